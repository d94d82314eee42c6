"""A studio without a robot: a machine, a brush and a camera that are not quite as they should be."""
