"""What forbids to run a plan on a machine, each in one sentence."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .cell import Cell, Station, robot_from_paper
from .frame import moved

ROUNDING_MM = 1e-6


def broken_limits(plan, brush, cell: Cell, z_offset_mm: float = 0.0) -> list[tuple[str, str]]:
    """(stroke or station, sentence) for each limit that the plan breaks; empty when the robot may run it.

    brush: asked for nothing but its name and how fast it may go.
    """
    problems = [] if plan.passes else [("", "there is nothing to paint")]
    limits = (brush.max_speed_mm_s, f"brush {brush.name}"), (cell.speeds.paint_mm_s, f"cell {cell.name}")
    limit, whose = min(limits)
    frame = robot_from_paper(cell, z_offset_mm)
    for a_pass in plan.passes:
        poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
        if len(poses) == 0:
            sentences = ["the pass has no poses"]
        elif not np.isfinite(poses).all():
            sentences = ["a pose is not a finite number"]
        else:
            sentences = [*_heights(poses, cell), *_sheet(poses, plan.sheet_mm, cell)]
            ends = poses[[0, -1]]
            ends[:, 2] = cell.heights.safe_mm
            sentences += _workspace(moved(frame, np.vstack([poses, ends])), cell)
            if not (poses[:, 2] < 0).any():
                sentences.append("the brush is never pressed to the paper: nothing would be painted")
        speed = a_pass.speed_mm_s
        if not 0 < speed <= limit:
            sentences.append(f"speed {speed:.1f} mm/s is outside the range (0, {limit:.1f}] mm/s of {whose}")
        problems += [(a_pass.stroke, sentence) for sentence in sentences]
    if cell.servo:
        heights = [np.min(a_pass.poses_mm[:, 2]) for a_pass in plan.passes if len(a_pass.poses_mm)]
        heights += [height for each in cell.stations for height in station_points(each, cell)[:, 2]]
        heights = np.array([0.0, *heights, cell.heights.safe_mm])
        problems += [("", said) for said in _servo(heights, cell, z_offset_mm)]
    for station in cell.stations:
        points = station_points(station, cell)
        problems += [(station.name, said) for said in _workspace(moved(frame, points), cell)]
        problems += [(station.name, said) for said in _sheet(points, plan.sheet_mm, cell)]
        width, height = plan.sheet_mm
        inside = (points[:, :2] > 0).all(axis=1) & (points[:, :2] < (width, height)).all(axis=1)
        if inside.any() and not station.by_hand:
            problems.append((station.name, f"its place lies on the sheet of {width:g} x {height:g} mm"))
    return problems


def workspace_problems(
    points_mm: np.ndarray, cell: Cell, z_offset_mm: float = 0.0, sheet_mm=None
) -> list[str]:
    """A sentence for each side of the cell's box and reach, and of a sheet with the margin round it, that points (n, 3)
    of the paper's frame are beyond; and for heights that a servo does not know."""
    sentences = list(_workspace(moved(robot_from_paper(cell, z_offset_mm), points_mm), cell))
    if cell.servo:
        sentences += _servo(points_mm[:, 2], cell, z_offset_mm)
    return sentences if sheet_mm is None else [*sentences, *_sheet(points_mm, sheet_mm, cell)]


def station_points(station: Station, cell: Cell) -> np.ndarray:
    """(n, 3) where a visit to a station takes the tool."""
    lowest = cell.heights.safe_mm if station.by_hand else station.surface_mm - station.depth_mm
    return np.array(
        [(*station.place_mm, cell.heights.safe_mm), (*station.place_mm, lowest), *station.wipe_mm],
        dtype=float,
    )


def _heights(poses: np.ndarray, cell: Cell) -> Iterator[str]:
    lowest, highest = poses[:, 2].min(), poses[:, 2].max()
    if highest > 0:
        yield f"height {highest:.3f} mm inside a pass is above the paper: a pass stays at z <= 0"
    elif lowest < cell.heights.lowest_mm:
        yield f"height {lowest:.1f} mm is outside the range [{cell.heights.lowest_mm:.1f}, 0.0] mm of cell {cell.name}"


def _servo(heights_mm: np.ndarray, cell: Cell, z_offset_mm: float) -> Iterator[str]:
    """A height beyond the table would silently become its end."""
    known = np.array(cell.servo.table)[:, 0]
    for height in (np.nanmin(heights_mm) + z_offset_mm, np.nanmax(heights_mm) + z_offset_mm):
        if not known.min() - ROUNDING_MM <= height <= known.max() + ROUNDING_MM:
            yield (
                f"height {height:.1f} mm is outside the range [{known.min():g}, {known.max():g}] mm of the servo "
                f"of cell {cell.name}"
            )


def _sheet(poses: np.ndarray, sheet_mm, cell: Cell) -> Iterator[str]:
    margin = cell.workspace.margin_mm
    bounds_mm = (*poses[:, :2].min(axis=0), *poses[:, :2].max(axis=0))
    for side, beyond in beyond_edges(bounds_mm, sheet_mm).items():
        if beyond - margin > ROUNDING_MM:
            yield (
                f"the TCP goes {beyond - margin:.2f} mm beyond the {side} edge of the workspace, "
                f"which is the sheet and {margin:.1f} mm around it"
            )


def _workspace(points: np.ndarray, cell: Cell) -> Iterator[str]:
    if cell.workspace.box_mm:
        low, high = np.array(cell.workspace.box_mm)
        for axis, name in enumerate("xyz"):
            least, greatest = points[:, axis].min(), points[:, axis].max()
            if least < low[axis] - ROUNDING_MM or greatest > high[axis] + ROUNDING_MM:
                worst = least if low[axis] - least > greatest - high[axis] else greatest
                yield (
                    f"the tool goes to {name} {worst:.1f} mm, outside the range "
                    f"[{low[axis]:g}, {high[axis]:g}] mm of the box of cell {cell.name}"
                )
    if cell.workspace.reach_mm:
        least, greatest = cell.workspace.reach_mm
        away = np.linalg.norm(points, axis=1)
        if away.min() < least - ROUNDING_MM or away.max() > greatest + ROUNDING_MM:
            worst = away.min() if least - away.min() > away.max() - greatest else away.max()
            yield (
                f"the tool goes {worst:.1f} mm away from the robot's origin, outside the range "
                f"[{least:g}, {greatest:g}] mm of the reach of cell {cell.name}"
            )


def beyond_edges(bounds_mm, sheet_mm) -> dict[str, float]:
    """How far (left, bottom, right, top) reaches beyond each edge of the sheet [mm]; negative inside."""
    left, bottom, right, top = bounds_mm
    width, height = sheet_mm
    return {"left": -left, "right": right - width, "lower": -bottom, "upper": top - height}
