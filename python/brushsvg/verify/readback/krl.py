"""Read back KRL that brushsvg wrote."""

from __future__ import annotations

import re

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import rotation, rotation_deg
from ...machine.posts.krl import RISES, controller_name
from ...machine.posts.script import upright_tool_rotation
from ...machine.posts.text import PROGRAM_END
from . import Readback
from .script import N, NumberedLines, Script, read_script


def _point(names: str, turned: str) -> str:
    x, y, z = (f"{axis} (?P<{name}>{N})" for axis, name in zip("xyz", names, strict=True))
    return rf"\{{{x}, {y}, {z}, {turned}\}}"


_TURN = rf"a {N}, b {N}, c {N}"
_TO = _point("xyz", f"(?P<turned>{_TURN})")
_VIA = _point("uvw", f"(?P<turned_via>{_TURN})")
_FRAME = rf"\{{x {N}, y {N}, z {N}, {_TURN}\}}"
_DEF = re.compile(r"def (\w+)\(\)")
_LINES = tuple(  # in lower case
    (kind, re.compile(pattern))
    for kind, pattern in (
        ("blended", rf"lin {_TO} c_dis"),
        ("sets", rf"\$apo\.cdis = (?P<blend>{N})"),
        ("move", rf"lin {_TO}"),
        ("sets", rf"\$vel\.cp = (?P<speed>{N})"),
        ("circle", rf"circ {_VIA}, {_TO}"),
        ("wait", rf"wait sec (?P<seconds>{N})"),
        ("rise", r"lin here"),
        ("sets", rf"\$acc\.cp = (?P<acceleration>{N})"),
        ("text", rf"if here\.z < (?P<height>{N}) then|here\.z = {N}|here = \$pos_act|endif|halt"),
        ("text", rf"decl e6pos here|end|\$(?:tool|base) = {_FRAME}"),
        ("text", r"bas\(#initmov, 0\)|ptp \$axis_act|\$ori_type = #var"),
    )
)
_CALL = re.compile(r"(b[0-9a-z]{4}\d{3,})\(\)")
_RISE_DECLARATION = RISES.strip().lower()
_FILE_HEADER = re.compile(r"&(?:access|rel|param|comment|user)\b.*")  # a controller adds these above DEF
_INITIALISATION = "bas(#initmov, 0)"  # sets all motion parameters


def read_krl(text: str, cell: Cell) -> Readback:
    """Read the main program and those that it calls as steps in the paper frame.

    Line numbers continue through the programs. Raises Error with the line for a statement that brushsvg does not write.
    """
    script = Script(
        remark="; ",
        lines=_LINES,
        again=re.compile(r"\$|bas\(|ptp|here"),
        last=(f"; {PROGRAM_END}", "END"),
        units_mm={"speed": 1e3, "acceleration": 1e3},
        sets_after=_INITIALISATION,
        turned_deg=tuple(rotation_deg(upright_tool_rotation(cell.tool.spin_deg))[::-1].tolist()),
        any_case=True,
        rotation=lambda abc: rotation(abc[::-1]),
    )
    return read_script("", script, Readback(in_paper_frame=True, blends_by_radius=True), _lines_in_order(text))


def _lines_in_order(text: str) -> NumberedLines:
    """Return the lines in running order.

    Called programs come without their first and last line. A declaration in the first of them moves to the main
    program, where it is when there is only one program.
    """
    main, others = _split_programs(text)
    if not others:
        return main
    lines: NumberedLines = []
    uncalled = dict(others)
    for number, line in main:
        call = _CALL.fullmatch(line.strip(" ").lower())
        if not call:
            lines.append((number, line))
            continue
        if call[1] not in uncalled:
            sentence = f"line {number}: it calls {call[1]!r}, which is missing or was called before"
            raise Error(sentence, code="line-unread")
        part = uncalled.pop(call[1])
        if len(uncalled) + 1 == len(others) and part[1:2] and part[1][1].strip(" ").lower() == _RISE_DECLARATION:
            lines.insert(next(k for k, (_, line) in enumerate(lines) if not line.startswith(";")), part.pop(1))
        if part[-1][1].strip(" ").lower() != "end":
            raise Error(f"program {call[1]!r} has no END", code="program-cut-short")
        lines += part[1:-1]
    if uncalled:
        raise Error(f"program {next(iter(uncalled))!r} is not called", code="line-unread")
    return lines


def _split_programs(text: str) -> tuple[NumberedLines, dict[str, NumberedLines]]:
    """Return the lines of the main program, and of the others by their names.

    The lines of the main program include the remarks above it, but not the line with its name, which is that of its
    file.
    """
    main: NumberedLines = []
    others: dict[str, NumberedLines] = {}
    lines, names, is_inside = main, set(), False
    for number, line in enumerate(text.splitlines(), 1):
        statement = line.strip(" ").lower()
        if not is_inside and _FILE_HEADER.fullmatch(statement):
            continue
        is_inside = (is_inside or statement.startswith("def ")) and statement != "end"
        if found := _DEF.fullmatch(statement):
            if found[1] in names:
                raise Error(f"line {number}: {found[1]!r} stands there twice", code="line-unread")
            if controller_name(found[1]) != found[1].upper():
                raise Error(f"line {number}: a routine cannot have the name {found[1]!r}", code="line-unread")
            if names:
                lines = others[found[1]] = []
            elif any(not above.startswith(";") for _, above in main):
                raise Error(f"line {number}: only remarks may be above the first DEF", code="line-unread")
            names.add(found[1])
            if lines is main:
                continue
        if line.strip(" "):
            lines.append((number, line.rstrip(" ")))
    if not names:
        raise Error("no DEF names a routine", code="line-unread")
    return main, others
