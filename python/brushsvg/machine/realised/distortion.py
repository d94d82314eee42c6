"""Model of an inexact machine: true places and commands.

All places are in the paper's frame.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from ... import _core
from ..cells.cell import Cell, Machine
from .displacement_field import count_line_parts, cuts_at_field_edge, field_displacement_mm, has_field, max_field_slope
from .pass_on_path import move_pass_to_path

# Error [mm] at which inverting a field stops, and largest number of rounds. Each round leaves at most a quarter of the
# error.
SOLVER_TOLERANCE_MM, MAX_SOLVER_ROUNDS = 1e-9, 60
MAX_MAP_OFFSET_MM = 0.003  # largest distance of a commanded line from the paper's map


def is_similar(machine: Machine | None) -> bool:
    """Return whether a circle at one depth stays a circle."""
    return machine is None or (
        not machine.skew
        and machine.scale[0] == machine.scale[1]
        and not any(machine.tilt_mm_per_mm)
        and not machine.map_mm
        and not machine.field_mm
    )


def has_lean(machine: Machine | None) -> bool:
    return machine is not None and any(machine.lean_mm_per_mm)


def true_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """Return the true places (n, 3) [mm] of the tool for commands (n, 3).

    The lean is proportional to the depth, and 0 in the air.
    """
    if machine is None:
        return points_mm
    commanded = np.asarray(points_mm, dtype=float)
    z = commanded[:, 2] - _paper_height_mm(commanded[:, :2], machine)
    depth = np.maximum(-z, 0.0)
    place = commanded[:, :2] @ _axis_matrix(machine).T + field_displacement_mm(commanded[:, :2], machine)
    return np.column_stack([place + np.outer(depth, machine.lean_mm_per_mm), z])


def true_path_mm(commanded_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """Return the true path (m, 3) [mm] of the tool along commanded lines.

    The lines connect the commanded places (n, 3). The path has more points where the machine bends the lines.
    """
    if has_field(machine):
        commanded_mm = _split_evenly(commanded_mm, count_line_parts(commanded_mm[:, :2], machine))
    true_path = true_mm(commanded_mm, machine)
    if not has_lean(machine):
        return true_path
    # the tool begins to lean where it touches the paper, not where the line begins
    before, after = true_path[:-1, 2], true_path[1:, 2]
    cuts = [[a / (a - b), 1.0] if a * b < 0 else [1.0] for a, b in zip(before, after, strict=True)]
    return true_mm(_split_at_shares(np.asarray(commanded_mm, dtype=float), map(np.array, cuts)), machine)


def commanded_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """Return the commands (n, 3) [mm] that take the tool to places (n, 3)."""
    if machine is None:
        return points_mm
    target = np.asarray(points_mm, dtype=float)
    depth = np.maximum(-target[:, 2], 0.0)
    place = _solve_place(target[:, :2] - np.outer(depth, machine.lean_mm_per_mm), machine)
    return np.column_stack([place, target[:, 2] + _paper_height_mm(place, machine)])


def _solve_place(target_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """Return the commands (n, 2) that take the tool to targets (n, 2). They invert the machine's axes and its field."""
    inverse_axes = np.linalg.inv(_axis_matrix(machine)).T
    place = target_mm @ inverse_axes
    for _ in range(MAX_SOLVER_ROUNDS if has_field(machine) else 0):
        previous, place = place, (target_mm - field_displacement_mm(place, machine)) @ inverse_axes
        if np.max(np.abs(place - previous), initial=0.0) < SOLVER_TOLERANCE_MM:
            break
    return place


def commanded_heights_mm(commanded_mm: np.ndarray, height_mm: float, machine: Machine | None) -> np.ndarray:
    """Return the commanded heights [mm] for a height over the paper, (n,).

    The tool is then at least height_mm above the paper, and above objects whose heights were taught, such as vessels.

    commanded_mm: (n, 2) commanded places.
    """
    rises_mm = np.zeros(len(commanded_mm))
    if machine is not None:
        plane_mm = machine.height_mm + commanded_mm @ machine.tilt_mm_per_mm
        # The map is not higher between its places.
        highest_mm = max((row[2] for row in machine.map_mm), default=0.0)
        rises_mm = np.maximum(plane_mm + highest_mm, 0.0)
    return height_mm + rises_mm


def keeps_lines(machine: Machine | None) -> bool:
    """Return whether commanded lines stay straight lines on the paper."""
    return machine is None or not (machine.map_mm or machine.field_mm)


def in_lines_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """Split lines, so that commanded lines keep the tool on its path.

    The lines also keep the tool's height over the paper's map. Returns places (m, k).

    points_mm: (n, k) x, y, z and further values that change evenly along the lines.
    """
    if keeps_lines(machine):
        return points_mm
    target = np.asarray(points_mm, dtype=float)
    if has_field(machine):
        target = _split_evenly(target, count_line_parts(commanded_mm(target[:, :3], machine)[:, :2], machine))
        target = _split_at_shares(target, cuts_at_field_edge(commanded_mm(target[:, :3], machine)[:, :2], machine))
    if not machine.map_mm:
        return target
    commanded = commanded_mm(target[:, :3], machine)[:, :2]
    return _split_at_shares(target, [_map_cuts(*ends, machine) for ends in pairwise(commanded)])


def _split_at_shares(points: np.ndarray, cuts) -> np.ndarray:
    """Split each line between points (n, k) at its shares. The last share of each line is 1."""
    lines = zip(pairwise(points), cuts, strict=True)
    return np.vstack([points[:1], *(a + at[:, None] * (b - a) for (a, b), at in lines)])


def _split_evenly(points: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Split each line between points (n, k) into equal parts; counts: (n - 1,) number of parts of each line."""
    line = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(line)) - np.repeat(np.cumsum(counts) - counts, counts) + 1) / counts[line]
    return np.vstack([points[:1], points[line] + share[:, None] * (points[line + 1] - points[line])])


def _map_cuts(a: np.ndarray, b: np.ndarray, machine: Machine) -> np.ndarray:
    """Return the shares at which to split the line between two places (2,).

    The shares are above 0 and up to 1. The line is split where it crosses the map's lines. Between two of these, it is
    split further if the map is hollow or domed along it, until chords are close enough.
    """
    xs, ys, heights = _map_grid(machine.map_mm)
    crossed = [
        (lines - start) / (end - start) for lines, start, end in zip((xs, ys), a, b, strict=True) if start != end
    ]
    inside = np.concatenate([[0.0, 1.0], *crossed])
    ends = np.unique(inside[(inside >= 0.0) & (inside <= 1.0)])
    cuts = []
    for first, last in pairwise(ends):
        middle, (dx, dy) = a + (first + last) / 2 * (b - a), (last - first) * (b - a)
        i, j = (_grid_cell(grid, place) for grid, place in zip((xs, ys), middle, strict=True))
        (low, high), (low_on, high_on) = heights[j : j + 2, i : i + 2]
        is_beyond = not (xs[0] <= middle[0] <= xs[-1] and ys[0] <= middle[1] <= ys[-1])
        twist = 0.0 if is_beyond else (high_on - low_on - high + low) / np.diff(xs)[i] / np.diff(ys)[j]
        count = max(1, int(np.ceil(np.sqrt(abs(twist * dx * dy) / (4 * MAX_MAP_OFFSET_MM)))))
        cuts.append(first + (last - first) * np.arange(1, count + 1) / count)
    return np.concatenate(cuts)


def _paper_height_mm(places_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """Return how much higher [mm] the paper is than taught at commanded places (n, 2), (n,)."""
    plane_mm = machine.height_mm + places_mm @ machine.tilt_mm_per_mm
    if not machine.map_mm:
        return plane_mm
    xs, ys, heights = _map_grid(machine.map_mm)
    (i, u), (j, v) = (_grid_cell_and_share(grid, places) for grid, places in zip((xs, ys), places_mm.T, strict=True))
    below = heights[j, i] * (1 - u) + heights[j, i + 1] * u
    above = heights[j + 1, i] * (1 - u) + heights[j + 1, i + 1] * u
    return plane_mm + below * (1 - v) + above * v


@lru_cache
def _map_grid(map_mm: tuple) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x (k,), y (m,) and heights (m, k) of a map. x and y are ascending."""
    rows = np.array(sorted(map_mm, key=lambda row: (row[1], row[0])))
    xs, ys = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    return xs, ys, rows[:, 2].reshape(len(ys), len(xs))


def _grid_cell(grid: np.ndarray, places):
    """Return the number of the grid cell for each place.

    Places beyond the ends of the grid belong to the nearest cell.
    """
    return np.clip(np.searchsorted(grid, places, side="right") - 1, 0, len(grid) - 2)


def _grid_cell_and_share(grid: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    number = _grid_cell(grid, places)
    return number, np.clip((places - grid[number]) / (grid[number + 1] - grid[number]), 0.0, 1.0)


def _axis_matrix(machine: Machine) -> np.ndarray:
    return np.array([[machine.scale[0], machine.skew], [0.0, machine.scale[1]]])


def max_true_per_commanded(machine: Machine | None) -> float:
    """Return how many times faster than commanded the tool may move in x and y, at least 1.

    The ratio holds for all directions and places. It leaves out the lean, which changes only with the depth.
    """
    if machine is None:
        return 1.0
    slope = max_field_slope(machine) if has_field(machine) else 0.0
    return max(1.0, float(np.linalg.norm(_axis_matrix(machine), 2)) + 2 * slope)


def true_pass(a_pass, cell: Cell):
    """Return a commanded pass as the machine runs it. Circles that the machine distorts are replaced by their poses."""
    return _transform_pass(a_pass, cell.machine, true_mm)


def commanded_pass(a_pass, cell: Cell):
    """Return the commands with which the machine runs a pass."""
    return _transform_pass(a_pass, cell.machine, commanded_mm)


def _transform_pass(a_pass, machine: Machine | None, transform):
    if machine is None:
        return a_pass
    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    arcs = []
    for arc in a_pass.arcs if is_similar(machine) else ():
        centre = transform(np.array([[*arc.centre_mm, poses[arc.first, 2]]]), machine)[0, :2]
        arcs.append(_core.Arc(arc.first, arc.last, tuple(centre.tolist()), arc.direction))
    return move_pass_to_path(a_pass, transform(poses, machine), arcs, a_pass.tool_axes)
