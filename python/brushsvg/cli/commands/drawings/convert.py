"""brushsvg convert: convert a drawing into the program of a machine.

A picture and figures can be written as well.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy  # noqa: F401  # before the core: if memory is short, numpy then raises an exception instead of exiting

from ....jobs import conversion, outputs, prediction
from ....jobs.choices.choices import choose_margin_strokes
from ....jobs.preparation.colours import list_colours, select_colour
from ....jobs.preparation.margin_strokes import describe_expected_accuracy
from ....jobs.prepared_drawing import PreparedDrawing
from ....machine.cells.cell import Cell
from ....machine.job_program import Job
from ....machine.leftover_programs import report_leftover_programs
from ....machine.pen_changes import count_pen_changes, has_pens, may_pause
from ....machine.writer import path_next_to, report_renamed
from ....show.evaluation import report
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import apply_drawing_settings, make_choices, warn_about_cell
from ...steps.output_places import check_outputs, suffix_of, write_outputs
from ...steps.prepared import prepare


def convert_file(args) -> None:
    check_outputs(args, args.output, args.picture, args.report, args.page)
    chosen = apply_drawing_settings(make_choices(args), args.input)
    # `check` finds margin strokes in the program that paints them. With --per-colour, only one program would.
    work = prepare(choose_margin_strokes(chosen) if args.page and not args.per_colour else chosen)
    warn(args.input, [notice for notice in work.notices if args.lenient or not notice.damaged])
    parts = _split_by_colour(args.output, work) if args.per_colour else [(args.output, work)]
    check_outputs(args, *(path for path, _ in parts))
    files, figures = {}, None
    if args.page:
        with refuse_errors(args.page):
            files[args.page] = outputs.make_job_page(suffix_of(args.page), work)
    with refuse_errors(args.input):
        simulations = [_simulate_or_refuse(args, path, part) for path, part in parts]
        for (path, _), simulated in reversed([*zip(parts, simulations, strict=True)]):
            files = {path_next_to(path, name): text for name, text in simulated.encoded().items()} | files
        single = simulations[0] if len(simulations) == 1 else None
        if args.picture or args.report:
            marks = single.marks if single else prediction.predict(work, suffix_of(args.picture) == ".svg", stage)
            whole_work = single.work if single else work
        if args.picture:
            files[args.picture] = outputs.make_picture(suffix_of(args.picture), whole_work, marks)
        if args.report:
            figures = outputs.make_report(whole_work, marks, work.options.cell)
            files[args.report] = report.as_text(suffix_of(args.report), figures)
    remarks = dict.fromkeys(notice for simulated in simulations for notice in simulated.remarks())
    if args.per_colour:
        advice = "give -o a short name of letters and digits that begins with a letter"
        remarks = [replace(each, advice=advice) if each.code == "program-renamed" else each for each in remarks]
    warn(args.input, remarks)
    warn_about_cell(args, simulations[0].cell)
    warn(args.output, report_leftover_programs(args.output, files))
    strokes = sum(len(simulated.loads.loads) for simulated in simulations) - args.from_stroke + 1
    times_s = [simulated.time_s() for simulated in simulations]
    seconds = None if None in times_s else sum(times_s)
    write_outputs(
        args,
        files,
        strokes,
        seconds,
        figures and figures.total.overlap,
        "" if args.per_colour else _describe_pen_changes(simulations[0], args.from_stroke),
    )
    if figures:
        print_text(f"{figures.verdict}\n")
    if words := describe_expected_accuracy(work):
        print_text(f"{words}\n")


def _split_by_colour(output: str, work: PreparedDrawing) -> list[tuple[str, PreparedDrawing]]:
    """Return a file name and the work for each colour, the lightest colour first."""
    return [
        (_name_program(Path(output), number, colour[1:], work.options.cell), select_colour(work, colour))
        for number, colour in enumerate(list_colours(work), 1)
    ]


def _name_program(path: Path, number: int, colour: str, cell: Cell) -> str:
    """Return the path of the program for a colour, with a name that the controller can have, if possible."""
    # KUKA controllers allow no "-", and names of FANUC controllers have 8 characters.
    names = [f"{path.stem}-{number}-{colour}", f"{path.stem}_{number}_{colour}", f"{path.stem}_c{number}"]
    possible = (name for name in names if not report_renamed(name, path.suffix.lower(), cell))
    return str(path.with_name(next(possible, names[0]) + path.suffix))


def _simulate_or_refuse(args, path: str, work: PreparedDrawing) -> conversion.SimulatedWork:
    """Return a program that may be written.

    Raises RefusedError with all problems that forbid writing it.
    """
    rings, job = suffix_of(args.picture) == ".svg", Job(args.z_offset, args.from_stroke)
    simulated = conversion.simulate_and_check(
        work, suffix_of(path), job, args.order, args.lenient, rings, stage, path=path
    )
    if simulated.problems:
        raise RefusedError(args.input, simulated.problems)
    return simulated


def _describe_pen_changes(simulated: conversion.SimulatedWork, from_stroke: int) -> str:
    """Describe how often a person has to change the pen."""
    if not (simulated.is_program and may_pause(simulated.cell)):
        return ""
    stops = count_pen_changes(simulated.loads.loads, simulated.cell, from_stroke)
    times = "once" if stops == 1 else f"{stops} times"
    sentence = f"takes another pen {times}" if has_pens(simulated.cell) else f"stops {times} for another pen"
    return sentence if stops else ""
