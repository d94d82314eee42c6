"""Text in a font to a drawing: an SVG document in mm, one path a glyph."""

from .typesetting import text_svg as text_svg
