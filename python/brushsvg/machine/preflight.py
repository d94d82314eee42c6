"""Check a plan before it is run: limits, the sheet, cut corners and rounding."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from .. import _core
from ..errors import Error, Notice
from .cells.cell import Cell, unit_mm
from .job_program import WHOLE_JOB, CheckedProgram, Job, find_moves_out_of_arm, make_checked_program, make_written_form
from .limits.paint_on_sheet import find_paint_off_sheet
from .paint_reload import PlanInLoads
from .realised.corner_blending import blend_radii, cut_corners
from .realised.distortion import true_pass
from .realised.rounding import Written
from .tool_axes import interpolate_axes

DEFAULT_TOLERANCE_MM = 0.05
# Number of poses that one call to numpy handles. It limits the memory for plans of any size.
MAX_POSES_AT_ONCE = 100_000


def report_other_brush(plan: _core.Plan, brush: _core.Brush) -> list[Notice]:
    """Return a notice if a plan was made for another brush, or with another file of this brush."""
    if brush.name != plan.brush:
        where, sentence = "brush", f"the plan was made for brush {plan.brush}, not for {brush.name}"
    elif plan.brush_sha256 and brush.sha256 and plan.brush_sha256 != brush.sha256:
        where, sentence = "brush_sha256", f"the plan was made with another file of brush {brush.name}"
    else:
        return []
    return [Notice(where, sentence, code="plan-of-other-brush")]


def check_job(
    loads: PlanInLoads,
    brush: _core.Brush,
    marks: _core.Marks,
    cell: Cell,
    tolerance_mm: float,
    job: Job = WHOLE_JOB,
    walk: CheckedProgram | None = None,
    of_drawing: bool = True,
    with_advice: bool = True,
) -> CheckedProgram:
    """Check a job and return it with every reason not to run it on the robot.

    marks: marks of the plan or of its loads. Of a resumed job, only the rest is checked.
    walk: the result of check_limits, if it is known already.
    of_drawing: see find_paint_off_sheet.
    with_advice: see find_moves_out_of_arm.
    """
    walk = walk or check_limits(loads, brush, marks, cell, job, of_drawing)
    left_loads = loads.left(job.first_stroke) if job.first_stroke > 1 else loads
    if job.first_stroke > 1 and not left_loads.loads:
        return walk
    limit_problems = walk.problems or find_moves_out_of_arm(walk.made, left_loads.sheet_mm, with_advice)
    # In this case, the program was checked for the paper's place in the cell.
    is_paper_unchanged = walk.made.cell is cell and not job.z_offset_mm
    written = walk.written if is_paper_unchanged else make_written_form(loads, cell, WHOLE_JOB)
    return replace(
        walk,
        problems=limit_problems or find_blend_shifts(loads, brush, cell, tolerance_mm, job.first_stroke, written),
    )


def check_limits(
    loads: PlanInLoads,
    brush: _core.Brush,
    marks: _core.Marks,
    cell: Cell,
    job: Job = WHOLE_JOB,
    of_drawing: bool = True,
) -> CheckedProgram:
    """Check a job for broken limits and marks that cross the sheet's edges."""
    walk = make_checked_program(loads, brush, cell, job)
    if job.first_stroke > 1:
        loads = loads.left(job.first_stroke)
        if not loads.loads:
            return walk
        marks = _core.simulate(loads.as_plan(), brush)
    return replace(walk, problems=walk.problems + find_paint_off_sheet(marks, brush, loads.sheet_mm, of_drawing))


def as_exact_as(cell: Cell, tolerance_mm: float) -> Cell:
    """Return the cell with corners cut by at most a fifth of a plan's tolerance.

    The cuts must not use up the tolerance. They are also limited to MAX_AIR_CUT_MM, because the tool would otherwise
    begin to move sideways well below the safe height.
    """
    cut_mm = min(cell.blending.tolerance_mm, tolerance_mm / 5, MAX_AIR_CUT_MM)
    return replace(cell, blending=replace(cell.blending, tolerance_mm=cut_mm))


# Largest cut of a corner in the air. The tool leaves a right angle 0.04 / tan(22.5 degrees) = 0.1 mm before it.
MAX_AIR_CUT_MM = 0.04


def check_rounding(cell: Cell, tolerance_mm: float) -> None:
    """Raise Error if the units of the cell's language are too coarse.

    The limit is a fifth of a plan's tolerance, or a quarter if the language has a unit of its own.
    """
    rounded_mm, share = 0.5 * unit_mm(cell), "a fifth"
    max_mm = tolerance_mm / 5
    if has_own_unit := unit_mm(cell) != 10.0**-cell.decimals:
        max_mm, share = tolerance_mm / 4, "a quarter"
    if rounded_mm > max_mm + 1e-9:
        units = f"units of {unit_mm(cell):g} mm" if has_own_unit else f"{cell.decimals} decimals"
        raise Error(
            f"{units} of cell {cell.name} round places by up to {rounded_mm:g} mm, outside the "
            f"range [0, {max_mm:g}] mm, {share} of the tolerance",
            where="" if has_own_unit else "decimals",
            code="decimals-too-few",
        )


def find_blend_shifts(
    loads: PlanInLoads,
    brush: _core.Brush,
    cell: Cell,
    tolerance_mm: float,
    first_stroke: int,
    written: Callable[[int], Written],
) -> list[Notice]:
    """Report strokes whose marks move too far when corners are cut.

    A mark may move by the tolerance.

    The path with cut corners is simulated. Its widest section is compared with the plan where the brush is taut.

    first_stroke: number of the first stroke to check.
    written: returns the written form of each load, by its number.
    """
    if not cell.blending.tolerance_mm:
        return []
    # Marks are straight between rows. Rows further apart than the tolerance allows would compare chords.
    rows_mm = min(tolerance_mm / 10, MAX_ROW_SPACING_MM)
    notices = []
    commanded_passes = [
        _commanded_pass(a_pass, written(number), cell)
        for number, a_pass in enumerate(loads.loads, 1)
        if number >= first_stroke
    ]
    for first, last in _group_passes(commanded_passes):
        runs = as_run(commanded_passes[first:last], lambda poses, arcs: blend_radii(poses, cell.blending, arcs))
        pairs = zip(commanded_passes[first:last], runs, strict=True)
        blended_runs = [(a_pass, *run) for a_pass, run in pairs if len(run[1]) > len(a_pass.poses_mm)]
        planned_and_blended = [a_pass for a_pass, _, _ in blended_runs] + [run for _, run, _ in blended_runs]
        traces = _core.simulate(
            _core.Plan(sheet_mm=loads.sheet_mm, passes=planned_and_blended),
            brush,
            rows_mm,
            for_outlines=False,
        ).passes
        for (a_pass, _, at), planned_trace, run in zip(
            blended_runs, traces[: len(blended_runs)], traces[len(blended_runs) :], strict=True
        ):
            shift_mm = _largest_shift_mm(planned_trace, run, at, brush)
            if shift_mm > tolerance_mm:
                sentence = (
                    f"cutting corners by up to {cell.blending.tolerance_mm:g} mm, as cell {cell.name} does, moves the "
                    f"mark by {shift_mm:.3g} mm, outside the range [0, {tolerance_mm:g}] mm of the tolerance"
                )
                notices.append(Notice(a_pass.stroke, sentence, code="shifted-by-blends"))
    return notices


MAX_ROW_SPACING_MM = 0.02  # largest spacing of the rows of a mark, also for a coarse tolerance


def _commanded_pass(a_pass, written: Written, cell: Cell):
    """Return a pass with the poses and circles of its program, but not rounded."""
    axes = np.zeros((0, 3)) if written.axes is None else written.axes
    commanded = _core.Pass(a_pass.stroke, written.commanded_mm, a_pass.speed_mm_s, arcs=written.arcs, tool_axes=axes)
    return true_pass(commanded, cell)


def _group_passes(passes) -> Iterator[tuple[int, int]]:
    """Yield the range (first, end) of each group of passes that is handled at once."""
    first, poses = 0, 0
    for number, a_pass in enumerate(passes):
        if poses and poses + len(a_pass.poses_mm) > MAX_POSES_AT_ONCE:
            yield first, number
            first, poses = number, 0
        poses += len(a_pass.poses_mm)
    yield first, len(passes)


def as_run(passes, radii_of: Callable[[np.ndarray, list], np.ndarray]) -> list[tuple]:
    """Cut the corners of passes.

    radii_of: maps poses (n, 3) and arcs to the blend radius of each corner, see blend_radii.

    Returns the pass with cut corners for each pass. It also returns the planned pose of each point of the path, as a
    fractional index.
    """
    starts = np.cumsum([0, *(len(a_pass.poses_mm) for a_pass in passes)]).tolist()
    poses = np.vstack([a_pass.poses_mm for a_pass in passes])
    arcs = [
        _core.Arc(arc.first + start, arc.last + start, arc.centre_mm, arc.direction)
        for a_pass, start in zip(passes, starts[:-1], strict=True)
        for arc in a_pass.arcs
    ]
    radii = radii_of(poses, arcs)
    radii[starts[:-1]] = radii[[start - 1 for start in starts[1:]]] = 0.0  # no path continues into the next
    path, at, points = cut_corners(poses, radii, arcs)
    runs = []
    for a_pass, start, end in zip(passes, starts[:-1], starts[1:], strict=True):
        first, last = points[start, 0], points[end - 1, 1] + 1
        rows = points[start:end] - first
        arcs = [_core.Arc(rows[arc.first, 1], rows[arc.last, 0], arc.centre_mm, arc.direction) for arc in a_pass.arcs]
        rows_at, axes = at[first:last] - start, np.asarray(a_pass.tool_axes)
        if len(axes):  # the brush turns along the cut as it does along the moves
            axes = interpolate_axes(axes, rows_at)
        run = _core.Pass(a_pass.stroke, path[first:last], a_pass.speed_mm_s, arcs=arcs, tool_axes=axes)
        runs.append((run, rows_at))
    return runs


def _largest_shift_mm(planned_trace, run, at: np.ndarray, brush) -> float:
    """Return the largest distance [mm] of the widest sections of two traces.

    Both traces are of one stroke.

    at: planned pose of each pose that is run, as a fractional index.
    """
    run_rows, planned_rows = _moving_rows(run), _moving_rows(planned_trace)
    taut = np.asarray(run.taut, dtype=bool)[run_rows]
    if not taut.any():
        return 0.0
    pose = np.interp(np.asarray(run.pose)[run_rows][taut], np.arange(len(at)), at)
    widest_of_plan = _core.widest_points(planned_trace, brush)[planned_rows]
    planned_widest = np.column_stack(
        [np.interp(pose, np.asarray(planned_trace.pose)[planned_rows], axis) for axis in widest_of_plan.T]
    )
    return float(np.linalg.norm(_core.widest_points(run, brush)[run_rows][taut] - planned_widest, axis=1).max())


def _moving_rows(trace) -> slice:
    """Return the rows of a trace between its landing and its lift.

    All rows of a landing or lift on the spot have the same pose, so no place can be found for them.
    """
    pose = np.asarray(trace.pose)
    return slice(int(np.searchsorted(pose, pose[0], "right")) - 1, int(np.searchsorted(pose, pose[-1])) + 1)
