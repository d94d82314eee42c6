"""How well a studio repeats: the same strokes on several sheets, or several times on one."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

import numpy as np

from .. import _core, json_fields
from ..errors import Error
from ..files import read_bytes
from ..geometry.polylines import evenly
from ..geometry.rotation import rotation
from ..reporting.report_text import Report, plural, table, verdict
from .corrections import LEAST_MARKS
from .next_corrections import UNSEEN
from .photographs import Comparison

FORMAT = "brushsvg/repeatability"
SAME_MM = (
    0.2  # copies of a stroke have the same way but for its place, and for the simplification of its poses
)
ALONG = 65  # places at which ways are compared
LEAST_FREEDOM = 4  # values to spare for a spread: fewer say next to nothing
ALIKE_MM = 1e-9  # no two sheets repeat so well
BIN_SHARE = 0.25  # width of a column of the histogram over the spread
BAR = 40
GOOD_MM = 0.1  # of a displacement: it costs 0.06 of the overlap of a line of 3 mm
MOST_WORST = 5


@dataclass(frozen=True)
class Spread:
    """A stroke, or copies of one: how many were seen, their mean displacement beyond the sheet's place, and how far
    they are from it: rms in x and y together over the square root of two, and the farthest; wider_mm: rms of how much
    wider they are than on average."""

    stroke: str
    count: int
    mean_mm: tuple[float, float]
    spread_mm: float
    farthest_mm: float
    wider_mm: float


@dataclass(frozen=True)
class Approach:
    """By how much strokes that begin in the positive direction of an axis are further along it than those that begin
    in the negative one, with half its 95 % interval; None where there are too few of either. plus_mm, minus_mm: mean
    place along the axis of each stroke, by that direction."""

    axis: str
    value_mm: float | None
    half_mm: float | None
    plus_mm: np.ndarray
    minus_mm: np.ndarray


@dataclass(frozen=True)
class Repeats:
    """displacement_mm: standard deviation in x and in y of the place of the same stroke, with its 95 % interval;
    away_mm: (n,) of each one, how far from its mean; over_sheets: else over copies on one, which their places
    move, too; once: strokes that were seen once or not at all, which have no figures."""

    rows: tuple[Spread, ...]
    displacement_mm: float
    low_mm: float
    high_mm: float
    away_mm: np.ndarray
    approaches: tuple[Approach, ...]
    sheets: int
    over_sheets: bool
    once: tuple[str, ...] = ()


def repeats(plan, sheets: list[Comparison]) -> Repeats:
    """sheets: comparisons of sheets that were painted by the same plan. Error where nothing was painted twice."""
    places = [_places(found) for found in sheets]
    names = [one.stroke for one in plan.passes]
    over_sheets = len(sheets) > 1
    groups = [[name] for name in names] if over_sheets else _copies(plan)
    rows, once, away, squares, seen, used = [], [], [], 0.0, 0, 0
    for group in groups:
        values = [each[name] for each in places for name in group if name in each]
        if len(values) < 2:
            once += group
            continue
        at = np.array([value[:2] for value in values])
        off = at - at.mean(axis=0)
        far = np.hypot(*off.T)
        wide = np.array([value[2] for value in values])
        count = len(values)
        rows.append(
            Spread(
                group[0],
                count,
                tuple(at.mean(axis=0).tolist()),
                math.sqrt(float(np.square(off).sum()) / (2 * (count - 1))),
                float(far.max()),
                float(wide.std(ddof=1)),
            )
        )
        away.append(far)
        squares += float(np.square(off).sum())
        seen += count
        used += 1
    # two means of each group, and of each sheet but one a shift and a turn
    freedom = 2 * (seen - used) - 3 * (len(sheets) - 1)
    if freedom < LEAST_FREEDOM:
        what = "on these sheets" if over_sheets else "on this sheet, where copies of a stroke are looked for"
        sentence = (
            f"too few strokes are seen more than once {what}: {seen} marks of {used} strokes show no spread"
        )
        raise Error(sentence, code="too-few-repeats")
    sigma = math.sqrt(squares / freedom)
    if sigma < ALIKE_MM:
        sentence = "marks are alike to the last digit: photographs of two sheets are needed, not of one twice"
        raise Error(sentence, code="too-few-repeats")
    low, high = (sigma * math.sqrt(freedom / _chi_square(freedom, side)) for side in (1.96, -1.96))
    approaches = tuple(_approach(plan, places, axis) for axis in (0, 1))
    return Repeats(
        tuple(rows), sigma, low, high, np.concatenate(away), approaches, len(sheets), over_sheets, tuple(once)
    )


def _places(found: Comparison) -> dict[str, tuple[float, float, float]]:
    """By stroke x and y beyond the sheet's place, in the sheet's own directions, and how much wider it is."""
    if found.spread_mm is None:
        sentence = (
            f"fewer than {LEAST_MARKS} of its marks are found, which do not determine the pose of the sheet"
        )
        raise Error(sentence, code="marks-missing")
    sheet, out = found.common, {}
    for row in found.strokes:
        if row.placed.found and row.missing <= UNSEEN:
            middle = np.array([row.middle_mm])
            beyond = middle + row.placed.shift_mm - sheet.moved(middle, found.middle_mm)
            x, y = (beyond @ rotation(-sheet.turn_rad))[0].tolist()
            out[row.stroke] = (x, y, row.placed.wider_mm)
    return out


def _copies(plan) -> list[list[str]]:
    """Names of strokes that are the same but for their place."""
    groups: list[tuple[np.ndarray, list[str]]] = []
    for one in plan.passes:
        way = _along(np.array(one.poses_mm))
        for known, names in groups:
            if np.abs(known - way).max() < SAME_MM:
                names.append(one.stroke)
                break
        else:
            groups.append((way, [one.stroke]))
    return [names for _, names in groups]


def _along(poses_mm: np.ndarray) -> np.ndarray:
    """(n, 3) from its beginning, at places that part the way into equal lengths."""
    way = evenly(poses_mm, ALONG)
    way[:, :2] -= poses_mm[0, :2]
    return way


def _approach(plan, places, axis: int) -> Approach:
    """The way to a stroke's beginning: from where the one before it ended."""
    ways: dict[bool, list[float]] = {True: [], False: []}
    for before, one in zip(plan.passes[:-1], plan.passes[1:], strict=True):
        way = one.poses_mm[0][axis] - before.poses_mm[-1][axis]
        values = [each[one.stroke][axis] for each in places if one.stroke in each]
        if values and abs(way) > 1.0:
            ways[way > 0].append(float(np.mean(values)))
    name = "xy"[axis]
    up, down = (np.array(ways[side]) for side in (True, False))
    if min(len(up), len(down)) < 2:
        return Approach(name, None, None, up, down)
    freedom = len(up) + len(down) - 2
    within = (np.square(up - up.mean()).sum() + np.square(down - down.mean()).sum()) / freedom
    half = _core.deviations_of_95(freedom) * math.sqrt(within * (1 / len(up) + 1 / len(down)))
    return Approach(name, float(up.mean() - down.mean()), float(half), up, down)


def _chi_square(freedom: int, deviate: float) -> float:
    """The quantile of a normal deviate (Wilson and Hilferty)."""
    part = 2.0 / (9.0 * freedom)
    return freedom * max(1.0 - part + deviate * math.sqrt(part), 0.05) ** 3


def histogram(found: Repeats) -> list[tuple[float, int]]:
    """Return (upper edge in mm, how many displacements are below it and above the one before)."""
    edges, counts = bins_of(found)
    return list(zip(edges[1:].tolist(), counts.tolist(), strict=True))


def bins_of(found: Repeats) -> tuple[np.ndarray, np.ndarray]:
    """Return edges (n + 1,) of bins in mm, from 0, and how many displacements (n,) are in each."""
    step = max(0.01, round(BIN_SHARE * float(np.quantile(found.away_mm, 0.9)), 2))
    edges = np.arange(math.ceil(float(found.away_mm.max()) / step) + 1) * step
    return edges, np.histogram(found.away_mm, np.concatenate([[0.0], edges[1:] + 1e-9]))[0]


def report(title: str, found: Repeats) -> Report:
    """What `brushsvg compare --sheets` prints. Good: a stroke repeats to 0.1 mm, and every stroke was seen twice."""
    count = len(found.once)
    but = [
        f"strokes repeat only to {found.displacement_mm:.2f} mm" if found.displacement_mm >= GOOD_MM else "",
        f"{plural(count, 'stroke')} {'was' if count == 1 else 'were'} not seen twice" if count else "",
    ]
    over = (
        f"{found.sheets} sheets" if found.over_sheets else "copies on one sheet, which their place moves, too"
    )
    worst = sorted(found.rows, key=lambda row: -row.spread_mm)[:MOST_WORST]
    lines = [
        f"{title}: {plural(len(found.rows), 'stroke')} on {over}: the same stroke is displaced by "
        f"{found.displacement_mm:.3f} mm in x and in y (standard deviation, 95 % interval {found.low_mm:.3f} to "
        f"{found.high_mm:.3f})",
        *(
            f"{row.stroke} spreads by {row.spread_mm:.3f} mm, {row.farthest_mm:.2f} mm at most"
            for row in worst
        ),
        *(_approach_words(one) for one in found.approaches),
    ]
    if count:
        why = f"not found, or more than {100 * UNSEEN:g} % of the mark without paint"
        lines.append(f"{plural(count, 'stroke')} not seen twice ({why}): {', '.join(found.once)}.")
    return Report(verdict([], but), tuple(lines), tuple(_details(found)))


def _details(found: Repeats) -> list[str]:
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
    lines += ["", "Distance of each from its mean, mm:"]
    bins = histogram(found)
    most, before = max(count for _, count in bins), 0.0
    for edge, count in bins:
        lines.append(f"  {before:5.2f} to {edge:5.2f}  {count:4d}  {'#' * round(BAR * count / most)}")
        before = edge
    return [
        *lines,
        "",
        "Mean, spread, farthest: displacement beyond the sheet's place, mm; spread in x and in y; wider: how far edges",
        "are from their mean (standard deviation, mm).",
    ]


def _approach_words(one: Approach) -> str:
    if one.value_mm is None:
        return f"Too few strokes are approached from either side in {one.axis} to show a hysteresis."
    certain = "" if abs(one.value_mm) > one.half_mm else ", which may be chance"
    return (
        f"Strokes that are approached towards +{one.axis} are {one.value_mm:+.3f} +- {one.half_mm:.3f} mm further that "
        f"way than those approached towards -{one.axis}{certain}."
    )


def as_json(title: str, found: Repeats) -> str:
    made = {
        "format": FORMAT,
        "version": 1,
        "title": title,
        "sheets": found.sheets,
        "displacement_mm": round(found.displacement_mm, 4),
        "displacement_95_mm": [round(found.low_mm, 4), round(found.high_mm, 4)],
        "hysteresis_mm": {
            one.axis: None if one.value_mm is None else [round(one.value_mm, 4), round(one.half_mm, 4)]
            for one in found.approaches
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
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


def read_displacement_mm(path: str) -> float:
    """The standard deviation in a file that `compare --sheets` wrote. Error naming file and key."""
    try:
        content = json_fields.document(read_bytes(path), FORMAT)
        return json_fields.number(content.get("displacement_mm"), "displacement_mm", 1e-3, 10.0)
    except Error as refusal:
        refusal.file = path
        raise
