"""Plan + Cell -> what the robot does, move by move with its meaning, every limit checked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cell import Cell
from .errors import Error

SAFE_MEANINGS = ("travel", "retract")  # at or above safe height: as fast as the machine likes

ON_THE_SPOT_MM = 1e-6


@dataclass(frozen=True)
class Move:
    """Straight lines through points_mm (n, 3), robot frame, at one speed.

    meaning: travel (at safe height, to above the start), approach (down to the clearance), land (down to the
    first pose), paint (along the poses), lift (up to the clearance), retract (up to safe height).
    """

    meaning: str
    points_mm: np.ndarray
    speed_mm_s: float


@dataclass(frozen=True)
class Section:
    """All moves that paint one stroke."""

    stroke: str
    moves: tuple[Move, ...]


@dataclass(frozen=True)
class Program:
    """header: lines for the reader of the program, each beginning with a word of ours."""

    header: tuple[str, ...]
    sections: tuple[Section, ...]
    safe_height_mm: float
    path_tolerance_mm: float
    decimals: int


def program(plan, brush, cell: Cell, header: tuple[str, ...] = ()) -> Program:
    """Moves for every pass of the plan, in order. Error, naming stroke and range, where a limit is broken.

    brush: asked for nothing but its name and how fast it may go.
    """
    for where, sentence in broken_limits(plan, brush, cell):
        raise Error(sentence, where=where)
    sections = tuple(Section(a_pass.stroke, _moves(a_pass, brush, cell)) for a_pass in plan.passes)
    return Program(header, sections, cell.safe_height_mm, cell.path_tolerance_mm, cell.decimals)


def duration_s(plan, brush, cell: Cell) -> float:
    """Time for the whole plan at the speeds asked for, acceleration left out; limits are not looked at."""
    total_s = 0.0
    above = None
    for move in (move for a_pass in plan.passes for move in _moves(a_pass, brush, cell)):
        path = move.points_mm if above is None else np.vstack([above, move.points_mm])
        total_s += float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) / move.speed_mm_s
        above = move.points_mm[-1]
    return total_s


def broken_limits(plan, brush, cell: Cell) -> list[tuple[str, str]]:
    """(stroke, sentence) for each limit that the plan breaks; empty when the robot may run it."""
    problems = [] if plan.passes else [("", "there is nothing to paint")]
    limits = (brush.max_speed_mm_s, f"brush {brush.name}"), (cell.max_paint_mm_s, f"cell {cell.name}")
    limit, whose = min(limits)
    for a_pass in plan.passes:
        poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
        sentences = []
        if len(poses) == 0:
            sentences = ["the pass has no poses"]
        elif not np.isfinite(poses).all():
            sentences = ["a pose is not a finite number"]
        else:
            sentences = _heights(poses, cell) + _workspace(poses, plan.sheet_mm, cell)
            if not (poses[:, 2] < 0).any():
                sentences.append("the brush is never pressed to the paper: nothing would be painted")
        speed = a_pass.speed_mm_s
        if not 0 < speed <= limit:
            sentences.append(f"speed {speed:.1f} mm/s is outside the range (0, {limit:.1f}] mm/s of {whose}")
        problems += [(a_pass.stroke, sentence) for sentence in sentences]
    return problems


def _heights(poses: np.ndarray, cell: Cell) -> list[str]:
    lowest, highest = poses[:, 2].min(), poses[:, 2].max()
    if highest > 0:
        return [f"height {highest:.3f} mm inside a pass is above the paper: a pass stays at z <= 0"]
    if lowest < cell.z_range_mm[0]:
        allowed = "[{:.1f}, {:.1f}]".format(*cell.z_range_mm)
        return [f"height {lowest:.1f} mm is outside the range {allowed} mm of cell {cell.name}"]
    return []


def _workspace(poses: np.ndarray, sheet_mm, cell: Cell) -> list[str]:
    margin = cell.workspace_margin_mm
    bounds_mm = (*poses[:, :2].min(axis=0), *poses[:, :2].max(axis=0))
    return [
        f"the TCP goes {beyond - margin:.2f} mm beyond the {side} edge of the workspace, "
        f"which is the sheet and {margin:.1f} mm around it"
        for side, beyond in beyond_edges(bounds_mm, sheet_mm).items()
        if beyond - margin > 1e-6
    ]


def beyond_edges(bounds_mm, sheet_mm) -> dict[str, float]:
    """How far (left, bottom, right, top) reaches beyond each edge of the sheet [mm]; negative inside."""
    left, bottom, right, top = bounds_mm
    width, height = sheet_mm
    return {"left": -left, "right": right - width, "lower": -bottom, "upper": top - height}


def _moves(a_pass, brush, cell: Cell) -> tuple[Move, ...]:
    poses = np.array(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    if len(poses) == 0:
        return ()

    def over(pose, height_mm):
        return np.array([[pose[0], pose[1], height_mm]])

    start, end = poses[0], poses[-1]
    # Pressing on the spot and lifting off bend the bristles as much as painting does: never faster than it.
    press_mm_s = min(cell.press_mm_s, a_pass.speed_mm_s)
    # In the air nothing bends; yet a program is easier to trust if no feed in it is above the brush's limit.
    approach_mm_s = min(cell.approach_mm_s, brush.max_speed_mm_s)
    moves = (
        Move("travel", over(start, cell.safe_height_mm), cell.travel_mm_s),
        Move("approach", over(start, cell.clearance_mm), approach_mm_s),
        Move("land", poses[:1], press_mm_s),
        *_painting(poses, a_pass.speed_mm_s, press_mm_s),
        Move("lift", over(end, cell.clearance_mm), press_mm_s),
        Move("retract", over(end, cell.safe_height_mm), cell.travel_mm_s),
    )
    return tuple(move for move in moves if len(move.points_mm))


def _painting(poses: np.ndarray, paint_mm_s: float, press_mm_s: float) -> list[Move]:
    """From the first pose on, straight up and down as slowly as a landing."""
    steps = np.diff(poses, axis=0)
    on_the_spot = (np.abs(steps[:, :2]).max(axis=1, initial=0.0) < ON_THE_SPOT_MM) & (steps[:, 2] != 0)
    runs = np.split(np.arange(len(steps)), np.flatnonzero(np.diff(on_the_spot)) + 1)
    return [
        Move("paint", poses[run + 1], press_mm_s if on_the_spot[run[0]] else paint_mm_s)
        for run in runs
        if len(run)
    ]
