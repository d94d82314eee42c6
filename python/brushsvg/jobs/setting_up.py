"""Write the programs that are run before a job: its border, the first run of a machine, the height of the paper.

These are the steps of `brushsvg setup`, which Python users can call as well.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from .. import _core
from ..errors import Notice, name_file_in_errors, need_number, require_type
from ..files import write_files
from ..machine import header_lines, preflight, setup_programs, writer
from ..machine.cells.cell import Cell
from ..machine.job_program import Job
from ..machine.leftover_programs import report_leftover_programs
from ..machine.limits.paint_on_sheet import job_bounds_mm
from ..machine.moves import Program, duration_s
from ..machine.paint_reload import split_into_loads
from ..machine.posts import Post
from ..model.library import find_brush
from . import outputs, prediction
from .choices.choice_checks import check_choices, refuse_file_used_twice
from .choices.choices import ChoiceKeywords, Choices, path_of, suffix_of
from .choices.drawing_settings import fill_from_drawing
from .choices.ineffective_flags import report_ineffective_flags
from .conversion import default_suffix, make_choices
from .options import DEFAULT_BRUSH, load_brush, load_cell, make_options
from .preparation import preparation

if TYPE_CHECKING:
    from .preparation.preparation import Source

Warn = Callable[[str, list[Notice]], object]
DEFAULT_SHEET_MM = (200.0, 100.0)
DEFAULT_HEIGHTS_MM = (1.0, -1.0, 0.1)  # first, last, step
HEIGHT_RANGE_MM, STEP_RANGE_MM = (-20.0, 20.0), (0.01, 5.0)


@dataclass(frozen=True)
class SetupProgram:
    """A program that is run before a job.

    text: the program in the language of the machine, with all its files; bytes for a binary format (".cdr").
    time_s: how long the machine takes.
    stroke_count: the number of strokes that it paints.
    notices: warnings, none of which forbids running the program.
    """

    text: str | bytes = field(repr=False)
    time_s: float
    stroke_count: int = 0
    notices: tuple[Notice, ...] = ()


def setup_border(
    drawing: Source,
    out: str | os.PathLike[str] | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> SetupProgram:
    """Make the tool go round a job in the air, as `brushsvg setup border` does.

    The border is round all paint and the path of the tool, at the safe height.

    drawing: what will be painted, as `convert` takes it.
    out: the path of the program, if it is to be written.
    choices: as for `convert`.

    Raises Error for a drawing that cannot be painted, and if the tool would leave the workspace.
    """
    chosen = make_choices(drawing, choices)
    return _write(chosen, out, lambda path, warn: make_border(chosen, path, warn=warn))


def setup_first_run(
    cell: str | os.PathLike[str] | Cell,
    out: str | os.PathLike[str] | None = None,
    *,
    brush: str | os.PathLike[str] | _core.Brush | None = None,
    sheet: tuple[float, float] | None = None,
) -> SetupProgram:
    """Make a slow, careful program for a new machine, as `brushsvg setup first-run` does.

    The tool goes round the sheet in the air, touches the paper at four points, and paints strokes. It waits for a
    person before each of these steps.

    out: the path of the program, if it is to be written.
    brush: round-6 by default.
    sheet: width and height [mm], 200 x 100 by default.

    Raises Error if the machine cannot wait for a person, or would leave the workspace or the sheet.
    """
    chosen = check_choices(Choices(cell=cell, brush=brush, sheet=sheet))
    return _write(chosen, out, lambda path, warn: make_first_run(chosen, path, warn))


def setup_height(
    cell: str | os.PathLike[str] | Cell | None = None,
    out: str | os.PathLike[str] | None = None,
    *,
    brush: str | os.PathLike[str] | _core.Brush | None = None,
    sheet: tuple[float, float] | None = None,
    highest: float = DEFAULT_HEIGHTS_MM[0],
    lowest: float = DEFAULT_HEIGHTS_MM[1],
    step: float = DEFAULT_HEIGHTS_MM[2],
) -> SetupProgram:
    """Paint strokes that show how high the paper is, as `brushsvg setup height` does.

    out: the path of the program, if it is to be written.
    brush: round-6 by default.
    sheet: width and height [mm], 200 x 100 by default.
    highest, lowest: heights of the first and the last stroke over the paper [mm].
    step: difference of the heights of neighbouring strokes [mm].

    Raises Error if the strokes do not fit on the sheet, or go deeper than the brush or the machine allows.
    """
    chosen = check_choices(Choices(cell=cell, brush=brush, sheet=sheet))
    heights_mm = (
        need_number(highest, "highest [mm]", *HEIGHT_RANGE_MM),
        need_number(lowest, "lowest [mm]", *HEIGHT_RANGE_MM),
        need_number(step, "step [mm]", *STEP_RANGE_MM),
    )
    return _write(chosen, out, lambda path, warn: make_height(chosen, heights_mm, path, warn))


def _write(
    chosen: Choices, out: str | os.PathLike[str] | None, make: Callable[[str | None, Warn], SetupProgram]
) -> SetupProgram:
    """Make a program, write it if it has a path, and add the notices."""
    if out is not None:
        require_type(out, (str, os.PathLike), "a path", "out")
    refuse_file_used_twice(chosen, [out])
    path, notices = None if out is None else os.fspath(out), []
    made = make(path, lambda _, some: notices.extend(some))
    if path is not None:
        files = writer.in_files(path, made.text)
        notices += report_leftover_programs(path, files)
        write_files(files)
    return replace(made, notices=tuple(notices))


def make_border(
    chosen: Choices,
    path: str | None,
    stage: Callable[[str], object] = lambda text: None,
    warn: Warn = lambda file, notices: None,
) -> SetupProgram:
    """Make the border of a job, and report notices with their file as soon as they are known.

    path: the path of the program; None for a program with the extension of the cell.
    """
    file = path_of(chosen.input)
    with name_file_in_errors(file):
        chosen = fill_from_drawing(chosen, chosen.input)
        warn(file, report_ineffective_flags(chosen))
        work = preparation.prepare(chosen.input, make_options(chosen), stage)
        brush, cell, plan = work.brush, work.options.cell, work.plan
        loads, marks = split_into_loads(plan, brush, cell), prediction.predict(work, False, stage)
        is_drawing, tolerance_mm, job = work.strokes is not None, work.options.tolerance_mm, Job(chosen.z_offset or 0.0)
        walk = preflight.check_job(loads, brush, marks, cell, tolerance_mm, job, work.walk(cell, job), is_drawing)
        warn(file, [*work.notices, *(replace(problem, refused=True) for problem in walk.problems)])
        suffix, post = _find_post(path, cell)
        around_mm = setup_programs.round_outwards(job_bounds_mm(plan, marks, brush))
        program = setup_programs.make_border_program(around_mm, brush, cell, plan.sheet_mm, job.z_offset_mm)
        title = f"border of {work.title or 'untitled'}"
        notes = outputs.header_lines(work)
        header = header_lines.border_header(
            title, brush.name, len(plan.passes), plan.sheet_mm, notes, around_mm, program, job
        )
        text = _text_of(post, program, header, path, suffix, warn)
    warn(cell.name, writer.list_cell_notices(cell))
    return SetupProgram(text, duration_s(program))


def make_first_run(chosen: Choices, path: str | None, warn: Warn = lambda file, notices: None) -> SetupProgram:
    """Make the first program of a machine, with the default heights, and report notices.

    chosen: cell, brush and sheet.
    """
    cell, brush, sheet_mm = _load_cell_and_brush(chosen)
    suffix, post = _find_post(path, cell)
    with name_file_in_errors(cell.name):
        program = setup_programs.make_first_run_program(brush, cell, sheet_mm, *DEFAULT_HEIGHTS_MM)
        header = header_lines.first_header(brush.name, sheet_mm, DEFAULT_HEIGHTS_MM, program)
        text = _text_of(post, program, header, path, suffix, warn)
    warn(cell.name, writer.list_cell_notices(cell))
    warn(cell.name, setup_programs.report_missing_air_run(cell, sheet_mm))
    count = len(setup_programs.stroke_heights_mm(*DEFAULT_HEIGHTS_MM)) + 1
    return SetupProgram(text, duration_s(program), count)


def make_height(
    chosen: Choices, heights_mm: tuple[float, float, float], path: str | None, warn: Warn = lambda file, notices: None
) -> SetupProgram:
    """Make strokes at heights from the first to the last, by a step, and report notices.

    chosen: cell, brush and sheet.
    """
    cell, brush, sheet_mm = _load_cell_and_brush(chosen)
    suffix, post = _find_post(path, cell)
    with name_file_in_errors(cell.name):
        program = setup_programs.make_height_program(brush, cell, sheet_mm, *heights_mm)
        header = header_lines.height_header(brush.name, sheet_mm, heights_mm, program)
        text = _text_of(post, program, header, path, suffix, warn)
    warn(cell.name, writer.list_cell_notices(cell))
    return SetupProgram(text, duration_s(program), len(setup_programs.stroke_heights_mm(*heights_mm)))


def _load_cell_and_brush(chosen: Choices) -> tuple[Cell, _core.Brush, tuple[float, float]]:
    """Return the cell, the brush and the size of the sheet [mm], the default ones where nothing was chosen."""
    cell = preflight.as_exact_as(load_cell(chosen.cell), preflight.DEFAULT_TOLERANCE_MM)
    return cell, load_brush(chosen.brush) or find_brush(DEFAULT_BRUSH), chosen.sheet or DEFAULT_SHEET_MM


def _find_post(path: str | None, cell: Cell) -> tuple[str, Post]:
    """Return the extension of a program, and the post that writes it."""
    suffix = default_suffix(cell) if path is None else suffix_of(path)
    with name_file_in_errors(path or ""):
        return suffix, writer.post_for(suffix, cell)


def _text_of(post: Post, program: Program, header: tuple[str, ...], path: str | None, suffix: str, warn: Warn):
    name = Path(path).stem if path else program.name
    warn(path or "", writer.report_renamed(name, suffix, program.cell))
    return writer.join_pieces(writer.text_of(post, replace(program, header=header, name=name), suffix))
