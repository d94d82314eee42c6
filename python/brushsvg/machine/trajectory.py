"""When the tool is where: a program's moves with times that the cell's speeds and acceleration allow."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

import numpy as np

from .cells.cell import robot_from_paper
from .motion import Move, Program, Wait
from .tool_axes import turned_on

POSE, WAY, REST = 0, 1, 2  # what a row is: a place of the plan, one on the way to it, the end of a wait
SLICE_S = 0.02  # rows are so far apart where the speed changes: between two it counts as even
LEAST_MM = 1e-6


def timed(program: Program) -> Iterator[tuple[str, np.ndarray]]:
    """(title, rows) of each section. rows (n, 6): time from the first place on [s], x, y, z [mm, the program's frame],
    the speed that its move may have [mm/s], POSE, WAY or REST; (n, 9) of a program that tilts the brush, then the unit
    vector from its tip up along it, which turns evenly along a line.

    A move begins and ends at rest, and is at rest where nothing may be cut. Along straight lines the speed changes by
    the cell's acceleration a. Through a joint of two lines that turns by t and may be cut from r on, it goes no faster
    than an arc that touches both there allows: v^2 tan(t/2) / r <= a. Places are rounded as the cell's are.
    """
    a, decimals = program.cell.speeds.acceleration_mm_s2, program.cell.decimals
    now_s, here = 0.0, None
    # its points are in the robot's frame, where nothing is upright but on the paper
    normal = tuple(robot_from_paper(program.cell)[:3, 2].tolist()) if program.tilts else ()
    held = normal
    for section in program.sections():
        rows: list[tuple] = []
        for step in section.steps:
            if isinstance(step, Wait):
                now_s += step.seconds or 0.0
                rows.append((now_s, *here, 0.0, REST, *held))
                continue
            axes = None
            if program.tilts:
                axes = np.tile(normal, (len(step.points_mm), 1)) if step.axes is None else step.axes
            if here is None:
                here = tuple(np.round(step.points_mm[0], decimals).tolist())
                held = held if axes is None else tuple(axes[0].tolist())
                rows.append((now_s, *here, step.speed_mm_s, POSE, *held))
            now_s, here, held = _moved(step, here, axes, held, now_s, a, decimals, rows)
        yield section.title, np.array(rows).reshape(-1, 6 + len(normal))


def _moved(
    move: Move,
    here: tuple,
    axes: np.ndarray | None,
    held: tuple,
    now_s: float,
    a: float,
    decimals: int,
    rows: list,
) -> tuple[float, tuple, tuple]:
    """Rows of a move, added; when and where it ends, and how the brush is held there; axes: (n, 3) of its points."""
    path = np.vstack([here, np.round(move.points_mm, decimals)])
    steps = np.diff(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    goes = lengths > LEAST_MM
    if not goes.any():
        return now_s, here, held
    at = np.flatnonzero(goes) + 1
    steps, lengths = steps[goes], lengths[goes]
    top = move.speed_mm_s
    caps = joint_caps(move.blends_mm, at, steps, lengths, a).tolist()
    places = path[at].tolist()
    axes = axes if axes is None else axes[at - 1]
    for k, when_s, done_mm in paced(lengths.tolist(), caps, [top] * len(lengths), a, now_s):
        there = places[k]
        if done_mm is None:
            now_s, here = when_s, tuple(there)
            held = held if axes is None else tuple(axes[k].tolist())
            rows.append((now_s, *here, top, POSE, *held))
            continue
        part = done_mm / lengths[k]
        place = (x + part * (to - x) for x, to in zip(here, there, strict=True))
        on = () if axes is None else turned_on(np.array(held), axes[k], part).tolist()
        rows.append((when_s, *place, top, WAY, *on))
    return now_s, here, held


def paced(
    lengths: list[float], caps: list[float], tops: list[float], a: float, now_s: float = 0.0
) -> Iterator[tuple[int, float, float | None]]:
    """(line, when [s], how far on the line [mm], None for its end) of n lines [mm] that follow each other, from rest to
    rest. caps: (n - 1) the most that the speed may be in each joint; tops: (n,) on each line [mm/s]."""
    speeds = _speeds(lengths, caps, tops, a)
    for k, length in enumerate(lengths):
        begin, end = speeds[k], speeds[k + 1]
        if begin == end == tops[k]:  # most by far
            now_s += length / begin
            yield k, now_s, None
            continue
        peak = min(tops[k], sqrt(a * length + (begin * begin + end * end) / 2))
        rising_s, falling_s = (peak - begin) / a, (peak - end) / a
        even_mm = max(length - (2 * peak * peak - begin * begin - end * end) / (2 * a), 0.0)
        even_s = even_mm / peak if even_mm > LEAST_MM else 0.0
        if max(rising_s, falling_s) > SLICE_S / 2:
            for after_s, done_mm in _slices(begin, peak, rising_s, even_s, falling_s, length, end, a):
                yield k, now_s + after_s, done_mm
        now_s += rising_s + even_s + falling_s
        yield k, now_s, None


def joint_caps(
    blends_mm: np.ndarray | None, at: np.ndarray, steps: np.ndarray, lengths: np.ndarray, a: float
) -> np.ndarray:
    """(n - 1,) the most that the speed may be through each joint of n lines, the k-th of which ends at point at[k] - 1
    of those that have blends."""
    count = len(lengths)
    if blends_mm is None or count < 2:
        return np.zeros(count - 1)
    along = steps / lengths[:, None]
    cosine = np.clip((along[1:] * along[:-1]).sum(axis=1), -1.0, 1.0)
    bend = np.sqrt((1 - cosine) / np.maximum(1 + cosine, 1e-12))  # tan(t / 2)
    radii = blends_mm[at[:-1] - 1]
    return np.sqrt(np.divide(a * radii, bend, out=np.full(count - 1, np.inf), where=bend > 1e-7))


def _speeds(lengths: list[float], caps: list[float], tops: list[float], a: float) -> list[float]:
    """At both ends of each line and in all joints: what can be reached, and left in time."""
    speeds = [0.0, *map(min, caps, tops[:-1], tops[1:]), 0.0]
    for k, length in enumerate(lengths):
        if speeds[k + 1] > speeds[k]:
            speeds[k + 1] = min(speeds[k + 1], sqrt(speeds[k] ** 2 + 2 * a * length))
    for k in range(len(lengths) - 1, -1, -1):
        if speeds[k] > speeds[k + 1]:
            speeds[k] = min(speeds[k], sqrt(speeds[k + 1] ** 2 + 2 * a * lengths[k]))
    return speeds


def _slices(
    begin: float,
    peak: float,
    rising_s: float,
    even_s: float,
    falling_s: float,
    length: float,
    end: float,
    a: float,
) -> Iterator[tuple[float, float]]:
    """(seconds, mm) after a line's beginning, where the speed changes for longer than a slice; none at its ends."""
    if rising_s > SLICE_S / 2:
        count = max(1, round(rising_s / SLICE_S))
        last = count + 1 if even_s + falling_s > 0 else count
        for k in range(1, last):
            after_s = rising_s * k / count
            yield after_s, begin * after_s + a * after_s * after_s / 2
    if falling_s > SLICE_S / 2:
        count = max(1, round(falling_s / SLICE_S))
        first = 0 if even_s > 0 else 1
        for k in range(first, count):
            left_s = falling_s * (1 - k / count)
            yield rising_s + even_s + falling_s - left_s, length - end * left_s - a * left_s * left_s / 2
