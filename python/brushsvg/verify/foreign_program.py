"""What a brush paints with a plotter's G-code that somebody else wrote, without a thought of a lag."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..errors import Error, Notice
from ..machine.cells.cell import Cell, robot_from_paper
from ..machine.cells.cell_file import find_cell
from ..machine.move_extents import ways as straight
from ..machine.posts.gcode_servo import height_at
from ..machine.preflight import off_sheet
from ..machine.workspace_limits import ROUNDING_MM, astray, broken_limits
from ..read.gcode.pen import pen_kind, read_pen
from ..read.gcode.toolpaths import CHORD_MM, Way, ways_and_end

MARGIN_MM = 20.0
BY_Z, BY_VALUE, BY_ANGLE = "linuxcnc-3axis", "grbl-servo", "marlin-servo"  # cells that come along
Lift = Callable[[float | None], float]
_ROOM = dict.fromkeys(
    ("left", "lower"), "its zero is the sheet's lower left corner: move the program's lines"
)
_ROOM |= dict.fromkeys(("right", "upper"), "give the sheet's size with --sheet WxH")


@dataclass(frozen=True)
class Foreign:
    """plan: a pass for each time that the brush touches; problems: a notice for each limit that it breaks; warnings:
    what is assumed."""

    plan: object
    marks: object
    problems: tuple[Notice, ...]
    warnings: tuple[Notice, ...] = ()


def foreign_program(text: str, brush, cell: Cell, sheet_mm=None, paper_z_mm: float | None = None) -> Foreign:
    """The program's ways on the cell, its zero the sheet's lower left corner, paper_z_mm where the brush just touches,
    None: 0. By default the sheet ends 20 mm beyond what is painted. A pen that goes by M3 and M5, or by M280, goes as
    the cell's servo does; M5 lifts it.

    Error for lines not read, places never named, a pen that the cell lifts in another way, and where nothing touches.
    """
    some, power = ways_and_end(text)
    lift = _servo_lift(some, cell)
    if lift and paper_z_mm is not None:
        sentence = (
            f"its pen goes by a servo, whose heights cell {cell.name} gives: --paper-z would change nothing"
        )
        raise Error(sentence, code="flag-without-effect")
    if not lift and paper_z_mm is None:
        _refuse_inverted(some)
    some = [replace(way, points_mm=_at_heights(way, lift, paper_z_mm or 0.0)) for way in some]
    passes, careless = _touches(some, cell)
    outside = _outside(some, cell, sheet_mm)
    if not passes:
        raise _never_touches(some, cell, lift, paper_z_mm or 0.0)
    if sheet_mm is None:
        highest = np.max([np.asarray(a_pass.poses_mm)[:, :2].max(axis=0) for a_pass in passes], axis=0)
        sheet_mm = tuple(np.maximum(highest + MARGIN_MM, MARGIN_MM).tolist())
    plan = _core.Plan(brush.name, "", tuple(sheet_mm), passes)
    marks = _core.simulate(plan, brush)
    problems = [
        *careless,
        *_left_down(some, lift(power) if lift else float(some[-1].points_mm[-1, 2])),
        *outside,
        *broken_limits(passes, sheet_mm, brush, cell),
        *(replace(notice, advice=_ROOM[notice.about]) for notice in off_sheet(marks, brush, sheet_mm)),
    ]
    return Foreign(plan, marks, tuple(dict.fromkeys(problems)), _assumed(some))


def _assumed(some: list[Way]) -> tuple[Notice, ...]:
    if some[0].unit_known:
        return ()
    sentence = "neither G20 nor G21 stands before it: its numbers count as millimetres"
    return (Notice(f"line {some[0].line}", sentence, code="unit-assumed"),)


def _outside(some: list[Way], cell: Cell, sheet_mm) -> list[Notice]:
    """A notice for each limit of place that a line leaves, in the air as well; sheet_mm: with the margin round it,
    where it is known."""
    lines, paths = [], []
    for way in some:
        points = way.points_mm
        points = points[~np.isnan(points).any(axis=1)]
        if len(points):
            lines.append(way.line)
            paths.append(points)
    frame, slack_mm = robot_from_paper(cell), ROUNDING_MM + CHORD_MM
    if not paths or not astray(straight(paths), frame, cell, sheet_mm, slack_mm):
        return []
    return [
        replace(notice, where=f"line {line}")
        for line, path in zip(lines, paths, strict=True)
        for notice in astray(straight([path]), frame, cell, sheet_mm, slack_mm)
    ]


def _left_down(some: list[Way], height_mm: float) -> list[Notice]:
    """A notice where the program leaves the brush on the paper; height_mm: of the brush behind its last line."""
    if not height_mm < 0:
        return []
    sentence = (
        f"the program ends with the brush on the paper, at z {height_mm:.4g} mm: lift it behind its last line"
    )
    return [Notice(f"line {some[-1].line}", sentence, code="ends-on-paper")]


def _touches(some: list[Way], cell: Cell) -> tuple[list, list[Notice]]:
    """A pass for each time that the brush is at or below the paper, and a notice for each rapid move there."""
    passes, careless = [], []
    poses: list[np.ndarray] = []
    speeds: list[float] = []
    name = ""

    def lifted() -> None:
        if poses and min(pose[2] for pose in poses) < 0:
            over = [np.array([*pose[:2], 0.0]) for pose in (poses[0], poses[-1])]
            way = poses if len(poses) > 1 else [over[0], *poses, over[1]]  # a servo's dot
            passes.append(_core.Pass(name, np.array(way), max(speeds, default=cell.speeds.press_mm_s)))
        poses.clear()
        speeds.clear()

    for way in some:
        points = way.points_mm
        if points[-1, 2] < 0 and np.isnan(points[[0, -1], :2]).any():
            sentence = f"line {way.line}: the brush is down where no line has named both X and Y"
            raise Error(sentence, code="line-incomplete")
        if np.isnan(points[-1]).any():
            lifted()
            continue
        points = points[~np.isnan(points).any(axis=1)]
        for start, end in zip(points, [*points[1:], points[-1]], strict=True):
            if min(start[2], end[2]) > 0 or (
                max(start[2], end[2]) >= 0 and min(start[2], end[2]) == 0 and not poses
            ):
                lifted()
                continue
            ends = _below(start, end)
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
                    raise Error(
                        f"line {way.line}: {feed}: an F above 0 must stand before it",
                        code="speed-out-of-range",
                    )
                speeds.append(way.speed_mm_s)
            if end[2] > 0:
                lifted()
    lifted()
    return passes, careless


def _below(start: np.ndarray, end: np.ndarray) -> list[np.ndarray]:
    """Return the ends of the part of a straight way that is not above the paper."""
    rise = end[2] - start[2]

    def at_paper() -> np.ndarray:
        place = start + (end - start) * (-start[2] / rise)
        return np.array([*place[:2], 0.0])

    return [at_paper() if start[2] > 0 else start, at_paper() if end[2] > 0 else end]


def _refuse_inverted(some: list[Way]) -> None:
    """Error where Z counts downwards, as no cell's does: what is drawn would be travel, and travel would be drawn."""
    try:
        pen = read_pen(some, "z") if some else None
    except Error:  # nothing shows it
        return
    if pen and pen.is_inverted:
        advice = "convert it for your machine, or give --paper-z MM where Z counts upwards"
        raise Error(f"{pen.how}: no cell's does", code="z-inverted", advice=advice)


def _at_heights(way: Way, lift: Lift | None, paper_z_mm: float) -> np.ndarray:
    """(n, 3) points of a way over the paper; of a pen on a servo, at the height that its value gives."""
    points = way.points_mm - (0.0, 0.0, paper_z_mm)
    if lift:
        points[:, 2] = lift(way.power)
    return points


def _servo_lift(some: list[Way], cell: Cell) -> Lift | None:
    """The height over the paper [mm] of each value of the program's servo, up where it has none; None for a pen that
    goes by Z. Error where the cell does not say it."""
    up_and_down = cell.pen.servo_values if cell.pen else ()
    if pen_kind(some) == "z":
        if (cell.servo or up_and_down) and any(np.isfinite(way.points_mm[:, 2]).any() for way in some):
            sentence = f"its pen goes by Z, and cell {cell.name} lifts its brush by a servo"
            raise Error(sentence, code="servo-unknown", advice=f"give a cell without a servo, --cell {BY_Z}")
        return None
    values = sorted({way.power for way in some if way.power is not None})
    line = next(way.line for way in some if way.power is not None)
    if any(way.by_angle == 300 for way in some):
        sentence = f"line {line}: its pen goes by M300, which plays a tone on the machines of all cells"
        raise Error(sentence, code="servo-unknown", advice="brushsvg convert paints -o its lines")
    if any(way.by_angle for way in some):
        if not up_and_down:
            sentence = f"line {line}: its pen goes by M280, and cell {cell.name} has no such servo"
            raise Error(
                sentence, code="servo-unknown", advice=f"--cell {BY_ANGLE}, or one of your own like it"
            )
        return _up_or_down(some, cell)
    if not cell.servo:
        sentence = f"line {line}: its pen goes by M3 and M5, and cell {cell.name} has no servo"
        fits = _in_table(values, find_cell(BY_VALUE))
        advice = f"--cell {BY_VALUE}, or one of your own like it" if fits else _own_table(values)
        raise Error(sentence, code="servo-unknown", advice=advice)
    if not _in_table(values, cell):
        least, most = _table_range(cell)
        used = " to ".join(f"S{value:g}" for value in dict.fromkeys((values[0], values[-1])))
        sentence = (
            f"line {line}: its pen is lifted by M3 {used}, and the servo's table of cell "
            f"{cell.name} has values from {least:g} to {most:g}"
        )
        raise Error(sentence, code="servo-unknown", advice=_own_table(values))
    highest_mm = max(height for height, _ in cell.servo.table)
    return lambda power: highest_mm if power is None else height_at(cell.servo, power)


def _up_or_down(some: list[Way], cell: Cell) -> Lift:
    """Of a lift that knows up and down alone: at which values the pen is down the program's moves show."""
    down = {way.power for way, is_down in zip(some, read_pen(some, "servo").down, strict=True) if is_down}
    return lambda power: cell.pen.down_mm if power in down else cell.heights.safe_mm


def _in_table(values: list[float], cell: Cell) -> bool:
    least, most = _table_range(cell)
    return least <= values[0] and values[-1] <= most


def _table_range(cell: Cell) -> tuple[float, float]:
    values = [value for _, value in cell.servo.table]
    return min(values), max(values)


def _own_table(values: list[float]) -> str:
    said = " and ".join(f"S{value:g}" for value in dict.fromkeys((values[0], values[-1])))
    return (
        f"write a cell of your own with  brushsvg cell new -o mine.toml --like {BY_VALUE}  and put the heights of "
        f"{said} into its [servo] table, then give --cell mine.toml"
    )


def _never_touches(some: list[Way], cell: Cell, lift: Lift | None, paper_z_mm: float) -> Error:
    sentence = f"the brush never touches the paper: nothing is below z {paper_z_mm:g}"
    heights = np.concatenate([way.points_mm[:, 2] for way in some]) if some else np.array([])
    heights = heights[np.isfinite(heights)]
    if lift:
        sentence = (
            f"the brush never touches the paper: by cell {cell.name} all values of the servo are above it"
        )
        advice = "" if cell.pen else _own_table(sorted({way.power for way in some if way.power is not None}))
    elif not len(heights):
        sentence = "the brush never touches the paper: no line names a height (Z) or moves a servo (M3, M280)"
        advice = ""
    else:
        lowest_mm = float(heights.min()) + paper_z_mm
        advice = f"--paper-z {lowest_mm + 1:.6g} presses it 1 mm deep where it is lowest"
    return Error(sentence, code="nothing-painted", advice=advice)
