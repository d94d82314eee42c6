"""Convert a drawing into the program of a machine.

These are the steps of `brushsvg convert`, which Python users can call as well.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from .. import _core
from ..errors import Error, Notice, name_file_in_errors, need_number, need_one_of, need_truth, require_type
from ..files import write_files
from ..machine import preflight, writer
from ..machine.cells.cell import Cell
from ..machine.job_program import WHOLE_JOB, CheckedProgram, Job
from ..machine.leftover_programs import report_leftover_programs
from ..machine.moves import duration_s
from ..machine.paint_reload import PlanInLoads, fetched_mm, split_into_loads
from ..machine.posts import POSTS
from ..notice_summary import summarize_notices
from ..show.evaluation import report as reports
from . import cancelling, outputs, prediction
from .cancelling import Cancel
from .choices.choice_checks import check_choices, refuse_ends_without_effect, refuse_file_used_twice
from .choices.choices import ChoiceKeywords, Choices, choose_margin_strokes, path_of, suffix_of
from .choices.drawing_settings import fill_from_drawing
from .choices.ineffective_flags import report_ineffective_flags
from .options import make_options
from .preparation import preparation
from .prepared_drawing import PreparedDrawing, order_nearest_first
from .project.ignored_settings import drop_from_project

if TYPE_CHECKING:
    from .preparation.preparation import Source

ORDERS = ("drawn", "nearest")
# How far --z-offset may lower the tool without a notice. The strokes of `brushsvg setup height` try 1 mm.
MAX_SILENT_LOWERING_MM = 2.0
# Extensions of the files that are written in addition to a program.
OUTPUT_SUFFIXES = {
    "picture": (".png", ".svg"),
    "report": (".txt", ".json", ".csv"),
    "page": (".pdf", ".svg"),
}


@dataclass(frozen=True)
class Conversion:
    """A drawing that was converted into a plan and a program.

    plan: TCP poses [mm] of each stroke.
    notices: warnings, none of which forbids running the program.
    time_s: how long a machine takes; None if only a plan was requested and the machine cannot paint it.
    texts: the text of each file by its extension (".ngc", ".json"), or the bytes of a binary file (".cdr"). Further
        files of a program in several files are named by what they add to its name ("-part2.script") or by their own
        name.
    figures: a report with strokes and total on how close the paint comes to the drawing; None unless requested.
    files: the paths that were written.
    """

    title: str
    plan: _core.Plan
    notices: tuple[Notice, ...]
    time_s: float | None
    texts: Mapping[str, str | bytes] = field(repr=False)
    figures: reports.Report | None = field(default=None, repr=False)
    files: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The text of the first format. Raises Error for a binary one, whose bytes are in texts."""
        suffix, text = next(iter(self.texts.items()))
        if isinstance(text, bytes):
            raise Error(f"{suffix} is binary and has no text: texts[{suffix!r}] has its bytes", code="wrong-type")
        return text


def convert(
    drawing: Source,
    out: str | os.PathLike[str] | None = None,
    *,
    picture: str | os.PathLike[str] | None = None,
    report: str | os.PathLike[str] | None = None,
    page: str | os.PathLike[str] | None = None,
    formats: Sequence[str] = (),
    figures: bool = False,
    from_stroke: int = 1,
    order: str = "drawn",
    lenient: bool = False,
    progress: Callable[[str], object] | None = None,
    cancel: Cancel | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> Conversion:
    """Convert a drawing into a plan and a program, as `brushsvg convert` does.

    The files equal those of the command byte for byte. Only the given paths are written: all of them or none. Existing
    files are overwritten, but not the drawing, brush, cell or corrections of the same call.

    drawing: a path, any other input of read_drawing, a Design, or a Plan.
    out: the path of a program in the cell's language, or of a plan (.json).
    picture: the path of a picture of what will be painted (.png .svg).
    report: the path of the figures (.txt .json .csv).
    page: the path of a page to print and paint on (.pdf .svg).
    formats: the extensions of the texts to return, by default that of out, otherwise the first one of the cell's
        language.
    figures: also measure overlap and errors.
    from_stroke: the stroke at which to resume a job.
    order: "drawn" or "nearest".
    lenient: paint the sound parts of damaged geometry.
    progress: called with words on the progress.
    cancel: a callable or an object with is_set(), such as a threading.Event. It is polled 20 times a second in the
        thread of the caller. Once it returns true, concurrent.futures.CancelledError is raised within a second, and
        nothing is written.

    The choices are by default what the drawing says:
    brush, cell: a name, path, Brush or Cell.
    sheet, fit, origin: a pair (w, h) or (x, y) in mm.
    width, lag, tolerance, z_offset: mm.
    paint_speed: mm/s.
    scale: a factor.
    units: "mm", "in".
    layer: a list of names.
    select: CSS.
    paths_as: "stroke", "outline".
    wide: "auto", "clamp", "passes", "refuse".
    corners: "auto", "turn".
    detail: "draft", "normal", "fine".
    script: "auto", "latin", "arabic", "devanagari", "cjk".
    join: bool.
    compensation: "none", "constant", "closed", "refined".
    terminals, start, end: "auto", "round", "butt", "pointed".
    corrections: the path of a file that compare wrote.
    margin_strokes: "auto", "on", "off".

    docs/reference/options.md lists all choices in a table.

    Raises Error, with a code of docs/reference/diagnostics.md, for anything that cannot be read, painted or run. If
    there are several reasons, the error is the first one, its notes are the others, and its notices are the
    warnings.
    """
    chosen = make_choices(drawing, choices)
    extras = {"picture": picture, "report": report, "page": page}
    paths = {name: path for name, given in extras.items() if (path := check_output_path(name, given)) is not None}
    out = os.fspath(out) if _is_path_given(out, "out") else None
    refuse_file_used_twice(chosen, [out, *paths.values()])
    require_type(formats, (tuple, list), "a list of extensions", "formats")
    for extension in formats:
        require_type(extension, str, "an extension, such as '.ngc'")
    need_one_of(order, ORDERS, "order")
    need_truth(lenient, "lenient")
    need_truth(figures, "figures")
    require_type(from_stroke, Integral, "a whole number", "from_stroke")
    first_stroke = int(need_number(from_stroke, "from_stroke", 1, 1e8))
    suffixes = [*([] if out is None else [suffix_of(out)]), *formats]
    chosen = refuse_job_of_plan(chosen, suffixes, first_stroke)
    job = Job(chosen.z_offset or 0.0, first_stroke)

    def run_conversion(stage) -> tuple[Conversion, dict]:
        return _make_conversion(chosen, out, paths, tuple(formats), bool(figures), job, order, bool(lenient), stage)

    conversion, files = cancelling.run(run_conversion, progress, cancel)
    if files:
        write_files(files)
    return replace(conversion, files=tuple(files))


def refuse_job_of_plan(chosen: Choices, suffixes: Sequence[str], first_stroke: int = 1) -> Choices:
    """Raise Error for choices that only a program can follow, if only a plan is written.

    Returns the choices. A project file serves programs as well, so its z_offset is dropped for a plan.
    """
    if not suffixes or any(suffix != ".json" for suffix in suffixes):
        return chosen
    chosen = drop_from_project(chosen, ["z_offset"])
    for name, is_given in (("from_stroke", first_stroke > 1), ("z_offset", chosen.z_offset)):
        if is_given:
            sentence = f"{name} is for programs; a plan (.json) always has the whole job, on the paper"
            raise Error(sentence, name, code="options-contradict")
    return chosen


def make_choices(drawing, choices: Mapping) -> Choices:
    """Return the choices with these names, checked.

    Raises TypeError for an unknown name, and Error for a wrong value.
    """
    choice_names = {name for name in Choices.__dataclass_fields__ if name != "input"}
    for name in choices:
        if name not in choice_names:
            raise TypeError(f"{name!r} is not an option; known are {', '.join(sorted(choice_names))}")
    chosen = check_choices(Choices(input=drawing, **choices))
    refuse_ends_without_effect(chosen)
    return chosen


def check_output_path(name: str, path: str | os.PathLike[str] | None) -> str | None:
    """Return the path of an output in OUTPUT_SUFFIXES, or None if there is none. Raises Error for a wrong extension."""
    if not _is_path_given(path, name):
        return None
    path = os.fspath(path)
    if suffix_of(path) not in OUTPUT_SUFFIXES[name]:
        sentence = f"{name} {path[:80]!r} does not end in {' or '.join(OUTPUT_SUFFIXES[name])}"
        raise Error(sentence, name, code="program-format")
    return path


def _is_path_given(path, name: str) -> bool:
    if path is not None:
        require_type(path, (str, os.PathLike), "a path", name)
    return path is not None


def _make_conversion(
    chosen: Choices,
    out,
    paths: dict,
    formats: tuple[str, ...],
    figures: bool,
    job: Job,
    order,
    lenient,
    stage,
) -> tuple[Conversion, dict]:
    source = chosen.input
    with name_file_in_errors(path_of(source)):
        chosen = fill_from_drawing(chosen, source)
        ignored = report_ineffective_flags(chosen)
        chosen = choose_margin_strokes(chosen) if "page" in paths else chosen
        work = preparation.prepare(source, make_options(chosen), stage)
        cell = work.options.cell
        if out is not None:
            formats = tuple(dict.fromkeys([suffix_of(out), *formats]))
        formats = formats or (default_suffix(cell),)
        files = {paths["page"]: outputs.make_job_page(suffix_of(paths["page"]), work)} if "page" in paths else {}
        simulations = {}
        for suffix in formats:
            with_outlines = suffix_of(paths.get("picture")) == ".svg"
            marks = simulations[formats[0]].marks if simulations else None
            program_path = (Path(out or path_of(source)).stem or "brushsvg") + suffix
            simulations[suffix] = simulate_and_check(
                work, suffix, job, order, lenient, with_outlines, stage, marks, program_path
            )
            _raise_first_problem(simulations[suffix].problems, work.notices)
        first_simulation = simulations[formats[0]]
        stage("writing the program")
        texts: dict[str, str | bytes] = {}
        for suffix, each in simulations.items():
            for name, pieces in each.encoded().items():
                text = writer.join_pieces(pieces)
                text = text.decode() if suffix == ".json" else text
                texts[name + suffix] = text
                if out is not None and suffix == suffix_of(out):
                    files[writer.path_next_to(out, name)] = text
        if "picture" in paths:
            stage("drawing")
            files[paths["picture"]] = outputs.make_picture(
                suffix_of(paths["picture"]), first_simulation.work, first_simulation.marks
            )
        measured_figures = None
        if figures or "report" in paths:
            stage("measuring")
            measured_figures = outputs.make_report(first_simulation.work, first_simulation.marks, cell)
        if "report" in paths:
            files[paths["report"]] = reports.as_text(suffix_of(paths["report"]), measured_figures)
    cell_notices = writer.list_cell_notices(cell) if any(each.is_program for each in simulations.values()) else []
    remarks = dict.fromkeys(remark for each in simulations.values() for remark in each.remarks())
    leftover = report_leftover_programs(out, files) if out is not None else []
    notices = (*ignored, *first_simulation.work.notices, *remarks, *cell_notices, *leftover)
    conversion = Conversion(
        work.title, first_simulation.work.plan, notices, first_simulation.time_s(), texts, measured_figures
    )
    return conversion, dict(sorted(files.items(), key=lambda each: each[0] != out))  # put the program first


def default_suffix(cell: Cell) -> str:
    post = POSTS.get(cell.language)
    return post.extensions[0] if post else ".json"


def _raise_first_problem(problems: list[Notice], notices: tuple[Notice, ...]) -> None:
    """Raise Error for the first problem, with the others as notes, and with the warnings `notices`."""
    if problems:
        problem, *others = problems
        error = Error(problem.sentence, problem.where, code=problem.code, advice=problem.advice)
        for other in others:
            error.add_note(": ".join(filter(None, (other.where, other.text))))
        error.notices = notices
        raise error


@dataclass(frozen=True)
class SimulatedWork:
    """Work that was simulated and checked against all limits of a machine.

    suffix: the extension of the program, or ".json" for a plan.
    work: the work with its strokes in the requested order.
    cell: the cell as it is for this output.
    notes: notes for the header of the program.
    problems: what forbids writing the program, one notice for each kind.
    name: the stem of the file; "" for none.
    """

    suffix: str
    work: PreparedDrawing
    cell: Cell
    notes: tuple[str, ...]
    marks: object
    loads: PlanInLoads
    walk: CheckedProgram
    problems: list[Notice]
    order: str
    name: str = ""

    @property
    def is_program(self) -> bool:
        return self.suffix != ".json"

    def encoded(self) -> dict[str, bytes | str | Iterator[str]]:
        """Return the files of the program, see writer.in_parts. Raises Error if something forbids writing it."""
        work = self.work
        encoded_program = writer.encode_checked(
            self.suffix, work.plan, self.walk, work.brush, work.title, self.notes, self.name
        )
        return writer.in_parts(self.suffix, encoded_program)

    def remarks(self) -> list[Notice]:
        """Return the notices of a job that may be run."""
        first_stroke = self.walk.job.first_stroke
        order_notices = _check_stroke_order(self.work, self.order, first_stroke)
        lowering_notices = _check_lowering(self.walk.job.z_offset_mm) if self.is_program else []
        program_notices = writer.report_program(
            self.suffix, self.loads, self.work.brush, self.cell, self.name, first_stroke
        )
        return [*order_notices, *lowering_notices, *program_notices]

    def time_s(self) -> float | None:
        """Return how long the machine takes for the program, or for one of the plan."""
        return estimate_output_time_s(self.suffix, self.work.plan, self.walk, self.work.brush, self.work.options.cell)


def _check_lowering(z_offset_mm: float) -> list[Notice]:
    """Return a notice if the tool is lowered so far that it may be a mistake."""
    if z_offset_mm > -MAX_SILENT_LOWERING_MM:
        return []
    sentence = (
        f"the tool goes {-z_offset_mm:g} mm lower than the cell's paper; `brushsvg setup height` rarely finds so large "
        "a difference"
    )
    return [Notice("z_offset", sentence, code="unusual-value", about="z_offset")]


def _check_stroke_order(work: PreparedDrawing, order: str, first_stroke: int) -> list[Notice]:
    """Return a notice if strokes are painted with less or more paint than planned.

    Strokes are pressed as deep as the remaining paint requires. In another order, other strokes are painted before
    them.
    """
    is_pressed = work.brush.paint and work.strokes is not None
    if not is_pressed or work.options.compensation not in ("closed", "refined"):
        return []
    changes = ["in another order"] if order == "nearest" else []
    changes += [f"resumed freshly dipped at stroke {first_stroke}"] if first_stroke > 1 else []
    dips_mm = fetched_mm(work.plan, work.brush, work.options.cell) if changes else []
    if all(dips[:1] == [0.0] for dips in dips_mm):
        return []
    sentence = (
        "the depths of the strokes allow for the paint that is left in the drawing's order: "
        f"{' and '.join(changes)} they come out wider or narrower than drawn"
    )
    return [Notice("", sentence, code="paint-out-of-turn", advice="fetch paint more often: set [reload] in the cell")]


def simulate_and_check(
    work: PreparedDrawing,
    suffix: str,
    job: Job = WHOLE_JOB,
    order: str = "drawn",
    lenient: bool = False,
    rings: bool = False,
    stage=lambda text: None,
    marks=None,
    path: str = "",
) -> SimulatedWork:
    """Simulate a work and check it against all limits of its machine.

    suffix: the extension of the program, or ".json" for a plan.
    rings: also trace the outlines of the marks.
    marks: the marks of the same work in the same order, if they are known.
    path: the path of the program, for its name and for errors about its format; "" for none.
    """
    cell, brush, tolerance_mm = work.options.cell, work.brush, work.options.tolerance_mm
    notes = outputs.header_lines(work)
    if order == "nearest":
        work, notes = order_nearest_first(work), (*notes, "order: nearest first")
    if suffix != ".json":
        with name_file_in_errors(path):
            writer.post_for(suffix, cell)
        preflight.check_rounding(cell, tolerance_mm)
    if marks is None:
        marks = prediction.predict(work, rings, stage)
    loads = split_into_loads(work.plan, brush, cell)
    known_walk, is_drawing = work.walk(cell, job), work.strokes is not None
    walk = preflight.check_job(loads, brush, marks, cell, tolerance_mm, job, known_walk, is_drawing)
    damaged = [] if lenient else [notice for notice in work.notices if notice.damaged]
    problems = summarize_notices([*walk.problems, *damaged])
    if damaged:
        problems[-1] = replace(problems[-1], advice="--lenient paints the undamaged part")
    return SimulatedWork(suffix, work, cell, notes, marks, loads, walk, problems, order, Path(path).stem)


def estimate_time_s(loads: PlanInLoads, brush, cell: Cell) -> float | None:
    """Return how long the machine takes, or None if it cannot paint the plan.

    A picture does not require that the machine can paint the plan.
    """
    with suppress(Error):
        return writer.time_s(loads, brush, cell)
    return None


def estimate_output_time_s(suffix: str, plan, walk: CheckedProgram, brush, cell: Cell) -> float | None:
    """Return how long the machine takes for a program, or for one of a plan.json."""
    if suffix != ".json":
        return duration_s(walk.made)
    return estimate_time_s(split_into_loads(plan, brush, cell), brush, cell)
