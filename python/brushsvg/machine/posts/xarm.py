"""Write Python (.py) for UFACTORY xArm with the vendor's SDK.

Units are millimetres and degrees. Points are in the arm's base frame.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from ..frames import rotation, rotation_deg
from ..moves import Move, Program, Wait
from .script import (
    QUOTE_REPLACEMENTS,
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
# Fraction of a blend's distance that is written as its radius. The SDK does not say whether a radius is the radius of
# the circle or the distance before the corner. brushsvg blends turns of up to 100 degrees. With this fraction, both
# readings cut the corner by at most the tolerance.
BLEND_FRACTION = 0.8
NAMES_LETTERS = re.compile(r"coding(?=[:=])")  # text that Python would read as the encoding of the file

BEFORE = """import sys

from xarm.wrapper import XArmAPI
"""
BEFORE_ARM = "\n\narm = XArmAPI("
FUNCTIONS = """

def done(code):
    if code != 0:
        arm.set_state(4)
        sys.exit(f"the arm answers {code} and was stopped")


def go(x, y, z, speed, radius):
    done(arm.set_position(x, y, z, *UPRIGHT, radius or None, speed, MOST, is_radian=False, wait=False))


def arrive():
    done(arm.set_position(wait=True))


def rise(height, speed):
    code, here = arm.get_position(is_radian=False)
    done(code)
    if here[2] < height:
        done(arm.set_position(*here[:2], height, *here[3:], None, speed, MOST, is_radian=False, wait=True))


def rest(seconds):
    done(arm.set_pause_time(seconds))


def stop(message):
    arrive()
    input(message + ", then press Enter ")


arm = XArmAPI(sys.argv[1])
done(arm.motion_enable(True))
done(arm.set_world_offset([0, 0, 0, 0, 0, 0], is_radian=False))
done(arm.set_tcp_offset(TOOL, is_radian=False))
"""
TILTED = """

def lean(x, y, z, roll, pitch, yaw, speed, radius):
    done(arm.set_position(x, y, z, roll, pitch, yaw, radius or None, speed, MOST, is_radian=False, wait=False))
"""
READY = """done(arm.set_mode(0))
done(arm.set_state(0))
"""
AFTER = "arrive()\narm.disconnect()\n"


def xarm(program: Program) -> Iterator[str]:
    """Write a script for a computer next to the arm.

    The computer sends the moves one by one. The SDK waits while the arm's queue of moves is full. Circles are written
    as lines, because the SDK defines a circle by its share of a whole turn and not by its end.
    """
    cell, decimals = program.cell, program.cell.decimals
    tool = join_numbers(cell.tool.tcp_mm, decimals), join_numbers(cell.tool.rotation_deg, DEGREE_DECIMALS)
    yield NAMES_LETTERS.sub("coding ", "".join(map(comment, program.header)))
    yield BEFORE
    yield f"\nUPRIGHT = ({join_numbers(upright_deg(cell), DEGREE_DECIMALS)})\n"
    yield f"TOOL = [{tool[0]}, {tool[1]}]\n"
    yield f"MOST = {format_rounded_down(cell.speeds.acceleration_mm_s2, SPEED_DECIMALS)}\n"
    yield FUNCTIONS.replace(BEFORE_ARM, TILTED + BEFORE_ARM) if program.tilts else FUNCTIONS
    if cell.contact:
        yield f"done(arm.set_collision_sensitivity({cell.contact.sensitivity}))\n"
    yield READY
    upright = rotation(upright_deg(cell))
    words = LanguageWords(
        comment,
        lambda speed: (
            f"rise({format_number(program.rise_mm, decimals)}, {format_rounded_down(speed, SPEED_DECIMALS)})\n"
        ),
        _wait_lines,
        lambda move: _move_lines(move, upright, decimals),
    )
    yield from write_sections(program, words)
    yield f"\n{AFTER}" + comment(PROGRAM_END)


def comment(text: str) -> str:
    return f"# {plain_text(text, LINE_LIMIT - 2)}\n"


def _move_lines(move: Move, upright: np.ndarray, decimals: int) -> Iterator[str]:
    speed = format_rounded_down(move.speed_mm_s, SPEED_DECIMALS)
    words = PointWords(
        lambda turned: join_numbers(rotation_deg(turned), DEGREE_DECIMALS),
        lambda place, blend: f"{place}, {speed}, {blend or None})",
        place=lambda place, angles: f"lean({place}, {angles}" if angles else f"go({place}",
    )
    has_blends = np.full(len(move.points_mm), move.blends_mm is not None)
    yield from write_points(move, upright, words, decimals, blends_mm(move, decimals, BLEND_FRACTION), has_blends)


def _wait_lines(step: Wait) -> str:
    if step.seconds is None:
        return f'stop("{plain_text(step.message, 60).translate(QUOTE_REPLACEMENTS)}")\n'
    return f"rest({format_number(step.seconds, 3)})\n"
