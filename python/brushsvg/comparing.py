"""A program that was read, held against the plan that it should paint and against what brushsvg would write."""

from __future__ import annotations

import re
from types import SimpleNamespace

import numpy as np

from . import _core
from .cell import Cell
from .checking import Problems, Ran, chords, slack_mm
from .errors import Error
from .machine import text_of
from .moves import Program
from .paint import visits
from .posts import POSTS
from .posts.gcode import AT_ONCE, BRACKETS
from .posts.text import plain
from .program import Job, unchecked_program

STRAY_MM = 0.02  # what rounding and the chords of circles make of a path; a brush does not show it


def with_plan(ran: Ran, expected, cell: Cell) -> tuple[list[int | None], Problems]:
    """For each pass that was read which of a plan in loads it is (None: none), and (stroke, sentence) for whatever is
    missing, in another order, elsewhere, at another speed or with other paint.

    Passes before the program's first stroke were painted before. Error when the plan has no such stroke.
    """
    first, count = ran.first_stroke, len(expected.passes)
    if first > count:
        raise Error(f"the program goes on with stroke {first}, the drawing has strokes 1 to {count}")
    due = expected.passes[first - 1 :]
    partners, problems = _partners(ran.plan.passes, due)
    pairs = [(a_pass, due[k]) for a_pass, k in zip(ran.plan.passes, partners, strict=True) if k is not None]
    problems += [said for pair in pairs for said in _strayed(*pair, cell)]
    if not problems:
        asked = visits(expected, cell, first)[first - 1 :] or ((),) * len(due)
        problems += _paint(ran, due, asked)
    return [None if k is None else first - 1 + k for k in partners], problems


def _partners(passes, due) -> tuple[list[int | None], Problems]:
    """For each pass the number of the one of due that has its name, in order where there are several."""
    names, wanted = [_written(a_pass.stroke) for a_pass in passes], [_written(each.stroke) for each in due]
    if len(names) == len(wanted) and all(map(_same, names, wanted)):
        return list(range(len(due))), []
    left = dict(enumerate(wanted))
    by_name: dict[str, list[int]] = {}
    for number, name in reversed(left.items()):
        by_name.setdefault(name, []).append(number)
    partners: list[int | None] = []
    for name in names:
        numbers = by_name.get(name)
        number = numbers.pop() if numbers else next((k for k in left if _same(name, left[k])), None)
        if number is not None:
            left.pop(number, None)
            partners.append(number)
        else:
            partners.append(None)
    problems = [
        (name, "the drawing has no such stroke") for name, k in zip(names, partners, strict=True) if k is None
    ]
    problems += [(due[k].stroke, "the program does not paint this stroke") for k in left]
    found = [k for k in partners if k is not None]
    if not problems and found != sorted(found):
        at = next(place for place, k in enumerate(found) if k != place)
        problems.append((names[at], f"it is painted where the drawing asks for {wanted[at]}"))
    return partners, problems


def _same(written: str, name: str) -> bool:
    """Whether a name that was read is this one; long ones are cut in a program."""
    return written == name or (written.endswith("...") and name.startswith(written[:-3]))


def _written(name: str) -> str:
    """A name as programs of any language may have it."""
    return plain(name, 1000).translate(BRACKETS).translate(AT_ONCE)


def _strayed(a_pass, meant, cell: Cell) -> Problems:
    """Where a pass that was read does not run where it should, or not as fast."""
    limit_mm = max(STRAY_MM, slack_mm(cell)) + (cell.servo.step_mm if cell.servo else 0.0)
    found, asked = _round(a_pass), _round(meant)
    away_mm = max(_farthest(_along(found), asked), _farthest(_along(asked), found))
    problems = []
    if away_mm > limit_mm:
        sentence = (
            f"the program runs {away_mm:.2f} mm away from where the drawing asks it to: it was changed, or made "
            "with other flags or of another drawing"
        )
        problems.append((a_pass.stroke, sentence))
    is_dab = not np.ptp(asked[:, :2], axis=0).any()  # pressed on the spot alone, as slowly as a landing
    if abs(a_pass.speed_mm_s - meant.speed_mm_s) > 0.1 and not is_dab:
        asked_for = f"the drawing asks for {meant.speed_mm_s:.1f} mm/s"
        problems.append((a_pass.stroke, f"it is painted at {a_pass.speed_mm_s:.1f} mm/s, {asked_for}"))
    return problems


def _round(a_pass) -> np.ndarray:
    """The poses, those on a circle with chords between them."""
    poses = np.asarray(a_pass.poses_mm)
    centres = {k: (*arc.centre_mm, arc.direction) for arc in a_pass.arcs for k in range(arc.first, arc.last)}
    if not centres:
        return poses
    points = [poses[0]]
    for k in range(len(poses) - 1):
        points += chords(poses[k], poses[k + 1], centres[k]) if k in centres else []
        points.append(poses[k + 1])
    return np.array(points)


def _along(poses: np.ndarray) -> np.ndarray:
    """Poses and the middles between them."""
    return np.vstack([poses, (poses[1:] + poses[:-1]) / 2])


def _farthest(points: np.ndarray, path: np.ndarray) -> float:
    """Largest distance [mm] of points (n, 3) from a path (m, 3) of straight moves."""
    starts, steps = path[:-1], np.diff(path, axis=0)
    if not len(steps):
        return float(np.linalg.norm(points - path[0], axis=1).max())
    squares = np.maximum((steps**2).sum(axis=1), 1e-30)
    farthest = 0.0
    for first in range(0, len(points), 256):  # bounds the memory, nothing else
        offset = points[first : first + 256, None] - starts
        at = np.clip((offset * steps).sum(axis=2) / squares, 0, 1)
        away = np.linalg.norm(offset - at[..., None] * steps, axis=2).min(axis=1)
        farthest = max(farthest, float(away.max()))
    return farthest


def _paint(ran: Ran, due, asked) -> Problems:
    """The first stroke before which paint is fetched otherwise than the cell says."""
    for a_pass, found, wanted in zip(due, ran.visits, asked, strict=True):
        if found != wanted:
            told = [" and ".join(station.name for station in each) or "nothing" for each in (found, wanted)]
            return [(a_pass.stroke, f"before it the program visits {told[0]}, the cell asks for {told[1]}")]
    return []


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
    lines = enumerate(text.splitlines(), 1)
    titles = r"\(?(stroke \d|paint: |border |end: )"
    return [
        (number, line)
        for number, line in lines
        if line.strip() and (re.match(titles, line) or not re.match(r"\(|  # (?!stroke|paint)", line))
    ]


_WAY = re.compile(r"(G1 X\S+ Y\S+) S\d+")
_LIFT = re.compile(r"M3 S(\d+)|G4 P(\d+\.\d+)")
LIFTS_S = 0.05  # what rounded heights make of the time that a lift waits


def _folded(lines: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """A servo's lines: ways that follow each other as the last one, lifts and waits as the last with the sum."""
    out: list[tuple[int, str]] = []
    last, value, waited_s = "", "", 0.0
    for number, line in lines:
        if way := _WAY.fullmatch(line):
            kind, told = "way", way[1]
        elif lift := _LIFT.fullmatch(line):
            kind = "lift"
            value, waited_s = (value, waited_s) if last == kind else ("", 0.0)
            value, waited_s = lift[1] or value, waited_s + float(lift[2] or 0)
            told = f"M3 S{value or 0} G4 P{waited_s:.3f}"
        else:
            kind, told = "", line
        if kind and kind == last:
            out[-1] = (out[-1][0], told)
        else:
            out.append((number, told))
        last = kind
    return out


_NUMBER = re.compile(r"([A-Z]|\br=)?(-?\d+(?:\.\d+)?)")
LEAST_BLEND_M, BLENDS = (
    1e-5,
    0.05,
)  # what rounded poses make of a blend, which hangs on the angle between two moves


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
                slack = max(slack, LEAST_BLEND_M, BLENDS * float(wanted))
        else:
            slack = letter == "S"  # a servo's values; codes and numbers of strokes are what they are
        if len(found.partition(".")[2]) != decimals or abs(float(found) - float(wanted)) > slack:
            return False
    return True
