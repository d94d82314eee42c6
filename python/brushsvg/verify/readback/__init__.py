"""Programs read back, as we write them and no further: what a machine would do, step by step."""

from __future__ import annotations

import codecs
import re
import unicodedata
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...errors import Error
from ...machine.header_lines import TILT_LINE

if TYPE_CHECKING:
    from ...machine.cells.cell import Cell


class Step(NamedTuple):
    """One move to a point [mm], in the frame of the program; NaN is a coordinate that was never named.

    line: of the file, from 1; centre: of the circle it runs on, with its turn (1 counter-clockwise), or None;
    blend_mm: how far before the point the next move may begin; via: a point of the circle that was named, in the
    frame of the program; wait_s: what is waited for behind it, in so many waits. What a servo does alone takes no time
    but that. axis: (3,) the unit vector from the tip up along a tilted brush, in the frame of the program; () upright.
    took_s: its duration, where the program gives it; 0: it gives the speed.
    """

    line: int
    rapid: bool
    x: float
    y: float
    z: float
    speed_mm_s: float
    blend_mm: float = 0.0
    centre: tuple[float, float, int] | None = None
    via: tuple = ()
    wait_s: float = 0.0
    waits: int = 0
    axis: tuple = ()
    took_s: float = 0.0


class Act(NamedTuple):
    """What a line of a program does or says, however it is written.

    line: of the file, from 1; kind: move, circle, way (a servo's move), lift (of a servo), wait or text, which says
    something, or is a statement; place: where it goes [mm]; at_most: its speed [mm/s] and acceleration [mm/s^2],
    where it names them; of a timed move its limit, its speed, and what rounding or one more step adds to that [mm/s];
    same: other numbers; turned: (9,) the tool's rotation there, row by row, in the frame of the program, where the move
    names one that is not upright. Of a rapid move the speed is inf.
    """

    line: int
    kind: str
    text: str = ""
    place: tuple = ()
    at_most: tuple = ()
    same: tuple = ()
    turned: tuple = ()


@dataclass
class ReadSection:
    """What stands under one of our comments, in a line of the file, from 1. taking_up: steps on which the tool stands,
    since an axis only takes up its play."""

    title: str
    line: int = 0
    steps: list[Step] = field(default_factory=list)
    taking_up: list[Step] = field(default_factory=list)


@dataclass
class Readback:
    """joint_mm: how far every corner may be cut; acts: all that the program does, in order; modes: what it sets before
    it first moves; rises_mm: heights to which it goes straight from any place; unsure: lines behind which an
    axis may be anywhere in its backlash, as it was before the program.

    in_paper_frame: points are the paper's; else the robot's. blends_by_radius: each move says how far before its end
    the next one may begin; else joint_mm holds for all corners. tilts: its header says that the brush is tilted.
    """

    sections: list[ReadSection] = field(default_factory=list)
    joint_mm: float = 0.0
    in_paper_frame: bool = False
    blends_by_radius: bool = False
    acts: list[Act] = field(default_factory=list)
    modes: frozenset[str] | None = None
    rises_mm: list[float] = field(default_factory=list)
    unsure: set[int] = field(default_factory=set)
    tilts: bool = False

    def section(self) -> ReadSection:
        """The one being read."""
        if not self.sections:
            self.sections.append(ReadSection(""))
        return self.sections[-1]

    def comment(self, number: int, text: str) -> None:
        """Perhaps the title of a section. Blanks at its end are ignored: some languages drop them."""
        text = text.rstrip(" ")
        text += " " * text.endswith(":")  # of a name without plain letters
        self.tilts = self.tilts or text == TILT_LINE
        if text.startswith(("stroke ", "paint: ", "border ")):
            self.sections.append(ReadSection(text, number))
        if re.match(r"stroke \d|border |\w+: ", text):  # others are somebody's remarks
            self.acts.append(Act(number, "text", f"({text})"))


def circle(out: Readback, number: int, via: np.ndarray, end: np.ndarray, speed_mm_s: float) -> None:
    """A step from where the tool is through a point to a point (3,): its centre is as far from all of them."""
    steps = out.section().steps
    if not steps:
        raise Error(f"line {number}: a circle from nowhere", code="line-incomplete")
    start = np.array([steps[-1].x, steps[-1].y])
    to_via, to_end = via[:2] - start, end[:2] - start
    cross = to_via[0] * to_end[1] - to_via[1] * to_end[0]
    if abs(cross) < 1e-9:
        raise Error(f"line {number}: the three points of the circle are on one line", code="line-incomplete")
    square_via, square_end = to_via @ to_via, to_end @ to_end
    centre = start + np.array(
        [
            to_end[1] * square_via - to_via[1] * square_end,
            to_via[0] * square_end - to_end[0] * square_via,
        ]
    ) / (2 * cross)
    turn = 1 if cross > 0 else -1
    place = (float(centre[0]), float(centre[1]), turn)
    steps.append(Step(number, False, *end.tolist(), speed_mm_s, 0.0, place, (via,)))


def text_of_file(data: bytes) -> str:
    """Decode bytes with any letters that an editor left, so that they can be named."""
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        raise Error("it is written in UTF-16: brushsvg writes plain 7-bit text", code="line-unread")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _of_letter(letter: str, line: int) -> str:
    if letter == "\ufeff":
        return f"line {line} begins with a byte order mark (U+FEFF), which an editor put there: save it without one"
    if letter == "\r":
        return f"line {line} ends as on Windows, with a carriage return: brushsvg writes line feeds alone"
    named = f"U+{ord(letter):04X} {unicodedata.name(letter, '')}".strip()
    return f"line {line} has a letter {letter!r} ({named}): brushsvg writes plain 7-bit text"


def read_program(text: str, suffix: str, cell: Cell) -> Readback:
    """What a program of the cell's language does, its places those where a machine with the cell's backlash goes. Error
    with the line for what brushsvg would not have written."""
    from ...machine.posts import POSTS
    from .play import as_gone

    post = POSTS.get(cell.language)
    if post is None or suffix not in post.extensions:
        speaks = f"{post.title} in {' or '.join(post.extensions)}" if post else cell.language
        raise Error(f"cell {cell.name} speaks {speaks}, not what ends in {suffix!r}", code="program-format")
    if post.line_end != "\n":
        text = text.replace(post.line_end, "\n")
    if post.has_tabs:
        text = text.replace("\t", " ")
    if odd := re.search(r"[^\n -~]", text):
        raise Error(_of_letter(odd[0], text.count("\n", 0, odd.start()) + 1), code="line-unread")
    for number, line in enumerate(text.splitlines(), 1):
        if (found := _HUGE.search(line)) and not line.lstrip(" ").startswith(
            ("(", "#", "!", ";", "--", ": !", "popup", "TPWrite", "stop(", "print(", "tp_popup(", 'CO "')
        ):
            raise Error(
                f"line {number}: {found[0][:30]!r} is larger than any number that brushsvg writes",
                code="line-unread",
            )
    return as_gone(_READERS[cell.language](text, cell), cell)


_HUGE = re.compile(
    r"(?<![\d.])0*[1-9]\d{9,}"
)  # no place in mm, no feed in mm/min: nothing can be computed with it


def _gcode(text: str, cell: Cell) -> Readback:
    from .gcode import read_gcode

    return read_gcode(text, cell)


def _jaka(text: str, cell: Cell) -> Readback:
    from .jaka import read_jaka

    return read_jaka(text, cell)


def _urscript(text: str, cell: Cell) -> Readback:
    from .urscript import read_urscript

    return read_urscript(text)


def _rapid(text: str, cell: Cell) -> Readback:
    from .rapid import read_rapid

    return read_rapid(text)


def _xarm(text: str, cell: Cell) -> Readback:
    from .xarm import read_xarm

    return read_xarm(text, cell)


def _krl(text: str, cell: Cell) -> Readback:
    from .krl import read_krl

    return read_krl(text, cell)


def _dobot(text: str, cell: Cell) -> Readback:
    from .dobot import read_dobot

    return read_dobot(text, cell)


def _fanuc(text: str, cell: Cell) -> Readback:
    from .fanuc import read_fanuc

    return read_fanuc(text, cell)


def _doosan(text: str, cell: Cell) -> Readback:
    from .doosan import read_doosan

    return read_doosan(text, cell)


def _ros2(text: str, cell: Cell) -> Readback:
    from .ros2 import as_table, read_ros2

    return read_ros2(as_table(text) if text.startswith("{") else text, cell)


def _hpgl(text: str, cell: Cell) -> Readback:
    from .hpgl import read_hpgl

    return read_hpgl(text, cell)


def _ebb(text: str, cell: Cell) -> Readback:
    from .ebb import read_ebb

    return read_ebb(text, cell)


_READERS: dict[str, Callable[[str, Cell], Readback]] = {
    "linuxcnc": _gcode,
    "grbl": _gcode,
    "grbl-servo": _gcode,
    "fluidnc": _gcode,
    "marlin": _gcode,
    "marlin-servo": _gcode,
    "klipper": _gcode,
    "urscript": _urscript,
    "jaka": _jaka,
    "rapid": _rapid,
    "xarm": _xarm,
    "krl": _krl,
    "dobot": _dobot,
    "fanuc": _fanuc,
    "doosan": _doosan,
    "ros2": _ros2,
    "hpgl": _hpgl,
    "ebb": _ebb,
}
