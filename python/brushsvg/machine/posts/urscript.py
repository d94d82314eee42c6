"""Write URScript for Universal Robots.

Units are metres, and rotations are rotation vectors. Points are on the paper's plane.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from ..frames import frame_of_pose, rotation_vector
from ..moves import Move, Program, Wait
from .program_parts import split_into_parts
from .script import (
    QUOTE_REPLACEMENTS,
    LanguageWords,
    PointWords,
    join_numbers,
    upright_tool_rotation,
    write_points,
)
from .text import format_number, plain_text

LINE_LIMIT = 100
MIN_BLEND_M = 5e-6  # a smaller blend is written as 0
M_PER_MM = 1e-3
START_WATCH = "  watching = run watch()\n"
BEGIN, END = "def brushsvg():\n", "end\nbrushsvg()\n"
NEXT = "brushsvg: go on with part"


def urscript(program: Program) -> Iterator[str]:
    """Write a program that can be run from the pendant or sent to the robot.

    A long job becomes several complete programs that run one after the other. Points are on the paper's plane. To teach
    the paper anew, only the line that sets the plane has to change.
    """
    decimals = program.cell.decimals + 3
    tool = program.cell.tool
    tcp = frame_of_pose(np.array(tool.tcp_mm), tool.rotation_deg)
    acceleration = format_number(program.cell.speeds.acceleration_mm_s2 * M_PER_MM, 4)
    header = "".join(f"  # {plain_text(line, LINE_LIMIT - 4)}\n" for line in program.header)
    setup = f"  set_tcp({_pose_text(tcp, decimals)})\n  paper = {_pose_text(program.robot_from_frame, decimals)}\n"
    upright = upright_tool_rotation(tool.spin_deg)
    setup += "  def on_paper(x, y, z):\n"
    setup += f"    return pose_trans(paper, p[x, y, z, {_rotation_text(upright, decimals)}])\n  end\n"
    if program.tilts:
        setup += "  def tilted(x, y, z, rx, ry, rz):\n"
        setup += "    return pose_trans(paper, p[x, y, z, rx, ry, rz])\n  end\n"
    contact = program.cell.contact
    if contact:
        setup += _watch_thread(contact.force_n)
    # The tool is high, and nothing presses on the sensor.
    begin = f"  zero_ftsensor()\n{START_WATCH}" if contact else ""
    words = LanguageWords(
        lambda title: f"  # {plain_text(title, LINE_LIMIT - 4)}\n",
        lambda speed: _rise_lines(program.rise_mm, speed, acceleration, decimals) + begin,
        lambda step: _wait_lines(step, contact is not None),
        lambda move: _move_lines(move, upright, acceleration, decimals),
    )
    # Two more lines: the number of the part, and the number of the next part.
    around = (BEGIN + header + setup + END).count("\n") + 2
    for count, moves in enumerate(split_into_parts(program, words, around, rises_again=True), 1):
        if count > 1:
            yield f'  textmsg("{NEXT} {count}")\n{END}'
        part = f"  # part: {count}\n" if count > 1 else ""
        yield f"{BEGIN}{part}{header}{setup}"
        yield moves
    yield END


def programs(text: str) -> dict[str, str]:
    """Return the texts of a stream of programs.

    The keys are the ends of their file names. The first program has the key "".
    """
    part_texts = re.split(rf"^(?={re.escape(BEGIN)})", text, flags=re.MULTILINE)[1:]
    return {part_suffix(count) if count > 1 else "": part_text for count, part_text in enumerate(part_texts, 1)}


def part_suffix(count: int) -> str:
    return f"-part{count}"


def called(text: str) -> list[str]:
    """Return the end of the name of the next file, if there is one."""
    part_numbers = re.findall(rf'^ *textmsg\("{NEXT} (\d{{1,6}})"\) *$', text, re.MULTILINE)
    return [part_suffix(int(count)) for count in part_numbers]


def _rise_lines(height_mm: float, speed_mm_s: float, acceleration: str, decimals: int) -> str:
    height = format_number(height_mm * M_PER_MM, decimals)
    return (
        "  here = pose_trans(pose_inv(paper), get_actual_tcp_pose())\n"
        f"  if here[2] < {height}:\n"
        f"    movel(pose_trans(paper, p[here[0], here[1], {height}, here[3], here[4], here[5]]), "
        f"a={acceleration}, v={format_number(speed_mm_s * M_PER_MM, 4)})\n"
        "  end\n"
    )


def _watch_thread(force_n: float) -> str:
    """Return a thread that ends the whole program on hard contact. The limit is force_n."""
    newtons = format_number(force_n, 1)
    return (
        "  thread watch():\n"
        "    while True:\n"
        f"      if force() > {newtons}:\n"
        f'        textmsg("brushsvg: the tool is pressed with more than {newtons} N")\n'
        "        halt\n"
        "      end\n"
        "      sync()\n"
        "    end\n"
        "  end\n"
    )


def _move_lines(move: Move, upright: np.ndarray, acceleration: str, decimals: int) -> Iterator[str]:
    speed = format_number(max(np.floor(move.speed_mm_s * M_PER_MM * 1e5) / 1e5, 1e-5), 5)
    at_most = f"a={acceleration}, v={speed}"
    words = PointWords(
        lambda turned: _rotation_text(turned, decimals),
        lambda place, blend: f"  movep({place}, {at_most}, r={blend})" if blend else f"  movel({place}, {at_most})",
        lambda place: f"  movec({place}, {place}, {at_most}, r=0.0, mode=1)",
    )
    count = len(move.points_mm)
    blends = np.zeros(count) if move.blends_mm is None else move.blends_mm * M_PER_MM
    # movep keeps the speed of the tool. The last move stops, because the next one may turn back, which movep cannot.
    has_blends = (np.arange(count) < count - 1) & (move.blends_mm is not None)
    blends = np.where(blends < MIN_BLEND_M, 0.0, blends)
    yield from write_points(move, upright, words, decimals, blends, has_blends, units_per_mm=M_PER_MM)


def _wait_lines(step: Wait, is_watched: bool) -> str:
    if step.seconds is None:
        popup = (
            f'  popup("{plain_text(step.message, 60).translate(QUOTE_REPLACEMENTS)}", '
            '"brushsvg", False, False, blocking=True)\n'
        )
        # A person may touch the brush during the wait.
        return f"  kill watching\n{popup}{START_WATCH}" if is_watched else popup
    return f"  sleep({format_number(step.seconds, 3)})\n"


def _pose_text(frame: np.ndarray, decimals: int) -> str:
    return f"p[{join_numbers(frame[:3, 3] * M_PER_MM, decimals)}, {_rotation_text(frame[:3, :3], decimals)}]"


def _rotation_text(turned: np.ndarray, decimals: int) -> str:
    return join_numbers(rotation_vector(turned), decimals)
