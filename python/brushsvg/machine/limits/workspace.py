"""Check moves against the limits of a machine: places, heights and speeds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from ...errors import Notice
from ..cells.cell import Cell
from ..moves import Section
from ..realised.backlash import half_mm
from ..realised.tilt import check_tilt_limits as tilted_too_far
from .move_extents import (
    ROUNDING_MM,
    Ways,
    distances_from_origin,
    find_place_inside,
    group_sections,
    make_paths,
    measure_bounds,
    paths_in_frame,
    paths_of_moves,
)
from .paint_on_sheet import distances_beyond_edges
from .speeds import check_painting_speed
from .vessels import find_stations_on_sheet


def broken_limits(passes, sheet_mm, brush, cell: Cell, least_mm: float = 0.0) -> list[Notice]:
    """Report each limit that passes break, independently of the paper's place.

    Each notice names the stroke or station.

    brush: only its name and its greatest speed are read.
    least_mm: smallest depth that a program can express. Rounding may leave nothing of a smaller depth.
    """
    problems = [] if passes else [Notice("", "there is nothing to paint", code="nothing-to-paint")]
    for a_pass in passes:
        poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
        if len(poses) == 0:
            notices = [Notice("", "the pass has no poses", code="pass-empty")]
        elif not np.isfinite(poses).all():
            notices = [Notice("", "a pose is not a finite number", code="not-finite")]
        else:
            notices = [*_check_heights(poses, cell), *tilted_too_far(a_pass, cell)]
            if not (poses[:, 2] < 0).any():
                sentence = "the brush is never pressed to the paper: nothing would be painted"
                notices.append(Notice("", sentence, code="never-pressed"))
            elif (depth_mm := -poses[:, 2].min()) < least_mm:
                sentence = (
                    f"the brush is pressed by {depth_mm:.3g} mm, less than the {least_mm:.3g} mm that a program of "
                    f"cell {cell.name} can express: nothing would be painted"
                )
                notices.append(Notice("", sentence, code="never-pressed"))
            if cell.pen:
                notices += _check_pen_height(poses, cell)
        notices += check_painting_speed(a_pass.speed_mm_s, brush, cell)
        problems += [replace(notice, where=a_pass.stroke) for notice in notices]
    return problems + find_stations_on_sheet(cell, sheet_mm)


def find_astray_sections(sections: Iterable[Section], frame: np.ndarray, cell: Cell, sheet_mm=None) -> list[Notice]:
    """Report each limit of place that the moves of sections break.

    Moves between sections are included. Each notice names the stroke or station. The path to the first move is not
    checked, because the tool's place before it is not known.

    frame: (4, 4) pose of the moves' frame, which is the paper's frame, in the robot's frame.
    """
    problems: list[Notice] = []
    here = None
    for group in group_sections(section for section in sections if section.moves):
        # Most sections keep every limit, so the whole group is checked first, including the moves between sections.
        moves = [move for section in group for move in section.moves]
        if find_broken_limits(paths_of_moves(moves, here), frame, cell, sheet_mm):
            problems += _find_in_each_section(group, here, frame, cell, sheet_mm)
        here = moves[-1].points_mm[-1]
    return list(dict.fromkeys(problems))


def _find_in_each_section(sections, here, frame: np.ndarray, cell: Cell, sheet_mm) -> Iterator[Notice]:
    for section in sections:
        moves = section.moves
        notices = [] if here is None else find_limits_broken_between(here, moves[0].points_mm[0], frame, cell)
        notices += find_broken_limits(paths_of_moves(moves, None), frame, cell, sheet_mm)
        yield from (replace(notice, where=section.name) for notice in notices)
        here = moves[-1].points_mm[-1]


def find_limits_broken_between(
    here, there, frame: np.ndarray, cell: Cell, slack_mm: float = ROUNDING_MM
) -> list[Notice]:
    """Report each limit of place that a straight move between two places breaks.

    Reports nothing if one of the two places breaks a limit itself.
    """
    ends = find_broken_limits(make_paths([[here], [there]]), frame, cell, None, slack_mm)
    notices = [] if ends else find_broken_limits(make_paths([[here, there]]), frame, cell, None, slack_mm)
    return [replace(notice, sentence=f"on the way there {notice.sentence}") for notice in notices]


def find_broken_limits(
    moves: Ways, frame: np.ndarray, cell: Cell, sheet_mm=None, slack_mm: float = ROUNDING_MM
) -> list[Notice]:
    """Report each limit of place that moves break anywhere on their path.

    The limits are the sheet with its margin, the cell's box, reach and boxes to keep out of, and the heights of a
    servo's table. The box is smaller by half of the machine's play, because a program commands places ahead of the
    tool. The notices name no stroke or station yet.

    frame: (4, 4) pose of the moves' frame, which is the paper's frame, in the robot's frame.
    slack_mm: how far rounding may have moved the moves.
    """
    notices = [] if sheet_mm is None else [*_check_sheet(*measure_bounds(moves), sheet_mm, cell, slack_mm)]
    moves = paths_in_frame(frame, moves)
    if cell.workspace.box_mm or cell.servo:
        notices += _check_box(*measure_bounds(moves), cell, slack_mm)
    # A cut corner stays in the triangle of its joint. The triangle's third side is r sin(turn) / 2 away from the other
    # two sides. This is at most twice the r tan(turn / 4) by which the corner is cut. A convex limit holds the triangle
    # anyway.
    cut_mm = 2 * cell.blending.tolerance_mm - slack_mm
    if cell.workspace.reach_mm:
        notices += _check_reach(*distances_from_origin(moves), cell, cut_mm, slack_mm)
    return [*notices, *_check_keep_out(moves, cell, cut_mm)]


def check_first_rise(
    height_mm: float, places, frame: np.ndarray, cell: Cell, slack_mm: float = ROUNDING_MM
) -> list[Notice]:
    """Report each limit of place that the straight rise before the first move breaks.

    The tool's place before the rise is not known. The places where a program begins and ends are checked instead.

    height_mm: height to which the tool rises.
    places: (n, 3) places from which it rises.
    frame: (4, 4) pose of the frame of both, in the robot's frame.
    """
    places = [place for place in np.asarray(places, dtype=float).reshape(-1, 3) if np.isfinite(place).all()]
    notices: list[Notice] = []
    for place in places:
        # Otherwise the place itself is reported.
        if not find_broken_limits(make_paths([[place]]), frame, cell, None, slack_mm):
            notices += find_broken_limits(
                make_paths([[place, (*place[:2], float(height_mm))]]), frame, cell, None, slack_mm
            )
    notices_of_rise = [
        replace(notice, sentence=f"on the rise before the first move {notice.sentence}") for notice in notices
    ]
    return list(dict.fromkeys(notices_of_rise))


def _check_heights(poses: np.ndarray, cell: Cell) -> Iterator[Notice]:
    lowest, highest = poses[:, 2].min(), poses[:, 2].max()
    if highest > 0:
        sentence = f"height {highest:.3f} mm inside a pass is above the paper: a pass stays at z <= 0"
        yield Notice("", sentence, code="above-paper")
    elif lowest < cell.heights.lowest_mm:
        reach = f"[{cell.heights.lowest_mm:.1f}, 0.0] mm of cell {cell.name}"
        yield Notice("", f"height {lowest:.1f} mm is outside the range {reach}", code="too-low")


def _check_pen_height(poses: np.ndarray, cell: Cell) -> Iterator[Notice]:
    """Report the first place that is not drawn at the height of the pen."""
    moves_sideways = np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1) > 1e-9
    drawn = np.r_[moves_sideways, False] | np.r_[False, moves_sideways]
    drawn[poses[:, 2].argmin()] = True  # the deepest place of a dab
    for k in np.flatnonzero(drawn & (np.abs(poses[:, 2] - cell.pen.down_mm) > MAX_PEN_HEIGHT_DIFFERENCE_MM))[:1]:
        x, y, height = poses[k]
        sentence = (
            f"near x {x:.1f}, y {y:.1f} mm the height is {height:.3f} mm: the pen of cell {cell.name} is up or at "
            f"{cell.pen.down_mm:g} mm, and draws at no other height"
        )
        if np.ptp(poses[drawn, 2]) > MAX_PEN_HEIGHT_DIFFERENCE_MM:
            sentence += "; --brush rigid draws as a pen does"
        yield Notice("", sentence, code="pen-depth")


MAX_PEN_HEIGHT_DIFFERENCE_MM = 0.005  # a smaller difference of height is not visible


def _check_sheet(low: np.ndarray, high: np.ndarray, sheet_mm, cell: Cell, slack_mm: float) -> Iterator[Notice]:
    margin = cell.workspace.margin_mm
    for side, beyond in distances_beyond_edges((*low[:2], *high[:2]), sheet_mm).items():
        if beyond - margin > slack_mm:
            sentence = (
                f"the TCP goes {beyond - margin:.2f} mm beyond the {side} edge of the workspace, "
                f"which is the sheet and {margin:.1f} mm around it"
            )
            moved = "the drawing or the station" if cell.stations else "the drawing"
            advice = f"move {moved} away from this edge, or raise workspace.margin_mm of the cell if there is room"
            yield Notice("", sentence, code="tool-off-sheet", about=side, advice=advice, excess=beyond - margin)


def _check_box(least: np.ndarray, greatest: np.ndarray, cell: Cell, slack_mm: float) -> Iterator[Notice]:
    play_mm = (*half_mm(cell).tolist(), 0.0)  # a program commands x and y this far ahead of their places
    for axis, name in enumerate("xyz" if cell.workspace.box_mm else ""):
        low, high = cell.workspace.box_mm[0][axis] + play_mm[axis], cell.workspace.box_mm[1][axis] - play_mm[axis]
        if least[axis] < low - slack_mm or greatest[axis] > high + slack_mm:
            shown_mm = least[axis] if low - least[axis] > greatest[axis] - high else greatest[axis]
            less = f", less {play_mm[axis]:g} mm for half of machine.backlash_mm" if play_mm[axis] else ""
            sentence = (
                f"the tool goes to {name} {_outside_text(shown_mm, low, high)} mm, outside the range "
                f"[{low:g}, {high:g}] mm of workspace.box_mm of cell {cell.name}{less}"
            )
            advice = _advise("box_mm", cell, name == "z")
            excess = _distance_outside(shown_mm, low, high)
            yield Notice("", sentence, code="out-of-box", about=name, advice=advice, excess=excess)
    if cell.servo:  # the paper is level, and a height beyond the table would silently become its last height
        heights = [row[0] for row in cell.servo.table]
        low, high = min(heights), max(heights)
        for height in (least[2], greatest[2]):
            if not low - slack_mm <= height <= high + slack_mm:
                sentence = (
                    f"height {_outside_text(height, low, high)} mm is outside the range [{low:g}, {high:g}] mm of the "
                    f"servo of cell {cell.name}"
                )
                advice = "measure a lower row of its table"
                if height > high:  # the paper is higher than the table allows
                    advice = "measure a higher row of its table, or lower safe_mm"
                excess = _distance_outside(height, low, high)
                yield Notice("", sentence, code="servo-out-of-range", advice=advice, excess=excess)


def _check_reach(nearest: float, farthest: float, cell: Cell, cut_mm: float, slack_mm: float) -> Iterator[Notice]:
    min_mm, max_mm = cell.workspace.reach_mm
    # a reach from 0 on has no lower limit, so a cut corner cannot break it
    nearest = max(nearest - max(cut_mm, 0.0), 0.0)
    if nearest < min_mm - max(-cut_mm, 0.0) or farthest > max_mm + slack_mm:
        shown_mm = nearest if min_mm - nearest > farthest - max_mm else farthest
        sentence = (
            f"the tool goes {_outside_text(shown_mm, min_mm, max_mm)} mm away from the robot's origin, outside the "
            f"range [{min_mm:g}, {max_mm:g}] mm of the reach of cell {cell.name}"
        )
        excess = _distance_outside(shown_mm, min_mm, max_mm)
        yield Notice("", sentence, code="out-of-reach", advice=_advise("reach_mm", cell), excess=excess)


def _check_keep_out(moves: Ways, cell: Cell, cut_mm: float) -> Iterator[Notice]:
    for number, corners in enumerate(cell.workspace.keep_out_mm, 1):
        low, high = np.array(corners)
        slack = np.maximum(cut_mm, (low - high) / 4)  # the slack leaves at least half of a thin box
        if (place := find_place_inside(moves, low - slack, high + slack)) is None:
            continue
        where = ", ".join(f"{axis} {value:.1f}" for axis, value in zip("xyz", place, strict=True))
        box = ", ".join(f"{axis} {a:g} to {b:g}" for axis, a, b in zip("xyz", low.tolist(), high.tolist(), strict=True))
        sentence = f"the tool goes through {where} mm, in box {number} that cell {cell.name} keeps it out of: {box} mm"
        yield Notice("", sentence, code="in-kept-out-box", about=str(number), advice=_advise("keep_out_mm", cell))


def _advise(key: str, cell: Cell, is_height: bool = False) -> str:
    """Return what to do about a broken limit of place, which is a key of the cell's table [workspace]."""
    moved = "the paper or the station" if cell.stations else "the paper"
    instead = "change the table [heights] of the cell" if is_height else "use a smaller sheet or drawing"
    return f"move {moved}, {instead}, or change workspace.{key} of the cell if the tool may go there"


def _distance_outside(value: float, low: float, high: float) -> float:
    return max(low - value, value - high)


def _outside_text(value: float, low: float, high: float) -> str:
    """Format a length outside of a range. It has enough decimals to show that it is outside."""
    for decimals in range(1, 7):
        if not low <= float(f"{value:.{decimals}f}") <= high:
            break
    return f"{value:.{decimals}f}"
