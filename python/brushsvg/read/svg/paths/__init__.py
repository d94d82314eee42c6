"""Shapes and path data of SVG as cubics."""
