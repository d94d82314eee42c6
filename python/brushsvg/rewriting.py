"""A program that was read, held line by line against what brushsvg would write for the same moves."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from . import _core
from .cell import Cell
from .checking import Ran
from .machine import header_of, text_of
from .moves import Program
from .posts import POSTS
from .program import Job, unchecked_program


def again(
    ran: Ran, brush, cell: Cell, z_offset_mm: float, first_stroke: int = 1, told: Told | None = None
) -> Program | None:
    """What brushsvg would make of the strokes and visits that were read; None where a stroke is not one touch. Without
    a header, unless its words are told."""
    if not ran.visits or len(ran.visits) != len(ran.plan.passes):
        return None
    before = first_stroke - 1
    passes = ran.plan.passes
    if cell.servo:
        passes = [_without(*each) for each in zip(passes, ran.lines, strict=True)]
    plan = SimpleNamespace(sheet_mm=ran.plan.sheet_mm, passes=[None] * before + list(passes))
    job = Job(z_offset_mm, first_stroke, ((),) * before + ran.visits)
    made = unchecked_program(plan, brush, cell, (), job)
    if told is None:
        return made
    return replace(made, header=header_of(told.title, brush.name, plan, told.notes, made, job))


@dataclass(frozen=True)
class Told:
    """What of a header stands in no line of the program."""

    title: str
    notes: tuple[str, ...]


def _without(a_pass, lines: np.ndarray):
    """A servo's pass without the poses with which its ways begin, and with one pose for all steps of a lift alone."""
    poses = np.asarray(a_pass.poses_mm)[np.r_[lines[1:] != lines[:-1], True]]
    poses = poses[np.r_[True, np.diff(poses, axis=0).any(axis=1)]]
    steps = np.diff(poses, axis=0)
    still, rising = ~steps[:, :2].any(axis=1), np.sign(steps[:, 2])
    inner = np.zeros(len(poses), dtype=bool)
    inner[1:-1] = still[:-1] & still[1:] & (rising[:-1] == rising[1:])
    return _core.Pass(a_pass.stroke, poses[~inner], a_pass.speed_mm_s)


def differing_line(text: str, program: Program, cell: Cell) -> str | None:
    """A sentence on the first line that brushsvg would write otherwise for the same poses; None where there is none.

    Numbers may differ by what rounding twice does to the last digit, time and length in the header by a little more.
    Of a servo's ways, whose heights were rounded to whole values, only the ends are looked at.
    """
    ours, theirs = _body(text), _body("".join(text_of(POSTS[cell.language], program)))
    if cell.servo:
        ours, theirs = _folded(ours), _folded(theirs)
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
    return [(number, line) for number, line in enumerate(text.splitlines(), 1) if line]


_FEED = re.compile(r"F\d+\.\d")
_WAY = re.compile(r"(G1 X\S+ Y\S+) S(\d+)")
_LIFT = re.compile(r"M3 S(\d+)|G4 P(\d+\.\d+)")
LIFTS_S = 0.05  # what rounded heights make of the time that a lift waits


def _folded(lines: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """A servo's lines: ways that follow each other as the last one, lifts one way with their waits as the last with the
    sum. Of feeds those that something is run with; ways to where the tool is are none."""
    out: list[tuple[int, str]] = []
    last, value, rises, waited_s, here, feed, told_feed = "", 0, 0, 0.0, "", None, ""
    for number, line in lines:
        if _FEED.fullmatch(line):
            feed = (number, line) if line != told_feed else None
            continue
        way, lift = _WAY.fullmatch(line), _LIFT.fullmatch(line)
        if way and (way[1], int(way[2])) == (here, value):
            continue
        if feed:
            out.append(feed)
            last, told_feed, feed = "", feed[1], None
        kind, told = "", line
        if way:
            kind, told, here, value = "way", way[1], way[1], int(way[2])
        elif lift:
            kind = "lift"
            change = int(lift[1]) - value if lift[1] else 0
            if last != kind or change * rises < 0:
                last, rises, waited_s = "", 0, 0.0
            value, rises, waited_s = value + change, change or rises, waited_s + float(lift[2] or 0)
            told = f"M3 S{value} G4 P{waited_s:.3f}"
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


_ABOUT = re.compile(
    r"(\(|  # )(?:time: about (?:(\d+) h )?(?:(\d+) min ?)?(?:(\d+) s)?|length: (\d+) mm on the paper)\)?"
)


def _alike(line: str, expected: str, waits_s: float) -> bool:
    if (about := _ABOUT.fullmatch(line)) and (asked := _ABOUT.fullmatch(expected)):
        return _nearly(about, asked, 0.05 if waits_s else 0.01)
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
        if re.match(r"-?0\d", found):
            return False
        if len(found.partition(".")[2]) != decimals or abs(float(found) - float(wanted)) > slack:
            return False
    return True


def _nearly(found: re.Match, asked: re.Match, part: float) -> bool:
    """Whether two times, or two lengths, are the same up to a part of them and two of their last unit."""
    if (found[1], found[5] is None) != (asked[1], asked[5] is None):
        return False
    seconds = [
        sum(int(each[k] or 0) * unit for k, unit in ((2, 3600), (3, 60), (4, 1))) for each in (found, asked)
    ]
    value, wanted = (int(found[5]), int(asked[5])) if asked[5] else seconds
    return abs(value - wanted) <= max(60 if asked[2] else 2, part * wanted)
