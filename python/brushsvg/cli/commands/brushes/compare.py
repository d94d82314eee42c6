"""brushsvg compare: compare photographs of a painted job with its target.

The target is the drawing; the paint is also compared with the prediction.
"""

from __future__ import annotations

from ....errors import Error, Notice
from ....machine.cells.cell_file import parse_cell, write_cell
from ....reporting.report_text import format_overlap
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, suffix_of, write_outputs


def compare_files(args) -> None:
    from ....jobs.comparing import compare_sheet, prepare_painted_sheet

    sources = _list_source_files(args)
    check_outputs(args, args.output, args.picture, args.corrected_cell, sources=sources)
    with refuse_errors(args.input):
        sheet = prepare_painted_sheet(make_choices(args), stage, warn)
    if args.sheets:
        _report_repeats(args, sheet)
        return
    with refuse_errors(args.photos[0]):
        job = compare_sheet(sheet, args.photos, stage, warn)
    files, details = {}, args.details
    if args.output:
        files[args.output] = job.json if suffix_of(args.output) == ".json" else job.report.text(details)
    if args.picture:
        files[args.picture] = job.picture()
    if args.corrected_cell:
        with refuse_errors(args.corrected_cell):
            files[args.corrected_cell] = _write_checked_cell(job.cell)
        if not job.is_corrected:
            sentence = "no error of the machine or the paper's height is certain: the cell is unchanged"
            warn(args.corrected_cell, [Notice("machine", sentence, code="cell-unchanged")])
    if files:
        write_outputs(args, files, sources=sources)
    print_text(job.json if args.json else job.report.text(details, args.picture or ""))
    if args.at_least is not None and job.overlap < args.at_least:
        sentence = f"the overlap {format_overlap(job.overlap)} is below {args.at_least:g}"
        error = Error(sentence, value=job.overlap, code="overlap-low")
        raise RefusedError(args.photos[0], [error.notice()])


def _list_source_files(args) -> list[str]:
    """List the outputs that later commands read: corrections, a studio's repeatability, and a cell."""
    outputs = [args.output] if suffix_of(args.output) == ".json" else []
    return [*outputs, *([args.corrected_cell] if args.corrected_cell else [])]


def _write_checked_cell(cell) -> str:
    """Return a cell file's text; raise Error if a number of its machine is outside the range of a cell."""
    text = write_cell(cell)
    parse_cell(text)
    return text


def _report_repeats(args, sheet) -> None:
    """Report how well strokes repeat on several sheets, or as copies on one sheet."""
    from ....comparison.photographs import compare_sheets
    from ....comparison.repeats import as_json, measure_repeats, report
    from ....comparison.repeats_picture import repeats_png
    from ....jobs.comparing import read_matching_page, read_photos

    with refuse_errors(args.photos[0]):
        photos = read_photos(args.photos, stage)
        sheet, sheets = read_matching_page(
            sheet, lambda candidate: compare_sheets(candidate.page, [*candidate.strokes], photos)
        )
    title, strokes = sheet.title, list(sheet.strokes)
    for path, comparison in zip(args.photos, sheets, strict=True):
        warn(path, list(comparison.notices))
    with refuse_errors(args.photos[0]):
        repeatability = measure_repeats(sheet.plan, args.photos, sheets)
    files, details, picture = {}, args.details, args.picture or ""
    if args.output:
        is_json = suffix_of(args.output) == ".json"
        files[args.output] = as_json(title, repeatability) if is_json else report(title, repeatability).text(details)
    if args.picture:
        files[args.picture] = repeats_png(title, repeatability, sheets, strokes)
    if files:
        write_outputs(args, files, sources=_list_source_files(args))
    print_text(as_json(title, repeatability) if args.json else report(title, repeatability).text(details, picture))
