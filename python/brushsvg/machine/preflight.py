"""What forbids to run a plan on a machine: limits, the sheet, corners that are cut, rounding."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from .. import _core
from ..errors import Error, Notice
from .cells.cell import Cell, unit_mm
from .paint_reload import PlanInLoads
from .program import MAX_POSES_AT_ONCE, WHOLE_JOB, Job, Walked, check_job, out_of_arm, written_of
from .realised.arc_chords import with_chords
from .realised.corner_blending import blend_radii, blended
from .realised.distortion import true_pass
from .realised.rounding import Written
from .tool_axes import mixed
from .workspace_limits import beyond_edges

DEFAULT_TOLERANCE_MM = 0.05


def look(
    loads: PlanInLoads,
    brush: _core.Brush,
    marks: _core.Marks,
    cell: Cell,
    tolerance_mm: float,
    job: Job = WHOLE_JOB,
    walk: Walked | None = None,
    of_drawing: bool = True,
) -> Walked:
    """The job with everything that forbids to run it on the robot. marks: of the plan or of its loads; of a job that
    is resumed only the rest is checked. walk: what within_limits found of it, where that is known. of_drawing: see
    off_sheet."""
    walk = walk or within_limits(loads, brush, marks, cell, job, of_drawing)
    left = loads.left(job.first_stroke) if job.first_stroke > 1 else loads
    if job.first_stroke > 1 and not left.loads:
        return walk
    found = walk.problems or out_of_arm(walk.made, left.sheet_mm)
    is_known = walk.made.cell is cell and not job.z_offset_mm  # checked for the paper where the cell has it
    written = walk.written if is_known else written_of(loads, cell, WHOLE_JOB)
    return replace(
        walk, problems=found or shifted_by_blends(loads, brush, cell, tolerance_mm, job.first_stroke, written)
    )


def within_limits(
    loads: PlanInLoads,
    brush: _core.Brush,
    marks: _core.Marks,
    cell: Cell,
    job: Job = WHOLE_JOB,
    of_drawing: bool = True,
) -> Walked:
    """The job with the limits that it breaks and the edges of the sheet that its marks cross."""
    walk = check_job(loads, brush, cell, job)
    if job.first_stroke > 1:
        loads = loads.left(job.first_stroke)
        if not loads.loads:
            return walk
        marks = _core.simulate(loads.as_plan(), brush)
    return replace(walk, problems=walk.problems + off_sheet(marks, brush, loads.sheet_mm, of_drawing))


def as_exact_as(cell: Cell, tolerance_mm: float) -> Cell:
    """The cell, cutting corners by at most a fifth of a plan's tolerance: they must not use it up. Nor by more than
    CUT_IN_AIR_MM, or the tool would begin to go sideways well below the safe height."""
    cut_mm = min(cell.blending.tolerance_mm, tolerance_mm / 5, CUT_IN_AIR_MM)
    return replace(cell, blending=replace(cell.blending, tolerance_mm=cut_mm))


CUT_IN_AIR_MM = (
    0.04  # a right angle that is cut by so much is left 0.04 / tan(22.5 degrees) = 0.1 mm before it
)


def check_rounding(cell: Cell, tolerance_mm: float) -> None:
    """Error where the units of the cell's language alone move places by more than a fifth of a plan's tolerance, or a
    quarter where they are the language's own."""
    rounded_mm, part = 0.5 * unit_mm(cell), "a fifth"
    most_mm = tolerance_mm / 5
    if own := unit_mm(cell) != 10.0**-cell.decimals:
        most_mm, part = tolerance_mm / 4, "a quarter"
    if rounded_mm > most_mm + 1e-9:
        units = f"units of {unit_mm(cell):g} mm" if own else f"{cell.decimals} decimals"
        raise Error(
            f"{units} of cell {cell.name} round places by up to {rounded_mm:g} mm, outside the "
            f"range [0, {most_mm:g}] mm, {part} of the tolerance",
            where="" if own else "decimals",
            code="decimals-too-few",
        )


def off_sheet(
    marks: _core.Marks, brush: _core.Brush, sheet_mm, of_drawing: bool = True, rounded_mm: float = 0.0
) -> list[Notice]:
    """A notice of the stroke for each side of the sheet [mm] that a stroke's paint crosses. of_drawing: whether it was
    made of one, which flags arrange anew; they have no effect on a plan. rounded_mm: the shift of the tool from its
    plan by rounding alone: it may move an edge so much more."""
    found = []
    advice = (
        "move the drawing or make room with --origin X,Y, --sheet WxH or --fit WxH"
        if of_drawing
        else "make the plan anew, from a drawing that is moved or has more room"
    )
    for trace in marks.passes:
        bounds_mm = _core.painted_bounds(trace, brush)
        if not np.isfinite(bounds_mm).all():
            continue  # nothing touches the paper
        found += [
            Notice(
                trace.stroke,
                f"the mark reaches {beyond:.2f} mm beyond the {side} edge of the sheet",
                code="mark-off-sheet",
                about=side,
                advice=advice,
            )
            for side, beyond in beyond_edges(bounds_mm, sheet_mm).items()
            if beyond >= 0.005 + _LEVER * rounded_mm  # what would print as 0.00 mm is rounding, not paint
        ]
    return found


_LEVER = 5.0  # times as far as a tool is moved an edge of its mark moves at most: a lag grows by 3 mm per mm of depth


def bounds_mm(marks: _core.Marks, brush: _core.Brush) -> tuple[float, float, float, float]:
    """Left, bottom, right, top of all paint. Error when nothing touches the paper."""
    bounds = np.array([_core.painted_bounds(trace, brush) for trace in marks.passes]).reshape(-1, 4)
    bounds = bounds[np.isfinite(bounds).all(axis=1)]
    if not len(bounds):
        raise Error("nothing touches the paper: there is no border", code="nothing-painted")
    return (*bounds[:, :2].min(axis=0).tolist(), *bounds[:, 2:].max(axis=0).tolist())


def job_bounds_mm(
    plan: _core.Plan, marks: _core.Marks, brush: _core.Brush
) -> tuple[float, float, float, float]:
    """Left, bottom, right, top of all paint and of the path of the tool, which leads into strokes from outside them.
    Error when nothing touches the paper."""
    left, bottom, right, top = bounds_mm(marks, brush)
    path_mm = np.vstack([with_chords(a_pass).poses_mm[:, :2] for a_pass in plan.passes])
    (x0, y0), (x1, y1) = path_mm.min(axis=0).tolist(), path_mm.max(axis=0).tolist()
    return (min(left, x0), min(bottom, y0), max(right, x1), max(top, y1))


def shifted_by_blends(
    loads: PlanInLoads,
    brush: _core.Brush,
    cell: Cell,
    tolerance_mm: float,
    first_stroke: int,
    written: Callable[[int], Written],
) -> list[Notice]:
    """A notice of the stroke where cutting corners as the cell does moves the mark by more than the tolerance, from one
    stroke on. written: what a program has of each load, by its number.

    The path as it is run is simulated, and where the brush is taut its widest section compared with the plan.
    """
    if not cell.blending.tolerance_mm:
        return []
    # marks are straight between rows: as close as the tolerance asks, or it is their chords that are compared
    rows_mm = min(tolerance_mm / 10, ROWS_MM)
    found = []
    as_written = [
        _as_commanded(a_pass, written(number), cell)
        for number, a_pass in enumerate(loads.loads, 1)
        if number >= first_stroke
    ]
    for first, last in _groups(as_written):
        runs = as_run(as_written[first:last], lambda poses, arcs: blend_radii(poses, cell.blending, arcs))
        pairs = zip(as_written[first:last], runs, strict=True)
        cut = [(a_pass, *run) for a_pass, run in pairs if len(run[1]) > len(a_pass.poses_mm)]
        both = [a_pass for a_pass, _, _ in cut] + [run for _, run, _ in cut]
        traces = _core.simulate(
            _core.Plan(sheet_mm=loads.sheet_mm, passes=both), brush, rows_mm, for_outlines=False
        ).passes
        for (a_pass, _, at), planned_trace, run in zip(
            cut, traces[: len(cut)], traces[len(cut) :], strict=True
        ):
            shift_mm = _largest_shift_mm(planned_trace, run, at, brush)
            if shift_mm > tolerance_mm:
                sentence = (
                    f"cutting corners by up to {cell.blending.tolerance_mm:g} mm, as cell {cell.name} does, moves the "
                    f"mark by {shift_mm:.3g} mm, outside the range [0, {tolerance_mm:g}] mm of the tolerance"
                )
                found.append(Notice(a_pass.stroke, sentence, code="shifted-by-blends"))
    return found


ROWS_MM = 0.02  # rows of a mark are as close as that: a coarse tolerance is no reason to look less closely


def _as_commanded(a_pass, written: Written, cell: Cell):
    """With the poses and circles that a program has, not rounded."""
    axes = np.zeros((0, 3)) if written.axes is None else written.axes
    commanded = _core.Pass(
        a_pass.stroke, written.commanded_mm, a_pass.speed_mm_s, arcs=written.arcs, tool_axes=axes
    )
    return true_pass(commanded, cell)


def _groups(passes) -> Iterator[tuple[int, int]]:
    """First and last of passes that are handled at once."""
    first, poses = 0, 0
    for number, a_pass in enumerate(passes):
        if poses and poses + len(a_pass.poses_mm) > MAX_POSES_AT_ONCE:
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
        rows_at, axes = at[first:last] - start, np.asarray(a_pass.tool_axes)
        if len(axes):  # turned on along with the cut as with its moves
            axes = mixed(axes, rows_at)
        run = _core.Pass(a_pass.stroke, path[first:last], a_pass.speed_mm_s, arcs=arcs, tool_axes=axes)
        runs.append((run, rows_at))
    return runs


def _largest_shift_mm(planned_trace, run, at: np.ndarray, brush) -> float:
    """Return the distance between the widest sections of two traces of one stroke; at: the planned pose of each pose
    that was run."""
    ran, planned = _under_way(run), _under_way(planned_trace)
    taut = np.asarray(run.taut, dtype=bool)[ran]
    if not taut.any():
        return 0.0
    pose = np.interp(np.asarray(run.pose)[ran][taut], np.arange(len(at)), at)
    widest = _core.widest_points(planned_trace, brush)[planned]
    there = np.column_stack(
        [np.interp(pose, np.asarray(planned_trace.pose)[planned], axis) for axis in widest.T]
    )
    return float(np.linalg.norm(_core.widest_points(run, brush)[ran][taut] - there, axis=1).max())


def _under_way(trace) -> slice:
    """The rows from where the brush was set down to where it is lifted: all rows of a landing or lift on the spot are
    of one pose, by which no place can be found."""
    pose = np.asarray(trace.pose)
    return slice(int(np.searchsorted(pose, pose[0], "right")) - 1, int(np.searchsorted(pose, pose[-1])) + 1)
