"""Python for xArm as brushsvg writes it, read back."""

from __future__ import annotations

import re

from ...errors import Error
from ...machine.cell import Cell
from ...machine.posts.xarm import AFTER, BEFORE, FUNCTIONS, NAMES_LETTERS, XARM_END, upright_deg
from . import Readback
from .script import N, Script, place, read_script

_FIXED = "|".join(
    re.escape(line).replace("\\[0,", "\\[-?0,")
    for line in dict.fromkeys((BEFORE + FUNCTIONS + AFTER).splitlines())
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
        ("wait", rf"rest\((?P<seconds>{N})\)"),
        ("rise", rf"rise\((?P<height>{N}), (?P<speed>{N})\)"),
        ("most", rf"MOST = (?P<most>{N})"),
        ("text", rf"UPRIGHT = \((?P<turned>{N}, {N}, {N})\)|TOOL = \[{N}(?:, {N}){{5}}\]"),
        ("text", rf"stop\(\"[^\"\\]*\"\)|{_FIXED}"),
    )
)


def read_xarm(text: str, cell: Cell) -> Readback:
    """The program as steps in the robot's frame. Error with the line for what brushsvg does not write."""
    for number, line in enumerate(text.splitlines()[:2], 1):  # Python looks no further
        if NAMES_LETTERS.search(line):
            sentence = f"line {number}: {line[:60]!r} tells Python to read the program's letters as others"
            raise Error(sentence, code="line-unread")
    script = Script(
        remark="# ",
        lines=_LINES,
        again=re.compile(r"done\(arm\.|arm = |import |from |UPRIGHT = |TOOL = |arrive\(\)$|arm\.disc"),
        last=(AFTER.splitlines()[-1], f"# {XARM_END}"),
        units_mm={},
        turned_deg=tuple(upright_deg(cell).tolist()),
        is_indented=True,
    )
    return read_script(text, script, Readback(blends_by_radius=True))
