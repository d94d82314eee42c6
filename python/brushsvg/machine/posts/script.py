"""What the scripts of robot arms have in common: sections with titles, a rise before anything else, numbers."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ..cells.cell import MAX_PROGRAM_LINES, Cell, robot_from_paper
from ..frames import rotation, rotation_deg
from ..motion import Move, Program, Section, Wait
from ..tool_axes import is_parallel, turned_to
from .text import number

RISE_MM_S = 50.0
QUIET = {ord('"'): "'", ord("\\"): "/"}  # what would end a text between quotes


class Words(NamedTuple):
    """How a language says what a program is made of.

    title: a comment; rise: straight up, at a speed [mm/s], by what is missing; wait: see Wait; lines: of a move.
    """

    title: Callable[[str], str]
    rise: Callable[[float], str]
    wait: Callable[[Wait], str]
    lines: Callable[[Move], Iterator[str]]


def body(program: Program, words: Words) -> Iterator[str]:
    """All sections; before the first move the tool goes straight up."""
    risen = False
    for section in program.sections():
        yield "\n"
        yield from section_lines(section, words, risen)
        risen = risen or bool(section.moves)


def parts(program: Program, words: Words, around: int, rises_again: bool) -> Iterator[str]:
    """Split the sections into parts, none with more lines than one program of the language may have.

    A section with more lines is a part by itself. around: lines that each program has in addition to these;
    rises_again: whether the tool goes straight up in each part, else in the first alone.
    """
    most = MAX_PROGRAM_LINES[program.cell.language] - around
    text, lines, risen = "", 0, False
    for section in program.sections():
        more = "\n" + "".join(section_lines(section, words, risen))
        if text and lines + more.count("\n") > most:
            yield text
            text, lines = "", 0
            if rises_again:
                risen = False
                more = "\n" + "".join(section_lines(section, words, risen))
        text += more
        lines += more.count("\n")
        risen = risen or bool(section.moves)
    yield text


def part_name(setup: str, number: int) -> str:
    """Name a program that another one calls, by the text of that one: the names of two jobs differ."""
    return f"B{hashlib.sha256(setup.encode()).hexdigest()[:4].upper()}{number:03d}"


def section_lines(section: Section, words: Words, risen: bool) -> Iterator[str]:
    """One section; risen: whether the tool has gone straight up before."""
    yield words.title(section.title)
    for step in section.steps:
        if isinstance(step, Wait):
            yield words.wait(step)
            continue
        if not risen:
            yield words.rise(min(step.speed_mm_s, RISE_MM_S))
            risen = True
        yield from words.lines(step)


def rounded_down(value: float, decimals: int) -> str:
    """So that a limit is kept; but not to 0, at which a machine stands still."""
    unit = 10.0**decimals
    return number(max(np.floor(value * unit + 1e-6), 1) / unit, decimals)


def numbers(values, decimals: int) -> str:
    return ", ".join(number(value, decimals) for value in values)


def blends_mm(move: Move, decimals: int, part: float = 1.0) -> np.ndarray:
    """(n,) how far before each point of a move its blend begins, of that only a part, rounded down; 0 at the last one,
    since what follows may turn back."""
    blends = np.zeros(len(move.points_mm))
    blends[:-1] = move.blends_mm[:-1]
    return np.floor(blends * part * 10.0**decimals) / 10.0**decimals


def down(spin_deg: float) -> np.ndarray:
    """(3, 3) the tool in the paper's frame, its z into the paper."""
    return np.diag([1.0, -1.0, -1.0]) @ rotation((0, 0, spin_deg))


def turned_at(move: Move, upright: np.ndarray) -> Iterator[np.ndarray | None]:
    """(3, 3) the tool at each point of a move, in the frame in which it is upright (3, 3); None where it is."""
    if move.axes is None:
        yield from [None] * len(move.points_mm)
        return
    stands = is_parallel(move.axes, -upright[:, 2])
    for turned, is_upright in zip(turned_to(move.axes, upright), stands.tolist(), strict=True):
        yield None if is_upright else turned


def upright_deg(cell: Cell) -> np.ndarray:
    """(3,) the tool in the robot's frame, the brush upright on the paper: about the fixed x, then y, then z axis."""
    return rotation_deg(robot_from_paper(cell)[:3, :3] @ down(cell.tool.spin_deg))
