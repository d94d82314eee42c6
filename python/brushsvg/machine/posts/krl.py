"""Moves -> KRL (.src) for KUKA robots: millimetres, degrees, the paper as BASE, the brush's tip as TOOL."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from tempfile import SpooledTemporaryFile

import numpy as np

from ..frames import frame_of_pose, rotation_deg
from ..motion import Move, Program, Wait, via_point
from .script import (
    LanguageWords,
    blends_mm,
    down,
    format_rounded_down,
    join_numbers,
    name_part,
    split_into_parts,
    tool_rotations_at,
)
from .text import format_number, format_rows, plain_text

LINE_LIMIT = 100
DEGREE_DECIMALS = 5
SPEED_DECIMALS = 6  # of m/s
HELD_BYTES = 20_000_000  # of text, before it goes to a file
MAIN = "brushsvg"
RISES = "DECL E6POS here\n"
AROUND = 3  # lines of a program that is called, next to its moves
KRL_END = "end: the brush is held up"


def krl(program: Program) -> Iterator[str]:
    """One .src without a .dat: all points stand in it; of a long job a main one that calls others, each with whole
    strokes. They are those of the BASE: to teach the paper anew, only its line has to change. The first move goes to
    where the robot is, as a first one must be PTP."""
    cell, decimals = program.cell, program.cell.decimals
    acceleration = format_rounded_down(cell.speeds.acceleration_mm_s2 / 1e3, 3)
    tool = frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg)
    header = "".join(map(comment, program.header))
    setup = "BAS(#INITMOV, 0)\n"
    setup += f"$TOOL = {_frame(tool, decimals)}\n$BASE = {_frame(program.robot_from_frame, decimals)}\n"
    if program.tilts:
        setup += "$ORI_TYPE = #VAR\n"  # #CONSTANT, of a program before, would hold the tool as it was
    setup += f"PTP $AXIS_ACT\n$ACC.CP = {acceleration}\n"
    upright = down(cell.tool.spin_deg)
    turned = _angles(rotation_deg(upright))
    words = LanguageWords(
        comment,
        lambda speed: _rise(format_number(program.rise_mm, decimals), speed),
        _wait,
        lambda move: (
            _lines(move, turned, decimals) if move.axes is None else _tilted(move, upright, decimals)
        ),
    )
    made = split_into_parts(program, words, AROUND, rises_again=False)
    end = comment(KRL_END) + "END\n"
    first, second = next(made), next(made, None)
    if second is None:
        yield f"DEF {MAIN}()\n{header}{RISES}{setup}{first}\n{end}"
        return
    calls, setup = "", header + setup
    with SpooledTemporaryFile(HELD_BYTES, "w+", encoding="ascii") as held:
        for count, moves in enumerate(itertools.chain((first, second), made), 1):
            name = name_part(setup, count)
            calls += f"{name}()\n"
            held.write(f"DEF {name}()\n{RISES if count == 1 else ''}{moves}END\n")
        yield f"DEF {MAIN}()\n{setup}{calls}{end}"
        held.seek(0)
        while piece := held.read(1_000_000):
            yield piece


def programs(text: str) -> dict[str, str]:
    """Return the texts of a stream of programs in a dictionary of names, the main one's as ""."""
    found = re.split(r"^(?=DEF )", text, flags=re.MULTILINE)[1:]
    named = {re.match(r"DEF (\w+)", each)[1]: each for each in found}
    return {"" if name == MAIN else name: each for name, each in named.items()}


def called(text: str) -> list[str]:
    """Names of the programs that one calls, in order, each once."""
    found = re.finditer(r"^ *(B[0-9A-F]{4}\d{3,})\(\) *\r?$", text, re.MULTILINE | re.IGNORECASE)
    return list(dict.fromkeys(each[1].upper() for each in found))


def comment(text: str) -> str:
    return f"; {plain_text(text, LINE_LIMIT - 2)}\n"


def _rise(height: str, speed_mm_s: float) -> str:
    return (
        f"here = $POS_ACT\n{_speed(speed_mm_s)}"
        f"IF here.Z < {height} THEN\n  here.Z = {height}\n  LIN here\nENDIF\n"
    )


def _lines(move: Move, turned: str, decimals: int) -> Iterator[str]:
    yield _speed(move.speed_mm_s)
    point = f"{{X %.{decimals}f, Y %.{decimals}f, Z %.{decimals}f, {turned}}}"
    if move.arc is not None:
        values = np.array([[*via_point(move.points_mm), *move.points_mm[-1]]])
        yield from format_rows(f"CIRC {point}, {point}", values, decimals)
        return
    blends = np.zeros(len(move.points_mm)) if move.blends_mm is None else blends_mm(move, decimals)
    values, is_blended = np.column_stack([blends, move.points_mm]), blends > 0
    for run in np.split(np.arange(len(values)), np.flatnonzero(np.diff(is_blended)) + 1):
        if is_blended[run[0]]:
            yield from format_rows(f"$APO.CDIS = %.{decimals}f\nLIN {point} C_DIS", values[run], decimals)
        else:
            yield from format_rows(f"LIN {point}", values[run, 1:], decimals)


def _tilted(move: Move, upright: np.ndarray, decimals: int) -> Iterator[str]:
    """The same moves, each with how the tool is held at its end; where that is upright as all others are written."""
    yield _speed(move.speed_mm_s)
    blends = np.zeros(len(move.points_mm)) if move.blends_mm is None else blends_mm(move, decimals)
    stands = _angles(rotation_deg(upright))
    rows_of = zip(move.points_mm, tool_rotations_at(move, upright), blends.tolist(), strict=True)
    for point, turned, blend in rows_of:
        x, y, z = join_numbers(point, decimals).split(", ")
        angles = stands if turned is None else _angles(rotation_deg(turned))
        place = f"{{X {x}, Y {y}, Z {z}, {angles}}}"
        yield (
            f"$APO.CDIS = {format_number(blend, decimals)}\nLIN {place} C_DIS\n"
            if blend > 0
            else f"LIN {place}\n"
        )


def _wait(step: Wait) -> str:
    if step.seconds is None:
        return comment(f"stop: {step.message}") + "HALT\n"
    return f"WAIT SEC {format_number(step.seconds, 3)}\n"


def _speed(speed_mm_s: float) -> str:
    return f"$VEL.CP = {format_rounded_down(speed_mm_s / 1e3, SPEED_DECIMALS)}\n"


def _frame(frame: np.ndarray, decimals: int) -> str:
    x, y, z = join_numbers(frame[:3, 3], decimals).split(", ")
    return f"{{X {x}, Y {y}, Z {z}, {_angles(rotation_deg(frame[:3, :3]))}}}"


def _angles(about_xyz_deg: np.ndarray) -> str:
    """A turns about z, then B about the new y, then C about the newest x: the same as fixed x, y, z backwards."""
    a, b, c = join_numbers(about_xyz_deg[::-1], DEGREE_DECIMALS).split(", ")
    return f"A {a}, B {b}, C {c}"
