"""A brush from the outlines of painted strokes."""
