"""Compare photographs of a painted sheet with its targets and predictions.

These are the steps of `brushsvg compare`, which Python users can call as well.
"""

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
from ..comparison.attribution.corrected_cell import (
    corrected_machine,
    key_of,
    select_certain_numbers,
    significant_part,
    subtract_faults,
)
from ..comparison.attribution.faults import Faults, attribute_errors
from ..comparison.attribution.model import BRUSH
from ..comparison.corrections import (
    Correction,
    SheetBefore,
    apply_corrections,
    is_corrected,
    machine_sha256,
    remove_corrections,
    select_for_machine,
)
from ..comparison.ends import Ends, measure_ends
from ..comparison.job_marks import job_marks
from ..comparison.job_page import JobPage, job_page
from ..comparison.next_corrections import find_growing_displacements, next_corrections
from ..comparison.photographs import Compared, Comparison, TargetStroke, compare_photos, select_drawn_strokes
from ..comparison.picture import comparison_png
from ..errors import Error, Notice, name_file_in_errors, require_type
from ..files import read_bytes
from ..machine.cells.cell import Cell, Machine, axes_along_paper, list_uncorrectable_keys
from ..machine.cells.cell_file import own_name, parse_cell, write_cell
from ..reporting.report_text import Report
from ..show.evaluation.figures import target_rings
from . import cancelling, prediction
from .cancelling import Cancel
from .checking import Warn
from .choices.choices import ChoiceKeywords, Choices, choose_margin_strokes, path_of
from .choices.drawing_settings import fill_from_drawing
from .choices.ineffective_flags import report_ineffective_flags
from .conversion import make_choices
from .options import load_sheet_before, make_options
from .preparation import preparation
from .preparation.margin_strokes import is_margin
from .prepared_drawing import PreparedDrawing

if TYPE_CHECKING:
    from .preparation.preparation import Source

Read = TypeVar("Read")


# As fractions. Printers scale a page by at least 2 %, and both axes by the same factor.
MIN_PRINT_SCALE_ERROR, MAX_AXIS_SCALE_DIFFERENCE = 0.015, 0.006


@dataclass(frozen=True)
class Sheet:
    """The plan that was commanded to the machine, and the page that it painted on.

    plan: the plan with the corrections of the sheet before, as far as they belong to its cell.
    strokes: the outlines of targets and predictions, on the sheet.
    alternative: makes the sheet of the other page that this drawing may have been painted on, without margin strokes.
    """

    work: PreparedDrawing
    plan: _core.Plan
    before: SheetBefore
    page: JobPage
    strokes: tuple[TargetStroke, ...]
    alternative: Callable[[], Sheet] | None = None

    @property
    def title(self) -> str:
        return self.work.title or "untitled"


@dataclass(frozen=True)
class PaintedJob:
    """What photographs of a painted sheet show.

    overlap: overlap of all paint, as painted, with the target, or with the prediction if there is no drawing.
    strokes: for each stroke its overlaps and its place.
    ends: by stroke, how much later than the target it begins and ends.
    faults: the causes of the errors; None if there are too few data.
    corrections: by stroke, where to move it on the next sheet.
    cell: the cell with a [machine] that also corrects all certain errors.
    is_corrected: whether the cell corrects any error.
    notices: warnings.
    report: the verdict, lines and details that the command prints. report.text(details=True) has all tables.
    json: the text that `convert` takes as corrections.
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
        """Return a picture of the photographed paint over the target, as a PNG.

        The target is grey, a red line shows the prediction, and the worst places have the numbers of the report.
        """
        if self._shown is None:
            raise Error("this comparison was not made from photographs", code="nothing-to-show")
        return comparison_png(*self._shown, self.faults)


def compare(
    drawing: Source,
    photos: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    progress: Callable[[str], object] | None = None,
    cancel: Cancel | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> PaintedJob:
    """Compare photographs of one painted sheet with targets and predictions.

    This is what `brushsvg compare` does.

    drawing: what was painted, as `convert` takes it.
    photos: the path of a photograph, or a list of paths of photographs, which are averaged.
    progress, cancel: as for `convert`.
    choices: the choices that the drawing was converted with, including the corrections that it was painted with.

    Raises Error, with a code of docs/reference/diagnostics.md, for a photograph that cannot be read or shows
    another job.
    """
    single = isinstance(photos, (str, os.PathLike))
    require_type(photos, (str, os.PathLike, tuple, list), "a path or a list of paths", "photos")
    paths = [photos] if single else list(photos)
    if not paths:
        raise Error("there is no photograph", "photos", code="wrong-type")
    for path in paths:
        require_type(path, (str, os.PathLike), "a path", "each of photos")
    chosen, notices = make_choices(drawing, choices), []

    def work(stage) -> PaintedJob:
        def warn(_, warnings):
            notices.extend(warnings)

        return compare_sheet(prepare_painted_sheet(chosen, stage, warn), [*map(os.fspath, paths)], stage, warn)

    return replace(cancelling.run(work, progress, cancel), notices=tuple(notices))


def prepare_painted_sheet(chosen: Choices, stage: Callable[[str], object], warn: Warn) -> Sheet:
    """Return the contents of the painted page. Notices are reported with their file."""
    before = load_sheet_before(chosen.corrections)
    return _prepare_sheet(replace(chosen, corrections=None), before, stage, warn)


def _prepare_sheet(given: Choices, before: SheetBefore, stage: Callable[[str], object], warn: Warn) -> Sheet:
    name = path_of(given.input)
    with name_file_in_errors(name):
        chosen = fill_from_drawing(given, given.input)
        warn(name, report_ineffective_flags(chosen))
        chosen = choose_margin_strokes(chosen)
        work = preparation.prepare(chosen.input, make_options(chosen), stage)
        warn(name, work.notices)
        corrected_plan, given_before = None, before
        if is_corrected(work.plan):  # a plan.json with corrections says which corrections it was painted with
            _refuse_second_corrections(before)
            corrected_plan = work.plan
            uncorrected_plan, known_corrections = remove_corrections(corrected_plan)
            work, before = replace(work, plan=uncorrected_plan), SheetBefore(known_corrections)
        marks = prediction.predict(work, True, stage)
        before = replace(before, corrections=select_for_machine(before.corrections, _get_cell_machine(work)))
        plan = corrected_plan or apply_corrections(work.plan, before.corrections, work.brush)
        target = {} if work.strokes is None else {stroke.id: target_rings([stroke]) for stroke in work.strokes}
        strokes = (
            TargetStroke(mark.stroke, target.get(mark.stroke), [*mark.outline_mm], not is_margin(a_pass))
            for mark, a_pass in zip(marks.passes, work.plan.passes, strict=True)
        )
        alternative = None
        if given.margin_strokes is None and any(map(is_margin, work.strokes or ())):
            without_margin = replace(given, margin_strokes="off")
            alternative = functools.partial(_prepare_sheet, without_margin, given_before, stage, ignore_notices)
        return Sheet(work, plan, before, job_page(plan, work.title), tuple(strokes), alternative)


def ignore_notices(file: str, notices: Iterable[Notice]) -> None:
    """Ignore warnings that were printed when the drawing was first prepared."""


def read_matching_page(sheet: Sheet, read: Callable[[Sheet], Read]) -> tuple[Sheet, Read]:
    """Read photographs with the sheet whose page they show. Returns that sheet, and what `read` returned for it."""
    try:
        return sheet, read(sheet)
    except Error as refusal:
        if refusal.code != "photo-of-another-chart" or sheet.alternative is None:
            raise
    sheet = sheet.alternative()
    return sheet, read(sheet)


def _refuse_second_corrections(given: SheetBefore) -> None:
    if given.corrections:
        sentence = "the plan was written with corrections and holds them: leave --corrections out"
        raise Error(sentence, "corrections", code="corrections-twice")


def read_photos(paths: Iterable[str], stage: Callable[[str], object]) -> list[tuple[str, bytes]]:
    """Return the paths of photographs with the contents of the files."""
    stage("reading the photographs")
    return [(path, read_bytes(path)) for path in paths]


def compare_sheet(sheet: Sheet, paths: list[str], stage: Callable[[str], object], warn: Warn) -> PaintedJob:
    """Compare photographs with a sheet.

    paths: the paths of photographs of one sheet. Notices are reported with the first path.
    """
    with name_file_in_errors(paths[0]):
        photos = read_photos(paths, stage)
        sheet, comparison = read_matching_page(
            sheet, lambda candidate: compare_photos(candidate.page, [*candidate.strokes], photos)
        )
    work, brush, strokes = sheet.work, sheet.work.brush, list(sheet.strokes)
    stage("estimating faults")
    before_selection = comparison, sheet.page, strokes
    comparison, strokes = select_drawn_strokes(comparison, strokes)
    learned = has_learned(brush, [hashlib.sha256(data).hexdigest() for _, data in photos])
    faults = attribute_errors(sheet.plan, brush, strokes, comparison, learned)
    before = sheet.before.corrections
    corrections, too_far = next_corrections(comparison, work.plan, before, brush)
    displacement_notices = find_growing_displacements(comparison, sheet.before.displacement_mm)
    warn(paths[0], [*comparison.notices, *too_far, *displacement_notices])
    cell, machine, residual = work.options.cell, None, None
    if cell and faults:
        axes = axes_along_paper(cell)
        machine, left_out = _find_correctable_machine(faults, comparison.middle_mm, cell, axes)
        warn(paths[0], _report_uncorrectable(faults, cell, left_out))
        if machine:
            certain = significant_part(faults, cell.machine, axes, left_out)
            remaining = subtract_faults(comparison, certain, sheet.plan, brush, strokes)
            residual = machine_sha256(machine), next_corrections(remaining, work.plan, before, brush)[0]
    ends = measure_ends(comparison, strokes, work.strokes or ())
    made_with = report.SheetFingerprints(brush.sha256, work.plan.brush_sha256, machine_sha256(_get_cell_machine(work)))
    has_isolated_marks = faults is None or faults.first != BRUSH or bool(job_marks(*before_selection).rings)
    places = report.places_of(comparison, strokes)
    return PaintedJob(
        sheet.title,
        comparison.overlap_predicted if comparison.overlap_target is None else comparison.overlap_target,
        comparison.strokes,
        ends,
        faults,
        corrections,
        replace(cell, name=own_name(cell.name), machine=machine) if machine else cell,
        machine is not None,
        (),
        report.report(sheet.title, comparison, faults, ends, places, machine, has_isolated_marks),
        report.as_json(sheet.title, comparison, corrections, faults, ends, made_with, residual),
        (sheet.page, strokes, comparison, sheet.title, places),
    )


def _find_correctable_machine(faults: Faults, middle_mm, cell: Cell, axes) -> tuple[Machine | None, dict[str, str]]:
    """Return the next cell's machine without numbers that the cell refuses, and by key why they are left out."""
    left_out = list_uncorrectable_keys(cell)
    if print_scale := _estimate_print_scale(faults):
        left_out["scale"] = f"the page was probably printed at {100 * print_scale:.1f} %"
    while True:
        machine = corrected_machine(faults, middle_mm, cell.machine, axes, left_out)
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
    """Return notices on certain errors of the machine that the cell cannot correct."""
    certain_errors = [name for name, value in select_certain_numbers(faults).items() if value]
    print_scale = _estimate_print_scale(faults)
    uncorrectable = [
        name for name in certain_errors if key_of(name) in left_out and not (print_scale and key_of(name) == "scale")
    ]
    notices = []
    if print_scale:
        sentence = f"the page was probably printed at {100 * print_scale:.1f} %: both axes are off by this much"
        advice = "measure its bar and print it at 100 %; the corrected cell does not include this scale"
        notices.append(Notice("page", sentence, code="page-scale", advice=advice))
    if not uncorrectable:
        return notices
    why = "; ".join(dict.fromkeys(left_out[key_of(name)] for name in uncorrectable))
    sentence = f"cell {cell.name} cannot undo {', '.join(uncorrectable)}: {why}"
    advice = "repair the machine, or give the corrections to convert"
    return [*notices, Notice("machine", sentence, code="machine-not-undone", advice=advice)]


def _estimate_print_scale(faults: Faults) -> float | None:
    """Return the probable scale of the printed page, or None if it looks unscaled.

    If both axes of the machine seem to have the same scale error, the print is the probable cause. Printers shrink
    a page to their printable area, and machines seldom have the same fault in both axes.
    """
    x, y = (select_certain_numbers(faults).get(f"scale in {axis}", 0.0) for axis in "xy")
    if min(abs(x), abs(y)) < MIN_PRINT_SCALE_ERROR or abs(x - y) > MAX_AXIS_SCALE_DIFFERENCE:
        return None
    return 1.0 / (1.0 + (x + y) / 2)


def _get_cell_machine(work: PreparedDrawing):
    return work.options.cell.machine if work.options.cell else None
