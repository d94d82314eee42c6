"""Fit a brush to the outlines of painted strokes."""
