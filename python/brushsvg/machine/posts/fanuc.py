"""Moves -> TP (.ls) for FANUC robots: millimetres, degrees, the paper as user frame 1, the brush's tip as tool 1."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from tempfile import SpooledTemporaryFile

import numpy as np

from ..cells.cell import MAX_PROGRAM_POINTS, Cell
from ..frames import rotation_deg
from ..motion import Move, Program, Section, Wait, via_point
from .dobot import whole_mm_s
from .script import LanguageWords, blends_mm, down, name_part, tool_rotations_at, write_section
from .text import STATEMENT_ENDS, format_number, format_rows, plain_text

LINE_LIMIT = 100  # of a remark, on as many lines as it needs
REMARK = 32  # letters of one line of it
DEGREE_DECIMALS, POINT_DECIMALS = 5, 3  # of the angles of frames and of points
MAIN = "BRUSHSVG"
INDEX = 1  # of the user frame, the tool, and the registers that set them
RISE, HEIGHT = 2, 1  # position register and register of the rise
HELD_BYTES = 20_000_000  # of text, before it goes to a file
FANUC_END = "end: the brush is held up"


def fanuc(program: Program) -> Iterator[str]:
    """One program, or, where it has more points than one may have, a main one that calls others, each with whole
    strokes. Points are those of the user frame: to teach the paper anew, only its lines have to change."""
    cell = program.cell
    setup = "".join(map(comment, program.header)) + _setup(program)
    end = comment(FANUC_END)
    points, lines, calls, risen = _Points(cell), "", [], False
    with SpooledTemporaryFile(HELD_BYTES, "w+", encoding="ascii") as held:
        for section in program.sections():
            if points.count and points.count + _count(section) > MAX_PROGRAM_POINTS["fanuc"]:
                calls.append(name_part(setup, len(calls) + 1))
                held.write(_program(calls[-1], lines, points))
                points, lines = _Points(cell), ""
            lines += "".join(write_section(section, _words(program, points), risen))
            risen = risen or bool(section.moves)
        if not calls:
            yield _program(MAIN, setup + lines + end, points)
            return
        calls.append(name_part(setup, len(calls) + 1))
        held.write(_program(calls[-1], lines, points))
        called = "".join(f" : CALL {call} ;\n" for call in calls)
        yield _program(MAIN, setup + called + end, _Points(cell))
        held.seek(0)
        while piece := held.read(1_000_000):
            yield piece


def programs(text: str) -> dict[str, str]:
    """Return the texts of a stream of programs in a dictionary of names, the main one's as ""."""
    found = re.split(r"^(?=/PROG)", text, flags=re.MULTILINE)[1:]
    named = {re.match(r"/PROG +(\S*)", each)[1]: each for each in found}
    return {"" if name == MAIN else name: each for name, each in named.items()}


def called(text: str) -> list[str]:
    """Names of the programs that one calls, in order, each once."""
    found = re.finditer(r"^ *\d*: *CALL +(\w+) *;", text, re.MULTILINE)
    return list(dict.fromkeys(each[1] for each in found))


def comment(text: str) -> str:
    """As remarks of so many letters: what goes on begins with a plus."""
    left, lines = plain_text(text, LINE_LIMIT).translate(STATEMENT_ENDS), []
    while left or not lines:
        begin = "+" if lines else ""
        kept = left[: REMARK - len(begin)]
        if len(kept) < len(left):
            kept = kept.rstrip(" ") or kept
        lines.append(f" : !{begin}{kept} ;\n")
        left = left[len(kept) :]
    return "".join(lines)


class _Points:
    """Of one program: each has its number there, a place, and angles where the brush is tilted."""

    def __init__(self, cell: Cell):
        self.decimals, self.count = cell.decimals, 0
        self.held: list[tuple[np.ndarray, tuple[str, str, str]]] = []
        self.stands = down(cell.tool.spin_deg)
        self.upright = _angles(self.stands)
        x, y, z = (f"{axis} = %.{cell.decimals}f  mm" for axis in "XYZ")
        self.place = (
            f"P[%d]{{\n   GP1:\n\tUF : {INDEX}, UT : {INDEX},\t\tCONFIG : '{cell.tool.configuration}',\n"
            f"\t{x},\t{y},\t{z},\n"
        )

    def more(self, move: Move, points_mm: np.ndarray) -> np.ndarray:
        """(n,) the numbers of new points (n, 3), all those of a move where it tilts the brush."""
        first = self.count + 1
        if move.axes is None:
            self.held.append((points_mm, self.upright))
        else:
            turns = tool_rotations_at(move, self.stands)
            angles = (self.upright if turned is None else _angles(turned) for turned in turns)
            self.held += zip(points_mm[:, None], angles, strict=True)
        self.count += len(points_mm)
        return np.arange(first, self.count + 1)

    def text(self) -> str:
        rows_text, first = "", 1
        for angles, alike in itertools.groupby(self.held, lambda each: each[1]):
            places = np.vstack([points_mm for points_mm, _ in alike])
            values = np.column_stack([np.arange(first, first + len(places)), places])
            w, p, r = angles
            held = f"\tW = {w} deg,\tP = {p} deg,\tR = {r} deg\n}};"
            rows_text += "".join(format_rows(self.place + held, values, self.decimals))
            first += len(places)
        return rows_text


def _angles(turned: np.ndarray) -> tuple[str, str, str]:
    """W, P and R of the tool (3, 3): about the fixed axes x, y and z."""
    w, p, r = (format_number(angle, POINT_DECIMALS) for angle in rotation_deg(turned))
    return w, p, r


def _program(name: str, lines: str, points: _Points) -> str:
    return (
        f'/PROG  {name}\n/ATTR\nCOMMENT\t\t= "brushsvg";\nPROTECT\t\t= READ_WRITE;\nDEFAULT_GROUP\t= 1,*,*,*,*;\n'
        f"/MN\n{lines}/POS\n{points.text()}/END\n"
    )


def _setup(program: Program) -> str:
    """The register holds a place of the arm first, so that it has all six values."""
    cell = program.cell
    paper, tool = program.robot_from_frame, cell.tool
    frames = (
        ("UFRAME", paper[:3, 3], rotation_deg(paper[:3, :3])),
        ("UTOOL", tool.tcp_mm, tool.rotation_deg),
    )
    lines = [f"PR[{INDEX}]=LPOS"]
    for name, origin_mm, turned_deg in frames:
        values = [format_number(value, cell.decimals) for value in origin_mm]
        values += [format_number(angle, DEGREE_DECIMALS) for angle in turned_deg]
        lines += [f"PR[{INDEX},{k}]={_constant(value)}" for k, value in enumerate(values, 1)]
        lines.append(f"{name}[{INDEX}]=PR[{INDEX}]")
    lines += [f"UFRAME_NUM={INDEX}", f"UTOOL_NUM={INDEX}"]
    return "".join(f" : {line} ;\n" for line in lines)


def _constant(value: str) -> str:
    return f"({value})" if value.startswith("-") else value


def _words(program: Program, points: _Points) -> LanguageWords:
    height = format_number(program.rise_mm, program.cell.decimals)
    return LanguageWords(
        comment,
        lambda speed: _rise(height, speed),
        _wait,
        lambda move: _lines(move, points, program.cell.blending.ramp_s),
    )


def _count(section: Section) -> int:
    return sum(len(move.points_mm) if move.arc is None else 2 for move in section.moves)


def _rise(height: str, speed_mm_s: float) -> str:
    lines = (
        f"PR[{RISE}]=LPOS",
        f"R[{HEIGHT}]=PR[{RISE},3]",
        f"IF (R[{HEIGHT}]<{height}) THEN",
        f"PR[{RISE},3]={_constant(height)}",
        f"L PR[{RISE}] {whole_mm_s(speed_mm_s)}mm/sec FINE",
        "ENDIF",
    )
    return "".join(f" : {line} ;\n" for line in lines)


def _lines(move: Move, points: _Points, ramp_s: float) -> Iterator[str]:
    speed = whole_mm_s(move.speed_mm_s)
    if move.arc is not None:
        numbers = points.more(move, np.vstack([via_point(move.points_mm), move.points_mm[-1]]))
        yield " : C P[{}]\n :  P[{}] {}mm/sec FINE ;\n".format(*numbers, speed)
        return
    numbers = points.more(move, move.points_mm)
    percent = np.zeros(len(numbers))
    if move.blends_mm is not None:
        percent = np.minimum(
            np.floor(blends_mm(move, points.decimals) / cnt_mm(1, speed, ramp_s) + 1e-9), 100
        )
    ends = (f"CNT{each}" if each else "FINE" for each in percent.astype(int).tolist())
    yield "".join(
        f" : L P[{each}] {speed}mm/sec {end} ;\n" for each, end in zip(numbers.tolist(), ends, strict=True)
    )


def cnt_mm(percent: float, speed_mm_s: float, ramp_s: float) -> float:
    """How far before a point the next move begins at most [mm]: with CNT100 when the arm begins to slow down, v T / 2
    before it, with less that share of its time later, of which the way is no larger a share."""
    return percent / 100 * speed_mm_s * ramp_s / 2


def _wait(step: Wait) -> str:
    if step.seconds is None:
        return comment(f"stop: {step.message}") + " : PAUSE ;\n"
    return f" : WAIT {format_number(np.ceil(100 * step.seconds - 1e-6) / 100, 2)}(sec) ;\n"
