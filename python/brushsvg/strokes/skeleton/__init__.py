"""Filled outlines to the strokes that a brush would paint them with."""

from .fill_rule import filled
from .shape_to_strokes import OutlineStroke, outline_strokes

__all__ = ["OutlineStroke", "filled", "outline_strokes"]
