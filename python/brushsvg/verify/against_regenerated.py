"""A program that was read, held line by line against what brushsvg would write for the same moves."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..machine.cells.cell import Cell, unit_mm, value_mm
from ..machine.frames import apart_deg
from ..machine.header_lines import header_of
from ..machine.motion import Program, duration_s, painting_mm
from ..machine.paint_reload import PlanInLoads
from ..machine.posts import POSTS
from ..machine.posts.fanuc import cnt_mm
from ..machine.posts.script import down
from ..machine.program import Job, unchecked_program, written_of
from ..machine.writer import text_of
from .readback import Act, Readback, read_program
from .servo_lifts import as_lifts, as_ways, seen_from_above_mm, without_none, without_steps
from .simulate_program import Ran


def again(
    ran: Ran,
    brush,
    cell: Cell,
    z_offset_mm: float,
    first_stroke: int = 1,
    header_notes: HeaderNotes | None = None,
    speeds_mm_s: list[float] | None = None,
) -> Program | None:
    """Return the program that brushsvg would write for the strokes and visits that were read; None where a stroke is
    not one touch. Without a header, unless its words are given. speeds_mm_s: planned speeds of the strokes, where
    known.
    """
    if not ran.visits or len(ran.visits) != len(ran.plan.passes):
        return None
    before = first_stroke - 1
    passes = ran.plan.passes
    if cell.servo:
        rests = ran.rests if cell.servo.settle_s else (None,) * len(passes)
        passes = [without_steps(*each) for each in zip(passes, ran.lines, rests, strict=True)]
    if speeds_mm_s:
        passes = [
            _core.Pass(each.stroke, each.poses_mm, speed, arcs=each.arcs, tool_axes=each.tool_axes)
            for each, speed in zip(passes, speeds_mm_s, strict=True)
        ]
    loads = PlanInLoads(tuple(ran.plan.sheet_mm), (None,) * before + tuple(passes))
    job = Job(z_offset_mm, first_stroke, ((),) * before + ran.visits)
    made = unchecked_program(loads, brush, cell, job, written_of(loads, cell, job, was_read=True))
    if header_notes is None:
        return made
    return replace(
        made, header=header_of(header_notes.title, brush.name, loads, header_notes.notes, made, job)
    )


@dataclass(frozen=True)
class HeaderNotes:
    """The words of a header that no line of the program holds."""

    title: str
    notes: tuple[str, ...]


def differing_line(
    text: str, read: Readback, program: Program, cell: Cell, least_time_s: float | None = None
) -> str | None:
    """A sentence on the first line that does something else than what brushsvg would write; None where there is none.

    However the numbers are written, places may be off by what a brush does not show, feeds may be lower, and what does
    nothing may be missing or stand twice. Of a servo's ways in paint, whose heights were rounded to whole values, only
    the ends are compared. least_time_s: that of the program before its feeds were lowered; None: they are as planned.
    """
    theirs_text = "".join(text_of(POSTS[cell.language], program))
    again = read_program(theirs_text, POSTS[cell.language].extensions[0], cell)
    circles = any(act.kind == "circle" for act in again.acts)
    idle = {"G80"} if circles else {"G80", "G17", "G91.1"}
    idle |= set() if cell.language == "linuxcnc" else {"G40"}  # grbl knows no other
    if lost := sorted((again.modes or set()) - (read.modes or set()) - idle):
        return f"{lost[0]} is missing before the first move"
    ours, theirs = _with_header_sorted(read.acts), _with_header_sorted(again.acts)
    upright = down(cell.tool.spin_deg) if cell.tool else None
    if upright is not None and not read.in_paper_frame:
        upright = program.robot_from_frame[:3, :3] @ upright
    like = _Alike(cell, _header_ranges(program, least_time_s), upright)
    if cell.servo:
        both = without_none(as_lifts(ours), as_lifts(theirs), like.is_none, like.is_same)
        ours, theirs = map(as_ways, both)
    here: tuple = ()
    held: tuple = ()  # how the tool is turned here
    i, k = 0, 0
    while i < len(ours) or k < len(theirs):
        a = ours[i] if i < len(ours) else None
        b = theirs[k] if k < len(theirs) else None
        if a and b and like.is_same(a, b):
            i, k = i + 1, k + 1
            here, held = (a.place, a.turned) if a.place else (here, held)
        elif a and like.is_idle(a, here) and like.is_held(a.turned, held):
            i += 1
        elif b and like.is_idle(b, here) and like.is_held(b.turned, held):
            k += 1
        elif a and b and like.is_on_the_way(a, here, b) and like.is_slow(a, b) and like.are_held(a, b, held):
            i, here = i + 1, a.place
        elif a and b and like.is_on_the_way(b, here, a) and like.is_slow(a, b) and like.are_held(a, b, held):
            k += 1
        else:
            if sentence := _differs_in_header(
                ours, theirs, text.splitlines(), theirs_text.splitlines(), a, b
            ):
                return sentence
            if a and b and a.kind == b.kind == "lift":
                a, b = _first_unlike(_of_lift(read.acts, ours, i), _of_lift(again.acts, theirs, k), like)
            elif a and b and a.kind == b.kind == "way" and like.is_stopped(ours[i + 1 :], theirs[k + 1 :]):
                a = _of_lift(read.acts, ours, i + 1)[0]
            return _differs(text.splitlines(), theirs_text.splitlines(), a, b, like)
    return None


def _of_lift(acts: list[Act], lifts: list[Act], number: int) -> list[Act]:
    """What a servo's lift was put together of, and what follows it."""
    before = max((act.line for act in lifts[:number]), default=0)
    lines = [act.line for act in acts]
    return acts[bisect_right(lines, before) : bisect_right(lines, lifts[number].line) + 1]


def _first_unlike(found: list[Act], reference: list[Act], like: _Alike) -> tuple[Act, Act]:
    """What makes one lift another one: the value that it ends with, or that is beyond all of the other's, else what is
    waited at the value where that is furthest off. Rounding may have made the values one more or less."""
    ours, theirs = ([act for act in acts if act.kind == "lift"] for acts in (found, reference))
    if bool(ours) != bool(theirs):
        return found[0], reference[0]
    for pick in (lambda acts, **_: acts[-1], min, max) if ours else ():
        a, b = (pick(acts, key=lambda act: act.same[0]) for acts in (ours, theirs))
        if abs(a.same[0] - b.same[0]) > like.step_values:
            return a, b
    ours_at, theirs_at = _by_value(found), _by_value(reference)

    def off_s(value: float) -> float:
        waits = [
            [act.same[0] for act in at.get(value, ()) if act.kind == "wait"] for at in (ours_at, theirs_at)
        ]
        return abs(sum(waits[0]) - sum(waits[1]))

    value = max([*ours_at, *theirs_at], key=off_s)
    pairs = zip(ours_at.get(value, found[-1:]), theirs_at.get(value, reference[-1:]), strict=False)
    unlike = ((a, b) for a, b in pairs if (a.kind, a.same) != (b.kind, b.same))
    return next(unlike, (found[-1], reference[-1]))


def _by_value(acts: list[Act]) -> dict[float, list[Act]]:
    """What follows each value of a lift, up to the next one and with it; none before its first."""
    at: dict[float, list[Act]] = {}
    value = None
    for act in acts:
        at.setdefault(value, []).append(act)
        if act.kind == "lift":
            value = act.same[0]
    return at


def _differs_in_header(
    ours: list[Act], theirs: list[Act], text: list[str], again: list[str], a: Act | None, b: Act | None
) -> str | None:
    """A line that only one of both headers has: they are sorted, so the line next to it is no counterpart."""
    if b and _HEADER.match(b.text) and _header_word(b) not in map(_header_word, ours):
        return f"its header lacks the line {again[b.line - 1].strip()[:60]!r}"
    if a and _HEADER.match(a.text) and _header_word(a) not in map(_header_word, theirs):
        return f"line {a.line}: {text[a.line - 1].strip()[:60]!r} is nothing that brushsvg would write in this header"
    return None


def _differs(ours: list[str], theirs: list[str], a: Act | None, b: Act | None, like: _Alike) -> str:
    line, expected = (lines[act.line - 1] if act else "" for lines, act in ((ours, a), (theirs, b)))
    if not a:
        return f"the line {expected.strip()[:60]!r} is missing at the end"
    if (
        b
        and a.at_most
        and b.at_most
        and a.at_most[0] > b.at_most[0] + FASTER
        and math.isfinite(a.at_most[0])
        and like.is_same(a._replace(at_most=b.at_most), b)
    ):
        speeds = f"runs at {a.at_most[0]:.1f} mm/s: for these strokes and this cell brushsvg would write"
        return f"line {a.line}: {line.strip()[:60]!r} {speeds} {b.at_most[0]:.1f} mm/s"
    if b and a.kind == b.kind == "move" and a.text and a.same[0] == 0 < b.same[0]:
        stands = "the brush stands still in the paint: for these strokes and this cell brushsvg would write"
        return f"line {a.line}: {line.strip()[:60]!r}: {stands} {expected.strip()[:90]!r}"
    if b and a.kind == b.kind == "move" and not a.text and a.place == b.place and a.same != b.same:
        corners = next((line for line in theirs if line.startswith("G6")), "nothing")
        most = f"by up to {a.same[0]:g} mm" if math.isfinite(a.same[0]) else "as far as the machine likes"
        return f"line {a.line}: corners are cut {most}, brushsvg would write {corners!r}"
    at = next((n for n, (x, y) in enumerate(zip(line, expected, strict=False)) if x != y), len(line))
    found, required = _near(line, at), _near(expected, at)
    instead = f"brushsvg would write {required!r}" if b else "nothing should follow"
    return f"line {a.line}: {found!r}: for these strokes and this cell {instead}"


def _near(line: str, place: int) -> str:
    """60 letters of a line, from its beginning where that holds the place."""
    first = max(0, place - 30) if place > 50 else 0
    return ("..." if first else "") + line.strip()[first : first + 60]


_HEADER = re.compile(r"\((?!stroke \d|paint: |border of )|set_tcp|paper =|local ")


def _with_header_sorted(acts: list[Act]) -> list[Act]:
    """The acts, what a header says and sets in the order of first words, and nothing twice but declarations, of which
    controllers load no two alike."""
    is_header = [bool(_HEADER.match(act.text)) for act in acts]
    first = next((k for k, is_it in enumerate(is_header) if is_it), len(acts))
    last = next((k for k in range(first, len(acts)) if not is_header[k]), len(acts))
    said = acts[first:last]
    once = {act.text: act for act in said if not act.text.startswith("local ")}
    declared = [act for act in said if act.text.startswith("local ")]
    return acts[:first] + sorted([*once.values(), *declared], key=_header_word) + acts[last:]


def _header_word(act: Act) -> str:
    """Return the key of a line of a header: its first word, or the name that it declares."""
    word = act.text.partition(":")[0]
    return word if word.startswith("local ") else word[:8]


_NUMBER = re.compile(r"-?(?:\d+\.?\d*|\.\d+)")
NEAR_MM = 2.05e-3  # how far a place may be off: what checking.TOUCH_MM allows, and the last digit of what is written
WAITS_S = 0.0031
LIFTS_S = 0.05  # what rounded heights make of the time that a lift waits, and which part of it
FASTER = 0.011  # mm/s, of what is written in steps of 0.01
TURNED_DEG = 0.5  # of the tool: what no brush shows
DIGITS = 10.5  # of the last decimal, the third at least: what a statement loses with it
TILTED_RAD = 1.05e-3  # about a brush's tip, which stays where it is
PAPER_TILTED_RAD = 1e-5  # about a sheet's corner
# what rounded poses make of a blend, which hangs on the angle between two moves: mm, or a part of it; and the part for
# each mm of rounding, where few decimals turn moves of a millimetre by more than such an angle
LEAST_BLEND_MM, BLENDS, BLENDS_PER_MM = 1e-2, 0.05, 2e2


class _Alike:
    """Whether one act does what another does, on a machine."""

    def __init__(
        self,
        cell: Cell,
        header_ranges: tuple = ((0.0, math.inf), (0.0, math.inf)),
        upright: np.ndarray | None = None,
    ):
        self.cell = cell
        self.length_mm, self.time_s = header_ranges
        self.near_mm = max(NEAR_MM, 3.1 * unit_mm(cell))
        self.upright = upright
        self.blends = max(BLENDS, BLENDS_PER_MM * unit_mm(cell))
        if cell.servo:
            # rounded heights give a lift's begin and end to a value, and a way's last part to a step
            self.value_s = 2 * value_mm(cell) / cell.speeds.press_mm_s
            rows = np.diff(np.array(cell.servo.table), axis=0)
            self.rest_s = cell.servo.settle_s + LIFTS_S + self.value_s
            self.step_values = 1 + cell.servo.step_mm * np.abs(rows[:, 1] / rows[:, 0]).max()

    def is_same(self, a: Act, b: Act) -> bool:
        if a.kind != b.kind or not self._is_near(a.place, b.place) or not self.is_slow(a, b):
            return False
        if not self.is_held(a.turned, b.turned):
            return False
        if a.kind == "text":
            return a.text == b.text or self._says_same(a.text, b.text)
        if a.kind == "move" and a.text != "movel":  # how much of its corners is cut: by G64 P, by a blend
            slack = max(LEAST_BLEND_MM, self.blends * b.same[0]) if a.text else self.near_mm / 2
            is_cut = a.same[0] > 0 or b.same[0] <= max(slack, self.least_blend_mm(b))
            return a.text == b.text and (a.same == b.same or (is_cut and a.same[0] <= b.same[0] + slack))
        return a.text == b.text and all(
            found == reference or abs(found - reference) <= slack
            for found, reference, slack in zip(a.same, b.same, self._slacks(b), strict=True)
        )

    def least_blend_mm(self, act: Act) -> float:
        """The smallest cut that a language has a word for: rounding makes it none, by which the tool stands still."""
        if self.cell.language == "fanuc":
            return cnt_mm(1, act.at_most[0], self.cell.blending.ramp_s)
        return 0.0

    def is_slow(self, a: Act, b: Act) -> bool:
        """No faster than another, which may be rapid. For stepper commands, one step more is rounding."""
        slacks = (FASTER, *(max(0.01 * most, *b.at_most[2:], 0.0) for most in b.at_most[1:2]), math.inf)
        return len(a.at_most) == len(b.at_most) and all(
            found <= most + more for found, most, more in zip(a.at_most, b.at_most, slacks, strict=False)
        )

    def is_held(self, found: tuple, reference: tuple) -> bool:
        """Whether two rotations of the tool are one, but for what no brush shows; () is upright."""
        if not found and not reference:
            return True
        a, b = (np.reshape(turned or self.upright, (3, 3)) for turned in (found, reference))
        return bool(apart_deg(a, b) <= TURNED_DEG)

    def are_held(self, a: Act, b: Act, held: tuple) -> bool:
        """Whether the tool is turned nowhere on two moves from a place on."""
        return self.is_held(a.turned, held) and self.is_held(b.turned, held)

    def is_stopped(self, ours: list[Act], theirs: list[Act]) -> bool:
        """Whether a lift follows where another one does, or none."""
        return bool(ours) and ours[0].kind == "lift" and not (theirs and self.is_same(ours[0], theirs[0]))

    def is_none(self, lift: Act) -> bool:
        """Whether a servo's lift in paint goes no further than rounding makes of none, and waits no longer than that
        and its rest take. Rounding makes no wait without a lift: there the brush stands still in the paint."""
        _, waited_s, least, most = lift.same
        going_s = (most - least) * self.value_s
        goes = most > least or waited_s <= WAITS_S
        return (
            bool(lift.text)
            and goes
            and most - least <= self.step_values
            and waited_s <= self.rest_s + going_s
        )

    def is_idle(self, act: Act, here: tuple) -> bool:
        """Goes to where the tool is, or nowhere that a brush shows: the tool counts as where it was."""
        if act.kind != "move" or len(act.place) != len(here):
            return False
        return act.place == here or math.dist(act.place, here) <= self.near_mm / 2

    def is_on_the_way(self, act: Act, here: tuple, to: Act) -> bool:
        """Whether a straight move ends on another one that begins here: with or without it, the way is the same."""
        if {act.kind, to.kind} != {"move"} or act.text != to.text or act.same != to.same or not here:
            return False
        start, point, end = (np.array(place) for place in (here, act.place, to.place))
        if not np.isfinite([start, point, end]).all():
            return False
        way = end - start
        length = np.linalg.norm(way)
        if length < self.near_mm:
            return False
        along = (point - start) @ way / length
        off = np.linalg.norm(point - start - along * way / length)
        return bool(0 <= along <= length and off <= self.near_mm / 2)

    def _is_near(self, found: tuple, reference: tuple) -> bool:
        """Places that were never named are the same."""
        return len(found) == len(reference) and all(
            abs(x - y) <= self.near_mm or (math.isnan(x) and math.isnan(y))
            for x, y in zip(found, reference, strict=True)
        )

    def _slacks(self, act: Act) -> tuple:
        if act.kind == "wait":
            return (WAITS_S,)
        if act.kind == "lift":
            waits_s = max(LIFTS_S, LIFTS_S * act.same[1]) + self.value_s
            waits_s += self.rest_s if act.text else 0.0  # that of a first part which is none
            return (self.step_values, waits_s, self.step_values, self.step_values)
        if act.kind == "way":
            return (self.step_values,)
        if act.kind == "circle":
            return (self.near_mm,) * len(act.same)
        return (1e-4,)

    def _says_same(self, found: str, reference: str) -> bool:
        """Time and length in a header, and the numbers of a statement."""
        if (about := _ABOUT.fullmatch(found)) and (found[:6] == reference[:6]):
            value, unit = _about(about)
            least, most = self.length_mm if about[4] else self.time_s
            return least - unit <= value <= most + 2 * unit
        if found[:1] == "(" or _NUMBER.sub("0", found) != _NUMBER.sub("0", reference):
            return False
        in_degrees = reference.startswith(("$tool", "tool = [", "TOOL = [", "SetTool(", "UTOOL"))
        tilts = 3 if in_degrees or reference.startswith(("set_tcp", "return", "paper")) else 0
        tilted = PAPER_TILTED_RAD if reference.startswith("paper") else TILTED_RAD
        tilted = math.degrees(tilted) if in_degrees else tilted
        numbers = list(zip(_NUMBER.findall(found), _NUMBER.findall(reference), strict=True))
        return all(
            abs(float(x) - float(y))
            <= (
                tilted
                if k >= len(numbers) - tilts
                else DIGITS * 10.0 ** -max(len(y.partition(".")[2]), 3) * ("." in y)
            )
            for k, (x, y) in enumerate(numbers)
        )


_ABOUT = re.compile(
    r"\((?:time: about (?:(\d+) h )?(?:(\d+) min ?)?(?:(\d+) s)?|length: (\d+) mm on the paper)\)"
)


def _header_ranges(program: Program, least_time_s: float | None) -> tuple[tuple, tuple]:
    """Return (least, most) of the length [mm] and of the time [s] that a header may state, with one unit of the last
    digit less and two more: circles that were written as lines took rests.

    A servo's heights in steps make a way longer than planned, but not shorter than it is seen from above; and each
    stroke may have lost a step and a value at both ends.
    """
    length_mm, time_s = painting_mm(program), duration_s(program)
    least_mm, most_mm = length_mm * (1 - LENGTHS), length_mm * (1 + LENGTHS)
    if program.cell.servo:
        ends_mm = 2 * len([*program.sections()]) * (program.cell.servo.step_mm + value_mm(program.cell))
        least_mm, most_mm = seen_from_above_mm(program) - ends_mm, most_mm + ends_mm
    fewer, more = (least_mm / length_mm, most_mm / length_mm) if length_mm else (1.0, 1.0)
    least_s = time_s if least_time_s is None else min(time_s, least_time_s)
    return (least_mm, most_mm), (least_s * fewer * (1 - TIMES), time_s * more * (1 + TIMES))


# what rounded places make of lengths and times; on paper that leans a circle, which takes a rest, is read as lines
LENGTHS, TIMES = 1e-3, 1e-2


def _about(found: re.Match) -> tuple[float, float]:
    """Return the seconds or millimetres of a header, and the unit that they are rounded to."""
    if found[4]:
        return float(found[4]), 1.0
    seconds = sum(int(found[k] or 0) * unit for k, unit in ((1, 3600), (2, 60), (3, 1)))
    return float(seconds), 60.0 if found[1] else 1.0
