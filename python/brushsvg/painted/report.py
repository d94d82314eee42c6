"""A comparison in words and as JSON."""

from __future__ import annotations

import json
import math

import numpy as np

from .comparison import BLOT_MM, Compared, Comparison

HEAD = ("stroke", "wanted", "predicted", "x", "y", "off", "turn", "wider", "missing", "blots")


def as_text(title: str, found: Comparison) -> str:
    rows = [HEAD, *(_row(stroke) for stroke in found.strokes)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(HEAD))]
    table = [
        "  ".join(
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    as_it_lies, placed, each = found.overlaps
    what = "what was wanted" if found.overlap_wanted is not None else "what was predicted"
    common, spread = found.common, spread_mm(found)
    lines = [
        f"{title}: {len(found.strokes)} strokes",
        "",
        table[0],
        *table[1:],
        "",
        f"All paint overlaps with {what} by {as_it_lies:.3f}; with the sheet's place put right by {placed:.3f}, with "
        f"each stroke's by {each:.3f}.",
        f"The sheet: x {common.shift_mm[0]:+.2f}, y {common.shift_mm[1]:+.2f} mm, "
        f"turned {math.degrees(common.turn_rad):+.2f} degrees."
        + (f" What is left of the strokes' places: {spread:.2f} mm (rms)." if spread is not None else ""),
        "",
        "Wanted, predicted: overlap of the stroke's paint with them, intersection over union. x, y, off: displacement",
        "from the prediction in mm; turn in degrees; wider: of each edge, in mm; missing: share of the mark, as it",
        f"lies, without paint; blots: paint more than {BLOT_MM:g} mm beside it.",
    ]
    return "\n".join(lines) + "\n"


def _row(one: Compared) -> tuple[str, ...]:
    x, y = one.placed.shift_mm
    known = one.placed.found
    return (
        one.stroke,
        "-" if one.overlap_wanted is None else f"{one.overlap_wanted:.3f}",
        f"{one.overlap_predicted:.3f}",
        f"{x:+.2f}" if known else "-",
        f"{y:+.2f}" if known else "-",
        f"{math.hypot(x, y):.2f}" if known else "-",
        f"{math.degrees(one.placed.turn_rad):+.1f}" if known else "-",
        f"{one.placed.wider_mm:+.2f}" if known else "-",
        f"{100 * one.missing:.0f} %",
        f"{100 * one.extra:.0f} %",
    )


def spread_mm(found: Comparison) -> float | None:
    """Of the strokes' displacements about the sheet's, rms; None where fewer than two are known."""
    places = np.array([one.placed.shift_mm for one in found.strokes if one.placed.found])
    if len(places) < 2:
        return None
    return float(np.sqrt(np.square(places - places.mean(axis=0)).sum(axis=1).mean()))


def as_json(title: str, found: Comparison) -> str:
    _, placed, each = found.overlaps
    made = {
        "format": "brushsvg/comparison",
        "version": 1,
        "title": title,
        "overlap_wanted": found.overlap_wanted,
        "overlap_predicted": found.overlap_predicted,
        "overlap_sheet_placed": placed,
        "overlap_strokes_placed": each,
        "sheet": {
            "shift_mm": list(found.common.shift_mm),
            "turn_deg": math.degrees(found.common.turn_rad),
            "middle_mm": found.middle_mm.tolist(),
            "found": found.common.found,
        },
        "strokes": [
            {
                "stroke": one.stroke,
                "overlap_wanted": one.overlap_wanted,
                "overlap_predicted": one.overlap_predicted,
                "found": one.placed.found,
                "shift_mm": list(one.placed.shift_mm),
                "turn_deg": math.degrees(one.placed.turn_rad),
                "wider_mm": one.placed.wider_mm,
                "missing": one.missing,
                "blots": one.extra,
            }
            for one in found.strokes
        ],
    }
    return json.dumps(_rounded(made), indent=1, ensure_ascii=False) + "\n"


def _rounded(value):
    if isinstance(value, float):
        return round(value, 4) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list) else value
