"""Reader from the model space of a DXF to a Design.

The rules are in docs/reference/drawings.md.
"""

from __future__ import annotations

from dataclasses import replace

from .. import AS_DRAWN, ReadOptions
from ..design import Design, Notice
from ..empty_drawing import empty_drawing_error
from ..layout import bounds_mm
from .entity_walk import EntityWalk
from .file import open_dxf
from .linetypes import DashCutter
from .pieces_to_elements import find_pattern_restarts, join_pieces, piece_to_element
from .placement import keep_in_range, move_to_origin, place_with_margin
from .units import find_unit, report_large_unit

_MAX_FLAT_RANGE_MM = 1e-3  # a larger range of heights is reported


def read_dxf(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """Read the model space of a DXF, with its strokes in the order drawn, in mm.

    Without options.sheet_mm, the sheet is the bounding box of the drawing plus a margin of 20 mm. A given sheet has
    the origin of the drawing at its lower left corner, unless the drawing is far away and options.is_placed_later.

    Raises Error if the data is not a DXF or has nothing to paint, or if neither the drawing nor the options give a
    unit.
    """
    document, notices = open_dxf(data)
    mm_per_unit, unit_notices = find_unit(document, options.units)
    walk = EntityWalk(document, mm_per_unit)
    walk.run()
    keeps_origin = options.sheet_mm is not None and not options.is_placed_later
    pieces, far_notices = keep_in_range(walk.pieces if keeps_origin else move_to_origin(walk.pieces))
    notices += [*unit_notices, *walk.notices, *far_notices]
    if not pieces:
        if keeps_origin and far_notices:
            advice = "--fit WxH or --origin X,Y moves the drawing onto the sheet"
            notices = [replace(notice, advice=advice) for notice in far_notices]
        raise empty_drawing_error(notices)
    heights = [curve.cubics[..., 2] for piece in pieces for curve in piece.curves]
    lowest, highest = min(z.min() for z in heights), max(z.max() for z in heights)
    if highest - lowest > _MAX_FLAT_RANGE_MM:
        sentence = f"the drawing is not flat: heights from {lowest:.6g} to {highest:.6g} mm are left out"
        notices.append(Notice("z", sentence, code="dxf-not-flat"))
    dashes = DashCutter()
    elements = [
        dashes.cut(piece_to_element(piece), piece.pen, find_pattern_restarts(piece)) for piece in join_pieces(pieces)
    ]
    notices += dashes.notices
    if options.units is None:
        x0, y0, x1, y1 = bounds_mm(elements).tolist()
        notices += report_large_unit(document, max(x1 - x0, y1 - y0))
    sheet_mm, placed = (options.sheet_mm, tuple(elements)) if options.sheet_mm else place_with_margin(elements)
    return Design(sheet_mm, placed, tuple(notices), layers=walk.pens.hidden())
