"""Strokes to calibrate a brush from: layout, file, page to print."""
