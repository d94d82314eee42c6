"""Make the moves of a stroke: travel, approach, land, paint, lift and retract."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .cells.cell import Cell
from .limits.speeds import commanded_touching_mm_s
from .moves import Arc, Move
from .realised.corner_blending import MAX_BLEND_TURN_RAD, blend_radii_and_angles, find_vertical_steps
from .realised.distortion import commanded_heights_mm, commanded_mm, true_mm
from .realised.rounding import Written
from .realised.tilt import limit_turning_speed
from .tool_axes import tilts_deg

STRAIGHT_SEGMENT, VERTICAL_SEGMENT = -1, -2  # kinds of segments that are not part of an arc


def point_above(point, height_mm: float) -> np.ndarray:
    """Return the place (1, 3) [mm] at a height above a point."""
    return np.array([[point[0], point[1], height_mm]], dtype=float)


def safe_point_above(commanded_mm, cell: Cell) -> np.ndarray:
    """Return the place (1, 3) [mm] at the safe height above a commanded place."""
    (height_mm,) = commanded_heights_mm(np.array([commanded_mm[:2]], dtype=float), cell.heights.safe_mm, cell.machine)
    return point_above(commanded_mm, height_mm)


def approach_mm_s(brush, cell: Cell) -> float:
    """Return the speed [mm/s] of an approach, which is never above the brush's limit.

    Nothing bends in the air, but a program is easier to trust if none of its feeds is above the brush's limit.
    """
    return min(cell.speeds.approach_mm_s, brush.max_speed_mm_s)


def make_stroke_moves(a_pass, written: Written, brush, cell: Cell) -> tuple[Move, ...]:
    """Make the moves of a stroke, from the safe height down to the paper and back up.

    written: the pass as the program contains it. A pass without poses has no moves.
    """
    poses = written.commanded_mm
    if len(poses) == 0:
        return ()
    heights, speeds = cell.heights, cell.speeds
    start, end = true_mm(poses[[0, -1]], cell.machine)

    def commanded_above(place, height_mm: float) -> np.ndarray:
        return commanded_mm(point_above(place, height_mm), cell.machine)

    axes = written.axes
    first, last = (None, None) if axes is None else (axes[:1], axes[-1:])

    def limit_turn_speed(speed_mm_s: float, axes_there) -> float:
        """Limit the speed of a move that turns the tool.

        The tool is upright at the safe height and turns on the way to or from the clearance.
        """
        turn_deg = 0.0 if axes_there is None else float(tilts_deg(axes_there)[0])
        return limit_turning_speed(speed_mm_s, heights.safe_mm - heights.clearance_mm, turn_deg, cell)

    paint_mm_s = min(a_pass.speed_mm_s, commanded_touching_mm_s(brush, cell))
    # Pressing on the spot and lifting bend the bristles as much as painting does, so they are never faster.
    press_mm_s = min(speeds.press_mm_s, paint_mm_s)
    return (
        Move("travel", safe_point_above(commanded_above(start, 0.0)[0], cell), speeds.travel_mm_s),
        Move(
            "approach",
            commanded_above(start, heights.clearance_mm),
            limit_turn_speed(approach_mm_s(brush, cell), first),
            axes=first,
        ),
        Move("land", poses[:1], press_mm_s, axes=first),
        *_paint_moves(poses, written, paint_mm_s, press_mm_s, cell),
        Move("lift", commanded_above(end, heights.clearance_mm), press_mm_s, axes=last),
        Move(
            "retract",
            safe_point_above(commanded_above(end, 0.0)[0], cell),
            limit_turn_speed(speeds.travel_mm_s, last),
        ),
    )


def _paint_moves(
    poses: np.ndarray, written: Written, paint_mm_s: float, press_mm_s: float, cell: Cell
) -> Iterator[Move]:
    """Yield the moves that paint a pass, from its first pose on.

    Straight moves up and down are as slow as a landing. The plan's arcs are circles.
    """
    arcs, steps = written.arcs, np.diff(true_mm(written.poses_mm, cell.machine), axis=0)
    kinds = np.full(len(steps), STRAIGHT_SEGMENT)
    kinds[find_vertical_steps(steps, written.sideways_mm)] = VERTICAL_SEGMENT
    for number, arc in enumerate(arcs):
        kinds[arc.first : arc.last] = number
    starts_run = np.diff(kinds) != 0
    radii = None
    if cell.blending.radius_mm:
        radii, turns_rad = blend_radii_and_angles(written.poses_mm, cell.blending, arcs)
        starts_run |= turns_rad[1:-1] > MAX_BLEND_TURN_RAD
    for run in np.split(np.arange(len(steps)), np.flatnonzero(starts_run) + 1):
        if not len(run):
            continue
        kind = kinds[run[0]]
        arc = Arc(tuple(arcs[kind].centre_mm), arcs[kind].direction) if kind >= 0 else None
        speed = press_mm_s if kind == VERTICAL_SEGMENT else paint_mm_s
        blends_mm = None if radii is None else radii[run + 1]
        axes = None if written.axes is None else written.axes[run + 1]
        yield Move("paint", poses[run + 1], speed, arc, blends_mm, axes)
