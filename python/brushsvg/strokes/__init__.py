"""Strokes that paint a drawing."""
