"""Programs before the first stroke: where will it be painted, and how high does the paper lie."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..errors import Error
from .cell import LEAST_SPEED_MM_S, Cell, robot_from_paper
from .distortion import told_mm
from .motion import Move, Program, Section, Wait, at_told_speeds, rise_over
from .program import approach_mm_s, astray_in, out_of_arm, over, safely_over
from .workspace_limits import touching_mm_s

CORNER_WAIT_S = 0.5  # long enough to look where the tip stands
SPEED_MM_S = 15.0
STROKE_MM = 12.0
LANE_MM = 6.0
LANE_APART_MM = 25.0  # an arm does what is between two such lanes, where it does both
LONG_EVERY = 5  # every fifth stroke is half as long again, to count by
LONGER = 1.5


def around(bounds_mm) -> tuple[float, float, float, float]:
    """(left, bottom, right, top) as a header can say it: outwards to whole hundredths of a millimetre."""
    left, bottom, right, top = bounds_mm
    out = [math.floor(side * 100 + 1e-6) / 100 for side in (left, bottom, -right, -top)]
    return (out[0], out[1], -out[2], -out[3])


def border(around_mm, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> Program:
    """An air run: at safe height round (left, bottom, right, top) [mm] of what will be painted, corner by corner.

    Error when it leaves the workspace.
    """
    left, bottom, right, top = around_mm
    corners = ((left, bottom), (right, bottom), (right, top), (left, top), (left, bottom))
    told = np.vstack([told_mm(over(corner, 0.0), cell.machine) for corner in corners])
    path = np.vstack([safely_over(corner, cell) for corner in told])

    def sections() -> Iterator[Section]:
        start = Move("travel", path[:1], cell.speeds.travel_mm_s)
        slow_mm_s = approach_mm_s(brush, cell)
        steps = [
            step
            for corner in path[1:]
            for step in (Wait(CORNER_WAIT_S), Move("look", corner[None], slow_mm_s))
        ]
        yield Section("border of the job, at safe height", (start, *steps))

    return _unless_astray(sections, brush, cell, sheet_mm, z_offset_mm)


def paper_height(brush, cell: Cell, sheet_mm, highest_mm: float, lowest_mm: float, step_mm: float) -> Program:
    """Short strokes side by side, each step_mm deeper than the one before, from highest_mm over the paper to
    lowest_mm, as the cell believes it to lie: the first that leaves paint tells the paper's true height.

    Error when they do not fit on the sheet or go deeper than brush or cell allow.
    """
    heights = strokes_at(highest_mm, lowest_mm, step_mm)
    if lowest_mm < cell.heights.lowest_mm or -lowest_mm > brush.depth_range_mm[1]:
        least = max(cell.heights.lowest_mm, -brush.depth_range_mm[1])
        raise Error(
            f"height {lowest_mm:g} mm is outside the range [{least:g}, {highest_mm:g}] mm of brush and cell",
            code="height-out-of-range",
        )
    starts = _lanes(len(heights), sheet_mm)
    safe, speeds = cell.heights.safe_mm, cell.speeds
    clearance = max(cell.heights.clearance_mm, highest_mm + 0.5)
    if clearance > safe:
        raise Error(
            f"height {highest_mm:g} mm is outside the range [{lowest_mm:g}, {safe - 0.5:g}] mm below safe height",
            code="height-out-of-range",
        )
    speed = min(touching_mm_s(brush, cell), SPEED_MM_S)
    if speed < (least_mm_s := LEAST_SPEED_MM_S.get(cell.language, 0.0)):
        raise Error(
            f"speed {speed:.4g} mm/s of brush {brush.name} is outside the range [{least_mm_s:g}, {SPEED_MM_S:g}] mm/s "
            f"of cell {cell.name}",
            code="speed-out-of-range",
        )
    press = min(speeds.press_mm_s, speed)
    steps = []
    for number, (height, (x, y)) in enumerate(zip(heights, starts, strict=True)):
        length = STROKE_MM * (LONGER if number % LONG_EVERY == 0 else 1.0)
        ends = (x, y), (x + length, y)
        first, last = (told_mm(over(end, height), cell.machine) for end in ends)
        down, up = (told_mm(over(end, clearance), cell.machine) for end in ends)
        steps.append(
            (
                Move("travel", safely_over(down[0], cell), speeds.travel_mm_s),
                Move("approach", down, approach_mm_s(brush, cell)),
                Move("land", first, press),
                Move("paint", last, speed),
                Move("lift", up, press),
                Move("retract", safely_over(up[0], cell), speeds.travel_mm_s),
            )
        )

    def sections() -> Iterator[Section]:
        for number, (height, each) in enumerate(zip(heights, steps, strict=True), 1):
            yield Section(
                f"stroke {number} of {len(heights)}: first to paint means --z-offset {height:.2f}", each
            )

    return _unless_astray(sections, brush, cell, sheet_mm)


def over_sheet(brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> Program:
    """To and fro over a whole sheet, at the safe height and touching it: what any drawing on it may ask of an arm. It
    is asked and never run; limits are not looked at."""
    width, height = sheet_mm
    lanes = np.linspace(0.0, height, max(2, math.ceil(height / LANE_APART_MM) + 1))
    ends = [((0.0, y), (width, y))[:: 1 if k % 2 == 0 else -1] for k, y in enumerate(lanes)]
    flat = np.array(ends).reshape(-1, 2)
    high, low = (np.column_stack([flat, np.full(len(flat), z)]) for z in (cell.heights.safe_mm, 0.0))
    moves = (
        Move("travel", high, cell.speeds.travel_mm_s),
        Move("look", low[::-1], touching_mm_s(brush, cell)),
        Move("retract", over(low[0], cell.heights.safe_mm), cell.speeds.travel_mm_s),
    )
    frame = robot_from_paper(cell, z_offset_mm)
    rises_mm = (rise_over(cell, sheet_mm, of) for of in (np.eye(4), frame))
    sections = (Section("the sheet", moves),)
    return Program((), cell, frame, lambda: iter(sections), *rises_mm, touching_mm_s(brush, cell))


def strokes_at(highest_mm: float, lowest_mm: float, step_mm: float) -> np.ndarray:
    """Heights [mm] of the strokes, from above down. Error for a step that makes less than 2 or more than 100."""
    count = int(np.floor((highest_mm - lowest_mm) / step_mm + 1e-9)) + 1
    if not 2 <= count <= 100:
        raise Error(
            f"from {highest_mm:g} to {lowest_mm:g} mm by {step_mm:g} mm are {count} strokes, not 2 to 100",
            code="strokes-out-of-range",
        )
    return highest_mm - step_mm * np.arange(count)


def _lanes(count: int, sheet_mm) -> list[tuple[float, float]]:
    """Where each stroke starts: from the sheet's top down, then in the next column."""
    width, height = sheet_mm
    rows = int((height - 2 * LANE_MM) // LANE_MM) + 1
    pitch = STROKE_MM * LONGER + LANE_MM
    columns = int((width - LANE_MM) // pitch)
    if rows * columns < count:
        room = max(rows * columns, 0)
        raise Error(
            f"the sheet of {width:g} x {height:g} mm has room for {room} strokes, not for {count}",
            code="strokes-out-of-range",
        )
    return [(LANE_MM + pitch * (k // rows), height - LANE_MM * (1 + k % rows)) for k in range(count)]


def _unless_astray(sections, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> Program:
    frame = robot_from_paper(cell, z_offset_mm)
    rises_mm = (rise_over(cell, sheet_mm, of) for of in (np.eye(4), frame))

    def told() -> Iterator[Section]:
        return (at_told_speeds(section, cell) for section in sections())

    made = Program((), cell, frame, told, *rises_mm, touching_mm_s(brush, cell))
    for notice in astray_in(made, sheet_mm) or out_of_arm(made, sheet_mm):
        raise Error(notice.sentence, code=notice.code, advice=notice.advice)
    return made
