"""Write RAPID (.mod) for ABB robots.

Units are millimetres. The paper is a work object, and the brush's tip is the tool.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..frames import frame_of_pose, quaternion
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

LINE_LIMIT = 100
TURN_DECIMALS = 7  # decimals of quaternions: a tenth of a micrometre at a distance of a metre
SPEED_DECIMALS = 3
STRING_LIMIT = 60
BRUSH_KG = 0.5  # an assumed weight, because the robot refuses a load of 0
TOOL_AND_WORK_OBJECT = r"brush\WObj:=paper"

_FUNCTIONS = """
  FUNC speeddata mm_s(num speed)
    RETURN [speed, 500, 5000, 1000];
  ENDFUNC

  FUNC zonedata within(num radius)
    IF radius = 0 THEN
      RETURN fine;
    ENDIF
    RETURN [FALSE, radius, radius, radius, 0.1, radius, 0.1];
  ENDFUNC
"""


def rapid(program: Program) -> Iterator[str]:
    """Write a module whose routine `paint` does everything.

    Points are in the work object `paper`. To teach the paper anew, only the line of the work object has to change.
    Configurations are free, so the robot keeps the configuration in which it was put over the sheet.
    """
    cell, decimals = program.cell, program.cell.decimals
    acceleration = format_rounded_down(cell.speeds.acceleration_mm_s2 / 1e3, SPEED_DECIMALS)
    tool = frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg)
    load = f"[{BRUSH_KG}, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0]"
    upright_rotation = upright_tool_rotation(cell.tool.spin_deg)
    upright = _quaternion_text(upright_rotation)
    paper = _pose_text(program.robot_from_frame, decimals)
    yield "MODULE brushsvg\n"
    yield "".join(map(comment, program.header))
    yield f"  LOCAL PERS tooldata brush := [TRUE, {_pose_text(tool, decimals)}, {load}];\n"
    yield (
        f'  LOCAL PERS wobjdata paper := [FALSE, TRUE, "", {paper}, [[0, 0, 0], [1, 0, 0, 0]]];\n'
        "  LOCAL VAR robtarget here;\n\n"
        "  FUNC robtarget on_paper(num x, num y, num z)\n"
        f"    RETURN [[x, y, z], [{upright}], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];\n"
        "  ENDFUNC\n"
    )
    if program.tilts:
        yield (
            "\n  FUNC robtarget tilted(num x, num y, num z, num q1, num q2, num q3, num q4)\n"
            "    RETURN [[x, y, z], [q1, q2, q3, q4], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];\n"
            "  ENDFUNC\n"
        )
    yield _FUNCTIONS
    yield "\n  PROC paint()\n    ConfL \\Off;\n"
    yield f"    PathAccLim TRUE \\AccMax:={acceleration}, TRUE \\DecelMax:={acceleration};\n"
    words = LanguageWords(
        comment,
        lambda speed: _rise_lines(program.rise_mm, speed, decimals),
        _wait_lines,
        lambda move: _move_lines(move, upright_rotation, decimals),
    )
    yield from write_sections(program, words)
    yield "\n" + comment(PROGRAM_END) + "  ENDPROC\nENDMODULE\n"


def comment(text: str) -> str:
    return f"  ! {plain_text(text, LINE_LIMIT - 4)}\n"


def _rise_lines(height_mm: float, speed_mm_s: float, decimals: int) -> str:
    height = format_number(height_mm, decimals)
    return (
        "    here := CRobT(\\Tool:=brush \\WObj:=paper);\n"
        f"    IF here.trans.z < {height} THEN\n"
        f"      here.trans.z := {height};\n"
        f"      MoveL here, mm_s({format_rounded_down(speed_mm_s, SPEED_DECIMALS)}), fine, {TOOL_AND_WORK_OBJECT};\n"
        "    ENDIF\n"
    )


def _move_lines(move: Move, upright: np.ndarray, decimals: int) -> Iterator[str]:
    speed = f"mm_s({format_rounded_down(move.speed_mm_s, SPEED_DECIMALS)})"
    words = PointWords(
        _quaternion_text,
        lambda place, blend: (
            f"    MoveL {place}, {speed}, {f'within({blend})' if blend else 'fine'}, {TOOL_AND_WORK_OBJECT};"
        ),
        lambda place: f"    MoveC {place}, {place}, {speed}, fine, {TOOL_AND_WORK_OBJECT};",
    )
    has_blends = np.full(len(move.points_mm), move.blends_mm is not None)
    yield from write_points(move, upright, words, decimals, blends_mm(move, decimals), has_blends)


def _wait_lines(step: Wait) -> str:
    if step.seconds is None:
        return f'    TPWrite "{plain_text(step.message, STRING_LIMIT).translate(QUOTE_REPLACEMENTS)}";\n    Stop;\n'
    return f"    WaitTime \\InPos, {format_number(step.seconds, 3)};\n"


def _pose_text(frame: np.ndarray, decimals: int) -> str:
    return f"[[{join_numbers(frame[:3, 3], decimals)}], [{_quaternion_text(frame[:3, :3])}]]"


def _quaternion_text(turned: np.ndarray) -> str:
    return join_numbers(quaternion(turned), TURN_DECIMALS)
