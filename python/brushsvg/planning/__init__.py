"""Steps of a plan next to compensation: refinement, order, size."""
