"""All that brushsvg makes of one drawing: python demo.py DRAWING.svg DIRECTORY"""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from brushsvg.cli.console import RefusedError, refuse_errors, say_notice, warn
from brushsvg.files import write_files
from brushsvg.jobs import outputs, prediction
from brushsvg.jobs.comparison_picture import comparison_png
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation import constant_lag, preparation
from brushsvg.machine import preflight, writer
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.show.evaluation import figures, report


def main(drawing: Path, directory: Path) -> None:
    cell = find_cell()
    ways = ("none", "constant", "closed", "refined")
    works = {how: preparation.prepare(drawing, Options(compensation=how)) for how in ways}
    work = works["closed"]
    works["best"] = constant_lag.find_best_constant_lag(work)
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
    table = report.comparison_text([(name, totals[how]) for how, name in names.items()])
    files = {
        ".plan.json": writer.encode_checked(".json", work.plan, walk, work.brush, work.title),
        ".ngc": writer.encode_checked(".ngc", work.plan, walk, work.brush, work.title, outputs.header_lines(work)),
        ".marks.svg": outputs.make_picture(".svg", work, marks["closed"]),
        ".report.txt": report.as_text(".txt", outputs.make_report(work, marks["closed"], cell)) + "\n" + table,
        ".html": outputs.make_animation(work, loads, marks["closed"], cell),
        ".png": comparison_png(works, marks, totals),
    }
    directory.mkdir(parents=True, exist_ok=True)
    paths: dict[str | os.PathLike[str], str | bytes | Iterator[str]] = {
        directory / (drawing.stem + ending): data for ending, data in files.items()
    }
    write_files(paths)
    print(table, *paths, sep="\n")


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
