"""DXF to Design: the model space, in millimetres. How it is read: docs/dxf.md."""

from __future__ import annotations

import math

from ..design import Design, Notice
from ..errors import Error
from . import AS_DRAWN, ReadOptions
from .dxf_dashes import Dashes
from .dxf_file import open_dxf
from .dxf_lines import chained, element_of
from .dxf_place import anchored, in_range, with_margin
from .dxf_walk import Walk
from .nothing import nothing_to_paint

_FLAT_MM = 1e-3

_FOOT_MM = 304.8
_SURVEY_FOOT_MM = 1_200_000 / 3937
# $INSUNITS: name, mm.
_UNITS = {
    1: ("inches", 25.4),
    2: ("feet", _FOOT_MM),
    3: ("miles", 5280 * _FOOT_MM),
    4: ("millimetres", 1.0),
    5: ("centimetres", 10.0),
    6: ("metres", 1e3),
    7: ("kilometres", 1e6),
    8: ("microinches", 25.4e-6),
    9: ("mils", 25.4e-3),
    10: ("yards", 3 * _FOOT_MM),
    11: ("angstroms", 1e-7),
    12: ("nanometres", 1e-6),
    13: ("microns", 1e-3),
    14: ("decimetres", 100.0),
    15: ("decametres", 1e4),
    16: ("hectometres", 1e5),
    17: ("gigametres", 1e12),
    18: ("astronomical units", 149_597_870_700e3),
    19: ("light years", 9_460_730_472_580_800e3),
    20: ("parsecs", 149_597_870_700e3 * 648_000 / math.pi),
    21: ("US survey feet", _SURVEY_FOOT_MM),
    22: ("US survey inches", _SURVEY_FOOT_MM / 12),
    23: ("US survey yards", 3 * _SURVEY_FOOT_MM),
    24: ("US survey miles", 5280 * _SURVEY_FOOT_MM),
}
_ASKED_FOR = {"mm": _UNITS[4], "in": _UNITS[1]}


def read_dxf(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """The model space, its strokes in the order drawn, in mm.

    The sheet is what is drawn and 20 mm around it. A sheet given has the drawing's origin at its lower left.

    Error if it is no DXF, says no unit where options name none either, or has nothing to paint.
    """
    document, notices = open_dxf(data)
    mm_per_unit, unit_notices = _mm_per_unit(document, options.units)
    walk = Walk(document, mm_per_unit)
    walk.run()
    pieces, far = in_range(walk.pieces if options.sheet_mm else anchored(walk.pieces))
    notices += [*unit_notices, *walk.notices, *far]
    if not pieces:
        raise nothing_to_paint(notices)
    heights = [curve.cubics[..., 2] for piece in pieces for curve in piece.curves]
    lowest, highest = min(z.min() for z in heights), max(z.max() for z in heights)
    if highest - lowest > _FLAT_MM:
        sentence = f"the drawing is not flat: heights from {lowest:.6g} to {highest:.6g} mm are left out"
        notices.append(Notice("z", sentence))
    dashes = Dashes()
    elements = [dashes.cut(element_of(piece), piece.pen) for piece in chained(pieces)]
    notices += dashes.notices
    sheet_mm, placed = (options.sheet_mm, tuple(elements)) if options.sheet_mm else with_margin(elements)
    return Design(sheet_mm, placed, tuple(notices), layers=walk.pens.hidden())


def _mm_per_unit(document, asked_for: str | None) -> tuple[float, list[Notice]]:
    name, drawn = _UNITS.get(document.header.get("$INSUNITS", 0), ("", None))
    if asked_for is None:
        if drawn is None:
            raise Error("the drawing does not say its unit: give --units mm or --units in", where="$INSUNITS")
        return drawn, []
    wanted_name, wanted = _ASKED_FOR[asked_for]
    if drawn is None or drawn == wanted:
        return wanted, []
    return wanted, [Notice("$INSUNITS", f"the drawing is in {name}; read in {wanted_name}, as asked for")]
