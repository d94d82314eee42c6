"""Write KRL (.src) for KUKA robots.

Units are millimetres and degrees. The paper is BASE, and the brush's tip is TOOL.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from tempfile import SpooledTemporaryFile

import numpy as np

from ..frames import frame_of_pose, rotation_deg
from ..moves import Move, Program, Wait
from .program_parts import name_on_controller, name_parts, split_into_parts
from .script import (
    LanguageWords,
    PointWords,
    blends_mm,
    format_rounded_down,
    join_numbers,
    upright_tool_rotation,
    write_points,
)
from .text import PROGRAM_END, format_number, plain_text

LINE_LIMIT = 100
DEGREE_DECIMALS = 5
SPEED_DECIMALS = 6  # decimals of speeds in m/s
MAX_TEXT_IN_MEMORY_BYTES = 20_000_000  # larger text is kept in a file
MAX_NAME_LETTERS = 24
RISES = "DECL E6POS here\n"
# Words of the language, types, and the names that the program itself uses.
RESERVED_WORDS = frozenset(
    """ANIN ANOUT AND AXIS BAS BOOL BRAKE CASE CHANNEL CHAR CIRC CIRC_REL CONFIRM CONST CONTINUE DECL DEF DEFAULT DEFDAT
    DEFFCT DELAY DO E3AXIS E3POS E6AXIS E6POS ELSE END ENDDAT ENDFCT ENDFOR ENDIF ENDLOOP ENDSPLINE ENDSWITCH ENDWHILE
    ENUM ERR_RAISE EXIT EXOR EXT EXTFCT FALSE FOR FRAME GLOBAL GOTO HALT HERE IF IMPORT INT INTERRUPT INVERSE IS LIN
    LIN_REL LOOP MAXIMUM MINIMUM NOT OFF ON OR POS PRIO PTP PTP_REL PUBLIC PULSE REAL REPEAT RESUME RETURN SCIRC SEC
    SEMA SIGNAL SLIN SPL SPLINE SPTP STEP STRUC SWITCH THEN TIMER TO TRIGGER TRUE UNTIL WAIT WHEN WHILE
    ABS ACOS ATAN2 COS SIN SQRT TAN B_AND B_EXOR B_NOT B_OR""".split()
)
LINES_AROUND_PART = 3  # lines of a called program in addition to its moves


def krl(program: Program) -> Iterator[str]:
    """Write a program for a KUKA robot.

    The program is one .src with all points, without a .dat. A long job becomes a main program that calls others, each
    with whole strokes. Points are in the BASE. To teach the paper anew, only the line of the BASE has to change. The
    first move must be a PTP, so it goes to the robot's own place.
    """
    cell, decimals, name = program.cell, program.cell.decimals, controller_name(program.name)
    acceleration = format_rounded_down(cell.speeds.acceleration_mm_s2 / 1e3, 3)
    tool = frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg)
    header = "".join(map(comment, program.header))
    setup = "BAS(#INITMOV, 0)\n"
    setup += f"$TOOL = {_frame_text(tool, decimals)}\n$BASE = {_frame_text(program.robot_from_frame, decimals)}\n"
    if program.tilts:
        setup += "$ORI_TYPE = #VAR\n"  # #CONSTANT, set by an earlier program, would keep the tool's orientation
    setup += f"PTP $AXIS_ACT\n$ACC.CP = {acceleration}\n"
    upright = upright_tool_rotation(cell.tool.spin_deg)
    words = LanguageWords(
        comment,
        lambda speed: _rise_lines(format_number(program.rise_mm, decimals), speed),
        _wait_lines,
        lambda move: _move_lines(move, upright, decimals),
    )
    part_texts = split_into_parts(program, words, LINES_AROUND_PART, rises_again=False)
    end = comment(PROGRAM_END) + "END\n"
    first, second = next(part_texts), next(part_texts, None)
    if second is None:
        yield f"DEF {name}()\n{header}{RISES}{setup}{first}\n{end}"
        return
    calls, setup = "", header + setup
    with SpooledTemporaryFile(MAX_TEXT_IN_MEMORY_BYTES, "w+", encoding="ascii") as held_file:
        for called_name, moves in zip(
            name_parts(program, setup), itertools.chain((first, second), part_texts), strict=False
        ):
            held_file.write(f"DEF {called_name}()\n{'' if calls else RISES}{moves}END\n")
            calls += f"{called_name}()\n"
        yield f"DEF {name}()\n{setup}{calls}{end}"
        held_file.seek(0)
        while piece := held_file.read(1_000_000):
            yield piece


def controller_name(name: str) -> str:
    """Return the name of a routine, which must be that of its file."""
    return name_on_controller(name, MAX_NAME_LETTERS, RESERVED_WORDS)


def name_in(text: str) -> str:
    """Return the name of the main program, or "" if there is none."""
    found = re.search(r"^ *DEF (\w+)", text, re.IGNORECASE | re.MULTILINE)
    return found[1] if found else ""


def programs(text: str) -> dict[str, str]:
    """Return the texts of a stream of programs, keyed by program name. The main program has the name ""."""
    main, *others = re.split(r"^(?=DEF )", text, flags=re.MULTILINE)[1:]
    return {"": main} | {re.match(r"DEF (\w+)", program_text)[1]: program_text for program_text in others}


def called(text: str) -> list[str]:
    """Return the names of the programs that a program calls. They are in order and without repetition."""
    calls = re.finditer(r"^ *(B[0-9A-Z]{4}\d{3,})\(\) *\r?$", text, re.MULTILINE | re.IGNORECASE)
    return list(dict.fromkeys(call[1].upper() for call in calls))


def comment(text: str) -> str:
    return f"; {plain_text(text, LINE_LIMIT - 2)}\n"


def _rise_lines(height: str, speed_mm_s: float) -> str:
    return (
        f"here = $POS_ACT\n{_speed_line(speed_mm_s)}IF here.Z < {height} THEN\n  here.Z = {height}\n  LIN here\nENDIF\n"
    )


def _move_lines(move: Move, upright: np.ndarray, decimals: int) -> Iterator[str]:
    yield _speed_line(move.speed_mm_s)
    upright_angles = _abc_text(rotation_deg(upright))
    words = PointWords(
        lambda turned: _abc_text(rotation_deg(turned)),
        lambda place, blend: f"$APO.CDIS = {blend}\nLIN {place} C_DIS" if blend else f"LIN {place}",
        lambda place: f"CIRC {place}, {place}",
        lambda place, angles: _pose_text(place, angles or upright_angles),
    )
    blends = blends_mm(move, decimals)
    yield from write_points(move, upright, words, decimals, blends, blends > 0)


def _wait_lines(step: Wait) -> str:
    if step.seconds is None:
        return comment(f"stop: {step.message}") + "HALT\n"
    return f"WAIT SEC {format_number(step.seconds, 3)}\n"


def _speed_line(speed_mm_s: float) -> str:
    return f"$VEL.CP = {format_rounded_down(speed_mm_s / 1e3, SPEED_DECIMALS)}\n"


def _frame_text(frame: np.ndarray, decimals: int) -> str:
    return _pose_text(join_numbers(frame[:3, 3], decimals), _abc_text(rotation_deg(frame[:3, :3])))


def _pose_text(place: str, angles: str) -> str:
    x, y, z = place.split(", ")
    return f"{{X {x}, Y {y}, Z {z}, {angles}}}"


def _abc_text(about_xyz_deg: np.ndarray) -> str:
    """Return A, B and C for angles about the fixed axes x, y and z.

    A turns about z, then B about the new y, then C about the newest x. These are the angles about fixed axes in reverse
    order.
    """
    a, b, c = join_numbers(about_xyz_deg[::-1], DEGREE_DECIMALS).split(", ")
    return f"A {a}, B {b}, C {c}"
