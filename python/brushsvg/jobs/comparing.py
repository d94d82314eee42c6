"""Compare photographs of a painted sheet with its targets and predictions: what `brushsvg compare` does, from
Python."""

from __future__ import annotations

import functools
import hashlib
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar, Unpack

from .. import _core
from ..calibration.prior.from_prior import has_learned
from ..comparison import report
from ..comparison.attribution.corrected_cell import certain_of, corrected_machine, key_of, sure
from ..comparison.attribution.faults import Faults, attribute_errors
from ..comparison.attribution.model import BRUSH
from ..comparison.attribution.residual import subtract_faults
from ..comparison.corrections import (
    Correction,
    SheetBefore,
    corrected,
    is_corrected,
    machine_sha256,
    select_for_machine,
    uncorrected,
)
from ..comparison.ends import Ends, ends_of
from ..comparison.job_marks import job_marks
from ..comparison.job_page import JobPage, job_page
from ..comparison.next_corrections import farther, next_corrections
from ..comparison.photographs import Compared, Comparison, TargetStroke, compare_photos, of_drawing
from ..comparison.picture import comparison_png
from ..errors import Error, Notice, need
from ..files import read_bytes
from ..machine.cells.cell import Cell, Machine, axes_along_paper, not_undone
from ..machine.cells.cell_file import own_name, parse_cell, write_cell
from ..reporting.report_text import Report
from ..show.evaluation.report import target_rings
from . import cancelling, prediction
from .cancelling import Cancel
from .checking import Warn
from .choices import (
    ChoiceKeywords,
    Choices,
    apply_drawing_settings,
    choose_margin_strokes,
    load_sheet_before,
    make_options,
    name_file_in_errors,
    path_of,
    report_ineffective_flags,
)
from .conversion import make_choices
from .preparation import preparation
from .preparation.margin_strokes import is_margin
from .work import Work

if TYPE_CHECKING:
    from .preparation.preparation import Source

Read = TypeVar("Read")


MIN_PRINT_SCALE_ERROR, MAX_AXIS_SCALE_DIFFERENCE = (
    0.015,
    0.006,
)  # shares: print scales begin at 2 %, and both axes share one


@dataclass(frozen=True)
class Sheet:
    """What was commanded to the machine, and the page that it painted on: plan, with the corrections of before, as far
    as they are of its cell; strokes: rings on the sheet of targets and predictions; otherwise: makes the sheet of
    the other page that this drawing may have been painted on, without strokes in its margin."""

    work: Work
    plan: _core.Plan
    before: SheetBefore
    page: JobPage
    strokes: tuple[TargetStroke, ...]
    otherwise: Callable[[], Sheet] | None = None

    @property
    def title(self) -> str:
        return self.work.title or "untitled"


@dataclass(frozen=True)
class PaintedJob:
    """What photographs of a painted sheet show.

    overlap: of all paint with the target, or with the prediction where there is no drawing, as painted. strokes: each
    with its overlaps and its place; ends: by stroke, how much later than the target it begins and ends. faults: the
    causes, None where there are too few data. corrections: by stroke, where to move it next time. cell: with a
    [machine] that also corrects what is certain; is_corrected: whether anything is. notices: the warnings. report: its
    verdict, lines and details, as the command prints them; report.text(details=True) has all tables.
    json: what `convert` takes as corrections.
    """

    title: str
    overlap: float
    strokes: tuple[Compared, ...] = field(repr=False)
    ends: dict[str, Ends] = field(repr=False)
    faults: Faults | None = field(repr=False)
    corrections: dict[str, Correction] = field(repr=False)
    cell: Cell = field(repr=False)
    is_corrected: bool
    notices: tuple[Notice, ...] = field(repr=False)
    report: Report = field(repr=False)
    json: str = field(repr=False)
    _shown: tuple[JobPage, list[TargetStroke], Comparison, str, list] | None = field(
        default=None, repr=False, compare=False
    )

    @property
    def text(self) -> str:
        """The report in at most ten lines, the verdict first."""
        return self.report.text()

    def picture(self) -> bytes:
        """A PNG: the paint as photographed over the target, in grey, under a red line where it was predicted, with
        the numbers of the report's worst places."""
        if self._shown is None:
            raise Error("it was not made of photographs", code="nothing-to-show")
        return comparison_png(*self._shown, self.faults)


def compare(
    drawing: Source,
    photos: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    progress: Callable[[str], object] | None = None,
    cancel: Cancel | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> PaintedJob:
    """Compare photographs of one painted sheet with targets and predictions, as `brushsvg compare` does.

    drawing: what was painted, as `convert` takes it, with the choices that it was converted with; corrections: those
    that it was painted with. photos: the path of one, or a list of them, which are averaged. progress, cancel: as for
    `convert`.

    Raises Error, with a code of docs/reference/diagnostics.md, for a photograph that cannot be read or shows
    another job.
    """
    single = isinstance(photos, (str, os.PathLike))
    need(photos, (str, os.PathLike, tuple, list), "a path or a list of paths, which photos are")
    paths = [photos] if single else list(photos)
    if not paths:
        raise Error("there is no photograph", "photos", code="wrong-type")
    for each in paths:
        need(each, (str, os.PathLike), "a path, which each of photos is")
    chosen, notices = make_choices(drawing, choices), []

    def work(stage) -> PaintedJob:
        def warn(_, found):
            notices.extend(found)

        return compare_sheet(
            prepare_painted_sheet(chosen, stage, warn), [*map(os.fspath, paths)], stage, warn
        )

    return replace(cancelling.run(work, progress, cancel), notices=tuple(notices))


def prepare_painted_sheet(chosen: Choices, stage: Callable[[str], object], warn: Warn) -> Sheet:
    """Return the contents of the painted page; notices are reported with the file that they are of."""
    before = load_sheet_before(chosen.corrections)
    return _prepare_sheet(replace(chosen, corrections=None), before, stage, warn)


def _prepare_sheet(given: Choices, before: SheetBefore, stage: Callable[[str], object], warn: Warn) -> Sheet:
    name = path_of(given.input)
    with name_file_in_errors(name):
        chosen = apply_drawing_settings(given, given.input)
        warn(name, report_ineffective_flags(chosen))
        chosen = choose_margin_strokes(chosen)
        work = preparation.prepare(chosen.input, make_options(chosen), stage)
        warn(name, work.notices)
        painted, corrections_before = None, before
        if is_corrected(work.plan):  # a plan.json, which says itself what it was painted with
            _refuse_second_corrections(before)
            painted = work.plan
            planned, known = uncorrected(painted)
            work, before = replace(work, plan=planned), SheetBefore(known)
        marks = prediction.predict(work, True, stage)
        before = replace(before, corrections=select_for_machine(before.corrections, _get_cell_machine(work)))
        plan = painted or corrected(work.plan, before.corrections, work.brush)
        target = {} if work.strokes is None else {one.id: target_rings([one]) for one in work.strokes}
        strokes = (
            TargetStroke(mark.stroke, target.get(mark.stroke), [*mark.outline_mm], not is_margin(a_pass))
            for mark, a_pass in zip(marks.passes, work.plan.passes, strict=True)
        )
        otherwise = None
        if given.margin_strokes is None and any(map(is_margin, work.strokes or ())):
            without = replace(given, margin_strokes="off")
            otherwise = functools.partial(_prepare_sheet, without, corrections_before, stage, ignore_notices)
        return Sheet(work, plan, before, job_page(plan, work.title), tuple(strokes), otherwise)


def ignore_notices(file: str, notices: Iterable[Notice]) -> None:
    """Keep warnings from being printed twice when a drawing is prepared again."""


def read_matching_page(sheet: Sheet, read: Callable[[Sheet], Read]) -> tuple[Sheet, Read]:
    """What photographs show, read with the sheet whose page they show."""
    try:
        return sheet, read(sheet)
    except Error as refusal:
        if refusal.code != "photo-of-another-chart" or sheet.otherwise is None:
            raise
    sheet = sheet.otherwise()
    return sheet, read(sheet)


def _refuse_second_corrections(given: SheetBefore) -> None:
    if given.corrections:
        sentence = "the plan was written with corrections and holds them: leave --corrections out"
        raise Error(sentence, "corrections", code="corrections-twice")


def read_photos(paths: Iterable[str], stage: Callable[[str], object]) -> list[tuple[str, bytes]]:
    """Names, and what their files hold."""
    stage("reading the photographs")
    return [(path, read_bytes(path)) for path in paths]


def compare_sheet(sheet: Sheet, paths: list[str], stage: Callable[[str], object], warn: Warn) -> PaintedJob:
    """paths: photographs of one sheet; notices are reported with the first of them."""
    with name_file_in_errors(paths[0]):
        photos = read_photos(paths, stage)
        sheet, found = read_matching_page(sheet, lambda one: compare_photos(one.page, [*one.strokes], photos))
    work, brush, strokes = sheet.work, sheet.work.brush, list(sheet.strokes)
    stage("estimating faults")
    every = found, sheet.page, strokes
    found, strokes = of_drawing(found, strokes)
    learned = has_learned(brush, [hashlib.sha256(data).hexdigest() for _, data in photos])
    faults = attribute_errors(sheet.plan, brush, strokes, found, learned)
    before = sheet.before.corrections
    corrections, too_far = next_corrections(found, work.plan, before, brush)
    beyond = farther(found, sheet.before.displacement_mm)
    warn(paths[0], [*found.notices, *too_far, *beyond])
    cell, machine, residual = work.options.cell, None, None
    if cell and faults:
        along = axes_along_paper(cell)
        machine, left_out = _find_correctable_machine(faults, found.middle_mm, cell, along)
        warn(paths[0], _report_uncorrectable(faults, cell, left_out))
        if machine:
            certain = sure(faults, cell.machine, along, left_out)
            rest = subtract_faults(found, certain, sheet.plan, brush, strokes)
            residual = machine_sha256(machine), next_corrections(rest, work.plan, before, brush)[0]
    ends = ends_of(found, strokes, work.strokes or ())
    made_with = report.Made(brush.sha256, work.plan.brush_sha256, machine_sha256(_get_cell_machine(work)))
    any_alone = faults is None or faults.first != BRUSH or bool(job_marks(*every).rings)
    places = report.places_of(found, strokes)
    return PaintedJob(
        sheet.title,
        found.overlap_predicted if found.overlap_target is None else found.overlap_target,
        found.strokes,
        ends,
        faults,
        corrections,
        replace(cell, name=own_name(cell.name), machine=machine) if machine else cell,
        machine is not None,
        (),
        report.report(sheet.title, found, faults, ends, places, machine, any_alone),
        report.as_json(sheet.title, found, corrections, faults, ends, made_with, residual),
        (sheet.page, strokes, found, sheet.title, places),
    )


def _find_correctable_machine(
    faults: Faults, middle_mm, cell: Cell, along
) -> tuple[Machine | None, dict[str, str]]:
    """The machine for the next cell, without the numbers that such a cell refuses; and why, by key."""
    left_out = not_undone(cell)
    if printed := _estimate_print_scale(faults):
        left_out["scale"] = f"the page was probably printed at {100 * printed:.1f} %"
    while True:
        machine = corrected_machine(faults, middle_mm, cell.machine, along, left_out)
        try:
            if machine:
                parse_cell(write_cell(replace(cell, machine=machine)))
            return machine, left_out
        except Error as problem:
            key = problem.where.removeprefix("machine.")
            if key == problem.where or key in left_out:
                raise
            left_out[key] = str(problem)


def _report_uncorrectable(faults: Faults, cell: Cell, left_out: dict[str, str]) -> list[Notice]:
    """One notice on all that is certain of the machine and goes into no cell of its kind."""
    certain = [name for name, value in certain_of(faults).items() if value]
    printed = _estimate_print_scale(faults)
    rest = [
        name for name in certain if key_of(name) in left_out and not (printed and key_of(name) == "scale")
    ]
    notices = []
    if printed:
        sentence = f"the page was probably printed at {100 * printed:.1f} %: both axes seem to be as much off"
        advice = "measure its bar and print it at 100 %; the scale goes into no cell"
        notices.append(Notice("page", sentence, code="page-scale", advice=advice))
    if not rest:
        return notices
    why = "; ".join(dict.fromkeys(left_out[key_of(name)] for name in rest))
    sentence = f"cell {cell.name} cannot undo {', '.join(rest)}: {why}"
    advice = "repair the machine, or give the corrections to convert"
    return [*notices, Notice("machine", sentence, code="machine-not-undone", advice=advice)]


def _estimate_print_scale(faults: Faults) -> float | None:
    """The scale of the page's print, where both axes of the machine seem to be off by as much: printers shrink a page
    to its printable area, and machines seldom have the same fault in both axes."""
    x, y = (certain_of(faults).get(f"scale in {axis}", 0.0) for axis in "xy")
    if min(abs(x), abs(y)) < MIN_PRINT_SCALE_ERROR or abs(x - y) > MAX_AXIS_SCALE_DIFFERENCE:
        return None
    return 1.0 / (1.0 + (x + y) / 2)


def _get_cell_machine(work: Work):
    return work.options.cell.machine if work.options.cell else None
