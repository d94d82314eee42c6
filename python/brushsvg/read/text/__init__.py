"""Convert text in a font to a drawing: an SVG document in mm, one path per glyph."""

from .text_to_svg import text_svg as text_svg
