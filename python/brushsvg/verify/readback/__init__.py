"""Read back programs of brushsvg into the steps that a machine would run.

Only the statements that brushsvg writes are understood; all others are refused.
"""

from __future__ import annotations

import codecs
import importlib
import re
import unicodedata
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...errors import Error
from ...machine.header_lines import TILT_LINE

if TYPE_CHECKING:
    from ...machine.cells.cell import Cell


class Step(NamedTuple):
    """One move to a point [mm], in the frame of the program.

    A coordinate that was never named is NaN. line: line of the file, from 1; centre: centre of its circle, with the
    turn (1 counter-clockwise), or None; blend_mm: how far before the point the next move may begin; via: the point of
    the circle that the program names, in the frame of the program; wait_s, waits: total time and number of the waits
    after the move. A servo's own movement takes no other time. axis: (3,) unit vector from the tip up along a tilted
    brush, in the frame of the program; () upright. took_s: duration, where the program states it; 0 where the program
    states the speed instead.
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
    """The effect of one line of a program, independent of its notation.

    line: line of the file, from 1; kind: move, circle, way (a servo's move), lift (of a servo), wait or text (a remark
    or a statement); place: destination [mm]; at_most: speed [mm/s] and acceleration [mm/s^2], where the line names
    them. The speed of a rapid move is inf. The `at_most` of a timed move holds its limit, its speed, and the speed that
    rounding or one more step adds [mm/s]. same: other numbers; turned: (9,) the tool's rotation at the destination, row
    by row, in the frame of the program, where the move names one that is not upright.
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
    """The steps under one title comment of brushsvg.

    line: line of the title in the file, from 1; taking_up: steps on which the tool stands, since an axis only takes up
    its backlash.
    """

    title: str
    line: int = 0
    steps: list[Step] = field(default_factory=list)
    taking_up: list[Step] = field(default_factory=list)


@dataclass
class Readback:
    """A program that was read back.

    joint_mm: distance by which every corner may be cut; acts: everything that the program does, in order; modes: the
    modes that it sets before it first moves; rises_mm: heights to which it goes straight from any place; unsure: lines
    after which an axis may be anywhere in its backlash, as before the program.

    in_paper_frame: points are in the paper frame, otherwise in the robot frame. blends_by_radius: each move states how
    far before its end the next one may begin; otherwise joint_mm holds for all corners. tilts: the header says that the
    brush is tilted.
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
        """Return the section that is being read."""
        if not self.sections:
            self.sections.append(ReadSection(""))
        return self.sections[-1]

    def comment(self, number: int, text: str) -> None:
        """Record a comment, which may be the title of a section.

        Blanks at its end are ignored, because some languages drop them.
        """
        text = text.rstrip(" ")
        text += " " * text.endswith(":")  # a name without plain letters leaves only the colon
        self.tilts = self.tilts or text == TILT_LINE
        if text.startswith(("stroke ", "paint: ", "border ")):
            self.sections.append(ReadSection(text, number))
        if re.match(r"stroke \d|border |\w+: ", text):  # other comments are somebody's remarks
            self.acts.append(Act(number, "text", f"({text})"))


def add_circle(out: Readback, number: int, via: np.ndarray, end: np.ndarray, speed_mm_s: float) -> None:
    """Add a step along a circle from the current place.

    The circle goes through `via` (3,) to `end` (3,) [mm]. Raises Error without a current place, and for three points on
    one line.
    """
    steps = out.section().steps
    if not steps:
        raise Error(f"line {number}: a circle without a starting point", code="line-incomplete")
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


def unread_error(number: int, line: str) -> Error:
    return Error(f"line {number}: {line[:60]!r} is not a line that brushsvg writes", code="line-unread")


def text_of_file(data: bytes) -> str:
    """Decode the bytes of a program.

    Letters that an editor left are kept, so that error messages can name them. Raises Error for UTF-16.
    """
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        raise Error("it is written in UTF-16, not in plain 7-bit text: save it as UTF-8", code="line-unread")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _describe_letter(letter: str, line: int) -> str:
    if letter == "\ufeff":
        return f"line {line} begins with a byte order mark (U+FEFF), which an editor put there: save it without one"
    if letter == "\r":
        return f"line {line} ends as on Windows, with a carriage return: save it with line feeds alone"
    named = f"U+{ord(letter):04X} {unicodedata.name(letter, '')}".strip()
    return f"line {line} has a letter {letter!r} ({named}): programs are plain 7-bit text, so leave it out"


def read_program(text: str, suffix: str, cell: Cell) -> Readback:
    """Read a program in the cell's language.

    The places are those that a machine with the cell's backlash reaches. Raises Error with the line for a statement
    that brushsvg would not have written.
    """
    from ...machine.posts import POSTS
    from .backlash import with_backlash

    post = POSTS.get(cell.language)
    if post is None or suffix not in post.extensions:
        spoken = f"{post.title} in {' or '.join(post.extensions)}" if post else cell.language
        raise Error(f"cell {cell.name} speaks {spoken}, not what ends in {suffix!r}", code="program-format")
    if post.line_end != "\n":
        text = text.replace(post.line_end, "\n")
    if post.has_tabs:
        text = text.replace("\t", " ")
    if bad_letter := re.search(r"[^\n -~]", text):
        raise Error(_describe_letter(bad_letter[0], text.count("\n", 0, bad_letter.start()) + 1), code="line-unread")
    for number, line in enumerate(text.splitlines(), 1):
        if (found := _HUGE_NUMBER.search(line)) and not line.lstrip(" ").startswith(
            ("(", "#", "!", ";", "--", ": !", "popup", "TPWrite", "stop(", "print(", "tp_popup(", 'CO "')
        ):
            sentence = f"line {number}: {found[0][:30]!r} is larger than any number that brushsvg writes"
            raise Error(sentence, code="line-unread")
    name = _READERS[cell.language]
    read = getattr(importlib.import_module(f".{name}", __name__), f"read_{name}")
    return with_backlash(read(text, cell), cell)


# Larger than any place in mm or feed in mm/min, and too large to compute with.
_HUGE_NUMBER = re.compile(r"(?<![\d.])0*[1-9]\d{9,}")


# The module that reads each language. Its function is called read_ and the module's name.
_READERS = dict.fromkeys(
    ["linuxcnc", "grbl", "grbl-servo", "fluidnc", "marlin", "marlin-servo", "klipper"], "gcode"
) | {
    name: name
    for name in ["urscript", "jaka", "rapid", "xarm", "krl", "dobot", "fanuc", "doosan", "ros2", "hpgl", "ebb"]
}
