"""Write JAKA script (.jks) for JAKA robots.

Units are millimetres and degrees. Points are in the robot's own frame.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..cells.cell import Blending
from ..frames import rotation, rotation_deg
from ..moves import Move, Program, Wait
from .script import (
    LanguageWords,
    PointWords,
    blends_mm,
    format_rounded_down,
    join_numbers,
    upright_deg,
    write_points,
    write_sections,
)
from .text import PROGRAM_END, format_number, plain_text

LINE_LIMIT = 100
DEGREE_DECIMALS = 4
SPEED_DECIMALS = 3


def jaka(program: Program) -> Iterator[str]:
    """Write a program in the robot's base frame.

    A move needs a variable with its pose, so each move has two lines.

    The last number of a move is the tolerance of its end. With 0 the end is met exactly, otherwise the next move may
    begin earlier. The number is never more than the blending's tolerance. The corner is then cut by at most this
    tolerance, whether the controller reads the number as the remaining path or as the distance to the corner.
    """
    cell, decimals = program.cell, program.cell.decimals
    yield "".join(map(comment, program.header))
    yield "set_user_frame_id(0)\n"
    yield (
        f"tool = [{join_numbers(cell.tool.tcp_mm, decimals)}, "
        f"{join_numbers(cell.tool.rotation_deg, DEGREE_DECIMALS)}]\n"
    )
    yield "set_tool(tool)\n"
    turned = join_numbers(upright_deg(cell), DEGREE_DECIMALS)
    upright = rotation(upright_deg(cell))
    acceleration = format_number(cell.speeds.acceleration_mm_s2, SPEED_DECIMALS)
    words = LanguageWords(
        comment,
        lambda speed: _rise_lines(program.rise_mm, speed, acceleration, decimals),
        _wait_lines,
        lambda move: _move_lines(move, turned, upright, acceleration, cell.blending, decimals),
    )
    yield from write_sections(program, words)
    yield "\n" + comment(PROGRAM_END)


def comment(text: str) -> str:
    return f"# {plain_text(text, LINE_LIMIT - 2)}\n"


def _rise_lines(height_mm: float, speed_mm_s: float, acceleration: str, decimals: int) -> str:
    """Return a rise to a height along the base's z axis. The tool's orientation does not change."""
    height = format_number(height_mm, decimals)
    return (
        "here = get_atl_tcp_pose()\n"
        f"if(here[2] < {height}):\n"
        f"  rise = ({height} - here[2])\n"
        "  up = [0, 0, rise, 0, 0, 0]\n"
        f"  movl(up, 1, {_speed_text(speed_mm_s)}, {acceleration}, 0)\n"
        "end\n"
    )


def _move_lines(
    move: Move, turned: str, upright: np.ndarray, acceleration: str, blending: Blending, decimals: int
) -> Iterator[str]:
    run = f"0, {_speed_text(move.speed_mm_s)}, {acceleration}"
    words = PointWords(
        lambda tilted: join_numbers(rotation_deg(tilted), DEGREE_DECIMALS),
        lambda place, blend: f"to = {place}\nmovl(to, {run}, {blend})",
        lambda place: f"via = {place}\nto = {place}\nmovc(via, to, {run}, 0)",
        lambda place, angles: f"[{place}, {angles or turned}]",
    )
    cut_mm = np.minimum(blends_mm(move, decimals), np.floor(blending.tolerance_mm * 10.0**decimals) / 10.0**decimals)
    yield from write_points(move, upright, words, decimals, cut_mm, np.full(len(cut_mm), True))


def _wait_lines(step: Wait) -> str:
    if step.seconds is None:
        return comment(f"stop: {step.message}") + "pause()\n"
    return f"sleep({format_number(step.seconds, 3)})\n"


def _speed_text(speed_mm_s: float) -> str:
    return format_rounded_down(speed_mm_s, SPEED_DECIMALS)
