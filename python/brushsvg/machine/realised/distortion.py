"""Model where a machine takes the tool for a command, and the command for a place. In the paper's frame."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from ... import _core
from ..cells.cell import Cell, Machine
from .retimed import on_way
from .smooth_field import edge_cuts, field_mm, is_bent, parts_of

NEAR_MM, MOST_ROUNDS = 1e-9, 60  # of the way back through a field: each round leaves a quarter of it or less
MAP_OFF_MM = 0.003  # greatest distance of a commanded line from the paper's map between its ends


def is_similar(machine: Machine | None) -> bool:
    """Whether a circle at one depth stays a circle."""
    return machine is None or (
        not machine.skew
        and machine.scale[0] == machine.scale[1]
        and not any(machine.tilt_mm_per_mm)
        and not machine.map_mm
        and not machine.field_mm
    )


def leans(machine: Machine | None) -> bool:
    return machine is not None and any(machine.lean_mm_per_mm)


def true_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """Return (n, 3): where the tool goes for commands. It leans as deep as it is pressed: not in the air."""
    if machine is None:
        return points_mm
    commanded = np.asarray(points_mm, dtype=float)
    z = commanded[:, 2] - _paper_mm(commanded[:, :2], machine)
    depth = np.maximum(-z, 0.0)
    place = commanded[:, :2] @ _axes(machine).T + field_mm(commanded[:, :2], machine)
    return np.column_stack([place + np.outer(depth, machine.lean_mm_per_mm), z])


def true_way_mm(commanded_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """Return (m, 3): where the tool goes along commanded lines between places (n, 3), with more of them where it
    bends."""
    if is_bent(machine):
        commanded_mm = _in_parts(commanded_mm, parts_of(commanded_mm[:, :2], machine))
    run = true_mm(commanded_mm, machine)
    if not leans(machine):
        return run
    # it begins to lean where it touches the paper, not where the line began
    over, under = run[:-1, 2], run[1:, 2]
    cuts = [[a / (a - b), 1.0] if a * b < 0 else [1.0] for a, b in zip(over, under, strict=True)]
    return true_mm(_cut(np.asarray(commanded_mm, dtype=float), map(np.array, cuts)), machine)


def commanded_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """Return (n, 3): the commands that take the tool there."""
    if machine is None:
        return points_mm
    target = np.asarray(points_mm, dtype=float)
    depth = np.maximum(-target[:, 2], 0.0)
    place = _solve_place(target[:, :2] - np.outer(depth, machine.lean_mm_per_mm), machine)
    return np.column_stack([place, target[:, 2] + _paper_mm(place, machine)])


def _solve_place(target_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """Return (n, 2) the commands for which the machine's axes and its field take the tool there."""
    back = np.linalg.inv(_axes(machine)).T
    place = target_mm @ back
    for _ in range(MOST_ROUNDS if is_bent(machine) else 0):
        before, place = place, (target_mm - field_mm(place, machine)) @ back
        if np.max(np.abs(place - before), initial=0.0) < NEAR_MM:
            break
    return place


def commanded_high_mm(commanded_mm: np.ndarray, height_mm: float, machine: Machine | None) -> np.ndarray:
    """Return (n,) the commanded heights at commanded places (n, 2), so that the tool is at least so high over the
    paper, and over what stands as it was taught, such as vessels."""
    rises_mm = np.zeros(len(commanded_mm))
    if machine is not None:
        plane_mm = machine.height_mm + commanded_mm @ machine.tilt_mm_per_mm
        highest_mm = max((row[2] for row in machine.map_mm), default=0.0)  # between places, too
        rises_mm = np.maximum(plane_mm + highest_mm, 0.0)
    return height_mm + rises_mm


def goes_straight(machine: Machine | None) -> bool:
    """Return whether commanded lines are lines on the paper."""
    return machine is None or not (machine.map_mm or machine.field_mm)


def in_lines_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """(m, k): places (n, k), x, y, z and what else changes evenly, where the tool shall go, with more of them between,
    so that straight lines between the commands keep the tool on its way, and its height over the paper's map."""
    if goes_straight(machine):
        return points_mm
    target = np.asarray(points_mm, dtype=float)
    if is_bent(machine):
        target = _in_parts(target, parts_of(commanded_mm(target[:, :3], machine)[:, :2], machine))
        target = _cut(target, edge_cuts(commanded_mm(target[:, :3], machine)[:, :2], machine))
    if not machine.map_mm:
        return target
    commanded = commanded_mm(target[:, :3], machine)[:, :2]
    return _cut(target, [_cuts(*ends, machine) for ends in pairwise(commanded)])


def _cut(points: np.ndarray, cuts) -> np.ndarray:
    """Each line between points (n, k) at n - 1 times shares of it, the last of which is 1."""
    lines = zip(pairwise(points), cuts, strict=True)
    return np.vstack([points[:1], *(a + at[:, None] * (b - a) for (a, b), at in lines)])


def _in_parts(points: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Each line between points (n, k) in so many (n - 1,) of the same length."""
    line = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(line)) - np.repeat(np.cumsum(counts) - counts, counts) + 1) / counts[line]
    return np.vstack([points[:1], points[line] + share[:, None] * (points[line + 1] - points[line])])


def _cuts(a: np.ndarray, b: np.ndarray, machine: Machine) -> np.ndarray:
    """Shares of the way from a place (2,) to another, above 0 and up to 1: where it crosses the map's lines, and
    between two of them, where the map is hollow or domed along it, so many that chords do."""
    xs, ys, heights = _grid(machine.map_mm)
    crossed = [
        (lines - start) / (end - start)
        for lines, start, end in zip((xs, ys), a, b, strict=True)
        if start != end
    ]
    inside = np.concatenate([[0.0, 1.0], *crossed])
    ends = np.unique(inside[(inside >= 0.0) & (inside <= 1.0)])
    cuts = []
    for first, last in pairwise(ends):
        middle, (dx, dy) = a + (first + last) / 2 * (b - a), (last - first) * (b - a)
        i, j = (_cell(grid, place) for grid, place in zip((xs, ys), middle, strict=True))
        (low, high), (low_on, high_on) = heights[j : j + 2, i : i + 2]
        is_beyond = not (xs[0] <= middle[0] <= xs[-1] and ys[0] <= middle[1] <= ys[-1])
        twist = 0.0 if is_beyond else (high_on - low_on - high + low) / np.diff(xs)[i] / np.diff(ys)[j]
        count = max(1, int(np.ceil(np.sqrt(abs(twist * dx * dy) / (4 * MAP_OFF_MM)))))
        cuts.append(first + (last - first) * np.arange(1, count + 1) / count)
    return np.concatenate(cuts)


def _paper_mm(places_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """Return (n,) how much higher the paper is at commanded places (n, 2) than it was taught."""
    plane_mm = machine.height_mm + places_mm @ machine.tilt_mm_per_mm
    if not machine.map_mm:
        return plane_mm
    xs, ys, heights = _grid(machine.map_mm)
    (i, u), (j, v) = (
        _cell_and_share(grid, places) for grid, places in zip((xs, ys), places_mm.T, strict=True)
    )
    below = heights[j, i] * (1 - u) + heights[j, i + 1] * u
    above = heights[j + 1, i] * (1 - u) + heights[j + 1, i + 1] * u
    return plane_mm + below * (1 - v) + above * v


@lru_cache
def _grid(map_mm: tuple) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x (k,), y (m,) of a map's places, upwards, and its heights (m, k)."""
    rows = np.array(sorted(map_mm, key=lambda row: (row[1], row[0])))
    xs, ys = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    return xs, ys, rows[:, 2].reshape(len(ys), len(xs))


def _cell(grid: np.ndarray, places):
    """Return the lines of the grid between which places are, or the nearest ones beyond its ends."""
    return np.clip(np.searchsorted(grid, places, side="right") - 1, 0, len(grid) - 2)


def _cell_and_share(grid: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    number = _cell(grid, places)
    return number, np.clip((places - grid[number]) / (grid[number + 1] - grid[number]), 0.0, 1.0)


def _axes(machine: Machine) -> np.ndarray:
    return np.array([[machine.scale[0], machine.skew], [0.0, machine.scale[1]]])


def true_pass(a_pass, cell: Cell):
    """Return a commanded pass as the machine runs it; circles that do not stay any become the poses on them."""
    return _mapped(a_pass, cell.machine, true_mm)


def commanded_pass(a_pass, cell: Cell):
    """Return the commands with which the machine runs this pass."""
    return _mapped(a_pass, cell.machine, commanded_mm)


def _mapped(a_pass, machine: Machine | None, to):
    if machine is None:
        return a_pass
    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    arcs = []
    for arc in a_pass.arcs if is_similar(machine) else ():
        centre = to(np.array([[*arc.centre_mm, poses[arc.first, 2]]]), machine)[0, :2]
        arcs.append(_core.Arc(arc.first, arc.last, tuple(centre.tolist()), arc.direction))
    return on_way(a_pass, to(poses, machine), arcs, a_pass.tool_axes)
