"""brushsvg compare: photographs of a painted job held against what was wanted and predicted."""

from __future__ import annotations

from dataclasses import replace

from ...errors import Error, Notice
from ...evaluation import report as figures
from ...files import read_bytes
from ...machine.cell import axes_along_paper
from ...machine.cell_file import parse_cell, write_cell
from ...painted.corrections import (
    aside_before_mm,
    beside_machine,
    corrected,
    machine_sha256,
    refuse_corrected,
)
from ...pipeline import prediction
from ..console import RefusedError, about, stage, tell, warn
from ..steps.options import corrections_of, settled, typed
from ..steps.output_places import check_places, suffix_of, write
from ..steps.prepared import prepare


def compare_files(args) -> None:
    import hashlib

    from ...calibration.from_prior import has_learned
    from ...painted.beside_machine import beside_machine as left_beside
    from ...painted.comparison import Wanted, compare_photos
    from ...painted.ends import ends_of
    from ...painted.fault_model import BRUSH
    from ...painted.faults import whose_fault
    from ...painted.job_marks import job_marks
    from ...painted.job_page import job_page
    from ...painted.mended_cell import mended, sure
    from ...painted.next_time import farther, next_corrections
    from ...painted.picture import comparison_png
    from ...painted.report import Made, as_json, as_text

    check_places(args.output, args.picture, args.mended_cell)
    work = prepare(settled(typed(args, corrections=None), args.input))
    before = corrections_of(args.corrections)
    warn(args.input, work.notices)
    with about(args.input):
        refuse_corrected(work.plan)
        marks = prediction.predict(work, True, stage)
        undone = work.options.cell.machine if work.options.cell else None
        before = beside_machine(before, undone)
        told = corrected(work.plan, before, work.brush)
        page = job_page(told, work.title)
        wanted = {} if work.strokes is None else {one.id: figures.wanted_rings([one]) for one in work.strokes}
        strokes = [
            Wanted(each.stroke, wanted.get(each.stroke), [ring for ring in each.outline_mm])
            for each in marks.passes
        ]
    if args.sheets:
        _repeats(args, work, page, told, strokes)
        return
    with about(args.photos[0]):
        stage("reading the photographs")
        photos = [(path, read_bytes(path)) for path in args.photos]
        found = compare_photos(page, strokes, photos)
    stage("looking for what is amiss")
    learned = has_learned(work.brush, [hashlib.sha256(data).hexdigest() for _, data in photos])
    faults = whose_fault(told, work.brush, strokes, found, learned)
    corrections, too_far = next_corrections(found, work.plan, before, work.brush)
    beyond = farther(found, aside_before_mm(args.corrections)) if args.corrections else []
    warn(args.photos[0], [*found.notices, *too_far, *beyond])
    cell = work.options.cell
    along = axes_along_paper(cell) if cell else None
    machine = mended(faults, found.middle_mm, cell.machine, along) if faults else None
    title = work.title or "untitled"
    files = {}
    beside = None
    if machine and faults:
        rest = left_beside(found, sure(faults, cell.machine, along), told, work.brush, strokes)
        beside = machine_sha256(machine), next_corrections(rest, work.plan, before, work.brush)[0]
    ends = ends_of(found, strokes, work.strokes or ())
    made_with = Made(work.brush.sha256, work.plan.brush_sha256, machine_sha256(undone))
    any_alone = faults is None or faults.first != BRUSH or bool(job_marks(found, page, strokes).rings)
    as_words = as_text(title, found, faults, ends, machine, any_alone)
    as_figures = as_json(title, found, corrections, faults, ends, made_with, beside)
    if args.output:
        files[args.output] = as_figures if suffix_of(args.output) == ".json" else as_words
    if args.picture:
        files[args.picture] = comparison_png(page, strokes, found, title, faults)
    if args.mended_cell:
        with about(args.mended_cell):
            files[args.mended_cell] = _cell_text(replace(cell, machine=machine or cell.machine))
        if machine is None:
            sentence = (
                "nothing is certain to be amiss of the machine or the paper's height: the cell is as it was"
            )
            warn(args.mended_cell, [Notice("machine", sentence, code="cell-unchanged")])
    if files:
        write(args, files)
    tell(as_figures if args.json else as_words)
    reached = found.overlap_wanted if found.overlap_wanted is not None else found.overlap_predicted
    if args.at_least is not None and reached < args.at_least:
        raise RefusedError(
            args.photos[0],
            [
                Error(
                    f"the overlap {reached:.3f} is below {args.at_least:g}", value=reached, code="overlap-low"
                ).notice()
            ],
        )


def _cell_text(cell) -> str:
    """Error where a number of its machine is beyond what a cell may have."""
    text = write_cell(cell)
    parse_cell(text)
    return text


def _repeats(args, work, page, plan, strokes) -> None:
    """How well the same strokes lie on several sheets, or copies of strokes on one."""
    from ...painted.comparison import compare_sheets
    from ...painted.repeats import as_json, as_text, repeats
    from ...painted.repeats_picture import repeats_png

    with about(args.photos[0]):
        stage("reading the photographs")
        sheets = compare_sheets(page, strokes, [(path, read_bytes(path)) for path in args.photos])
    for path, sheet in zip(args.photos, sheets, strict=True):
        warn(path, list(sheet.notices))
    with about(args.photos[0]):
        found = repeats(plan, sheets)
    title, files = work.title or "untitled", {}
    if args.output:
        makes = as_json if suffix_of(args.output) == ".json" else as_text
        files[args.output] = makes(title, found)
    if args.picture:
        files[args.picture] = repeats_png(title, found, sheets, strokes)
    if files:
        write(args, files)
    tell(as_json(title, found) if args.json else as_text(title, found))
