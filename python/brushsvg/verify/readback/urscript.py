"""Read back URScript that brushsvg wrote."""

from __future__ import annotations

import re

import numpy as np

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import of_rotation_vector
from ...machine.posts.urscript import BEGIN, END, NEXT
from . import Act, Readback, Step, add_circle, unread_error
from .script import NumberedLines

_N = r"-?(?:\d+\.?\d*|\.\d+)"
_POINT = rf"on_paper\(({_N}), ({_N}), ({_N})\)"
_MOVE = re.compile(rf"(movel|movep)\({_POINT}, a=({_N}), v=({_N})(?:, r=({_N}))?\)")
_TILTED = re.compile(
    rf"(movel|movep)\(tilted\(({_N}), ({_N}), ({_N}), ({_N}), ({_N}), ({_N})\), a=({_N}), v=({_N})(?:, r=({_N}))?\)"
)
_CIRCLE = re.compile(rf"movec\({_POINT}, {_POINT}, a=({_N}), v=({_N}), r=(?:0+\.?0*|\.0+), mode=1\)")
_PAPER = re.compile(rf"paper = p\[({_N}(?:, {_N}){{5}})\]")
_SLEEP = re.compile(r"sleep\((\d+\.?\d*|\.\d+)\)")
_RISE = re.compile(
    rf"(movel\(pose_trans\(paper, p\[here\[0\], here\[1\], ({_N}), here\[3\], here\[4\], here\[5\]\]\)), "
    rf"a=({_N}), v=({_N})\)"
)
TITLES = ("# stroke ", "# paint: ")
_FRAME_LINE = re.compile(  # the frame around the moves
    rf"def brushsvg\(\):|end|brushsvg\(\)|set_tcp\(p\[{_N}(?:, {_N}){{5}}\]\)|def on_paper\(x, y, z\):"
    rf"|return pose_trans\(paper, p\[x, y, z(?:, {_N}){{3}}\]\)"
    r"|def tilted\(x, y, z, rx, ry, rz\):|return pose_trans\(paper, p\[x, y, z, rx, ry, rz\]\)"
    r"|here = pose_trans\(pose_inv\(paper\), get_actual_tcp_pose\(\)\)"
    rf"|if here\[2\] < {_N}:"
    rf"|thread watch\(\):|while True:|if force\(\) > {_N}:|halt|sync\(\)|zero_ftsensor\(\)|kill watching"
    rf'|watching = run watch\(\)|textmsg\("brushsvg: the tool is pressed with more than {_N} N"\)'
    r'|popup\("[^"\\]*", "brushsvg", False, False, blocking=True\)'
)


def read_urscript(text: str, _cell: Cell) -> Readback:
    """Read one or more programs, in sequence, as steps in the paper frame.

    Line numbers continue through the programs. Raises Error with the line for a statement that brushsvg does not write.
    """
    out = Readback(in_paper_frame=True, blends_by_radius=True)
    has_paper = False
    lines = _join_programs(text)
    for number, line in lines:
        if line.startswith("# "):
            before = len(out.acts)
            out.comment(number, line[2:])
            if 0 < before < len(out.acts) and out.acts[before - 1].text.startswith("here ="):
                out.acts.insert(before - 1, out.acts.pop())  # a title has no effect on the line before it
        elif found := _MOVE.fullmatch(line):
            x, y, z, a, v, r = (float(value or 0) * 1e3 for value in found.groups()[1:])
            _check_speed(number, line, a, v)
            if r < 0:
                raise Error(f"line {number}: {line[:60]!r} has a negative blend", code="line-unread")
            out.section().steps.append(Step(number, False, x, y, z, v, r))
            out.acts.append(Act(number, "move", found[1], (x, y, z), (v, a), (r,)))
        elif found := _TILTED.fullmatch(line):
            x, y, z, a, v, r = (float(found[k] or 0) * 1e3 for k in (2, 3, 4, 8, 9, 10))
            _check_speed(number, line, a, v)
            if r < 0:
                raise Error(f"line {number}: {line[:60]!r} has a negative blend", code="line-unread")
            turned = of_rotation_vector([float(found[k]) for k in (5, 6, 7)])
            axis = tuple((-turned[:, 2]).tolist())
            out.section().steps.append(Step(number, False, x, y, z, v, r, axis=axis))
            out.acts.append(Act(number, "move", found[1], (x, y, z), (v, a), (r,), tuple(turned.ravel().tolist())))
        elif found := _CIRCLE.fullmatch(line):
            *points, a, v = (float(value) * 1e3 for value in found.groups())
            _check_speed(number, line, a, v)
            add_circle(out, number, np.array(points[:3]), np.array(points[3:]), v)
            out.acts.append(Act(number, "circle", "", tuple(points[3:]), (v, a), tuple(points[:3])))
        elif found := _SLEEP.fullmatch(line):
            out.acts.append(Act(number, "wait", same=(float(found[1]),)))
        elif found := _RISE.fullmatch(line):
            height_mm, a, v = (float(value) * 1e3 for value in found.groups()[1:])
            _check_speed(number, line, a, v)
            out.rises_mm.append(height_mm)
            out.acts.append(Act(number, "text", found[1], (), (v, a)))
        elif _FRAME_LINE.fullmatch(line) or (found := _PAPER.fullmatch(line)):
            has_paper = has_paper or bool(found)
            is_set = " = " in line and " = run " not in line  # a thread that is run twice makes two threads
            if is_set and out.acts and out.acts[-1].text == line:
                continue  # setting a variable again has no effect
            is_first = all(act.text.startswith("(") for act in out.acts)  # remarks may precede it
            out.acts.insert(0 if is_first else len(out.acts), Act(number, "text", line))
        else:
            raise unread_error(number, line)
    if not has_paper:
        raise Error("the line that sets the paper is missing", code="program-cut-short")
    code = [line for _, line in lines if not line.startswith("# ")]
    if code[-2:] != ["end", "brushsvg()"] or lines[-1][1] != code[-1]:
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    return out


def _check_speed(number: int, line: str, acceleration: float, speed: float) -> None:
    if not (acceleration > 0 and speed > 0):
        raise Error(f"line {number}: {line[:60]!r} has no speed or acceleration", code="line-incomplete")


def _join_programs(text: str) -> NumberedLines:
    """Return the lines in running order, as if all programs were one.

    Each program repeats the setup, which must be the same in all of them. Raises Error for a missing or changed part.
    """
    lines = [(number, line.strip(" ")) for number, line in enumerate(text.splitlines(), 1) if line.strip(" ")]
    starts = [k for k, (_, line) in enumerate(lines) if line == BEGIN.strip()][1:]
    parts = [lines[first:last] for first, last in zip([0, *starts], [*starts, None], strict=True)]
    joined: NumberedLines = []
    setup, rise = _setup_lines(parts[0]), _rise_lines(parts[0])
    if later := next((line for line in setup if line.startswith("# part: ")), None):
        raise Error(
            f"this is {later[2:].replace(':', '')} of a job in several files: check the first file, which finds the "
            "others next to it",
            code="program-cut-short",
        )
    for count, part in enumerate(parts, 1):
        if count > 1:
            _check_repeated_lines(part, [setup[0], f"# part: {count}", *setup[1:]], _setup_lines(part))
            _check_repeated_lines(part, rise, _rise_lines(part))
            part = part[len(setup) + 1 :]
            at = next((k for k, (_, line) in enumerate(part) if line in rise[:1]), 0)
            part = part[:at] + part[at + len(rise) :]
        if count < len(parts):
            end = [f'textmsg("{NEXT} {count + 1}")', *END.split()]
            _check_repeated_lines(part, end, [line for _, line in part[-len(end) :]])
            part = part[: -len(end)]
        joined += part
    return joined


def _setup_lines(part: NumberedLines) -> list[str]:
    """Return the lines before the first title."""
    lines = [line for _, line in part]
    return lines[: next((k for k, line in enumerate(lines) if line.startswith(TITLES)), len(lines))]


def _rise_lines(part: NumberedLines) -> list[str]:
    """Return the lines that move straight up before the first move. Settings among these lines are included."""
    lines = [line for _, line in part]
    first = next((k for k, line in enumerate(lines) if line.startswith("here = ")), len(lines))
    last = first + 4
    return lines[first : last + 2 * (lines[last : last + 1] == ["zero_ftsensor()"])]


def _check_repeated_lines(part: NumberedLines, expected: list[str], found: list[str]) -> None:
    if found != expected:
        raise Error(
            f"line {part[0][0]}: this part does not begin or end like the one before it: a part is missing, belongs "
            "to another job, or was changed",
            code="program-cut-short",
        )
