"""Header lines of a program: its origin, its machine and its duration."""

from __future__ import annotations

from ..units import clock
from .job_program import WHOLE_JOB, Job
from .moves import Program, duration_s, painting_mm
from .paint_reload import PlanInLoads
from .posts import POSTS
from .posts.text import NAMED, plain_text

TILT_LINE = "tilt: the brush is held as each move says"


def header_of(title: str, brush: str, loads: PlanInLoads, notes, program: Program, job: Job) -> tuple[str, ...]:
    """Return the header of a program. Loads before the job's first stroke are only counted."""
    return (
        f"title: {title}",
        _brush_line(brush, len(loads.loads)),
        _sheet_line(loads.sheet_mm),
        *notes,
        *([f"resumed: from stroke {job.first_stroke}"] if job.first_stroke > 1 else []),
        *common_lines(program, job),
        f"length: {painting_mm(program):.0f} mm on the paper",
    )


def border_header(
    title: str, brush: str, count: int, sheet_mm, notes, around_mm, program: Program, job: Job
) -> tuple[str, ...]:
    """Return the header of an air run round a job.

    count: number of strokes of the job.
    around_mm: left, bottom, right and top of the job [mm].
    """
    left, bottom, right, top = around_mm
    return (
        f"title: {title}",
        _brush_line(brush, count),
        _sheet_line(sheet_mm),
        *notes,
        f"border: {left:.2f} to {right:.2f} mm, {bottom:.2f} to {top:.2f} mm",
        *common_lines(program, job),
    )


def height_header(brush: str, sheet_mm, heights_mm, program: Program) -> tuple[str, ...]:
    """Return the header of strokes that find the paper's height.

    heights_mm: highest height, lowest height and step [mm].
    """
    return (
        "title: height of the paper",
        _brush_line(brush, sum(1 for _ in program.sections())),
        _sheet_line(sheet_mm),
        "heights: {:.10g} to {:.10g} mm, {:.10g} mm apart".format(*heights_mm),
        *common_lines(program),
    )


def first_header(brush: str, sheet_mm, heights_mm, program: Program) -> tuple[str, ...]:
    """Return the header of a first run. heights_mm: highest height, lowest height and step of its strokes [mm]."""
    return (
        "title: first run",
        _brush_line(brush, sum(section.title.startswith("stroke ") for section in program.sections())),
        _sheet_line(sheet_mm),
        "first: heights {:.10g} to {:.10g} mm, {:.10g} mm apart".format(*heights_mm),
        *common_lines(program),
    )


def _brush_line(brush: str, count: int) -> str:
    """Return the line of brush and stroke count; only the name is cut, because check needs the number."""
    return f"brush: {plain_text(brush, NAMED)}, {count} strokes"


def _sheet_line(sheet_mm) -> str:
    return "sheet: {:g} x {:g} mm".format(*sheet_mm)


def common_lines(program: Program, job: Job = WHOLE_JOB) -> list[str]:
    """Return the header lines that every program has: machine, frame and time."""
    lines = [
        f"cell: {plain_text(program.cell.name, NAMED)}, {program.cell.language}",
        _frame_line(program),
        f"time: about {clock(duration_s(program))}",
    ]
    if program.tilts:
        lines.append(TILT_LINE)
    if job.z_offset_mm:
        lines.append(f"paper: {job.z_offset_mm:+.10g} mm against the cell's")
    if program.cell.paper.example:
        lines.append("caution: the paper's place is the example of the cell file; teach yours")
    return lines


def _frame_line(program: Program) -> str:
    paper = program.cell.paper
    at_origin = not (paper.taught_mm or any(paper.origin_mm) or any(paper.rotation_deg))
    if at_origin or not POSTS[program.cell.language].in_robot_frame:
        return "frame: the sheet's lower left corner, mm; z 0 touches"
    x, y, z = program.robot_from_frame[:3, 3]
    return f"frame: the machine's, mm; sheet's corner at {x:.1f} {y:.1f} {z:.1f}"
