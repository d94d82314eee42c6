"""Reload paint: stations to visit before strokes, and splits of long strokes."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import Error
from ..geometry.polylines import length, lengths
from .cells.cell import Cell, Station, robot_from_paper, shorten_visit
from .frames import is_upright
from .pen_changes import may_pause, pen_visits
from .posts import POSTS, circles_by
from .realised.arc_chords import points_with_chords, split_arcs_at_extremes, with_chords
from .realised.distortion import in_lines_mm, is_similar, keeps_lines
from .realised.pass_on_path import move_pass_to_path
from .realised.tilt import refuse_tilt_without_tool, split_turning_moves
from .tool_axes import axes_of, normalize


@dataclass(frozen=True)
class PlanInLoads:
    """A plan as a machine runs it, with each stroke in one or more passes.

    Paint can be fetched between the passes. This is not a plan: it counts loads instead of strokes, and no load is
    split again. The attribute `load` of a part is its number in its stroke, also in a plan.json. As a rule, plans are
    stored unsplit and are split for the machine.

    lasts_mm: path length [mm] that a load of paint lasts; infinite unless the brush gives it and the cell counts it.
    """

    sheet_mm: tuple[float, float]
    loads: tuple
    lasts_mm: float = math.inf

    def strokes(self) -> list[str]:
        """Return for each load the name of the stroke that it paints or continues."""
        names: list[str] = []
        for a_pass in self.loads:
            names.append(names[-1] if is_later_part(a_pass) else a_pass.stroke)
        return names

    def left(self, first_stroke: int) -> PlanInLoads:
        """Return the loads from number first_stroke on, counted from 1."""
        return PlanInLoads(self.sheet_mm, self.loads[first_stroke - 1 :], self.lasts_mm)

    def as_plan(self):
        """Return the loads as a plan, for simulation."""
        return _core.Plan(sheet_mm=self.sheet_mm, passes=list(self.loads))


def split_into_loads(plan: _core.Plan, brush: _core.Brush, cell: Cell) -> PlanInLoads:
    """Split strokes into parts that one load of paint can paint.

    The parts are named stroke, stroke+2, ... A stroke stays whole if the cell does not count the length, or if its
    setting reload is false. Parts that are already split stay as they are. A pass that begins or ends below the paper
    is set down or lifted there.

    Passes are also prepared for the machine. Poses are added to

    - arcs, for a machine without circles,
    - lines, if the cell has a map of the paper or a field,
    - moves that turn the brush, for a robot that turns evenly between poses.

    If the axes have backlash, arcs are split where an axis turns back.

    Raises Error for a part that does not follow the part before it, and for a tilted brush that the cell cannot tilt.
    """
    refuse_tilt_without_tool(plan.passes, cell)
    loads, previous, lasts_mm = list(plan.passes), None, math.inf
    for a_pass in loads:
        if is_later_part(a_pass) and (previous is None or previous.load != a_pass.load - 1):
            number = a_pass.load
            sentence = f"load {number} of a stroke stands where no load {number - 1} of it comes before"
            raise Error(sentence, a_pass.stroke, code="load-out-of-order")
        previous = a_pass
    if cell.reload and cell.reload.when == "length":
        every_mm, back_mm = load_length_mm(brush, cell), cell.reload.backtrack_mm
        lasts_mm = every_mm if brush.paint else math.inf
        loads = []
        for a_pass in plan.passes:
            is_whole = painted_mm(a_pass) <= every_mm or a_pass.settings.reload is False or a_pass.load > 0
            loads += [a_pass] if is_whole else _core.split_into_loads(a_pass, brush, every_mm, every_mm, back_mm)
    if not _can_write_circles(cell):
        loads = map(with_chords, loads)
    elif cell.machine and any(cell.machine.backlash_mm):
        axes = robot_from_paper(cell)[:2, 0]
        loads = (split_arcs_at_extremes(load, float(np.arctan2(axes[1], axes[0]))) for load in loads)
    if not keeps_lines(cell.machine):
        loads = (_split_for_map(load, cell.machine) for load in map(split_turning_moves, loads))
    else:
        loads = map(split_turning_moves, loads)
    return PlanInLoads(tuple(plan.sheet_mm), tuple(map(_start_and_end_on_paper, loads)), lasts_mm)


def _split_for_map(a_pass, machine):
    axes = axes_of(a_pass)
    rows = in_lines_mm(np.asarray(a_pass.poses_mm if axes is None else np.hstack([a_pass.poses_mm, axes])), machine)
    return move_pass_to_path(a_pass, rows[:, :3], (), None if axes is None else normalize(rows[:, 3:]))


def load_length_mm(brush: _core.Brush, cell: Cell) -> float:
    """Return the path length [mm] that a load of paint lasts.

    The cell must count the length. It is the smallest of three lengths: the cell's own, the length until the hairs run
    dry, and the length until the marks narrow by the amount that the cell allows.

    Raises Error if no part of a stroke could be that short.
    """
    reload = cell.reload
    limits_mm = [reload.every_mm]
    if brush.paint and brush.paint.lasts_mm:
        limits_mm.append(brush.paint.lasts_mm)
    if brush.paint and reload.narrower_percent:
        limits_mm.append(brush.paint.path_to_share_mm(1 - reload.narrower_percent / 100))
    if min(limits_mm) <= 2 * reload.backtrack_mm:
        sentence = (
            f"paint of brush {brush.name} lasts for {min(limits_mm):.1f} mm on cell {cell.name}, which must be more "
            f"than twice backtrack_mm {reload.backtrack_mm:g}"
        )
        raise Error(sentence, code="load-too-short")
    return min(limits_mm)


def _can_write_circles(cell: Cell) -> bool:
    """Return whether the plan's arcs can be written as circles.

    On leaning paper, circles would not be in a plane that the robot knows. A machine with corrected positions may need
    ellipses.
    """
    post = POSTS.get(cell.language)
    if not is_similar(cell.machine):
        return False
    if not circles_by(cell):
        return False
    return not post or not post.in_robot_frame or is_upright(robot_from_paper(cell))


def _start_and_end_on_paper(a_pass):
    """Add a landing or lift on the spot if a pass begins or ends below the paper."""
    poses = np.asarray(a_pass.poses_mm)
    below = poses[[0, -1], 2] < 0 if len(poses) else np.zeros(2, dtype=bool)
    if not below.any():
        return a_pass
    ends = poses[[0, -1]] * (1, 1, 0) + 0.0  # adding 0.0 turns -0.0 into 0.0
    before, after = ends[:1][below[:1]], ends[1:][below[1:]]
    arcs = [
        _core.Arc(arc.first + len(before), arc.last + len(before), arc.centre_mm, arc.direction) for arc in a_pass.arcs
    ]
    axes = np.asarray(a_pass.tool_axes).reshape(-1, 3)
    if len(axes):
        axes = np.vstack([axes[:1][below[:1]], axes, axes[-1:][below[1:]]])
    return move_pass_to_path(a_pass, np.vstack([before, poses, after]), arcs, axes)


def list_station_visits(loads: PlanInLoads, cell: Cell, first_stroke: int = 1) -> tuple[tuple[Station, ...], ...]:
    """Return for each load the stations to visit before it.

    Loads before first_stroke are not run and have no visits. For a cell without paint, the visits are changes of the
    pen. The result is then () if all strokes have one colour, or if the program cannot wait for a person.

    Paint is fetched before the first stroke and before every change of colour. It is also fetched before every stroke
    or layer if the cell says so, and when the paint on the brush would not last. More paint of the same colour needs
    only a short visit. A stroke's setting reload requests paint or does without it, instead of the cell's rule.

    Raises Error for a colour that no station serves.
    """
    if not cell.reload:
        return pen_visits(loads.loads, cell, first_stroke) if may_pause(cell) else ()
    painted, left_loads = loads.loads[: first_stroke - 1], loads.loads[first_stroke - 1 :]
    visits_of_loads, last_pass, used_mm = [()] * len(painted), None, 0.0
    with suppress(Error):  # a colour that no station serves is not on the brush
        last_pass = painted[-1] if painted and _find_station(painted[-1], cell) else None
    for number, a_pass in enumerate(left_loads, len(painted) + 1):
        station = _find_station(a_pass, cell)
        length_mm = painted_mm(a_pass)
        is_new_colour = last_pass is not None and _find_station(last_pass, cell) != station
        wash_stations = [candidate for candidate in cell.stations if candidate.name == cell.reload.wash]
        is_fetching = (
            last_pass is None
            or is_new_colour
            or number == first_stroke
            or _needs_paint(a_pass, last_pass, used_mm + length_mm, cell.reload, loads.lasts_mm)
        )
        if last_pass is not None and not is_new_colour and number != first_stroke:
            wash_stations = [shorten_visit(candidate) for candidate in wash_stations if cell.reload.rinse]
            station = shorten_visit(station)
        elif not is_new_colour:
            wash_stations = []
        visits_of_loads.append((*wash_stations, station) if is_fetching else ())
        used_mm = length_mm + (0.0 if is_fetching else used_mm)
        last_pass = a_pass
    return tuple(visits_of_loads)


def dips_mm(passes, loads: PlanInLoads, cell: Cell) -> list[list[float]]:
    """Return for each pass the path lengths [mm] at which paint was fetched.

    `narrow` needs this result. The path lengths are measured along the path of the TCP.

    If the cell does not fetch paint, every pass begins freshly dipped. Only passes with reload set to false continue
    with the paint left by the pass before.

    passes: passes of the plan, or the loads themselves.
    """
    if not cell.reload:
        return dips_without_cell(passes)
    visits_of_loads, dips_of_passes, load_index = list_station_visits(loads, cell), [], 0
    for a_pass in passes:
        dips = [0.0] if visits_of_loads[load_index] else []
        load_index += 1
        while not a_pass.load and load_index < len(loads.loads) and is_later_part(loads.loads[load_index]):
            dips.append(_part_start_mm(a_pass, loads.loads[load_index], dips[-1] if dips else 0.0))
            load_index += 1
        dips_of_passes.append(dips)
    return dips_of_passes


def fetched_mm(plan: _core.Plan, brush: _core.Brush, cell: Cell | None) -> list[list[float]]:
    """Return dips_mm for the passes of a plan, with or without a cell."""
    if cell:
        with suppress(Error):  # the error is reported when the program is made
            return dips_mm(plan.passes, split_into_loads(plan, brush, cell), cell)
    return dips_without_cell(plan.passes)


def dips_without_cell(passes) -> list[list[float]]:
    """Return dips_mm for passes whose paint is not fetched by a program."""
    return [[] if number and a_pass.settings.reload is False else [0.0] for number, a_pass in enumerate(passes)]


def _part_start_mm(stroke, part, after_mm: float) -> float:
    """Return the path length [mm] along a stroke at which a part begins.

    The part's landing is included. It is found from the moves that the stroke and the part share, beyond the beginning
    of the part before. If they share none, it is found from the part's first pose.

    after_mm: path length at which the part before begins.
    """
    stroke_points, part_points = (
        points_with_chords(np.asarray(a_pass.poses_mm), a_pass.arcs)[:, :2] for a_pass in (stroke, part)
    )
    along_mm, way_mm = lengths(stroke_points), lengths(part_points)
    start, step = stroke_points[:-1], np.diff(stroke_points, axis=0)
    squared_lengths = np.maximum((step**2).sum(axis=1), 1e-18)
    fraction = np.clip((((part_points[:, None] - start) * step).sum(axis=2)) / squared_lengths, 0.0, 1.0)
    offset_mm = np.linalg.norm(start + fraction[..., None] * step - part_points[:, None], axis=2)
    places_mm = along_mm[:-1] + fraction * np.sqrt(squared_lengths)
    offset_mm[places_mm <= after_mm] = np.inf
    nearest = offset_mm.argmin(axis=1)
    rows = np.arange(len(part_points))
    place_mm, offset_mm = places_mm[rows, nearest], offset_mm[rows, nearest]
    is_shared = (
        (offset_mm[:-1] < MAX_SHARED_OFFSET_MM)
        & (offset_mm[1:] < MAX_SHARED_OFFSET_MM)
        & (np.abs(np.diff(place_mm) - np.diff(way_mm)) < MAX_SHARED_OFFSET_MM)
    )
    part_starts_mm = (place_mm - way_mm)[:-1]
    if not is_shared.any():
        return float(max(place_mm[0], after_mm + MAX_SHARED_OFFSET_MM))
    return float(max(np.median(part_starts_mm[is_shared]), after_mm + MAX_SHARED_OFFSET_MM))


# Largest distance between moves that a stroke and its part share. Their arcs are divided into chords at different
# places, and each chord is up to 0.01 mm away from its circle.
MAX_SHARED_OFFSET_MM = 0.02


def painted_mm(a_pass: _core.Pass) -> float:
    """Return the length of the TCP's path on the paper [mm]."""
    poses = np.asarray(a_pass.poses_mm)
    return length(points_with_chords(poses, a_pass.arcs) if len(a_pass.arcs) else poses)


def _needs_paint(a_pass, last, used_mm: float, reload, lasts_mm: float) -> bool:
    if is_later_part(a_pass):
        return True
    requested = a_pass.settings.reload
    if requested is not None:
        return requested
    if reload.when == "stroke":
        return True
    if reload.when == "layer":
        return a_pass.layer != last.layer
    return used_mm > min(reload.every_mm, lasts_mm)


def is_later_part(a_pass: _core.Pass) -> bool:
    """Return whether a load continues the stroke of the load before it."""
    return a_pass.load > 1


def _find_station(a_pass, cell: Cell) -> Station:
    colour = a_pass.colour.lower()
    stations = [station for station in cell.stations if station.name != cell.reload.wash]
    for station in stations:
        if colour in [served_colour.lower() for served_colour in station.colours]:
            return station
    for station in stations:
        if not station.colours:
            return station
    served = ", ".join(colour for station in stations for colour in station.colours)
    sentence = f"no station of cell {cell.name} has paint of colour {colour or 'none'}; there are {served}"
    raise Error(sentence, a_pass.stroke, code="colour-not-served")
