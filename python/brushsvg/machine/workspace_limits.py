"""Limits of a machine that moves are held against: places, heights, speeds. Each one broken is a sentence."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..errors import Notice
from .cells.cell import LEAST_SPEED_MM_S, Cell
from .motion import Move, Section
from .move_extents import Ways, bounds, from_origin, place_inside, ways, ways_in
from .realised.tilt import broken_limits as tilted_too_far

ROUNDING_MM = 1e-6
SLOWEST_MM_S = 1e-6  # slower, durations cannot be given


def touching_mm_s(brush, cell: Cell) -> float:
    """The most that the brush's tip may have where it touches."""
    return min(cell.speeds.paint_mm_s, brush.max_speed_mm_s)


def broken_limits(passes, sheet_mm, brush, cell: Cell, least_mm: float = 0.0) -> list[Notice]:
    """A notice of the stroke or station for each limit that passes break for any place of the paper.

    brush: only its name and its greatest speed are read. least_mm: pressed by less, rounding may leave nothing.
    """
    problems = [] if passes else [Notice("", "there is nothing to paint", code="nothing-to-paint")]
    least_mm_s, limit = LEAST_SPEED_MM_S.get(cell.language, SLOWEST_MM_S), touching_mm_s(brush, cell)
    whose = f"brush {brush.name}" if limit == brush.max_speed_mm_s else f"cell {cell.name}"
    for a_pass in passes:
        poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
        if len(poses) == 0:
            found = [Notice("", "the pass has no poses", code="pass-empty")]
        elif not np.isfinite(poses).all():
            found = [Notice("", "a pose is not a finite number", code="not-finite")]
        else:
            found = [*_heights(poses, cell), *tilted_too_far(a_pass, cell)]
            if not (poses[:, 2] < 0).any():
                sentence = "the brush is never pressed to the paper: nothing would be painted"
                found.append(Notice("", sentence, code="never-pressed"))
            elif (depth_mm := -poses[:, 2].min()) < least_mm:
                sentence = (
                    f"the brush is pressed by {depth_mm:.3g} mm, less than the {least_mm:.3g} mm that a program of "
                    f"cell {cell.name} can express: nothing would be painted"
                )
                found.append(Notice("", sentence, code="never-pressed"))
            if cell.pen:
                found += _off_pen(poses, cell)
        speed = a_pass.speed_mm_s
        if not least_mm_s <= speed <= limit:
            sentence = (
                f"speed {speed:.4g} mm/s is outside the range [{least_mm_s:f}, {limit:.1f}] mm/s of {whose}"
            )
            found.append(Notice("", sentence, code="speed-out-of-range"))
        problems += [replace(each, where=a_pass.stroke) for each in found]
    for station in cell.stations:
        if station.by_hand:
            continue  # at the safe height
        width, height = sheet_mm
        on_sheet = (0.0, 0.0, -1.0), (width, height, 1.0)
        path = [(*point[:2], 0.0) for point in (station.place_mm, *station.wipe_mm)]
        (x, y), r = station.place_mm, station.stir_mm
        stirs = [(x - r, y, 0.0), (x + r, y, 0.0), (x, y - r, 0.0), (x, y + r, 0.0)]
        if any(place_inside(ways([[point]]), *on_sheet) is not None for point in (*path, *stirs)):
            sentence = f"its place is on the sheet of {width:g} x {height:g} mm"
            problems.append(Notice(station.name, sentence, code="station-on-sheet"))
        elif place_inside(ways([path]), *on_sheet) is not None:
            sentence = f"its wipe goes over the sheet of {width:g} x {height:g} mm"
            problems.append(Notice(station.name, sentence, code="station-on-sheet"))
    return problems


def walked_astray(sections: Iterable[Section], frame: np.ndarray, cell: Cell, sheet_mm=None) -> list[Notice]:
    """A notice of the stroke or station for each limit of place that the moves of sections break anywhere on their way,
    and those from one section to the next. frame: (4, 4) that of the moves, which is the paper's, in the robot's.

    Where the tool is before the first move nobody knows: that way is not looked at.
    """
    problems: list[Notice] = []
    here = None
    for some in _groups(section for section in sections if section.moves):
        # most keep every limit: all together are checked first, ways between them included
        moves = [move for section in some for move in section.moves]
        if astray(_ways_of(moves, here), frame, cell, sheet_mm):
            problems += _one_by_one(some, here, frame, cell, sheet_mm)
        here = moves[-1].points_mm[-1]
    return list(dict.fromkeys(problems))


MOVES_AT_ONCE = 10_000  # bounds the memory; less is slower


def _groups(sections: Iterable[Section]) -> Iterator[list[Section]]:
    group, moves = [], 0
    for section in sections:
        group.append(section)
        moves += sum(len(move.points_mm) for move in section.moves)
        if moves >= MOVES_AT_ONCE:
            yield group
            group, moves = [], 0
    if group:
        yield group


def _one_by_one(sections, here, frame: np.ndarray, cell: Cell, sheet_mm) -> Iterator[Notice]:
    for section in sections:
        moves = section.moves
        said = [] if here is None else astray_between(here, moves[0].points_mm[0], frame, cell)
        said += astray(_ways_of(moves, None), frame, cell, sheet_mm)
        yield from (replace(each, where=section.name) for each in said)
        here = moves[-1].points_mm[-1]


def _ways_of(moves: Sequence[Move], here: np.ndarray | None) -> Ways:
    """From where the tool is, or else from the first place on. A circle is also looked at along its chords."""
    paths = [move.points_mm for move in moves]
    points = np.vstack(paths if here is None else [here, *paths])
    ends = np.cumsum([len(path) for path in paths]) + (here is not None)
    circles = [
        (points[last - len(move.points_mm) - 1], points[last - 1], (*move.arc.centre_mm, move.arc.turn))
        for move, last in zip(moves, ends.tolist(), strict=True)
        if move.arc is not None and last > len(move.points_mm)
    ]
    return ways([points], circles)


def astray_between(here, there, frame: np.ndarray, cell: Cell, slack_mm: float = ROUNDING_MM) -> list[Notice]:
    """The same for a straight way between two places, unless one of these says it itself."""
    ends = astray(ways([[here], [there]]), frame, cell, None, slack_mm)
    said = [] if ends else astray(ways([[here, there]]), frame, cell, None, slack_mm)
    return [replace(each, sentence=f"on the way there {each.sentence}") for each in said]


def astray(
    some: Ways, frame: np.ndarray, cell: Cell, sheet_mm=None, slack_mm: float = ROUNDING_MM
) -> list[Notice]:
    """A notice, of no element yet, for each limit of place that moves of the paper's frame, (4, 4) in the robot's,
    break anywhere on their way: of the sheet with the margin round it, the cell's box, reach and boxes to keep out of,
    and the heights that a servo knows. slack_mm: what rounding may have moved them by."""
    found = [] if sheet_mm is None else [*_sheet(*bounds(some), sheet_mm, cell, slack_mm)]
    some = ways_in(frame, some)
    if cell.workspace.box_mm or cell.servo:
        found += _box(*bounds(some), cell, slack_mm)
    # Corners that are cut stay in the triangle of their joint. Its third side is r sin(turn) / 2 away from the other
    # two, which is at most twice the r tan(turn / 4) by which the corner is cut. What is convex holds it anyway.
    cut_mm = 2 * cell.blending.tolerance_mm - slack_mm
    if cell.workspace.reach_mm:
        found += _reach(*from_origin(some), cell, cut_mm, slack_mm)
    return [*found, *_kept_out(some, cell, cut_mm)]


def rise_astray(
    height_mm: float, places, frame: np.ndarray, cell: Cell, slack_mm: float = ROUNDING_MM
) -> list[Notice]:
    """The same for the way straight up or down between places (n, 3) and the height to which the tool rises before its
    first move. frame: (4, 4) that of both, in the robot's.

    Where it stands then nobody knows: checked are the places where a program begins and where it leaves the tool.
    """
    places = [place for place in np.asarray(places, dtype=float).reshape(-1, 3) if np.isfinite(place).all()]
    found: list[Notice] = []
    for place in places:
        if not astray(ways([[place]]), frame, cell, None, slack_mm):  # else the place says so itself
            found += astray(ways([[place, (*place[:2], float(height_mm))]]), frame, cell, None, slack_mm)
    said = [replace(each, sentence=f"on the rise before the first move {each.sentence}") for each in found]
    return list(dict.fromkeys(said))


def _heights(poses: np.ndarray, cell: Cell) -> Iterator[Notice]:
    lowest, highest = poses[:, 2].min(), poses[:, 2].max()
    if highest > 0:
        sentence = f"height {highest:.3f} mm inside a pass is above the paper: a pass stays at z <= 0"
        yield Notice("", sentence, code="above-paper")
    elif lowest < cell.heights.lowest_mm:
        reach = f"[{cell.heights.lowest_mm:.1f}, 0.0] mm of cell {cell.name}"
        yield Notice("", f"height {lowest:.1f} mm is outside the range {reach}", code="too-low")


def _off_pen(poses: np.ndarray, cell: Cell) -> Iterator[Notice]:
    """A notice for the first place where a pass is not drawn at the one height that a pen has."""
    goes = np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1) > 1e-9
    drawn = np.r_[goes, False] | np.r_[False, goes]
    drawn[poses[:, 2].argmin()] = True  # of a dab, the deepest place
    for k in np.flatnonzero(drawn & (np.abs(poses[:, 2] - cell.pen.down_mm) > PEN_MM))[:1]:
        x, y, height = poses[k]
        sentence = (
            f"near x {x:.1f}, y {y:.1f} mm the height is {height:.3f} mm: the pen of cell {cell.name} is up or at "
            f"{cell.pen.down_mm:g} mm, and draws at no other height"
        )
        if np.ptp(poses[drawn, 2]) > PEN_MM:
            sentence += "; --brush rigid draws as a pen does"
        yield Notice("", sentence, code="pen-depth")


PEN_MM = 0.005  # of height, that no pen shows


def _sheet(low: np.ndarray, high: np.ndarray, sheet_mm, cell: Cell, slack_mm: float) -> Iterator[Notice]:
    margin = cell.workspace.margin_mm
    for side, beyond in beyond_edges((*low[:2], *high[:2]), sheet_mm).items():
        if beyond - margin > slack_mm:
            sentence = (
                f"the TCP goes {beyond - margin:.2f} mm beyond the {side} edge of the workspace, "
                f"which is the sheet and {margin:.1f} mm around it"
            )
            yield Notice("", sentence, code="tool-off-sheet", about=side)


def _box(least: np.ndarray, greatest: np.ndarray, cell: Cell, slack_mm: float) -> Iterator[Notice]:
    for axis, name in enumerate("xyz" if cell.workspace.box_mm else ""):
        low, high = cell.workspace.box_mm[0][axis], cell.workspace.box_mm[1][axis]
        if least[axis] < low - slack_mm or greatest[axis] > high + slack_mm:
            worst = least[axis] if low - least[axis] > greatest[axis] - high else greatest[axis]
            sentence = (
                f"the tool goes to {name} {_in_digits(worst, low, high)} mm, outside the range "
                f"[{low:g}, {high:g}] mm of workspace.box_mm of cell {cell.name}"
            )
            yield Notice("", sentence, code="out-of-box", about=name)
    if cell.servo:  # its paper is level, and a height beyond the table would silently become its end
        heights = [row[0] for row in cell.servo.table]
        low, high = min(heights), max(heights)
        for height in (least[2], greatest[2]):
            if not low - slack_mm <= height <= high + slack_mm:
                sentence = (
                    f"height {_in_digits(height, low, high)} mm is outside the range [{low:g}, {high:g}] mm of the "
                    f"servo of cell {cell.name}"
                )
                if height > high:  # where the paper is higher than the table allows
                    sentence += ": measure a higher row of its table, or lower safe_mm"
                yield Notice("", sentence, code="servo-out-of-range")


def _reach(nearest: float, farthest: float, cell: Cell, cut_mm: float, slack_mm: float) -> Iterator[Notice]:
    least, greatest = cell.workspace.reach_mm
    # a reach from 0 on forbids nothing near the origin, however corners are cut
    nearest = max(nearest - max(cut_mm, 0.0), 0.0)
    if nearest < least - max(-cut_mm, 0.0) or farthest > greatest + slack_mm:
        worst = nearest if least - nearest > farthest - greatest else farthest
        sentence = (
            f"the tool goes {_in_digits(worst, least, greatest)} mm away from the robot's origin, outside the range "
            f"[{least:g}, {greatest:g}] mm of the reach of cell {cell.name}"
        )
        yield Notice("", sentence, code="out-of-reach")


def _kept_out(some: Ways, cell: Cell, cut_mm: float) -> Iterator[Notice]:
    for number, corners in enumerate(cell.workspace.keep_out_mm, 1):
        low, high = np.array(corners)
        grown = np.maximum(cut_mm, (low - high) / 4)  # however thin a box, slack leaves half of it
        if (place := place_inside(some, low - grown, high + grown)) is None:
            continue
        where = ", ".join(f"{axis} {value:.1f}" for axis, value in zip("xyz", place, strict=True))
        box = ", ".join(
            f"{axis} {a:g} to {b:g}" for axis, a, b in zip("xyz", low.tolist(), high.tolist(), strict=True)
        )
        sentence = f"the tool goes through {where} mm, in box {number} that cell {cell.name} keeps it out of: {box} mm"
        yield Notice("", sentence, code="in-kept-out-box", about=str(number))


def _in_digits(value: float, low: float, high: float) -> str:
    """A length outside of a range, with as many decimals as show it outside."""
    for decimals in range(1, 7):
        if not low <= float(f"{value:.{decimals}f}") <= high:
            break
    return f"{value:.{decimals}f}"


def beyond_edges(bounds_mm, sheet_mm) -> dict[str, float]:
    """How far (left, bottom, right, top) reaches beyond each edge of the sheet [mm]; negative inside."""
    left, bottom, right, top = bounds_mm
    width, height = sheet_mm
    return {"left": -left, "right": right - width, "lower": -bottom, "upper": top - height}
