"""A comparison in words and as JSON."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

import numpy as np

from ..machine.cells.cell import Machine
from .attribution.faults import Faults
from .attribution.report import in_json, in_words
from .corrections import FORMAT, RESIDUAL, Correction
from .corrections import as_json as in_file
from .ends import UNSEEN, Ends
from .next_corrections import displacement_mm
from .photographs import BLOT_MM, Compared, Comparison

LEAST_BLOT_MM2 = 1.0
HEAD = ("stroke", "wanted", "predicted", "x", "y", "off", "turn", "wider", "began", "ended", "missing")
WORSE = (
    " (less: the middles of marks tell that place, which missing paint, the brush and the machine move, too)"
)


@dataclass(frozen=True)
class Made:
    """Fingerprints of what a sheet was made with: the brush that predicted, the one that the plan was made for, where
    it is known, and the machine that the cell undid."""

    brush: str
    plan_brush: str
    machine: str


def as_text(
    title: str,
    found: Comparison,
    faults: Faults | None,
    ends: dict[str, Ends],
    machine: Machine | None = None,
    any_alone: bool = True,
) -> str:
    """ends: by stroke; machine: of the cell, as the next job should be told it; any_alone: see in_words."""
    rows = [HEAD, *(_row(stroke, ends.get(stroke.stroke, UNSEEN)) for stroke in found.strokes)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(HEAD))]
    table = [
        "  ".join(
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    as_painted, placed, each = found.overlaps
    what = "what was wanted" if found.overlap_target is not None else "what was predicted"
    common, middle, spread = found.common, found.middle_mm, found.spread_mm
    lines = [
        f"{title}: {len(found.strokes)} strokes",
        "",
        table[0],
        *table[1:],
        "",
        f"All paint overlaps with {what} by {as_painted:.3f}; with the sheet's place put right by {placed:.3f}"
        f"{WORSE if round(placed, 3) < round(as_painted, 3) else ''}, with each stroke's by {each:.3f}.",
        f"The sheet lies x {common.shift_mm[0]:+.2f}, y {common.shift_mm[1]:+.2f} mm aside at the middle of its marks, "
        f"x {middle[0]:.1f}, y {middle[1]:.1f} mm, turned by {math.degrees(common.turn_rad):+.2f} degrees."
        + (f" Beyond that, strokes lie {spread:.2f} mm (rms) aside." if spread is not None else ""),
        *(
            [f"Paint farther than {BLOT_MM:g} mm from all marks: {found.elsewhere_mm2:.1f} mm^2."]
            if found.elsewhere_mm2 > LEAST_BLOT_MM2
            else []
        ),
        "",
        "Wanted, predicted: overlap of the stroke's paint with them, intersection over union. x, y, off: displacement",
        "from the prediction in mm; turn in degrees; wider: of each edge, in mm; began, ended: how much later on its",
        "way than wanted, in mm; missing: share of the mark, where it lies, without paint; -: not to be told from its",
        "neighbours.",
        *in_words(faults, machine, any_alone),
    ]
    return "\n".join(lines) + "\n"


def _row(one: Compared, ends: Ends) -> tuple[str, ...]:
    x, y = one.placed.shift_mm
    placed = (x, y, math.hypot(x, y), math.degrees(one.placed.turn_rad), one.placed.wider_mm)
    formats = ("+.2f", "+.2f", ".2f", "+.1f", "+.2f")
    return (
        one.stroke,
        "-" if one.overlap_target is None else f"{one.overlap_target:.3f}",
        f"{one.overlap_predicted:.3f}",
        *(
            f"{round(value, int(how[-2])) + 0.0:{how}}" if one.placed.found else "-"
            for value, how in zip(placed, formats, strict=True)
        ),
        *("-" if mm is None else f"{round(mm, 2) + 0.0:+.2f}" for mm in (ends.began_mm, ends.ended_mm)),
        f"{100 * one.missing:.0f} %",
    )


def as_json(
    title: str,
    found: Comparison,
    corrections: dict[str, Correction],
    faults: Faults | None,
    ends: dict[str, Ends],
    sha256: Made,
    residual: tuple[str, dict[str, Correction]] | None = None,
) -> str:
    """corrections: of the strokes that should be led elsewhere next time; faults: None where nothing is told; beside:
    the fingerprint of the corrected cell's machine, and the corrections that are left with it."""
    _, placed, each = found.overlaps
    made = {
        "format": FORMAT,
        "version": 1,
        "title": title,
        "brush_sha256": sha256.brush,
        "plan_brush_sha256": sha256.plan_brush,
        "machine_sha256": sha256.machine,
        "overlap_wanted": found.overlap_target,
        "overlap_predicted": found.overlap_predicted,
        "overlap_sheet_placed": placed,
        "overlap_strokes_placed": each,
        "sheet": {
            "shift_mm": list(found.common.shift_mm),
            "turn_deg": math.degrees(found.common.turn_rad),
            "middle_mm": found.middle_mm.tolist(),
            "found": found.common.found,
            "strokes_aside_mm": found.spread_mm,
        },
        "elsewhere_mm2": found.elsewhere_mm2,
        "faults": in_json(faults),
        "strokes": [
            {
                "stroke": one.stroke,
                "overlap_wanted": one.overlap_target,
                "overlap_predicted": one.overlap_predicted,
                "found": one.placed.found,
                "shift_mm": list(one.placed.shift_mm) if one.placed.found else None,
                "aside_mm": float(np.hypot(*displacement_mm(one, found))) if one.placed.found else None,
                "turn_deg": math.degrees(one.placed.turn_rad) if one.placed.found else None,
                "wider_mm": one.placed.wider_mm if one.placed.found else None,
                "began_mm": ends.get(one.stroke, UNSEEN).began_mm,
                "ended_mm": ends.get(one.stroke, UNSEEN).ended_mm,
                "missing": one.missing,
                "correction": in_file(corrections.get(one.stroke)),
            }
            for one in found.strokes
        ],
    }
    if residual:
        machine, left = residual
        rows = [{"stroke": name, "correction": in_file(each)} for name, each in left.items()]
        made[RESIDUAL] = {"machine_sha256": machine, "strokes": rows}
    return json.dumps(_rounded(made), indent=1, ensure_ascii=False) + "\n"


def _rounded(value):
    if isinstance(value, float):
        return round(value, 4 if abs(value) > 0.05 else 6) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list | tuple) else value
