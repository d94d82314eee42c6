"""Place the lines of a DXF on the sheet.

Model space has no page, and its origin can be far away, as in maps.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..design import Element, Notice
from ..layout import bounds_mm, scale_and_move
from ..svg.paths.path_to_cubics import MAX_COORDINATE_MM
from .entity_walk import Piece

MARGIN_MM = 20.0


def move_to_origin(pieces: list[Piece]) -> list[Piece]:
    """Move the pieces to the origin if most of them are more than 1e6 mm from it.

    Coordinates in maps are that large.
    """
    if not pieces:
        return pieces
    starts = np.array([piece.curves[0].cubics[0, 0, :2] for piece in pieces])
    middle = np.sort(starts, axis=0)[(len(starts) - 1) // 2]
    if np.abs(middle).max() <= MAX_COORDINATE_MM:
        return pieces
    shift = np.array([*middle.round(), 0.0])
    return [
        replace(piece, curves=tuple(replace(curve, cubics=curve.cubics - shift) for curve in piece.curves))
        for piece in pieces
    ]


def keep_in_range(pieces: list[Piece]) -> tuple[list[Piece], list[Notice]]:
    """Return the pieces within 1e6 mm, and the notices about the others."""
    kept, notices = [], []
    for piece in pieces:
        if all(np.abs(curve.cubics).max() <= MAX_COORDINATE_MM for curve in piece.curves):
            kept.append(piece)
        else:
            sentence = "its geometry is beyond 1e6 mm: left out"
            notices.append(
                Notice(piece.id, sentence, damaged=True, layer=piece.pen.layer, code="geometry-out-of-range")
            )
    return kept, notices


def place_with_margin(elements: list[Element]) -> tuple[tuple[float, float], tuple[Element, ...]]:
    """Return a sheet for the elements, and the elements moved onto it.

    The sheet, (width, height) [mm], is the bounding box of the elements with their widths, plus a margin of 20 mm.
    """
    box = bounds_mm(elements)
    shift = MARGIN_MM - box[:2]
    width, height = (box[2:] + shift + MARGIN_MM).tolist()
    return (width, height), tuple(scale_and_move(element, 1.0, shift, 1.0) for element in elements)
