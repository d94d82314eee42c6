"""brushsvg batch: many drawings, each to its program, its picture and a row of a table."""

from __future__ import annotations

from dataclasses import replace

from ....errors import Notice
from ....jobs.choices import CHOICES
from ....text_summary import summarized
from ....units import clock
from ...console import RefusedError, clear_stage, refuse_errors, say, stage, warn
from ...steps.options import make_choices
from .text import read_font

SINGLE_DRAWING_CHOICES = ("input", "corrections")  # choices that are of one drawing


def batch_files(args) -> None:
    from ....jobs.batch.items import list_drawings, list_words
    from ....jobs.batch.run import batch

    with refuse_errors(args.font or ""):  # errors about the words name their file
        set_in_font = (
            list_words(args.words, read_font(args.font), args.size or 20.0, args.sheet) if args.words else []
        )
    chosen = make_choices(args, input=None)
    with refuse_errors(args.output):
        done = batch(
            [*list_drawings(args.inputs), *set_in_font],
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
    notices = [
        replace(each, where=_format_place(row, each.where)) for row in done.rows for each in row.notices
    ]
    outdated = "removed: it was made from an earlier version of the drawing"
    notices += [Notice(path, outdated, code="outdated-removed") for path in done.removed]
    warn(args.output, notices)
    if not args.quiet:
        say(args.output, _summarize(done))
    if done.refused:
        why = [Notice(_format_place(row, row.where), row.sentence, code=row.code) for row in done.refused]
        raise RefusedError(args.output, summarized(why))


def _format_place(row, element: str) -> str:
    return ": ".join(filter(None, (row.source, element)))


def _summarize(done) -> str:
    painted = [row.figures for row in done.rows if row.figures]
    known = [f"{len(done.rows)} drawing{'s' * (len(done.rows) != 1)}"]
    known += [f"{done.resumed} of them done before"] if done.resumed else []
    known += [f"{len(done.refused)} refused"] if done.refused else []
    seconds = [each.time_s for each in painted if each.time_s is not None]
    known += [f"all take about {clock(sum(seconds))}"] if seconds else []
    overlaps = [each.overlap for each in painted if each.overlap is not None]
    if overlaps:
        mean = sum(overlaps) / len(overlaps)
        known += [f"overlap {mean:.3f} on average, {min(overlaps):.3f} at least"]
    return f"written; {', '.join(known)}"
