"""Compensate backlash.

Each axis is commanded half of the backlash ahead of its place, in the direction in which it moves. Where an axis turns
back, it is first commanded to the other side, and takes up its play while the tool stands still.

All offsets are whole units of the language, as written places are. A reader of the program then finds the same places.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..cells.cell import Cell, round_points, unit_mm
from ..moves import Move, Program, Section, Wait


def half_mm(cell: Cell) -> np.ndarray:
    """Return half of the backlash of x and y (2,) [mm]. It is rounded to whole units of the language."""
    unit = unit_mm(cell)
    return np.rint(np.array(cell.machine.backlash_mm if cell.machine else (0.0, 0.0)) / 2 / unit) * unit


def compensate_backlash(program: Program) -> Program:
    """Return a program with the backlash of its axes compensated. The program must be in the robot's frame."""
    half = half_mm(program.cell)
    if not half.any():
        return program
    return replace(program, sections=lambda: _compensate_sections(program.sections(), half, program.cell))


def sides_of_steps(ways_mm: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Return the side, 1 or -1, to which each axis goes on each step, (n, 2).

    An axis that stands still stays on its side.

    side: (2,) sides before the first step.
    """
    signs = np.vstack([side, np.sign(ways_mm)])
    last_moving = np.maximum.accumulate(np.where(signs != 0, np.arange(len(signs))[:, None], 0), axis=0)
    return np.take_along_axis(signs, last_moving, axis=0)[1:]


def commands_ahead(points_mm: np.ndarray, here_mm: np.ndarray, side: np.ndarray, half: np.ndarray) -> tuple:
    """Return the commands for places in turn, and the final sides of the axes.

    The commands include the moves that take up the play.

    points_mm: (n, 3) the places. The commands are (m, 3), and the sides are (2,).
    here_mm: (3,) place before the first one.
    """
    path = np.vstack([here_mm, points_mm])
    sides = sides_of_steps(np.diff(path[:, :2], axis=0), side)
    before = np.vstack([side, sides[:-1]])
    turns = np.flatnonzero((sides != before).any(axis=1))
    compensated = points_mm + np.column_stack([sides * half, np.zeros(len(sides))])
    taken_up = path[turns] + np.column_stack([sides[turns] * half, np.zeros(len(turns))])
    return np.insert(compensated, turns, taken_up, axis=0), sides[-1]


START_HEIGHT_MM = 5.0  # height at which from_air_mm begins


def from_air_mm(commanded_mm: np.ndarray, backlash_mm) -> np.ndarray:
    """Return the commands (m, 3) for places (n, 3) of a pass, beginning in the air.

    In the air, each axis comes to the side to which it goes first. The paper must be aligned with the machine's axes.
    """
    half, path = 0.5 * np.asarray(backlash_mm), np.round(commanded_mm, 6)
    first = first_side(np.diff(path[:, :2], axis=0))
    side = np.where(first == 0, 1.0, first)
    points = commands_ahead(path[1:], path[0], side, half)[0] if len(path) > 1 else path[1:]
    air = path[:1] * (1, 1, 0) + (0, 0, START_HEIGHT_MM)
    return np.vstack(
        [
            _offset_to_side(air, -side, half),
            _offset_to_side(air, side, half),
            _offset_to_side(path[:1], side, half),
            points,
        ]
    )


def first_side(ways_mm: np.ndarray) -> np.ndarray:
    """Return the side to which each axis goes first on steps (n, 2), (2,). It is 0 for an axis that stands still."""
    signs = np.sign(ways_mm)
    return np.array([next(iter(axis_signs[axis_signs != 0]), 0.0) for axis_signs in signs.T])


def _compensate_sections(sections: Iterator[Section], half: np.ndarray, cell: Cell) -> Iterator[Section]:
    last_point, side = None, np.zeros(2)
    for section in sections:
        steps: list[Move | Wait] = []
        for number, step in enumerate(section.steps):
            if isinstance(step, Wait):
                steps.append(step)
                continue
            move = replace(step, points_mm=_round_sideways(step.points_mm, cell), blends_mm=None)
            next_side = _next_side(section.steps[number + 1 :], move.points_mm[-1], side, cell)
            if last_point is None:  # the axis leaves its play on the way to the other side, from any place
                last_point, side = move.points_mm[0], -next_side
            moves, side = _compensate_moves(move, last_point, side, half)
            steps += moves
            last_point = move.points_mm[-1]
            if move.meaning == "travel" and (side != next_side).any():
                side = next_side  # take up the play in the air, not on the paper
                steps.append(replace(move, points_mm=_offset_to_side(last_point[None], side, half)))
        yield Section(section.title, tuple(steps))


def _round_sideways(points_mm: np.ndarray, cell: Cell) -> np.ndarray:
    return np.column_stack([round_points(points_mm, cell)[:, :2], np.asarray(points_mm)[:, 2]])


def _next_side(steps, here: np.ndarray, side: np.ndarray, cell: Cell) -> np.ndarray:
    """Return the side (2,) to which each axis goes first in the next steps.

    An axis that stands still keeps its side.
    """
    sides = np.zeros(2)
    for move in (step for step in steps if isinstance(step, Move)):
        points = _round_sideways(move.points_mm if move.arc is None else move.points_mm[-1:], cell)
        sides = np.where(sides != 0, sides, first_side(np.diff(np.vstack([here, points])[:, :2], axis=0)))
        if sides.all():
            break
        here = points[-1]
    return np.where(sides != 0, sides, np.where(side != 0, side, 1.0))


def _offset_to_side(points_mm: np.ndarray, side: np.ndarray, half: np.ndarray) -> np.ndarray:
    return points_mm + np.append(side * half, 0.0)


def _compensate_moves(
    move: Move, here: np.ndarray, side: np.ndarray, half: np.ndarray
) -> tuple[list[Move], np.ndarray]:
    """Compensate a move, and return its moves and the final sides of the axes.

    The move begins at the place `here` (3,). The sides are (2,). On a circle, each axis keeps its direction.
    """
    if move.arc is None:
        points, side = commands_ahead(move.points_mm, here, side, half)
        return [replace(move, points_mm=points)], side
    (sides,) = sides_of_steps(move.points_mm[-1:, :2] - here[:2], side)
    take_up = [replace(move, points_mm=_offset_to_side(here[None], sides, half), arc=None)] * bool(
        (sides != side).any()
    )
    centre = (np.array(move.arc.centre_mm) + sides * half).tolist()
    arc = replace(move.arc, centre_mm=tuple(centre))
    return [*take_up, replace(move, points_mm=_offset_to_side(move.points_mm, sides, half), arc=arc)], sides
