"""What a brush paints with a plotter's G-code that somebody else wrote, without a thought of a lag."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..drawing.gcode.toolpaths import CHORD_MM, Way, ways_and_end
from ..errors import Error, Notice
from ..machine.cell import Cell, robot_from_paper
from ..machine.move_extents import ways as straight
from ..machine.posts.gcode_servo import height_at
from ..machine.preflight import off_sheet
from ..machine.workspace_limits import ROUNDING_MM, astray, broken_limits

MARGIN_MM = 20.0
_ROOM = dict.fromkeys(
    ("left", "lower"), "its zero is the sheet's lower left corner: move the program's lines"
)
_ROOM |= dict.fromkeys(("right", "upper"), "tell the sheet's size with --sheet WxH")


@dataclass(frozen=True)
class Foreign:
    """plan: a pass for each time that the brush touches; problems: a notice for each limit that it breaks; warnings:
    what is assumed."""

    plan: object
    marks: object
    problems: tuple[Notice, ...]
    warnings: tuple[Notice, ...] = ()


def foreign_program(text: str, brush, cell: Cell, sheet_mm=None, paper_z_mm: float = 0.0) -> Foreign:
    """The program's ways on the cell, its zero the sheet's lower left corner, paper_z_mm where the brush just touches.
    By default the sheet ends 20 mm beyond what is painted. A pen that goes by M3 and M5 goes as the cell's servo does;
    M5 lifts it.

    Error for lines not read, places never named, a pen without a servo in the cell, and where nothing touches.
    """
    some, power = ways_and_end(text)
    some = [replace(way, points_mm=way.points_mm - (0.0, 0.0, paper_z_mm)) for way in some]
    passes, careless = _touches(some, cell)
    outside = _outside(some, cell, sheet_mm)
    if not passes:
        advice = "--paper-z MM says at which height its pen just touches the paper"
        sentence = f"the brush never touches the paper: nothing is below z {paper_z_mm:g}"
        raise Error(sentence, code="nothing-painted", advice=advice)
    if sheet_mm is None:
        highest = np.max([np.asarray(a_pass.poses_mm)[:, :2].max(axis=0) for a_pass in passes], axis=0)
        sheet_mm = tuple(np.maximum(highest + MARGIN_MM, MARGIN_MM).tolist())
    plan = _core.Plan(brush.name, "", tuple(sheet_mm), passes)
    marks = _core.simulate(plan, brush)
    problems = [
        *careless,
        *_left_down(some, power, cell),
        *outside,
        *broken_limits(passes, sheet_mm, brush, cell),
        *(replace(notice, advice=_ROOM[notice.about]) for notice in off_sheet(marks, brush, sheet_mm)),
    ]
    return Foreign(plan, marks, tuple(dict.fromkeys(problems)), _assumed(some))


def _assumed(some: list[Way]) -> tuple[Notice, ...]:
    if some[0].unit_told:
        return ()
    sentence = "neither G20 nor G21 stands before it: its numbers count as millimetres"
    return (Notice(f"line {some[0].line}", sentence, code="unit-assumed"),)


def _outside(some: list[Way], cell: Cell, sheet_mm) -> list[Notice]:
    """A notice for each limit of place that a line leaves, in the air as well; sheet_mm: with the margin round it,
    where it is known."""
    lines, paths = [], []
    for way in some:
        points = _at_heights(way, cell)
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


def _left_down(some: list[Way], power: float | None, cell: Cell) -> list[Notice]:
    """A notice where the program leaves the brush on the paper; power: what a servo holds behind its last line."""
    height_mm = _servo_mm(power, cell) if cell.servo else float(some[-1].points_mm[-1, 2])
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
        points = _at_heights(way, cell)
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
                    told = f"a feed of {60 * way.speed_mm_s:g} mm/min while the brush touches"
                    raise Error(
                        f"line {way.line}: {told}: an F above 0 must stand before it",
                        code="speed-out-of-range",
                    )
                speeds.append(way.speed_mm_s)
            if end[2] > 0:
                lifted()
    lifted()
    return passes, careless


def _below(start: np.ndarray, end: np.ndarray) -> list[np.ndarray]:
    """The ends of what of a straight way is not above the paper."""
    rise = end[2] - start[2]

    def at_paper() -> np.ndarray:
        place = start + (end - start) * (-start[2] / rise)
        return np.array([*place[:2], 0.0])

    return [at_paper() if start[2] > 0 else start, at_paper() if end[2] > 0 else end]


def _at_heights(way, cell: Cell) -> np.ndarray:
    """(n, 3) points of a way; of a pen on a servo, at the height that its value gives."""
    points = np.array(way.points_mm)
    if way.power is not None and cell.servo is None:
        raise Error(
            f"line {way.line}: its pen goes by M3 and M5: give a cell with a servo, whose table says how deep",
            code="servo-unknown",
            advice="--cell grbl-servo, or one of your own",
        )
    if cell.servo is not None:
        points[:, 2] = _servo_mm(way.power, cell)
    return points


def _servo_mm(power: float | None, cell: Cell) -> float:
    """The height that a value of the servo gives; without one it is up."""
    if power is None:
        return max(height for height, _ in cell.servo.table)
    return height_at(cell.servo, power)
