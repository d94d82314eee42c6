"""Find the errors of a machine from painted marks.

They are described in words and as a table of a cell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error, Notice, require_type
from .sheet_scale import MIN_SIGNIFICANT_SIGMAS
from .stray_marks import MIN_SPREAD_MM

# Prior standard deviation of each number. A tool on a long thin arm bends by half of its depth. The length of a printed
# or scanned page is right to 1 %. A table is 1 mm off level over a sheet. Worn screws and loose belts lose some tenths
# of a mm where they reverse. A warped or sagging frame displaces the tool by half a mm at the edges of the sheet.
PARTS = {
    "lean": ("lean_mm_per_mm", 0.5),
    "axes": ("axes", 0.01),
    "tilt": ("tilt_mm_per_mm", 0.005),
    "backlash": ("backlash_mm", 0.2),
    "field": ("field_mm", 0.5),
}
# Parts that bias the laws if the fit leaves them out. Axes and a field displace whole marks, which the fit allows for.
BIASING_PARTS = ("lean", "tilt", "backlash")
IGNORED_ERRORS = "the machine has errors that the fit leaves out"  # a reservation in a verdict
FIELD_TERMS = ("u u", "u v", "v v")
# Remarks in the table on numbers that some machines cannot compensate, see cell.list_uncorrectable_keys.
SERVO_REMARK = "# leave this line out for a brush on a servo or a pen lift"
PEN_REMARK = "# leave this line out for a pen lift"
ARM_REMARK = "# only for a machine with one motor for x and one for y: leave this line out for an arm or an EBB"
MIN_BACKLASH_MM = 0.01  # least backlash that is compensated by a cell
# Size of a field's number, in half 95 % intervals. In 99 of 100 fits chance moves none of its six numbers this far
# from 0.
MIN_FIELD_HALF_INTERVALS = 1.6
# Largest interval relative to the prior interval. Above it, the marks do not determine the number.
MAX_INTERVAL_PER_PRIOR = 0.8
# Largest share of the path length in one direction (0: all directions equal, 1: one direction). Above it, lean along
# that direction looks like a longer lag at greater depth.
MAX_DIRECTION_SHARE = 0.8


@dataclass(frozen=True)
class Number:
    """One number of a machine with half its 95 % interval.

    part: the option that requests it. unit: the unit of value and half.
    """

    part: str
    name: str
    value: float
    half: float
    unit: str


def refuse_unknown_parts(machine) -> None:
    """Raise Error for anything other than a list of names of machine parts."""
    known = ", ".join(PARTS)
    if isinstance(machine, str):
        example = f"({machine!r},)" if machine in PARTS else repr(tuple(PARTS)[:2])
        sentence = f"machine must be a tuple of names (known: {known}), not the text {machine[:40]!r}. Write {example}"
        raise Error(sentence, "machine", code="wrong-type")
    require_type(machine, (tuple, list, set, frozenset), f"a tuple of names (known: {known})")
    for part in machine:
        if not (isinstance(part, str) and part in PARTS):
            sentence = f"{str(part)[:40]!r} is not a known part of a machine (known: {known})"
            raise Error(sentence, "machine", code="choice-unknown")


def request_machine_parts(options: _core.MarkOptions, parts: tuple[str, ...]) -> None:
    """Request that the fit finds these parts of the machine as well."""
    for part in parts:
        key, sigma = PARTS[part]
        setattr(options, key, sigma)


def list_requested_parts(options: _core.MarkOptions) -> tuple[str, ...]:
    return tuple(part for part, (key, _) in PARTS.items() if getattr(options, key) > 0)


def list_machine_numbers(fit, covariance: np.ndarray, options: _core.MarkOptions) -> list[Number]:
    """Return all requested numbers, in the order of the fit."""
    parts = list_requested_parts(options)
    if not parts:
        return []
    machine = fit.machine
    rows = (
        ("lean", "lean in x", machine.lean_mm_per_mm[0], "mm per mm of depth"),
        ("lean", "lean in y", machine.lean_mm_per_mm[1], "mm per mm of depth"),
        ("axes", "scale in x", machine.scale[0], ""),
        ("axes", "scale in y", machine.scale[1], ""),
        ("axes", "skew", machine.skew, "mm in x per mm in y"),
        ("tilt", "tilt in x", machine.tilt_mm_per_mm[0], "mm higher per mm"),
        ("tilt", "tilt in y", machine.tilt_mm_per_mm[1], "mm higher per mm"),
        ("backlash", "backlash in x", machine.backlash_mm[0], "mm"),
        ("backlash", "backlash in y", machine.backlash_mm[1], "mm"),
        *(
            ("field", f"field in {axis}, {term}", value, "mm at the edge")
            for axis, values in zip("xy", machine.field_mm, strict=True)
            for term, value in zip(FIELD_TERMS, values, strict=True)
        ),
    )
    first = len(covariance) - len(rows)
    halves = _core.interval_factor_95() * np.sqrt(np.maximum(np.diag(covariance)[first:], 0.0))
    return [
        Number(part, name, value, float(half), unit)
        for (part, name, value, unit), half in zip(rows, halves, strict=False)
        if part in parts
    ]


def select_visible_numbers(numbers: list[Number], deepest_mm: float, reach_mm: float) -> list[Number]:
    """Return the numbers of lean, tilt and backlash that chance does not explain and that displace paint visibly.

    deepest_mm: the greatest depth. reach_mm: the greatest distance of a mark from the middle of the sheet. The
    displacement is visible if it exceeds MIN_SPREAD_MM.
    """
    greatest_mm = {"lean": deepest_mm, "tilt": reach_mm, "backlash": 1.0}
    significant = MIN_SIGNIFICANT_SIGMAS / _core.interval_factor_95()
    return [
        number
        for number in numbers
        if abs(number.value) > significant * number.half
        and abs(number.value) * greatest_mm[number.part] > MIN_SPREAD_MM
    ]


def advise_parts(ignored: list[Number], requested: tuple[str, ...]) -> list[str]:
    """Return a sentence that names errors which the fit leaves out, and the option that includes them.

    ignored: the errors. requested: the parts that were requested already.
    """
    if not ignored:
        return []
    parts = ",".join(part for part in PARTS if part in requested or part in {number.part for number in ignored})
    shown = ", ".join(map(_describe_number, ignored))
    return [
        f"the marks show errors of the machine, which bias the laws because the fit leaves them out ({shown}): use "
        f"--machine {parts}"
    ]


def _describe_number(number: Number) -> str:
    return f"{number.name}: {number.value:.4f} +- {number.half:.4f} {number.unit}".rstrip()


def describe_numbers(found: list[Number]) -> list[str]:
    """Return a line for each number, and a line for each part that the table for the cell file leaves out."""
    lines = [_describe_number(number) for number in found]
    field = [number for number in found if number.part == "field"]
    certain = list_certain_parts(found)
    for part in dict.fromkeys(number.part for number in found if number.part not in certain):
        if (
            part == "field"
            and min(number.half for number in field)
            > MAX_INTERVAL_PER_PRIOR * _core.interval_factor_95() * PARTS["field"][1]
        ):
            lines.append("field: these marks do not determine it; paint strokes all over the sheet")
        else:
            lines.append(f"{part}: not significant, so the table for the cell file has none")
    return lines


def describe_exact_machine(found: list[Number]) -> list[str]:
    """Return a sentence if the requested parts of the machine have no error that the marks show."""
    if not found or list_certain_parts(found):
        return []
    parts = ", ".join(dict.fromkeys(number.part for number in found))
    return [f"the marks show no error of the machine ({parts}), so there is no table for the cell file"]


def list_certain_parts(found: list[Number]) -> set[str]:
    """Return the parts with a number whose 95 % interval excludes the value of an exact machine.

    Backlash must also be large enough to be compensated, and a field has one test for all of its numbers.
    """
    certain = {
        number.part
        for number in found
        if number.part in ("lean", "axes", "tilt") and abs(number.value - number.name.startswith("scale")) > number.half
    }
    certain |= {"backlash"} if any(map(_is_certain_backlash, found)) else set()
    return certain | ({"field"} if has_field(found) else set())


def _is_certain_backlash(number: Number) -> bool:
    return number.part == "backlash" and number.value > max(number.half, MIN_BACKLASH_MM)


def has_field(found: list[Number]) -> bool:
    """Return whether there is a field at all: one test for all of its six numbers."""
    return any(abs(number.value) > MIN_FIELD_HALF_INTERVALS * number.half for number in found if number.part == "field")


def format_cell_table(fit, found: list[Number]) -> list[str]:
    """Return the lines of a cell's table [machine].

    There are no lines if none of the requested parts has an error that the marks show.

    Parts that could be 0 are left out. The kind of machine may be unknown, so remarks say which machines cannot use a
    line.
    """
    parts, machine = list_certain_parts(found), fit.machine
    lines = ["[machine]"] if parts else []
    if "lean" in parts:
        lines.append(f"lean_mm_per_mm = {format_pair(machine.lean_mm_per_mm)}  {SERVO_REMARK}")
    if "axes" in parts:
        lines += [f"scale = {format_pair(machine.scale)}", f"skew = {machine.skew:.5f}"]
    if "tilt" in parts:
        height = fit.height_mm - float(np.dot(machine.tilt_mm_per_mm, fit.centre_mm))
        lines += [
            f"height_mm = {height:.3f}  {PEN_REMARK}",
            f"tilt_mm_per_mm = {format_pair(machine.tilt_mm_per_mm)}  {SERVO_REMARK}",
        ]
    if "backlash" in parts:
        numbers = [number for number in found if number.part == "backlash"]
        backlash = [number.value if _is_certain_backlash(number) else 0.0 for number in numbers]
        lines.append("backlash_mm = [{:.3f}, {:.3f}]  ".format(*backlash) + ARM_REMARK)
    return [*lines, *(format_field_lines(machine) if "field" in parts else [])]


def format_field_lines(machine) -> list[str]:
    """Return the lines of the field in a cell's table [machine]. machine: a fitted machine or the machine of a cell."""
    rows = ", ".join("[" + ", ".join(f"{mm:.4f}" for mm in row) + "]" for row in machine.field_mm)
    places = (machine.field_middle_mm, machine.field_reach_mm)
    middle, reach = ("[{:.2f}, {:.2f}]".format(*pair) for pair in places)
    return [f"field_mm = [{rows}]", f"field_middle_mm = {middle}", f"field_reach_mm = {reach}"]


def format_pair(values) -> str:
    return "[{:.5f}, {:.5f}]".format(*values)


def report_inseparable_lean(painted, options: _core.MarkOptions) -> list[Notice]:
    """Return a notice where lean cannot be separated from lag."""
    if "lean" not in list_requested_parts(options):
        return []
    way, total = np.zeros(2), 0.0
    for mark in painted.marks:
        poses = np.array(mark.poses_mm)
        steps = np.diff(poses[:, :2], axis=0)[(poses[1:, 2] < 0) & (poses[:-1, 2] < 0)]
        way += steps.sum(axis=0)
        total += float(np.hypot(*steps.T).sum())
    share = float(np.hypot(*way)) / max(total, 1e-9)
    if share <= MAX_DIRECTION_SHARE:
        return []
    sentence = (
        f"{100 * share:.0f} % of the stroke length goes in one direction, "
        f"{math.degrees(math.atan2(way[1], way[0])):.0f} degrees, outside the range [0, {100 * MAX_DIRECTION_SHARE:g}] "
        "%: lean in that direction looks like a lag that grows with depth, so both are less certain than their "
        "intervals show. Add strokes in the opposite direction"
    )
    return [Notice("lean", sentence, code="lean-like-lag", about="lean")]
