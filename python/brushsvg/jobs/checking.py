"""Check a program: read it back, simulate it, and compare it with its target.

These are the steps of `brushsvg check`, which Python users can call as well. A program is compared with its brush,
its machine and its drawing.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from .. import _core
from ..comparison.corrections import is_corrected
from ..errors import Error, Notice, join_advice, name_file_in_errors, require_type
from ..files import read_bytes
from ..machine import preflight
from ..machine.cells.cell import Cell
from ..machine.cells.cell_file import cell_names
from ..machine.dry_brush import report_dry_brush
from ..machine.job_program import find_moves_out_of_arm
from ..machine.leftover_programs import read_if_possible
from ..machine.limits.paint_on_sheet import job_bounds_mm
from ..machine.moves import duration_s
from ..machine.paint_reload import split_into_loads
from ..machine.posts import GCODE, POSTS, Post
from ..machine.posts.text import NAMED, plain_text, spelled
from ..machine.setup_programs import round_outwards
from ..machine.writer import called_programs, list_arm_notices, parted_post, report_renamed
from ..model.library import brush_names, find_brush
from ..read import settings_in
from ..read.gcode import is_ours
from ..show.evaluation.report import Report
from ..verify import against_plan, against_regenerated, pauses_in_paint, setup_checks, simulate_program
from ..verify.foreign_program import simulate_foreign_program
from ..verify.readback import read_program, text_of_file
from ..verify.readback.header import read_header as read_header
from ..verify.readback.ros2 import as_table
from ..verify.time_as_run import time_as_run_s
from . import cancelling, outputs, prediction
from .cancelling import Cancel
from .choices.choices import CHOICE_BY_FLAG, CHOICES, ChoiceKeywords, Choices, path_of, suffix_of
from .choices.ineffective_flags import (
    LAYOUT_FLAGS,
    PLANNING_FLAGS,
    report_flags_without_effect,
    report_ineffective_flags,
)
from .conversion import make_choices
from .json_files import read_plan
from .options import DEFAULT_BRUSH, Options, load_brush, load_cell, make_options
from .preparation import preparation
from .preparation.margin_strokes import is_margin
from .prepared_drawing import PreparedDrawing, list_strokes_from, match_whole_strokes, order_nearest_first
from .project.ignored_settings import drop_from_project, drop_overruled, find_overruled_names

if TYPE_CHECKING:
    from .preparation.preparation import Source

Warn = Callable[[str, Iterable[Notice]], object]
MAX_BORDER_DIFFERENCE_MM = 0.02  # how far rounding of a plan can displace the edges of its paint
# Choices that a program defines itself, in its header.
SET_BY_PROGRAM = ("compensation", "tolerance", "lag", "terminals", "start", "end", "margin_strokes")
# Flags that say how a drawing becomes strokes. Without a drawing, --sheet is still the sheet of the program.
DRAWING_FLAGS = ("colour", "speed", *(flag for flag in (*LAYOUT_FLAGS, *PLANNING_FLAGS) if flag != "sheet"))


@dataclass(frozen=True)
class Check:
    """What a program does, and the problems that forbid running it.

    job: "painting", or a job before the first stroke: "border", "first-run", "height".
    problems: what forbids running the program; empty if nothing does.
    time_s: how long the machine takes; None for a program that brushsvg did not write.
    is_foreign: the program was written by other software, for a pen.
    is_compared: the program was compared with a drawing or plan.
    notices: further warnings, about the drawing or the machine.
    work, marks, figures: what the program paints; None if it paints nothing.
    border_mm: left, bottom, right and top of a run in the air.
    heights_mm: the first and last height; for a height program also the step.
    """

    job: str
    problems: tuple[Notice, ...]
    time_s: float | None = None
    is_foreign: bool = False
    is_compared: bool = False
    notices: tuple[Notice, ...] = ()
    work: PreparedDrawing | None = field(default=None, repr=False)
    marks: _core.Marks | None = field(default=None, repr=False)
    figures: Report | None = field(default=None, repr=False)
    border_mm: tuple[float, ...] | None = None
    heights_mm: tuple[float, ...] | None = None

    @property
    def plan(self) -> _core.Plan | None:
        """TCP poses [mm] of each stroke, as in the program."""
        return self.work.plan if self.work else None


def check(
    program: str | os.PathLike[str],
    drawing: Source | None = None,
    *,
    progress: Callable[[str], object] | None = None,
    cancel: Cancel | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> Check:
    """Check a program as `brushsvg check` does: read it back and simulate it.

    The program is checked against the limits of its brush and its machine, and compared with its drawing.

    program: the path of the program.
    drawing: what the program should paint, as `convert` takes it; None to check only the limits.
    progress, cancel: as for `convert`.
    choices: as for `convert`, by default as the program says. How strokes were compensated is always taken from the
        program.

    Raises Error, with a code of docs/reference/diagnostics.md, for a drawing that cannot be painted, and for a
    program that cannot be read or followed. Such a program may press deeper than the laws of the brush reach. All
    other reasons not to run the program are in `problems`.
    """
    require_type(program, (str, os.PathLike), "a path", "program")
    chosen = make_choices(drawing, choices)
    chosen = drop_from_project(chosen, SET_BY_PROGRAM)
    for name in SET_BY_PROGRAM:
        if getattr(chosen, name) is not None:
            sentence = f"the program's header says how it was made: {name} has no effect"
            raise Error(sentence, name, code="flag-without-effect")
    if drawing is None and chosen.corrections is not None:
        raise Error("corrections need the drawing that they belong to", "corrections", code="options-contradict")
    notices: list[Notice] = []
    result = cancelling.run(
        lambda stage: check_program(os.fspath(program), chosen, stage, lambda _, warnings: notices.extend(warnings)),
        progress,
        cancel,
    )
    return replace(result, notices=tuple(notices))


def check_program(
    path: str,
    chosen: Choices,
    stage: Callable[[str], object] = lambda text: None,
    warn: Warn = lambda file, notices: None,
) -> Check:
    """Check a program, and report notices with their file as soon as they are known."""
    suffix = suffix_of(path)
    with name_file_in_errors(path):
        data = read_bytes(path)
        text = text_of_file(b"" if suffix == ".cdr" else data)
        if suffix in GCODE and not is_ours(text):
            return _check_foreign_program(path, text, chosen, warn)
        files = _read_with_called_files(path, suffix, text)
        header = read_header(files.text)
        chosen = _drop_project_choices(chosen, header)
        for kind, name, names in (
            ("cell", header.cell, cell_names()),
            ("brush", header.brush, brush_names()),
        ):
            if getattr(chosen, kind) is None and name not in names:
                sentence = f"the program names {kind} {name!r}, which brushsvg does not ship"
                raise Error(sentence, code=f"{kind}-unknown", advice=f"give --{kind} FILE")
        tolerance_mm = header.tolerance_mm or preflight.DEFAULT_TOLERANCE_MM
        cell = preflight.as_exact_as(load_cell(chosen.cell or header.cell), tolerance_mm)
        brush = load_brush(chosen.brush) or find_brush(header.brush)
        _require_named("cell", header.cell, cell.name)
        _require_named("brush", header.brush, brush.name)
        with files.located_errors():
            read = read_program(files.text, suffix, cell)
    if chosen.input is None:
        warn(path, report_flags_without_effect(chosen, DRAWING_FLAGS, "a program that is checked without its drawing"))
    warn(path, report_renamed(Path(path).stem, suffix, cell, POSTS[cell.language].name_in(files.text)))
    warn(cell.name, list_arm_notices(cell))
    program = _OwnProgram(path, files, header, read, cell, brush)
    if header.border_mm or header.heights_mm or header.first_mm:
        return _check_setup_program(program, chosen, stage, warn)
    return _check_painting(program, chosen, stage, warn)


def _require_named(kind: str, name_in_header: str, name: str) -> None:
    """Raise Error for a cell or brush that is not the one that the program was written for."""
    written, given = ("".join(spelled(plain_text(each, NAMED)).split()) for each in (name_in_header, name))
    if written != given:
        sentence = f"the program was written for {kind} {name_in_header!r}, not for {name!r}"
        advice = f"give the {kind} of the program, or convert the drawing again"
        raise Error(sentence, code="program-for-other", advice=advice)


@dataclass(frozen=True)
class _ProgramFiles:
    """The files of a program as one text.

    text: the lines of all files.
    first_lines: the line of the text, from 1, at which each called file begins, by the name of that file.
    """

    text: str
    first_lines: dict[str, int]

    def locate(self, sentence: str) -> str:
        """Return a sentence that begins with a line of the text, with the file of that line and its number there."""
        found = re.match(r"line (\d+)", sentence)
        begun = [(first, name) for name, first in self.first_lines.items() if found and first <= int(found[1])]
        if not begun:
            return sentence
        first, name = max(begun)
        return f"line {int(found[1]) - first + 1} of {name}{sentence[found.end() :]}"

    @contextmanager
    def located_errors(self) -> Iterator[None]:
        """Let errors inside name the file of their line."""
        try:
            yield
        except Error as problem:
            problem.sentence = self.locate(problem.sentence)
            problem.args = (join_advice(problem.sentence, problem.advice),)
            raise


@dataclass(frozen=True)
class _OwnProgram:
    """A program that brushsvg wrote.

    files: its text.
    header: the contents of its header.
    read: its moves.
    cell, brush: the cell and brush that it is for.
    """

    path: str
    files: _ProgramFiles
    header: object
    read: object
    cell: Cell
    brush: _core.Brush

    def z_offset_mm(self, chosen: Choices) -> float:
        return self.header.z_offset_mm if chosen.z_offset is None else chosen.z_offset


def _read_with_called_files(path: str, suffix: str, text: str) -> _ProgramFiles:
    """Return a program with the files that it calls, next to it."""
    if suffix == ".robodk":
        sentence = "brushsvg cannot read back what a RoboDK post writes"
        raise Error(sentence, code="program-format")
    if suffix == ".cdr":
        sentence = "a serialized message does not name brush and paper: check the .csv of the same job"
        raise Error(sentence, code="program-format")
    if suffix == ".traj":
        text = as_table(text)
    post = parted_post(suffix)
    if post and (first := _find_first_file(Path(path), post, text)):
        sentence = "this is one part of a job in several files"
        raise Error(sentence, code="program-cut-short", advice=f"check {first}, which reads all of them")
    called = called_programs(path, text, lambda file: text_of_file(read_bytes(file)))
    first_lines = {}
    for file, called_text in called.items():
        text += "" if text.endswith("\n") else "\n"  # an editor can leave out the end of the last line
        first_lines[Path(file).name] = text.count("\n") + 1
        text += called_text
    return _ProgramFiles(text, first_lines)


def _find_first_file(path: Path, post: Post, text: str) -> str:
    """Return the name of the first file of a job of which this file is a later one, or ""."""
    part = re.fullmatch(r"(.+)-part\d+", path.stem)
    if part and any(name.startswith("-part") for name in post.called(text)):
        return path.with_name(part[1] + path.suffix).name
    if not re.fullmatch(r"B[0-9A-Z]{4}\d{3,}", path.stem, re.IGNORECASE):  # as name_parts names called programs
        return ""
    others = sorted(other for other in path.parent.glob(f"*{path.suffix}") if other != path)
    calling = (other.name for other in others if path.stem.upper() in post.called(read_if_possible(str(other))))
    return next(calling, "")


def _drop_project_choices(chosen: Choices, header) -> Choices:
    """Drop project choices that the header of the program defines."""
    if not chosen.from_project:
        return chosen
    drawing_settings = {} if chosen.input is None else settings_in(chosen.input)
    chosen = drop_overruled(
        chosen, {name: drawing_settings[name] for name in drawing_settings if name not in ("brush", "cell")}
    )
    names = {"brush": header.brush, "cell": header.cell}
    dropped = {"z_offset"} | find_overruled_names(chosen, names, unknown=False)
    if header.sheet_mm and chosen.input is None:
        dropped.add("sheet")
    return drop_from_project(chosen, dropped)


def _check_painting(program: _OwnProgram, chosen: Choices, stage, warn: Warn) -> Check:
    header, read, cell, brush = program.header, program.read, program.cell, program.brush
    work = _prepare_as_made(program, chosen, stage, warn) if chosen.input is not None else None
    z_offset_mm = program.z_offset_mm(chosen)
    with name_file_in_errors(program.path):
        sheet_mm = work.plan.sheet_mm if work else chosen.sheet or header.sheet_mm
        if sheet_mm is None:
            sentence = "its header does not say how large the sheet is: give --sheet or the drawing"
            raise Error(sentence, code="sheet-unknown")
        with program.files.located_errors():
            simulated = simulate_program.simulate_program(read, brush, cell, sheet_mm, z_offset_mm)
    warn(program.path, _report_offset(z_offset_mm))
    with name_file_in_errors(program.path):
        problems = simulated.problems + simulate_program.check_stroke_numbers(read, header.first_stroke, header.strokes)
        strokes, drawn, speeds = None, None, None
        if work:
            loads = split_into_loads(work.plan, brush, cell)
            warn(program.path, report_dry_brush(loads, brush, cell, header.first_stroke))
            stroke_rows, differences = against_plan.compare_with_plan(simulated, loads, cell, header.first_stroke)
            if header.is_of_plan and work.strokes is not None:
                differences = _merge_style_differences(differences)
            problems = problems + differences
            speeds = None if None in stroke_rows else [loads.loads[k].speed_mm_s for k in stroke_rows]
            if work.strokes is not None:
                target_strokes = match_whole_strokes(work, loads)
                strokes = None if None in stroke_rows else [target_strokes[k] for k in stroke_rows]
                drawn = list_strokes_from(work, loads, header.first_stroke)
                drawn = drawn and [each for each in drawn if not is_margin(each)]
        rewritten, rewrite_notices = _compare_with_rewritten(program, simulated, work, speeds, z_offset_mm)
        problems = problems + rewrite_notices
        if rewritten and not problems:
            problems = find_moves_out_of_arm(rewritten, sheet_mm)
        problems = [replace(each, sentence=program.files.locate(each.sentence)) for each in problems]
        title = (work and work.title) or header.title  # a program has ASCII letters only
        painted_work = PreparedDrawing(title, brush, simulated.plan, strokes, (), Options(), ())
        seconds, as_run_s = duration_s(rewritten) if rewritten else 0.0, time_as_run_s(read, cell)
        if as_run_s > 1.1 * seconds + 1.0:  # feeds were lowered in the program
            seconds = as_run_s
        figures = outputs.make_report(
            painted_work,
            simulated.marks,
            cell,
            forbidden=problems,
            drawn=drawn,
            seconds=seconds,
            as_run=simulated.as_run,
        )
    return Check(
        "painting",
        tuple(problems),
        seconds,
        is_compared=work is not None,
        work=painted_work,
        marks=simulated.marks,
        figures=figures,
    )


def _report_offset(z_offset_mm: float) -> list[Notice]:
    """Return a notice if the paper is expected at another height than in the cell."""
    if not z_offset_mm:
        return []
    where = "higher" if z_offset_mm > 0 else "lower"
    sentence = (
        f"the program was made with --z-offset {z_offset_mm:g}: all limits were checked for paper "
        f"{abs(z_offset_mm):g} mm {where} than the cell has it"
    )
    return [Notice("", sentence, code="paper-offset")]


def _merge_style_differences(differences: list[Notice]) -> list[Notice]:
    """Merge the notices on strokes that are painted in another way into one notice.

    Neither the program nor its plan.json says how the strokes were planned, so they may be as requested.
    """
    restyled = [each for each in differences if each.code in ("path-elsewhere", "held-otherwise", "stroke-too-fast")]
    if not restyled:
        return differences
    sentence = (
        f"stroke {restyled[0].where!r} differs from the drawing's, and the plan.json that the program was made from "
        "does not say how it was planned"
    )
    advice = "check the program against that plan.json"
    other_differences = [each for each in differences if each not in restyled]
    return [*other_differences, Notice("", sentence, code="plan-unlike-drawing", advice=advice)]


def _compare_with_rewritten(
    program: _OwnProgram, simulated, work: PreparedDrawing | None, speeds, z_offset_mm: float
) -> tuple[object, list[Notice]]:
    """Write the plan that was read anew; return that program, and notices on where the given one differs."""
    header, cell, brush = program.header, program.cell, program.brush
    header_notes = against_regenerated.HeaderNotes(*_make_expected_header(header, work))
    rewritten = against_regenerated.regenerate_program(
        simulated, brush, cell, z_offset_mm, header.first_stroke, header_notes, speeds
    )
    if not rewritten:
        return rewritten, []
    at_own_speeds, least_s, most_s = rewritten, None, None
    if speeds is not None:  # a program may be slower than the drawing, for example because of another --speed
        passes = simulated.plan.passes
        if any(a_pass.speed_mm_s < speed for a_pass, speed in zip(passes, speeds, strict=True)):
            at_own_speeds = against_regenerated.regenerate_program(
                simulated, brush, cell, z_offset_mm, header.first_stroke, header_notes
            )
            most_s = duration_s(at_own_speeds)
    else:  # feeds may have been lowered after the time was written into the header
        usual_mm_s = min(Options.speed_mm_s, rewritten.touching_mm_s)
        fastest = [max(a_pass.speed_mm_s, usual_mm_s) for a_pass in simulated.plan.passes]
        fastest_program = against_regenerated.regenerate_program(
            simulated, brush, cell, z_offset_mm, header.first_stroke, None, fastest
        )
        least_s = duration_s(fastest_program)
    changed_line = against_regenerated.differing_line(
        program.files.text, program.read, rewritten, cell, least_s, most_s
    )
    notices = (
        [Notice("", changed_line, code="program-changed")]
        if changed_line
        else pauses_in_paint.find_pauses(program.read, at_own_speeds)
    )
    return rewritten, notices


def _make_expected_header(header, work: PreparedDrawing | None) -> tuple[str, tuple[str, ...]]:
    """Return the title and notes that the header of a program should have.

    They come from the drawing, or from the header itself where nothing else is known, as for a program that was
    made from a plan.
    """
    if work is None or work.strokes is None or not header.notes[:1] or not header.notes[0].startswith("compensation"):
        return header.title, header.notes
    order = [note for note in header.notes if note.startswith("order")]
    return work.title or "untitled", (*outputs.header_lines(work), *order)


def _check_foreign_program(path: str, text: str, chosen: Choices, warn: Warn) -> Check:
    """Check a pen's program by other software: what a brush would paint with it, and which limits it breaks."""
    if chosen.input is not None:
        sentence = "brushsvg did not write this program and does not know its drawing: check it without a drawing"
        raise Error(sentence, code="nothing-to-compare")
    chosen = drop_from_project(chosen, {*CHOICES} - {"brush", "cell", "sheet", "paper_z"})
    for flag in (*DRAWING_FLAGS, "z-offset", "corrections"):
        given = getattr(chosen, CHOICE_BY_FLAG.get(flag, flag))
        if flag != "paper-z" and given:
            sentence = f"brushsvg did not write this program: --{flag} has no effect"
            raise Error(sentence, code="flag-without-effect")
    cell, brush = load_cell(chosen.cell), load_brush(chosen.brush) or find_brush(DEFAULT_BRUSH)
    foreign = simulate_foreign_program(text, brush, cell, chosen.sheet, chosen.paper_z)
    warn(path, foreign.warnings)
    painted_work = PreparedDrawing("", brush, foreign.plan, None, (), Options(cell=cell), ())
    figures = outputs.make_report(painted_work, foreign.marks, cell, forbidden=foreign.problems)
    return Check("painting", foreign.problems, is_foreign=True, work=painted_work, marks=foreign.marks, figures=figures)


def _check_setup_program(program: _OwnProgram, chosen: Choices, stage, warn: Warn) -> Check:
    """Check a program that runs before the first stroke; its header says all that it does."""
    header, read, text = program.header, program.read, program.files.text
    cell, brush = program.cell, program.brush
    with name_file_in_errors(program.path):
        if (header.heights_mm or header.first_mm) and chosen.input is not None:
            raise Error(
                "it finds the paper's height and paints no drawing: check it without a drawing",
                code="nothing-to-compare",
            )
        if header.sheet_mm is None:
            raise Error("its header does not say how large the sheet is", code="sheet-unknown")
    work = _prepare_as_made(program, chosen, stage, warn) if chosen.input is not None else None
    with name_file_in_errors(program.path):
        if header.border_mm:
            sheet_mm = work.plan.sheet_mm if work else header.sheet_mm
            z_offset_mm = program.z_offset_mm(chosen)
            outcome = setup_checks.check_border(text, read, header, brush, cell, sheet_mm, z_offset_mm)
            problems = [*outcome.problems, *(_compare_border(header, work, stage) if work else [])]
            return Check(
                "border",
                tuple(problems),
                outcome.time_s,
                is_compared=work is not None,
                border_mm=tuple(header.border_mm),
            )
        outcome = setup_checks.check_strokes(text, read, header, brush, cell)
        kind, heights_mm = ("first-run", header.first_mm) if header.first_mm else ("height", header.heights_mm)
        return Check(kind, tuple(outcome.problems), outcome.time_s, heights_mm=tuple(heights_mm))


def _compare_border(header, work: PreparedDrawing, stage) -> list[Notice]:
    """Return a notice if a run in the air does not go around the paint."""
    marks = prediction.predict(work, outlines=False, stage=stage)
    needed_mm, commanded_mm = round_outwards(job_bounds_mm(work.plan, marks, work.brush)), header.border_mm
    if (
        max(abs(commanded - needed) for commanded, needed in zip(commanded_mm, needed_mm, strict=True))
        <= MAX_BORDER_DIFFERENCE_MM
    ):
        return []
    template = "{0:.2f} to {2:.2f} mm, {1:.2f} to {3:.2f} mm"
    sentence = (
        f"the program goes round {template.format(*commanded_mm)}, but the paint and the tool of the drawing stay "
        f"within {template.format(*needed_mm)}: it was changed, or made with other flags or from another drawing"
    )
    return [Notice("", sentence, code="border-elsewhere")]


def _is_corrected_plan(source) -> bool:
    if isinstance(source, str | os.PathLike) and suffix_of(source) == ".json":
        with name_file_in_errors(path_of(source)):
            source = read_plan(source)
    return isinstance(source, _core.Plan) and is_corrected(source)


def _prepare_as_made(program: _OwnProgram, chosen: Choices, stage, warn: Warn) -> PreparedDrawing:
    """Prepare a program's drawing or plan as its header says, and repeat notices on what is left out."""
    header, source = program.header, chosen.input
    if header.is_corrected and chosen.corrections is None and not _is_corrected_plan(source):
        with name_file_in_errors(program.path):
            sentence = "corrections moved its strokes, and the check does not have them"
            raise Error(sentence, code="corrections-missing", advice="give --corrections FILE")
    if suffix_of(source) != ".json":
        with name_file_in_errors(path_of(source)):
            wide = chosen.wide or settings_in(source).get("wide")
        chosen = replace(
            chosen,
            compensation=header.compensation,
            tolerance=header.tolerance_mm,
            lag=header.lag_mm,
            start=header.start,
            end=header.end,
            z_offset=header.z_offset_mm,
            wide=wide,
            margin_strokes="on" if header.has_margin else "off",
        )
    warn(path_of(source), report_ineffective_flags(chosen))
    options = make_options(chosen, program.cell, program.brush)
    with name_file_in_errors(path_of(source)):
        work = preparation.prepare(source, options, stage)
    warn(path_of(source), work.notices)
    return order_nearest_first(work) if header.nearest_first else work
