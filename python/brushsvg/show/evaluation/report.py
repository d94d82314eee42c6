"""Report how well a plan paints the drawing, in mm: per stroke and in total, as text, JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Protocol

import numpy as np

from ... import _core
from ...errors import Notice
from ...geometry.polylines import length
from ...reporting import report_text
from ...reporting.report_text import format_overlap, percent, plural, table
from ...text_summary import summarize_notices
from ...units import clock
from .error_causes import Cause, cause
from .places import Place, find_places
from .uncertainty import Confidence, PlanConfidence
from .verdict import verdict_of

RING_TOLERANCE_MM = 0.01
MIN_DIFFERENCE_MM2 = 0.005  # a smaller difference is not reported
_MIN_SQUARE_MM = 0.5  # smallest side of the square in which paint and drawing differ most, see stroke_score
_MIN_BARE_SHARE = 0.1  # of this square: a smaller area that no stroke reaches does not explain the difference


@dataclass(frozen=True)
class Figures:
    """The figures of one stroke, or of all strokes together.

    None means that the drawing is not known, or that nothing could be measured.

    overlap: area of intersection over area of union of predicted and drawn mark.
    centre_mean_mm, centre_largest_mm: distance of the widest point from the middle line over taut rows.
    width_error_mm: mean absolute difference of predicted and drawn width across the middle line.
    widths_out_of_reach: number of the stroke's half widths that the brush cannot paint.
    excess_turning: how much more the mark's outline turns than the drawn one's, in full turns; the mean over all.
    drawn_mm, painted_mm: length of the middle line, and of the TCP's path on the paper.
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
    worst: Worst | None = None
    excess_turning: float | None = None


@dataclass(frozen=True)
class Worst:
    """The place where a stroke's paint differs most from the drawing.

    place_mm: (x, y); is_missing: drawn but not painted, else painted but not drawn; area_mm2: area of the difference
    near this place; reason: the cause in words; code: see error_causes.
    """

    place_mm: tuple[float, float]
    is_missing: bool
    area_mm2: float
    reason: str
    code: str = ""


@dataclass(frozen=True)
class Group:
    """Strokes that touch or cross, for example a letter.

    overlap: of all their paint with everything drawn of them, so that paint of one stroke on another is no error.
    """

    strokes: tuple[str, ...]
    overlap: float


@dataclass(frozen=True)
class Report:
    """Everything that is known about the paint of a plan.

    assumed: the properties of the brush that were never measured, in words; places: the worst places, with the numbers
    of the overlap picture.
    """

    title: str
    brush: str
    compensation: str
    tolerance_mm: float | None
    strokes: tuple[Figures, ...]
    total: Figures
    time_s: float
    warnings: tuple[Notice, ...] = ()
    refused: tuple[Notice, ...] = ()  # strokes that were left out
    forbidden: tuple[Notice, ...] = ()  # warnings for which no program would be written
    confidence: PlanConfidence | None = None  # None: the brush has no confidence
    is_tilted: bool = False  # the brush tilts somewhere, for which no confidence is known
    groups: tuple[Group, ...] = ()
    advice: str = ""  # on the drawing's size
    assumed: tuple[str, ...] = ()  # laws that were never measured
    without_interval: tuple[str, ...] = ()  # laws that were measured, but without a confidence interval
    places: tuple[Place, ...] = ()

    @property
    def verdict(self) -> str:
        """One line: "good", "usable, but ..." or "do not use, because ..."."""
        return verdict_of(self)


class Bare(Protocol):
    """A piece of an element's shape that no stroke reaches.

    rings: its outlines [mm]; is_rim: it belongs to a stroke that is wider than the brush.
    """

    @property
    def element(self) -> str: ...
    @property
    def rings(self) -> list[np.ndarray]: ...
    @property
    def is_rim(self) -> bool: ...


def target_rings(strokes: Iterable[_core.Stroke]) -> list[np.ndarray]:
    """Return the outline of everything that was drawn."""
    return _core.unite([ring for s in strokes for ring in _core.target_outline(s, RING_TOLERANCE_MM)])


@dataclass(frozen=True)
class PaintedPlan:
    """A plan with its marks and its drawing.

    strokes: one per pass, or None if they are unknown; a pass that is a part of a stroke has None; drawn: everything
    that was drawn, None where it equals the strokes; unreached: pieces of shapes that no stroke reaches.
    """

    plan: _core.Plan
    marks: _core.Marks
    brush: _core.Brush
    strokes: Sequence[_core.Stroke | None] | None = None
    tolerance_mm: float = 0.05
    drawn: Sequence[_core.Stroke] | None = None
    compensation: str = "closed"
    unreached: Sequence[Bare] = ()

    def target(self) -> list[_core.Stroke] | None:
        """Return everything that the plan should paint, None if a pass paints an unknown part of a stroke."""
        if self.drawn is not None:
            return list(self.drawn)
        return None if self.strokes is None or None in self.strokes else list(self.strokes)


def measure(painted: PaintedPlan) -> tuple[tuple[Figures, ...], Figures]:
    """Return the figures of each pass, and of all passes together."""
    plan, strokes, brush = painted.plan, painted.strokes, painted.brush
    if strokes is None:
        rows = tuple(_path_figures(a_pass) for a_pass in plan.passes)
        return rows, _total_figures(rows, None)
    passes, traces = plan.passes, painted.marks.passes
    known_passes = [k for k, stroke in enumerate(strokes) if stroke is not None]
    known_strokes = [strokes[k] for k in known_passes]
    stroke_scores = _core.score_strokes([traces[k] for k in known_passes], known_strokes, brush)
    tracking_errors = _core.tracking_errors_of(
        [passes[k] for k in known_passes], known_strokes, brush, painted.tolerance_mm
    )
    measured = iter(zip(stroke_scores, tracking_errors, strict=True))
    rows = tuple(
        _path_figures(a_pass) if stroke is None else _stroke_figures(painted, a_pass, stroke, *next(measured))
        for a_pass, stroke in zip(passes, strokes, strict=True)
    )
    target = painted.target()
    overlap = _core.common_area(traces, target, brush).overlap if rows and target is not None else None
    return rows, _total_figures(rows, overlap)


def _stroke_figures(painted: PaintedPlan, a_pass, stroke, verdict, tracking_error) -> Figures:
    line = _core.flatten(stroke, RING_TOLERANCE_MM)
    worst, place = None, verdict.worst
    if place.area_mm2 >= MIN_DIFFERENCE_MM2:
        size_mm = _square_side_mm(line)
        why = _find_cause(painted, stroke, line, place, size_mm, tracking_error)
        worst = Worst(tuple(place.at_mm), place.is_missing, place.area_mm2, why.words, why.code)
    return replace(
        _path_figures(a_pass),
        overlap=verdict.overlap,
        centre_mean_mm=tracking_error.mean_mm,
        centre_largest_mm=tracking_error.largest_mm,
        width_error_mm=verdict.width_error_mm,
        excess_turning=verdict.excess_turning,
        widths_out_of_reach=_out_of_reach(stroke, painted.brush),
        drawn_mm=float(line[-1, 2]),
        worst=worst,
    )


def worst_places(painted: PaintedPlan) -> tuple[Place, ...]:
    """Return the places where paint differs most from the drawing.

    The largest difference comes first. There are none if the target of the plan is unknown.
    """
    pairs = zip(painted.plan.passes, painted.strokes or (), strict=bool(painted.strokes))
    whole = {stroke.id: (run, stroke) for run, stroke in pairs if stroke is not None}

    def why(name: str, area) -> tuple[Cause, float | None]:
        if name not in whole:
            return Cause("", ""), None
        run, stroke = whole[name]
        (error,) = _core.tracking_errors_of([run], [stroke], painted.brush, painted.tolerance_mm)
        line = _core.flatten(stroke, RING_TOLERANCE_MM)
        size_mm = max(_square_side_mm(line), area.area_mm2**0.5)
        found_cause = _find_cause(painted, stroke, line, area, size_mm, error)
        is_off = not (stroke.target_mm or error.within_tolerance or "tracking error" in found_cause.words)
        return found_cause, error.largest_mm if is_off else None

    return find_places(painted.marks, painted.brush, painted.target() or [], why)


def _square_side_mm(line: np.ndarray) -> float:
    return max(_MIN_SQUARE_MM, float(np.median(line[:, 3])))


def _find_cause(painted: PaintedPlan, stroke, line, place, size_mm, tracking_error) -> Cause:
    """Find why paint differs at a place.

    size_mm: side of the square around the place that is examined.
    """
    pieces_here = [
        piece
        for piece in painted.unreached
        if piece.element == stroke.origin.element and _is_near_rings(place.at_mm, piece.rings, size_mm / 2)
    ]
    is_bare = place.is_missing and any(not piece.is_rim for piece in pieces_here)
    is_rim = place.is_missing and bool(pieces_here)
    is_corner = place.is_missing and _outside_discs_mm2(stroke, place.at_mm, size_mm) > place.area_mm2 / 2
    where = "bare" if is_bare else "rim" if is_rim else "corner" if is_corner else ""
    return cause(
        stroke,
        line,
        painted.brush,
        place,
        size_mm,
        where,
        tracking_error,
        painted.tolerance_mm,
        painted.compensation,
    )


def _is_near_rings(place_mm, rings, reach_mm: float) -> bool:
    """Return whether rings enclose enough of a square around a place.

    The limit is _MIN_BARE_SHARE of the square.
    """
    return (
        _core.area(_core.intersect([_square_ring(place_mm, reach_mm)], rings)) > _MIN_BARE_SHARE * (2 * reach_mm) ** 2
    )


def _outside_discs_mm2(stroke, place_mm, size_mm: float) -> float:
    """Return the area of a shape near a place that discs do not cover.

    The discs have the widths of the stroke. A round brush cannot paint there. The square is around place_mm, with side
    size_mm.
    """
    if not stroke.target_mm:
        return 0.0
    within = _core.intersect([_square_ring(place_mm, size_mm / 2)], stroke.target_mm)
    discs = _core.target_outline(stroke.replaced(target_mm=[]), RING_TOLERANCE_MM)
    return _core.area(within) - _core.area(_core.intersect(within, discs))


def _square_ring(place_mm, reach_mm: float) -> np.ndarray:
    x, y = place_mm
    sides = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.array([(x + reach_mm * right, y + reach_mm * up) for right, up in sides])


def groups(marks: _core.Marks, brush: _core.Brush, strokes: Sequence[_core.Stroke] | None) -> tuple[Group, ...]:
    """Return groups of strokes that touch, so that each letter is judged as a whole.

    strokes: one per pass, None for a pass that is a part of a stroke.
    """
    known_pairs = [pair for pair in zip(marks.passes, strokes or (), strict=bool(strokes)) if pair[1] is not None]
    traces, targets = [trace for trace, _ in known_pairs], [stroke for _, stroke in known_pairs]
    touching = _core.group_touching(targets)
    areas = _core.common_areas(traces, targets, touching, brush)
    return tuple(
        Group(tuple(targets[k].id for k in members), area.overlap)
        for members, area in zip(touching, areas, strict=True)
    )


def _path_figures(a_pass) -> Figures:
    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    painted_mm = length(poses)
    return Figures(a_pass.stroke, None, None, None, None, None, None, painted_mm, len(poses))


def _total_figures(rows: tuple[Figures, ...], overlap: float | None) -> Figures:
    def combine_known(name, combine):
        values = [(getattr(row, name), row.drawn_mm or 0.0) for row in rows if getattr(row, name) is not None]
        return combine(*zip(*values, strict=True)) if values else None

    def mean(values, weights):
        return float(np.average(values, weights=weights)) if sum(weights) > 0 else float(np.mean(values))

    return Figures(
        stroke="all",
        overlap=overlap,
        centre_mean_mm=combine_known("centre_mean_mm", mean),
        centre_largest_mm=combine_known("centre_largest_mm", lambda values, _: max(values)),
        width_error_mm=combine_known("width_error_mm", mean),
        excess_turning=combine_known("excess_turning", lambda values, _: float(np.mean(values))),
        widths_out_of_reach=combine_known("widths_out_of_reach", lambda values, _: sum(values)),
        drawn_mm=combine_known("drawn_mm", lambda values, _: sum(values)),
        painted_mm=sum(row.painted_mm for row in rows),
        poses=sum(row.poses for row in rows),
    )


def _out_of_reach(stroke, brush) -> int:
    if not brush.width_follows_depth():
        return 0  # such a brush cannot vary its width
    least, greatest = brush.half_width_range_mm()
    return sum(not least - 1e-9 <= half_width <= greatest + 1e-9 for _, half_width in stroke.half_width)


def _round_floats(value):
    if isinstance(value, dict):
        return {key: _round_floats(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return [_round_floats(each) for each in value]
    return round(value, 6) if isinstance(value, float) else value


def to_json(report: Report) -> str:
    """Return the report as JSON.

    Lengths are rounded to 1e-6 mm, so that the same input gives the same bytes.
    """

    def figures(row: Figures, confidence) -> dict:
        intervals_95 = {} if confidence is None else {"uncertainty_95": _round_floats(asdict(confidence))}
        return _round_floats(asdict(row)) | intervals_95

    confidence = report.confidence
    intervals = [None] * len(report.strokes) if confidence is None else confidence.strokes

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
                "uncertainty_from": None if confidence is None else confidence.source,
                "total": figures(report.total, None if confidence is None else confidence.total),
                "strokes": [figures(*pair) for pair in zip(report.strokes, intervals, strict=True)],
                "warnings": [notice.as_json() for notice in report.warnings],
                "refused": [notice.as_json() for notice in report.refused],
                "forbidden": [notice.as_json() for notice in report.forbidden],
                "groups": [
                    {"strokes": list(group.strokes), "overlap": round(group.overlap, 6)} for group in report.groups
                ],
                "advice": report.advice,
                "verdict": report.verdict,
                "places": [_round_floats(place.as_json()) for place in report.places],
            },
            indent=1,
            ensure_ascii=False,
        )
        + "\n"
    )


def as_text(kind: str, report: Report, details: bool = False, picture: str = "") -> str:
    """Return the report as JSON, CSV or text.

    kind: .json for JSON, .csv for a table of strokes, else text, see to_text.
    """
    if kind == ".json":
        return to_json(report)
    return to_csv(report) if kind == ".csv" else to_text(report, details, picture)


def to_csv(report: Report) -> str:
    """Return the report as CSV, one row per stroke.

    The columns are the keys of the JSON. Unknown values are empty cells.
    """
    plain = [column.name for column in fields(Figures) if column.name != "worst"]
    worst = [column.name for column in fields(Worst) if column.name != "place_mm"]
    interval_names = [column.name for column in fields(Confidence)] if report.confidence else []
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(
        [
            *plain,
            "worst_x_mm",
            "worst_y_mm",
            *(f"worst_{name}" for name in worst),
            *(f"{name}_95" for name in interval_names),
        ]
    )
    intervals = report.confidence.strokes if report.confidence else [None] * len(report.strokes)
    for row, interval in zip(report.strokes, intervals, strict=True):
        at = row.worst.place_mm if row.worst else ("", "")
        cells = [getattr(row, name) for name in plain]
        cells += [*at, *(getattr(row.worst, name, "") for name in worst)]
        rows.writerow([_round_floats(cell) for cell in (*cells, *(getattr(interval, name) for name in interval_names))])
    return out.getvalue()


def to_text(report: Report, details: bool = False, picture: str = "") -> str:
    """Return the report in at most ten lines.

    The lines show verdict, overlap, time, worst places and strokes left out. details: add tables of the strokes and of
    those that touch, and every warning; picture: the file that shows the numbers of the places, "" for none.
    """
    lines = [_summary_line(report), *(place.line for place in report.places)]
    if not report.places and report.total.overlap is not None:
        lines.append("Paint and drawing differ nowhere by more than 0.2 mm.")
    if report.refused:
        count = len(report.refused)
        lines.append(
            f"Left out: {_first_notice(report.refused)}"
            if count == 1
            else f"Left out: {count}, {_first_notice(report.refused)}"
        )
    if report.warnings:
        lines.append(f"{plural(len(report.warnings), 'warning')}: {_first_notice(report.warnings)}")
    if report.advice and len(lines) + 2 + bool(picture) <= report_text.MAX_LINES:
        lines.append(report.advice)
    return report_text.Report(report.verdict, tuple(lines), tuple(_details(report))).text(details, picture)


def _summary_line(report: Report) -> str:
    name, total = report.title or "untitled", report.total
    what = f"{plural(len(report.strokes), 'stroke')}"
    if total.overlap is not None:
        what = f"{percent(total.overlap)} of paint and drawing coincide (overlap {format_overlap(total.overlap)})"
    return f"{name}: {what}; painting takes {clock(report.time_s)}."


def _first_notice(notices: Iterable[Notice]) -> str:
    """Return the first notice as text.

    "..." stands for others, which are all in the details.
    """
    first, *others = summarize_notices(notices)
    return ": ".join(filter(None, (first.where, first.text))) + (" ..." if others else "")


def _details(report: Report) -> list[str]:
    """Return the lines of the details.

    The details are tables of all strokes, all strokes left out and all warnings.
    """
    rows = [*report.strokes, report.total]
    columns = [
        ("stroke", [_shorten(row.stroke) for row in rows]),
        ("overlap", [_format_overlap(row.overlap) for row in rows]),
        ("centre mean", [_format_figure(row.centre_mean_mm, 3) for row in rows]),
        ("largest", [_format_figure(row.centre_largest_mm, 3) for row in rows]),
        ("width error", [_format_figure(row.width_error_mm, 3) for row in rows]),
        ("turning", [_format_figure(row.excess_turning, 2) for row in rows]),
        ("out of reach", [_format_figure(row.widths_out_of_reach, 0) for row in rows]),
        ("drawn", [_format_figure(row.drawn_mm, 1) for row in rows]),
        ("painted", [_format_figure(row.painted_mm, 1) for row in rows]),
        ("poses", [str(row.poses) for row in rows]),
        *_confidence_columns(report.confidence),
    ]
    notes = ["differs most", *map(_describe_worst, rows)] if any(row.worst for row in rows) else []
    lines = _ruled_table(columns, notes)
    how = f", compensation {report.compensation}" if report.compensation else ""
    how += f", tolerance {report.tolerance_mm:g} mm" if report.tolerance_mm is not None else ""
    lines = [
        f"{report.title or 'untitled'}: {plural(len(report.strokes), 'stroke')}, brush {report.brush}{how}",
        "",
        *lines[:-1],
        lines[1],
        lines[-1],
        "",
        "Lengths in mm. Overlap: intersection over union of predicted mark and target mark. Centre: tracking",
        "error, the distance of the widest point from the middle line. Painted: path of the TCP on the paper.",
        "Turning: of the mark's outline beyond that of the target mark, in full turns.",
        *_confidence_words(report.confidence, report.is_tilted),
    ]
    if report.groups:
        names = [_shorten(" + ".join(group.strokes), 64) for group in report.groups]
        overlaps = [_format_overlap(group.overlap) for group in report.groups]
        lines += ["", "Strokes that touch, judged together:", ""]
        lines += table(("strokes", "overlap"), zip(names, overlaps, strict=True))
    if report.advice:
        lines += ["", report.advice]
    if report.refused:
        lines += ["", f"Left out, since they cannot be painted: {len(report.refused)}"]
        lines += ["  " + ": ".join((notice.where, notice.text)) for notice in report.refused]
    if report.warnings:
        lines += ["", f"Warnings: {len(report.warnings)}"]
        lines += ["  " + ": ".join(filter(None, (notice.where, notice.text))) for notice in report.warnings]
    return lines


def _ruled_table(columns: list[tuple[str, list[str]]], notes: Sequence[str] = ()) -> list[str]:
    """Return the lines of a table from its columns, with a rule below their names."""
    head, *rows = table([name for name, _ in columns], zip(*(cells for _, cells in columns), strict=True), notes)
    return [head, "-" * max(map(len, (head, *rows))), *rows]


def _confidence_columns(confidence: PlanConfidence | None) -> list[tuple[str, list[str]]]:
    if confidence is None:
        return []
    rows = [*confidence.strokes, confidence.total]
    return [
        ("middle +-", [_format_figure(row.middle_mm, 2) for row in rows]),
        ("ends +-", [_format_figure(row.ends_mm, 2) for row in rows]),
        ("width +-", [_format_figure(row.width_mm, 2) for row in rows]),
    ]


def _confidence_words(confidence: PlanConfidence | None, is_tilted: bool) -> list[str]:
    if is_tilted:
        return ["No confidence intervals: how sure a mark is is known of a brush held upright."]
    if confidence is None:
        return ["No confidence intervals: the brush has neither covariance nor RMSE."]
    return [
        "+-: half the confidence interval of the mark's middle across the line, of its ends along it, of its width,",
        f"{confidence.words}.",
    ]


def comparison_text(rows: list[tuple[str, Figures]]) -> str:
    """Return a table of several ways to paint the same drawing.

    rows: (compensation, total figures).
    """
    lines = _ruled_table(
        [
            ("compensation", [how for how, _ in rows]),
            ("overlap", [_format_overlap(total.overlap) for _, total in rows]),
            ("centre mean", [_format_figure(total.centre_mean_mm, 3) for _, total in rows]),
            ("largest", [_format_figure(total.centre_largest_mm, 3) for _, total in rows]),
        ]
    )
    heading = "Compensations compared; distances of the widest point from the middle line in mm:"
    return "\n".join([heading, "", *lines, ""])


def brushes_json(title: str, suits) -> str:
    """Return several other_brushes.Suit as JSON, in their order.

    Overlaps are rounded to 1e-6.
    """
    rows = [_round_floats(asdict(suit)) for suit in suits]
    document = {"format": "brushsvg/brushes", "version": 1, "title": title, "brushes": rows}
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def brushes_text(title: str, suits) -> str:
    """Return a table of brushes that were tried on a drawing, see other_brushes.Suit."""
    lines = _ruled_table(
        [
            ("brush", [suit.brush for suit in suits]),
            ("overlap", [_format_overlap(suit.overlap) for suit in suits]),
            ("worst stroke", [_shorten(suit.worst or "-") for suit in suits]),
            ("its overlap", [_format_overlap(suit.worst_overlap) for suit in suits]),
            ("refused", [f"{suit.refused} of {suit.strokes}" for suit in suits]),
        ],
        ["", *(_shorten(suit.why, 100) for suit in suits)],
    )
    heading = f"{title or 'untitled'}: which brush suits it; overlap of all that was drawn, refused strokes included"
    return "\n".join([heading, "", *lines, ""])


def _describe_worst(row: Figures) -> str:
    if row.worst is None:
        return ""
    x, y = row.worst.place_mm
    what = "not painted" if row.worst.is_missing else "too much paint"
    return f"x {x:.1f}, y {y:.1f}: {what}; {row.worst.reason}"


def _format_overlap(overlap: float | None) -> str:
    return _format_figure(None, 3) if overlap is None else format_overlap(overlap)


def _format_figure(value, decimals: int) -> str:
    return "-" if value is None else f"{value:.{decimals}f}"


def _shorten(name: str, most: int = 24) -> str:
    return name if len(name) <= most else name[: most - 3] + "..."
