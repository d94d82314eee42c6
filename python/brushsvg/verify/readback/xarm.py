"""Read back Python programs for xArm that brushsvg wrote."""

from __future__ import annotations

import itertools
import re

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import rotation
from ...machine.posts.text import PROGRAM_END
from ...machine.posts.xarm import (
    AFTER,
    BEFORE,
    FUNCTIONS,
    NAMES_LETTERS,
    READY,
    TILTED,
    upright_deg,
)
from . import Act, Readback
from .script import N, Script, place, read_script

_FIXED = "|".join(
    re.escape(line).replace("\\[0,", "\\[-?0,")
    for line in dict.fromkeys((BEFORE + FUNCTIONS + TILTED + READY + AFTER).splitlines())
    if line
)
_LINES = tuple(
    (kind, re.compile(pattern))
    for kind, pattern in (
        # A radius below 0 means no blend.
        (
            "move",
            rf"go\({place('xyz')}, (?P<speed>{N}), (?:(?P<blend>\d+\.?\d*|\.\d+)|-(?:\d+\.?\d*|\.\d+)|None)\)",
        ),
        (
            "move",
            rf"lean\({place('xyz')}, (?P<turned>{N}, {N}, {N}), (?P<speed>{N}), "
            r"(?:(?P<blend>\d+\.?\d*|\.\d+)|-(?:\d+\.?\d*|\.\d+)|None)\)",
        ),
        ("wait", rf"rest\((?P<seconds>{N})\)"),
        ("rise", rf"rise\((?P<height>{N}), (?P<speed>{N})\)"),
        ("most", rf"MOST = (?P<most>{N})"),
        ("text", rf"UPRIGHT = \((?P<turned>{N}, {N}, {N})\)|TOOL = \[{N}(?:, {N}){{5}}\]"),
        ("text", rf"stop\(\"[^\"\\]*\"\)|done\(arm\.set_collision_sensitivity\(\d\)\)|{_FIXED}"),
    )
)

_MINUS_ZERO = re.compile(r"(?<=[\[ (])-0(?=[],)])")  # -0 in a setting
_MISSING_ARGUMENT = re.compile(r"(set_(?:mode|state))\(\)")  # the SDK then uses 0
# Runs of lines whose order has no effect: imports and constants; the tool and the arm's mode, set between switching the
# arm on and letting it move.
_ANY_ORDER = (
    re.compile(r"import |from |UPRIGHT = |TOOL = |at most"),
    re.compile(r"done\(arm\.set_(?:world_offset|tcp_offset|collision_sensitivity|mode)\("),
)


def refuse_other_encoding(text: str) -> None:
    """Raise Error for a line from which Python would read the encoding of a program."""
    for number, line in enumerate(text.splitlines()[:2], 1):  # Python looks for an encoding in two lines only
        if NAMES_LETTERS.search(line):
            sentence = f"line {number}: {line[:60]!r} makes Python decode the program with another encoding"
            raise Error(sentence, code="line-unread")


def read_xarm(text: str, cell: Cell) -> Readback:
    """Read an xArm program as steps in the robot frame.

    Raises Error with the line for a statement that brushsvg does not write.
    """
    refuse_other_encoding(text)
    script = Script(
        remark="# ",
        lines=_LINES,
        again=re.compile(r"done\(arm\.|arm = |import |from |UPRIGHT = |TOOL = |arrive\(\)$|arm\.disc"),
        last=(AFTER.splitlines()[-1], f"# {PROGRAM_END}"),
        units_mm={},
        turned_deg=tuple(upright_deg(cell).tolist()),
        is_indented=True,
        rotation=rotation,
    )
    lines = (_normalise_setting(line) if line.startswith("done(arm.set_") else line for line in text.splitlines())
    out = read_script("\n".join(lines), script, Readback(blends_by_radius=True))
    out.acts = _sort_runs(_without_idle_stops(out.acts))
    return out


def _normalise_setting(line: str) -> str:
    return _MISSING_ARGUMENT.sub(r"\1(0)", _MINUS_ZERO.sub("0", line))


def _without_idle_stops(acts: list[Act]) -> list[Act]:
    """Drop waits where the arm stops anyway before it moves on: they have no effect."""
    kept = []
    for act, then in zip(acts, [*acts[1:], None], strict=True):
        stands = bool(kept) and kept[-1].kind == "move" and not any(kept[-1].same)
        goes_on = then is not None and then.kind == "move"
        if not (act.text == "arrive()" and stands and goes_on):
            kept.append(act)
    return kept


def _sort_runs(acts: list[Act]) -> list[Act]:
    out = []
    for number, group in itertools.groupby(acts, _run_number):
        lines = list(group)
        out += lines if number is None else sorted(lines, key=lambda act: act.text)
    return out


def _run_number(act: Act) -> int | None:
    return next((k for k, pattern in enumerate(_ANY_ORDER) if pattern.match(act.text)), None)
