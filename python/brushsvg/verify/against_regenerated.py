"""Compare a program line by line with what brushsvg would write."""

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
from ..machine.job_program import Job, make_written_form, unchecked_program
from ..machine.moves import Program, duration_s, painting_mm
from ..machine.paint_reload import PlanInLoads
from ..machine.posts import POSTS
from ..machine.posts.fanuc import cnt_mm
from ..machine.posts.script import upright_tool_rotation
from ..machine.writer import text_of
from .readback import Act, Readback, read_program
from .servo_lifts import drop_rounding_lifts, join_lifts, join_paths, projected_length_mm, remove_servo_steps
from .simulate_program import SimulatedProgram


def regenerate_program(
    ran: SimulatedProgram,
    brush,
    cell: Cell,
    z_offset_mm: float,
    first_stroke: int = 1,
    header_notes: HeaderNotes | None = None,
    speeds_mm_s: list[float] | None = None,
) -> Program | None:
    """Return the program that brushsvg would write for the strokes that were read.

    The visits to stations are also those that were read. Returns None where a stroke is not exactly one touch. The
    program has a header only if `header_notes` is given. speeds_mm_s: planned speeds of the strokes, where known.
    """
    if not ran.visits or len(ran.visits) != len(ran.plan.passes):
        return None
    before = first_stroke - 1
    passes = ran.plan.passes
    if cell.servo:
        rests = ran.rests if cell.servo.settle_s else (None,) * len(passes)
        passes = [remove_servo_steps(*each) for each in zip(passes, ran.lines, rests, strict=True)]
    if speeds_mm_s:
        passes = [
            _core.Pass(each.stroke, each.poses_mm, speed, arcs=each.arcs, tool_axes=each.tool_axes)
            for each, speed in zip(passes, speeds_mm_s, strict=True)
        ]
    loads = PlanInLoads(tuple(ran.plan.sheet_mm), (None,) * before + tuple(passes))
    job = Job(z_offset_mm, first_stroke, ((),) * before + ran.visits)
    program = unchecked_program(loads, brush, cell, job, make_written_form(loads, cell, job, was_read=True))
    if header_notes is None:
        return program
    return replace(program, header=header_of(header_notes.title, brush.name, loads, header_notes.notes, program, job))


@dataclass(frozen=True)
class HeaderNotes:
    """The parts of a header that cannot be derived from the lines of the program."""

    title: str
    notes: tuple[str, ...]


def differing_line(
    text: str,
    read: Readback,
    program: Program,
    cell: Cell,
    least_time_s: float | None = None,
    most_time_s: float | None = None,
) -> str | None:
    """Describe the first line that differs from what brushsvg would write.

    Returns None where no line does something else. The notation of numbers does not matter. Places may differ by less
    than a brush shows, feeds may be lower, and lines without effect may be missing or repeated. A servo's paths in
    paint have heights rounded to whole values, so only their ends are compared. least_time_s: duration of the program
    before its feeds were lowered; most_time_s: its duration at its own, lower speeds; None: the speeds are as planned.
    """
    theirs_text = "".join(text_of(POSTS[cell.language], program))
    regenerated = read_program(theirs_text, POSTS[cell.language].extensions[0], cell)
    circles = any(act.kind == "circle" for act in regenerated.acts)
    optional_modes = {"G80"} if circles else {"G80", "G17", "G91.1"}
    optional_modes |= set() if cell.language == "linuxcnc" else {"G40"}  # grbl knows no other mode
    if lost := sorted((regenerated.modes or set()) - (read.modes or set()) - optional_modes):
        return f"{lost[0]} is missing before the first move"
    ours, theirs = _sort_header(read.acts), _sort_header(regenerated.acts)
    upright = upright_tool_rotation(cell.tool.spin_deg) if cell.tool else None
    if upright is not None and not read.in_paper_frame:
        upright = program.robot_from_frame[:3, :3] @ upright
    rules = _ActComparison(cell, _header_ranges(program, least_time_s, most_time_s), upright)
    if cell.servo:
        both = drop_rounding_lifts(join_lifts(ours), join_lifts(theirs), rules.is_rounding_lift, rules.is_same)
        ours, theirs = map(join_paths, both)
    here: tuple = ()
    held: tuple = ()  # the tool's rotation here
    i, k = 0, 0
    while i < len(ours) or k < len(theirs):
        a = ours[i] if i < len(ours) else None
        b = theirs[k] if k < len(theirs) else None
        if a and b and rules.is_same(a, b):
            i, k = i + 1, k + 1
            here, held = (a.place, a.turned) if a.place else (here, held)
        elif a and rules.is_idle(a, here) and rules.is_same_rotation(a.turned, held):
            i += 1
        elif b and rules.is_idle(b, here) and rules.is_same_rotation(b.turned, held):
            k += 1
        elif a and b and rules.is_on_path(a, here, b) and rules.is_no_faster(a, b) and rules.keep_rotation(a, b, held):
            i, here = i + 1, a.place
        elif a and b and rules.is_on_path(b, here, a) and rules.is_no_faster(a, b) and rules.keep_rotation(a, b, held):
            k += 1
        else:
            if sentence := _describe_header_difference(ours, theirs, text.splitlines(), theirs_text.splitlines(), a, b):
                return sentence
            if a and b and a.kind == b.kind == "lift":
                a, b = _first_differing_acts(
                    _acts_of_lift(read.acts, ours, i), _acts_of_lift(regenerated.acts, theirs, k), rules
                )
            elif a and b and a.kind == b.kind == "way" and rules.begins_with_other_lift(ours[i + 1 :], theirs[k + 1 :]):
                a = _acts_of_lift(read.acts, ours, i + 1)[0]
            return _describe_difference(text.splitlines(), theirs_text.splitlines(), a, b, rules)
    return None


def _acts_of_lift(acts: list[Act], lifts: list[Act], number: int) -> list[Act]:
    """Return the acts that were joined into a servo's lift, and the next act."""
    before = max((act.line for act in lifts[:number]), default=0)
    lines = [act.line for act in acts]
    return acts[bisect_right(lines, before) : bisect_right(lines, lifts[number].line) + 1]


def _first_differing_acts(found: list[Act], reference: list[Act], rules: _ActComparison) -> tuple[Act, Act]:
    """Return the pair of acts that makes two lifts differ.

    The lifts differ by their last value, or by a value beyond all values of the other. Otherwise they differ by the
    wait at the value where the waits differ most. Rounding may have changed values by one.
    """
    ours, theirs = ([act for act in acts if act.kind == "lift"] for acts in (found, reference))
    if bool(ours) != bool(theirs):
        return found[0], reference[0]
    for pick in (lambda acts, **_: acts[-1], min, max) if ours else ():
        a, b = (pick(acts, key=lambda act: act.same[0]) for acts in (ours, theirs))
        if abs(a.same[0] - b.same[0]) > rules.step_values:
            return a, b
    ours_at, theirs_at = _acts_by_servo_value(found), _acts_by_servo_value(reference)

    def off_s(value: float) -> float:
        waits = [[act.same[0] for act in at.get(value, ()) if act.kind == "wait"] for at in (ours_at, theirs_at)]
        return abs(sum(waits[0]) - sum(waits[1]))

    value = max([*ours_at, *theirs_at], key=off_s)
    pairs = zip(ours_at.get(value, found[-1:]), theirs_at.get(value, reference[-1:]), strict=False)
    unlike = ((a, b) for a, b in pairs if (a.kind, a.same) != (b.kind, b.same))
    return next(unlike, (found[-1], reference[-1]))


def _acts_by_servo_value(acts: list[Act]) -> dict[float, list[Act]]:
    """Group a lift's acts by the held servo value, with the act that sets the next; None at first."""
    at: dict[float, list[Act]] = {}
    value = None
    for act in acts:
        at.setdefault(value, []).append(act)
        if act.kind == "lift":
            value = act.same[0]
    return at


def _describe_header_difference(
    ours: list[Act], theirs: list[Act], text: list[str], expected: list[str], a: Act | None, b: Act | None
) -> str | None:
    """Describe a line that only one of both headers has.

    Headers are sorted, so the next line of the other header is no counterpart.
    """
    if b and _HEADER_LINE.match(b.text) and _header_key(b) not in map(_header_key, ours):
        return f"its header lacks the line {expected[b.line - 1].strip()[:60]!r}"
    if a and _HEADER_LINE.match(a.text) and _header_key(a) not in map(_header_key, theirs):
        return f"line {a.line}: {text[a.line - 1].strip()[:60]!r} is nothing that brushsvg would write in this header"
    return None


def _describe_difference(
    ours: list[str], theirs: list[str], a: Act | None, b: Act | None, rules: _ActComparison
) -> str:
    line, expected = (lines[act.line - 1] if act else "" for lines, act in ((ours, a), (theirs, b)))
    if not a:
        return f"the line {expected.strip()[:60]!r} is missing at the end"
    if (
        b
        and a.at_most
        and b.at_most
        and a.at_most[0] > b.at_most[0] + SPEED_TOLERANCE_MM_S
        and math.isfinite(a.at_most[0])
        and rules.is_same(a._replace(at_most=b.at_most), b)
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
    found, required = _excerpt(line, at), _excerpt(expected, at)
    instead = f"brushsvg would write {required!r}" if b else "nothing should follow"
    return f"line {a.line}: {found!r}: for these strokes and this cell {instead}"


def _excerpt(line: str, place: int) -> str:
    """Return 60 letters of a line around a place.

    They start at the line's beginning where they then include the place.
    """
    first = max(0, place - 30) if place > 50 else 0
    return ("..." if first else "") + line.strip()[first : first + 60]


_HEADER_LINE = re.compile(r"\((?!stroke \d|paint: |border of )|set_tcp|paper =|local ")


def _sort_header(acts: list[Act]) -> list[Act]:
    """Return the acts with the header sorted without repeats, except declarations, which controllers refuse."""
    is_header = [bool(_HEADER_LINE.match(act.text)) for act in acts]
    first = next((k for k, is_line in enumerate(is_header) if is_line), len(acts))
    last = next((k for k in range(first, len(acts)) if not is_header[k]), len(acts))
    header = acts[first:last]
    unique = {act.text: act for act in header if not act.text.startswith("local ")}
    declared = [act for act in header if act.text.startswith("local ")]
    return acts[:first] + sorted([*unique.values(), *declared], key=_header_key) + acts[last:]


def _header_key(act: Act) -> str:
    """Return the first word of a header line, or the name that it declares."""
    word = act.text.partition(":")[0]
    return word if word.startswith("local ") else word[:8]


_NUMBER = re.compile(r"-?(?:\d+\.?\d*|\.\d+)")
# Deviation of a place: simulate_program.MAX_ROUNDING_LIFT_MM plus the last written digit.
PLACE_TOLERANCE_MM = 2.05e-3
WAIT_TOLERANCE_S = 0.0031
LIFT_WAIT_TOLERANCE_S = 0.05  # change of a lift's wait by rounded heights; also used as a share of the wait
SPEED_TOLERANCE_MM_S = 0.011  # mm/s, rounding of a speed that is written in steps of 0.01
ROTATION_TOLERANCE_DEG = 0.5  # rotation of the tool: no brush shows a smaller one
STATEMENT_TOLERANCE_DIGITS = 10.5  # units of the last decimal, or of the third one: rounding of a statement
TOOL_TILT_TOLERANCE_RAD = 1.05e-3  # rotation about a brush's tip, which does not move
PAPER_TILT_TOLERANCE_RAD = 1e-5  # rotation about a sheet's corner
# A blend depends on the angle between two moves, so rounded poses change it: by a length in mm, or by a share of the
# blend. The last constant is the share per mm of rounding, for cells whose few decimals turn short moves further.
BLEND_TOLERANCE_MM, BLEND_TOLERANCE_SHARE, BLEND_TOLERANCE_PER_MM = 1e-2, 0.05, 2e2


class _ActComparison:
    """Tolerant comparison of two acts on a machine of a cell."""

    def __init__(
        self,
        cell: Cell,
        header_ranges: tuple = ((0.0, math.inf), (0.0, math.inf)),
        upright: np.ndarray | None = None,
    ):
        self.cell = cell
        self.length_mm, self.time_s = header_ranges
        self.place_tolerance_mm = max(PLACE_TOLERANCE_MM, 3.1 * unit_mm(cell))
        self.upright = upright
        self.blend_share = max(BLEND_TOLERANCE_SHARE, BLEND_TOLERANCE_PER_MM * unit_mm(cell))
        if cell.servo:
            # Rounding changes the begin and end of a lift by up to one value, and the last part of a path by one step.
            self.time_per_value_s = 2 * value_mm(cell) / cell.speeds.press_mm_s
            rows = np.diff(np.array(cell.servo.table), axis=0)
            self.rest_s = cell.servo.settle_s + LIFT_WAIT_TOLERANCE_S + self.time_per_value_s
            self.step_values = 1 + cell.servo.step_mm * np.abs(rows[:, 1] / rows[:, 0]).max()

    def is_same(self, a: Act, b: Act) -> bool:
        if a.kind != b.kind or not self._are_places_close(a.place, b.place) or not self.is_no_faster(a, b):
            return False
        if not self.is_same_rotation(a.turned, b.turned):
            return False
        if a.kind == "text":
            return a.text == b.text or self._is_same_statement(a.text, b.text)
        if a.kind == "move" and a.text != "movel":  # `same` is how far its corners are cut, by G64 P or by a blend
            slack = max(BLEND_TOLERANCE_MM, self.blend_share * b.same[0]) if a.text else self.place_tolerance_mm / 2
            is_cut = a.same[0] > 0 or b.same[0] <= max(slack, self.min_blend_mm(b))
            return a.text == b.text and (a.same == b.same or (is_cut and a.same[0] <= b.same[0] + slack))
        return a.text == b.text and all(
            found == reference or abs(found - reference) <= slack
            for found, reference, slack in zip(a.same, b.same, self._tolerances(b), strict=True)
        )

    def min_blend_mm(self, act: Act) -> float:
        """Return the smallest blend [mm] that the language can express.

        Rounding may turn it into no blend, at which the tool stands still.
        """
        if self.cell.language == "fanuc":
            return cnt_mm(1, act.at_most[0], self.cell.blending.ramp_s)
        return 0.0

    def is_no_faster(self, a: Act, b: Act) -> bool:
        """Return whether act `a` is no faster than act `b`, which may be rapid.

        For stepper commands, one additional step is rounding.
        """
        slacks = (
            SPEED_TOLERANCE_MM_S,
            *(max(0.01 * most, *b.at_most[2:], 0.0) for most in b.at_most[1:2]),
            math.inf,
        )
        return len(a.at_most) == len(b.at_most) and all(
            found <= most + more for found, most, more in zip(a.at_most, b.at_most, slacks, strict=False)
        )

    def is_same_rotation(self, found: tuple, reference: tuple) -> bool:
        """Return whether no brush shows a difference of two rotations; () is upright."""
        if not found and not reference:
            return True
        a, b = (np.reshape(turned or self.upright, (3, 3)) for turned in (found, reference))
        return bool(apart_deg(a, b) <= ROTATION_TOLERANCE_DEG)

    def keep_rotation(self, a: Act, b: Act, held: tuple) -> bool:
        """Return whether two moves keep the tool's rotation where they begin."""
        return self.is_same_rotation(a.turned, held) and self.is_same_rotation(b.turned, held)

    def begins_with_other_lift(self, ours: list[Act], theirs: list[Act]) -> bool:
        """Return whether `ours` begins with a lift that `theirs` does not begin with."""
        return bool(ours) and ours[0].kind == "lift" and not (theirs and self.is_same(ours[0], theirs[0]))

    def is_rounding_lift(self, lift: Act) -> bool:
        """Return whether a servo's lift in paint may be an effect of rounding alone.

        Such a lift goes no further than rounding does, and waits no longer than its movement and rest last. Rounding
        adds no wait without a lift: in such a wait the brush stands still in the paint.
        """
        _, waited_s, least, most = lift.same
        going_s = (most - least) * self.time_per_value_s
        goes = most > least or waited_s <= WAIT_TOLERANCE_S
        return bool(lift.text) and goes and most - least <= self.step_values and waited_s <= self.rest_s + going_s

    def is_idle(self, act: Act, here: tuple) -> bool:
        """Return whether a move stays at a place, or moves less than a brush shows."""
        if act.kind != "move" or len(act.place) != len(here):
            return False
        return act.place == here or math.dist(act.place, here) <= self.place_tolerance_mm / 2

    def is_on_path(self, act: Act, here: tuple, to: Act) -> bool:
        """Return whether a straight move ends on another move that begins here.

        The path is the same with or without such a move.
        """
        if {act.kind, to.kind} != {"move"} or act.text != to.text or act.same != to.same or not here:
            return False
        start, point, end = (np.array(place) for place in (here, act.place, to.place))
        if not np.isfinite([start, point, end]).all():
            return False
        way = end - start
        length = np.linalg.norm(way)
        if length < self.place_tolerance_mm:
            return False
        along = (point - start) @ way / length
        off = np.linalg.norm(point - start - along * way / length)
        return bool(0 <= along <= length and off <= self.place_tolerance_mm / 2)

    def _are_places_close(self, found: tuple, reference: tuple) -> bool:
        """Return whether two places are close. Coordinates that were never named (NaN) are equal."""
        return len(found) == len(reference) and all(
            abs(x - y) <= self.place_tolerance_mm or (math.isnan(x) and math.isnan(y))
            for x, y in zip(found, reference, strict=True)
        )

    def _tolerances(self, act: Act) -> tuple:
        if act.kind == "wait":
            return (WAIT_TOLERANCE_S,)
        if act.kind == "lift":
            waits_s = max(LIFT_WAIT_TOLERANCE_S, LIFT_WAIT_TOLERANCE_S * act.same[1]) + self.time_per_value_s
            waits_s += self.rest_s if act.text else 0.0  # the rest after a first part that is an effect of rounding
            return (self.step_values, waits_s, self.step_values, self.step_values)
        if act.kind == "way":
            return (self.step_values,)
        if act.kind == "circle":
            return (self.place_tolerance_mm,) * len(act.same)
        return (1e-4,)

    def _is_same_statement(self, found: str, reference: str) -> bool:
        """Return whether texts say the same; header times, lengths and numbers may differ by rounding."""
        if (about := _ABOUT_LINE.fullmatch(found)) and (found[:6] == reference[:6]):
            value, unit = _parse_about(about)
            least, most = self.length_mm if about[4] else self.time_s
            return least - unit <= value <= most + 2 * unit
        if found[:1] == "(" or _NUMBER.sub("0", found) != _NUMBER.sub("0", reference):
            return False
        in_degrees = reference.startswith(("$tool", "tool = [", "TOOL = [", "SetTool(", "UTOOL"))
        tilts = 3 if in_degrees or reference.startswith(("set_tcp", "return", "paper")) else 0
        tilted = PAPER_TILT_TOLERANCE_RAD if reference.startswith("paper") else TOOL_TILT_TOLERANCE_RAD
        tilted = math.degrees(tilted) if in_degrees else tilted
        numbers = list(zip(_NUMBER.findall(found), _NUMBER.findall(reference), strict=True))
        return all(
            abs(float(x) - float(y))
            <= (
                tilted
                if k >= len(numbers) - tilts
                else STATEMENT_TOLERANCE_DIGITS * 10.0 ** -max(len(y.partition(".")[2]), 3) * ("." in y)
            )
            for k, (x, y) in enumerate(numbers)
        )


_ABOUT_LINE = re.compile(r"\((?:time: about (?:(\d+) h )?(?:(\d+) min ?)?(?:(\d+) s)?|length: (\d+) mm on the paper)\)")


def _header_ranges(program: Program, least_time_s: float | None, most_time_s: float | None) -> tuple[tuple, tuple]:
    """Return the ranges of length [mm] and time [s] that a header may state.

    Each range is (least, most). A header may differ by one unit of its last digit less and two more: circles that were
    written as lines took rests. The stepped heights of a servo make a path longer than planned, but not shorter than
    its projection onto the paper. Each stroke may have lost a step and a value at both ends.
    """
    length_mm, time_s = painting_mm(program), duration_s(program)
    least_mm, most_mm = length_mm * (1 - LENGTH_TOLERANCE_SHARE), length_mm * (1 + LENGTH_TOLERANCE_SHARE)
    if program.cell.servo:
        ends_mm = 2 * len([*program.sections()]) * (program.cell.servo.step_mm + value_mm(program.cell))
        least_mm, most_mm = projected_length_mm(program) - ends_mm, most_mm + ends_mm
    fewer, more = (least_mm / length_mm, most_mm / length_mm) if length_mm else (1.0, 1.0)
    least_s = time_s if least_time_s is None else min(time_s, least_time_s)
    most_s = time_s if most_time_s is None else max(time_s, most_time_s)
    return (least_mm, most_mm), (
        least_s * fewer * (1 - TIME_TOLERANCE_SHARE),
        most_s * more * (1 + TIME_TOLERANCE_SHARE),
    )


# Relative change of lengths and times by rounded places. On tilted paper, a circle, which needs a rest, is read back as
# lines.
LENGTH_TOLERANCE_SHARE, TIME_TOLERANCE_SHARE = 1e-3, 1e-2


def _parse_about(found: re.Match) -> tuple[float, float]:
    """Return the seconds or millimetres of a header, and their rounding unit."""
    if found[4]:
        return float(found[4]), 1.0
    seconds = sum(int(found[k] or 0) * unit for k, unit in ((1, 3600), (2, 60), (3, 1)))
    return float(seconds), 60.0 if found[1] else 1.0
