"""Strokes with which a brush would paint filled outlines."""

from .fill_rule import filled_rings
from .shape_to_strokes import OutlineStroke, outline_strokes

__all__ = ["OutlineStroke", "filled_rings", "outline_strokes"]
