"""Check programs that run before a job: air runs, paper heights, first runs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import Notice
from ..machine.cells.cell import Cell
from ..machine.header_lines import border_header, first_header, height_header
from ..machine.job_program import Job
from ..machine.moves import Program, duration_s
from ..machine.realised.distortion import true_mm
from ..machine.setup_programs import (
    ONE_STROKE_DEPTH_MM,
    make_border_program,
    make_first_run_program,
    make_height_program,
)
from .against_regenerated import differing_line
from .readback import Readback
from .readback.header import ProgramHeader
from .simulate_program import Problems, slack_mm, walk_sections


@dataclass(frozen=True)
class SetupCheck:
    """Result of the check of a setup program.

    problems: one notice for each dangerous step; time_s: duration of the program [s].
    """

    problems: Problems
    time_s: float


def check_border(
    text: str, read: Readback, origin: ProgramHeader, brush, cell: Cell, sheet_mm, z_offset_mm: float
) -> SetupCheck:
    """Check an air run around the border that its header names. Raises Error when a corner is outside the workspace."""
    expected = make_border_program(origin.border_mm, brush, cell, sheet_mm, z_offset_mm)
    job, notes = Job(z_offset_mm), origin.notes
    header = border_header(origin.title, brush.name, origin.strokes, sheet_mm, notes, origin.border_mm, expected, job)
    expected = replace(expected, header=header)
    sections = [*walk_sections(read, brush, cell, sheet_mm, z_offset_mm)]
    return _check_setup_program(text, read, expected, sections, cell, cell.heights.safe_mm, "safe height")


def check_strokes(text: str, read: Readback, origin: ProgramHeader, brush, cell: Cell) -> SetupCheck:
    """Check a first run, or a program that finds the paper by strokes at several heights.

    Its header names the heights. Each of these strokes may be the first on the paper. Raises Error when the program
    leaves the workspace, does not fit on the sheet, or goes deeper than the brush or the cell allows.
    """
    sheet_mm, heights_mm = origin.sheet_mm, origin.first_mm or origin.heights_mm
    highest_mm, lowest_mm, _ = heights_mm
    make_program, make_header, limit_name = make_height_program, height_header, "height of the lowest stroke"
    if origin.first_mm:
        make_program, make_header, limit_name = make_first_run_program, first_header, "height of the deepest stroke"
        lowest_mm = min(lowest_mm, -ONE_STROKE_DEPTH_MM)
    expected = make_program(brush, cell, sheet_mm, *heights_mm)
    expected = replace(expected, header=make_header(brush.name, sheet_mm, heights_mm, expected))
    sections = [*walk_sections(read, brush, cell, sheet_mm, paper_mm=max(0.0, highest_mm))]
    return _check_setup_program(text, read, expected, sections, cell, lowest_mm, limit_name)


def _check_setup_program(
    text: str, read: Readback, expected: Program, sections, cell: Cell, lowest_mm: float, limit_name: str
) -> SetupCheck:
    problems: Problems = []
    for section, track, notices in sections:
        problems += [replace(each, where=section.title) for each in notices]
        heights = true_mm(track.points, cell.machine)[:, 2]
        lowest = int(np.argmin(heights)) if len(heights) else None
        if lowest is not None and heights[lowest] < lowest_mm - slack_mm(cell):
            line, height_mm = section.steps[track.step[lowest]].line, heights[lowest]
            sentence = f"line {line}: height {height_mm:.2f} mm is below the {limit_name}, {lowest_mm:g} mm"
            problems.append(Notice(section.title, sentence, code="too-low"))
    if changed := differing_line(text, read, expected, cell):
        problems.append(Notice("", changed, code="program-changed"))
    return SetupCheck(problems, duration_s(expected))
