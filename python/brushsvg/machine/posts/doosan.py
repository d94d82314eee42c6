"""Write DRL (.drl) for Doosan robots.

Units are millimetres and degrees. The paper is a user coordinate system.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..frames import zyz_deg
from ..moves import Move, Program, Wait
from .script import (
    QUOTE_REPLACEMENTS,
    LanguageWords,
    PointWords,
    blends_mm,
    format_rounded_down,
    join_numbers,
    upright_tool_rotation,
    write_points,
    write_sections,
)
from .text import PROGRAM_END, format_number, plain_text
from .xarm import NAMES_LETTERS

LINE_LIMIT = 100
DEGREE_DECIMALS = 5
SPEED_DECIMALS = 3
# Limits of the tool's turn in degrees/s and degrees/s^2. The arm slows down where a plan turns the tool faster.
TURN_SPEED_LIMITS = "30.000"
TCP = "brush"

CHECKS = f"""set_tcp("{TCP}")
tip = get_current_posx(DR_BASE)[0]
flange = get_current_tool_flange_posx(DR_BASE)
tip_mm = sum((tip[k] - flange[k]) ** 2 for k in range(3)) ** 0.5
"""
STOPS = f"""    tp_popup("TCP {TCP} is not as long as the cell says", DR_PM_ALARM, 0)
    exit()
"""


def doosan(program: Program) -> Iterator[str]:
    """Write one script that runs from top to bottom.

    Points are in the user coordinate system. To teach the paper anew, only the line of this system has to change. A
    script can choose a tool only by its name. The script therefore checks the tool's length before anything moves.
    """
    cell, decimals = program.cell, program.cell.decimals
    frame = program.robot_from_frame
    paper = f"{join_numbers(frame[:3, 3], decimals)}, {join_numbers(zyz_deg(frame[:3, :3]), DEGREE_DECIMALS)}"
    yield NAMES_LETTERS.sub("coding ", "".join(map(comment, program.header)))
    yield CHECKS
    yield f"if abs(tip_mm - {format_number(np.linalg.norm(cell.tool.tcp_mm), decimals)}) > 1.0:\n{STOPS}"
    yield f"set_accx({format_rounded_down(cell.speeds.acceleration_mm_s2, SPEED_DECIMALS)}, {TURN_SPEED_LIMITS})\n"
    yield f"paper = set_user_cart_coord(posx({paper}), ref=DR_BASE)\nset_ref_coord(paper)\n"
    upright_rotation = upright_tool_rotation(cell.tool.spin_deg)
    upright = join_numbers(zyz_deg(upright_rotation), DEGREE_DECIMALS)
    yield f"\n\ndef on_paper(x, y, z):\n    return posx(x, y, z, {upright})\n\n"
    if program.tilts:
        yield "\ndef tilted(x, y, z, a, b, c):\n    return posx(x, y, z, a, b, c)\n\n"
    words = LanguageWords(
        comment,
        lambda speed: _rise_lines(format_number(program.rise_mm, decimals), speed),
        _wait_lines,
        lambda move: _move_lines(move, upright_rotation, decimals),
    )
    yield from write_sections(program, words)
    yield "\n" + comment(PROGRAM_END)


def comment(text: str) -> str:
    return f"# {plain_text(text, LINE_LIMIT - 2)}\n"


def _rise_lines(height: str, speed_mm_s: float) -> str:
    return (
        f"here = get_current_posx(paper)[0]\n{_speed_line(speed_mm_s)}"
        f"if here[2] < {height}:\n    here[2] = {height}\n    movel(here)\n"
    )


def _move_lines(move: Move, upright: np.ndarray, decimals: int) -> Iterator[str]:
    yield _speed_line(move.speed_mm_s)
    words = PointWords(
        lambda turned: join_numbers(zyz_deg(turned), DEGREE_DECIMALS),
        lambda place, blend: f"movel({place}{', radius=' if blend else ''}{blend})",
        lambda place: f"movec({place}, {place})",
    )
    blends = blends_mm(move, decimals)
    yield from write_points(move, upright, words, decimals, blends, blends > 0)


def _wait_lines(step: Wait) -> str:
    if step.seconds is None:
        return f'tp_popup("{plain_text(step.message, 60).translate(QUOTE_REPLACEMENTS)}", DR_PM_MESSAGE, 1)\n'
    return f"wait({format_number(step.seconds, 3)})\n"


def _speed_line(speed_mm_s: float) -> str:
    return f"set_velx({format_rounded_down(speed_mm_s, SPEED_DECIMALS)}, {TURN_SPEED_LIMITS})\n"
