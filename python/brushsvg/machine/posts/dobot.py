"""Write Lua (.lua) for Dobot's CR and Nova arms with controller 4.

Units are millimetres and degrees. The paper is user frame 1, and the brush's tip is tool 1.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..frames import rotation_deg
from ..moves import Move, Program, Wait
from .script import (
    QUOTE_REPLACEMENTS,
    LanguageWords,
    PointWords,
    blends_mm,
    join_numbers,
    upright_tool_rotation,
    write_points,
    write_sections,
)
from .text import PROGRAM_END, format_number, plain_text

LINE_LIMIT = 100
DEGREE_DECIMALS = 5
INDEX = 1  # index of the user frame and the tool in the controller's lists; index 0 is the base and the flange


def dobot(program: Program) -> Iterator[str]:
    """Write one chunk that runs from top to bottom.

    Points are in the user frame. To teach the paper anew, only the line of the user frame has to change. An index that
    is not in the controller's list stops the project at its first line.
    """
    cell, decimals = program.cell, program.cell.decimals
    frame = program.robot_from_frame
    paper = _pose_text(frame[:3, 3], rotation_deg(frame[:3, :3]), decimals)
    tool = _pose_text(cell.tool.tcp_mm, cell.tool.rotation_deg, decimals)
    yield "".join(map(comment, program.header))
    yield f"SetUser({INDEX}, {paper})\nSetTool({INDEX}, {tool})\nUser({INDEX})\nTool({INDEX})\nCP(0)\n"
    upright_rotation = upright_tool_rotation(cell.tool.spin_deg)
    upright = join_numbers(rotation_deg(upright_rotation), DEGREE_DECIMALS)
    yield f"\nfunction on_paper(x, y, z)\n  return {{pose = {{x, y, z, {upright}}}}}\nend\n"
    if program.tilts:
        yield "\nfunction tilted(x, y, z, rx, ry, rz)\n  return {pose = {x, y, z, rx, ry, rz}}\nend\n"
    words = LanguageWords(
        comment,
        lambda speed: _rise_lines(format_number(program.rise_mm, decimals), speed),
        _wait_lines,
        lambda move: _move_lines(move, upright_rotation, cell.blending.step_mm, decimals),
    )
    yield from write_sections(program, words)
    yield "\n" + comment(PROGRAM_END)


def comment(text: str) -> str:
    return f"-- {plain_text(text, LINE_LIMIT - 3)}\n"


def _rise_lines(height: str, speed_mm_s: float) -> str:
    return (
        f"here = GetPose({INDEX}, {INDEX}).pose\n"
        f"if here[3] < {height} then\n"
        f"  here[3] = {height}\n"
        f"  MovL({{pose = here}}, {{speed = {round_down_speed_mm_s(speed_mm_s)}}})\n"
        "end\n"
    )


def _move_lines(move: Move, upright: np.ndarray, step_mm: float, decimals: int) -> Iterator[str]:
    speed = f"speed = {round_down_speed_mm_s(move.speed_mm_s)}"
    words = PointWords(
        lambda turned: join_numbers(rotation_deg(turned), DEGREE_DECIMALS),
        lambda place, blend: f"MovL({place}, {{{speed}{', r = ' if blend else ''}{blend}}})",
        lambda place: f"Arc({place}, {place}, {{{speed}}})",
    )
    blends = np.floor(blends_mm(move, decimals) / step_mm + 1e-9) * step_mm
    yield from write_points(move, upright, words, decimals, blends, blends > 0, "%.0f" if step_mm == 1 else "")


def _wait_lines(step: Wait) -> str:
    if step.seconds is None:
        return f'print("{plain_text(step.message, 60).translate(QUOTE_REPLACEMENTS)}")\nPause()\n'
    return f"Wait({round(1e3 * step.seconds)})\n"


def round_down_speed_mm_s(speed_mm_s: float) -> int:
    """Round a speed down to whole mm/s, but not to 0.

    Rounding down keeps limits, and a machine would stand still at 0.
    """
    return max(int(np.floor(speed_mm_s + 1e-6)), 1)


def _pose_text(origin_mm, turned_deg, decimals: int) -> str:
    return f"{{{join_numbers(origin_mm, decimals)}, {join_numbers(turned_deg, DEGREE_DECIMALS)}}}"
