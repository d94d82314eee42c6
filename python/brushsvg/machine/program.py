"""Turn a plan and a cell into the moves of a robot, and check every limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from .. import _core
from ..errors import Error, Notice
from .arm.inverse_kinematics import is_installed
from .arm.place import find_unreachable
from .cells.cell import Cell, Station, robot_from_paper, shorten_visit, value_mm
from .cells.language_limits import MAX_PROGRAM_LINES, MAX_PROGRAM_POINTS
from .frames import transform_points
from .moves import Arc, Move, Program, Section, Wait, rise_height_mm, set_programmed_speeds
from .paint_reload import PlanInLoads, station_visits
from .posts import POSTS
from .posts.text import make_unique_names
from .realised.corner_blending import MAX_BLEND_TURN_RAD, blend_radii_and_angles, find_vertical_steps
from .realised.distortion import commanded_heights_mm, commanded_mm, true_mm
from .realised.rounding import Written, as_written
from .realised.tilt import limit_turning_speed
from .tool_axes import axes_of, tilts_deg
from .workspace_limits import (
    broken_limits,
    check_first_rise,
    commanded_touching_mm_s,
    find_astray_sections,
    find_strokes_in_vessels,
    find_vessels_near_travel,
    touching_mm_s,
)

STRAIGHT_SEGMENT, VERTICAL_SEGMENT = -1, -2  # kinds of segments that are not part of an arc


@dataclass(frozen=True)
class Job:
    """Options for running a plan.

    z_offset_mm: how much higher the paper is than the cell says.
    first_stroke: number of the first stroke to run. It counts loads, as the titles in a program do.
    visits: for each load, the stations to visit before it; () for a brush that is loaded once.
    """

    z_offset_mm: float = 0.0
    first_stroke: int = 1
    visits: tuple[tuple[Station, ...], ...] = ()


WHOLE_JOB = Job()
POSES_AROUND_STROKE = 4  # points that a stroke has in addition to its poses
# Largest plan whose moves are made once and kept. They need about 10 MB.
POSES_KEPT = 300_000
# Number of poses that one call to numpy handles. It limits the memory for plans of any size.
MAX_POSES_AT_ONCE = 100_000


@dataclass(frozen=True)
class CheckedProgram:
    """A job with its program and its problems, as found before it is run.

    job: the job with its visits.
    made: the whole program, without a header.
    written: returns the written form of a load, by its number.
    problems: a notice for each reason not to run the job, naming the stroke or station. Empty if the job may be run.
    """

    loads: PlanInLoads
    job: Job
    made: Program
    written: Callable[[int], Written]
    problems: list[Notice]

    def allowed(self) -> Program:
        """Return the program if there is no problem.

        Raises Error, naming stroke and range, for the first problem.
        """
        for notice in self.problems:
            raise Error(notice.sentence, where=notice.where, code=notice.code, advice=notice.advice)
        return self.made


def make_checked_program(loads: PlanInLoads, brush, cell: Cell, job: Job = WHOLE_JOB) -> CheckedProgram:
    """Make the moves of a job, with the visits to the paint, and check their limits.

    Every move is checked over its whole length, and so are the visits to all stations.

    brush: only its name and its greatest speed are read.
    """
    problems = []
    try:
        job = replace(job, visits=station_visits(loads, cell, job.first_stroke))
    except Error as error:
        problems.append(error.notice())
    written = make_written_form(loads, cell, job)
    made = unchecked_program(loads, brush, cell, job, written)
    first_stroke, count = job.first_stroke, len(loads.loads)
    if count and not 1 <= first_stroke <= count:
        sentence = f"stroke {first_stroke} is outside the range [1, {count}] of this job"
        return CheckedProgram(loads, job, made, written, [Notice("", sentence, code="stroke-unknown")])
    left_loads = loads.left(first_stroke).loads
    if cell.pen and job.z_offset_mm:
        sentence = f"the pen of cell {cell.name} is up or down: no height of the paper can be set"
        problems.append(Notice("", sentence, code="pen-depth"))
    problems += find_vessels_near_travel(cell, job.z_offset_mm)
    commanded_mm = value_mm(cell) if cell.servo else 10.0**-cell.decimals
    problems += broken_limits(
        [_pass_at_servo_places(a_pass, made) for a_pass in left_loads],
        loads.sheet_mm,
        brush,
        cell,
        commanded_mm,
    )
    problems += [
        Notice(
            a_pass.stroke,
            f"{count} poses are outside the range [1, {MAX_PROGRAM_POINTS[cell.language]}] of one program, "
            "and a stroke cannot be split: a larger --tolerance gives fewer poses",
            code="poses-too-many",
        )
        for a_pass in (left_loads if cell.language in MAX_PROGRAM_POINTS else ())
        if (count := len(a_pass.poses_mm) + POSES_AROUND_STROKE) > MAX_PROGRAM_POINTS[cell.language]
    ]
    if all(np.isfinite(a_pass.poses_mm).all() for a_pass in left_loads):
        problems += find_moves_out_of_limits(made, loads.sheet_mm)
        problems += find_stations_out_of_limits(brush, cell, made.robot_from_frame, loads.sheet_mm)
    if problems and cell.reload:  # name the stroke as it was drawn, once for all its parts
        stroke_of_load = dict(zip((a_pass.stroke for a_pass in loads.loads), loads.strokes(), strict=True))
        problems = [replace(notice, where=stroke_of_load.get(notice.where, notice.where)) for notice in problems]
    return CheckedProgram(loads, job, made, written, list(dict.fromkeys(problems)))


def beyond_part(loads: PlanInLoads, cell: Cell) -> list[Notice]:
    """Report each stroke that alone is too long for one program.

    The language limits the lines of a program.
    """
    max_lines = MAX_PROGRAM_LINES.get(cell.language)
    return [
        Notice(
            a_pass.stroke,
            f"{count} poses are outside the range [1, {max_lines}] of one program, which the controller may not load",
            code="poses-too-many",
            advice="a larger --tolerance gives fewer poses",
        )
        for a_pass in (loads.loads if max_lines else ())
        if (count := len(a_pass.poses_mm) + POSES_AROUND_STROKE) > max_lines
    ]


def _pass_at_servo_places(a_pass, program: Program):
    """Return the pass for which limits are checked.

    With a servo, its poses are the places at which the servo stands.
    """
    if program.cell.servo is None or not np.isfinite(a_pass.poses_mm).all():
        return a_pass
    written = as_written(a_pass, program.cell, program.robot_from_frame)
    poses = true_mm(written.commanded_mm, program.cell.machine)
    return _core.Pass(a_pass.stroke, poses, a_pass.speed_mm_s)  # a servo cannot tilt the brush


def find_moves_out_of_limits(program: Program, sheet_mm) -> list[Notice]:
    """Report moves of a program that leave the workspace.

    The rise before the first move is included.
    """
    ends: list = []
    home_sections = _home_sections(program)

    def sections() -> Iterator[Section]:
        yield from home_sections
        for section in program.sections():
            if moves := section.moves:
                ends[:] = [ends[0] if ends else moves[0].points_mm[0], moves[-1].points_mm[-1]]
            yield section
        yield from home_sections

    frame, height_mm = program.robot_from_frame, program.rise_mm
    notices = find_astray_sections(sections(), frame, program.cell, sheet_mm)
    if program.cell.stations:  # visits go to vessels, and vessels may stand close together
        visits = {f"paint: {name}" for name in names_of_stations(program.cell).values()}
        strokes = (section for section in program.sections() if section.title not in visits)
        notices += find_strokes_in_vessels(strokes, program.cell)
    post = POSTS.get(program.cell.language)
    if post and post.in_robot_frame:  # other programs rise to the safe height over the paper
        ends = list(transform_points(frame, np.reshape(ends, (-1, 3))))
        frame, height_mm = np.eye(4), program.rise_in_robot_mm
    return notices + check_first_rise(height_mm, ends, frame, program.cell)


def _home_sections(program: Program) -> tuple[Section, ...]:
    """Return a section with the place where motors that count steps begin and end.

    The place is over the robot's origin. Other machines have no such section.
    """
    if program.cell.motors is None:
        return ()
    place_mm = transform_points(
        np.linalg.inv(program.robot_from_frame), np.array([[0.0, 0.0, program.cell.heights.safe_mm]])
    )
    travel = Move("travel", place_mm, program.cell.speeds.travel_mm_s)
    return (Section("home: where the motors begin and end", (travel,)),)


def out_of_arm(program: Program, sheet_mm, with_advice: bool = True) -> list[Notice]:
    """Report what the cell's arm cannot do of a program.

    The advice is the place that the paper would need. Reports nothing if the cell has no arm, or if the library for
    joints is not installed.

    with_advice: False saves the search for this place, which can take seconds.
    """
    if program.cell.arm is None or not is_installed():
        return []
    if not with_advice:
        return find_unreachable(program)
    return find_unreachable(program, lambda there: not find_moves_out_of_limits(there, sheet_mm))


def _fits_in_cache(loads: PlanInLoads, job: Job) -> bool:
    left_loads = loads.loads[max(job.first_stroke - 1, 0) :]
    return sum(len(a_pass.poses_mm) for a_pass in left_loads) <= POSES_KEPT


def make_written_form(loads: PlanInLoads, cell: Cell, job: Job, was_read: bool = False) -> Callable[[int], Written]:
    """Return a function that gives the written form of a load by its number.

    Loads are numbered from 1. The results are kept for a small plan.

    was_read: whether the loads were read from a program.
    """
    frame = robot_from_paper(cell, job.z_offset_mm)

    def written(number: int) -> Written:
        return as_written(loads.loads[number - 1], cell, frame, was_read)

    return cache(written) if _fits_in_cache(loads, job) else written


def unchecked_program(
    loads: PlanInLoads,
    brush,
    cell: Cell,
    job: Job = WHOLE_JOB,
    written: Callable[[int], Written] | None = None,
) -> Program:
    """Make a program without checking its limits.

    It can be used for a duration or a picture. A small plan's sections are made only once, because limits, time, length
    and text all need them.
    """
    frame, count = robot_from_paper(cell, job.z_offset_mm), len(loads.loads)
    numbered_loads = list(enumerate(loads.loads, 1))[max(job.first_stroke - 1, 0) :]
    written = written or make_written_form(loads, cell, job)

    def sections() -> Iterator[Section]:
        for number, a_pass in numbered_loads:
            stations = job.visits[number - 1] if job.visits else ()
            yield from (set_programmed_speeds(make_visit(station, brush, cell), cell) for station in stations)
            moves = _stroke_moves(a_pass, written(number), brush, cell)
            yield set_programmed_speeds(Section(f"stroke {number} of {count}: {a_pass.stroke}", moves), cell)

    make_sections_once = cache(lambda: tuple(sections()))
    rises_mm = (rise_height_mm(cell, loads.sheet_mm, of) for of in (np.eye(4), frame))
    iterate_sections = (lambda: iter(make_sections_once())) if _fits_in_cache(loads, job) else sections
    tilts = any(axes_of(a_pass) is not None for _, a_pass in numbered_loads)
    return Program((), cell, frame, iterate_sections, *rises_mm, commanded_touching_mm_s(brush, cell), tilts)


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


def names_of_stations(cell: Cell) -> dict[Station, str]:
    """Return a unique name for each station and for each short visit."""
    stations = list(
        dict.fromkeys(visited for station in cell.stations for visited in (station, shorten_visit(station)))
    )
    names = make_unique_names([station.name for station in stations])
    return dict(zip(stations, names, strict=True))


def find_stations_out_of_limits(brush, cell: Cell, frame: np.ndarray, sheet_mm=None) -> list[Notice]:
    """Report visits to stations that leave the workspace.

    Dips, stirring and wiping are included.

    frame: (4, 4) pose of the paper's frame in the robot's frame.
    """
    visited = ([make_visit(station, brush, cell)] for station in cell.stations)
    return [notice for sections in visited for notice in find_astray_sections(sections, frame, cell, sheet_mm)]


def make_visit(station: Station, brush, cell: Cell) -> Section:
    """Make the moves to the paint and back up to the safe height.

    At a station that is served by hand, a person does the rest.
    """
    name = names_of_stations(cell).get(station, station.name)
    speeds = cell.speeds
    if not station.place_mm:
        return Section(f"paint: {name}", (Wait(None, f"take the {name}"),))
    steps = [Move("travel", safe_point_above(station.place_mm, cell), speeds.travel_mm_s)]
    if station.by_hand:
        return Section(f"paint: {name}", (*steps, Wait(None, f"dip the brush: {name}")))
    # a vessel may be lower than the paper, but no move below the paper's height is fast
    rim_mm = max(station.rim_mm, 0.0) + cell.heights.clearance_mm
    press_mm_s = min(speeds.press_mm_s, touching_mm_s(brush, cell))
    steps += [
        Move("approach", point_above(station.place_mm, rim_mm), approach_mm_s(brush, cell)),
        Move("dip", point_above(station.place_mm, station.surface_mm - station.depth_mm), press_mm_s),
    ]
    if station.stir_mm:
        steps.append(Move("dip", _stir_circles(station), press_mm_s))
    steps += [Wait(station.hold_s)] if station.hold_s else []
    steps.append(Move("dip", point_above(station.place_mm, rim_mm), press_mm_s))
    steps += [Wait(station.drip_s)] if station.drip_s else []
    last_mm = station.place_mm
    if station.wipe_mm:
        steps.append(Move("wipe", np.array(station.wipe_mm, dtype=float), press_mm_s))
        last_mm = station.wipe_mm[-1]
        if last_mm[2] < rim_mm:
            steps.append(Move("dip", point_above(last_mm, rim_mm), press_mm_s))
    steps.append(Move("retract", safe_point_above(last_mm, cell), speeds.travel_mm_s))
    return Section(f"paint: {name}", tuple(steps))


POINTS_PER_STIR_CIRCLE = 24


def _stir_circles(station: Station) -> np.ndarray:
    """Return points (n, 3) [mm] of circles in the paint, which end in the middle."""
    turn = np.linspace(0, 2 * np.pi * station.stir_turns, POINTS_PER_STIR_CIRCLE * station.stir_turns + 1)
    x, y = station.place_mm
    circles = np.column_stack([x + station.stir_mm * np.cos(turn), y + station.stir_mm * np.sin(turn)])
    places = np.vstack([circles, [x, y]])
    return np.column_stack([places, np.full(len(places), station.surface_mm - station.depth_mm)])


def _stroke_moves(a_pass, written: Written, brush, cell: Cell) -> tuple[Move, ...]:
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
