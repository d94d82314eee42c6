"""TP for FANUC as brushsvg writes it, read back: the main program with those that it calls."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import rotation, rotation_deg
from ...machine.posts.fanuc import FANUC_END, INDEX, MAIN, POINT_DECIMALS, cnt_mm
from ...machine.posts.script import down
from . import Readback
from .script import N, Numbered, Script, place, read_script

_C = rf"(?:{N}|\({N}\))"
_ATTRIBUTES = re.compile(
    r"COMMENT *= \"[ -!#-~]*\";|PROTECT *= READ(?:_WRITE)?;|DEFAULT_GROUP *= 1,\*,\*,\*,\*;|/MN"
)
_GROUP = re.compile(r"DEFAULT_GROUP *= 1,\*,\*,\*,\*;")
_POINT = re.compile(
    rf"P\[(\d{{1,5}})\]\{{ GP1: UF : {INDEX}, UT : {INDEX}, CONFIG : '([^']*)', "
    rf"X = ({N}) mm, Y = ({N}) mm, Z = ({N}) mm, W = ({N}) deg, P = ({N}) deg, R = ({N}) deg \}};"
)
_SPEED = r"(\d{1,4}(?:mm/sec|cm/min))"
_LINE = re.compile(rf"L P\[(\d{{1,5}})\] {_SPEED} (?:FINE|CNT(\d{{1,3}}))")
_CIRCLE = re.compile(r"C P\[(\d{1,5})\]")
_ONWARD = re.compile(rf"P\[(\d{{1,5}})\] {_SPEED} FINE")
_CALL = re.compile(r"CALL (\w{1,32})")
_SETS = re.compile(rf"PR\[{INDEX},([1-6])\]=({_C})")
_FRAME = re.compile(rf"(UFRAME|UTOOL)\[{INDEX}\]=PR\[{INDEX}\]")
_CHOICE = re.compile(rf"UFRAME_NUM={INDEX}|UTOOL_NUM={INDEX}")
_LINES = tuple(
    (kind, re.compile(pattern))
    for kind, pattern in (
        (
            "move",
            rf"L {place('xyz')} turned (?P<turned>{N}, {N}, {N}) at (?P<speed>{N}) blend (?P<blend>{N})",
        ),
        (
            "circle",
            rf"C {place('uvw')} turned (?P<turned_via>{N}, {N}, {N}) "
            rf"to {place('xyz')} turned (?P<turned>{N}, {N}, {N}) at (?P<speed>{N})",
        ),
        ("wait", rf"WAIT (?P<seconds>{N})\(sec\)"),
        ("rise", r"L PR\[2\] (?P<speed>\d{1,4})mm/sec FINE"),
        ("text", rf"IF \(R\[1\]<(?P<height>{N})\) THEN|PR\[2,3\]={_C}|ENDIF|PAUSE"),
        ("text", r"PR\[2\]=LPOS|R\[1\]=PR\[2,3\]|U(?:FRAME|TOOL)(?:_NUM=1|\[1\] \{.*\})"),
    )
)


def read_fanuc(text: str, cell: Cell) -> Readback:
    """The programs as steps in the paper's frame. Error with the line for what brushsvg does not write; lines are
    counted on through the programs."""
    script = Script(
        remark="!",
        lines=_LINES,
        again=re.compile(r"PR\[2\]|R\[1\]"),
        last=(f"!{FANUC_END}",),
        units_mm={},
        turned_deg=tuple(np.round(rotation_deg(down(cell.tool.spin_deg)), POINT_DECIMALS).tolist()),
        rotation=rotation,
    )
    out = Readback(in_paper_frame=True, blends_by_radius=True)
    read_script("", script, out, _with_setup_as_frames(_in_order(text, cell)))
    return out


def _in_order(text: str, cell: Cell) -> Numbered:
    """The instructions as they run, a place instead of a point's number."""
    found = _programs(text)
    if not found or next(iter(found)) != MAIN:
        raise Error(f"it does not begin with the program {MAIN}", code="line-unread")
    lines, taken = [], [MAIN]
    for number, line in _with_places(*found[MAIN], cell):
        call = _CALL.fullmatch(line)
        if not call:
            lines.append((number, line))
            continue
        if call[1] not in found or call[1] in taken:
            raise Error(
                f"line {number}: it calls {call[1]!r}, which is missing or was called before",
                code="line-unread",
            )
        taken.append(call[1])
        lines += _with_places(*found[call[1]], cell)
    if left := [name for name in found if name not in taken]:
        raise Error(f"program {left[0]!r} is not called", code="line-unread")
    if any(_CALL.fullmatch(line) for _, line in lines):
        raise Error("a program that is called calls others", code="line-unread")
    return lines


def _programs(text: str) -> dict[str, tuple[Numbered, Numbered]]:
    """Return the instructions and points of each program, in a dictionary of names."""
    found: dict[str, tuple[Numbered, Numbered]] = {}
    name, where, has_group = "", "out", False
    for number, raw in enumerate(text.splitlines(), 1):
        line = " ".join(raw.split())
        if not line:
            continue
        begins = re.fullmatch(r"/PROG (\w{1,32})", line)
        if begins and where == "out" and begins[1] not in found:
            name, where, has_group = begins[1], "name", False
            found[name] = ([], [])
        elif where == "name" and line == "/ATTR":
            where = "head"
        elif where == "head" and _ATTRIBUTES.fullmatch(line):
            has_group = has_group or bool(_GROUP.fullmatch(line))
            if line == "/MN" and not has_group:
                raise Error(f"line {number}: no DEFAULT_GROUP says which arm moves", code="line-unread")
            where = "instructions" if line == "/MN" else where
        elif where == "instructions" and line == "/POS":
            where = "points"
        elif where == "instructions" and (one := re.fullmatch(r" *\d*: ?(.*?) *;?", raw.rstrip(" "))):
            is_open = not raw.rstrip(" ").endswith(";")
            said = one[1] if one[1].startswith("!") else " ".join(one[1].split())
            if is_open != bool(_CIRCLE.fullmatch(said)):
                raise Error(f"line {number}: {line[:60]!r} ends too early or too late", code="line-unread")
            found[name][0].append((number, said))
        elif where == "points" and line == "/END":
            where = "out"
        elif where == "points":
            found[name][1].append((number, line))
        else:
            raise Error(
                f"line {number}: {line[:60]!r} is not a line that brushsvg writes", code="line-unread"
            )
    if where != "out":
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    return found


def _with_places(lines: Numbered, said: Numbered, cell: Cell) -> Iterator[tuple[int, str]]:
    points = _points(said, cell)

    def at(number: int, name: str) -> tuple[str, str]:
        if int(name) not in points:
            raise Error(f"line {number}: there is no point P[{name}]", code="line-incomplete")
        return points[int(name)]

    opened = None
    for number, line in lines:
        move, circle, onward = _LINE.fullmatch(line), _CIRCLE.fullmatch(line), _ONWARD.fullmatch(line)
        if bool(onward) != (opened is not None):
            raise Error(f"line {number}: a circle is written in two lines", code="line-unread")
        if move:
            to, turned = at(number, move[1])
            speed, percent = _mm_s(move[2]), int(move[3] or 0)
            if percent > 100:
                raise Error(f"line {number}: CNT{percent} is outside the range [0, 100]", code="line-unread")
            blend = cnt_mm(percent, speed, cell.blending.ramp_s)
            yield number, f"L {to} turned {turned} at {speed:.6f} blend {blend:.6f}"
        elif circle:
            opened = circle[1]
        elif onward:
            (via, via_turned), (to, turned) = at(number, opened), at(number, onward[1])
            yield number, f"C {via} turned {via_turned} to {to} turned {turned} at {_mm_s(onward[2]):.6f}"
            opened = None
        else:
            yield number, line
    if opened is not None:
        raise Error("a circle has no end", code="line-incomplete")


def _mm_s(speed: str) -> float:
    return float(speed[:-6]) / (6 if speed.endswith("cm/min") else 1)


def _points(said: Numbered, cell: Cell) -> dict[int, tuple[str, str]]:
    """Place and angles of each point, as they are written."""
    points: dict[int, tuple[str, str]] = {}
    held, first = "", 0
    for number, line in said:
        first = first if held else number
        held = f"{held} {line}".strip()
        if not line.endswith("};"):
            continue
        found = _POINT.fullmatch(held)
        if not found or int(found[1]) in points:
            raise Error(
                f"line {first}: {held[:60]!r} is not a point that brushsvg writes", code="line-unread"
            )
        if found[2] != cell.tool.configuration:
            sentence = (
                f"line {first}: the arm's configuration is {found[2]!r}, not {cell.tool.configuration!r}"
            )
            raise Error(sentence, code="line-unread")
        points[int(found[1])] = (", ".join(found.groups()[2:5]), ", ".join(found.groups()[5:]))
        held = ""
    if held:
        raise Error(f"line {first}: {held[:60]!r} is not a point that brushsvg writes", code="line-unread")
    return points


def _with_setup_as_frames(lines: Numbered) -> Numbered:
    """Instead of the lines that set frame and tool by a register, what they are set to; remarks that go on as one."""
    out: Numbered = []
    held: dict[int, str] | None = None
    choices: Numbered = []
    known: set[str] = set()
    for number, line in lines:
        if line.startswith("!+") and out and out[-1][1].startswith("!"):
            out[-1] = (out[-1][0], out[-1][1] + line[2:])
        elif line == f"PR[{INDEX}]=LPOS":
            held = {}
        elif (sets := _SETS.fullmatch(line)) and held is not None:
            held[int(sets[1])] = sets[2].strip("()")
        elif frame := _FRAME.fullmatch(line):
            if held is None or len(held) < 6:
                raise Error(f"line {number}: {line!r} sets a frame that is not whole", code="line-incomplete")
            known.add(frame[1])
            values = ", ".join(held[k] for k in range(1, 7))
            choices.append((number, f"{frame[1]}[{INDEX}] {{{values}}}"))
        elif _CHOICE.fullmatch(line):
            if line.partition("_")[0] not in known:
                raise Error(
                    f"line {number}: {line!r} chooses a frame before anything sets it", code="line-incomplete"
                )
            choices.append((number, line))
        elif line.startswith("!") or not line:
            out.append((number, line))
        else:
            out += _settled(choices)
            choices = []
            out.append((number, line))
    return [each for each in out + _settled(choices) if each[1]]


def _settled(choices: Numbered) -> Numbered:
    """What is set before a move in one order, and once, the last value of each."""
    last = {line.partition(" ")[0]: (number, line) for number, line in choices}
    return [last[name] for name in sorted(last)]
