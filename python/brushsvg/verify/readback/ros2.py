"""Read back poses with times for ROS 2, as a table or as JSON."""

from __future__ import annotations

import json
import math
import re

import numpy as np

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import apart_deg, frame_of_pose, of_quaternion, rotation
from ...machine.header_lines import TILT_LINE
from ...machine.posts.ros2 import COLUMNS, flange_from_tip
from ...machine.posts.script import upright_deg
from ...machine.posts.text import PROGRAM_END
from ...machine.tool_axes import turned_on, turned_to
from . import Act, Readback, Step, unread_error
from .script import TILT_TOLERANCE_DEG

_N = r"-?(?:\d+\.?\d*|\.\d+)"
_ROW = re.compile(rf"({_N}(?:,{_N}){{8}}),(pose|way|rest)")
_FIRST_JSON_LINE = '{"format": "brushsvg/trajectory", "version": 1, "rows": ['
_COLUMN_NAMES_LINE = '["' + COLUMNS.replace(",", '","') + '"]'
MIN_TIME_STEP_S = 1e-7
PATH_ROUNDING_MM = 2e-4  # change of a path by rounded decimals
QUATERNION_LENGTH_TOLERANCE = 1e-2  # deviation of a quaternion from length 1: smaller ones are normalised
ROTATION_ROUNDING_DEG = 1e-4  # change of a rotation by rounded decimals
PLACE_TOLERANCE_MM = 3e-3  # distance of places: no brush shows a smaller one
SPEED_TOLERANCE_SHARE, SPEED_TOLERANCE_MM_S = 1e-3, 0.01  # change of a speed by rounding: share and mm/s


def as_table(text: str) -> str:
    """Convert JSON to the lines of a table, with the same line numbers. Raises Error for invalid JSON."""
    try:
        json.loads(text)
    except ValueError as mistake:
        raise Error(f"it is not valid JSON: {mistake}", code="line-unread") from None
    except RecursionError:
        raise Error("brushsvg does not write such JSON: its lists are nested too deeply", code="line-unread") from None
    lines = text.splitlines()
    if lines[0].rstrip(" ") != _FIRST_JSON_LINE:
        raise unread_error(1, lines[0])
    return "\n".join(["", *(_table_line(line.strip(" ")) for line in lines[1:])]) + "\n"


def _table_line(line: str) -> str:
    """Return the table line for a line of JSON. A line without a counterpart is returned unchanged."""
    try:
        row = json.loads(line.removesuffix(",") if line.endswith(",") else line.removesuffix("]}"))
    except ValueError:
        return line
    if line.rstrip(",") == _COLUMN_NAMES_LINE:
        return COLUMNS
    if isinstance(row, list) and len(row) == 1 and isinstance(row[0], str) and row[0].startswith("# "):
        return row[0]
    if found := re.fullmatch(rf'\[({_N}(?:,{_N}){{8}}),"(pose|way|rest)"\],', line):
        return f"{found[1]},{found[2]}"
    return line


def read_ros2(text: str, cell: Cell) -> Readback:
    """Read the rows as steps in the robot frame.

    Raises Error with the line for a row that brushsvg does not write, for times that do not increase, and for a path
    that is faster than its row allows.
    """
    if text.startswith("{"):
        text = as_table(text)
    reader = _RowReader(cell)
    lines = [(number, line.strip(" ")) for number, line in enumerate(text.splitlines(), 1) if line.strip(" ")]
    rows, found = [], [_ROW.fullmatch(line) for _, line in lines]
    for (number, line), row in zip(lines, found, strict=True):
        if row:
            rows.append([float(value) for value in row[1].split(",")])
        elif not line.startswith("# ") and line != COLUMNS:
            raise unread_error(number, line)
    numbers = [number for (number, _), row in zip(lines, found, strict=True) if row]
    is_tilted = any(line == f"# {TILT_LINE}" for _, line in lines)
    places, turned = _tips_and_rotations(np.array(rows).reshape(-1, 9), numbers, cell, is_tilted)
    on_grid = np.array([row[2] != "way" for row in found if row], dtype=bool)
    places[on_grid] = np.round(places[on_grid], cell.decimals)
    tips, turns = iter(places.tolist()), iter(turned)
    values, header_count = iter(rows), 0
    for (number, line), row in zip(lines, found, strict=True):
        if row:
            if header_count != 1:
                raise Error(f"line {number}: exactly one line must name the columns", code="line-unread")
            reader.row(number, next(values), tuple(next(tips)), row[2], next(turns))
        elif line == COLUMNS:
            header_count += 1
        elif line != f"# {PROGRAM_END}":
            reader.out.comment(number, line[2:])
    if not lines or lines[-1][1] != f"# {PROGRAM_END}" or reader.ways:
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    return reader.out


def _tips_and_rotations(rows: np.ndarray, numbers: list[int], cell: Cell, is_tilted: bool) -> tuple[np.ndarray, list]:
    """Return the places of the brush's tip (n, 3) [mm], and the tool's rotations.

    A rotation is (3, 3), or None where the tool is upright. Raises Error where the tool is tilted although no line says
    so, and for a quaternion that is not of length 1.
    """
    sizes = np.linalg.norm(rows[:, 4:8], axis=1, keepdims=True)
    off = np.abs(sizes[:, 0] - 1) > QUATERNION_LENGTH_TOLERANCE
    turns = rows[:, 4:8] / np.where(sizes > 0, sizes, 1.0)
    upright = rotation(upright_deg(cell)) @ flange_from_tip(cell)[:3, :3]
    turned = of_quaternion(turns[:, [3, 0, 1, 2]])
    leans_deg = apart_deg(turned, upright)
    for k in np.flatnonzero(off | ((leans_deg > TILT_TOLERANCE_DEG) & (not is_tilted))):
        if off[k]:
            raise Error(f"line {numbers[k]}: its quaternion is not of length 1", code="line-unread")
        sentence = f"line {numbers[k]}: the tool is turned {leans_deg[k]:.4g} degrees from upright on the paper"
        raise Error(sentence, code="tool-turned")
    tip_in_flange = frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg)[:3, 3]
    tips = 1e3 * rows[:, 1:4] + turned @ tip_in_flange
    stands = leans_deg < ROTATION_ROUNDING_DEG if is_tilted else np.ones(len(rows), dtype=bool)
    tool = turned @ frame_of_pose(np.zeros(3), cell.tool.rotation_deg)[:3, :3]
    return tips, [None if upright else each for each, upright in zip(tool, stands.tolist(), strict=True)]


class _RowReader:
    def __init__(self, cell: Cell):
        self.out = Readback(blends_by_radius=True)
        self.near_mm = max(PLACE_TOLERANCE_MM, 1.5 * 10.0**-cell.decimals)
        self.rounded_mm = 3**0.5 * 10.0**-cell.decimals  # rounding of a path between two poses
        self.now_s, self.begin_s = 0.0, 0.0  # times of the last row and of the last pose
        self.last: tuple = ()
        self.here: tuple | None = None
        self.ways: list[tuple[int, tuple, float, np.ndarray | None]] = []
        self.upright = rotation(upright_deg(cell))
        self.turned: np.ndarray | None = None

    def row(self, number: int, values: list[float], tip: tuple, kind: str, turned: np.ndarray | None) -> None:
        now_s, limit_mm_s = values[0], 1e3 * values[8]
        if self.here is None:
            if kind != "pose" or now_s != 0:
                raise Error(f"line {number}: the first row is not a pose at time 0", code="line-unread")
            self._add_pose(number, tip, (limit_mm_s, limit_mm_s), now_s, turned)
            return
        if now_s < self.now_s + MIN_TIME_STEP_S:
            raise Error(f"line {number}: time {now_s:g} s is not later than the row before", code="line-unread")
        after_s, way_mm = now_s - self.now_s, math.dist(tip, self.last)
        if kind == "rest":
            if self.ways or way_mm > self.near_mm or limit_mm_s or not self._is_same_rotation(turned, self.turned):
                raise Error(f"line {number}: the tool moves during a pause", code="line-unread")
            step = self.out.section().steps[-1] if self.out.section().steps else None
            if step is None:
                raise Error(f"line {number}: it pauses before any pose", code="line-unread")
            self.out.acts.append(Act(number, "wait", same=(after_s,)))
            self.now_s = self.begin_s = now_s
            return
        if not limit_mm_s > 0:
            raise Error(f"line {number}: no speed is allowed", code="line-incomplete")
        rounded_mm_s = PATH_ROUNDING_MM / after_s
        if way_mm > after_s * (limit_mm_s * (1 + SPEED_TOLERANCE_SHARE) + SPEED_TOLERANCE_MM_S + rounded_mm_s):
            sentence = f"line {number}: speed {way_mm / after_s:.1f} mm/s, its limit {limit_mm_s:.1f} mm/s"
            raise Error(sentence, code="speed-out-of-range")
        self.now_s, self.last = now_s, tip
        if kind == "way":
            self.ways.append((number, tip, limit_mm_s, turned))
            return
        self._check_way_rows(tip, limit_mm_s, turned)
        way_mm, took_s = math.dist(tip, self.here), now_s - self.begin_s
        # The mean speed of a short path is uncertain, because both of its ends are rounded.
        self._add_pose(number, tip, (limit_mm_s, way_mm / took_s, self.rounded_mm / took_s), now_s, turned)

    def _add_pose(
        self,
        number: int,
        tip: tuple,
        at_most: tuple,
        now_s: float,
        turned: np.ndarray | None,
    ) -> None:
        axis, turned_axes = ((), ()) if turned is None else (tuple(-turned[:, 2]), tuple(turned.ravel().tolist()))
        self.out.section().steps.append(Step(number, False, *tip, at_most[0], axis=axis))
        self.out.acts.append(Act(number, "move", "movel", tip, at_most, (0.0,), turned_axes))
        self.here = self.last = tip
        self.turned = turned
        self.now_s = self.begin_s = now_s

    def _is_same_rotation(self, a: np.ndarray | None, b: np.ndarray | None) -> bool:
        """Return whether no brush shows a difference of two rotations. None is upright."""
        a, b = (self.upright if each is None else each for each in (a, b))
        return bool(apart_deg(a, b) <= TILT_TOLERANCE_DEG)

    def _check_way_rows(self, tip: tuple, limit_mm_s: float, turned: np.ndarray | None) -> None:
        """Check the rows between the last pose and this one.

        Raises Error where they are not in order on the straight line between both poses, or where the tool's rotation
        is not between the rotations of both.
        """
        start, way = np.array(self.here), np.subtract(tip, self.here)
        length, done = float(np.linalg.norm(way)), 0.0
        for number, place, its_mm_s, its_turn in self.ways:
            step = np.array(place) - start
            along = float(step @ way) / length if length else 0.0
            sideways_mm = float(np.linalg.norm(step - along * way / length)) if length else math.inf
            if sideways_mm > self.near_mm or not done - self.near_mm <= along <= length + self.near_mm:
                raise Error(f"line {number}: it is not on a straight line to the next pose", code="line-unread")
            a, b, c = (self.upright if each is None else each for each in (self.turned, its_turn, turned))
            share = min(max(along / length, 0.0), 1.0)
            if not self._is_same_rotation(b, turned_to(turned_on(-a[:, 2], -c[:, 2], share), self.upright)):
                raise Error(f"line {number}: the tool does not turn evenly to the next pose", code="line-unread")
            if its_mm_s != limit_mm_s:
                raise Error(f"line {number}: its speed limit differs from the one of the next pose", code="line-unread")
            done = along
        self.ways = []
