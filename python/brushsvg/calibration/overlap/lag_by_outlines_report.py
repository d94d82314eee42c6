"""What painted marks show of the lag of a brush whose outlines are known."""

from __future__ import annotations

from ...reporting.report_text import Report, verdict
from ..law_text import HALF_95, coefficients, depths_shown, law_table, name_and_depths, paper_height, values
from ..marks.mark_report import judge_overlap, overlaps


def report(found) -> Report:
    """What `brushsvg calibrate --brush` prints. found: lag_by_outlines.LagByOutlines."""
    brush, own, before = found.brush, found.own, found.before
    was, now = overlaps(before)[1], overlaps(found.made)[1]
    worse = "these outlines predict the marks worse than drops or eggs do: look at the dabs once more"
    against, but = judge_overlap(now)
    lines = [
        f"{name_and_depths(brush)}: the lag of {len(found.made.painted.marks)} painted marks by the outlines of brush "
        f"{own.name}; all else is that brush's",
        f"painted and predicted marks overlap by {now:.3f}, by the brush of drops or eggs {was:.3f} (mean of "
        "intersection over union, without displacements)",
        paper_height(found.height_mm),
        f"residuals of the edges: standard deviation {found.noise_mm:.2f} mm",
    ]
    depths = depths_shown(brush, found.made.painted.deepest_mm)
    names = (f"lag of {own.name}"[:19], "by drops or eggs", "by its outlines")
    columns = zip(names, (values(each, "lag", depths) for each in (own, before.brush, brush)), strict=True)
    details = [*law_table(depths, columns), HALF_95, "", *coefficients(brush, ["lag"])]
    return Report(verdict(against, [worse if now < was else "", *but]), tuple(lines), tuple(details))
