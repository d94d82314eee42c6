"""Report a comparison as text and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from ..machine.cells.cell import Machine
from ..reporting.report_text import Report, format_overlap, overlap_reasons, percent, place_line, plural, table, verdict
from ..reporting.worst_areas import WorstArea, worst_areas
from .attribution.faults import Faults
from .attribution.report import fault_lines, faults_as_json, fix_first
from .corrections import FORMAT, RESIDUAL_KEY, Correction
from .corrections import as_json as correction_as_json
from .ends import UNKNOWN_ENDS, Ends
from .next_corrections import displacement_mm
from .photographs import MAX_EDGE_DISTANCE_MM, MISSING_MARK_SHARE, Compared, Comparison, TargetStroke

MIN_STRAY_PAINT_MM2 = 1.0
TABLE_HEAD = ("stroke", "drawn", "predicted", "x", "y", "off", "turn", "wider", "began", "ended", "missing")
WORSE_PLACE_NOTE = (
    ". The correction of the sheet reduces the overlap here, because missing paint, the brush and the machine also "
    "displace marks"
)


@dataclass(frozen=True)
class SheetFingerprints:
    """Fingerprints of the parts with which a sheet was made.

    brush: the brush that predicted the marks; plan_brush: the brush that the plan was made for, where it is known;
    machine: the machine errors that the cell compensated.
    """

    brush: str
    plan_brush: str
    machine: str


MIN_EXPLAINING_DISPLACEMENT_MM = 0.2  # smallest displacement that explains a difference of paint and drawing
MIN_EXPLAINING_MISSING_SHARE = 0.1  # smallest share of a mark without paint that explains one


def places_of(found: Comparison, strokes: list[TargetStroke]) -> list[tuple[str, WorstArea]]:
    """Return the areas where paint differs most from the drawing.

    Each area comes with the name of its stroke. Without a drawing, paint is compared with the prediction.
    """
    painting = [stroke for stroke in strokes if stroke.predicted]
    has_target = found.overlap_target is not None
    target = [*chain(*((stroke.target if has_target else stroke.predicted) or () for stroke in strokes))]
    left, _, _, top = found.canvas.window_mm
    lines = [np.vstack([ring[:, :2] for ring in stroke.predicted]) for stroke in painting]
    areas = worst_areas(found.canvas.filled(target), found.painted, (left, top), found.canvas.px_per_mm, lines)
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
    """Return the report of `brushsvg compare`.

    ends: by stroke; places: see `places_of`; machine: the cell's machine, as the next job should have it; any_alone:
    see `fix_first`.

    The verdict is "do not use" if paint and drawing overlap by less than 0.70. It is "usable, but" if they overlap by
    less than 0.95, if marks are missing, or if the sheet is partly covered.
    """
    as_painted, placed, each = found.overlaps
    what = "the drawing" if found.overlap_target is not None else "the prediction"
    against, low = overlap_reasons(as_painted, f"paint and {what.removeprefix('the ')}")
    missing_count = sum(not row.placed.found and row.missing > MISSING_MARK_SHARE for row in found.strokes)
    reservations = [
        *low,
        f"{plural(missing_count, 'mark')} {'is' if missing_count == 1 else 'are'} missing" if missing_count else "",
    ]
    reservations += ["an object or a blot covers part of the sheet"] if found.has_things else []
    rows = {row.stroke: row for row in found.strokes}
    shown_painted, shown_placed, shown_each = map(format_overlap, (as_painted, placed, each))
    lines = [
        f"{title}: {percent(as_painted)} of paint and {what.removeprefix('the ')} coincide (overlap {shown_painted}; "
        f"{shown_placed} if the place of the sheet were corrected, {shown_each} if the place of each stroke were)"
        f"{WORSE_PLACE_NOTE if shown_placed < shown_painted else ''}",
        _describe_sheet(found),
        *(
            place_line(
                number,
                name,
                area.at_mm,
                area.words,
                _explain_area(rows.get(name), area, ends.get(name, UNKNOWN_ENDS)),
            )
            for number, (name, area) in enumerate(places, 1)
        ),
        fix_first(faults, any_alone),
    ]
    if found.elsewhere_mm2 > MIN_STRAY_PAINT_MM2:
        lines.append(f"Paint further than {MAX_EDGE_DISTANCE_MM:g} mm from all marks: {found.elsewhere_mm2:.1f} mm^2.")
    details = [
        *table(
            TABLE_HEAD,
            (_table_row(stroke, ends.get(stroke.stroke, UNKNOWN_ENDS)) for stroke in found.strokes),
        ),
        "",
        "Drawn, predicted: overlap of the stroke's paint with the drawing and the prediction (intersection over "
        "union).",
        "x, y, off: displacement from the prediction in mm. Turn: in degrees. Wider: outward shift of each edge in mm.",
        "Began, ended: how much later than drawn the paint begins and ends along the stroke, in mm.",
        "Missing: share of the mark without paint. -: cannot be separated from neighbouring strokes.",
        *fault_lines(faults, machine),
    ]
    return Report(verdict(against, reservations), tuple(lines), tuple(details))


def _describe_sheet(found: Comparison) -> str:
    common, spread, middle = found.common, found.spread_mm, found.middle_mm
    beyond = f"; relative to the sheet, strokes are displaced by {spread:.2f} mm (rms)" if spread is not None else ""
    return (
        f"The sheet is displaced by x {common.shift_mm[0]:+.2f}, y {common.shift_mm[1]:+.2f} mm at x {middle[0]:.1f}, "
        f"y {middle[1]:.1f} mm, and turned by {math.degrees(common.turn_rad):+.2f} degrees{beyond}."
    )


def _explain_area(row: Compared | None, area: WorstArea, ends: Ends) -> str:
    """Return the best explanation of a difference: missing paint, or the largest displacement."""
    if row is None:
        return ""
    if area.is_missing and row.missing > MIN_EXPLAINING_MISSING_SHARE:
        return f"{percent(row.missing)} of its mark has no paint"
    causes = []
    if row.placed.found:
        off, wider = math.hypot(*row.placed.shift_mm), row.placed.wider_mm
        causes = [
            (off, "the stroke is displaced by"),
            (abs(wider), f"the stroke is too {'wide' if wider > 0 else 'narrow'}, at each edge by"),
        ]
    for what, mm in ends.near(area.at_mm).items():
        causes += [(abs(mm), f"the stroke {what} too {'late' if mm > 0 else 'early'}, by")]
    most, words = max(causes, default=(0.0, ""))
    return f"{words} {most:.2f} mm" if most > MIN_EXPLAINING_DISPLACEMENT_MM else ""


def _table_row(row: Compared, ends: Ends) -> tuple[str, ...]:
    x, y = row.placed.shift_mm
    placed = (x, y, math.hypot(x, y), math.degrees(row.placed.turn_rad), row.placed.wider_mm)
    formats = ("+.2f", "+.2f", ".2f", "+.1f", "+.2f")
    return (
        row.stroke,
        "-" if row.overlap_target is None else format_overlap(row.overlap_target),
        format_overlap(row.overlap_predicted),
        *(
            f"{round(value, int(how[-2])) + 0.0:{how}}" if row.placed.found else "-"
            for value, how in zip(placed, formats, strict=True)
        ),
        *("-" if mm is None else f"{round(mm, 2) + 0.0:+.2f}" for mm in (ends.began_mm, ends.ended_mm)),
        f"{100 * row.missing:.0f} %",
    )


def as_json(
    title: str,
    found: Comparison,
    corrections: dict[str, Correction],
    faults: Faults | None,
    ends: dict[str, Ends],
    sha256: SheetFingerprints,
    residual: tuple[str, dict[str, Correction]] | None = None,
) -> str:
    """Return the comparison as the text of a JSON file.

    corrections: corrections of strokes for the next sheet; faults: None if no cause is known; residual: fingerprint of
    the corrected cell's machine, and the corrections that remain with this cell.
    """
    _, placed, each = found.overlaps
    content = {
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
        "faults": faults_as_json(faults),
        "strokes": [
            {
                "stroke": row.stroke,
                "overlap_wanted": row.overlap_target,
                "overlap_predicted": row.overlap_predicted,
                "found": row.placed.found,
                "shift_mm": list(row.placed.shift_mm) if row.placed.found else None,
                "aside_mm": float(np.hypot(*displacement_mm(row, found))) if row.placed.found else None,
                "turn_deg": math.degrees(row.placed.turn_rad) if row.placed.found else None,
                "wider_mm": row.placed.wider_mm if row.placed.found else None,
                "began_mm": ends.get(row.stroke, UNKNOWN_ENDS).began_mm,
                "ended_mm": ends.get(row.stroke, UNKNOWN_ENDS).ended_mm,
                "missing": row.missing,
                "correction": correction_as_json(corrections.get(row.stroke)),
            }
            for row in found.strokes
        ],
    }
    if residual:
        machine, left = residual
        rows = [{"stroke": name, "correction": correction_as_json(each)} for name, each in left.items()]
        content[RESIDUAL_KEY] = {"machine_sha256": machine, "strokes": rows}
    return json.dumps(_rounded(content), indent=1, ensure_ascii=False) + "\n"


def _rounded(value):
    if isinstance(value, float):
        return round(value, 4 if abs(value) > 0.05 else 6) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list | tuple) else value
