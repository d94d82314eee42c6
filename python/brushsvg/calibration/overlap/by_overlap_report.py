"""Report a calibration to the largest overlap, and compare it with the fit by edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...model.describe import LAWS
from ...model.plot import brush_picture
from ...reporting.report_text import Report, format_overlap, verdict
from ..law_text import depths_shown, format_coefficients, law_table, name_and_depths, paper_height, summarize_laws
from ..marks.machine_found import BIASING_PARTS
from ..marks.mark_report import judge_overlap, measure_mean_overlaps
from ..marks.mark_report import report as edge_report
from ..marks.mark_report import report_picture as edge_report_picture


def report(calibration, of_photo: bool = False, advised_parts: tuple[str, ...] = BIASING_PARTS) -> Report:
    """Return the report that `brushsvg calibrate --aim overlap` prints.

    calibration: a by_overlap.OverlapCalibration. of_photo, advised_parts: see
    mark_report.report.
    """
    brush, edges, found = calibration.brush, calibration.by_edges, calibration.found
    if found.kind == "edges":
        by_edges = edge_report(edges, of_photo, advised_parts)
        return replace(by_edges, lines=(chosen_in_words(found), *by_edges.lines))
    (in_place, moved), (now_in_place, now_moved) = (
        measure_mean_overlaps(edges),
        measure_mean_overlaps(calibration.mark_calibration),
    )
    lines = [
        f"{name_and_depths(brush)}: {summarize_laws(brush)}, fitted to the largest overlap with "
        f"{len(edges.painted.marks)} painted marks",
        f"painted and predicted marks overlap by {format_overlap(now_in_place)} as painted, and by "
        f"{format_overlap(now_moved)} after each mark is moved to its predicted place (fit by edges: "
        f"{format_overlap(in_place)} and {format_overlap(moved)})",
        chosen_in_words(found),
        f"{paper_height(found.height_mm)} (fit by edges: {edges.fit.height_mm:+.2f} mm)",
        *_describe_machine(edges, found.offsets),
        "no confidence intervals are known for this brush; calibrate without --aim overlap gives a brush with "
        "intervals",
    ]
    depths = depths_shown(brush)
    columns = [
        (
            f"{law} (edges)",
            [f"{getattr(brush, law)(at):.2f} ({getattr(edges.brush, law)(at):.2f})" for at in depths],
        )
        for law, _ in LAWS
    ]
    by_edges = "  in brackets: the fit by edges, which calibrate writes without --aim overlap"
    details = [*law_table(depths, columns), by_edges, "", *format_coefficients(brush)]
    return Report(verdict(*judge_overlap(now_moved)), tuple(lines), tuple(details))


KIND_NAMES = {
    "edges": "the fit by edges, unchanged",
    "disc": "a dragged disc",
    "laws": "laws and footprint changed",
    "machine": "laws, footprint and machine changed",
}


def chosen_in_words(found) -> str:
    """Describe which numbers the search changed, and why. found: an overlap_choice.Predicting."""
    if not found.left_out:
        return (
            f"used: {KIND_NAMES[found.kind]}. There are too few marks to test whether this predicts other marks "
            "better than the fit by edges"
        )
    listed = "; ".join(f"{KIND_NAMES[kind]} {sum(both) / 2:.3f}" for kind, both in found.left_out.items())
    return (
        f"used: {KIND_NAMES[found.kind]}. It has the largest overlap with marks that were left out of the fit "
        f"(cross-validation with {found.parts} parts, mean of the overlaps as painted and moved): {listed}"
    )


def _describe_machine(edges, offsets) -> list[str]:
    """Describe the errors of the machine by edges, and with the additional ones."""
    lines, machine_by_edges = [], edges.fit.machine
    if offsets.lean_mm_per_mm.any():
        x, y = offsets.lean_mm_per_mm + machine_by_edges.lean_mm_per_mm
        lines.append(
            f"lean: {x:+.3f} mm in x and {y:+.3f} mm in y per mm of depth (fit by edges: {{:+.3f}} and "
            "{:+.3f})".format(*machine_by_edges.lean_mm_per_mm)
        )
    if offsets.map.any():
        axes = np.array([[machine_by_edges.scale[0], machine_by_edges.skew], [0.0, machine_by_edges.scale[1]]])
        (a, b), (c, d) = (np.eye(2) + offsets.map) @ axes - np.eye(2)
        lines.append(
            f"paths: x is off by {a:+.4f} mm per mm in x and {b:+.4f} mm per mm in y, y by {c:+.4f} and {d:+.4f} mm "
            f"(fit by edges: scale {machine_by_edges.scale[0]:.4f} and {machine_by_edges.scale[1]:.4f}, skew "
            f"{machine_by_edges.skew:+.4f})"
        )
    return lines


def report_picture(calibration, suffix: str) -> bytes:
    """Draw the laws, with bands only if the fit by edges was chosen."""
    if calibration.found.kind == "edges":
        return edge_report_picture(calibration.by_edges, suffix)
    return brush_picture(calibration.brush, suffix)
