"""Plan + Cell -> what the robot does, move by move with its meaning, every limit checked."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from .. import _core
from ..errors import Error, Notice
from .arm.joints import is_installed
from .arm.place import find_unreachable
from .cells.cell import (
    MAX_PROGRAM_LINES,
    MAX_PROGRAM_POINTS,
    Cell,
    Station,
    robot_from_paper,
    shorten_visit,
    value_mm,
)
from .frames import moved
from .motion import Arc, Move, Program, Section, Wait, rise_over, set_programmed_speeds
from .paint_reload import PlanInLoads, visits
from .posts import POSTS
from .posts.text import make_unique
from .realised.corner_blending import SHARP_RAD, blends, on_the_spot
from .realised.distortion import commanded_high_mm, commanded_mm, true_mm
from .realised.rounding import Written, as_written
from .realised.tilt import slow_enough
from .tool_axes import axes_of, tilts_deg
from .workspace_limits import broken_limits, rise_astray, touching_mm_s, walked_astray

PLAIN, ON_THE_SPOT = -1, -2  # what a segment is that is on no arc


@dataclass(frozen=True)
class Job:
    """How a plan is run: the paper so much higher than the cell says, from which stroke on.

    first_stroke counts loads, as a program's titles do. visits: for each load the stations to visit before it; () for a
    brush that is loaded once.
    """

    z_offset_mm: float = 0.0
    first_stroke: int = 1
    visits: tuple[tuple[Station, ...], ...] = ()


WHOLE_JOB = Job()
AROUND = 4  # points of a stroke around its poses
POSES_KEPT = 300_000  # of a plan whose moves are made once and kept, in some 10 MB
POSES_AT_ONCE = 100_000  # held twice, for a plan of any size; and what one call to numpy handles


@dataclass(frozen=True)
class Walked:
    """A job that was gone through before it is run. job: with its visits; made: all that the machine does, without a
    header; written: what a program has of a load, by its number; problems: a notice of the stroke or station for
    anything that forbids to run it, empty when the robot may."""

    loads: PlanInLoads
    job: Job
    made: Program
    written: Callable[[int], Written]
    problems: list[Notice]

    def allowed(self) -> Program:
        """What is run. Error, naming stroke and range, where something forbids it."""
        for notice in self.problems:
            raise Error(notice.sentence, where=notice.where, code=notice.code)
        return self.made


def walked(loads: PlanInLoads, brush, cell: Cell, job: Job = WHOLE_JOB) -> Walked:
    """Moves for every load of the job, in order, with the visits to the paint, and each limit that is broken anywhere
    on its way, or on that of a visit to any station.

    brush: only its name and its greatest speed are read.
    """
    problems = []
    try:
        job = replace(job, visits=visits(loads, cell, job.first_stroke))
    except Error as unserved:
        problems.append(unserved.notice())
    written = written_of(loads, cell, job)
    made = unchecked_program(loads, brush, cell, job, written)
    first, count = job.first_stroke, len(loads.loads)
    if count and not 1 <= first <= count:
        sentence = f"stroke {first} is outside the range [1, {count}] of this job"
        return Walked(loads, job, made, written, [Notice("", sentence, code="stroke-unknown")])
    left = loads.left(first).loads
    if cell.pen and job.z_offset_mm:
        sentence = f"the pen of cell {cell.name} is up or down: no height of the paper can be set"
        problems.append(Notice("", sentence, code="pen-depth"))
    commanded_mm = value_mm(cell) if cell.servo else 10.0**-cell.decimals
    problems += broken_limits(
        [_as_run(a_pass, made) for a_pass in left], loads.sheet_mm, brush, cell, commanded_mm
    )
    problems += [
        Notice(
            a_pass.stroke,
            f"{count} poses are outside the range [1, {MAX_PROGRAM_POINTS[cell.language]}] of one program, and a "
            "stroke cannot be parted: --tolerance makes them fewer",
            code="poses-too-many",
        )
        for a_pass in (left if cell.language in MAX_PROGRAM_POINTS else ())
        if (count := len(a_pass.poses_mm) + AROUND) > MAX_PROGRAM_POINTS[cell.language]
    ]
    if all(np.isfinite(a_pass.poses_mm).all() for a_pass in left):
        problems += astray_in(made, loads.sheet_mm)
        problems += stations_astray(brush, cell, made.robot_from_frame, loads.sheet_mm)
    if problems and cell.reload:  # reported of strokes as they were drawn, once for one in parts
        drawn = dict(zip((a_pass.stroke for a_pass in loads.loads), loads.strokes(), strict=True))
        problems = [replace(each, where=drawn.get(each.where, each.where)) for each in problems]
    return Walked(loads, job, made, written, list(dict.fromkeys(problems)))


def beyond_part(loads: PlanInLoads, cell: Cell) -> list[Notice]:
    """A notice of each stroke that alone has more lines than a program of the language should."""
    most = MAX_PROGRAM_LINES.get(cell.language)
    return [
        Notice(
            a_pass.stroke,
            f"{count} poses are outside the range [1, {most}] of one program, which the controller may not load",
            code="poses-too-many",
            advice="--tolerance makes them fewer",
        )
        for a_pass in (loads.loads if most else ())
        if (count := len(a_pass.poses_mm) + AROUND) > most
    ]


def _as_run(a_pass, made: Program):
    """Return the pass for which limits are checked: a servo's with the places at which it stands."""
    if made.cell.servo is None or not np.isfinite(a_pass.poses_mm).all():
        return a_pass
    written = as_written(a_pass, made.cell, made.robot_from_frame)
    poses = true_mm(written.commanded_mm, made.cell.machine)
    return _core.Pass(a_pass.stroke, poses, a_pass.speed_mm_s)  # no servo tilts a brush


def astray_in(made: Program, sheet_mm) -> list[Notice]:
    """The same for a program's ways, its rise before the first move included."""
    ends: list = []
    home = _home(made)

    def sections() -> Iterator[Section]:
        yield from home
        for section in made.sections():
            if moves := section.moves:
                ends[:] = [ends[0] if ends else moves[0].points_mm[0], moves[-1].points_mm[-1]]
            yield section
        yield from home

    frame, height_mm = made.robot_from_frame, made.rise_mm
    found = walked_astray(sections(), frame, made.cell, sheet_mm)
    post = POSTS.get(made.cell.language)
    if post and post.in_robot_frame:  # else it rises to the safe height over the paper
        ends = list(moved(frame, np.reshape(ends, (-1, 3))))
        frame, height_mm = np.eye(4), made.rise_in_robot_mm
    return found + rise_astray(height_mm, ends, frame, made.cell)


def _home(made: Program) -> tuple[Section, ...]:
    """Return where motors that count steps begin, and end: over the robot's origin."""
    if made.cell.motors is None:
        return ()
    place = moved(np.linalg.inv(made.robot_from_frame), np.array([[0.0, 0.0, made.cell.heights.safe_mm]]))
    travel = Move("travel", place, made.cell.speeds.travel_mm_s)
    return (Section("home: where the motors begin and end", (travel,)),)


def out_of_arm(made: Program, sheet_mm) -> list[Notice]:
    """A notice, with the place that the paper would need, for what the cell's arm cannot do of a program; none
    where the cell has no arm, or nothing is installed that knows its joints."""
    if made.cell.arm is None or not is_installed():
        return []
    return find_unreachable(made, lambda there: not astray_in(there, sheet_mm))


def _is_little(loads: PlanInLoads, job: Job) -> bool:
    left = loads.loads[max(job.first_stroke - 1, 0) :]
    return sum(len(a_pass.poses_mm) for a_pass in left) <= POSES_KEPT


def written_of(loads: PlanInLoads, cell: Cell, job: Job, was_read: bool = False) -> Callable[[int], Written]:
    """What a program has of each load, by its number from 1 on; made once where that is little. was_read: the loads,
    in a program."""
    frame = robot_from_paper(cell, job.z_offset_mm)

    def written(number: int) -> Written:
        return as_written(loads.loads[number - 1], cell, frame, was_read)

    return cache(written) if _is_little(loads, job) else written


def unchecked_program(
    loads: PlanInLoads,
    brush,
    cell: Cell,
    job: Job = WHOLE_JOB,
    written: Callable[[int], Written] | None = None,
) -> Program:
    """Return the program for its duration or its picture: limits are not checked. Its sections are made
    once where they are few: they are walked for limits, time, length and text."""
    frame, count = robot_from_paper(cell, job.z_offset_mm), len(loads.loads)
    left = list(enumerate(loads.loads, 1))[max(job.first_stroke - 1, 0) :]
    written = written or written_of(loads, cell, job)

    def sections() -> Iterator[Section]:
        for number, a_pass in left:
            stations = job.visits[number - 1] if job.visits else ()
            yield from (set_programmed_speeds(visit(station, brush, cell), cell) for station in stations)
            moves = _moves(a_pass, written(number), brush, cell)
            yield set_programmed_speeds(Section(f"stroke {number} of {count}: {a_pass.stroke}", moves), cell)

    made = cache(lambda: tuple(sections()))
    rises_mm = (rise_over(cell, loads.sheet_mm, of) for of in (np.eye(4), frame))
    walk = (lambda: iter(made())) if _is_little(loads, job) else sections
    tilts = any(axes_of(a_pass) is not None for _, a_pass in left)
    return Program((), cell, frame, walk, *rises_mm, touching_mm_s(brush, cell), tilts)


def over(point, height_mm: float) -> np.ndarray:
    """(1, 3) the place above a point."""
    return np.array([[point[0], point[1], height_mm]], dtype=float)


def safely_over(commanded_mm, cell: Cell) -> np.ndarray:
    """Return (1, 3) the place at safe height above a commanded one."""
    (height_mm,) = commanded_high_mm(
        np.array([commanded_mm[:2]], dtype=float), cell.heights.safe_mm, cell.machine
    )
    return over(commanded_mm, height_mm)


def approach_mm_s(brush, cell: Cell) -> float:
    """In the air nothing bends; yet a program is easier to trust if no feed in it is above the brush's limit."""
    return min(cell.speeds.approach_mm_s, brush.max_speed_mm_s)


def names_of_stations(cell: Cell) -> dict[Station, str]:
    """What a program calls each, short visits by a name of their own: no two alike."""
    stations = list(dict.fromkeys(each for one in cell.stations for each in (one, shorten_visit(one))))
    names = make_unique([station.name for station in stations])
    return dict(zip(stations, names, strict=True))


def stations_astray(brush, cell: Cell, frame: np.ndarray, sheet_mm=None) -> list[Notice]:
    """A notice for each limit of place that a visit to a station breaks, dips, stirring and wiping included.
    frame: (4, 4) the paper's in the robot's."""
    visited = ([visit(station, brush, cell)] for station in cell.stations)
    return [notice for one in visited for notice in walked_astray(one, frame, cell, sheet_mm)]


def visit(station: Station, brush, cell: Cell) -> Section:
    """To the paint and back up to safe height; a person does the rest where the station is served by hand."""
    name = names_of_stations(cell).get(station, station.name)
    speeds = cell.speeds
    if not station.place_mm:
        return Section(f"paint: {name}", (Wait(None, f"take the {name}"),))
    steps = [Move("travel", safely_over(station.place_mm, cell), speeds.travel_mm_s)]
    if station.by_hand:
        return Section(f"paint: {name}", (*steps, Wait(None, f"dip the brush: {name}")))
    # a vessel may stand lower than the paper, under which nothing is fast
    rim = max(station.rim_mm, 0.0) + cell.heights.clearance_mm
    press_mm_s = min(speeds.press_mm_s, touching_mm_s(brush, cell))
    steps += [
        Move("approach", over(station.place_mm, rim), approach_mm_s(brush, cell)),
        Move("dip", over(station.place_mm, station.surface_mm - station.depth_mm), press_mm_s),
    ]
    if station.stir_mm:
        steps.append(Move("dip", _circles(station), press_mm_s))
    steps += [Wait(station.hold_s)] if station.hold_s else []
    steps.append(Move("dip", over(station.place_mm, rim), press_mm_s))
    steps += [Wait(station.drip_s)] if station.drip_s else []
    last = station.place_mm
    if station.wipe_mm:
        steps.append(Move("wipe", np.array(station.wipe_mm, dtype=float), press_mm_s))
        last = station.wipe_mm[-1]
        if last[2] < rim:
            steps.append(Move("dip", over(last, rim), press_mm_s))
    steps.append(Move("retract", safely_over(last, cell), speeds.travel_mm_s))
    return Section(f"paint: {name}", tuple(steps))


STIR_POINTS = 24  # of each circle


def _circles(station: Station) -> np.ndarray:
    """(n, 3) circles in the paint, from the middle out and back to it."""
    turn = np.linspace(0, 2 * np.pi * station.stir_turns, STIR_POINTS * station.stir_turns + 1)
    x, y = station.place_mm
    circles = np.column_stack([x + station.stir_mm * np.cos(turn), y + station.stir_mm * np.sin(turn)])
    places = np.vstack([circles, [x, y]])
    return np.column_stack([places, np.full(len(places), station.surface_mm - station.depth_mm)])


def _moves(a_pass, written: Written, brush, cell: Cell) -> tuple[Move, ...]:
    poses = written.commanded_mm
    if len(poses) == 0:
        return ()
    heights, speeds = cell.heights, cell.speeds
    start, end = true_mm(poses[[0, -1]], cell.machine)

    def above(place, height_mm: float) -> np.ndarray:
        return commanded_mm(over(place, height_mm), cell.machine)

    axes = written.axes
    first, last = (None, None) if axes is None else (axes[:1], axes[-1:])

    def no_faster(speed_mm_s: float, held) -> float:
        """The tool turns between upright, at the safe height, and how it is held at the clearance."""
        turn_deg = 0.0 if held is None else float(tilts_deg(held)[0])
        return slow_enough(speed_mm_s, heights.safe_mm - heights.clearance_mm, turn_deg, cell)

    # Pressing on the spot and lifting off bend the bristles as much as painting does: never faster than it.
    press_mm_s = min(speeds.press_mm_s, a_pass.speed_mm_s)
    return (
        Move("travel", safely_over(above(start, 0.0)[0], cell), speeds.travel_mm_s),
        Move(
            "approach",
            above(start, heights.clearance_mm),
            no_faster(approach_mm_s(brush, cell), first),
            axes=first,
        ),
        Move("land", poses[:1], press_mm_s, axes=first),
        *_painting(poses, written, a_pass.speed_mm_s, press_mm_s, cell),
        Move("lift", above(end, heights.clearance_mm), press_mm_s, axes=last),
        Move("retract", safely_over(above(end, 0.0)[0], cell), no_faster(speeds.travel_mm_s, last)),
    )


def _painting(
    poses: np.ndarray, written: Written, paint_mm_s: float, press_mm_s: float, cell: Cell
) -> Iterator[Move]:
    """From the first pose on, straight up and down as slowly as a landing, along arcs where the plan has them."""
    arcs, steps = written.arcs, np.diff(true_mm(written.poses_mm, cell.machine), axis=0)
    kinds = np.full(len(steps), PLAIN)
    kinds[on_the_spot(steps, written.sideways_mm)] = ON_THE_SPOT
    for number, arc in enumerate(arcs):
        kinds[arc.first : arc.last] = number
    new_run = np.diff(kinds) != 0
    radii = None
    if cell.blending.radius_mm:
        radii, turns_rad = blends(written.poses_mm, cell.blending, arcs)
        new_run |= turns_rad[1:-1] > SHARP_RAD
    for run in np.split(np.arange(len(steps)), np.flatnonzero(new_run) + 1):
        if not len(run):
            continue
        kind = kinds[run[0]]
        arc = Arc(tuple(arcs[kind].centre_mm), arcs[kind].direction) if kind >= 0 else None
        speed = press_mm_s if kind == ON_THE_SPOT else paint_mm_s
        blends_mm = None if radii is None else radii[run + 1]
        axes = None if written.axes is None else written.axes[run + 1]
        yield Move("paint", poses[run + 1], speed, arc, blends_mm, axes)
