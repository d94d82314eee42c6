"""All that brushsvg makes of one drawing: python demo.py DRAWING.svg DIRECTORY"""

import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from brushsvg import _core
from brushsvg.cli.console import RefusedError, refuse_errors, say_notice, warn
from brushsvg.files import write_files
from brushsvg.jobs import outputs, prediction
from brushsvg.jobs.comparison_picture import comparison_png
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation import preparation
from brushsvg.jobs.prepared_drawing import PreparedDrawing
from brushsvg.machine import preflight, writer
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.reporting.report_text import format_overlap, table
from brushsvg.show.evaluation import figures, report
from brushsvg.strokes.wide_shapes import within_reach

LAG_STEP_MM = 0.25


def main(drawing: Path, directory: Path) -> None:
    cell = find_cell()
    ways = ("none", "constant", "closed", "refined")
    works = {how: preparation.prepare(drawing, Options(compensation=how)) for how in ways}
    work = works["closed"]
    works["best"] = find_best_constant_lag(work)
    marks = {how: prediction.predict(works[how]) for how in works}
    loads = split_into_loads(work.plan, work.brush, cell)
    walk = preflight.check_job(loads, work.brush, marks["closed"], cell, work.options.tolerance_mm)
    if walk.problems:
        raise RefusedError(str(drawing), walk.problems)
    warn(str(drawing), work.notices)

    totals = {
        how: figures.measure_figures(figures.PaintedPlan(each.plan, marks[how], each.brush, each.strokes))[1]
        for how, each in works.items()
    }
    names = {
        "none": "none",
        "best": f"constant, {works['best'].options.lag_mm:g} mm for all, the best",
        "constant": "constant, by each stroke's depth",
        "closed": "closed",
        "refined": "refined",
    }
    compared = comparison_text([(name, totals[how]) for how, name in names.items()])
    files = {
        ".plan.json": writer.encode_checked(".json", work.plan, walk, work.brush, work.title),
        ".ngc": writer.encode_checked(".ngc", work.plan, walk, work.brush, work.title, outputs.header_lines(work)),
        ".marks.svg": outputs.make_picture(".svg", work, marks["closed"]),
        ".report.txt": report.as_text(".txt", outputs.make_report(work, marks["closed"], cell)) + "\n" + compared,
        ".html": outputs.make_animation(work, loads, marks["closed"], cell),
        ".png": comparison_png(works, marks, totals),
    }
    directory.mkdir(parents=True, exist_ok=True)
    paths: dict[str | os.PathLike[str], str | bytes | Iterator[str]] = {
        directory / (drawing.stem + ending): data for ending, data in files.items()
    }
    write_files(paths)
    print(compared, *paths, sep="\n")


def find_best_constant_lag(work: PreparedDrawing) -> PreparedDrawing:
    """Return the work compensated with the constant lag of largest overlap.

    Lags from 0 to the greatest lag of the brush are tried and compared by pixels. The best lag is in options.lag_mm.
    """
    window = (0.0, 0.0, *work.plan.sheet_mm)
    # This resolution gives overlaps to 2e-4, in a twentieth of the time that outlines need.
    px_per_mm = min(4.0, 4000.0 / max(work.plan.sheet_mm))
    strokes = work.strokes or []
    target = _core.target_coverage(strokes, window, px_per_mm)
    best_work, best_overlap = work, -1.0
    greatest_mm = max(work.brush.lag(depth) for depth in np.linspace(*work.brush.depth_range_mm, 101))
    for lag_mm in np.arange(0.0, greatest_mm + LAG_STEP_MM, LAG_STEP_MM).tolist():
        options = replace(work.options, compensation="constant", lag_mm=lag_mm)
        compensated = _core.compensate(
            within_reach(strokes, work.brush, "clamp")[0],
            work.brush,
            work.plan.sheet_mm,
            "constant",
            options.tolerance_mm,
            lag_mm,
            options.speed_mm_s,
        )
        painted = _core.coverage(_core.simulate(compensated.plan, work.brush), work.brush, window, px_per_mm)
        overlap = np.minimum(painted, target).sum() / np.maximum(painted, target).sum()
        if overlap > best_overlap:
            errors = tuple(compensated.tracking_errors)
            best_work = replace(work, plan=compensated.plan, tracking_errors=errors, options=options)
            best_overlap = overlap
    return best_work


def comparison_text(rows: list[tuple[str, figures.Figures]]) -> str:
    """Return a table of (compensation, total figures), several ways to paint the same drawing."""
    cells = [
        (how, format_overlap(total.overlap or 0.0), f"{total.centre_mean_mm:.3f}", f"{total.centre_largest_mm:.3f}")
        for how, total in rows
    ]
    head, *lines = table(("compensation", "overlap", "centre mean", "largest"), cells)
    heading = "Compensations compared; distances of the widest point from the middle line in mm:"
    return "\n".join([heading, "", head, "-" * max(map(len, (head, *lines))), *lines, ""])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        with refuse_errors(sys.argv[1]):
            main(Path(sys.argv[1]), Path(sys.argv[2]))
    except RefusedError as refused:
        for notice in refused.why:
            say_notice(refused.file, notice)
        sys.exit(1)
