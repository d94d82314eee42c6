"""A comparison for people and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from ..machine.cells.cell import Machine
from ..reporting.report_text import Report, overlap_reasons, percent, place_line, plural, table, verdict
from ..reporting.worst_areas import WorstArea, worst_areas
from .attribution.faults import Faults
from .attribution.report import fix_first, in_json, in_words
from .corrections import FORMAT, RESIDUAL_KEY, Correction
from .corrections import as_json as in_file
from .ends import UNSEEN, Ends
from .next_corrections import displacement_mm
from .photographs import MAX_EDGE_DISTANCE_MM, MAX_MISSING_SHARE, Compared, Comparison, TargetStroke

LEAST_BLOT_MM2 = 1.0
HEAD = ("stroke", "drawn", "predicted", "x", "y", "off", "turn", "wider", "began", "ended", "missing")
WORSE = " (less: the place comes from the middles of marks, which missing paint, the brush and the machine move, too)"


@dataclass(frozen=True)
class Made:
    """Fingerprints of what a sheet was made with: the brush that predicted, the one that the plan was made for, where
    it is known, and the machine that the cell undid."""

    brush: str
    plan_brush: str
    machine: str


SEEN_MM = 0.2  # a displacement that explains a place at least
SEEN_SHARE = 0.1  # of a mark without paint, that does


def places_of(found: Comparison, strokes: list[TargetStroke]) -> list[tuple[str, WorstArea]]:
    """Where paint differs most from the drawing, or from the prediction without one, each with its stroke."""
    painting = [stroke for stroke in strokes if stroke.predicted]
    has_target = found.overlap_target is not None
    target = [*chain(*((stroke.target if has_target else stroke.predicted) or () for stroke in strokes))]
    left, _, _, top = found.canvas.window_mm
    lines = [np.vstack([ring[:, :2] for ring in stroke.predicted]) for stroke in painting]
    areas = worst_areas(
        found.canvas.filled(target), found.painted, (left, top), found.canvas.px_per_mm, lines
    )
    names = [stroke.stroke for stroke in painting]
    return [(names[area.stroke], area) for area in areas]


def report(
    title: str,
    found: Comparison,
    faults: Faults | None,
    ends: dict[str, Ends],
    places: Iterable[tuple[str, WorstArea]],
    machine: Machine | None = None,
    any_alone: bool = True,
) -> Report:
    """What `brushsvg compare` prints. ends: by stroke; places: see places_of; machine: of the cell, as the next job
    should have it; any_alone: see in_words.

    Do not use: paint and drawing overlap by less than 0.70. Usable, but: by less than 0.95; marks are missing; the
    sheet is partly covered.
    """
    as_painted, placed, each = found.overlaps
    what = "the drawing" if found.overlap_target is not None else "the prediction"
    against, low = overlap_reasons(as_painted, f"paint and {what.removeprefix('the ')}")
    gone = sum(not row.placed.found and row.missing > MAX_MISSING_SHARE for row in found.strokes)
    but = [*low, f"{plural(gone, 'mark')} {'is' if gone == 1 else 'are'} missing" if gone else ""]
    but += ["something covers part of the sheet"] if found.has_things else []
    rows = {row.stroke: row for row in found.strokes}
    lines = [
        f"{title}: {percent(as_painted)} of paint and {what.removeprefix('the ')} coincide (overlap {as_painted:.3f}; "
        f"{placed:.3f} with the sheet's place corrected, {each:.3f} with each stroke's)"
        f"{WORSE if round(placed, 3) < round(as_painted, 3) else ''}",
        _sheet(found),
        *(
            place_line(
                number, name, area.at_mm, area.words, _why(rows.get(name), area, ends.get(name, UNSEEN))
            )
            for number, (name, area) in enumerate(places, 1)
        ),
        fix_first(faults, any_alone),
    ]
    if found.elsewhere_mm2 > LEAST_BLOT_MM2:
        lines.append(
            f"Paint further than {MAX_EDGE_DISTANCE_MM:g} mm from all marks: {found.elsewhere_mm2:.1f} mm^2."
        )
    details = [
        *table(HEAD, (_row(stroke, ends.get(stroke.stroke, UNSEEN)) for stroke in found.strokes)),
        "",
        "Drawn, predicted: overlap of the stroke's paint with them, intersection over union. x, y, off: displacement",
        "from the prediction in mm; turn in degrees; wider: of each edge, in mm; began, ended: how much later on its",
        "way than drawn, in mm; missing: share of the mark without paint; -: cannot be separated from its neighbours.",
        *in_words(faults, machine),
    ]
    return Report(verdict(against, but), tuple(lines), tuple(details))


def _sheet(found: Comparison) -> str:
    common, spread, middle = found.common, found.spread_mm, found.middle_mm
    beyond = f"; beyond that, strokes are displaced by {spread:.2f} mm (rms)" if spread is not None else ""
    return (
        f"The sheet is displaced by x {common.shift_mm[0]:+.2f}, y {common.shift_mm[1]:+.2f} mm at x {middle[0]:.1f}, "
        f"y {middle[1]:.1f} mm, and turned by {math.degrees(common.turn_rad):+.2f} degrees{beyond}."
    )


def _why(row: Compared | None, area: WorstArea, ends: Ends) -> str:
    """What explains a place best, by what is known of its stroke: missing paint, else the largest displacement."""
    if row is None:
        return ""
    if area.is_missing and row.missing > SEEN_SHARE:
        return f"{percent(row.missing)} of its mark has no paint"
    causes = []
    if row.placed.found:
        off, wider = math.hypot(*row.placed.shift_mm), row.placed.wider_mm
        causes = [
            (off, "the stroke is displaced by"),
            (abs(wider), f"each edge is too {'far out' if wider > 0 else 'far in'}, by"),
        ]
    for what, mm in ends.near(area.at_mm).items():
        causes += [(abs(mm), f"it {what} too {'late' if mm > 0 else 'early'}, by")]
    most, words = max(causes, default=(0.0, ""))
    return f"{words} {most:.2f} mm" if most > SEEN_MM else ""


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
    """Return the comparison as the text of a JSON file.

    corrections: of the strokes that should be displaced next time; faults: None if no cause is known; residual: the
    fingerprint of the corrected cell's machine, and the corrections that are left with it.
    """
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
        made[RESIDUAL_KEY] = {"machine_sha256": machine, "strokes": rows}
    return json.dumps(_rounded(made), indent=1, ensure_ascii=False) + "\n"


def _rounded(value):
    if isinstance(value, float):
        return round(value, 4 if abs(value) > 0.05 else 6) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list | tuple) else value
