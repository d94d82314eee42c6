"""Reader from the model space of a DXF to a Design.

The rules are in docs/reference/drawings.md.
"""

from __future__ import annotations

from .. import AS_DRAWN, ReadOptions
from ..design import Design, Notice
from ..empty_drawing import empty_drawing_error
from .entity_walk import Walk
from .file import open_dxf
from .linetypes import Dashes
from .pieces_to_elements import anew, chained, element_of
from .placement import anchored, extents, in_range, with_margin
from .units import large_for_its_unit, unit_of

_FLAT_MM = 1e-3  # a larger range of heights is reported


def read_dxf(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """Read the model space of a DXF, with its strokes in the order drawn, in mm.

    Without options.sheet_mm, the sheet is the bounding box of the drawing plus a margin of 20 mm. A given sheet has
    the origin of the drawing at its lower left corner.

    Raises Error if the data is not a DXF or has nothing to paint, or if neither the drawing nor the options give a
    unit.
    """
    document, notices = open_dxf(data)
    mm_per_unit, unit_notices = unit_of(document, options.units)
    walk = Walk(document, mm_per_unit)
    walk.run()
    pieces, far = in_range(walk.pieces if options.sheet_mm else anchored(walk.pieces))
    notices += [*unit_notices, *walk.notices, *far]
    if not pieces:
        raise empty_drawing_error(notices)
    heights = [curve.cubics[..., 2] for piece in pieces for curve in piece.curves]
    lowest, highest = min(z.min() for z in heights), max(z.max() for z in heights)
    if highest - lowest > _FLAT_MM:
        sentence = f"the drawing is not flat: heights from {lowest:.6g} to {highest:.6g} mm are left out"
        notices.append(Notice("z", sentence, code="dxf-not-flat"))
    dashes = Dashes()
    elements = [dashes.cut(element_of(piece), piece.pen, anew(piece)) for piece in chained(pieces)]
    notices += dashes.notices
    if options.units is None:
        least, greatest = extents(elements)
        notices += large_for_its_unit(document, float((greatest - least).max()))
    sheet_mm, placed = (options.sheet_mm, tuple(elements)) if options.sheet_mm else with_margin(elements)
    return Design(sheet_mm, placed, tuple(notices), layers=walk.pens.hidden())
