"""A drawing to the program of a machine in one call: what `brushsvg convert` does, from Python."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from numbers import Integral
from typing import TYPE_CHECKING, Unpack

from .. import _core
from ..errors import Error, Notice, lacking, need, need_number, need_one_of, need_truth
from ..files import write_files
from ..machine import preflight, writer
from ..machine.arm.joints import is_installed
from ..machine.cells.cell import Cell
from ..machine.cells.cell_check import OF_EXAMPLE
from ..machine.motion import duration_s
from ..machine.paint_reload import PlanInLoads, fetched_mm, in_loads, too_long, with_one_pen, without_paint
from ..machine.posts import POSTS
from ..machine.program import WHOLE_JOB, Job, Walked, beyond_part
from ..machine.realised.smooth_field import beyond_field
from ..show.evaluation import report as reports
from ..text_summary import summarized
from . import cancelling, outputs, prediction
from .cancelling import Cancel
from .choices import (
    ChoiceKeywords,
    Choices,
    apply_drawing_settings,
    check_choices,
    choose_margin_strokes,
    make_options,
    name_file_in_errors,
    path_of,
    report_ineffective_flags,
    suffix_of,
)
from .preparation import preparation
from .work import Work, order_nearest_first

if TYPE_CHECKING:
    from .preparation.preparation import Source

ORDERS = ("drawn", "nearest")
MAX_SILENT_LOWERING_MM = 2.0  # by --z-offset, without a word: the strokes of `brushsvg setup height` try 1 mm
OUTPUT_SUFFIXES = {
    "picture": (".png", ".svg"),
    "report": (".txt", ".json", ".csv"),
    "page": (".pdf", ".svg"),
}  # of what is written next to a program


@dataclass(frozen=True)
class Conversion:
    """A drawing that became a plan, and what a machine runs.

    plan: TCP poses [mm] of each stroke; notices: warnings, none of which forbids to run it; time_s: how long a machine
    takes, None where it cannot paint a plan that was requested alone; texts: by extension (".ngc", ".json"); the
    others of a program in several files by what they add to its name ("-part2.script") or by their own; figures: how
    near the paint comes, a report with strokes and total, None unless requested; files: the paths that were written.
    """

    title: str
    plan: _core.Plan
    notices: tuple[Notice, ...]
    time_s: float | None
    texts: Mapping[str, str] = field(repr=False)
    figures: reports.Report | None = field(default=None, repr=False)
    files: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Of the first format."""
        return next(iter(self.texts.values()))


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
    """A drawing to a plan and a program, as `brushsvg convert` makes them, byte for byte. Nothing is written but to
    the paths given: all of them or none.

    drawing: a path, any other input of read_drawing, a Design, or a Plan.
    out: a program in the cell's language, or a plan (.json); picture: what will be painted (.png .svg); report: the
    figures (.txt .json .csv); page: to print and paint on (.pdf .svg).
    formats: extensions of the texts to return, by default that of out, else the first of the cell's language.
    figures: whether to measure overlap and errors, too. from_stroke: resumes a job there. order: "drawn", "nearest".
    lenient: paint what is sound of damaged geometry.
    progress: called with words on what is done. cancel: a callable or something with is_set(), as a threading.Event:
    polled 20 times a second in the caller's thread; once it says yes, concurrent.futures.CancelledError is raised
    within a second, and nothing is written.

    choices, by default what the drawing says: brush, cell: a name, path, Brush or Cell; sheet, fit (w, h),
    origin (x, y), width, lag, tolerance, z_offset: mm; paint_speed: mm/s; scale: a factor; units: "mm", "in";
    layer: a list of names; select: CSS; paths_as: "stroke", "outline"; wide: "auto", "clamp", "passes", "refuse";
    corners: "auto", "turn"; detail: "draft", "normal", "fine"; script: "auto", "latin", "arabic", "devanagari", "cjk";
    join: bool; compensation: "none", "constant", "closed", "refined"; terminals, start, end: "auto", "round", "butt",
    "pointed"; corrections: the path of what compare wrote; margin_strokes: "auto", "on", "off".
    docs/reference/options.md has them in a table.

    Raises Error, with a code of docs/reference/diagnostics.md, for what cannot be read, painted or run. Of several
    reasons it gives the first, its notes the others, its notices what was to be warned of.
    """
    chosen = make_choices(drawing, choices)
    extras = {"picture": picture, "report": report, "page": page}
    paths = {name: os.fspath(path) for name, path in extras.items() if _is_path_given(path, name)}
    out = os.fspath(out) if _is_path_given(out, "out") else None
    for name, path in paths.items():
        if suffix_of(path) not in OUTPUT_SUFFIXES[name]:
            sentence = f"{name} {path[:80]!r} does not end in {' or '.join(OUTPUT_SUFFIXES[name])}"
            raise Error(sentence, name, code="program-format")
    need(formats, (tuple, list), "a list of extensions, which formats is")
    for each in formats:
        need(each, str, "an extension, such as '.ngc'")
    need_one_of(order, ORDERS, "order")
    need_truth(lenient, "lenient")
    need_truth(figures, "figures")
    need(from_stroke, Integral, "a whole number, which from_stroke is")
    first = int(need_number(from_stroke, "from_stroke", 1, 1e8))
    job = Job(chosen.z_offset or 0.0, first)

    def work(stage) -> tuple[Conversion, dict]:
        return _make_conversion(
            chosen, out, paths, tuple(formats), bool(figures), job, order, bool(lenient), stage
        )

    done, files = cancelling.run(work, progress, cancel)
    if files:
        write_files(files)
    return replace(done, files=tuple(files))


def make_choices(drawing, choices: Mapping) -> Choices:
    """Choices by their names. Error for a name or value that there is not."""
    known = {name for name in Choices.__dataclass_fields__ if name != "input"}
    for name in choices:
        if name not in known:
            raise TypeError(f"{name!r} is no choice; known are {', '.join(sorted(known))}")
    return check_choices(Choices(input=drawing, **choices))


def _is_path_given(path, name: str) -> bool:
    if path is not None:
        need(path, (str, os.PathLike), f"a path, which {name} is")
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
        chosen = apply_drawing_settings(chosen, source)
        ignored = report_ineffective_flags(chosen)
        chosen = choose_margin_strokes(chosen) if "page" in paths else chosen
        work = preparation.prepare(source, make_options(chosen), stage)
        cell = work.options.cell
        if out is not None:
            formats = tuple(dict.fromkeys([suffix_of(out), *formats]))
        formats = formats or (default_suffix(cell),)
        files = {paths["page"]: outputs.page(suffix_of(paths["page"]), work)} if "page" in paths else {}
        tries = {}
        for suffix in formats:
            wants_rings = suffix_of(paths.get("picture")) == ".svg"
            marks = tries[formats[0]].marks if tries else None
            tries[suffix] = simulate_and_check(work, suffix, job, order, lenient, wants_rings, stage, marks)
            _raise_first_problem(tries[suffix].problems, work.notices)
        one = tries[formats[0]]
        stage("writing the program")
        texts: dict[str, str] = {}
        for suffix, each in tries.items():
            for name, pieces in each.encoded().items():
                text = pieces.decode() if isinstance(pieces, bytes) else "".join(pieces)
                texts[name + suffix] = text
                if out is not None and suffix == suffix_of(out):
                    files[writer.path_next_to(out, name)] = text
        if "picture" in paths:
            stage("drawing")
            files[paths["picture"]] = outputs.picture(suffix_of(paths["picture"]), one.work, one.marks)
        measured = None
        if figures or "report" in paths:
            stage("measuring")
            measured = outputs.reported(one.work, one.marks, cell)
        if "report" in paths:
            files[paths["report"]] = reports.as_text(suffix_of(paths["report"]), measured)
    of_machine = list_cell_notices(cell) if one.is_program else []
    notices = (*ignored, *one.work.notices, *one.remarks(), *of_machine)
    done = Conversion(work.title, one.work.plan, notices, one.time_s(), texts, measured)
    return done, dict(sorted(files.items(), key=lambda each: each[0] != out))  # the program first


def default_suffix(cell: Cell) -> str:
    post = POSTS.get(cell.language)
    return post.extensions[0] if post else ".json"


def _raise_first_problem(problems: list[Notice], notices: tuple[Notice, ...]) -> None:
    """Error for the first, with the others as notes. notices: what is to be warned of."""
    if problems:
        first, *others = problems
        error = Error(first.sentence, first.where, code=first.code, advice=first.advice)
        for other in others:
            error.add_note(": ".join(filter(None, (other.where, other.text))))
        error.notices = notices
        raise error


@dataclass(frozen=True)
class SimulatedWork:
    """Work that was simulated and held against all limits of a machine. suffix: of the program, or ".json" for a plan;
    work: with its strokes in the requested order; cell: as it is for that output; notes: for the header; problems: what
    forbids to write it, one for each kind."""

    suffix: str
    work: Work
    cell: Cell
    notes: tuple[str, ...]
    marks: object
    loads: PlanInLoads
    walk: Walked
    problems: list[Notice]
    order: str

    @property
    def is_program(self) -> bool:
        return self.suffix != ".json"

    def encoded(self) -> dict[str, bytes | str | Iterator[str]]:
        """What is written, see writer.in_parts. Error where something forbids it."""
        work = self.work
        made = writer.encoded(self.suffix, work.plan, self.walk, work.brush, work.title, self.notes)
        return writer.in_parts(self.suffix, made)

    def remarks(self) -> list[Notice]:
        """Return the notices of a job that may be run."""
        first = self.walk.job.first_stroke
        pens = with_one_pen(self.loads, self.cell, first) if self.is_program else []
        brush, cell = self.work.brush, self.cell
        out_of_turn = _check_stroke_order(self.work, self.order, first)
        beyond = beyond_field(self.loads.loads, cell) if self.is_program else []
        long = beyond_part(self.loads, self.cell) if self.is_program else []
        low = _check_lowering(self.walk.job.z_offset_mm) if self.is_program else []
        return [
            *without_paint(brush, cell),
            *out_of_turn,
            *too_long(self.loads, brush, cell),
            *pens,
            *beyond,
            *long,
            *low,
        ]

    def time_s(self) -> float | None:
        """How long the machine takes for the program, or for one of the plan."""
        return estimate_output_time_s(
            self.suffix, self.work.plan, self.walk, self.work.brush, self.work.options.cell
        )


def _check_lowering(z_offset_mm: float) -> list[Notice]:
    """A notice where the tool goes so much further down than the paper was taught that it may be a slip."""
    if z_offset_mm > -MAX_SILENT_LOWERING_MM:
        return []
    sentence = (
        f"the tool goes {-z_offset_mm:g} mm further down than where the cell has the paper, which the strokes of "
        "`brushsvg setup height` seldom ask for"
    )
    return [Notice("z_offset", sentence, code="unusual-value", about="z_offset")]


def _check_stroke_order(work: Work, order: str, first_stroke: int) -> list[Notice]:
    """A notice where strokes are pressed for paint that is left of others than those that are painted before them."""
    is_pressed = work.brush.paint and work.strokes is not None
    if not is_pressed or work.options.compensation not in ("closed", "refined"):
        return []
    how = ["in another order"] if order == "nearest" else []
    how += [f"resumed freshly dipped at stroke {first_stroke}"] if first_stroke > 1 else []
    dips_mm = fetched_mm(work.plan, work.brush, work.options.cell) if how else []
    if all(dips[:1] == [0.0] for dips in dips_mm):
        return []
    sentence = (
        "strokes are pressed as deep as the paint that the drawing's order leaves asks for: "
        f"{' and '.join(how)} they come out wider or narrower than drawn"
    )
    return [
        Notice("", sentence, code="paint-out-of-turn", advice="fetch paint more often: [reload] of the cell")
    ]


def simulate_and_check(
    work: Work,
    suffix: str,
    job: Job = WHOLE_JOB,
    order: str = "drawn",
    lenient: bool = False,
    rings: bool = False,
    stage=lambda text: None,
    marks=None,
    path: str = "",
) -> SimulatedWork:
    """rings: trace the marks' outlines; marks: of the same work in the same order, where they are known; path: of the
    program, for errors about its format."""
    cell, brush, tolerance_mm = work.options.cell, work.brush, work.options.tolerance_mm
    notes = outputs.notes(work)
    if order == "nearest":
        work, notes = order_nearest_first(work), (*notes, "order: nearest first")
    if suffix != ".json":
        with name_file_in_errors(path):
            writer.post_for(suffix, cell)
        preflight.check_rounding(cell, tolerance_mm)
    if marks is None:
        marks = prediction.predict(work, rings, stage)
    loads = in_loads(work.plan, brush, cell)
    known, of_drawing = work.walk(cell, job), work.strokes is not None
    walk = preflight.look(loads, brush, marks, cell, tolerance_mm, job, known, of_drawing)
    damaged = [] if lenient else [notice for notice in work.notices if notice.damaged]
    problems = summarized([*walk.problems, *damaged])
    if damaged:
        problems[-1] = replace(problems[-1], advice="--lenient draws what is sound")
    return SimulatedWork(suffix, work, cell, notes, marks, loads, walk, problems, order)


def estimate_time_s(loads: PlanInLoads, brush, cell: Cell) -> float | None:
    """How long the machine takes; None where it cannot paint this, which a picture does not ask."""
    with suppress(Error):
        return writer.time_s(loads, brush, cell)
    return None


def estimate_output_time_s(suffix: str, plan, walk: Walked, brush, cell: Cell) -> float | None:
    """How long the machine takes for a program that was gone through, or for one of a plan.json."""
    if suffix != ".json":
        return duration_s(walk.made)
    return estimate_time_s(in_loads(plan, brush, cell), brush, cell)


def list_cell_notices(cell: Cell) -> list[Notice]:
    """What makes a program less sure than it looks: a paper that nobody taught, an arm that is not followed."""
    return [*([OF_EXAMPLE] if cell.paper.example else []), *list_arm_notices(cell)]


def list_arm_notices(cell: Cell) -> list[Notice]:
    if not cell.arm or is_installed():
        return []
    sentence = f"whether arm {cell.arm.name} reaches all that is painted was not looked at"
    advice = lacking("its joints need", "ssik").sentence
    return [Notice("arm", sentence, code="arm-not-followed", advice=advice)]
