"""Write TP (.ls) for FANUC robots.

Units are millimetres and degrees. The paper is user frame 1, and the brush's tip is tool 1.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from tempfile import SpooledTemporaryFile

import numpy as np

from ..cells.cell import Cell
from ..cells.language_limits import MAX_PROGRAM_POINTS
from ..frames import rotation_deg
from ..moves import Move, Program, Section, Wait, via_point
from .dobot import round_down_speed_mm_s
from .program_parts import name_on_controller, name_parts
from .script import LanguageWords, blends_mm, tool_rotations_at, upright_tool_rotation, write_section
from .text import PROGRAM_END, STATEMENT_ENDS, format_number, format_rows, plain_text

LINE_LIMIT = 100  # letters of a remark, which may need several lines
REMARK_LETTERS = 32  # letters of one line of a remark
DEGREE_DECIMALS, POINT_DECIMALS = 5, 3  # decimals of the angles of frames and of points
MAX_NAME_LETTERS = 8
INDEX = 1  # number of the user frame, the tool, and the registers that set them
RISE_REGISTER, HEIGHT_REGISTER = 2, 1  # position register and register that the rise uses
MAX_TEXT_IN_MEMORY_BYTES = 20_000_000  # larger text is kept in a file


def fanuc(program: Program) -> Iterator[str]:
    """Write a program for a FANUC robot.

    A job with too many points for one program becomes a main program that calls others, each with whole strokes. Points
    are in the user frame. To teach the paper anew, only the lines of the user frame have to change.
    """
    cell, name = program.cell, controller_name(program.name)
    setup = "".join(map(comment, program.header)) + _setup_lines(program)
    end = comment(PROGRAM_END)
    points, section_text, calls, names, risen = _ProgramPoints(cell), "", [], None, False
    with SpooledTemporaryFile(MAX_TEXT_IN_MEMORY_BYTES, "w+", encoding="ascii") as held_file:
        for section in program.sections():
            if points.count and points.count + _count_points(section) > MAX_PROGRAM_POINTS["fanuc"]:
                names = names or name_parts(program, setup)
                calls.append(next(names))
                held_file.write(_write_program(calls[-1], section_text, points))
                points, section_text = _ProgramPoints(cell), ""
            section_text += "".join(write_section(section, _language_words(program, points), risen))
            risen = risen or bool(section.moves)
        if not calls:
            yield _write_program(name, setup + section_text + end, points)
            return
        calls.append(next(names))
        held_file.write(_write_program(calls[-1], section_text, points))
        called = "".join(f" : CALL {call} ;\n" for call in calls)
        yield _write_program(name, setup + called + end, _ProgramPoints(cell))
        held_file.seek(0)
        while piece := held_file.read(1_000_000):
            yield piece


def controller_name(name: str) -> str:
    """Return the name of a program on the controller."""
    return name_on_controller(name, MAX_NAME_LETTERS)


def name_in(text: str) -> str:
    """Return the name of the main program, or "" if there is none."""
    found = re.search(r"^/PROG\s+(\w+)", text, re.MULTILINE)
    return found[1] if found else ""


def programs(text: str) -> dict[str, str]:
    """Return the texts of a stream of programs, keyed by program name. The main program has the name ""."""
    main, *others = re.split(r"^(?=/PROG)", text, flags=re.MULTILINE)[1:]
    return {"": main} | {re.match(r"/PROG +(\S*)", program_text)[1]: program_text for program_text in others}


def called(text: str) -> list[str]:
    """Return the names of the programs that a program calls. They are in order and without repetition."""
    calls = re.finditer(r"^ *\d*: *CALL +(\w+) *;", text, re.MULTILINE)
    return list(dict.fromkeys(call[1] for call in calls))


def comment(text: str) -> str:
    """Return a comment as remarks of at most REMARK_LETTERS letters. Each continuation begins with a plus."""
    rest, lines = plain_text(text, LINE_LIMIT).translate(STATEMENT_ENDS), []
    while rest or not lines:
        begin = "+" if lines else ""
        kept = rest[: REMARK_LETTERS - len(begin)]
        if len(kept) < len(rest):
            kept = kept.rstrip(" ") or kept
        lines.append(f" : !{begin}{kept} ;\n")
        rest = rest[len(kept) :]
    return "".join(lines)


class _ProgramPoints:
    """The numbered points of one program, with the angles of the tool."""

    def __init__(self, cell: Cell):
        self.decimals, self.count = cell.decimals, 0
        self.held: list[tuple[np.ndarray, tuple[str, str, str]]] = []
        self.upright_rotation = upright_tool_rotation(cell.tool.spin_deg)
        self.upright = _wpr_angles(self.upright_rotation)
        x, y, z = (f"{axis} = %.{cell.decimals}f  mm" for axis in "XYZ")
        self.place = (
            f"P[%d]{{\n   GP1:\n\tUF : {INDEX}, UT : {INDEX},\t\tCONFIG : '{cell.tool.configuration}',\n"
            f"\t{x},\t{y},\t{z},\n"
        )

    def add(self, move: Move, points_mm: np.ndarray) -> np.ndarray:
        """Add points (n, 3) and return their numbers (n,).

        If the move tilts the brush, the points must be all points of the move.
        """
        first = self.count + 1
        if move.axes is None:
            self.held.append((points_mm, self.upright))
        else:
            turns = tool_rotations_at(move, self.upright_rotation)
            angles = (self.upright if turned is None else _wpr_angles(turned) for turned in turns)
            self.held += zip(points_mm[:, None], angles, strict=True)
        self.count += len(points_mm)
        return np.arange(first, self.count + 1)

    def text(self) -> str:
        rows_text, first = "", 1
        for angles, points_of_angles in itertools.groupby(self.held, lambda entry: entry[1]):
            places = np.vstack([points_mm for points_mm, _ in points_of_angles])
            values = np.column_stack([np.arange(first, first + len(places)), places])
            w, p, r = angles
            angles_text = f"\tW = {w} deg,\tP = {p} deg,\tR = {r} deg\n}};"
            rows_text += "".join(format_rows(self.place + angles_text, values, self.decimals))
            first += len(places)
        return rows_text


def _wpr_angles(turned: np.ndarray) -> tuple[str, str, str]:
    """Return W, P and R of a rotation (3, 3). They are the tool's angles about the fixed axes x, y and z."""
    w, p, r = (format_number(angle, POINT_DECIMALS) for angle in rotation_deg(turned))
    return w, p, r


def _write_program(name: str, lines: str, points: _ProgramPoints) -> str:
    return (
        f'/PROG  {name}\n/ATTR\nCOMMENT\t\t= "brushsvg";\nPROTECT\t\t= READ_WRITE;\nDEFAULT_GROUP\t= 1,*,*,*,*;\n'
        f"/MN\n{lines}/POS\n{points.text()}/END\n"
    )


def _setup_lines(program: Program) -> str:
    """Return the lines that set frame and tool; a place of the arm first fills all six register values."""
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
        lines += [f"PR[{INDEX},{k}]={_parenthesize_negative(value)}" for k, value in enumerate(values, 1)]
        lines.append(f"{name}[{INDEX}]=PR[{INDEX}]")
    lines += [f"UFRAME_NUM={INDEX}", f"UTOOL_NUM={INDEX}"]
    return "".join(f" : {line} ;\n" for line in lines)


def _parenthesize_negative(value: str) -> str:
    return f"({value})" if value.startswith("-") else value


def _language_words(program: Program, points: _ProgramPoints) -> LanguageWords:
    height = format_number(program.rise_mm, program.cell.decimals)
    return LanguageWords(
        comment,
        lambda speed: _rise_lines(height, speed),
        _wait_lines,
        lambda move: _move_lines(move, points, program.cell.blending.ramp_s),
    )


def _count_points(section: Section) -> int:
    return sum(len(move.points_mm) if move.arc is None else 2 for move in section.moves)


def _rise_lines(height: str, speed_mm_s: float) -> str:
    lines = (
        f"PR[{RISE_REGISTER}]=LPOS",
        f"R[{HEIGHT_REGISTER}]=PR[{RISE_REGISTER},3]",
        f"IF (R[{HEIGHT_REGISTER}]<{height}) THEN",
        f"PR[{RISE_REGISTER},3]={_parenthesize_negative(height)}",
        f"L PR[{RISE_REGISTER}] {round_down_speed_mm_s(speed_mm_s)}mm/sec FINE",
        "ENDIF",
    )
    return "".join(f" : {line} ;\n" for line in lines)


def _move_lines(move: Move, points: _ProgramPoints, ramp_s: float) -> Iterator[str]:
    speed = round_down_speed_mm_s(move.speed_mm_s)
    if move.arc is not None:
        numbers = points.add(move, np.vstack([via_point(move.points_mm), move.points_mm[-1]]))
        yield " : C P[{}]\n :  P[{}] {}mm/sec FINE ;\n".format(*numbers, speed)
        return
    numbers = points.add(move, move.points_mm)
    percent = np.zeros(len(numbers))
    if move.blends_mm is not None:
        percent = np.minimum(np.floor(blends_mm(move, points.decimals) / cnt_mm(1, speed, ramp_s) + 1e-9), 100)
    ends = (f"CNT{each}" if each else "FINE" for each in percent.astype(int).tolist())
    yield "".join(f" : L P[{each}] {speed}mm/sec {end} ;\n" for each, end in zip(numbers.tolist(), ends, strict=True))


def cnt_mm(percent: float, speed_mm_s: float, ramp_s: float) -> float:
    """Return the largest distance [mm] before a point at which the next move begins.

    With CNT100, the next move begins when the arm begins to slow down, v T / 2 before the point. With a smaller CNT, it
    begins later by the corresponding share of T. The distance is at most this share of v T / 2.
    """
    return percent / 100 * speed_mm_s * ramp_s / 2


def _wait_lines(step: Wait) -> str:
    if step.seconds is None:
        return comment(f"stop: {step.message}") + " : PAUSE ;\n"
    return f" : WAIT {format_number(np.ceil(100 * step.seconds - 1e-6) / 100, 2)}(sec) ;\n"
