"""Time a program's moves within the speeds and the acceleration of its cell."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

import numpy as np

from .cells.cell import robot_from_paper
from .moves import Move, Program, Wait
from .tool_axes import turned_on

# Kinds of rows: a place of the plan, a place on the way to it, the end of a wait.
POSE_ROW, WAY_ROW, REST_ROW = 0, 1, 2
SLICE_S = 0.02  # spacing of rows while the speed changes; between two rows the speed counts as constant
MIN_LENGTH_MM = 1e-6
MIN_SLICE_S = 1e-6  # rows that are closer in time could be written with one time


def make_timed_sections(program: Program) -> Iterator[tuple[str, np.ndarray]]:
    """Yield (title, rows) for each section.

    rows: (n, 6) the time since the first place [s], x, y and z [mm, the program's frame], the highest speed of the
        move [mm/s], and the kind of row: POSE_ROW, WAY_ROW or REST_ROW. A program that tilts the brush has rows (n, 9).
        They end with the unit vector from the tip up along the brush, which turns evenly along a line.

    A move begins and ends at rest, and stops at a corner that must not be cut. Along straight lines, the speed changes
    with the cell's acceleration a. At a joint, the lines turn by t, and the corner may be cut from a distance r on. The
    arc that touches both lines there limits the speed v: v^2 tan(t/2) / r <= a. Places are rounded to the cell's
    decimals.
    """
    a, decimals = program.cell.speeds.acceleration_mm_s2, program.cell.decimals
    now_s, here_mm = 0.0, None
    # the points are in the robot's frame, where an upright brush is parallel to the paper's normal
    normal = tuple(robot_from_paper(program.cell)[:3, 2].tolist()) if program.tilts else ()
    axis_here = normal
    for section in program.sections():
        rows: list[tuple] = []
        for step in section.steps:
            if isinstance(step, Wait):
                now_s += step.seconds or 0.0
                rows.append((now_s, *here_mm, 0.0, REST_ROW, *axis_here))
                continue
            axes = None
            if program.tilts:
                axes = np.tile(normal, (len(step.points_mm), 1)) if step.axes is None else step.axes
            if here_mm is None:
                here_mm = tuple(np.round(step.points_mm[0], decimals).tolist())
                axis_here = axis_here if axes is None else tuple(axes[0].tolist())
                rows.append((now_s, *here_mm, step.speed_mm_s, POSE_ROW, *axis_here))
            now_s, here_mm, axis_here = _append_move_rows(step, here_mm, axes, axis_here, now_s, a, decimals, rows)
        yield section.title, np.array(rows).reshape(-1, 6 + len(normal))


def _append_move_rows(
    move: Move,
    here: tuple,
    axes: np.ndarray | None,
    axis_here: tuple,
    now_s: float,
    a: float,
    decimals: int,
    rows: list,
) -> tuple[float, tuple, tuple]:
    """Append the rows of a move, and return its end.

    The end is a time [s], a place, and the brush's axis.

    axes: (n, 3) the brush's axes at the points of the move.
    """
    path = np.vstack([here, np.round(move.points_mm, decimals)])
    steps = np.diff(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    is_moving = lengths > MIN_LENGTH_MM
    if not is_moving.any():
        return now_s, here, axis_here
    point_numbers = np.flatnonzero(is_moving) + 1
    steps, lengths = steps[is_moving], lengths[is_moving]
    top_speed = move.speed_mm_s
    caps = joint_speed_limits(move.blends_mm, point_numbers, steps, lengths, a).tolist()
    places = path[point_numbers].tolist()
    axes = axes if axes is None else axes[point_numbers - 1]
    for k, when_s, done_mm in time_lines(lengths.tolist(), caps, [top_speed] * len(lengths), a, now_s):
        end_of_line = places[k]
        if done_mm is None:
            now_s, here = when_s, tuple(end_of_line)
            axis_here = axis_here if axes is None else tuple(axes[k].tolist())
            rows.append((now_s, *here, top_speed, POSE_ROW, *axis_here))
            continue
        fraction = done_mm / lengths[k]
        place = (x + fraction * (to - x) for x, to in zip(here, end_of_line, strict=True))
        axis_on_way = () if axes is None else turned_on(np.array(axis_here), axes[k], fraction).tolist()
        rows.append((when_s, *place, top_speed, WAY_ROW, *axis_on_way))
    return now_s, here, axis_here


def time_lines(
    lengths: list[float], caps: list[float], tops: list[float], a: float, now_s: float = 0.0
) -> Iterator[tuple[int, float, float | None]]:
    """Yield (line, time [s], path length [mm]) for consecutive lines.

    The motion is from rest to rest. The path length is measured on the line. The path length is None for the end of a
    line.

    lengths: (n,) lengths of the lines [mm].
    caps: (n - 1,) highest speed in each joint [mm/s].
    tops: (n,) highest speed on each line [mm/s].
    a: acceleration [mm/s2].
    """
    speeds = _speeds_at_joints(lengths, caps, tops, a)
    for k, length in enumerate(lengths):
        begin, end = speeds[k], speeds[k + 1]
        if begin == end == tops[k]:  # nearly all lines
            now_s += length / begin
            yield k, now_s, None
            continue
        peak = min(tops[k], sqrt(a * length + (begin * begin + end * end) / 2))
        rising_s, falling_s = (peak - begin) / a, (peak - end) / a
        even_mm = max(length - (2 * peak * peak - begin * begin - end * end) / (2 * a), 0.0)
        even_s = even_mm / peak if even_mm > MIN_LENGTH_MM else 0.0
        if max(rising_s, falling_s) > SLICE_S / 2:
            took_s, last_s = rising_s + even_s + falling_s, 0.0
            for after_s, done_mm in _slice_points(begin, peak, rising_s, even_s, falling_s, length, end, a):
                if min(after_s - last_s, took_s - after_s) >= MIN_SLICE_S:
                    yield k, now_s + after_s, done_mm
                    last_s = after_s
        now_s += rising_s + even_s + falling_s
        yield k, now_s, None


def joint_speed_limits(
    blends_mm: np.ndarray | None, at: np.ndarray, steps: np.ndarray, lengths: np.ndarray, a: float
) -> np.ndarray:
    """Return the highest speed [mm/s] through each joint of n lines, (n - 1,).

    at: line k ends at point at[k] - 1 of blends_mm.
    a: acceleration [mm/s2].
    """
    count = len(lengths)
    if blends_mm is None or count < 2:
        return np.zeros(count - 1)
    along = steps / lengths[:, None]
    cosine = np.clip((along[1:] * along[:-1]).sum(axis=1), -1.0, 1.0)
    half_tangents = np.sqrt((1 - cosine) / np.maximum(1 + cosine, 1e-12))  # tan(t / 2)
    radii = blends_mm[at[:-1] - 1]
    return np.sqrt(np.divide(a * radii, half_tangents, out=np.full(count - 1, np.inf), where=half_tangents > 1e-7))


def _speeds_at_joints(lengths: list[float], caps: list[float], tops: list[float], a: float) -> list[float]:
    """Return the speeds [mm/s] at both ends and in all joints.

    They can be reached, and braked from in time.
    """
    speeds = [0.0, *map(min, caps, tops[:-1], tops[1:]), 0.0]
    for k, length in enumerate(lengths):
        if speeds[k + 1] > speeds[k]:
            speeds[k + 1] = min(speeds[k + 1], sqrt(speeds[k] ** 2 + 2 * a * length))
    for k in range(len(lengths) - 1, -1, -1):
        if speeds[k] > speeds[k + 1]:
            speeds[k] = min(speeds[k], sqrt(speeds[k + 1] ** 2 + 2 * a * lengths[k]))
    return speeds


def _slice_points(
    begin: float,
    peak: float,
    rising_s: float,
    even_s: float,
    falling_s: float,
    length: float,
    end: float,
    a: float,
) -> Iterator[tuple[float, float]]:
    """Yield points (seconds, mm) after a line's beginning, while its speed changes.

    A change that is shorter than half a slice has no points. The line's ends are not included.
    """
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
