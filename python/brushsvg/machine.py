"""From a plan to the text that a machine runs: limits asked, paint fetched, blends tried, header written."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from . import _core
from .blends import blend_radii, blended
from .cell import Cell, robot_from_paper
from .cell_file import cell_names, find_cell
from .errors import Error
from .files import write_files
from .limits import beyond_edges
from .moves import Program, duration_s, in_robot_frame, painting_mm
from .paint import in_loads, visits
from .posts import POSTS, Post
from .program import WHOLE_JOB, Job, forbidden, program, unchecked_program
from .report import clock
from .written import as_written

DEFAULT_TOLERANCE_MM = 0.05


def problems(
    plan, brush, marks, cell: Cell, tolerance_mm: float, job: Job = WHOLE_JOB
) -> list[tuple[str, str]]:
    """(stroke, sentence) for everything that forbids to run the plan on the robot; empty when all is well."""
    found = forbidden(plan, brush, cell, job) + off_sheet(marks, brush, plan.sheet_mm)
    return found or shifted_by_blends(plan, brush, cell, tolerance_mm)


def as_exact_as(cell: Cell, tolerance_mm: float) -> Cell:
    """The cell, cutting corners by at most a fifth of a plan's tolerance: they must not use it up."""
    cut_mm = min(cell.blending.tolerance_mm, tolerance_mm / 5)
    return replace(cell, blending=replace(cell.blending, tolerance_mm=cut_mm))


def check_rounding(cell: Cell, tolerance_mm: float) -> None:
    """Error where the cell's decimals alone move places by more than a fifth of a plan's tolerance."""
    rounded_mm = 0.5 * 10.0**-cell.decimals
    if rounded_mm > tolerance_mm / 5:
        raise Error(
            f"{cell.decimals} decimals of cell {cell.name} round places by up to {rounded_mm:g} mm, outside the "
            f"range [0, {tolerance_mm / 5:g}] mm, a fifth of the tolerance",
            where="decimals",
        )


def off_sheet(marks, brush, sheet_mm) -> list[tuple[str, str]]:
    """(stroke, sentence) for each side of the sheet [mm] that a stroke's paint crosses."""
    found = []
    for trace in marks.passes:
        bounds_mm = _core.painted_bounds(trace, brush)
        if not np.isfinite(bounds_mm).all():
            continue  # nothing touches the paper
        found += [
            (trace.stroke, f"the mark reaches {beyond:.2f} mm beyond the {side} edge of the sheet")
            for side, beyond in beyond_edges(bounds_mm, sheet_mm).items()
            if beyond >= 0.005  # what would print as 0.00 mm is rounding, not paint
        ]
    return found


def bounds_mm(marks, brush) -> tuple[float, float, float, float]:
    """Left, bottom, right, top of all paint. Error when nothing touches the paper."""
    bounds = np.array([_core.painted_bounds(trace, brush) for trace in marks.passes]).reshape(-1, 4)
    bounds = bounds[np.isfinite(bounds).all(axis=1)]
    if not len(bounds):
        raise Error("nothing touches the paper: there is no border")
    return (*bounds[:, :2].min(axis=0).tolist(), *bounds[:, 2:].max(axis=0).tolist())


def shifted_by_blends(plan, brush, cell: Cell, tolerance_mm: float) -> list[tuple[str, str]]:
    """(stroke, sentence) where cutting corners as the cell does moves the mark by more than the tolerance.

    The path as it is run is simulated, and where the brush is taut its widest section compared with the plan's.
    """
    if not cell.blending.tolerance_mm:
        return []
    # marks are straight between rows: as close as the tolerance asks, or it is their chords that are compared
    rows_mm = min(tolerance_mm / 10, ROWS_MM)
    found = []
    told = [_with_circles_that_are_told(a_pass, cell) for a_pass in plan.passes]
    for first, last in _groups(plan.passes):
        runs = as_run(told[first:last], lambda poses, arcs: blend_radii(poses, cell.blending, arcs))
        pairs = zip(plan.passes[first:last], runs, strict=True)
        cut = [(a_pass, *run) for a_pass, run in pairs if len(run[1]) > len(a_pass.poses_mm)]
        both = [a_pass for a_pass, _, _ in cut] + [run for _, run, _ in cut]
        traces = _core.simulate(
            _core.Plan(sheet_mm=plan.sheet_mm, passes=both), brush, rows_mm, for_outlines=False
        ).passes
        for (a_pass, _, at), meant, run in zip(cut, traces[: len(cut)], traces[len(cut) :], strict=True):
            shift_mm = _largest_shift_mm(meant, run, at, brush)
            if shift_mm > tolerance_mm:
                sentence = (
                    f"cutting corners by up to {cell.blending.tolerance_mm:g} mm, as cell {cell.name} does, moves the "
                    f"mark by {shift_mm:.3g} mm, outside the range [0, {tolerance_mm:g}] mm of the tolerance"
                )
                found.append((a_pass.stroke, sentence))
    return found


ROWS_MM = 0.02  # rows of a mark are as close as that: a coarse tolerance is no reason to look less closely
POSES_AT_ONCE = 100_000  # what is held twice, whatever the size of a plan; and what one call to numpy handles


def _with_circles_that_are_told(a_pass, cell: Cell):
    if not a_pass.arcs:
        return a_pass
    arcs = as_written(a_pass, cell, robot_from_paper(cell)).arcs
    return _core.Pass(a_pass.stroke, a_pass.poses_mm, a_pass.speed_mm_s, arcs=arcs)


def _groups(passes) -> Iterator[tuple[int, int]]:
    """First and last of passes that are handled at once."""
    first, poses = 0, 0
    for number, a_pass in enumerate(passes):
        if poses and poses + len(a_pass.poses_mm) > POSES_AT_ONCE:
            yield first, number
            first, poses = number, 0
        poses += len(a_pass.poses_mm)
    yield first, len(passes)


def as_run(passes, radii_of: Callable[[np.ndarray, list], np.ndarray]) -> list[tuple]:
    """Each pass with its corners cut, and the pose that each point of its path belongs to, as a fractional index.

    radii_of: from poses (n, 3) and arcs to how far each corner is cut, see blend_radii.
    """
    starts = np.cumsum([0, *(len(a_pass.poses_mm) for a_pass in passes)]).tolist()
    poses = np.vstack([a_pass.poses_mm for a_pass in passes])
    arcs = [
        _core.Arc(arc.first + start, arc.last + start, arc.centre_mm, arc.direction)
        for a_pass, start in zip(passes, starts[:-1], strict=True)
        for arc in a_pass.arcs
    ]
    radii = radii_of(poses, arcs)
    radii[starts[:-1]] = radii[[start - 1 for start in starts[1:]]] = 0.0  # no path goes on in the next
    path, at, points = blended(poses, radii, arcs)
    runs = []
    for a_pass, start, end in zip(passes, starts[:-1], starts[1:], strict=True):
        first, last = points[start, 0], points[end - 1, 1] + 1
        rows = points[start:end] - first
        arcs = [
            _core.Arc(rows[arc.first, 1], rows[arc.last, 0], arc.centre_mm, arc.direction)
            for arc in a_pass.arcs
        ]
        run = _core.Pass(a_pass.stroke, path[first:last], a_pass.speed_mm_s, arcs=arcs)
        runs.append((run, at[first:last] - start))
    return runs


def _largest_shift_mm(meant, run, at: np.ndarray, brush) -> float:
    """Between the widest sections of two traces of one stroke; at: the meant pose of each pose that was run."""
    ran, planned = _under_way(run), _under_way(meant)
    taut = np.asarray(run.taut, dtype=bool)[ran]
    if not taut.any():
        return 0.0
    pose = np.interp(np.asarray(run.pose)[ran][taut], np.arange(len(at)), at)
    widest = _core.widest_points(meant, brush)[planned]
    there = np.column_stack([np.interp(pose, np.asarray(meant.pose)[planned], axis) for axis in widest.T])
    return float(np.linalg.norm(_core.widest_points(run, brush)[ran][taut] - there, axis=1).max())


def _under_way(trace) -> slice:
    """The rows from where the brush was set down to where it is lifted: all rows of a landing or lift on the spot are
    of one pose, by which no place can be found."""
    pose = np.asarray(trace.pose)
    return slice(int(np.searchsorted(pose, pose[0], "right")) - 1, int(np.searchsorted(pose, pose[-1])) + 1)


def post_for(suffix: str, cell: Cell) -> Post:
    """How the cell's language is written. Error when it cannot be, or not in a file of that extension."""
    post = POSTS.get(cell.language)
    if post is None:
        raise Error(
            f"no program can be written in {cell.language!r}, the language of cell {cell.name}; "
            f"known: {', '.join(POSTS)}",
            where="language",
        )
    if suffix not in post.extensions:
        other = cells_for(suffix)
        raise Error(
            f"the extension {suffix!r} is neither .json, for a plan, nor {' or '.join(post.extensions)}, for "
            f"{post.title}, which cell {cell.name} speaks"
            + (f"; for {suffix} give --cell {' or '.join(other)}" if other else "")
        )
    return post


def cells_for(suffix: str) -> list[str]:
    """Names of the cells that come along whose programs have this extension."""
    languages = {name for name, post in POSTS.items() if suffix in post.extensions}
    return [name for name in cell_names() if find_cell(name).language in languages]


def encode(
    suffix: str, plan, brush, title: str, notes=(), cell: Cell | None = None, job: Job = WHOLE_JOB
) -> bytes | Iterator[str]:
    """The plan as the bytes of a plan.json or a program in the cell's language, in pieces, by the file's extension.

    Error for any other extension, and for a program where a limit of brush or cell is broken.
    """
    if suffix == ".json":
        return _core.write_plan(plan).encode()
    cell = cell or find_cell()
    post = post_for(suffix, cell)
    plan = in_loads(plan, brush, cell)
    job = replace(job, visits=visits(plan, cell, job.first_stroke))
    made = _held(program(plan, brush, cell, (), job), plan)
    header = header_of(title or "untitled", brush.name, plan, notes, made, job)
    return text_of(post, replace(made, header=header))


def header_of(title: str, brush: str, plan, notes, made: Program, job: Job) -> tuple[str, ...]:
    """The header of a program made of a plan in loads; its passes before the first one of the job are only counted."""
    return (
        f"title: {title}",
        f"brush: {brush}, {len(plan.passes)} strokes",
        _sheet_line(plan.sheet_mm),
        *notes,
        *([f"resumed: from stroke {job.first_stroke}"] if job.first_stroke > 1 else []),
        *about(made, job),
        f"length: {painting_mm(made):.0f} mm on the paper",
    )


def border_header(
    title: str, brush: str, count: int, sheet_mm, notes, around_mm, made: Program, job: Job
) -> tuple[str, ...]:
    """The header of an air run round (left, bottom, right, top) [mm] of a job of so many strokes."""
    left, bottom, right, top = around_mm
    return (
        f"title: {title}",
        f"brush: {brush}, {count} strokes",
        _sheet_line(sheet_mm),
        *notes,
        f"border: {left:.2f} to {right:.2f} mm, {bottom:.2f} to {top:.2f} mm",
        *about(made, job),
    )


def height_header(brush: str, sheet_mm, heights_mm, made: Program) -> tuple[str, ...]:
    """The header of strokes from the highest to the lowest height [mm], a step apart."""
    return (
        "title: how high the paper lies",
        f"brush: {brush}, {sum(1 for _ in made.sections())} strokes",
        _sheet_line(sheet_mm),
        "heights: {:.10g} to {:.10g} mm, {:.10g} mm apart".format(*heights_mm),
        *about(made),
    )


def _sheet_line(sheet_mm) -> str:
    return "sheet: {:g} x {:g} mm".format(*sheet_mm)


def _held(made: Program, plan) -> Program:
    """The program with its sections made once, where that is little: they are walked for the time and for the text."""
    if sum(len(a_pass.poses_mm) for a_pass in plan.passes) > POSES_AT_ONCE:
        return made
    sections = tuple(made.sections())
    return replace(made, sections=lambda: iter(sections))


def about(made: Program, job: Job = WHOLE_JOB) -> list[str]:
    """Lines of a header that every program has: machine, frame, time."""
    lines = [
        f"cell: {made.cell.name}, {made.cell.language}",
        _frame_line(made),
        f"time: about {clock(duration_s(made))}",
    ]
    if job.z_offset_mm:
        lines.append(f"paper: {job.z_offset_mm:+.10g} mm against the cell's")
    if made.cell.paper.example:
        lines.append("caution: the paper's place is the example of the cell file; teach yours")
    return lines


def _frame_line(made: Program) -> str:
    paper = made.cell.paper
    at_origin = not (paper.taught_mm or any(paper.origin_mm) or any(paper.rotation_deg))
    if at_origin or not POSTS[made.cell.language].in_robot_frame:
        return "frame: the sheet's lower left corner, mm; z 0 touches"
    x, y, z = made.robot_from_frame[:3, 3]
    return f"frame: the machine's, mm; sheet's corner at {x:.1f} {y:.1f} {z:.1f}"


def text_of(post: Post, made: Program) -> Iterator[str]:
    """The program in a robot's language, in pieces."""
    return post.write(in_robot_frame(made) if post.in_robot_frame else made)


def whole_program(plan, brush, cell: Cell, job: Job = WHOLE_JOB) -> Program:
    """All that the machine does with a plan in loads, paint included, for who only looks: limits are not asked."""
    job = replace(job, visits=visits(plan, cell, job.first_stroke))
    return unchecked_program(plan, brush, cell, (), job)


def time_s(plan, brush, cell: Cell, job: Job = WHOLE_JOB) -> float:
    """Estimated time of the plan, paint included; limits are not looked at."""
    return duration_s(whole_program(in_loads(plan, brush, cell), brush, cell, job))


def write_program(path: str | os.PathLike, plan, brush, title: str = "", cell: Cell | None = None) -> None:
    """Write a plan as plan.json or a program in the cell's language, by the extension of path.

    Error, and nothing written, when paint leaves the sheet or a limit of brush or cell is broken.
    """
    cell = as_exact_as(cell or find_cell(), DEFAULT_TOLERANCE_MM)
    suffix = Path(path).suffix.lower()
    for where, sentence in problems(plan, brush, _core.simulate(plan, brush), cell, DEFAULT_TOLERANCE_MM):
        raise Error(sentence, where=where)
    write_files({path: encode(suffix, plan, brush, title, cell=cell)})
