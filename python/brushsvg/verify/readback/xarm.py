"""Python for xArm as brushsvg writes it, read back."""

from __future__ import annotations

import itertools
import re

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import rotation
from ...machine.posts.xarm import (
    AFTER,
    BEFORE,
    FUNCTIONS,
    NAMES_LETTERS,
    READY,
    TILTED,
    XARM_END,
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
        # a radius below 0 is none
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

_NOTHING = re.compile(r"(?<=[\[ (])-0(?=[],)])")  # of a setting
_LEFT_OUT = re.compile(r"(set_(?:mode|state))\(\)")  # 0 is what the SDK takes then
# Runs of lines that do the same in any order: what is imported and named; where the tool is and how the arm moves,
# between switching it on and letting it move.
_ANY_ORDER = (
    re.compile(r"import |from |UPRIGHT = |TOOL = |at most"),
    re.compile(r"done\(arm\.set_(?:world_offset|tcp_offset|collision_sensitivity|mode)\("),
)


def read_xarm(text: str, cell: Cell) -> Readback:
    """The program as steps in the robot's frame. Error with the line for what brushsvg does not write."""
    for number, line in enumerate(text.splitlines()[:2], 1):  # Python looks no further
        if NAMES_LETTERS.search(line):
            sentence = f"line {number}: {line[:60]!r} makes Python decode the program with another encoding"
            raise Error(sentence, code="line-unread")
    script = Script(
        remark="# ",
        lines=_LINES,
        again=re.compile(r"done\(arm\.|arm = |import |from |UPRIGHT = |TOOL = |arrive\(\)$|arm\.disc"),
        last=(AFTER.splitlines()[-1], f"# {XARM_END}"),
        units_mm={},
        turned_deg=tuple(upright_deg(cell).tolist()),
        is_indented=True,
        rotation=rotation,
    )
    lines = (_spelled(line) if line.startswith("done(arm.set_") else line for line in text.splitlines())
    out = read_script("\n".join(lines), script, Readback(blends_by_radius=True))
    out.acts = _with_runs_sorted(_without_idle_stops(out.acts))
    return out


def _spelled(line: str) -> str:
    return _LEFT_OUT.sub(r"\1(0)", _NOTHING.sub("0", line))


def _without_idle_stops(acts: list[Act]) -> list[Act]:
    """To wait where the arm stops anyway, before it goes on, is nothing."""
    kept = []
    for act, then in zip(acts, [*acts[1:], None], strict=True):
        stands = bool(kept) and kept[-1].kind == "move" and not any(kept[-1].same)
        goes_on = then is not None and then.kind == "move"
        if not (act.text == "arrive()" and stands and goes_on):
            kept.append(act)
    return kept


def _with_runs_sorted(acts: list[Act]) -> list[Act]:
    out = []
    for run, group in itertools.groupby(acts, _run):
        lines = list(group)
        out += lines if run is None else sorted(lines, key=lambda act: act.text)
    return out


def _run(act: Act) -> int | None:
    return next((k for k, these in enumerate(_ANY_ORDER) if these.match(act.text)), None)
