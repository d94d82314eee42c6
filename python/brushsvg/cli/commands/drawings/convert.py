"""brushsvg convert: a drawing to the program of a machine, with its picture and its figures."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

import numpy  # noqa: F401  # before the core: where memory is short, numpy then fails with an exception and not by exit

from ....errors import Notice
from ....jobs import conversion, outputs, prediction
from ....jobs.choices import choose_margin_strokes
from ....jobs.preparation.margin_strokes import describe_expected_accuracy
from ....jobs.work import Work, list_colours, select_colour
from ....machine.paint_reload import has_pens, may_pause, pens_changed
from ....machine.program import Job
from ....machine.writer import called_programs, path_next_to
from ....show.evaluation import report
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import apply_drawing_settings, make_choices, warn_about_cell
from ...steps.output_places import check_outputs, suffix_of, write_outputs
from ...steps.prepared import prepare


def convert_file(args) -> None:
    check_outputs(args, args.output, args.picture, args.report, args.page)
    chosen = apply_drawing_settings(make_choices(args), args.input)
    # check knows strokes in the margin by the program that paints them: of several, only one would
    work = prepare(choose_margin_strokes(chosen) if args.page and not args.per_colour else chosen)
    warn(args.input, [notice for notice in work.notices if args.lenient or not notice.damaged])
    parts = _split_by_colour(args.output, work) if args.per_colour else [(args.output, work)]
    check_outputs(args, *(path for path, _ in parts))
    files, figures = {}, None
    if args.page:
        with refuse_errors(args.page):
            files[args.page] = outputs.page(suffix_of(args.page), work)
    with refuse_errors(args.input):
        tries = [_simulate_or_refuse(args, path, part) for path, part in parts]
        for (path, _), one in reversed([*zip(parts, tries, strict=True)]):
            files = {path_next_to(path, name): text for name, text in one.encoded().items()} | files
        shown = tries[0] if len(tries) == 1 else None
        if args.picture or args.report:
            marks = (
                shown.marks if shown else prediction.predict(work, suffix_of(args.picture) == ".svg", stage)
            )
            of_all = shown.work if shown else work
        if args.picture:
            files[args.picture] = outputs.picture(suffix_of(args.picture), of_all, marks)
        if args.report:
            figures = outputs.reported(of_all, marks, work.options.cell)
            files[args.report] = report.as_text(suffix_of(args.report), figures)
    warn(args.input, dict.fromkeys(notice for one in tries for notice in one.remarks()))
    warn_about_cell(args, tries[0].cell)
    warn(args.output, _report_leftover_programs(args.output, files, _list_called_before(args.output)))
    strokes = sum(len(one.loads.loads) for one in tries) - args.from_stroke + 1
    times_s = [one.time_s() for one in tries]
    seconds = None if None in times_s else sum(times_s)
    write_outputs(
        args,
        files,
        strokes,
        seconds,
        figures and figures.total.overlap,
        "" if args.per_colour else _describe_pen_changes(tries[0], args.from_stroke),
    )
    if figures and not args.quiet:
        print_text(f"{figures.verdict}\n")
    if not args.quiet and (words := describe_expected_accuracy(work)):
        print_text(f"{words}\n")


def _split_by_colour(output: str, work: Work) -> list[tuple[str, Work]]:
    """A file and the strokes of one colour each, the lightest first."""
    path = Path(output)
    return [
        (str(path.with_name(f"{path.stem}-{number}-{colour[1:]}{path.suffix}")), select_colour(work, colour))
        for number, colour in enumerate(list_colours(work), 1)
    ]


def _make_sort_key(name: str) -> list:
    """A key that sorts part2 before part10."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", name)]


def _list_called_before(output: str) -> list[str]:
    """Names of the files that the program calls which is now at the output, if it is one of several files."""
    return [
        Path(file).name
        for file in called_programs(output, _read_earlier_program(output), _read_earlier_program)
    ]


def _read_earlier_program(path: str) -> str:
    """A program of an earlier run, as far as it can be read; names in it are ASCII. Devices and pipes hold none."""
    try:
        return Path(path).read_bytes().decode("ascii", "replace") if Path(path).is_file() else ""
    except OSError:
        return ""


def _report_leftover_programs(output: str, files: Collection[str], called_before: list[str]) -> list[Notice]:
    """A notice of programs for a colour, or of parts, that an earlier run wrote and this one does not: nobody should
    run them."""
    path = Path(output)
    name = re.compile(rf"{re.escape(path.stem)}(-\d+-[0-9a-f]{{6}})?(-part\d+)?{re.escape(path.suffix)}")
    there = [each.name for each in path.parent.glob("*") if name.fullmatch(each.name)]
    there += [each for each in called_before if path.with_name(each).exists()]
    left = sorted({each for each in there if str(path.with_name(each)) not in files}, key=_make_sort_key)
    if not left:
        return []
    sentence = f"programs of an earlier run are still here and belong to another version: {', '.join(left)}"
    return [Notice("", sentence, code="programs-of-before", advice="delete them")]


def _simulate_or_refuse(args, path: str, work: Work) -> conversion.SimulatedWork:
    """A program that may be written. RefusedError with all that forbids it."""
    rings, job = suffix_of(args.picture) == ".svg", Job(args.z_offset, args.from_stroke)
    one = conversion.simulate_and_check(
        work, suffix_of(path), job, args.order, args.lenient, rings, stage, path=path
    )
    if one.problems:
        raise RefusedError(args.input, one.problems)
    return one


def _describe_pen_changes(one: conversion.SimulatedWork, from_stroke: int) -> str:
    """How often somebody has to change the pen, in words."""
    if not (one.is_program and may_pause(one.cell)):
        return ""
    stops = pens_changed(one.loads, one.cell, from_stroke)
    times = "once" if stops == 1 else f"{stops} times"
    more = f"takes another pen {times}" if has_pens(one.cell) else f"stops {times} for another pen"
    return more if stops else ""
