"""brushsvg demo: draw a first picture from a word that is part of the package."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from ...console import print_text, stage
from ...steps.output_places import check_outputs, write_outputs

DEMO_DRAWING = Path(__file__).parents[3] / "data" / "drawings" / "vincent.svg"


def demo_picture(args) -> None:
    """Write the picture of the word, print its path, and open it.

    The picture is opened only if there is a display.
    """
    check_outputs(args, args.output)
    from ....jobs import prediction
    from ....jobs.comparison_picture import TITLES, comparison_png
    from ....jobs.options import Options
    from ....jobs.preparation import preparation
    from ....show.evaluation import figures

    stage("painting")
    works = {how: preparation.prepare(DEMO_DRAWING, Options(compensation=how)) for how in TITLES}
    marks = {how: prediction.predict(work) for how, work in works.items()}
    totals = {
        how: figures.measure_figures(figures.PaintedPlan(work.plan, marks[how], work.brush, work.strokes))[1]
        for how, work in works.items()
    }
    picture = comparison_png(works, marks, totals)
    write_outputs(args, {args.output: picture}, len(works["closed"].strokes or ()), overlap=totals["closed"].overlap)
    print_text(f"{os.path.abspath(args.output)}\n")
    if not args.no_open:
        open_picture(args.output)


def open_picture(path: str) -> None:
    """Show a picture in the viewer of the desktop, if there is a desktop."""
    if sys.platform == "win32":
        os.startfile(path)
    elif sys.platform == "darwin":
        _start_viewer("open", path)
    elif os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        _start_viewer("xdg-open", path)


def _start_viewer(program: str, path: str) -> None:
    nothing = subprocess.DEVNULL
    try:
        subprocess.Popen([program, path], stdin=nothing, stdout=nothing, stderr=nothing, start_new_session=True)
    except OSError:  # the path of the picture was printed already
        return
