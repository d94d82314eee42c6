"""Report how well a plan paints the drawing, in mm: per stroke and in total, as text, JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields

from ...errors import Notice
from ...notice_summary import summarize_notices
from ...reporting import report_text
from ...reporting.report_text import format_overlap, percent, plural, table
from ...units import clock
from .figures import Figures, Group, Worst
from .places import Place
from .uncertainty import Confidence, PlanConfidence
from .verdict import verdict_of


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
    """Return the first notice, with "..." for others, which are all in the details."""
    first, *others = summarize_notices(notices)
    return ": ".join(filter(None, (first.where, first.text))) + (" ..." if others else "")


def _details(report: Report) -> list[str]:
    """Return the lines of the details. The details are tables of all strokes, all strokes left out and all warnings."""
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
    """Return a table of several ways to paint the same drawing. rows: (compensation, total figures)."""
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
    """Return several other_brushes.BrushRating as JSON, in their order. Overlaps are rounded to 1e-6."""
    rows = [_round_floats(asdict(suit)) for suit in suits]
    document = {"format": "brushsvg/brushes", "version": 1, "title": title, "brushes": rows}
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def brushes_text(title: str, suits) -> str:
    """Return a table of brushes that were tried on a drawing, see other_brushes.BrushRating."""
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
