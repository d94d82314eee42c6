"""Steps of a plan other than compensation: refinement, order, size."""
