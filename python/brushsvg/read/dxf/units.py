"""The unit of a DXF in mm, from the header or from the options of the reader."""

from __future__ import annotations

import math

from ...errors import Error
from ..design import Notice

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
_MAX_PLAUSIBLE_MM = 5000.0  # no brush paints a larger drawing
_REQUESTED_UNITS = {"mm": _UNITS[4], "in": _UNITS[1]}


def find_unit(document, requested: str | None) -> tuple[float, list[Notice]]:
    """Return the unit of the drawing, or the requested unit, in mm.

    Also returns a notice if the request overrules the drawing.
    Raises Error if neither the drawing nor the request gives a unit.
    """
    name, drawn = _UNITS.get(document.header.get("$INSUNITS", 0), ("", None))
    if requested is None:
        if drawn is None:
            sentence = "the drawing does not say its unit: give --units mm or --units in"
            raise Error(sentence, where="$INSUNITS", code="unit-unknown")
        return drawn, []
    unit_name, unit_mm = _REQUESTED_UNITS[requested]
    if drawn is None or drawn == unit_mm:
        return unit_mm, []
    return unit_mm, [
        Notice(
            "$INSUNITS",
            f"the drawing is in {name}; read in {unit_name}, as requested",
            code="unit-overruled",
        )
    ]


def report_large_unit(document, size_mm: float) -> list[Notice]:
    """Return a notice if the longer side of the drawing is larger than any sheet.

    The numbers of such a drawing are probably in a smaller unit.
    """
    name, drawn = _UNITS[document.header["$INSUNITS"]]
    if drawn <= 1 or size_mm <= _MAX_PLAUSIBLE_MM:
        return []
    sentence = f"the drawing is {size_mm / 1000:.4g} m large, since its unit is {name}"
    advice = "--units mm reads its numbers as millimetres"
    return [Notice("$INSUNITS", sentence, code="unit-doubtful", advice=advice)]
