"""Find out when the pen of a plotter program is down.

The pen follows its height or its servo, depending on the axis that the program moves between strokes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

import numpy as np

from ...errors import Error, Notice
from ...geometry.polylines import length
from .toolpaths import Way

SAME_HEIGHT_MM = 1e-3  # heights that differ by less are the same
MAX_HOP_MM = 0.5  # a pen that comes down again within this distance continues its stroke
# Difference of travel scores from which Z counts downwards. Beginning and ending at z 0, where many programs park,
# scores 1.0, so this alone does not invert Z.
MIN_INVERSION_EVIDENCE = 1.0
# Ways between two strokes that count as travel. More ways in a row are drawn: nobody programs such a detour.
MAX_TRAVEL_WAYS = 3
MAX_TRIED_LEVELS = 200  # distinct heights that are tried as the lowest height of travel


@dataclass(frozen=True)
class Pen:
    """The state of the pen along the ways of a program.

    down: for each way, whether the pen is on the paper along all of it.
    kind: "z" or "servo".
    how: a sentence about the reading, for users.
    share: length of the drawn ways divided by the length of all ways that may be drawn.
    notices: points that the user should check.
    is_inverted: whether Z counts downwards.
    """

    down: tuple[bool, ...]
    kind: str
    how: str
    share: float
    notices: tuple[Notice, ...] = ()
    is_inverted: bool = False


def read_pen(all_ways: list[Way], kind: str | None = None, paper_z_mm: float | None = None) -> Pen:
    """Find out along which ways of a program the pen is down.

    Z decides if it changes between sideways ways at least as often as the servo does. The lowest height of travel is
    the height that agrees best with rapid ways, with vertical lifts and with the paper at z 0. Z counts downwards if
    the evidence is clear, see _travel_score. A servo is up at the value of rapid ways, after M5, and at the value that
    is set first.

    kind: "z" or "servo", None to find out; paper_z_mm: the pen is down at this height and beyond it.

    Raises Error if nothing shows when the pen is down, or if the requested axis does not move.
    """
    # A laser under grbl is dark on rapid ways.
    all_ways = [replace(way, power=None) if way.rapid and way.by_laser else way for way in all_ways]
    is_sideways = [bool(np.ptp(way.points_mm[:, :2], axis=0).any()) for way in all_ways]
    by_z, by_servo = _sideways_heights(all_ways, is_sideways), _servo_values(all_ways, is_sideways)
    if kind is None:
        kind = "z" if paper_z_mm is not None else pen_kind(all_ways)
    if kind == "z":
        down, how, is_inverted = _decide_by_height(all_ways, is_sideways, by_z, paper_z_mm)
    else:
        (down, how), is_inverted = _decide_by_servo(all_ways, is_sideways), False
    if not any(down) and paper_z_mm is None and len(set(filter(None, by_z))) < 2 and _count_changes(by_servo) == 0:
        raise _pen_unknown_error(by_z)
    notices = tuple(_report_painting_rapids(all_ways, is_sideways, down))
    return Pen(tuple(down), kind, how, _read_share(all_ways, is_sideways, down), notices, is_inverted)


def pen_kind(all_ways: list[Way]) -> str:
    """Return "z" or "servo", the axis that the program moves between strokes.

    If both change equally often, the answer is "z".
    """
    if all(way.power is None for way in all_ways):
        return "z"
    is_sideways = [bool(np.ptp(way.points_mm[:, :2], axis=0).any()) for way in all_ways]
    changes_z = _count_changes(_sideways_heights(all_ways, is_sideways))
    changes_servo = _count_changes(_servo_values(all_ways, is_sideways))
    return "z" if changes_z >= max(changes_servo, 1) else "servo"


def _pen_unknown_error(levels: list[float | None]) -> Error:
    sentence = "nothing shows when its pen is down: no height changes between strokes, and it has no M3, M5 or M280"
    known = [level for level in levels if level is not None]
    lifts = "write the program again with a pen that is lifted between strokes, by Z or by M3 and M5"
    advice = f"--paper-z {known[0]:g} reads all lines at this height" if known else lifts
    return Error(sentence, code="pen-unknown", advice=advice)


def _sideways_heights(all_ways: list[Way], is_sideways: list[bool]) -> list[float | None]:
    """Return each sideways way's greatest height [mm], rounded, None for unknown and other ways."""
    heights = [float(way.points_mm[:, 2].max()) for way in all_ways]
    return [
        round(height / SAME_HEIGHT_MM) * SAME_HEIGHT_MM if moves_sideways and math.isfinite(height) else None
        for height, moves_sideways in zip(heights, is_sideways, strict=True)
    ]


def _servo_values(all_ways: list[Way], is_sideways: list[bool]) -> list[float | None]:
    """Return each sideways way's servo value: -inf if the servo is off, None for other ways."""
    return [
        (-math.inf if way.power is None else way.power) if moves_sideways else None
        for way, moves_sideways in zip(all_ways, is_sideways, strict=True)
    ]


def _count_changes(levels: list[float | None]) -> int:
    """Count how often a sideways way has another level than the one before it."""
    known = [level for level in levels if level is not None]
    return sum(a != b for a, b in pairwise(known))


def _decide_by_height(
    all_ways: list[Way], is_sideways: list[bool], levels: list[float | None], paper_z_mm: float | None
) -> tuple[list[bool], str, bool]:
    """Decide by height which ways are drawn: a flag each, a sentence about it, whether Z counts downwards."""
    if paper_z_mm is None and len(_distinct_heights(all_ways, levels)) < 2:
        raise _pen_unknown_error(levels)
    inverted = [replace(way, points_mm=way.points_mm * (1.0, 1.0, -1.0)) for way in all_ways]
    inverted_levels = _sideways_heights(inverted, is_sideways)
    if paper_z_mm is None:
        lowest_travel = _lowest_travel_height(all_ways, is_sideways, _distinct_heights(all_ways, levels))
        inverted_least = _lowest_travel_height(
            inverted, is_sideways, _distinct_heights(inverted, inverted_levels), has_zero=False
        )
    else:
        lowest_travel, inverted_least = (sign * paper_z_mm + 2 * SAME_HEIGHT_MM for sign in (1, -1))
    score = _travel_score(all_ways, is_sideways, lowest_travel - SAME_HEIGHT_MM)
    is_inverted = _travel_score(inverted, is_sideways, inverted_least - SAME_HEIGHT_MM) > score + MIN_INVERSION_EVIDENCE
    if is_inverted:
        all_ways, levels, lowest_travel = inverted, inverted_levels, inverted_least
    down = [
        not _is_vertical(way) and float(way.points_mm[:, 2].max()) < lowest_travel - SAME_HEIGHT_MM for way in all_ways
    ]
    drawn = [level for level, is_down in zip(levels, down, strict=True) if is_down and level is not None]
    travel = [level for level, is_down in zip(levels, down, strict=True) if not is_down and level is not None]
    sign = -1.0 if is_inverted else 1.0
    how = "Z lifts its pen" + (", which counts downwards" if is_inverted else "")
    how += f": down to z {sign * max(drawn) + 0.0:g} mm" if drawn else ", and is never down"
    how += f", up from z {sign * min(travel) + 0.0:g} mm" if travel else ""
    return down, how, is_inverted


def _distinct_heights(all_ways: list[Way], levels: list[float | None]) -> list[float]:
    """Return the distinct heights [mm] of sideways ways and dots, ascending."""
    dots = (float(way.points_mm[-1, 2]) for way in all_ways if not np.ptp(way.points_mm, axis=0).any())
    return sorted({level for level in levels if level is not None} | {d for d in dots if math.isfinite(d)})


def _travel_score(all_ways: list[Way], is_sideways: list[bool], middle: float) -> float:
    """Score how much the ways above a height look like travel.

    The score is from 0 to 3. Three signs count up to 1 each: rapid ways end above the height; the program begins and
    ends above the height; and the pen makes fewer ways in a row above the height than below. A sign without evidence
    counts 0.5.
    """
    ends = [(way.rapid, float(way.points_mm[-1, 2])) for way in all_ways if math.isfinite(way.points_mm[-1, 2])]
    rapid = [height >= middle for is_rapid, height in ends if is_rapid]
    by_rapid = float(np.mean(rapid)) if 0 < len(rapid) < len(ends) else 0.5
    sides = [
        float(way.points_mm[:, 2].max()) >= middle
        for way, moves_sideways in zip(all_ways, is_sideways, strict=True)
        if moves_sideways and np.isfinite(way.points_mm[:, 2]).all()
    ]
    outer = ([sides[0]] if sides else []) + ([ends[-1][1] >= middle] if ends else [])
    runs: dict[bool, list[int]] = {True: [], False: []}
    for is_above, run in groupby(sides):
        runs[is_above].append(len(list(run)))
    above, below = (float(np.mean(runs[side])) if runs[side] else 0.0 for side in (True, False))
    by_runs = below / (above + below) if above and below else 0.5
    return by_rapid + (float(np.mean(outer)) if outer else 0.5) + by_runs


def _is_vertical(way: Way) -> bool:
    (x, y, from_z), *_, (u, v, to_z) = way.points_mm
    return bool(x == u and y == v and not way.turn and from_z != to_z)


def _lowest_travel_height(
    all_ways: list[Way], is_sideways: list[bool], known: list[float], has_zero: bool = True
) -> float:
    """Return the lowest height of travel [mm].

    This height separates drawing from travel best. Most vertical ways cross it, and rapid ways are above it. With
    has_zero, z 0 and lower heights should also be below it.
    """
    lifts = np.array(
        [
            (way.points_mm[0, 2], way.points_mm[-1, 2])
            for way in all_ways
            if _is_vertical(way) and np.isfinite(way.points_mm[:, 2]).all()
        ]
    ).reshape(-1, 2)
    sides = [
        (way.rapid, float(way.points_mm[:, 2].max()))
        for way, moves_sideways in zip(all_ways, is_sideways, strict=True)
        if moves_sideways and math.isfinite(float(way.points_mm[:, 2].max()))
    ]
    has_both = len({rapid for rapid, _ in sides}) == 2
    rapid = np.array([height for is_rapid, height in sides if is_rapid])
    best, lowest_travel = -math.inf, known[-1]
    levels = (
        known
        if len(known) <= MAX_TRIED_LEVELS
        else [known[k] for k in np.linspace(0, len(known) - 1, MAX_TRIED_LEVELS).astype(int)]
    )
    for below, level in pairwise(levels):
        middle = (below + level) / 2
        crossed = float(((lifts < middle).sum(axis=1) == 1).mean()) if len(lifts) else 0.0
        above = float((rapid >= middle).mean()) if has_both else 1.0
        at_zero = has_zero and below <= SAME_HEIGHT_MM < level
        score = crossed + above + 0.5 * at_zero
        if score > best + 1e-9:
            best, lowest_travel = score, level
    return lowest_travel


def _decide_by_servo(all_ways: list[Way], is_sideways: list[bool]) -> tuple[list[bool], str]:
    first = next((way.power for way in all_ways if way.power is not None), None)
    values = {
        way.power
        for way, moves_sideways in zip(all_ways, is_sideways, strict=True)
        if moves_sideways and way.power is not None
    }
    up: set[float | None] = {
        way.power for way, moves_sideways in zip(all_ways, is_sideways, strict=True) if moves_sideways and way.rapid
    }
    is_off = any(
        way.power is None and moves_sideways for way, moves_sideways in zip(all_ways, is_sideways, strict=True)
    )
    if not up - {None} and len(values) > 1 and not (is_off and any(way.rapid for way in all_ways)):
        up.add(first)  # programs begin with the pen up
    if values and values <= up:  # rapid ways draw as well, so only the first value is known to be up
        up = {first} if len(values) > 1 else set()
    up.add(None)
    down = [way.power not in up for way in all_ways]
    down_values = sorted(value for value in values if value not in up)
    up_values = sorted(value for value in up if value is not None)
    how = (
        f"a servo lifts its pen: down at S{', S'.join(f'{value:g}' for value in down_values[:3])}"
        if down_values
        else "a servo lifts its pen"
    )
    return down, how + (
        f", up at S{', S'.join(f'{value:g}' for value in up_values[:3])}" if up_values else ", up at S0 or M5"
    )


def _read_share(all_ways: list[Way], is_sideways: list[bool], down: list[bool]) -> float:
    """Return the drawn length divided by the length of all ways that may be drawn.

    Ways by G1, G2 and G3 that are read as travel may be drawn if they do not look like travel. In this case the pen is
    not lifted before them, or there are too many in a row.
    """
    lengths = [length(way.points_mm[:, :2]) for way in all_ways]
    drawn = doubtful = 0.0
    run: list[float] = []
    is_lifted = True
    for k, way in enumerate([*all_ways, None]):
        is_travel = way is not None and is_sideways[k] and not down[k] and not way.rapid
        if is_travel:
            run.append(lengths[k] if math.isfinite(lengths[k]) else 0.0)
            continue
        if way is None or (is_sideways[k] and down[k]) or way.rapid:
            doubtful += 0.0 if is_lifted and len(run) <= MAX_TRAVEL_WAYS else sum(run)
            run, is_lifted = [], True
        if way is not None and is_sideways[k] and down[k]:
            drawn += lengths[k] if math.isfinite(lengths[k]) else 0.0
            after = all_ways[k + 1] if k + 1 < len(all_ways) else None
            is_lifted = after is None or _is_vertical(after) or after.power != way.power
    return drawn / (drawn + doubtful) if drawn + doubtful else 1.0


def _report_painting_rapids(all_ways: list[Way], is_sideways: list[bool], down: list[bool]):
    lines = [
        way.line
        for way, moves_sideways, is_down in zip(all_ways, is_sideways, down, strict=True)
        if way.rapid and moves_sideways and is_down
    ]
    if lines:
        sentence = f"{len(lines)} rapid moves paint, the first in line {lines[0]}: they are read as lines"
        yield Notice(f"line {lines[0]}", sentence, code="rapid-paints")
