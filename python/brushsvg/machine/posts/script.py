"""Common parts of scripts for robot arms: sections, the first rise, numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ..cells.cell import Cell, robot_from_paper
from ..frames import rotation, rotation_deg
from ..moves import Move, Program, Section, Wait, via_point
from ..tool_axes import is_parallel, turned_to
from .text import format_number, format_rows

MAX_RISE_MM_S = 50.0
QUOTE_REPLACEMENTS = {ord('"'): "'", ord("\\"): "/"}  # for letters that would end a text between quotes


class LanguageWords(NamedTuple):
    """Functions that write the elements of a program in one language.

    title: writes a title as a comment.
    rise: writes the rise straight up to the program's height, at a speed [mm/s].
    wait: writes a Wait.
    lines: yields the lines of a move.
    """

    title: Callable[[str], str]
    rise: Callable[[float], str]
    wait: Callable[[Wait], str]
    lines: Callable[[Move], Iterator[str]]


def write_sections(program: Program, words: LanguageWords) -> Iterator[str]:
    """Yield all sections. Before the first move, the tool goes straight up."""
    risen = False
    for section in program.sections():
        yield "\n"
        yield from write_section(section, words, risen)
        risen = risen or bool(section.moves)


def write_section(section: Section, words: LanguageWords, risen: bool) -> Iterator[str]:
    """Yield the text of a section. risen: whether the tool has already gone straight up."""
    yield words.title(section.title)
    for step in section.steps:
        if isinstance(step, Wait):
            yield words.wait(step)
            continue
        if not risen:
            yield words.rise(min(step.speed_mm_s, MAX_RISE_MM_S))
            risen = True
        yield from words.lines(step)


def format_rounded_down(value: float, decimals: int) -> str:
    """Format a number rounded down, but not to 0. Rounding down keeps limits, and a machine would stand still at 0."""
    unit = 10.0**decimals
    return format_number(max(np.floor(value * unit + 1e-6), 1) / unit, decimals)


def join_numbers(values, decimals: int) -> str:
    return ", ".join(format_number(value, decimals) for value in values)


def blends_mm(move: Move, decimals: int, part: float = 1.0) -> np.ndarray:
    """Return how far [mm] before each point of a move its blend begins, (n,).

    The distances are rounded down. They are 0 for a move without blends, and at the last point, because the next move
    may turn back.

    part: fraction of the blend distance to use.
    """
    blends = np.zeros(len(move.points_mm))
    if move.blends_mm is not None:
        blends[:-1] = move.blends_mm[:-1]
    return np.floor(blends * part * 10.0**decimals) / 10.0**decimals


def place_on_paper(place: str, angles: str) -> str:
    """Return a call of the function that makes a pose on the paper, with an upright or a tilted brush."""
    return f"tilted({place}, {angles})" if angles else f"on_paper({place})"


class PointWords(NamedTuple):
    """Functions that write the points of a move in one language.

    angles: writes the tool's rotation (3, 3).
    line: writes the line to a place with the distance of its blend, which is "" where the place is met exactly.
    circle: writes a circle through two places of the given pattern.
    place: writes a place from its coordinates "x, y, z" and its angles, which are "" where the brush is upright.
    """

    angles: Callable[[np.ndarray], str]
    line: Callable[[str, str], str]
    circle: Callable[[str], str] | None = None
    place: Callable[[str, str], str] = place_on_paper


def write_points(
    move: Move,
    upright: np.ndarray,
    words: PointWords,
    decimals: int,
    blends: np.ndarray,
    is_blended: np.ndarray,
    blend_pattern: str = "",
    units_per_mm: float = 1.0,
) -> Iterator[str]:
    """Yield the lines to the points of a move.

    If the move tilts the brush, each line has the tool's orientation at its end. Where the brush is upright, the lines
    are those of other moves.

    upright: (3, 3) rotation of the tool with an upright brush.
    blends, is_blended: (n,) distance of each point's blend in the language's unit, and whether its line names the
    distance.
    blend_pattern: how a distance is written, by default as a coordinate.
    units_per_mm: how many units of the language a millimetre has.
    """
    number = f"%.{decimals}f"
    blend_pattern = blend_pattern or number
    point = words.place(", ".join([number] * 3), "")
    if move.arc is not None:
        values = np.array([[*via_point(move.points_mm), *move.points_mm[-1]]]) * units_per_mm
        yield from format_rows(words.circle(point), values, decimals)
        return
    points = move.points_mm * units_per_mm
    if move.axes is not None:
        rotations = tool_rotations_at(move, upright)
        for place, turned, blend, names_blend in zip(points, rotations, blends, is_blended, strict=True):
            text = words.place(join_numbers(place, decimals), "" if turned is None else words.angles(turned))
            yield words.line(text, blend_pattern % blend if names_blend else "") + "\n"
        return
    plain, blended = words.line(point, ""), words.line(point, blend_pattern)
    columns = [points, blends]
    if "%" in blended[: blended.index(point)]:
        columns.reverse()  # the language names the blend before the place
    values = np.column_stack(columns)
    for run in np.split(np.arange(len(blends)), np.flatnonzero(np.diff(is_blended)) + 1):
        if is_blended[run[0]]:
            yield from format_rows(blended, values[run], decimals)
        else:
            yield from format_rows(plain, points[run], decimals)


def upright_tool_rotation(spin_deg: float) -> np.ndarray:
    """Return the rotation (3, 3) of an upright tool in the paper's frame. The tool's z axis points into the paper."""
    return np.diag([1.0, -1.0, -1.0]) @ rotation((0, 0, spin_deg))


def tool_rotations_at(move: Move, upright: np.ndarray) -> Iterator[np.ndarray | None]:
    """Yield the tool's rotation (3, 3) at each point of a move.

    It is None where the brush is upright.

    upright: (3, 3) rotation of the tool with an upright brush. It defines the frame of the result.
    """
    if move.axes is None:
        yield from [None] * len(move.points_mm)
        return
    is_upright_at = is_parallel(move.axes, -upright[:, 2])
    for turned, is_upright in zip(turned_to(move.axes, upright), is_upright_at.tolist(), strict=True):
        yield None if is_upright else turned


def upright_deg(cell: Cell) -> np.ndarray:
    """Return the angles [degrees] of an upright tool in the robot's frame, (3,).

    The angles are about the fixed x, then y, then z axis. The brush is upright on the paper.
    """
    return rotation_deg(robot_from_paper(cell)[:3, :3] @ upright_tool_rotation(cell.tool.spin_deg))
