"""Convert many drawings, each on its own. Finished drawings are kept."""
