"""When the pen of somebody else's program is down: by its height or by its servo, whichever the program moves between
strokes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

import numpy as np

from ...errors import Error, Notice
from ...geometry.polylines import length
from .toolpaths import Way

SAME_MM = 1e-3  # heights that differ by less are one
HOP_MM = 0.5  # a pen that comes down again as near as this goes on with its stroke
CLEARLY = 1.0  # what beginning and ending at z 0 says, where many park: alone it does not turn Z
MOST_OF_TRAVEL = 3  # ways from one stroke to the next; more of them are drawn, or a detour that nobody writes
MOST_LEVELS = 200  # distinct heights that are tried as the lowest one of travel


@dataclass(frozen=True)
class Pen:
    """down: for each way whether the pen is on the paper all along it. kind: "z" or "servo". how: in words, for people.
    share: length of the drawn ways over that of all ways that may be drawn. notices: what to look at. is_inverted: by a
    Z that counts downwards."""

    down: tuple[bool, ...]
    kind: str
    how: str
    share: float
    notices: tuple[Notice, ...] = ()
    is_inverted: bool = False


def read_pen(some: list[Way], kind: str | None = None, paper_z_mm: float | None = None) -> Pen:
    """kind: "z" or "servo", None to find out; paper_z_mm: the pen is down at this height and beyond it.

    Z decides where it changes between ways to the side at least as often as the servo does. The least height of travel
    is the one that agrees best with rapid ways, with lifts straight up and down, and with the paper at z 0. Z counts
    downwards where that is clearly shown, see _as_travel. A servo is up at the value of rapid ways, behind M5, and at
    the value that is set first.

    Error where nothing shows it, or where the requested axis does not move.
    """
    # grbl's laser is dark on rapid ways
    some = [replace(way, power=None) if way.rapid and way.by_laser else way for way in some]
    across = [bool(np.ptp(way.points_mm[:, :2], axis=0).any()) for way in some]
    by_z, by_servo = _levels(some, across), _values(some, across)
    if kind is None:
        kind = "z" if paper_z_mm is not None else pen_kind(some)
    if kind == "z":
        down, how, is_inverted = _by_height(some, across, by_z, paper_z_mm)
    else:
        (down, how), is_inverted = _by_servo(some, across), False
    if not any(down) and paper_z_mm is None and len(set(filter(None, by_z))) < 2 and _changes(by_servo) == 0:
        raise _unknown(by_z)
    said = tuple(_rapids_that_paint(some, across, down))
    return Pen(tuple(down), kind, how, _share(some, across, down), said, is_inverted)


def pen_kind(some: list[Way]) -> str:
    """ "z" or "servo": whichever the program moves between strokes, Z where both do equally often."""
    if all(way.power is None for way in some):
        return "z"
    across = [bool(np.ptp(way.points_mm[:, :2], axis=0).any()) for way in some]
    changes_z, changes_servo = _changes(_levels(some, across)), _changes(_values(some, across))
    return "z" if changes_z >= max(changes_servo, 1) else "servo"


def _unknown(levels: list[float | None]) -> Error:
    sentence = (
        "nothing shows when its pen is down: no height changes between strokes, and no M3, M5 or M280 stands"
    )
    known = [level for level in levels if level is not None]
    advice = f"--paper-z {known[0]:g} reads all lines at this height" if known else ""
    return Error(sentence, code="pen-unknown", advice=advice)


def _levels(some: list[Way], across: list[bool]) -> list[float | None]:
    """For each way to the side its greatest height, rounded, None where that is not known."""
    heights = [float(way.points_mm[:, 2].max()) for way in some]
    return [
        round(height / SAME_MM) * SAME_MM if is_across and math.isfinite(height) else None
        for height, is_across in zip(heights, across, strict=True)
    ]


def _values(some: list[Way], across: list[bool]) -> list[float | None]:
    """For each way to the side the value of its servo, -inf where it is off; None for other ways."""
    return [
        (-math.inf if way.power is None else way.power) if is_across else None
        for way, is_across in zip(some, across, strict=True)
    ]


def _changes(levels: list[float | None]) -> int:
    """How often a way to the side has another level than the one before it."""
    known = [level for level in levels if level is not None]
    return sum(a != b for a, b in pairwise(known))


def _by_height(
    some: list[Way], across: list[bool], levels: list[float | None], paper_z_mm: float | None
) -> tuple[list[bool], str, bool]:
    """For each way whether it is drawn, how that was found, and whether Z counts downwards."""
    if paper_z_mm is None and len(_heights(some, levels)) < 2:
        raise _unknown(levels)
    turned = [replace(way, points_mm=way.points_mm * (1.0, 1.0, -1.0)) for way in some]
    turned_levels = _levels(turned, across)
    if paper_z_mm is None:
        least_up = _least_of_travel(some, across, _heights(some, levels))
        turned_least = _least_of_travel(turned, across, _heights(turned, turned_levels), has_zero=False)
    else:
        least_up, turned_least = (sign * paper_z_mm + 2 * SAME_MM for sign in (1, -1))
    shown = _as_travel(some, across, least_up - SAME_MM)
    is_inverted = _as_travel(turned, across, turned_least - SAME_MM) > shown + CLEARLY
    if is_inverted:
        some, levels, least_up = turned, turned_levels, turned_least
    down = [not _is_vertical(way) and float(way.points_mm[:, 2].max()) < least_up - SAME_MM for way in some]
    drawn = [level for level, is_down in zip(levels, down, strict=True) if is_down and level is not None]
    travel = [level for level, is_down in zip(levels, down, strict=True) if not is_down and level is not None]
    sign = -1.0 if is_inverted else 1.0
    how = "its pen goes by Z" + (", which counts downwards" if is_inverted else "")
    how += f": down to z {sign * max(drawn) + 0.0:g} mm" if drawn else ", and is never down"
    how += f", up from z {sign * min(travel) + 0.0:g} mm" if travel else ""
    return down, how, is_inverted


def _heights(some: list[Way], levels: list[float | None]) -> list[float]:
    """Distinct heights of ways to the side and of dots, the least first."""
    dots = (float(way.points_mm[-1, 2]) for way in some if not np.ptp(way.points_mm, axis=0).any())
    return sorted({level for level in levels if level is not None} | {d for d in dots if math.isfinite(d)})


def _as_travel(some: list[Way], across: list[bool], middle: float) -> float:
    """How much the ways above a height look like travel, from 0 to 3: rapid ways end there, where others do not; the
    program begins and ends there; and the pen goes fewer ways in a row there than below it."""
    ends = [(way.rapid, float(way.points_mm[-1, 2])) for way in some if math.isfinite(way.points_mm[-1, 2])]
    rapid = [height >= middle for is_rapid, height in ends if is_rapid]
    by_rapid = float(np.mean(rapid)) if 0 < len(rapid) < len(ends) else 0.5
    sides = [
        float(way.points_mm[:, 2].max()) >= middle
        for way, is_across in zip(some, across, strict=True)
        if is_across and np.isfinite(way.points_mm[:, 2]).all()
    ]
    outer = ([sides[0]] if sides else []) + ([ends[-1][1] >= middle] if ends else [])
    runs: dict[bool, list[int]] = {True: [], False: []}
    for is_above, run in groupby(sides):
        runs[is_above].append(len(list(run)))
    above, below = (float(np.mean(runs[each])) if runs[each] else 0.0 for each in (True, False))
    by_runs = below / (above + below) if above and below else 0.5
    return by_rapid + (float(np.mean(outer)) if outer else 0.5) + by_runs


def _is_vertical(way: Way) -> bool:
    (x, y, from_z), *_, (u, v, to_z) = way.points_mm
    return bool(x == u and y == v and not way.turn and from_z != to_z)


def _least_of_travel(some: list[Way], across: list[bool], known: list[float], has_zero: bool = True) -> float:
    """The height that separates drawing from travel best: most ways straight up and down cross it, rapid ways are above
    it, and, where has_zero, z 0 and below is below it."""
    lifts = np.array(
        [
            (way.points_mm[0, 2], way.points_mm[-1, 2])
            for way in some
            if _is_vertical(way) and np.isfinite(way.points_mm[:, 2]).all()
        ]
    ).reshape(-1, 2)
    sides = [
        (way.rapid, float(way.points_mm[:, 2].max()))
        for way, is_across in zip(some, across, strict=True)
        if is_across and math.isfinite(float(way.points_mm[:, 2].max()))
    ]
    has_both = len({rapid for rapid, _ in sides}) == 2
    rapid = np.array([height for is_rapid, height in sides if is_rapid])
    best, least_up = -math.inf, known[-1]
    levels = (
        known
        if len(known) <= MOST_LEVELS
        else [known[k] for k in np.linspace(0, len(known) - 1, MOST_LEVELS).astype(int)]
    )
    for below, level in pairwise(levels):
        middle = (below + level) / 2
        crossed = float(((lifts < middle).sum(axis=1) == 1).mean()) if len(lifts) else 0.0
        above = float((rapid >= middle).mean()) if has_both else 1.0
        at_zero = has_zero and below <= SAME_MM < level
        score = crossed + above + 0.5 * at_zero
        if score > best + 1e-9:
            best, least_up = score, level
    return least_up


def _by_servo(some: list[Way], across: list[bool]) -> tuple[list[bool], str]:
    first = next((way.power for way in some if way.power is not None), None)
    values = {
        way.power for way, is_across in zip(some, across, strict=True) if is_across and way.power is not None
    }
    up: set[float | None] = {
        way.power for way, is_across in zip(some, across, strict=True) if is_across and way.rapid
    }
    is_off = any(way.power is None and is_across for way, is_across in zip(some, across, strict=True))
    if not up - {None} and len(values) > 1 and not (is_off and any(way.rapid for way in some)):
        up.add(first)  # programs begin with the pen up
    if values and values <= up:  # drawn by rapid ways as well: what is left is the first value
        up = {first} if len(values) > 1 else set()
    up.add(None)
    down = [way.power not in up for way in some]
    said = sorted(value for value in values if value not in up)
    raised = sorted(value for value in up if value is not None)
    how = (
        f"its pen goes by a servo: down at S{', S'.join(f'{value:g}' for value in said[:3])}"
        if said
        else "its pen goes by a servo"
    )
    return down, how + (
        f", up at S{', S'.join(f'{value:g}' for value in raised[:3])}" if raised else ", up at S0 or M5"
    )


def _share(some: list[Way], across: list[bool], down: list[bool]) -> float:
    """Return the drawn length over that of all ways that may be drawn: ways by G1, G2 and G3 that are read
    as travel and do not look like it, for the pen is not lifted before them or they go on for long."""
    lengths = [length(way.points_mm[:, :2]) for way in some]
    drawn = doubtful = 0.0
    run: list[float] = []
    is_lifted = True
    for k, way in enumerate([*some, None]):
        is_travel = way is not None and across[k] and not down[k] and not way.rapid
        if is_travel:
            run.append(lengths[k] if math.isfinite(lengths[k]) else 0.0)
            continue
        if way is None or (across[k] and down[k]) or way.rapid:
            doubtful += 0.0 if is_lifted and len(run) <= MOST_OF_TRAVEL else sum(run)
            run, is_lifted = [], True
        if way is not None and across[k] and down[k]:
            drawn += lengths[k] if math.isfinite(lengths[k]) else 0.0
            after = some[k + 1] if k + 1 < len(some) else None
            is_lifted = after is None or _is_vertical(after) or after.power != way.power
    return drawn / (drawn + doubtful) if drawn + doubtful else 1.0


def _rapids_that_paint(some: list[Way], across: list[bool], down: list[bool]):
    lines = [
        way.line
        for way, is_across, is_down in zip(some, across, down, strict=True)
        if way.rapid and is_across and is_down
    ]
    if lines:
        sentence = f"{len(lines)} rapid moves paint, the first in line {lines[0]}: they are read as lines"
        yield Notice(f"line {lines[0]}", sentence, code="rapid-paints")
