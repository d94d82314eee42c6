"""Read back scripts of robot arms, with the line patterns of each language."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...errors import Error
from . import Act, Readback, Step, add_circle, unread_error

NumberedLines = list[tuple[int, str]]  # lines of a program with their numbers
N = r"[-+]?(?:\d+\.?\d*|\.\d+)"
TILT_TOLERANCE_DEG = 0.5  # tilt of the tool: no brush shows a smaller one
ROTATION_ROUNDING_RAD = 3e-6  # change of a rotation by four decimals of degrees


@dataclass(frozen=True)
class Script:
    """How to read the lines of a script language.

    remark: the beginning of a comment.
    lines: kinds of lines with their patterns; the first pattern that matches applies. The kinds are:
        move, circle: to x y z, circles through u v w, at a speed and optionally an acceleration; an earlier `sets` may
        have set each of these numbers. A move may have a group `blend`.
        blended: a move whose blend was set by `sets`.
        rise: a move straight up; wait: a wait in seconds; most: an acceleration that holds for all moves.
        text: any other line, optionally with the height that the tool rises to.
    again: texts that have no effect when they are repeated.
    last: the last lines of the program, without blanks around them.
    units_mm: units of the groups that are not in mm.
    turned_deg: required value of the group `turned` of a move and of `turned_via` of a circle's middle. Where the
        header says that the brush is tilted, these groups hold the tool's rotation instead.
    rotation: makes a matrix (3, 3) of the tool's rotation; None where the numbers are no rotation.
    least: smallest allowed number of `most`.
    sets_after: the text before which nothing may be set.
    is_indented: whether blanks before a line have a meaning.
    any_case: whether upper and lower case are the same.
    either_way: a text that may be before or after `most`.
    """

    remark: str
    lines: tuple[tuple[str, re.Pattern], ...]
    again: re.Pattern
    last: tuple[str, ...]
    units_mm: dict[str, float]
    turned_deg: tuple[float, ...] = ()
    sets_after: str = ""
    least: float = 0.0
    is_indented: bool = False
    any_case: bool = False
    either_way: str = ""
    rotation: Callable[[list[float]], np.ndarray | None] | None = None


def place(names: str) -> str:
    """Return a pattern for numbers separated by commas, each a group with its name."""
    return ", ".join(f"(?P<{name}>{N})" for name in names)


def read_script(text: str, script: Script, out: Readback, lines: list[tuple[int, str]] | None = None) -> Readback:
    """Read a script as steps and acts, into `out`.

    lines: the lines with their numbers, where they run in another order than in the text. Raises Error with the line
    for a statement that brushsvg does not write.
    """
    reader = _Reader(script, out)
    if lines is None:
        numbered = enumerate(text.splitlines(), 1)
        lines = [(number, line.rstrip(" ")) for number, line in numbered if line.strip(" ")]
    for number, line in lines:
        reader.line(number, line if script.is_indented else line.strip(" "))
    endings = [reader.fold_case(line.strip(" ")) for _, line in lines]
    last = [reader.fold_case(line) for line in script.last]
    endings = [line for line in endings if line in last or not line.startswith(script.remark)]
    if sorted(endings[-len(last) :]) != sorted(last):
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    return out


class _Reader:
    def __init__(self, script: Script, out: Readback):
        self.script, self.out = script, out
        self.held: dict[str, float] = {}
        self.is_ready = not script.sets_after
        self.in_block = False  # in a conditional block, which may not be run
        self.turned: tuple = ()

    def line(self, number: int, line: str) -> None:
        if line.lstrip(" ").startswith(self.script.remark):
            self._comment(number, line.lstrip(" ")[len(self.script.remark) :])
            return
        line = self.fold_case(line)
        if self.script.is_indented and not line.startswith(" "):
            self.in_block = False
        for kind, pattern in self.script.lines:
            if found := pattern.fullmatch(line):
                values = self._values(number, "move" if kind == "blended" else kind, line, found)
                if kind == "text" and found.groupdict().get("turned"):
                    line = line[: found.start("turned")]  # the rotation was checked
                getattr(self, f"_{kind}")(number, line, values)
                return
        raise unread_error(number, line)

    def _comment(self, number: int, text: str) -> None:
        if self.fold_case(self.script.remark + text) in map(self.fold_case, self.script.last):
            return  # `read_script` checks that the program ends with this comment
        acts, before = self.out.acts, len(self.out.acts)
        self.out.comment(number, text)
        if 0 < before < len(acts) and acts[before - 1].text.startswith("here"):
            acts.insert(before - 1, acts.pop())  # a title has no effect on the line before it

    def fold_case(self, line: str) -> str:
        return line.lower() if self.script.any_case else line

    def _values(self, number: int, kind: str, line: str, found: re.Match) -> dict[str, float]:
        """Return a line's numbers by names in mm and s; the tool's rotation goes to `self.turned`."""
        texts = {name: text for name, text in found.groupdict().items() if text is not None}
        if kind != "move" or "x" in texts:
            self.turned = ()
        if turned := texts.pop("turned_via", ""):  # the rotation in the middle of a circle
            self._check_upright(number, line, [float(value) for value in re.findall(N, turned)])
        if turned := texts.pop("turned", ""):
            values = [float(value) for value in re.findall(N, turned)]
            # Destination of a move that is in another line.
            is_end = kind == "move" or (kind == "sets" and "x" in texts)
            if is_end and self.script.rotation and self.out.tilts:
                self.turned = self._rotation(number, line, values)
            else:
                self._check_upright(number, line, values)
        return {name: float(text) * self.script.units_mm.get(name, 1.0) for name, text in texts.items()}

    def _rotation(self, number: int, line: str, values: list[float]) -> tuple:
        turned = self.script.rotation(values)
        if turned is None:
            raise Error(f"line {number}: {line[:60]!r} has no rotation of the tool", code="line-unread")
        if self.script.turned_deg:  # it is upright, except for rounded digits
            off = np.abs(turned - self.script.rotation(list(self.script.turned_deg))).max()
            if off < ROTATION_ROUNDING_RAD:
                return ()
        return tuple(turned.ravel().tolist())

    def _check_upright(self, number: int, line: str, found_deg: list[float]) -> None:
        """Raise Error unless the brush is upright on the paper; full turns do not matter."""
        if not self.script.turned_deg:
            sentence = f"line {number}: {line[:60]!r} tilts the brush, and no line of its header says so"
            raise Error(sentence, code="tool-turned")
        expected_deg = np.round(self.script.turned_deg, 6) + 0.0
        off_deg = np.abs((np.array(found_deg) - expected_deg + 180.0) % 360.0 - 180.0).max()
        if off_deg > TILT_TOLERANCE_DEG:
            expected = ", ".join(f"{value:g}" for value in expected_deg)
            raise Error(
                f"line {number}: {line[:60]!r} turns the tool {off_deg:.4g} degrees from {expected}, "
                "which sets the brush upright on the cell's paper",
                code="tool-turned",
            )

    # Kinds of lines ----------------------------------------------------------------------------------

    def _sets(self, number: int, line: str, values: dict) -> None:
        if self.in_block or not self.is_ready:
            raise Error(f"line {number}: {line[:60]!r} has no place here", code="line-unread")
        self.held |= values

    def _move(self, number: int, line: str, values: dict) -> None:
        at_most, end = self._at_most(number, line, values), self._destination(number, line, values, "xyz")
        blend_mm = values.get("blend", 0.0)
        if blend_mm < 0:
            raise Error(f"line {number}: {line[:60]!r} has a negative blend", code="line-unread")
        self.out.joint_mm = max(self.out.joint_mm, blend_mm)
        axis = tuple(-value for value in self.turned[2::3])  # the tool's z points from the brush into the paper
        self.out.section().steps.append(Step(number, False, *end, at_most[0], blend_mm, axis=axis))
        self.out.acts.append(Act(number, "move", "blends", end, at_most, (blend_mm,), self.turned))

    def _blended(self, number: int, line: str, values: dict) -> None:
        if "blend" not in self.held:
            sentence = f"line {number}: {line[:60]!r} cuts a corner, and no line before says how far"
            raise Error(sentence, code="line-incomplete")
        self._move(number, line, {**values, "blend": self.held["blend"]})

    def _circle(self, number: int, line: str, values: dict) -> None:
        if self.turned:
            sentence = f"line {number}: {line[:60]!r} tilts the brush on a circle, which brushsvg does not"
            raise Error(sentence, code="tool-turned")
        at_most = self._at_most(number, line, values)
        via, end = (self._destination(number, line, values, names) for names in ("uvw", "xyz"))
        add_circle(self.out, number, np.array(via), np.array(end), at_most[0])
        self.out.acts.append(Act(number, "circle", "", end, at_most, via))

    def _rise(self, number: int, line: str, values: dict) -> None:
        self.out.rises_mm += [values["height"]] if "height" in values else []
        height = f" {values['height']:.4f}" if "height" in values else ""
        at_most = self._at_most(number, line, values)
        self._add_unless_repeated(Act(number, "text", f"rises{height}", (), at_most))

    def _add_unless_repeated(self, act: Act) -> None:
        """Add an act, unless it repeats the last one, which has no further effect."""
        if not self.out.acts or self.out.acts[-1][1:] != act[1:]:
            self.out.acts.append(act)

    def _wait(self, number: int, line: str, values: dict) -> None:
        self.out.acts.append(Act(number, "wait", same=(values["seconds"],)))

    def _most(self, number: int, line: str, values: dict) -> None:
        if not min(values.values()) >= max(self.script.least, 1e-9):
            raise Error(f"line {number}: {line[:60]!r} leaves too little to move with", code="line-incomplete")
        self._add_unless_repeated(Act(number, "text", "at most", (), tuple(values.values())))

    def _text(self, number: int, line: str, values: dict) -> None:
        self.out.rises_mm += [values["height"]] if "height" in values else []
        self.is_ready = self.is_ready or line == self.script.sets_after
        self.in_block = line.startswith("if") or (self.in_block and line not in ("end", "endif"))
        acts = self.out.acts
        before = next((act.text for act in reversed(acts) if not act.text.startswith("(")), None)
        if before == line and self.script.again.match(line):
            return
        at = 0 if before is None else len(acts)  # remarks may precede the first text
        if acts and acts[-1].text == "at most" and line == self.script.either_way:
            at -= 1
        acts.insert(at, Act(number, "text", line))

    # Numbers of lines -----------------------------------------------------------------------------------

    def _destination(self, number: int, line: str, values: dict, names: str) -> tuple[float, ...]:
        values = self.held | values
        if not values.keys() >= set(names):
            raise Error(f"line {number}: {line[:60]!r} goes where no line before it says", code="line-incomplete")
        return tuple(values[name] for name in names)

    def _at_most(self, number: int, line: str, values: dict) -> tuple[float, ...]:
        values = self.held | values
        at_most = tuple(values[name] for name in ("speed", "acceleration") if name in values)
        if "speed" not in values or not min(at_most) > 0:
            raise Error(f"line {number}: {line[:60]!r} has no speed or acceleration", code="line-incomplete")
        return at_most
