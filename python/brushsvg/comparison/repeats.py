"""Measure how well a studio repeats strokes, on several sheets or on one."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import _core, json_fields
from ..errors import Error, name_file_in_errors
from ..files import read_bytes
from ..geometry.polylines import evenly
from ..reporting.report_text import Report, plural, table, verdict
from .corrections import MIN_MARKS
from .next_corrections import MAX_MISSING_FOR_PLACE, displacement_mm
from .photographs import Comparison

FORMAT = "brushsvg/repeatability"
# Deviation of the paths of two copies of a stroke, which differ by the simplification of their poses.
MAX_COPY_DEVIATION_MM = 0.2
PATH_PLACES = 65  # number of places at which paths are compared
MIN_DEGREES_OF_FREEDOM = 4  # degrees of freedom of a spread: with fewer it is almost unknown
MIN_SPREAD_MM = 1e-9  # spread below which photographs show the same sheet: no two sheets repeat so well
BIN_SHARE = 0.25  # width of a column of the histogram, as a share of the spread
MAX_BAR_LENGTH = 40
MAX_GOOD_DISPLACEMENT_MM = 0.1  # displacement that costs 0.06 of the overlap of a line of 3 mm
MAX_WORST_STROKES = 5


@dataclass(frozen=True)
class Spread:
    """The spread of a stroke, or of the copies of one.

    count: number of marks that were seen; mean_mm: mean displacement beyond the sheet's place; spread_mm: rms distance
    from the mean, in x and y together, divided by the square root of two; farthest_mm: largest distance from the mean;
    wider_mm: standard deviation of the width of each edge.
    """

    stroke: str
    count: int
    mean_mm: tuple[float, float]
    spread_mm: float
    farthest_mm: float
    wider_mm: float


@dataclass(frozen=True)
class Approach:
    """The hysteresis of an axis, by the direction of approach to strokes.

    value_mm: how much further along the axis strokes are that are approached in its positive direction than those
    approached in its negative one; half_mm: half its 95 % interval. Both are None where there are too few strokes of
    either kind. plus_mm, minus_mm: mean place of each stroke along the axis, by direction of approach.
    """

    axis: str
    value_mm: float | None
    half_mm: float | None
    plus_mm: np.ndarray
    minus_mm: np.ndarray


@dataclass(frozen=True)
class Repeats:
    """How well the same strokes repeat.

    displacement_mm: standard deviation, in x and in y, of the place of the same stroke, with the 95 % interval from
    low_mm to high_mm; away_mm: (n,) distance of each mark from its mean; over_sheets: whether the spread is over
    several sheets. Otherwise it is over copies on one sheet, whose different places add to the spread. once: strokes
    that were seen once or not at all, which have no figures.
    """

    rows: tuple[Spread, ...]
    displacement_mm: float
    low_mm: float
    high_mm: float
    away_mm: np.ndarray
    approaches: tuple[Approach, ...]
    sheets: int
    over_sheets: bool
    once: tuple[str, ...] = ()


def measure_repeats(plan, files: Sequence[str], sheets: Sequence[Comparison]) -> Repeats:
    """Measure the repeatability over sheets, or over copies on one sheet.

    files: the photograph of each sheet, for errors. sheets: comparisons of sheets that were painted with the same plan.
    Raises Error where nothing was painted twice.
    """
    places = []
    for file, found in zip(files, sheets, strict=True):
        with name_file_in_errors(file):
            places.append(_places_by_stroke(found))
    names = [a_pass.stroke for a_pass in plan.passes]
    over_sheets = len(sheets) > 1
    groups = [[name] for name in names] if over_sheets else _group_copies(plan)
    rows, once, away, squares, mark_count, group_count = [], [], [], 0.0, 0, 0
    for group in groups:
        values = [each[name] for each in places for name in group if name in each]
        if len(values) < 2:
            once += group
            continue
        at = np.array([value[:2] for value in values])
        off = at - at.mean(axis=0)
        distances_mm = np.hypot(*off.T)
        widths_mm = np.array([value[2] for value in values])
        count = len(values)
        rows.append(
            Spread(
                group[0],
                count,
                tuple(at.mean(axis=0).tolist()),
                math.sqrt(float(np.square(off).sum()) / (2 * (count - 1))),
                float(distances_mm.max()),
                float(widths_mm.std(ddof=1)),
            )
        )
        away.append(distances_mm)
        squares += float(np.square(off).sum())
        mark_count += count
        group_count += 1
    # Each group costs the two coordinates of its mean, and each sheet but one costs a shift and a turn.
    freedom = 2 * (mark_count - group_count) - 3 * (len(sheets) - 1)
    if freedom < MIN_DEGREES_OF_FREEDOM:
        where = "on these sheets" if over_sheets else "as copies on this sheet"
        sentence = (
            f"too few strokes are seen more than once {where}: {mark_count} marks of {group_count} strokes do not "
            "show how well strokes repeat"
        )
        raise Error(sentence, code="too-few-repeats")
    sigma = math.sqrt(squares / freedom)
    if sigma < MIN_SPREAD_MM:
        sentence = "all marks are exactly equal: give photographs of two sheets, not two photographs of one sheet"
        raise Error(sentence, code="too-few-repeats")
    low, high = (sigma * math.sqrt(freedom / _chi_square_quantile(freedom, side)) for side in (1.96, -1.96))
    approaches = tuple(_measure_hysteresis(plan, places, axis) for axis in (0, 1))
    return Repeats(
        tuple(rows), sigma, low, high, np.concatenate(away), approaches, len(sheets), over_sheets, tuple(once)
    )


def _places_by_stroke(found: Comparison) -> dict[str, tuple[float, float, float]]:
    """Return, by stroke, its place beyond the sheet's pose and its excess width.

    The place is x and y [mm] in the sheet's own directions; the excess width of an edge is in mm as well. Raises Error
    where too few marks are found to determine the pose of the sheet.
    """
    if found.spread_mm is None:
        sentence = f"fewer than {MIN_MARKS} marks are found, too few to determine the position of the sheet"
        raise Error(sentence, code="marks-missing")
    return {
        row.stroke: (*displacement_mm(row, found).tolist(), row.placed.wider_mm)
        for row in found.strokes
        if row.placed.found and row.missing <= MAX_MISSING_FOR_PLACE
    }


def _group_copies(plan) -> list[list[str]]:
    """Return groups of names of strokes that are the same except for their place."""
    groups: list[tuple[np.ndarray, list[str]]] = []
    for a_pass in plan.passes:
        way = _path_from_start(np.array(a_pass.poses_mm))
        for known, names in groups:
            if np.abs(known - way).max() < MAX_COPY_DEVIATION_MM:
                names.append(a_pass.stroke)
                break
        else:
            groups.append((way, [a_pass.stroke]))
    return [names for _, names in groups]


def _path_from_start(poses_mm: np.ndarray) -> np.ndarray:
    """Return places (n, 3) at equal lengths along a path, with x and y relative to its beginning."""
    way = evenly(poses_mm, PATH_PLACES)
    way[:, :2] -= poses_mm[0, :2]
    return way


def _measure_hysteresis(plan, places, axis: int) -> Approach:
    """Return the hysteresis of an axis; strokes are approached from the end of the stroke before."""
    ways: dict[bool, list[float]] = {True: [], False: []}
    for before, a_pass in zip(plan.passes[:-1], plan.passes[1:], strict=True):
        way = a_pass.poses_mm[0][axis] - before.poses_mm[-1][axis]
        values = [each[a_pass.stroke][axis] for each in places if a_pass.stroke in each]
        if values and abs(way) > 1.0:
            ways[way > 0].append(float(np.mean(values)))
    name = "xy"[axis]
    up, down = (np.array(ways[side]) for side in (True, False))
    if min(len(up), len(down)) < 2:
        return Approach(name, None, None, up, down)
    freedom = len(up) + len(down) - 2
    within = (np.square(up - up.mean()).sum() + np.square(down - down.mean()).sum()) / freedom
    half = _core.interval_factor_95(freedom) * math.sqrt(within * (1 / len(up) + 1 / len(down)))
    return Approach(name, float(up.mean() - down.mean()), float(half), up, down)


def _chi_square_quantile(freedom: int, deviate: float) -> float:
    """Return the chi-square quantile at a normal deviate, as Wilson and Hilferty approximate it."""
    part = 2.0 / (9.0 * freedom)
    return freedom * max(1.0 - part + deviate * math.sqrt(part), 0.05) ** 3


def histogram(found: Repeats) -> list[tuple[float, int]]:
    """Return the upper edge [mm] of each bin, and the number of displacements in it."""
    edges, counts = bins_of(found)
    return list(zip(edges[1:].tolist(), counts.tolist(), strict=True))


def bins_of(found: Repeats) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges of bins [mm], and the number of displacements in each bin.

    The edges (n + 1,) start at 0; the numbers are (n,).
    """
    step = max(0.01, round(BIN_SHARE * float(np.quantile(found.away_mm, 0.9)), 2))
    edges = np.arange(math.ceil(float(found.away_mm.max()) / step) + 1) * step
    return edges, np.histogram(found.away_mm, np.concatenate([[0.0], edges[1:] + 1e-9]))[0]


def report(title: str, found: Repeats) -> Report:
    """Return the report of `brushsvg compare --sheets`.

    The verdict is good if strokes repeat to 0.1 mm and every stroke was seen twice.
    """
    count = len(found.once)
    reservations = [
        f"strokes repeat only to {found.displacement_mm:.2f} mm"
        if found.displacement_mm >= MAX_GOOD_DISPLACEMENT_MM
        else "",
        f"{plural(count, 'stroke')} {'was' if count == 1 else 'were'} not seen twice" if count else "",
    ]
    over = f"{found.sheets} sheets" if found.over_sheets else "copies on one sheet"
    worst = sorted(found.rows, key=lambda row: -row.spread_mm)[:MAX_WORST_STROKES]
    lines = [
        f"{title}: {plural(len(found.rows), 'stroke')} on {over}. Repetitions of one stroke are displaced by "
        f"{found.displacement_mm:.3f} mm in x and in y (standard deviation, 95 % interval {found.low_mm:.3f} to "
        f"{found.high_mm:.3f}){'' if found.over_sheets else '. This includes errors that depend on the place'}",
        *(
            f"{row.stroke} repeats to {row.spread_mm:.3f} mm (standard deviation), at most {row.farthest_mm:.2f} mm "
            "from its mean"
            for row in worst
        ),
        *(_describe_hysteresis(approach) for approach in found.approaches),
    ]
    if count:
        why = f"a mark was not found or lacks more than {100 * MAX_MISSING_FOR_PLACE:g} % of its paint"
        lines.append(f"{plural(count, 'stroke')} not seen twice, because {why}: {', '.join(found.once)}.")
    return Report(verdict([], reservations), tuple(lines), tuple(_detail_lines(found)))


def _detail_lines(found: Repeats) -> list[str]:
    head = ("stroke", "seen", "mean x", "mean y", "spread", "farthest", "wider")
    rows = []
    for row in found.rows:
        x, y = row.mean_mm
        figures = (
            f"{x:+.2f}",
            f"{y:+.2f}",
            f"{row.spread_mm:.3f}",
            f"{row.farthest_mm:.2f}",
            f"{row.wider_mm:.3f}",
        )
        rows.append((row.stroke, str(row.count), *figures))
    lines = table(head, rows)
    lines += ["", "Number of marks by their distance from the mean of their stroke, mm:"]
    bins = histogram(found)
    most, before = max(count for _, count in bins), 0.0
    for edge, count in bins:
        lines.append(f"  {before:5.2f} to {edge:5.2f}  {count:4d}  {'#' * round(MAX_BAR_LENGTH * count / most)}")
        before = edge
    return [
        *lines,
        "",
        "Mean, spread, farthest: displacement relative to the sheet in mm. Spread: standard deviation in x and in y.",
        "Wider: standard deviation of the place of an edge in mm.",
    ]


def _describe_hysteresis(approach: Approach) -> str:
    if approach.value_mm is None:
        return f"Hysteresis in {approach.axis}: unknown, because too few strokes are approached from both sides."
    certain = "" if abs(approach.value_mm) > approach.half_mm else ", which may be chance"
    return (
        f"Hysteresis in {approach.axis}: {approach.value_mm:+.3f} +- {approach.half_mm:.3f} mm between strokes that "
        f"are approached in the direction +{approach.axis} and -{approach.axis}{certain}."
    )


def as_json(title: str, found: Repeats) -> str:
    content = {
        "format": FORMAT,
        "version": 1,
        "title": title,
        "sheets": found.sheets,
        "displacement_mm": round(found.displacement_mm, 4),
        "displacement_95_mm": [round(found.low_mm, 4), round(found.high_mm, 4)],
        "hysteresis_mm": {
            approach.axis: None
            if approach.value_mm is None
            else [round(approach.value_mm, 4), round(approach.half_mm, 4)]
            for approach in found.approaches
        },
        "not_seen_twice": list(found.once),
        "histogram": [{"to_mm": round(edge, 4), "count": count} for edge, count in histogram(found)],
        "strokes": [
            {
                "stroke": row.stroke,
                "seen": row.count,
                "mean_mm": [round(value, 4) for value in row.mean_mm],
                "spread_mm": round(row.spread_mm, 4),
                "farthest_mm": round(row.farthest_mm, 4),
                "wider_mm": round(row.wider_mm, 4),
            }
            for row in found.rows
        ],
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def read_displacement_mm(path: str) -> float:
    """Read the standard deviation [mm] from a file that `compare --sheets` wrote.

    Raises Error with the file and the key.
    """
    with name_file_in_errors(path):
        content = json_fields.document(read_bytes(path), FORMAT)
        return json_fields.number(content.get("displacement_mm"), "displacement_mm", 1e-3, 10.0)
