"""brushsvg compare: photographs of a painted job held against what was wanted and predicted."""

from __future__ import annotations

from ...errors import Error
from ...evaluation import report as figures
from ...files import read_bytes
from ...painted.corrections import corrected, refuse_corrected
from ...pipeline import prediction
from ..console import RefusedError, about, stage, tell, warn
from ..steps.options import corrections_of, settled, typed
from ..steps.output_places import check_places, suffix_of, write
from ..steps.prepared import prepare


def compare_files(args) -> None:
    from ...painted.comparison import Wanted, compare_photos
    from ...painted.faults import whose_fault
    from ...painted.job_page import job_page
    from ...painted.next_time import next_corrections
    from ...painted.picture import comparison_png
    from ...painted.report import as_json, as_text

    check_places(args.output, args.picture)
    work = prepare(settled(typed(args, corrections=None), args.input))
    before = corrections_of(args.corrections)
    warn(args.input, work.notices)
    with about(args.input):
        refuse_corrected(work.plan)
        marks = prediction.predict(work, True, stage)
        told = corrected(work.plan, before)
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
        found = compare_photos(page, strokes, [(path, read_bytes(path)) for path in args.photos])
    stage("looking for what is amiss")
    faults = whose_fault(told, work.brush, strokes, found)
    corrections, too_far = next_corrections(found, work.plan, before)
    warn(args.photos[0], [*found.notices, *too_far])
    title = work.title or "untitled"
    files = {}
    as_figures = as_json(title, found, corrections, faults)
    if args.output:
        files[args.output] = (
            as_figures if suffix_of(args.output) == ".json" else as_text(title, found, faults)
        )
    if args.picture:
        files[args.picture] = comparison_png(page, strokes, found, title, faults)
    if files:
        write(args, files)
    tell(as_figures if args.json else as_text(title, found, faults))
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


def _repeats(args, work, page, plan, strokes) -> None:
    """How well the same strokes lie on several sheets, or copies of strokes on one."""
    from ...painted.comparison import compare_photos
    from ...painted.repeats import as_json, as_text, repeats

    sheets = []
    for path in args.photos:
        with about(path):
            stage("reading the photographs")
            sheets.append(compare_photos(page, strokes, [(path, read_bytes(path))]))
            warn(path, list(sheets[-1].notices))
    with about(args.photos[0]):
        found = repeats(plan, sheets)
    title = work.title or "untitled"
    if args.output:
        makes = as_json if suffix_of(args.output) == ".json" else as_text
        write(args, {args.output: makes(title, found)})
    tell(as_json(title, found) if args.json else as_text(title, found))
