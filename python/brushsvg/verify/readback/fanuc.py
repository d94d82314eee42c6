"""Read back TP programs for FANUC: a main program and those that it calls."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import rotation, rotation_deg
from ...machine.posts.fanuc import INDEX, POINT_DECIMALS, cnt_mm
from ...machine.posts.script import upright_tool_rotation
from ...machine.posts.text import PROGRAM_END
from . import Readback, unread_error
from .script import N, NumberedLines, Script, place, read_script

_C = rf"(?:{N}|\({N}\))"
_ATTRIBUTES = re.compile(
    r"COMMENT *= \"[ -!#-~]*\";|PROTECT *= READ(?:_WRITE)?;|DEFAULT_GROUP *= 1,\*,\*,\*,\*;|/MN"
    # A controller adds these when it saves a program. A program that ignores a request to stop is not accepted.
    r"|OWNER *= \w*;|FILE_NAME *= \w*;|(?:PROG_SIZE|VERSION|LINE_COUNT|MEMORY_SIZE) *= \d+;"
    r"|(?:CREATE|MODIFIED) *= DATE [\d-]+ TIME [\d:]+;|CONTROL_CODE *= 0+ 0+;"
    r"|(?:TCD: )?(?:STACK_SIZE|TASK_PRIORITY|TIME_SLICE) *= \d+[,;]"
    r"|(?:TCD: )?(?:BUSY_LAMP_OFF|ABORT_REQUEST|PAUSE_REQUEST) *= 0[,;]"
    # An R-30iB adds these. Singularity avoidance would turn the tool.
    r"|LOCAL_REGISTERS *= \d+,\d+,\d+;|/APPL|AUTO_SINGULARITY_HEADER;|ENABLE_SINGULARITY_AVOIDANCE *: FALSE;"
)
_GROUP = re.compile(r"DEFAULT_GROUP *= 1,\*,\*,\*,\*;")
_POINT = re.compile(
    rf"P\[(\d{{1,5}})\]\{{ GP1: UF : {INDEX}, UT : {INDEX}, CONFIG : '([^']*)', "
    rf"X = ({N}) mm, Y = ({N}) mm, Z = ({N}) mm, W = ({N}) deg, P = ({N}) deg, R = ({N}) deg \}};"
)
_SPEED = r"(\d{1,4}(?:mm/sec|cm/min))"
_LINE = re.compile(rf"L P\[(\d{{1,5}})\] {_SPEED} (?:FINE|CNT(\d{{1,3}}))")
_CIRCLE = re.compile(r"C P\[(\d{1,5})\]")
_CIRCLE_END = re.compile(rf"P\[(\d{{1,5}})\] {_SPEED} FINE")
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
    """Read the programs as steps in the paper frame.

    Line numbers continue through the programs. Raises Error with the line for a statement that brushsvg does not write.
    """
    script = Script(
        remark="!",
        lines=_LINES,
        again=re.compile(r"PR\[2\]|R\[1\]"),
        last=(f"!{PROGRAM_END}",),
        units_mm={},
        turned_deg=tuple(np.round(rotation_deg(upright_tool_rotation(cell.tool.spin_deg)), POINT_DECIMALS).tolist()),
        rotation=rotation,
    )
    out = Readback(in_paper_frame=True, blends_by_radius=True)
    read_script("", script, out, _with_setup_as_frames(_instructions_in_order(text, cell)))
    return out


def _instructions_in_order(text: str, cell: Cell) -> NumberedLines:
    """Return the instructions in running order, with places for point numbers."""
    programs = _split_programs(text)
    if not programs:
        raise Error("it does not begin with /PROG and a name", code="line-unread")
    main = next(iter(programs))
    lines, called = [], [main]
    for number, line in _resolve_points(*programs[main], cell):
        call = _CALL.fullmatch(line)
        if not call:
            lines.append((number, line))
            continue
        if call[1] not in programs or call[1] in called:
            sentence = f"line {number}: it calls {call[1]!r}, which is missing or was called before"
            raise Error(sentence, code="line-unread")
        called.append(call[1])
        lines += _resolve_points(*programs[call[1]], cell)
    if uncalled := [name for name in programs if name not in called]:
        raise Error(f"program {uncalled[0]!r} is not called", code="line-unread")
    if any(_CALL.fullmatch(line) for _, line in lines):
        raise Error("a program that is called calls others", code="line-unread")
    return lines


def _split_programs(text: str) -> dict[str, tuple[NumberedLines, NumberedLines]]:
    """Return the instructions and points of each program, in a dictionary of names."""
    programs: dict[str, tuple[NumberedLines, NumberedLines]] = {}
    name, part, has_group = "", "out", False
    for number, raw in enumerate(text.splitlines(), 1):
        line = " ".join(raw.split())
        if not line:
            continue
        begins = re.fullmatch(r"/PROG ([A-Za-z]\w{0,35})", line)
        if begins and part == "out" and begins[1] not in programs:
            name, part, has_group = begins[1], "name", False
            programs[name] = ([], [])
        elif part == "name" and line == "/ATTR":
            part = "head"
        elif part == "head" and _ATTRIBUTES.fullmatch(line):
            has_group = has_group or bool(_GROUP.fullmatch(line))
            if line == "/MN" and not has_group:
                raise Error(f"line {number}: no DEFAULT_GROUP says which arm moves", code="line-unread")
            part = "instructions" if line == "/MN" else part
        elif part == "instructions" and line == "/POS":
            part = "points"
        elif part == "instructions" and (instruction_match := re.fullmatch(r" *\d*: ?(.*?) *;?", raw.rstrip(" "))):
            is_open = not raw.rstrip(" ").endswith(";")
            instruction = (
                instruction_match[1] if instruction_match[1].startswith("!") else " ".join(instruction_match[1].split())
            )
            if is_open != bool(_CIRCLE.fullmatch(instruction)):
                raise Error(f"line {number}: {line[:60]!r} ends too early or too late", code="line-unread")
            programs[name][0].append((number, instruction))
        elif part == "points" and line == "/END":
            part = "out"
        elif part == "points":
            programs[name][1].append((number, line))
        else:
            raise unread_error(number, line)
    if part != "out":
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    return programs


def _resolve_points(lines: NumberedLines, point_lines: NumberedLines, cell: Cell) -> Iterator[tuple[int, str]]:
    points = _parse_points(point_lines, cell)

    def point(number: int, name: str) -> tuple[str, str]:
        if int(name) not in points:
            raise Error(f"line {number}: there is no point P[{name}]", code="line-incomplete")
        return points[int(name)]

    open_circle_point = None
    for number, line in lines:
        move, circle, onward = _LINE.fullmatch(line), _CIRCLE.fullmatch(line), _CIRCLE_END.fullmatch(line)
        if bool(onward) != (open_circle_point is not None):
            raise Error(f"line {number}: a circle is written in two lines", code="line-unread")
        if move:
            to, turned = point(number, move[1])
            speed, percent = _parse_speed_mm_s(move[2]), int(move[3] or 0)
            if percent > 100:
                raise Error(f"line {number}: CNT{percent} is outside the range [0, 100]", code="line-unread")
            blend = cnt_mm(percent, speed, cell.blending.ramp_s)
            yield number, f"L {to} turned {turned} at {speed:.6f} blend {blend:.6f}"
        elif circle:
            open_circle_point = circle[1]
        elif onward:
            (via, via_turned), (to, turned) = point(number, open_circle_point), point(number, onward[1])
            yield (
                number,
                f"C {via} turned {via_turned} to {to} turned {turned} at {_parse_speed_mm_s(onward[2]):.6f}",
            )
            open_circle_point = None
        else:
            yield number, line
    if open_circle_point is not None:
        raise Error("a circle has no end", code="line-incomplete")


def _parse_speed_mm_s(speed: str) -> float:
    return float(speed[:-6]) / (6 if speed.endswith("cm/min") else 1)


def _parse_points(lines: NumberedLines, cell: Cell) -> dict[int, tuple[str, str]]:
    """Return the place and angles of each point by its number, as written."""
    points: dict[int, tuple[str, str]] = {}
    pending, first = "", 0
    for number, line in lines:
        first = first if pending else number
        pending = f"{pending} {line}".strip()
        if not line.endswith("};"):
            continue
        found = _POINT.fullmatch(pending)
        if not found or int(found[1]) in points:
            raise Error(f"line {first}: {pending[:60]!r} is not a point that brushsvg writes", code="line-unread")
        if found[2] != cell.tool.configuration:
            sentence = f"line {first}: the arm's configuration is {found[2]!r}, not {cell.tool.configuration!r}"
            raise Error(sentence, code="line-unread")
        points[int(found[1])] = (", ".join(found.groups()[2:5]), ", ".join(found.groups()[5:]))
        pending = ""
    if pending:
        raise Error(f"line {first}: {pending[:60]!r} is not a point that brushsvg writes", code="line-unread")
    return points


def _with_setup_as_frames(lines: NumberedLines) -> NumberedLines:
    """Replace the lines that set frame and tool in a register by one each; join continued remarks."""
    out: NumberedLines = []
    held: dict[int, str] | None = None
    choices: NumberedLines = []
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
                raise Error(f"line {number}: {line!r} chooses a frame before anything sets it", code="line-incomplete")
            choices.append((number, line))
        elif line.startswith("!") or not line:
            out.append((number, line))
        else:
            out += _sort_settings(choices)
            choices = []
            out.append((number, line))
    return [each for each in out + _sort_settings(choices) if each[1]]


def _sort_settings(choices: NumberedLines) -> NumberedLines:
    """Return the settings before a move, sorted, with only the last value of each."""
    last = {line.partition(" ")[0]: (number, line) for number, line in choices}
    return [last[name] for name in sorted(last)]
