"""Programs before the first stroke, looked at before a machine moves: air runs, and strokes that find the paper."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import Notice
from ..machine.cells.cell import Cell
from ..machine.header_lines import border_header, first_header, height_header
from ..machine.motion import Program, duration_s
from ..machine.program import Job
from ..machine.realised.distortion import true_mm
from ..machine.setup_programs import ONE_STROKE_DEPTH_MM, border, first_run, paper_height
from .against_regenerated import differing_line
from .readback import Readback
from .readback.header import Made
from .simulate_program import Problems, slack_mm, walked


@dataclass(frozen=True)
class Looked:
    """problems: a notice for each dangerous step; time_s: its duration."""

    problems: Problems
    time_s: float


def look_at_border(
    text: str, read: Readback, made: Made, brush, cell: Cell, sheet_mm, z_offset_mm: float
) -> Looked:
    """An air run round what its header says. Error when a corner is outside the workspace."""
    again = border(made.border_mm, brush, cell, sheet_mm, z_offset_mm)
    job, notes = Job(z_offset_mm), made.notes
    header = border_header(made.title, brush.name, made.strokes, sheet_mm, notes, made.border_mm, again, job)
    again = replace(again, header=header)
    sections = [*walked(read, brush, cell, sheet_mm, z_offset_mm)]
    return _looked(text, read, again, sections, cell, cell.heights.safe_mm, "safe height")


def look_at_heights(text: str, read: Readback, made: Made, brush, cell: Cell) -> Looked:
    """Strokes at the heights that its header says, each of which may be the first on the paper.

    Error when they do not fit on the sheet or go deeper than brush or cell allow.
    """
    sheet_mm = made.sheet_mm
    highest_mm, lowest_mm, step_mm = made.heights_mm
    again = paper_height(brush, cell, sheet_mm, highest_mm, lowest_mm, step_mm)
    again = replace(again, header=height_header(brush.name, sheet_mm, made.heights_mm, again))
    sections = [*walked(read, brush, cell, sheet_mm, paper_mm=max(0.0, highest_mm))]
    return _looked(text, read, again, sections, cell, lowest_mm, "height of the lowest stroke")


def look_at_first_run(text: str, read: Readback, made: Made, brush, cell: Cell) -> Looked:
    """A first run: the same for all that it does. Error when it leaves the workspace or does not fit on the sheet."""
    sheet_mm = made.sheet_mm
    highest_mm, lowest_mm, step_mm = made.first_mm
    again = first_run(brush, cell, sheet_mm, highest_mm, lowest_mm, step_mm)
    again = replace(again, header=first_header(brush.name, sheet_mm, made.first_mm, again))
    sections = [*walked(read, brush, cell, sheet_mm, paper_mm=max(0.0, highest_mm))]
    deepest_mm = min(lowest_mm, -ONE_STROKE_DEPTH_MM)
    return _looked(text, read, again, sections, cell, deepest_mm, "height of the deepest stroke")


def _looked(
    text: str, read: Readback, again: Program, sections, cell: Cell, lowest_mm: float, what: str
) -> Looked:
    problems: Problems = []
    for section, track, said in sections:
        problems += [replace(each, where=section.title) for each in said]
        heights = true_mm(track.points, cell.machine)[:, 2]
        at = int(np.argmin(heights)) if len(heights) else None
        if at is not None and heights[at] < lowest_mm - slack_mm(cell):
            line, height_mm = section.steps[track.step[at]].line, heights[at]
            sentence = f"line {line}: height {height_mm:.2f} mm is below the {what}, {lowest_mm:g} mm"
            problems.append(Notice(section.title, sentence, code="too-low"))
    if changed := differing_line(text, read, again, cell):
        problems.append(Notice("", changed, code="program-changed"))
    return Looked(problems, duration_s(again))
