"""Simulate a machine that paints a job, and the photograph of the painted page.

These are the steps of `brushsvg simulate-photo`, which Python users can call as well.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from numbers import Integral
from typing import TYPE_CHECKING, Unpack

from .. import _core
from ..calibration.chart.file import is_chart, read_chart
from ..calibration.chart.layout import Chart
from ..comparison.job_page import JobPage, job_page
from ..errors import Error, Notice, name_file_in_errors, need_number, require_type
from ..files import read_bytes, write_files
from ..jobs.choices.choice_checks import refuse_file_used_twice
from ..jobs.choices.choices import ChoiceKeywords, Choices, choose_margin_strokes, path_of, suffix_of
from ..jobs.choices.drawing_settings import fill_from_drawing
from ..jobs.choices.ineffective_flags import report_ineffective_flags
from ..jobs.conversion import make_choices
from ..jobs.options import load_brush, make_options
from ..jobs.preparation import preparation
from ..machine.paint_reload import fetched_mm
from .paint_with_errors import lower_paper, simulate_painted_strokes
from .photo import simulated_photo
from .studio_errors import random_studio, read_studio, write_studio

if TYPE_CHECKING:
    from ..jobs.preparation.preparation import Source

PHOTO_EXTENSIONS = (".jpg", ".jpeg")


@dataclass(frozen=True)
class SimulatedPhoto:
    """The photograph of a job that no machine painted. A notice in the picture says so.

    jpeg: the photograph.
    studio: the errors of machine, brush and camera, as a studio file (TOML).
    stroke_count: the number of painted strokes.
    notices: warnings.
    """

    jpeg: bytes = field(repr=False)
    studio: str = field(repr=False)
    stroke_count: int = 0
    notices: tuple[Notice, ...] = ()


def simulate_photo(
    drawing: Source | Chart,
    out: str | os.PathLike[str] | None = None,
    *,
    studio: str | os.PathLike[str] | None = None,
    true_brush: str | os.PathLike[str] | _core.Brush | None = None,
    seed: int = 1,
    progress: Callable[[str], object] | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> SimulatedPhoto:
    """Render a photograph of the painted job, as `brushsvg simulate-photo` does.

    drawing: a drawing or plan, as `convert` takes it, or a chart (a Chart, or the path of a chart.json).
    out: the path of the photograph (.jpg), if it is to be written.
    studio: the path of the errors to simulate (.toml); by default they are drawn at random by seed.
    true_brush: the brush that paints, by default that of the plan.
    seed: of chance; photographs of equal input and seed are equal.
    progress: called with words on the progress.
    choices: as for `convert`.

    Raises Error for what cannot be painted, and for a page that is too large for the camera.
    """
    if out is not None:
        require_type(out, (str, os.PathLike), "a path", "out")
        if suffix_of(out) not in PHOTO_EXTENSIONS:
            sentence = f"out {os.fspath(out)[:80]!r} does not end in {' or '.join(PHOTO_EXTENSIONS)}"
            raise Error(sentence, "out", code="program-format")
    if studio is not None:
        require_type(studio, (str, os.PathLike), "a path", "studio")
    if true_brush is not None:
        require_type(true_brush, (str, os.PathLike, _core.Brush), "a name, a path or a brush", "true_brush")
    require_type(seed, Integral, "a whole number", "seed")
    seed = int(need_number(seed, "seed", 1, 1e8))
    chart = drawing if isinstance(drawing, Chart) else None
    chosen = make_choices(chart.plan if chart else drawing, choices)
    refuse_file_used_twice(chosen, [out], [studio, true_brush])
    notices: list[Notice] = []
    made = photograph_job(
        chosen, chart, studio, true_brush, seed, progress or (lambda text: None), lambda _, some: notices.extend(some)
    )
    if out is not None:
        write_files({os.fspath(out): made.jpeg})
    return replace(made, notices=tuple(notices))


def photograph_job(
    chosen: Choices,
    chart: Chart | None,
    studio_path: str | os.PathLike[str] | None,
    true_brush,
    seed: int,
    stage: Callable[[str], object],
    warn: Callable[[str, list[Notice]], object],
) -> SimulatedPhoto:
    """Render the photograph of a job, and report notices with their file as soon as they are known.

    chart: the chart that is painted, if the input is not a file.
    """
    file, studio = path_of(chosen.input), None
    if studio_path is not None:
        with name_file_in_errors(studio_path):
            studio = read_studio(read_bytes(studio_path))
    with name_file_in_errors(file):
        chart = chart or _read_chart_if_any(file)
        chosen = choose_margin_strokes(fill_from_drawing(chosen, chosen.input))
        warn(file, report_ineffective_flags(chosen))
        work = preparation.prepare(chart.plan if chart else chosen.input, make_options(chosen), stage)
        warn(file, work.notices)
        brush, cell = load_brush(true_brush) or work.brush, work.options.cell
        studio = studio or lower_paper(random_studio(seed, work.plan.sheet_mm), work.plan, brush, cell.machine)
        stage("painting")
        dips_mm = fetched_mm(work.plan, brush, cell)
        strokes = simulate_painted_strokes(work.plan, brush, studio, cell.machine, seed, dips_mm)
        stage("photographing")
        page = JobPage(chart, 0.0, ()) if chart else job_page(work.plan, work.title)
        return SimulatedPhoto(simulated_photo(page, strokes, studio, seed), write_studio(studio), len(strokes))


def _read_chart_if_any(file: str) -> Chart | None:
    """Return the chart that chart --chart wrote, or None for a drawing or a plan."""
    if suffix_of(file) != ".json":
        return None
    data = read_bytes(file)
    return read_chart(data) if is_chart(data) else None
