"""Predict what a brush paints with a plotter's G-code from other software.

Such programs ignore the lag of a brush.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..errors import Error, Notice
from ..machine.cells.cell import Cell, robot_from_paper
from ..machine.cells.cell_file import find_cell
from ..machine.limits.move_extents import ROUNDING_MM
from ..machine.limits.move_extents import make_paths as straight_extents
from ..machine.limits.paint_on_sheet import find_paint_off_sheet
from ..machine.limits.workspace import broken_limits, find_broken_limits
from ..machine.posts.gcode_servo import height_at
from ..read.gcode.pen import pen_kind, read_pen
from ..read.gcode.toolpaths import CHORD_MM, Way, ways_and_end

SHEET_MARGIN_MM = 20.0
# Cells that brushsvg ships.
Z_CELL, SERVO_VALUE_CELL, SERVO_ANGLE_CELL = ("linuxcnc-3axis", "grbl-servo", "marlin-servo")
Lift = Callable[[float | None], float]
ADVICE_BY_SIDE = dict.fromkeys(("left", "lower"), "its zero is the sheet's lower left corner: move the program's lines")
ADVICE_BY_SIDE |= dict.fromkeys(("right", "upper"), "give the sheet's size with --sheet WxH")


@dataclass(frozen=True)
class SimulatedForeignProgram:
    """Passes and marks of a foreign program.

    plan: one pass for each time that the brush touches; problems: one notice for each limit that the program breaks;
    warnings: assumptions about the program.
    """

    plan: object
    marks: object
    problems: tuple[Notice, ...]
    warnings: tuple[Notice, ...] = ()


def simulate_foreign_program(
    text: str, brush, cell: Cell, sheet_mm=None, paper_z_mm: float | None = None
) -> SimulatedForeignProgram:
    """Simulate a foreign program on the cell.

    The zero of the program is the lower left corner of the sheet. paper_z_mm: height at which the brush just touches;
    None: 0. By default the sheet ends 20 mm beyond the painted area. A pen that moves by M3 and M5, or by M280, moves
    as the cell's servo does; M5 lifts it.

    Raises Error for unreadable lines, for places that are never named, for a pen that the cell lifts in another way,
    and where nothing touches the paper.
    """
    ways, power = ways_and_end(text)
    lift = _lift_of_program(ways, cell)
    if lift and paper_z_mm is not None:
        sentence = f"a servo lifts its pen, to the heights that cell {cell.name} gives: --paper-z has no effect"
        raise Error(sentence, code="flag-without-effect")
    if not lift and paper_z_mm is None:
        _refuse_inverted(ways)
    ways = [replace(way, points_mm=_heights_over_paper(way, lift, paper_z_mm or 0.0)) for way in ways]
    passes, careless = _touches_to_passes(ways, cell)
    outside = _check_workspace_limits(ways, cell, sheet_mm)
    if not passes:
        raise _nothing_painted_error(ways, cell, lift, paper_z_mm or 0.0)
    if sheet_mm is None:
        highest = np.max([np.asarray(a_pass.poses_mm)[:, :2].max(axis=0) for a_pass in passes], axis=0)
        sheet_mm = tuple(np.maximum(highest + SHEET_MARGIN_MM, SHEET_MARGIN_MM).tolist())
    plan = _core.Plan(brush.name, "", tuple(sheet_mm), passes)
    marks = _core.simulate(plan, brush)
    problems = [
        *careless,
        *_check_brush_lifted(ways, lift(power) if lift else float(ways[-1].points_mm[-1, 2])),
        *outside,
        *broken_limits(passes, sheet_mm, brush, cell),
        *(
            replace(notice, advice=ADVICE_BY_SIDE[notice.about])
            for notice in find_paint_off_sheet(marks, brush, sheet_mm)
        ),
    ]
    return SimulatedForeignProgram(plan, marks, tuple(dict.fromkeys(problems)), _unit_warnings(ways))


def _unit_warnings(ways: list[Way]) -> tuple[Notice, ...]:
    if ways[0].unit_known:
        return ()
    sentence = "neither G20 nor G21 comes before it: its numbers are read as millimetres"
    return (Notice(f"line {ways[0].line}", sentence, code="unit-assumed"),)


def _check_workspace_limits(ways: list[Way], cell: Cell, sheet_mm) -> list[Notice]:
    """Report each limit that a line breaks, also in the air; sheet_mm: size with margin, if known."""
    lines, paths = [], []
    for way in ways:
        points = way.points_mm
        points = points[~np.isnan(points).any(axis=1)]
        if len(points):
            lines.append(way.line)
            paths.append(points)
    frame, slack_mm = robot_from_paper(cell), ROUNDING_MM + CHORD_MM
    cell = replace(cell, machine=None)  # its commands are its places: nothing was added for the machine's play
    if not paths or not find_broken_limits(straight_extents(paths), frame, cell, sheet_mm, slack_mm):
        return []
    return [
        replace(notice, where=f"line {line}")
        for line, path in zip(lines, paths, strict=True)
        for notice in find_broken_limits(straight_extents([path]), frame, cell, sheet_mm, slack_mm)
    ]


def _check_brush_lifted(ways: list[Way], height_mm: float) -> list[Notice]:
    """Report a program that leaves the brush on the paper. height_mm: height of the brush after the last line."""
    if not height_mm < 0:
        return []
    sentence = f"the program ends with the brush on the paper, at z {height_mm:.4g} mm: lift it behind its last line"
    return [Notice(f"line {ways[-1].line}", sentence, code="ends-on-paper")]


def _touches_to_passes(ways: list[Way], cell: Cell) -> tuple[list, list[Notice]]:
    """Return a pass for each touch of the paper, and a notice for each rapid move in it."""
    passes, careless = [], []
    poses: list[np.ndarray] = []
    speeds: list[float] = []
    name = ""

    def finish_pass() -> None:
        if poses and min(pose[2] for pose in poses) < 0:
            over = [np.array([*pose[:2], 0.0]) for pose in (poses[0], poses[-1])]
            way = poses if len(poses) > 1 else [over[0], *poses, over[1]]  # a servo's dot goes straight down and up
            passes.append(_core.Pass(name, np.array(way), max(speeds, default=cell.speeds.press_mm_s)))
        poses.clear()
        speeds.clear()

    for way in ways:
        points = way.points_mm
        if points[-1, 2] < 0 and np.isnan(points[[0, -1], :2]).any():
            sentence = f"line {way.line}: the brush is down where no line has named both X and Y"
            raise Error(sentence, code="line-incomplete")
        if np.isnan(points[-1]).any():
            finish_pass()
            continue
        points = points[~np.isnan(points).any(axis=1)]
        for start, end in zip(points, [*points[1:], points[-1]], strict=True):
            if min(start[2], end[2]) > 0 or (max(start[2], end[2]) >= 0 and min(start[2], end[2]) == 0 and not poses):
                finish_pass()
                continue
            ends = _part_on_paper(start, end)
            if not poses:
                name = f"line {way.line}"
            poses += [pose for pose in ends if not poses or not np.array_equal(pose, poses[-1])]
            is_lift = end[2] > start[2] and np.array_equal(start[:2], end[:2])
            if way.rapid and min(start[2], end[2]) < 0 and not is_lift:
                sentence = "a rapid move while the brush touches"
                careless.append(Notice(f"line {way.line}", sentence, code="rapid-too-low"))
            elif not way.rapid and not np.array_equal(start[:2], end[:2]):
                if way.speed_mm_s <= 0:
                    feed = f"a feed of {60 * way.speed_mm_s:g} mm/min while the brush touches"
                    sentence = f"line {way.line}: {feed}: an F above 0 must stand before it"
                    raise Error(sentence, code="speed-out-of-range")
                speeds.append(way.speed_mm_s)
            if end[2] > 0:
                finish_pass()
    finish_pass()
    return passes, careless


def _part_on_paper(start: np.ndarray, end: np.ndarray) -> list[np.ndarray]:
    """Return the ends of the part of a straight way that is not above the paper."""
    rise = end[2] - start[2]

    def at_paper() -> np.ndarray:
        place = start + (end - start) * (-start[2] / rise)
        return np.array([*place[:2], 0.0])

    return [at_paper() if start[2] > 0 else start, at_paper() if end[2] > 0 else end]


def _refuse_inverted(ways: list[Way]) -> None:
    """Raise Error where Z counts downwards: drawing and travel would be exchanged."""
    try:
        pen = read_pen(ways, "z") if ways else None
    except Error:  # nothing shows the direction of Z
        return
    if pen and pen.is_inverted:
        advice = "convert it for your machine, or give --paper-z MM where Z counts upwards"
        raise Error(f"{pen.how}: no cell counts Z downwards", code="z-inverted", advice=advice)


def _heights_over_paper(way: Way, lift: Lift | None, paper_z_mm: float) -> np.ndarray:
    """Return points (n, 3) of a way relative to the paper, a servo's pen at its value's height."""
    points = way.points_mm - (0.0, 0.0, paper_z_mm)
    if lift:
        points[:, 2] = lift(way.power)
    return points


def _lift_of_program(ways: list[Way], cell: Cell) -> Lift | None:
    """Return a function from servo value to height above the paper [mm].

    Returns None for a pen that moves by Z. A missing value means that the pen is up. Raises Error where the cell does
    not define the heights.
    """
    up_and_down = cell.pen.servo_values if cell.pen else ()
    if pen_kind(ways) == "z":
        if (cell.servo or up_and_down) and any(np.isfinite(way.points_mm[:, 2]).any() for way in ways):
            sentence = f"Z lifts its pen, but a servo lifts the brush of cell {cell.name}"
            raise Error(sentence, code="servo-unknown", advice=f"give a cell without a servo, --cell {Z_CELL}")
        return None
    values = sorted({way.power for way in ways if way.power is not None})
    line = next(way.line for way in ways if way.power is not None)
    if any(way.by_angle == 300 for way in ways):
        sentence = f"line {line}: it lifts the pen with M300, which plays a tone on the machines of all cells"
        raise Error(
            sentence,
            code="servo-unknown",
            advice="brushsvg convert reads the program as a drawing and writes one for your cell",
        )
    if any(way.by_angle for way in ways):
        if not up_and_down:
            sentence = f"line {line}: it lifts the pen with M280, but cell {cell.name} has no such servo"
            raise Error(
                sentence,
                code="servo-unknown",
                advice=f"--cell {SERVO_ANGLE_CELL}, or one of your own like it",
            )
        return _two_state_lift(ways, cell)
    if not cell.servo:
        sentence = f"line {line}: it lifts the pen with M3 and M5, but cell {cell.name} has no servo"
        fits = _is_in_table(values, find_cell(SERVO_VALUE_CELL))
        advice = f"--cell {SERVO_VALUE_CELL}, or one of your own like it" if fits else _advise_own_table(values)
        raise Error(sentence, code="servo-unknown", advice=advice)
    if not _is_in_table(values, cell):
        least, most = _table_range(cell)
        used = " to ".join(f"S{value:g}" for value in dict.fromkeys((values[0], values[-1])))
        sentence = (
            f"line {line}: it lifts the pen with M3 {used}, but the servo's table of cell "
            f"{cell.name} has values from {least:g} to {most:g}"
        )
        raise Error(sentence, code="servo-unknown", advice=_advise_own_table(values))
    highest_mm = max(height for height, _ in cell.servo.table)
    return lambda power: highest_mm if power is None else height_at(cell.servo, power)


def _two_state_lift(ways: list[Way], cell: Cell) -> Lift:
    """Return heights of a lift that knows only up and down; the moves show the values that are down."""
    down = {way.power for way, is_down in zip(ways, read_pen(ways, "servo").down, strict=True) if is_down}
    return lambda power: cell.pen.down_mm if power in down else cell.heights.safe_mm


def _is_in_table(values: list[float], cell: Cell) -> bool:
    least, most = _table_range(cell)
    return least <= values[0] and values[-1] <= most


def _table_range(cell: Cell) -> tuple[float, float]:
    values = [value for _, value in cell.servo.table]
    return min(values), max(values)


def _advise_own_table(values: list[float]) -> str:
    values_text = " and ".join(f"S{value:g}" for value in dict.fromkeys((values[0], values[-1])))
    return (
        f"write a cell of your own with  brushsvg cell new -o mine.toml --like {SERVO_VALUE_CELL}  and put the "
        f"heights of {values_text} into its [servo] table, then give --cell mine.toml"
    )


def _nothing_painted_error(ways: list[Way], cell: Cell, lift: Lift | None, paper_z_mm: float) -> Error:
    sentence = f"the brush never touches the paper: nothing is below z {paper_z_mm:g}"
    heights = np.concatenate([way.points_mm[:, 2] for way in ways]) if ways else np.array([])
    heights = heights[np.isfinite(heights)]
    if lift:
        sentence = f"the brush never touches the paper: all servo values are above it in cell {cell.name}"
        advice = "" if cell.pen else _advise_own_table(sorted({way.power for way in ways if way.power is not None}))
    elif not len(heights):
        sentence = "the brush never touches the paper: no line names a height (Z) or moves a servo (M3, M280)"
        advice = ""
    else:
        lowest_mm = float(heights.min()) + paper_z_mm
        advice = f"--paper-z {lowest_mm + 1:.6g} presses it 1 mm deep where it is lowest"
    return Error(sentence, code="nothing-painted", advice=advice)
