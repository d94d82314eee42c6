"""How well a plan paints what was drawn, in mm: per stroke and in all, as text and as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace

import numpy as np

from . import _core
from .uncertainty import Uncertainty

RING_TOLERANCE_MM = 0.01
SAMPLE_SPACING_MM = 0.25


@dataclass(frozen=True)
class Figures:
    """Lengths in mm. None: cannot be said, since what was wanted is not known or nothing could be measured.

    overlap: area of intersection over area of union of predicted and wanted mark.
    centre_*: distance of the widest point from the middle line over taut rows.
    width_error_mm: mean absolute difference of predicted and wanted width across the middle line.
    drawn_mm, painted_mm: length of the middle line; of the TCP's path on the paper.
    """

    stroke: str
    overlap: float | None
    centre_mean_mm: float | None
    centre_largest_mm: float | None
    width_error_mm: float | None
    widths_out_of_reach: int | None
    drawn_mm: float | None
    painted_mm: float
    poses: int


@dataclass(frozen=True)
class Report:
    title: str
    brush: str
    compensation: str
    tolerance_mm: float | None
    strokes: tuple[Figures, ...]
    total: Figures
    time_s: float
    warnings: tuple[tuple[str, str], ...] = ()
    refused: tuple[tuple[str, str], ...] = ()  # strokes that are not among those of the report
    sure: Uncertainty | None = None  # None: nothing is known of how sure the brush is


def wanted_rings(strokes) -> list[np.ndarray]:
    """Outline of everything that was drawn."""
    return _core.unite([ring for s in strokes for ring in _core.wanted_outline(s, RING_TOLERANCE_MM)])


def measure(
    plan, marks, brush, strokes=None, tolerance_mm: float = 0.05, drawn=None
) -> tuple[tuple[Figures, ...], Figures]:
    """Figures for each pass and for all. marks: with outlines; strokes: one per pass, None if unknown, or None for a
    pass that is a part of a stroke: then drawn is all that was drawn, the strokes themselves where it is None."""
    if strokes is None:
        rows = tuple(_bare_figures(a_pass) for a_pass in plan.passes)
        return rows, _in_all(rows, None)
    rows, wanted = [], []
    for a_pass, trace, stroke in zip(plan.passes, marks.passes, strokes, strict=True):
        if stroke is None:
            rows.append(_bare_figures(a_pass))
            continue
        rings = _core.wanted_outline(stroke, RING_TOLERANCE_MM)
        miss = _core.miss_of(a_pass, stroke, brush, tolerance_mm)
        line = _core.flatten(stroke, RING_TOLERANCE_MM)
        figures = replace(
            _bare_figures(a_pass),
            overlap=_core.overlap(trace.outline_mm, rings),
            centre_mean_mm=miss.mean_mm,
            centre_largest_mm=miss.largest_mm,
            width_error_mm=width_error(line, trace.outline_mm, rings),
            widths_out_of_reach=_out_of_reach(stroke, brush),
            drawn_mm=float(line[-1, 2]),
        )
        rows.append(figures)
        wanted += rings
    meant = _core.unite(wanted) if drawn is None else wanted_rings(drawn)
    return tuple(rows), _in_all(tuple(rows), _core.overlap(marks.outline_mm, meant) if rows else None)


def _bare_figures(a_pass) -> Figures:
    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    painted_mm = float(np.linalg.norm(np.diff(poses, axis=0), axis=1).sum())
    return Figures(a_pass.stroke, None, None, None, None, None, None, painted_mm, len(poses))


def _in_all(rows: tuple[Figures, ...], overlap: float | None) -> Figures:
    def known(name, combine):
        values = [(getattr(row, name), row.drawn_mm or 0.0) for row in rows if getattr(row, name) is not None]
        return combine(*zip(*values, strict=True)) if values else None

    def mean(values, weights):
        return float(np.average(values, weights=weights)) if sum(weights) > 0 else float(np.mean(values))

    return Figures(
        stroke="all",
        overlap=overlap,
        centre_mean_mm=known("centre_mean_mm", mean),
        centre_largest_mm=known("centre_largest_mm", lambda values, _: max(values)),
        width_error_mm=known("width_error_mm", mean),
        widths_out_of_reach=known("widths_out_of_reach", lambda values, _: sum(values)),
        drawn_mm=known("drawn_mm", lambda values, _: sum(values)),
        painted_mm=sum(row.painted_mm for row in rows),
        poses=sum(row.poses for row in rows),
    )


def _out_of_reach(stroke, brush) -> int:
    if not brush.width_follows_depth():
        return 0  # the drawn width is not asked of such a brush
    least, greatest = brush.half_width_range_mm()
    return sum(not least - 1e-9 <= half_width <= greatest + 1e-9 for _, half_width in stroke.half_width)


def width_error(line: np.ndarray, predicted: list, wanted: list) -> float | None:
    """Mean absolute difference [mm] of two marks' widths, both measured across the middle line.

    line: (n, 4) rows x, y, arc length, half width. Places where the wanted mark is not as wide as the line
    says (its ends, where it crosses or touches itself) tell nothing of the brush's width and are left out.
    None when nothing is left.
    """
    length_mm = line[-1, 2]
    if length_mm <= 0:
        return None
    at_mm = (np.arange(max(1, round(length_mm / SAMPLE_SPACING_MM))) + 0.5) * SAMPLE_SPACING_MM
    at_mm = at_mm[at_mm < length_mm]
    xy = np.column_stack([np.interp(at_mm, line[:, 2], line[:, k]) for k in (0, 1)])
    segment = np.clip(np.searchsorted(line[:, 2], at_mm, side="right") - 1, 0, len(line) - 2)
    along = np.diff(line[:, :2], axis=0)[segment]
    lengths = np.hypot(along[:, 0], along[:, 1])
    half_mm = np.interp(at_mm, line[:, 2], line[:, 3])
    usable = (lengths > 0) & (half_mm > 0)
    xy, half_mm = xy[usable], half_mm[usable]
    along = along[usable] / lengths[usable, None]
    wanted_mm = widths_across(xy, along, wanted, reach_mm=2 * half_mm)
    usable = np.abs(wanted_mm - 2 * half_mm) < 0.1 * half_mm + 0.05
    if not usable.any():
        return None
    predicted_mm = widths_across(xy[usable], along[usable], predicted, reach_mm=2 * half_mm[usable])
    return float(np.abs(predicted_mm - wanted_mm[usable]).mean())


def widths_across(xy: np.ndarray, along: np.ndarray, rings: list, reach_mm: np.ndarray) -> np.ndarray:
    """Width [mm] of filled rings across each line: of the piece that holds the point, else of the nearest one
    that begins within reach_mm of it, else 0. xy, along (unit directions of the line): (n, 2)."""
    widths = np.zeros(len(xy))
    rings = [ring for ring in rings if len(ring) >= 3]
    if not rings:
        return widths
    tails = np.vstack(rings)
    heads = np.vstack([np.roll(ring, -1, axis=0) for ring in rings])
    for first in range(0, len(xy), 256):  # bounds the memory, nothing else
        part = slice(first, first + 256)
        widths[part] = _widths(xy[part], along[part], tails, heads, reach_mm[part])
    return widths


def _widths(xy, along, tails, heads, reach_mm) -> np.ndarray:
    def seen_from(points):  # ahead of the sample along the line, and to its left, (samples, edges)
        x = points[None, :, 0] - xy[:, None, 0]
        y = points[None, :, 1] - xy[:, None, 1]
        return along[:, :1] * x + along[:, 1:] * y, along[:, :1] * y - along[:, 1:] * x

    (ahead0, left0), (ahead1, left1) = seen_from(tails), seen_from(heads)
    crosses = (ahead0 > 0) != (ahead1 > 0)
    run = np.where(crosses, ahead0 - ahead1, 1.0)
    at = np.where(crosses, left0 + (left1 - left0) * ahead0 / run, np.inf)
    at = np.sort(at, axis=1)[:, : max(2, int(crosses.sum(axis=1).max()))]
    low, high = at[:, 0:-1:2], at[:, 1::2]  # simple rings: every second crossing leaves the mark
    there = np.isfinite(high)
    low, high = np.where(there, low, 0.0), np.where(there, high, 0.0)
    away = np.where(there, np.maximum(np.maximum(low, -high), 0.0), np.inf)
    nearest = away.argmin(axis=1)[:, None]
    width = np.take_along_axis(high - low, nearest, axis=1)[:, 0]
    return np.where(np.take_along_axis(away, nearest, axis=1)[:, 0] <= reach_mm, width, 0.0)


def to_json(report: Report) -> str:
    """Lengths to 1e-6 mm, so that the same input gives the same bytes."""

    def figures(row: Figures, sure) -> dict:
        told = {key: round(v, 6) if isinstance(v, float) else v for key, v in asdict(row).items()}
        if sure is not None:
            known = {key: None if v is None else round(v, 6) for key, v in asdict(sure).items()}
            told["uncertainty_95"] = known
        return told

    sure = report.sure
    sures = [None] * len(report.strokes) if sure is None else sure.strokes

    return (
        json.dumps(
            {
                "format": "brushsvg/report",
                "version": 1,
                "title": report.title,
                "brush": report.brush,
                "compensation": report.compensation,
                "tolerance_mm": report.tolerance_mm,
                "time_s": round(report.time_s, 3),
                "uncertainty_from": None if sure is None else sure.source,
                "total": figures(report.total, None if sure is None else sure.total),
                "strokes": [figures(*pair) for pair in zip(report.strokes, sures, strict=True)],
                "warnings": [{"where": where, "sentence": sentence} for where, sentence in report.warnings],
                "refused": [{"where": where, "sentence": sentence} for where, sentence in report.refused],
            },
            indent=1,
            ensure_ascii=False,
        )
        + "\n"
    )


def to_text(report: Report) -> str:
    """A table of strokes, the sum, the time, the warnings."""
    rows = [*report.strokes, report.total]
    columns = [
        ("stroke", [_short(row.stroke) for row in rows]),
        ("overlap", [_figure(row.overlap, 3) for row in rows]),
        ("centre mean", [_figure(row.centre_mean_mm, 3) for row in rows]),
        ("largest", [_figure(row.centre_largest_mm, 3) for row in rows]),
        ("width error", [_figure(row.width_error_mm, 3) for row in rows]),
        ("out of reach", [_figure(row.widths_out_of_reach, 0) for row in rows]),
        ("drawn", [_figure(row.drawn_mm, 1) for row in rows]),
        ("painted", [_figure(row.painted_mm, 1) for row in rows]),
        ("poses", [str(row.poses) for row in rows]),
        *_sure_columns(report.sure),
    ]
    table = _table(columns)
    rule = "-" * len(table[0])
    how = f", compensation {report.compensation}" if report.compensation else ""
    how += f", tolerance {report.tolerance_mm:g} mm" if report.tolerance_mm is not None else ""
    count = len(report.strokes)
    lines = [
        f"{report.title or 'untitled'}: {count} stroke{'s' * (count != 1)}, brush {report.brush}{how}",
        "",
        *table[:-1],
        rule,
        table[-1],
        "",
        "Lengths in mm. Overlap: common area over joint area of predicted and wanted mark. Centre: distance",
        "of the widest point from the middle line. Painted: path of the TCP on the paper.",
        *_sure_words(report.sure),
        f"Time, with the acceleration of the machine: {clock(report.time_s)}",
    ]
    if report.refused:
        lines += ["", f"Left out, since they cannot be painted: {len(report.refused)}"]
        lines += ["  " + ": ".join(refusal) for refusal in report.refused]
    if report.warnings:
        lines += ["", f"Warnings: {len(report.warnings)}"]
        lines += ["  " + ": ".join(filter(None, warning)) for warning in report.warnings]
    return "\n".join([*lines, ""])


def _sure_columns(sure: Uncertainty | None) -> list[tuple[str, list[str]]]:
    if sure is None:
        return []
    rows = [*sure.strokes, sure.total]
    return [
        ("middle +-", [_figure(row.middle_mm, 2) for row in rows]),
        ("ends +-", [_figure(row.ends_mm, 2) for row in rows]),
        ("width +-", [_figure(row.width_mm, 2) for row in rows]),
    ]


def _sure_words(sure: Uncertainty | None) -> list[str]:
    if sure is None:
        return ["How far the paint may lie off nobody can say: the brush has neither covariance nor RMSE."]
    return [
        "+-: how far the mark's middle may lie off across, its tip along the line, and its width;",
        f"{sure.words}.",
    ]


def comparison_text(rows: list[tuple[str, Figures]]) -> str:
    """A table of several ways to paint the same drawing: (how, its figures in all)."""
    table = _table(
        [
            ("compensation", [how for how, _ in rows]),
            ("overlap", [_figure(total.overlap, 3) for _, total in rows]),
            ("centre mean", [_figure(total.centre_mean_mm, 3) for _, total in rows]),
            ("largest", [_figure(total.centre_largest_mm, 3) for _, total in rows]),
        ]
    )
    heading = "Compensations compared; distances of the widest point from the middle line in mm:"
    return "\n".join([heading, "", table[0], "-" * len(table[0]), *table[1:], ""])


def _table(columns: list[tuple[str, list[str]]]) -> list[str]:
    """Lines of a table, the names first; the first column is flush left, the others flush right."""
    widths = [max(len(cell) for cell in (name, *cells)) for name, cells in columns]
    lines = []
    for name, *values in zip(*((name, *cells) for name, cells in columns), strict=True):
        padded = [value.rjust(width) for value, width in zip(values, widths[1:], strict=True)]
        lines.append("  ".join([name.ljust(widths[0]), *padded]))
    return lines


def _figure(value, decimals: int) -> str:
    return "-" if value is None else f"{value:.{decimals}f}"


def _short(name: str) -> str:
    return name if len(name) <= 24 else name[:21] + "..."


def clock(seconds: float) -> str:
    """A time for people."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return (
        f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
    )
