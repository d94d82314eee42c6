"""A program that was read, held line by line against what brushsvg would write for the same moves."""

from __future__ import annotations

import math
import re
from types import SimpleNamespace

import numpy as np

from . import _core
from .cell import Cell, Servo
from .checking import Ran
from .machine import text_of
from .moves import Program
from .posts import POSTS
from .posts.gcode_servo import height_at
from .program import Job, unchecked_program


def again(ran: Ran, brush, cell: Cell, z_offset_mm: float) -> Program | None:
    """What brushsvg would make of the strokes and visits that were read; None where a stroke is not one touch."""
    if not ran.visits or len(ran.visits) != len(ran.plan.passes):
        return None
    before = ran.first_stroke - 1
    passes = ran.plan.passes
    if cell.servo:
        passes = [_without(*each) for each in zip(passes, ran.begun, strict=True)]
    plan = SimpleNamespace(sheet_mm=ran.plan.sheet_mm, passes=[None] * before + list(passes))
    return unchecked_program(plan, brush, cell, (), Job(z_offset_mm, before + 1, ((),) * before + ran.visits))


def _without(a_pass, begun: np.ndarray):
    """A servo's pass without the poses with which its ways begin, and with one pose for all steps of a lift alone."""
    poses = np.asarray(a_pass.poses_mm)[~begun]
    steps = np.diff(poses, axis=0)
    still, rising = ~steps[:, :2].any(axis=1), np.sign(steps[:, 2])
    inner = np.zeros(len(poses), dtype=bool)
    inner[1:-1] = still[:-1] & still[1:] & (rising[:-1] == rising[1:])
    return _core.Pass(a_pass.stroke, poses[~inner], a_pass.speed_mm_s)


def differing_line(text: str, program: Program, cell: Cell) -> str | None:
    """A sentence on the first line that brushsvg would write otherwise for the same poses; None where there is none.

    Numbers may differ by what rounding twice does to the last digit. The header is not looked at. Of a servo's ways,
    whose heights were rounded to whole values, only the ends are.
    """
    ours, theirs = _body(text), _body("".join(text_of(POSTS[cell.language], program)))
    if cell.servo:
        ours, theirs = _folded(ours, cell.servo), _folded(theirs, cell.servo)
    for k in range(max(len(ours), len(theirs))):
        number, line = ours[k] if k < len(ours) else (0, "")
        expected = theirs[k][1] if k < len(theirs) else ""
        if line != expected and not _alike(line, expected, LIFTS_S if cell.servo else 0.0):
            if not line:
                return f"the line {expected.strip()[:60]!r} is missing at the end"
            same = next(
                (n for n, (a, b) in enumerate(zip(line, expected, strict=False)) if a != b), len(line)
            )
            found, wanted = _near(line, same), _near(expected, same)
            instead = f"brushsvg would write {wanted!r}" if expected else "nothing should follow"
            return f"line {number}: {found!r}: for these strokes and this cell {instead}"
    return None


def _near(line: str, place: int) -> str:
    """60 letters of a line, from its beginning where that holds the place."""
    first = max(0, place - 30) if place > 50 else 0
    return ("..." if first else "") + line.strip()[first : first + 60]


def _body(text: str) -> list[tuple[int, str]]:
    lines = enumerate(text.splitlines(), 1)
    titles = r"\(?(stroke \d|paint: |border |end: )"
    return [
        (number, line)
        for number, line in lines
        if line.strip() and (re.match(titles, line) or not re.match(r"\(|  # (?!stroke|paint)", line))
    ]


_WAY = re.compile(r"(G1 X\S+ Y\S+) S(\d+)")
_LIFT = re.compile(r"M3 S(\d+)|G4 P(\d+\.\d+)")
_FEED = re.compile(r"(?:G1 )?F(\d+\.\d)")
LIFTS_S = 0.05  # what rounding each step's wait up to a millisecond makes of a lift's


def _folded(lines: list[tuple[int, str]], servo: Servo) -> list[tuple[int, str]]:
    """A servo's lines: ways that follow each other as the last one; lifts and waits as the last value, with what they
    wait beyond the time that the way between their values takes at the feed. Where a lift begins, rounded heights do
    not tell to the value."""
    out: list[tuple[int, str]] = []
    last, value, waited_s, feed_mm_s = "", "", 0.0, math.inf
    for number, line in lines:
        kind, told = "", line
        if way := _WAY.fullmatch(line):
            kind, told, value = "way", way[1], way[2]
        elif lift := _LIFT.fullmatch(line):
            kind = "lift"
            waited_s = (waited_s if last == kind else 0.0) + float(lift[2] or 0)
            if lift[1] and value:
                waited_s -= abs(height_at(servo, float(lift[1])) - height_at(servo, float(value))) / feed_mm_s
            value = lift[1] or value
            told = f"M3 S{value or 0} G4 P{waited_s:.3f}"
        elif feed := _FEED.fullmatch(line):
            feed_mm_s = max(float(feed[1]), 0.1) / 60
        if kind and kind == last:
            out[-1] = (out[-1][0], told)
        else:
            out.append((number, told))
        last = kind
    return out


_NUMBER = re.compile(r"([A-Z]|\br=)?(-?\d+(?:\.\d+)?)")
# what rounded poses make of a blend, which hangs on the angle between two moves: metres, or a part of it; and the part
# for each metre of rounding, where few decimals turn moves of a millimetre by more than such an angle
LEAST_BLEND_M, BLENDS, BLENDS_PER_M = 1e-5, 0.05, 2e5


def _alike(line: str, expected: str, waits_s: float) -> bool:
    if _NUMBER.sub(r"\g<1>0", line) != _NUMBER.sub(r"\g<1>0", expected):
        return False
    for (letter, found), (_, wanted) in zip(_NUMBER.findall(line), _NUMBER.findall(expected), strict=True):
        decimals = len(wanted.partition(".")[2])
        if decimals:
            slack = 3.1 * 10.0**-decimals
            if letter == "P" and waits_s:
                slack = max(slack, waits_s, waits_s * float(wanted))
            elif letter == "r=":
                slack = max(LEAST_BLEND_M, max(BLENDS, BLENDS_PER_M * 10.0**-decimals) * float(wanted))
        else:
            slack = letter == "S"  # a servo's values; codes and numbers of strokes are what they are
        if len(found.partition(".")[2]) != decimals or abs(float(found) - float(wanted)) > slack:
            return False
    return True
