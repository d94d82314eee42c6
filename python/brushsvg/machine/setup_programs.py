"""Make programs before the first stroke: where it will be painted, and how high the paper is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..errors import Error
from .cells.cell import LEAST_SPEED_MM_S, Cell, reason_for_no_waiting, robot_from_paper
from .motion import Move, Program, Section, Wait, rise_over, set_programmed_speeds
from .move_extents import ways
from .program import approach_mm_s, astray_in, out_of_arm, point_above, safe_point_above
from .realised.distortion import commanded_mm, in_lines_mm
from .workspace_limits import astray, touching_mm_s

CORNER_WAIT_S = 0.5  # long enough to look where the tip stands
SPEED_MM_S = 15.0
STROKE_MM = 12.0
LANE_MM = 6.0
LANE_APART_MM = 25.0  # an arm does what is between two such lanes, where it does both
LONG_EVERY = 5  # every fifth stroke is half as long again, to count by
LONGER = 1.5
HIGH_MM = 30.0  # over the safe height: what was measured wrongly is seen before anything is hit
ONE_STROKE_MM, ONE_STROKE_DEPTH_MM = 30.0, 2.0


def around(bounds_mm) -> tuple[float, float, float, float]:
    """(left, bottom, right, top) as a header can say it: outwards to whole hundredths of a millimetre."""
    left, bottom, right, top = bounds_mm
    out = [math.floor(side * 100 + 1e-6) / 100 for side in (left, bottom, -right, -top)]
    return (out[0], out[1], -out[2], -out[3])


def first_run(brush, cell: Cell, sheet_mm, highest_mm: float, lowest_mm: float, step_mm: float) -> Program:
    """What a careful person does before the first job: round the sheet high in the air and again at safe height, down
    to the paper at four points, the strokes of `paper_height`, one stroke; a person lets it go on in between. The tool
    first rises straight up to the height of the air run, and is never lowered at travel speed.

    Error when the program cannot wait for a person, when it leaves the workspace, when the strokes do not fit.
    """
    if why := reason_for_no_waiting(cell):
        raise Error(
            f"{why}, as a first run must",
            code="cannot-wait",
            advice="use border" if cell.pen else "use border and height one by one",
        )
    width, height = sheet_mm
    high_mm = _highest_air(cell, sheet_mm) - cell.heights.safe_mm
    round_it = border((0.0, 0.0, width, height), brush, cell, sheet_mm)
    strokes = paper_height(brush, cell, sheet_mm, highest_mm, lowest_mm, step_mm)
    used_mm = max(x for x, _ in _lanes(len(strokes_at(highest_mm, lowest_mm, step_mm)), sheet_mm))
    start = (width - LANE_MM - ONE_STROKE_MM, LANE_MM)
    if start[0] < used_mm + STROKE_MM * LONGER + LANE_MM:
        room_mm = used_mm + STROKE_MM * LONGER + 2 * LANE_MM + ONE_STROKE_MM
        raise Error(
            f"the sheet is {width:g} mm wide, less than the {room_mm:g} mm that a first run needs on it",
            code="strokes-out-of-range",
        )
    depth_mm = min(ONE_STROKE_DEPTH_MM, brush.depth_range_mm[1], -cell.heights.lowest_mm)
    ends = (start, (start[0] + ONE_STROKE_MM, start[1]))

    def sections() -> Iterator[Section]:
        (look,) = round_it.sections()
        start, *others = look.steps
        slowly = Move(
            "approach", start.points_mm, approach_mm_s(brush, cell)
        )  # it may go down from higher up
        lifted = tuple(_raised(step, high_mm) for step in (slowly, *others))
        yield Section("first run: round the sheet, high in the air", lifted)
        yield Section(
            "first run: round the sheet, at safe height", (_ask("all clear of the tool"), slowly, *others)
        )
        for number, corner in enumerate(_inner_corners(sheet_mm), 1):
            yield Section(
                f"first run: touch the paper, point {number} of 4",
                _touch(corner, slow_below_mm(highest_mm, cell), brush, cell),
            )
        for number, section in enumerate(strokes.sections()):
            steps = (
                (_ask("the brush has paint, strokes follow"), *section.steps)
                if number == 0
                else section.steps
            )
            yield Section(section.title, steps)
        one = _stroke_at(ends, -depth_mm, slow_below_mm(highest_mm, cell), brush, cell)
        yield Section(
            f"first run: one stroke, {depth_mm:g} mm deep", (_ask("the brush has paint again"), *one)
        )

    return _unless_astray(sections, brush, cell, sheet_mm, rise_more_mm=high_mm)


def _ask(message: str) -> Wait:
    return Wait(None, message)


def _raised(step: Move | Wait, by_mm: float) -> Move | Wait:
    return (
        step
        if isinstance(step, Wait)
        else replace(step, points_mm=step.points_mm + np.array([0.0, 0.0, by_mm]))
    )


def _highest_air(cell: Cell, sheet_mm) -> float:
    """As far over the safe height as an air run goes, by whole halves of it, where the workspace has the room."""
    width, height = sheet_mm
    corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))
    frame, safe_mm = robot_from_paper(cell), cell.heights.safe_mm
    for more_mm in (HIGH_MM, HIGH_MM / 2):
        corner_poses = [
            commanded_mm(point_above(corner, safe_mm), cell.machine)[0] + np.array([0.0, 0.0, more_mm])
            for corner in corners
        ]
        if not astray(ways([np.array(corner_poses)]), frame, cell, sheet_mm):
            return safe_mm + more_mm
    return safe_mm


def _inner_corners(sheet_mm) -> tuple[tuple[float, float], ...]:
    (width, height), inset = sheet_mm, min(LANE_MM, *(side / 4 for side in sheet_mm))
    return (
        (inset, inset),
        (width - inset, inset),
        (width - inset, height - inset),
        (inset, height - inset),
    )


def _touch(place, clearance_mm: float, brush, cell: Cell) -> tuple[Move | Wait, ...]:
    """Go down to where the tip should just touch, with two stops: a person who sees the brush bend ends it."""
    press_mm_s = min(cell.speeds.press_mm_s, touching_mm_s(brush, cell))
    touching, down = (commanded_mm(point_above(place, z), cell.machine) for z in (0.0, clearance_mm))
    return (
        Move("travel", safe_point_above(down[0], cell), cell.speeds.travel_mm_s),
        Move("approach", down, approach_mm_s(brush, cell)),
        _ask("the tip is just over the paper"),
        Move("land", touching, press_mm_s),
        _ask("the tip just touches"),
        Move("lift", down, press_mm_s),
        Move("retract", safe_point_above(down[0], cell), cell.speeds.travel_mm_s),
    )


def border(around_mm, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> Program:
    """An air run: at safe height round (left, bottom, right, top) [mm] of the job, corner by corner.

    Error when it leaves the workspace.
    """
    left, bottom, right, top = around_mm
    corners = ((left, bottom), (right, bottom), (right, top), (left, top), (left, bottom))
    corner_poses = np.vstack([commanded_mm(point_above(corner, 0.0), cell.machine) for corner in corners])
    path = np.vstack([safe_point_above(corner, cell) for corner in corner_poses])

    def sections() -> Iterator[Section]:
        start = Move("travel", path[:1], cell.speeds.travel_mm_s)
        slow_mm_s = approach_mm_s(brush, cell)
        waits = () if cell.pen else (Wait(CORNER_WAIT_S),)  # a pen plotter has no waits
        steps = [step for corner in path[1:] for step in (*waits, Move("look", corner[None], slow_mm_s))]
        yield Section("border of the job, at safe height", (start, *steps))

    return _unless_astray(sections, brush, cell, sheet_mm, z_offset_mm)


def paper_height(brush, cell: Cell, sheet_mm, highest_mm: float, lowest_mm: float, step_mm: float) -> Program:
    """Short strokes side by side, each step_mm deeper than the one before, from highest_mm over the paper to
    lowest_mm, by the cell's height: the first that leaves paint shows the paper's true height.

    Error when they do not fit on the sheet or go deeper than brush or cell allow.
    """
    heights = strokes_at(highest_mm, lowest_mm, step_mm)
    if cell.pen:
        sentence = f"the pen of cell {cell.name} is up or down: it tries no heights in between"
        raise Error(sentence, code="pen-depth")
    if lowest_mm < cell.heights.lowest_mm or -lowest_mm > brush.depth_range_mm[1]:
        least = max(cell.heights.lowest_mm, -brush.depth_range_mm[1])
        raise Error(
            f"height {lowest_mm:g} mm is outside the range [{least:g}, {highest_mm:g}] mm of brush and cell",
            code="height-out-of-range",
        )
    starts = _lanes(len(heights), sheet_mm)
    safe = cell.heights.safe_mm
    clearance = slow_below_mm(highest_mm, cell)
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
    steps = []
    for number, (height, (x, y)) in enumerate(zip(heights, starts, strict=True)):
        length = STROKE_MM * (LONGER if number % LONG_EVERY == 0 else 1.0)
        steps.append(_stroke_at(((x, y), (x + length, y)), height, clearance, brush, cell))

    def sections() -> Iterator[Section]:
        for number, (height, each) in enumerate(zip(heights, steps, strict=True), 1):
            yield Section(
                f"stroke {number} of {len(heights)}: first to paint means --z-offset {height:.2f}", each
            )

    return _unless_astray(sections, brush, cell, sheet_mm)


def slow_below_mm(highest_mm: float, cell: Cell) -> float:
    """From there down all is slow, since the paper may be as high as highest_mm [mm]."""
    return max(cell.heights.clearance_mm, highest_mm + 0.5)


def _stroke_at(ends, height_mm: float, clearance_mm: float, brush, cell: Cell) -> tuple[Move, ...]:
    """A stroke from one place (x, y) to another at a height."""
    speed_mm_s = min(touching_mm_s(brush, cell), SPEED_MM_S)
    press_mm_s = min(cell.speeds.press_mm_s, speed_mm_s)
    way = in_lines_mm(np.vstack([point_above(end, height_mm) for end in ends]), cell.machine)
    commanded = commanded_mm(way, cell.machine)
    down, up = (commanded_mm(point_above(end, clearance_mm), cell.machine) for end in ends)
    return (
        Move("travel", safe_point_above(down[0], cell), cell.speeds.travel_mm_s),
        Move("approach", down, approach_mm_s(brush, cell)),
        Move("land", commanded[:1], press_mm_s),
        Move("paint", commanded[1:], speed_mm_s),
        Move("lift", up, press_mm_s),
        Move("retract", safe_point_above(up[0], cell), cell.speeds.travel_mm_s),
    )


def over_sheet(brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> Program:
    """Return moves to and fro over a whole sheet, at the safe height and touching it: all that a drawing on it may need
    of an arm. They are checked and never run; limits are not checked."""
    width, height = sheet_mm
    lanes = np.linspace(0.0, height, max(2, math.ceil(height / LANE_APART_MM) + 1))
    ends = [((0.0, y), (width, y))[:: 1 if k % 2 == 0 else -1] for k, y in enumerate(lanes)]
    flat = np.array(ends).reshape(-1, 2)
    high, low = (np.column_stack([flat, np.full(len(flat), z)]) for z in (cell.heights.safe_mm, 0.0))
    moves = (
        Move("travel", high, cell.speeds.travel_mm_s),
        Move("look", low[::-1], touching_mm_s(brush, cell)),
        Move("retract", point_above(low[0], cell.heights.safe_mm), cell.speeds.travel_mm_s),
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


def _unless_astray(
    sections, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0, rise_more_mm: float = 0.0
) -> Program:
    """rise_more_mm: how far over the safe height the tool rises before anything else."""
    frame = robot_from_paper(cell, z_offset_mm)
    high = replace(cell, heights=replace(cell.heights, safe_mm=cell.heights.safe_mm + rise_more_mm))
    rises_mm = (rise_over(high, sheet_mm, of) for of in (np.eye(4), frame))

    def timed() -> Iterator[Section]:
        return (set_programmed_speeds(section, cell) for section in sections())

    made = Program((), cell, frame, timed, *rises_mm, touching_mm_s(brush, cell))
    for notice in astray_in(made, sheet_mm) or out_of_arm(made, sheet_mm):
        raise Error(notice.sentence, code=notice.code, advice=notice.advice)
    return made
