"""Report the lag that was fitted to painted marks for a brush with known outlines."""

from __future__ import annotations

from ...reporting.report_text import Report, format_overlap, verdict
from ..law_text import (
    HALF_95,
    depths_shown,
    evaluate_law,
    format_coefficients,
    law_table,
    name_and_depths,
    paper_height,
)
from ..marks.from_marks import find_ignored_errors
from ..marks.machine_found import BIASING_PARTS, IGNORED_ERRORS, advise_parts, list_requested_parts
from ..marks.mark_report import judge_overlap, measure_mean_overlaps


def report(found, advised_parts: tuple[str, ...] = BIASING_PARTS) -> Report:
    """Return the report that `brushsvg calibrate --brush` prints.

    found: a lag_by_outlines.LagByOutlines. advised_parts: see mark_report.report.
    """
    brush, outline_brush, before = found.brush, found.outline_brush, found.before
    overlap_before, overlap_now = measure_mean_overlaps(before)[1], measure_mean_overlaps(found.mark_calibration)[1]
    ignored = find_ignored_errors(before, advised_parts)
    worse = "the measured outlines predict the marks worse than the usual drops or eggs: check the dabs again"
    reasons_against, reservations = judge_overlap(overlap_now)
    lines = [
        f"{name_and_depths(brush)}: the lag is fitted to {len(found.mark_calibration.painted.marks)} painted marks; "
        f"the outlines and the other laws are those of brush {outline_brush.name}",
        f"painted and predicted marks overlap by {format_overlap(overlap_now)}, and by "
        f"{format_overlap(overlap_before)} with drops or eggs as outlines (mean of intersection over union, after each "
        "mark is moved to its predicted place)",
        paper_height(found.height_mm),
        f"residuals of the edges: standard deviation {found.noise_mm:.2f} mm",
        *advise_parts(ignored, list_requested_parts(before.expected)),
    ]
    depths = depths_shown(brush, found.mark_calibration.painted.deepest_mm)
    names = (f"lag of {outline_brush.name}"[:19], "with drops or eggs", "with its outlines")
    columns = zip(
        names,
        (evaluate_law(shown_brush, "lag", depths) for shown_brush in (outline_brush, before.brush, brush)),
        strict=True,
    )
    details = [*law_table(depths, columns), HALF_95, "", *format_coefficients(brush, ["lag"])]
    return Report(
        verdict(
            reasons_against,
            [worse if overlap_now < overlap_before else "", *reservations, IGNORED_ERRORS if ignored else ""],
        ),
        tuple(lines),
        tuple(details),
    )
