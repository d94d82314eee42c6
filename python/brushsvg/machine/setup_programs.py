"""Make the programs that are run before a job: border, height, first run."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..errors import Error, Notice
from .cells.cell import Cell, reason_for_no_waiting, robot_from_paper
from .cells.language_limits import LEAST_SPEED_MM_S
from .job_program import find_moves_out_of_arm, find_moves_out_of_limits
from .limits.move_extents import make_paths
from .limits.speeds import commanded_touching_mm_s, touching_mm_s
from .limits.vessels import find_vessels_near_travel
from .limits.workspace import find_broken_limits
from .moves import Move, Program, Section, Wait, rise_height_mm, set_programmed_speeds
from .realised.distortion import commanded_mm, in_lines_mm
from .stroke_moves import approach_mm_s, point_above, safe_point_above

CORNER_WAIT_S = 0.5  # long enough to see where the tip is
TEST_SPEED_MM_S = 15.0
TEST_STROKE_MM = 12.0
LANE_SPACING_MM = 6.0
# Largest distance of two lanes over the sheet. An arm that can run both lanes can run everything between them.
MAX_SHEET_LANE_SPACING_MM = 25.0
LONG_STROKE_INTERVAL = 5  # every fifth stroke is longer, so that strokes are easy to count
LONG_STROKE_RATIO = 1.5
# Heights of the first air run above the safe height; the first one that the workspace allows is used.
# A wrong measurement is seen before anything is hit.
AIR_RUN_RISES_MM = (30.0, 15.0)
LAST_STROKE_MM, ONE_STROKE_DEPTH_MM = 30.0, 2.0


def round_outwards(bounds_mm) -> tuple[float, float, float, float]:
    """Round (left, bottom, right, top) outwards to hundredths of a millimetre.

    A header shows them with two decimals.
    """
    left, bottom, right, top = bounds_mm
    rounded_sides = [math.floor(side * 100 + 1e-6) / 100 for side in (left, bottom, -right, -top)]
    return (rounded_sides[0], rounded_sides[1], -rounded_sides[2], -rounded_sides[3])


def make_first_run_program(brush, cell: Cell, sheet_mm, highest_mm: float, lowest_mm: float, step_mm: float) -> Program:
    """Make the program for the first run of a machine.

    The tool goes round the sheet high in the air and again at the safe height. It goes down to the paper at four
    points, paints the strokes of `make_height_program`, and paints one more stroke. A person confirms each of these
    steps. The tool first rises straight up to the height of the first air run, and is never lowered at travel speed.
    Without room above the safe height, the high air run is left out.

    Raises Error if the program cannot wait for a person, leaves the workspace, or has strokes that do not fit.
    """
    if why := reason_for_no_waiting(cell):
        raise Error(
            f"{why}, as a first run must",
            code="cannot-wait",
            advice="use border" if cell.pen else "use border and height one by one",
        )
    width, height = sheet_mm
    high_mm = _air_run_rise_mm(cell, sheet_mm)
    air_run = make_border_program((0.0, 0.0, width, height), brush, cell, sheet_mm)
    strokes = make_height_program(brush, cell, sheet_mm, highest_mm, lowest_mm, step_mm)
    used_mm = max(x for x, _ in _stroke_starts(len(stroke_heights_mm(highest_mm, lowest_mm, step_mm)), sheet_mm))
    start = (width - LANE_SPACING_MM - LAST_STROKE_MM, LANE_SPACING_MM)
    if start[0] < used_mm + TEST_STROKE_MM * LONG_STROKE_RATIO + LANE_SPACING_MM:
        room_mm = used_mm + TEST_STROKE_MM * LONG_STROKE_RATIO + 2 * LANE_SPACING_MM + LAST_STROKE_MM
        sentence = f"the sheet is {width:g} mm wide, less than the {room_mm:g} mm that a first run needs on it"
        raise Error(sentence, code="strokes-out-of-range", advice="give a larger sheet")
    depth_mm = min(ONE_STROKE_DEPTH_MM, brush.depth_range_mm[1], -cell.heights.lowest_mm)
    ends = (start, (start[0] + LAST_STROKE_MM, start[1]))

    def sections() -> Iterator[Section]:
        (air_section,) = air_run.sections()
        start, *others = air_section.steps
        # The tool may come down from the higher air run.
        slowly = Move("approach", start.points_mm, approach_mm_s(brush, cell))
        if high_mm:
            raised_moves = tuple(_raise_step(step, high_mm) for step in (slowly, *others))
            yield Section("first run: round the sheet, high in the air", raised_moves)
        yield Section(
            "first run: round the sheet, at safe height",
            (_wait_for_person("all clear of the tool"), slowly, *others),
        )
        for number, corner in enumerate(_inner_corners(sheet_mm), 1):
            yield Section(
                f"first run: touch the paper, point {number} of 4",
                _touch_moves(corner, slow_below_mm(highest_mm, cell), brush, cell),
            )
        for number, section in enumerate(strokes.sections()):
            steps = (
                (_wait_for_person("the brush has paint, strokes follow"), *section.steps)
                if number == 0
                else section.steps
            )
            yield Section(section.title, steps)
        last_stroke = _stroke_moves(ends, -depth_mm, slow_below_mm(highest_mm, cell), brush, cell)
        yield Section(
            f"first run: one stroke, {depth_mm:g} mm deep",
            (_wait_for_person("the brush has paint again"), *last_stroke),
        )

    return _checked_program(sections, brush, cell, sheet_mm, rise_more_mm=high_mm)


def _wait_for_person(message: str) -> Wait:
    return Wait(None, message)


def _raise_step(step: Move | Wait, by_mm: float) -> Move | Wait:
    return step if isinstance(step, Wait) else replace(step, points_mm=step.points_mm + np.array([0.0, 0.0, by_mm]))


def report_missing_air_run(cell: Cell, sheet_mm) -> list[Notice]:
    """Report that a first run leaves out the high air run, with the limit that leaves no room for it."""
    if _air_run_rise_mm(cell, sheet_mm):
        return []
    rise_mm = AIR_RUN_RISES_MM[-1]
    notice = _find_limits_of_air_run(rise_mm, cell, sheet_mm)[0]
    sentence = f"the lap high in the air is left out: {rise_mm:g} mm above the safe height {notice.sentence}"
    return [replace(notice, sentence=sentence)]


def _air_run_rise_mm(cell: Cell, sheet_mm) -> float:
    """Return how far [mm] the first air run is above the safe height, 0 if the workspace has no room."""
    rises_mm = (rise_mm for rise_mm in AIR_RUN_RISES_MM if not _find_limits_of_air_run(rise_mm, cell, sheet_mm))
    return next(rises_mm, 0.0)


def _find_limits_of_air_run(rise_mm: float, cell: Cell, sheet_mm) -> list[Notice]:
    width, height = sheet_mm
    corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0))
    corner_poses = [
        commanded_mm(point_above(corner, cell.heights.safe_mm), cell.machine)[0] + np.array([0.0, 0.0, rise_mm])
        for corner in corners
    ]
    return find_broken_limits(make_paths([np.array(corner_poses)]), robot_from_paper(cell), cell, sheet_mm)


def _inner_corners(sheet_mm) -> tuple[tuple[float, float], ...]:
    (width, height), inset = sheet_mm, min(LANE_SPACING_MM, *(side / 4 for side in sheet_mm))
    return (
        (inset, inset),
        (width - inset, inset),
        (width - inset, height - inset),
        (inset, height - inset),
    )


def _touch_moves(place, clearance_mm: float, brush, cell: Cell) -> tuple[Move | Wait, ...]:
    """Make the moves down to the touch; they stop twice, so that a person can end the program."""
    press_mm_s = min(cell.speeds.press_mm_s, touching_mm_s(brush, cell))
    touching, down = (commanded_mm(point_above(place, z), cell.machine) for z in (0.0, clearance_mm))
    return (
        Move("travel", safe_point_above(down[0], cell), cell.speeds.travel_mm_s),
        Move("approach", down, approach_mm_s(brush, cell)),
        _wait_for_person("the tip is just over the paper"),
        Move("land", touching, press_mm_s),
        _wait_for_person("the tip just touches"),
        Move("lift", down, press_mm_s),
        Move("retract", safe_point_above(down[0], cell), cell.speeds.travel_mm_s),
    )


def make_border_program(around_mm, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> Program:
    """Make an air run round the job at the safe height, corner by corner.

    around_mm: left, bottom, right and top of the job [mm].

    Raises Error if the program leaves the workspace.
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

    return _checked_program(sections, brush, cell, sheet_mm, z_offset_mm)


def make_height_program(brush, cell: Cell, sheet_mm, highest_mm: float, lowest_mm: float, step_mm: float) -> Program:
    """Make short strokes side by side, each step_mm deeper than the one before.

    The strokes go from highest_mm over the paper to lowest_mm, in heights of the cell. The first stroke that leaves
    paint shows the paper's true height.

    Raises Error if the strokes do not fit on the sheet, or go deeper than the brush or the cell allows.
    """
    heights = stroke_heights_mm(highest_mm, lowest_mm, step_mm)
    if cell.pen:
        sentence = f"the pen of cell {cell.name} is up or down: it cannot try heights in between"
        raise Error(sentence, code="pen-depth")
    if lowest_mm < cell.heights.lowest_mm or -lowest_mm > brush.depth_range_mm[1]:
        min_mm = max(cell.heights.lowest_mm, -brush.depth_range_mm[1])
        sentence = f"height {lowest_mm:g} mm is outside the range [{min_mm:g}, {highest_mm:g}] mm of brush and cell"
        raise Error(sentence, code="height-out-of-range")
    starts = _stroke_starts(len(heights), sheet_mm)
    safe_mm = cell.heights.safe_mm
    clearance_mm = slow_below_mm(highest_mm, cell)
    if clearance_mm > safe_mm:
        raise Error(
            f"height {highest_mm:g} mm is outside the range [{lowest_mm:g}, {safe_mm - 0.5:g}] mm below safe height",
            code="height-out-of-range",
        )
    speed = min(commanded_touching_mm_s(brush, cell), TEST_SPEED_MM_S)
    if speed < (min_mm_s := LEAST_SPEED_MM_S.get(cell.language, 0.0)):
        raise Error(
            f"speed {speed:.4g} mm/s of brush {brush.name} is outside the range [{min_mm_s:g}, {TEST_SPEED_MM_S:g}] "
            f"mm/s of cell {cell.name}",
            code="speed-out-of-range",
        )
    steps = []
    for number, (height, (x, y)) in enumerate(zip(heights, starts, strict=True)):
        length = TEST_STROKE_MM * (LONG_STROKE_RATIO if number % LONG_STROKE_INTERVAL == 0 else 1.0)
        steps.append(_stroke_moves(((x, y), (x + length, y)), height, clearance_mm, brush, cell))

    def sections() -> Iterator[Section]:
        for number, (height, stroke_steps) in enumerate(zip(heights, steps, strict=True), 1):
            yield Section(
                f"stroke {number} of {len(heights)}: first to paint means --z-offset {height:.2f}",
                stroke_steps,
            )

    return _checked_program(sections, brush, cell, sheet_mm)


def slow_below_mm(highest_mm: float, cell: Cell) -> float:
    """Return the height [mm] below which all moves are slow. The paper may be as high as highest_mm."""
    return max(cell.heights.clearance_mm, highest_mm + 0.5)


def _stroke_moves(ends, height_mm: float, clearance_mm: float, brush, cell: Cell) -> tuple[Move, ...]:
    """Make the moves of a stroke between two ends (x, y) [mm] at one height."""
    speed_mm_s = min(commanded_touching_mm_s(brush, cell), TEST_SPEED_MM_S)
    press_mm_s = min(cell.speeds.press_mm_s, speed_mm_s)
    path = in_lines_mm(np.vstack([point_above(end, height_mm) for end in ends]), cell.machine)
    commanded = commanded_mm(path, cell.machine)
    down, up = (commanded_mm(point_above(end, clearance_mm), cell.machine) for end in ends)
    return (
        Move("travel", safe_point_above(down[0], cell), cell.speeds.travel_mm_s),
        Move("approach", down, approach_mm_s(brush, cell)),
        Move("land", commanded[:1], press_mm_s),
        Move("paint", commanded[1:], speed_mm_s),
        Move("lift", up, press_mm_s),
        Move("retract", safe_point_above(up[0], cell), cell.speeds.travel_mm_s),
    )


def make_sheet_program(brush, cell: Cell, sheet_mm) -> Program:
    """Make moves to and fro over a whole sheet, high and touching the paper.

    They stand for everything that a drawing on the sheet may need from an arm. The program is only checked for the arm
    and never run. Its limits are not checked here.
    """
    width, height = sheet_mm
    lanes = np.linspace(0.0, height, max(2, math.ceil(height / MAX_SHEET_LANE_SPACING_MM) + 1))
    ends = [((0.0, y), (width, y))[:: 1 if k % 2 == 0 else -1] for k, y in enumerate(lanes)]
    flat = np.array(ends).reshape(-1, 2)
    high_points, low_points = (np.column_stack([flat, np.full(len(flat), z)]) for z in (cell.heights.safe_mm, 0.0))
    moves = (
        Move("travel", high_points, cell.speeds.travel_mm_s),
        Move("look", low_points[::-1], touching_mm_s(brush, cell)),
        Move("retract", point_above(low_points[0], cell.heights.safe_mm), cell.speeds.travel_mm_s),
    )
    frame = robot_from_paper(cell)
    rises_mm = (rise_height_mm(cell, sheet_mm, of) for of in (np.eye(4), frame))
    sections = (Section("the sheet", moves),)
    return Program((), cell, frame, lambda: iter(sections), *rises_mm, touching_mm_s(brush, cell))


def stroke_heights_mm(highest_mm: float, lowest_mm: float, step_mm: float) -> np.ndarray:
    """Return the heights [mm] of the strokes, highest first. Raises Error for less than 2 or more than 100 strokes."""
    count = max(int(np.floor((highest_mm - lowest_mm) / step_mm + 1e-9)) + 1, 0)
    if not 2 <= count <= 100:
        sentence = (
            f"from {highest_mm:g} to {lowest_mm:g} mm in steps of {step_mm:g} mm there are {count} strokes, "
            "not 2 to 100"
        )
        advice = f"give a {'larger' if count > 100 else 'smaller'} step"
        if lowest_mm >= highest_mm:
            advice = "give a last height below the first one"
        raise Error(sentence, code="strokes-out-of-range", advice=advice)
    return highest_mm - step_mm * np.arange(count)


def _stroke_starts(count: int, sheet_mm) -> list[tuple[float, float]]:
    """Return each stroke's start (x, y) [mm], down from the sheet's top, then in the next column."""
    width, height = sheet_mm
    rows = int((height - 2 * LANE_SPACING_MM) // LANE_SPACING_MM) + 1
    pitch = TEST_STROKE_MM * LONG_STROKE_RATIO + LANE_SPACING_MM
    columns = int((width - LANE_SPACING_MM) // pitch)
    if rows * columns < count:
        room = max(rows * columns, 0)
        sentence = f"the sheet of {width:g} x {height:g} mm has room for {room} strokes, not for {count}"
        raise Error(sentence, code="strokes-out-of-range", advice="give a larger sheet")
    return [(LANE_SPACING_MM + pitch * (k // rows), height - LANE_SPACING_MM * (1 + k % rows)) for k in range(count)]


def _checked_program(
    sections, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0, rise_more_mm: float = 0.0
) -> Program:
    """Make a program that rises rise_more_mm first; raise Error beyond workspace or arm's reach."""
    frame = robot_from_paper(cell, z_offset_mm)
    raised_cell = replace(cell, heights=replace(cell.heights, safe_mm=cell.heights.safe_mm + rise_more_mm))
    rises_mm = (rise_height_mm(raised_cell, sheet_mm, of) for of in (np.eye(4), frame))

    def sections_at_programmed_speeds() -> Iterator[Section]:
        return (set_programmed_speeds(section, cell) for section in sections())

    program = Program((), cell, frame, sections_at_programmed_speeds, *rises_mm, touching_mm_s(brush, cell))
    problems = find_vessels_near_travel(cell, z_offset_mm) or find_moves_out_of_limits(program, sheet_mm)
    for notice in problems or find_moves_out_of_arm(program, sheet_mm):
        raise Error(notice.sentence, code=notice.code, advice=notice.advice)
    return program
