"""All that brushsvg makes of one drawing: python demo.py DRAWING.svg DIRECTORY"""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import brushsvg
from brushsvg.brush.describe import one_line
from brushsvg.cli.console import RefusedError, about, say_notice, warn
from brushsvg.evaluation import report
from brushsvg.files import write_files
from brushsvg.machine import preflight, writer
from brushsvg.machine.arc_chords import with_chords
from brushsvg.machine.cell_file import find_cell
from brushsvg.machine.paint_reload import in_loads
from brushsvg.pictures.panels_png import MIDDLE_LINE, Panel, panels_png
from brushsvg.pipeline import constant_lag, outputs, prediction, preparation
from brushsvg.pipeline.options import Options
from brushsvg.pipeline.work import Work


def main(drawing: Path, directory: Path) -> None:
    cell = find_cell()
    ways = ("none", "constant", "closed", "refined")
    works = {how: preparation.prepare(drawing, Options(compensation=how)) for how in ways}
    work = works["closed"]
    works["best"] = constant_lag.best_constant(work)
    marks = {how: prediction.predict(works[how]) for how in works}
    loads = in_loads(work.plan, work.brush, cell)
    walk = preflight.look(loads, work.brush, marks["closed"], cell, work.options.tolerance_mm)
    if walk.problems:
        raise RefusedError(str(drawing), walk.problems)
    warn(str(drawing), work.notices)

    totals = {
        how: report.measure(each.plan, marks[how], each.brush, each.strokes)[1] for how, each in works.items()
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
        ".plan.json": writer.encoded(".json", work.plan, walk, work.brush, work.title),
        ".ngc": writer.encoded(".ngc", work.plan, walk, work.brush, work.title, outputs.notes(work)),
        ".marks.svg": outputs.picture(".svg", work, marks["closed"]),
        ".report.txt": report.as_text(".txt", outputs.reported(work, marks["closed"], cell)) + "\n" + table,
        ".html": outputs.played(work, loads, marks["closed"], cell),
        ".png": three_panels(works, marks, totals),
    }
    directory.mkdir(parents=True, exist_ok=True)
    paths: dict[str | os.PathLike[str], str | bytes | Iterator[str]] = {
        directory / (drawing.stem + ending): data for ending, data in files.items()
    }
    write_files(paths)
    print(table, *paths, sep="\n")


def three_panels(
    works: dict[str, Work], marks: dict[str, brushsvg.Marks], totals: dict[str, report.Figures]
) -> bytes:
    """Three panels: what was drawn, what is painted without and with compensation."""
    work = works["closed"]
    strokes = work.strokes or []
    wanted = report.wanted_rings(strokes)
    middle = [brushsvg.flatten(stroke, 0.01)[:, :2] for stroke in strokes]
    width_mm, height_mm = np.ptp(np.vstack(wanted), axis=0)
    drawn = ("middle lines and their widths,", f"{width_mm:.0f} x {height_mm:.0f} mm")
    count = (str(len(strokes)), "strokes")
    panels = [Panel("What was drawn", count, drawn, wanted, [], middle, MIDDLE_LINE)]
    for how, title in (("none", "Tool follows the drawing"), ("closed", "With compensation")):
        total = totals[how]
        score = (f"{total.overlap:.2f}", "overlap with the drawing")
        off = f"{total.centre_mean_mm:.2f} mm mean, {total.centre_largest_mm:.2f} mm at most"
        paths = [with_chords(a_pass).poses_mm[:, :2] for a_pass in works[how].plan.passes]
        panels.append(Panel(title, score, ("centre-line error", off), wanted, marks[how].outline_mm, paths))
    return panels_png(panels, work.title, f"with brush {work.brush.name}. {one_line(work.brush)}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        with about(sys.argv[1]):
            main(Path(sys.argv[1]), Path(sys.argv[2]))
    except RefusedError as refused:
        for notice in refused.why:
            say_notice(refused.file, notice)
        sys.exit(1)
