"""Convert many drawings, each on its own; finished ones are kept."""
