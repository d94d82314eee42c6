"""brushsvg batch: convert many drawings.

Each drawing gets a program, a picture and a row of a table.
"""

from __future__ import annotations

from dataclasses import replace

from ....errors import Notice
from ....jobs.choices.choices import CHOICES
from ....notice_summary import summarize_notices
from ....reporting.report_text import format_overlap
from ....units import clock
from ...console import RefusedError, clear_stage, refuse_errors, say, stage, warn
from ...steps.options import make_choices
from .text import read_font

SINGLE_DRAWING_CHOICES = ("input", "corrections")  # choices that belong to one drawing


def batch_files(args) -> None:
    from ....jobs.batch.items import list_drawings, list_words
    from ....jobs.batch.run import batch

    with refuse_errors(args.font or ""):  # errors about the words name their file themselves
        word_items = list_words(args.words, read_font(args.font), args.size or 20.0, args.sheet) if args.words else []
    chosen = make_choices(args, input=None)
    with refuse_errors(args.output):
        result = batch(
            [*list_drawings(args.inputs), *word_items],
            args.output,
            jobs=args.jobs,
            cluster=args.cluster,
            format=args.format or "",
            order=args.order,
            lenient=args.lenient,
            parquet=args.parquet,
            progress=stage,
            **{name: getattr(chosen, name) for name in CHOICES if name not in SINGLE_DRAWING_CHOICES},
            from_project=chosen.from_project,
        )
    clear_stage()
    notices = [replace(each, where=_format_place(row, each.where)) for row in result.rows for each in row.notices]
    outdated = "removed: it was made from an earlier version of the drawing"
    notices += [Notice(path, outdated, code="outdated-removed") for path in result.removed]
    warn(args.output, notices)
    if not args.quiet:
        say(args.output, _summarize(result))
    if result.refused:
        why = [Notice(_format_place(row, row.where), row.sentence, code=row.code) for row in result.refused]
        raise RefusedError(args.output, summarize_notices(why))


def _format_place(row, element: str) -> str:
    return ": ".join(filter(None, (row.source, element)))


def _summarize(result) -> str:
    figures = [row.figures for row in result.rows if row.figures]
    facts = [f"{len(result.rows)} drawing{'s' * (len(result.rows) != 1)}"]
    facts += [f"{result.resumed} of them done before"] if result.resumed else []
    facts += [f"{len(result.refused)} refused"] if result.refused else []
    seconds = [each.time_s for each in figures if each.time_s is not None]
    facts += [f"all take about {clock(sum(seconds))}"] if seconds else []
    overlaps = [each.overlap for each in figures if each.overlap is not None]
    if overlaps:
        mean = sum(overlaps) / len(overlaps)
        facts += [f"overlap {format_overlap(mean)} on average, {format_overlap(min(overlaps))} at least"]
    return f"written; {', '.join(facts)}"
