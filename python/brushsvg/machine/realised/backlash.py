"""Undo backlash: each axis is commanded half of it ahead of where it should be, on the side to which it goes; where it
turns back it is commanded to the other side first, and takes up its play while the tool stands.

All of it in whole units of the language, as places are written: a reader of the program finds the same places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..cells.cell import Cell, round_points, unit_mm
from ..motion import Move, Program, Section, Wait


def half_mm(cell: Cell) -> np.ndarray:
    """(2,) half of the backlash of x and y, in whole units of the language."""
    unit = unit_mm(cell)
    return np.rint(np.array(cell.machine.backlash_mm if cell.machine else (0.0, 0.0)) / 2 / unit) * unit


def undone(program: Program) -> Program:
    """Return the program, in the robot's frame, as its axes are commanded."""
    half = half_mm(program.cell)
    if not half.any():
        return program
    return replace(program, sections=lambda: _compensate_sections(program.sections(), half, program.cell))


def sides_of(ways_mm: np.ndarray, side: np.ndarray) -> np.ndarray:
    """(n, 2) to which side axes go on their ways (n, 2), 1 or -1; one that stands stays on the side that it is on, at
    first `side` (2,)."""
    signs = np.vstack([side, np.sign(ways_mm)])
    last = np.maximum.accumulate(np.where(signs != 0, np.arange(len(signs))[:, None], 0), axis=0)
    return np.take_along_axis(signs, last, axis=0)[1:]


def ahead(points_mm: np.ndarray, here_mm: np.ndarray, side: np.ndarray, half: np.ndarray) -> tuple:
    """Return (m, 3) the commands for places (n, 3) in turn from one (3,) on, the ways on which play is taken up among
    them; and the side (2,) that the axes are on then."""
    path = np.vstack([here_mm, points_mm])
    sides = sides_of(np.diff(path[:, :2], axis=0), side)
    before = np.vstack([side, sides[:-1]])
    turns = np.flatnonzero((sides != before).any(axis=1))
    compensated = points_mm + np.column_stack([sides * half, np.zeros(len(sides))])
    taken_up = path[turns] + np.column_stack([sides[turns] * half, np.zeros(len(turns))])
    return np.insert(compensated, turns, taken_up, axis=0), sides[-1]


AIR_MM = 5.0


def from_air_mm(commanded_mm: np.ndarray, backlash_mm) -> np.ndarray:
    """Return (m, 3) the commands for places (n, 3) of a pass in turn, from the air on, where each axis comes to the
    side to which it goes first. On paper along the machine's axes."""
    half, way = 0.5 * np.asarray(backlash_mm), np.round(commanded_mm, 6)
    first = first_side(np.diff(way[:, :2], axis=0))
    side = np.where(first == 0, 1.0, first)
    points = ahead(way[1:], way[0], side, half)[0] if len(way) > 1 else way[1:]
    air = way[:1] * (1, 1, 0) + (0, 0, AIR_MM)
    return np.vstack(
        [_offset(air, -side, half), _offset(air, side, half), _offset(way[:1], side, half), points]
    )


def first_side(ways_mm: np.ndarray) -> np.ndarray:
    """(2,) to which side each axis goes first on ways (n, 2); 0 where it stands."""
    signs = np.sign(ways_mm)
    return np.array([next(iter(of[of != 0]), 0.0) for of in signs.T])


def _compensate_sections(sections: Iterator[Section], half: np.ndarray, cell: Cell) -> Iterator[Section]:
    here, side = None, np.zeros(2)
    for section in sections:
        steps: list[Move | Wait] = []
        for number, step in enumerate(section.steps):
            if isinstance(step, Wait):
                steps.append(step)
                continue
            move = replace(step, points_mm=_rounded(step.points_mm, cell), blends_mm=None)
            goes_on = _side_of(section.steps[number + 1 :], move.points_mm[-1], side, cell)
            if here is None:  # from any place, an axis comes out of its play on the way to the other side
                here, side = move.points_mm[0], -goes_on
            moves, side = _compensate_moves(move, here, side, half)
            steps += moves
            here = move.points_mm[-1]
            if move.meaning == "travel" and (side != goes_on).any():
                side = goes_on  # in the air, not where the brush touches
                steps.append(replace(move, points_mm=_offset(here[None], side, half)))
        yield Section(section.title, tuple(steps))


def _rounded(points_mm: np.ndarray, cell: Cell) -> np.ndarray:
    return np.column_stack([round_points(points_mm, cell)[:, :2], np.asarray(points_mm)[:, 2]])


def _side_of(steps, here: np.ndarray, side: np.ndarray, cell: Cell) -> np.ndarray:
    """(2,) the side to which each axis goes first in steps from a place on; where it stands, the one that it is on."""
    found = np.zeros(2)
    for move in (step for step in steps if isinstance(step, Move)):
        points = _rounded(move.points_mm if move.arc is None else move.points_mm[-1:], cell)
        found = np.where(found != 0, found, first_side(np.diff(np.vstack([here, points])[:, :2], axis=0)))
        if found.all():
            break
        here = points[-1]
    return np.where(found != 0, found, np.where(side != 0, side, 1.0))


def _offset(points_mm: np.ndarray, side: np.ndarray, half: np.ndarray) -> np.ndarray:
    return points_mm + np.append(side * half, 0.0)


def _compensate_moves(
    move: Move, here: np.ndarray, side: np.ndarray, half: np.ndarray
) -> tuple[list[Move], np.ndarray]:
    """A move from a place (3,) on, and the side (2,) that the axes are on then. On a circle each axis goes one way."""
    if move.arc is None:
        points, side = ahead(move.points_mm, here, side, half)
        return [replace(move, points_mm=points)], side
    (goes,) = sides_of(move.points_mm[-1:, :2] - here[:2], side)
    turns = [replace(move, points_mm=_offset(here[None], goes, half), arc=None)] * bool((goes != side).any())
    centre = (np.array(move.arc.centre_mm) + goes * half).tolist()
    arc = replace(move.arc, centre_mm=tuple(centre))
    return [*turns, replace(move, points_mm=_offset(move.points_mm, goes, half), arc=arc)], goes
