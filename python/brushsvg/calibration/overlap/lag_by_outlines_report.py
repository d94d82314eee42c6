"""Report the lag that was fitted to painted marks for a brush with known outlines."""

from __future__ import annotations

from ...reporting.report_text import Report, format_overlap, verdict
from ..law_text import HALF_95, coefficients, depths_shown, law_table, name_and_depths, paper_height, values
from ..marks.mark_report import judge_overlap, overlaps


def report(found) -> Report:
    """Return the report that `brushsvg calibrate --brush` prints.

    found: a lag_by_outlines.LagByOutlines.
    """
    brush, own, before = found.brush, found.own, found.before
    overlap_before, overlap_now = overlaps(before)[1], overlaps(found.made)[1]
    worse = "these outlines predict the marks worse than drops or eggs do: look at the dabs once more"
    reasons_against, reservations = judge_overlap(overlap_now)
    lines = [
        f"{name_and_depths(brush)}: the lag of {len(found.made.painted.marks)} painted marks by the outlines of brush "
        f"{own.name}; all else is that brush's",
        f"painted and predicted marks overlap by {format_overlap(overlap_now)}, by the brush of drops or eggs "
        f"{format_overlap(overlap_before)} (mean of intersection over union, without displacements)",
        paper_height(found.height_mm),
        f"residuals of the edges: standard deviation {found.noise_mm:.2f} mm",
    ]
    depths = depths_shown(brush, found.made.painted.deepest_mm)
    names = (f"lag of {own.name}"[:19], "by drops or eggs", "by its outlines")
    columns = zip(
        names, (values(shown_brush, "lag", depths) for shown_brush in (own, before.brush, brush)), strict=True
    )
    details = [*law_table(depths, columns), HALF_95, "", *coefficients(brush, ["lag"])]
    return Report(
        verdict(reasons_against, [worse if overlap_now < overlap_before else "", *reservations]),
        tuple(lines),
        tuple(details),
    )
