"""Make the program of a job: the moves of a plan on a cell, with every limit checked."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from .. import _core
from ..errors import Error, Notice
from .arm.inverse_kinematics import is_installed
from .arm.place import find_unreachable
from .cells.cell import Cell, Station, min_part_mm, robot_from_paper, value_mm
from .cells.language_limits import MAX_PROGRAM_LINES, MAX_PROGRAM_POINTS
from .frames import transform_points
from .limits.speeds import commanded_touching_mm_s
from .limits.vessels import find_strokes_in_vessels, find_vessels_near_travel
from .limits.workspace import broken_limits, check_first_rise, find_astray_sections
from .moves import Move, Program, Section, rise_height_mm, set_programmed_speeds
from .paint_reload import PlanInLoads, list_station_visits
from .posts import POSTS
from .realised.distortion import true_mm
from .realised.rounding import Written, as_written
from .station_moves import make_visit, names_of_stations
from .stroke_moves import make_stroke_moves
from .tool_axes import axes_of


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
        job = replace(job, visits=list_station_visits(loads, cell, job.first_stroke))
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
        [_pass_as_written(a_pass, made) for a_pass in left_loads],
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


def report_strokes_beyond_part(loads: PlanInLoads, cell: Cell) -> list[Notice]:
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


def _pass_as_written(a_pass, program: Program):
    """Return the pass for which limits are checked.

    With a servo, its poses are the places at which the servo stands. Poses that are hardly pressed are those that
    rounding leaves.
    """
    poses, cell = np.asarray(a_pass.poses_mm), program.cell
    is_hardly_pressed = len(poses) and -2 * min_part_mm(cell) < poses[:, 2].min() < 0
    if not (cell.servo or is_hardly_pressed) or not np.isfinite(poses).all():
        return a_pass
    written = as_written(a_pass, cell, program.robot_from_frame)
    poses = true_mm(written.commanded_mm, cell.machine)
    axes = {} if written.axes is None else {"tool_axes": written.axes}
    return _core.Pass(a_pass.stroke, poses, a_pass.speed_mm_s, **axes)


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


def find_moves_out_of_arm(program: Program, sheet_mm, with_advice: bool = True) -> list[Notice]:
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
            moves = make_stroke_moves(a_pass, written(number), brush, cell)
            yield set_programmed_speeds(Section(f"stroke {number} of {count}: {a_pass.stroke}", moves), cell)

    make_sections_once = cache(lambda: tuple(sections()))
    rises_mm = (rise_height_mm(cell, loads.sheet_mm, of) for of in (np.eye(4), frame))
    iterate_sections = (lambda: iter(make_sections_once())) if _fits_in_cache(loads, job) else sections
    tilts = any(axes_of(a_pass) is not None for _, a_pass in numbered_loads)
    return Program((), cell, frame, iterate_sections, *rises_mm, commanded_touching_mm_s(brush, cell), tilts)


def find_stations_out_of_limits(brush, cell: Cell, frame: np.ndarray, sheet_mm=None) -> list[Notice]:
    """Report visits to stations that leave the workspace.

    Dips, stirring and wiping are included.

    frame: (4, 4) pose of the paper's frame in the robot's frame.
    """
    visited = ([make_visit(station, brush, cell)] for station in cell.stations)
    return [notice for sections in visited for notice in find_astray_sections(sections, frame, cell, sheet_mm)]
