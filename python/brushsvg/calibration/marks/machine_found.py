"""Find the errors of a machine from painted marks; in words and as a cell's table."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error, Notice, need

# Standard deviation of each number beforehand. A tool on a long thin arm gives way by half as much as it is pressed;
# a printed or scanned page is as long as it should be to 1 %; 1 mm over a sheet is what a table is off level; worn
# screws and loose belts leave some tenths of a mm where they turn; a frame that is warped or sags displaces the tool by
# half a mm at the sheet's edges.
PARTS = {
    "lean": ("lean_mm_per_mm", 0.5),
    "axes": ("axes", 0.01),
    "tilt": ("tilt_mm_per_mm", 0.005),
    "backlash": ("backlash_mm", 0.2),
    "field": ("field_mm", 0.5),
}
TERMS = ("u u", "u v", "v v")
# Remarks in the table on numbers that not every machine can undo, see cell.not_undone.
NO_SERVO = "# leave this line out for a brush on a servo or a pen lift"
NO_PEN = "# leave this line out for a pen lift"
NO_ARM = "# only for a machine whose motors drive x and y each: leave this line out for an arm or an EBB"
LEAST_MM = 0.01  # of backlash that a cell undoes
CERTAIN = (
    1.6  # half 95 % intervals: none of a field's six numbers is further from 0 by chance in 99 of 100 fits
)
HARDLY = 0.8  # of what a number was known to beforehand: what is known no better, marks say nothing of
# Where the ways on the paper go one way by more than this (0: all ways alike, 1: one), lean along it is what a longer
# lag at greater depth would be
ONE_WAY = 0.8


@dataclass(frozen=True)
class Number:
    """One number of a machine with half its 95 % interval. part: the option that requests it; unit: what it counts
    in."""

    part: str
    name: str
    value: float
    half: float
    unit: str


def refuse_unknown_parts(machine) -> None:
    """Error for what is no list of names of machine parts."""
    known = ", ".join(PARTS)
    if isinstance(machine, str):
        example = f"({machine!r},)" if machine in PARTS else repr(tuple(PARTS)[:2])
        raise Error(
            f"machine must be a tuple of names (known: {known}), not the text {machine[:40]!r}. Write {example}",
            "machine",
            code="wrong-type",
        )
    need(machine, (tuple, list, set, frozenset), f"a tuple of names (known: {known})")
    for part in machine:
        if not (isinstance(part, str) and part in PARTS):
            raise Error(
                f"{str(part)[:40]!r} is no part of a machine (known: {known})",
                "machine",
                code="choice-unknown",
            )


def ask_for(options: _core.MarkOptions, parts: tuple[str, ...]) -> None:
    """The fit shall find these, too."""
    for part in parts:
        key, sigma = PARTS[part]
        setattr(options, key, sigma)


def list_parts(options: _core.MarkOptions) -> tuple[str, ...]:
    return tuple(part for part, (key, _) in PARTS.items() if getattr(options, key) > 0)


def numbers(fit, covariance: np.ndarray, options: _core.MarkOptions) -> list[Number]:
    """Return all requested numbers, in the order of the fit."""
    parts = list_parts(options)
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
            for term, value in zip(TERMS, values, strict=True)
        ),
    )
    first = len(covariance) - len(rows)
    halves = _core.deviations_of_95() * np.sqrt(np.maximum(np.diag(covariance)[first:], 0.0))
    return [
        Number(part, name, value, float(half), unit)
        for (part, name, value, unit), half in zip(rows, halves, strict=False)
        if part in parts
    ]


def describe_numbers(found: list[Number]) -> list[str]:
    """A line for each number, and of the field what becomes of it."""
    lines = [f"{one.name}: {one.value:.4f} +- {one.half:.4f} {one.unit}".rstrip() for one in found]
    field = [one for one in found if one.part == "field"]
    if field and min(one.half for one in field) > HARDLY * _core.deviations_of_95() * PARTS["field"][1]:
        lines.append("field: the marks do not show it; strokes all over the sheet would")
    elif field and not has_field(found):
        lines.append("field: none that is certain, and none for the cell")
    return lines


def has_field(found: list[Number]) -> bool:
    """Return whether there is a field at all: the test that six numbers are 0 is one for all of them."""
    return any(abs(one.value) > CERTAIN * one.half for one in found if one.part == "field")


def cell_table(fit, options: _core.MarkOptions, found: list[Number]) -> list[str]:
    """The lines of a cell's table [machine]; none where no requested number can be undone by a cell. Backlash and a
    field that may as well be none are left out. Which machine it is may not be known: a remark says where a line has no
    use.
    """
    parts, machine = list_parts(options), fit.machine
    backlash = [
        one.value if one.value > max(one.half, LEAST_MM) else 0.0 for one in found if one.part == "backlash"
    ]
    is_bent = has_field(found)
    lines = ["[machine]"] if set(parts) - {"backlash", "field"} or any(backlash) or is_bent else []
    if "lean" in parts:
        lines.append(f"lean_mm_per_mm = {_pair(machine.lean_mm_per_mm)}  {NO_SERVO}")
    if "axes" in parts:
        lines += [f"scale = {_pair(machine.scale)}", f"skew = {machine.skew:.5f}"]
    if "tilt" in parts:
        height = fit.height_mm - float(np.dot(machine.tilt_mm_per_mm, fit.centre_mm))
        lines += [
            f"height_mm = {height:.3f}  {NO_PEN}",
            f"tilt_mm_per_mm = {_pair(machine.tilt_mm_per_mm)}  {NO_SERVO}",
        ]
    if any(backlash):
        lines.append("backlash_mm = [{:.3f}, {:.3f}]  ".format(*backlash) + NO_ARM)
    return [*lines, *(field_lines(machine) if is_bent else [])]


def field_lines(machine) -> list[str]:
    """Of a cell's table [machine]. machine: one that was fitted or that of a cell."""
    rows = ", ".join("[" + ", ".join(f"{mm:.4f}" for mm in row) + "]" for row in machine.field_mm)
    places = (machine.field_middle_mm, machine.field_reach_mm)
    middle, reach = ("[{:.2f}, {:.2f}]".format(*pair) for pair in places)
    return [f"field_mm = [{rows}]", f"field_middle_mm = {middle}", f"field_reach_mm = {reach}"]


def _pair(values) -> str:
    return "[{:.5f}, {:.5f}]".format(*values)


def doubts(painted, options: _core.MarkOptions) -> list[Notice]:
    """Return a notice where lean cannot be separated from lag."""
    if "lean" not in list_parts(options):
        return []
    way, total = np.zeros(2), 0.0
    for mark in painted.marks:
        poses = np.array(mark.poses_mm)
        steps = np.diff(poses[:, :2], axis=0)[(poses[1:, 2] < 0) & (poses[:-1, 2] < 0)]
        way += steps.sum(axis=0)
        total += float(np.hypot(*steps.T).sum())
    share = float(np.hypot(*way)) / max(total, 1e-9)
    if share <= ONE_WAY:
        return []
    sentence = (
        f"the strokes go one way, by {share:.2f} of their length at {math.degrees(math.atan2(way[1], way[0])):.0f} "
        f"degrees, outside the range [0, {ONE_WAY:g}]: lean that way and a lag that grows with depth look alike, and "
        "neither is as sure as its interval says; add strokes the other way"
    )
    return [Notice("lean", sentence, code="lean-like-lag", about="lean")]
