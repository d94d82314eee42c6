"""A program read back, simulated, and held against its brush, its machine and what it should paint: what `brushsvg
check` does, from Python."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from .. import _core
from ..comparison.corrections import is_corrected
from ..errors import Error, Notice, need
from ..files import read_bytes
from ..machine import preflight
from ..machine.cells.cell import Cell
from ..machine.cells.cell_file import cell_names
from ..machine.motion import duration_s
from ..machine.paint_reload import in_loads
from ..machine.posts import GCODE
from ..machine.program import out_of_arm
from ..machine.setup_programs import around
from ..machine.writer import called_programs, parted_post
from ..model.library import brush_names, find_brush
from ..read import settings_in
from ..read.gcode import is_ours
from ..show.evaluation.report import Report
from ..verify import against_plan, against_regenerated, pace, setup_programs, simulate_program
from ..verify.foreign_program import foreign_program
from ..verify.readback import read_program, text_of_file
from ..verify.readback.header import made as made_of
from ..verify.readback.ros2 import as_table
from ..verify.time_as_run import time_as_run_s
from . import cancelling, outputs, prediction
from .cancelling import Cancel
from .choices import (
    CHOICE_BY_FLAG,
    CHOICES,
    LAYOUT_FLAGS,
    PLANNING_FLAGS,
    ChoiceKeywords,
    Choices,
    drop_from_project,
    drop_overruled,
    find_overruled_names,
    load_brush,
    load_cell,
    make_options,
    name_file_in_errors,
    path_of,
    report_ineffective_flags,
    suffix_of,
)
from .conversion import list_arm_notices, make_choices
from .json_files import read_plan
from .options import DEFAULT_BRUSH, Options
from .preparation import preparation
from .preparation.margin_strokes import is_margin
from .work import Work, match_whole_strokes, order_nearest_first

if TYPE_CHECKING:
    from .preparation.preparation import Source

Warn = Callable[[str, Iterable[Notice]], object]
MAX_BORDER_DIFFERENCE_MM = 0.02  # what a plan's rounding makes of where its paint ends
SET_BY_PROGRAM = (
    "compensation",
    "tolerance",
    "lag",
    "terminals",
    "start",
    "end",
    "margin_strokes",
)  # by the program


@dataclass(frozen=True)
class Check:
    """What a program does, and what forbids to run it.

    job: "painting", or what is done before the first stroke: "border", "first-run", "height". problems: what forbids to
    run it, empty where nothing does. time_s: how long the machine takes, None for a program of others. is_foreign:
    somebody else wrote it, for a pen; is_compared: with a drawing or plan. notices: further warnings, about the drawing
    or the machine. work, marks, figures: what it paints, None where that is nothing. border_mm: left, bottom, right,
    top of an air run; heights_mm: from, to, and of a height program the step.
    """

    job: str
    problems: tuple[Notice, ...]
    time_s: float | None = None
    is_foreign: bool = False
    is_compared: bool = False
    notices: tuple[Notice, ...] = ()
    work: Work | None = field(default=None, repr=False)
    marks: _core.Marks | None = field(default=None, repr=False)
    figures: Report | None = field(default=None, repr=False)
    border_mm: tuple[float, ...] | None = None
    heights_mm: tuple[float, ...] | None = None

    @property
    def plan(self) -> _core.Plan | None:
        """TCP poses [mm] of each stroke, as the program has them."""
        return self.work.plan if self.work else None


def check(
    program: str | os.PathLike[str],
    drawing: Source | None = None,
    *,
    progress: Callable[[str], object] | None = None,
    cancel: Cancel | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> Check:
    """A program read back and simulated, as `brushsvg check` does: whether it keeps the limits of its brush and its
    machine, and whether it paints what it should.

    program: its path. drawing: what it should paint, as `convert` takes it; None: only its limits are checked.
    choices: as those of `convert`, by default what the program says; how strokes were compensated it says itself.
    progress, cancel: as for `convert`.

    Raises Error, with a code of docs/reference/diagnostics.md, for a program that cannot be read or followed, such as
    one that presses deeper than the brush's laws reach, and a drawing that cannot be painted. What else forbids
    to run it stands in `problems`.
    """
    need(program, (str, os.PathLike), "a path, which program is")
    chosen = make_choices(drawing, choices)
    chosen = drop_from_project(chosen, SET_BY_PROGRAM)
    for name in SET_BY_PROGRAM:
        if getattr(chosen, name) is not None:
            sentence = f"a program says itself how it was made: {name} would change nothing"
            raise Error(sentence, name, code="flag-without-effect")
    if drawing is None and chosen.corrections is not None:
        raise Error("corrections need the drawing that they are of", "corrections", code="options-contradict")
    found: list[Notice] = []
    done = cancelling.run(
        lambda stage: check_program(
            os.fspath(program), chosen, stage, lambda _, notices: found.extend(notices)
        ),
        progress,
        cancel,
    )
    return replace(done, notices=tuple(found))


def check_program(
    path: str,
    chosen: Choices,
    stage: Callable[[str], object] = lambda text: None,
    warn: Warn = lambda file, notices: None,
) -> Check:
    """Check a program, and report notices with the file that they are of as soon as they are known."""
    suffix = suffix_of(path)
    with name_file_in_errors(path):
        data = read_bytes(path)
        text = text_of_file(b"" if suffix == ".cdr" else data)
        if suffix in GCODE and not is_ours(text):
            return _check_foreign_program(path, text, chosen, warn)
        text = _read_with_called_files(path, suffix, text)
        made = made_of(text)
        chosen = _drop_project_choices(chosen, made)
        for kind, name, names in (("cell", made.cell, cell_names()), ("brush", made.brush, brush_names())):
            if getattr(chosen, kind) is None and name not in names:
                raise Error(
                    f"the program names {kind} {name!r}, which does not come along",
                    code=f"{kind}-unknown",
                    advice=f"give --{kind} FILE",
                )
        tolerance_mm = made.tolerance_mm or preflight.DEFAULT_TOLERANCE_MM
        cell = preflight.as_exact_as(load_cell(chosen.cell or made.cell), tolerance_mm)
        brush = load_brush(chosen.brush) or find_brush(made.brush)
        read = read_program(text, suffix, cell)
    warn(cell.name, list_arm_notices(cell))
    program = _OwnProgram(path, text, made, read, cell, brush)
    if made.border_mm or made.heights_mm or made.first_mm:
        return _check_setup_program(program, chosen, stage, warn)
    return _check_painting(program, chosen, stage, warn)


@dataclass(frozen=True)
class _OwnProgram:
    """A program of ours: made, what its header says; read, its moves; cell, brush: those that it is for."""

    path: str
    text: str
    made: object
    read: object
    cell: Cell
    brush: _core.Brush

    def z_offset_mm(self, chosen: Choices) -> float:
        return self.made.z_offset_mm if chosen.z_offset is None else chosen.z_offset


def _read_with_called_files(path: str, suffix: str, text: str) -> str:
    """Read a program with the files that it calls, next to it."""
    if suffix == ".robodk":
        raise Error(
            "what a post of RoboDK's kind writes is in a language of its own, which is not read back",
            code="program-format",
        )
    if suffix == ".cdr":
        raise Error(
            "a serialized message says nothing of brush and paper: check the .csv of the same job",
            code="program-format",
        )
    if suffix == ".traj":
        text = as_table(text)
    post = parted_post(suffix)
    part = re.fullmatch(r"(.+)-part\d+", Path(path).stem)
    if post and part and any(name.startswith("-part") for name in post.called(text)):
        first = Path(path).with_name(part[1] + suffix).name
        raise Error(
            "this is one part of a job in several files",
            code="program-cut-short",
            advice=f"check {first}, which reads all of them",
        )
    called = called_programs(path, text, lambda file: text_of_file(read_bytes(file)))
    return "".join([text, *called.values()])


def _drop_project_choices(chosen: Choices, made) -> Choices:
    """Drop what a project file chose and the program's header says itself."""
    if not chosen.from_project:
        return chosen
    said = {} if chosen.input is None else settings_in(chosen.input)
    chosen = drop_overruled(chosen, {name: said[name] for name in said if name not in ("brush", "cell")})
    named = {"brush": made.brush, "cell": made.cell}
    dropped = {"z_offset"} | find_overruled_names(chosen, named, unknown=False)
    if made.sheet_mm and chosen.input is None:
        dropped.add("sheet")
    return drop_from_project(chosen, dropped)


def _check_painting(program: _OwnProgram, chosen: Choices, stage, warn: Warn) -> Check:
    made, read, cell, brush = program.made, program.read, program.cell, program.brush
    work = _prepare_as_made(program, chosen, stage, warn) if chosen.input is not None else None
    z_offset_mm = program.z_offset_mm(chosen)
    with name_file_in_errors(program.path):
        sheet_mm = work.plan.sheet_mm if work else chosen.sheet or made.sheet_mm
        if sheet_mm is None:
            raise Error(
                "its header does not say how large the sheet is: give --sheet or the drawing",
                code="sheet-unknown",
            )
        ran = simulate_program.run(read, brush, cell, sheet_mm, z_offset_mm)
    warn(program.path, _report_offset(z_offset_mm))
    with name_file_in_errors(program.path):
        problems = ran.problems + simulate_program.misnumbered(read, made.first_stroke, made.strokes)
        strokes, drawn, speeds = None, None, None
        if work:
            loads = in_loads(work.plan, brush, cell)
            which, unlike = against_plan.with_plan(ran, loads, cell, made.first_stroke)
            if made.is_of_plan and work.strokes is not None:
                unlike = _merge_style_differences(unlike)
            problems = problems + unlike
            speeds = None if None in which else [loads.loads[k].speed_mm_s for k in which]
            if work.strokes is not None:
                whole = match_whole_strokes(work, loads)
                strokes = None if None in which else [whole[k] for k in which]
                whole_job = made.first_stroke == 1
                drawn = [each for each in work.strokes if not is_margin(each)] if whole_job else None
        again, changed = _compare_with_rewritten(program, ran, work, speeds, z_offset_mm)
        problems = problems + changed
        if again and not problems:
            problems = out_of_arm(again, sheet_mm)
        shown = Work(made.title, brush, ran.plan, strokes, (), Options(), ())
        seconds, as_run_s = duration_s(again) if again else 0.0, time_as_run_s(read, cell)
        if as_run_s > 1.1 * seconds + 1.0:  # feeds were lowered
            seconds = as_run_s
        figures = outputs.reported(
            shown, ran.marks, cell, forbidden=problems, drawn=drawn, seconds=seconds, as_run=ran.as_run
        )
    return Check(
        "painting",
        tuple(problems),
        seconds,
        is_compared=work is not None,
        work=shown,
        marks=ran.marks,
        figures=figures,
    )


def _report_offset(z_offset_mm: float) -> list[Notice]:
    """A notice where the paper is expected at another height than the cell has it."""
    if not z_offset_mm:
        return []
    where = "higher" if z_offset_mm > 0 else "lower"
    sentence = (
        f"the program was made with --z-offset {z_offset_mm:g}: all limits were checked for a paper "
        f"{abs(z_offset_mm):g} mm {where} than the cell has it"
    )
    return [Notice("", sentence, code="paper-offset")]


def _merge_style_differences(unlike: list[Notice]) -> list[Notice]:
    """The same, with one notice for all strokes that are painted in another way: neither the program nor its plan.json
    says how it was planned, so they may be as requested."""
    otherwise = [
        each for each in unlike if each.code in ("path-elsewhere", "held-otherwise", "stroke-too-fast")
    ]
    if not otherwise:
        return unlike
    sentence = (
        f"stroke {otherwise[0].where!r} differs from the drawing's, and the plan.json that the program was made from "
        "does not say how it was planned"
    )
    advice = "check the program against that plan.json"
    rest = [each for each in unlike if each not in otherwise]
    return [*rest, Notice("", sentence, code="plan-unlike-drawing", advice=advice)]


def _compare_with_rewritten(
    program: _OwnProgram, ran, work: Work | None, speeds, z_offset_mm: float
) -> tuple[object, list[Notice]]:
    """What we would write of the plan that was read, and where the program differs from it."""
    made, cell, brush = program.made, program.cell, program.brush
    header_notes = against_regenerated.HeaderNotes(*_make_expected_header(made, work))
    again = against_regenerated.again(ran, brush, cell, z_offset_mm, made.first_stroke, header_notes, speeds)
    if not again:
        return again, []
    least_s = None
    if speeds is None:  # feeds may have been lowered after its time was written
        usual_mm_s = min(Options.speed_mm_s, again.touching_mm_s)
        fastest = [max(a_pass.speed_mm_s, usual_mm_s) for a_pass in ran.plan.passes]
        at_most = against_regenerated.again(ran, brush, cell, z_offset_mm, made.first_stroke, None, fastest)
        least_s = duration_s(at_most)
    changed = against_regenerated.differing_line(program.text, program.read, again, cell, least_s)
    said = [Notice("", changed, code="program-changed")] if changed else pace.stops(program.read, again)
    return again, said


def _make_expected_header(made, work: Work | None) -> tuple[str, tuple[str, ...]]:
    """Title and notes that a program's header should have: its drawing's, or its own where nobody knows better, as for
    a program that was made of a plan."""
    if (
        work is None
        or work.strokes is None
        or not made.notes[:1]
        or not made.notes[0].startswith("compensation")
    ):
        return made.title, made.notes
    order = [note for note in made.notes if note.startswith("order")]
    return work.title or "untitled", (*outputs.notes(work), *order)


def _check_foreign_program(path: str, text: str, chosen: Choices, warn: Warn) -> Check:
    """A program that somebody else wrote for a pen: what a brush paints with it, and which limits it breaks."""
    if chosen.input is not None:
        sentence = "brushsvg did not write it: it paints no drawing that is known; check it alone"
        raise Error(sentence, code="nothing-to-compare")
    chosen = drop_from_project(chosen, {*CHOICES} - {"brush", "cell", "sheet", "paper_z"})
    for flag in (*LAYOUT_FLAGS, *PLANNING_FLAGS, "speed", "z-offset", "corrections"):
        given = getattr(chosen, CHOICE_BY_FLAG.get(flag, flag))
        if flag not in ("sheet", "paper-z") and given:
            sentence = f"brushsvg did not write it: --{flag} would change nothing"
            raise Error(sentence, code="flag-without-effect")
    cell, brush = load_cell(chosen.cell), load_brush(chosen.brush) or find_brush(DEFAULT_BRUSH)
    found = foreign_program(text, brush, cell, chosen.sheet, chosen.paper_z)
    warn(path, found.warnings)
    shown = Work("", brush, found.plan, None, (), Options(cell=cell), ())
    figures = outputs.reported(shown, found.marks, cell, forbidden=found.problems)
    return Check("painting", found.problems, is_foreign=True, work=shown, marks=found.marks, figures=figures)


def _check_setup_program(program: _OwnProgram, chosen: Choices, stage, warn: Warn) -> Check:
    """A program before the first stroke: it paints no drawing, and says in its header all that it does."""
    made, read, text = program.made, program.read, program.text
    cell, brush = program.cell, program.brush
    with name_file_in_errors(program.path):
        if (made.heights_mm or made.first_mm) and chosen.input is not None:
            raise Error(
                "it finds the paper's height and paints no drawing: check it alone", code="nothing-to-compare"
            )
        if made.sheet_mm is None:
            raise Error("its header does not say how large the sheet is", code="sheet-unknown")
    work = _prepare_as_made(program, chosen, stage, warn) if chosen.input is not None else None
    with name_file_in_errors(program.path):
        if made.border_mm:
            sheet_mm, z_offset_mm = work.plan.sheet_mm if work else made.sheet_mm, program.z_offset_mm(chosen)
            looked = setup_programs.look_at_border(text, read, made, brush, cell, sheet_mm, z_offset_mm)
            problems = [*looked.problems, *(_compare_border(made, work, stage) if work else [])]
            return Check(
                "border",
                tuple(problems),
                looked.time_s,
                is_compared=work is not None,
                border_mm=tuple(made.border_mm),
            )
        if made.first_mm:
            looked = setup_programs.look_at_first_run(text, read, made, brush, cell)
            return Check("first-run", tuple(looked.problems), looked.time_s, heights_mm=tuple(made.first_mm))
        looked = setup_programs.look_at_heights(text, read, made, brush, cell)
        return Check("height", tuple(looked.problems), looked.time_s, heights_mm=tuple(made.heights_mm))


def _compare_border(made, work: Work, stage) -> list[Notice]:
    """A sentence where an air run does not go round what a drawing's paint needs."""
    marks = prediction.predict(work, outlines=False, stage=stage)
    needed, found = around(preflight.job_bounds_mm(work.plan, marks, work.brush)), made.border_mm
    if (
        max(abs(ours - theirs) for ours, theirs in zip(found, needed, strict=True))
        <= MAX_BORDER_DIFFERENCE_MM
    ):
        return []
    place = "{0:.2f} to {2:.2f} mm, {1:.2f} to {3:.2f} mm"
    sentence = (
        f"the program goes round {place.format(*found)}, paint and tool of the drawing stay within "
        f"{place.format(*needed)}: it was changed, or made with other flags or of another drawing"
    )
    return [Notice("", sentence, code="border-elsewhere")]


def _is_corrected_plan(source) -> bool:
    if isinstance(source, str | os.PathLike) and suffix_of(source) == ".json":
        with name_file_in_errors(path_of(source)):
            source = read_plan(source)
    return isinstance(source, _core.Plan) and is_corrected(source)


def _prepare_as_made(program: _OwnProgram, chosen: Choices, stage, warn: Warn) -> Work:
    """Return the drawing or plan that a program should paint, prepared as its header says; notices on parts that are
    left out or painted otherwise are repeated: this is the last look."""
    made, source = program.made, chosen.input
    if made.is_corrected and chosen.corrections is None and not _is_corrected_plan(source):
        with name_file_in_errors(program.path):
            raise Error(
                "its strokes were moved by corrections, which are not known here",
                code="corrections-missing",
                advice="give --corrections FILE",
            )
    if suffix_of(source) != ".json":
        with name_file_in_errors(path_of(source)):
            wide = chosen.wide or settings_in(source).get("wide")
        chosen = replace(
            chosen,
            compensation=made.compensation,
            tolerance=made.tolerance_mm,
            lag=made.lag_mm,
            start=made.start,
            end=made.end,
            z_offset=made.z_offset_mm,
            wide=wide,
            margin_strokes="on" if made.has_margin else "off",
        )
    warn(path_of(source), report_ineffective_flags(chosen))
    options = make_options(chosen, program.cell, program.brush)
    with name_file_in_errors(path_of(source)):
        work = preparation.prepare(source, options, stage)
    warn(path_of(source), work.notices)
    return order_nearest_first(work) if made.nearest_first else work
