"""Make the outputs of prepared work: header lines, pictures, pages, reports."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from .. import _core
from ..errors import Error, Notice
from ..machine.cells.cell import Cell
from ..machine.paint_reload import PlanInLoads, split_into_loads
from ..machine.realised.arc_chords import with_chords
from ..machine.tool_axes import is_tilted
from ..machine.writer import time_s, whole_program
from ..show.animation import animation
from ..show.evaluation import figures, places, report
from ..show.evaluation.uncertainty import Band, estimate_confidence, is_law_interval_known
from ..show.marks_svg import marks_svg
from ..show.overlap_svg import overlap_svg
from ..show.timeline import timeline
from .options import Options
from .preparation.margin_strokes import MARGIN_KIND, is_margin, remove_margin_strokes
from .prepared_drawing import PreparedDrawing

TARGET_TOLERANCE_MM = 0.02  # how exactly an HTML page shows the target; smaller errors are not visible
_NAMES_BY_LAW = {"lag": "lag", "half_width": "width"}  # the laws that a plan depends on, as users call them


def header_lines(work: PreparedDrawing) -> tuple[str, ...]:
    """Return lines for the header of a program.

    They say how the program was made, and how many warnings there were.
    """
    options = work.options
    lag = f", lag {options.lag_mm:g} mm" if options.lag_mm is not None else ""
    start = f", start {options.start}" if options.start != Options.start else ""
    end = f", end {options.end}" if options.end != Options.end else ""
    compensation_line = f"compensation: {options.compensation}, tolerance {options.tolerance_mm:g} mm{lag}{start}{end}"
    damaged = sum(notice.damaged for notice in work.notices)
    warnings_line = f"warnings: {len(work.notices)}" + (f", {damaged} of them damaged geometry" if damaged else "")
    lines = (compensation_line, warnings_line) if work.strokes is not None else (warnings_line,)
    if any(map(is_margin, work.strokes or ())):
        lines += (f"{MARGIN_KIND}: {sum(map(is_margin, work.strokes))} strokes",)
    elif any(notice.code == "margin-strokes-left-out" for notice in work.notices):
        lines += (f"{MARGIN_KIND}: 0 strokes",)
    if options.corrections:
        largest_shift_mm = max(np.hypot(*each.shift_mm) for each in options.corrections)
        lines += (f"corrections: {len(options.corrections)} strokes, shifted by {largest_shift_mm:.2f} mm at most",)
    return lines


def make_picture(
    suffix: str, work: PreparedDrawing, marks: _core.Marks, band: Band | None = None, with_toolpath: bool = False
) -> bytes:
    """Return a picture of the marks as the bytes of a .png or .svg, or a marks.json.

    An .svg and a .json need the outlines of the marks.

    band: an uncertainty.Band to draw around the marks.
    with_toolpath: also draw the positions of the tool.
    """
    if suffix == ".json":
        return _core.write_marks(marks).encode()
    colours = [a_pass.colour for a_pass in work.plan.passes]
    toolpath_mm = [with_chords(a_pass).poses_mm for a_pass in work.plan.passes] if with_toolpath else []
    unpainted = [ring for piece in (*work.unreached, *work.missed) for ring in piece.rings]
    if suffix == ".svg":
        compensation = "" if work.strokes is None else f", {work.options.compensation}"
        description = f"{work.plan.brush}{compensation}"
        text = marks_svg(
            marks,
            work.plan.sheet_mm,
            colours,
            work.title,
            work.tracking_errors,
            description,
            band,
            unpainted,
            work.astray,
            toolpath_mm,
        )
        return text.encode()
    from ..show import marks_png  # imports OpenCV, which the other formats do not need

    return marks_png.marks_png(marks, work.brush, work.plan.sheet_mm, colours, band, unpainted, toolpath_mm)


def make_job_page(suffix: str, work: PreparedDrawing) -> bytes:
    """Return the page to print for a job (.pdf, .svg). The strokes are in the order in which they were drawn."""
    from ..calibration.chart.page import chart_page
    from ..comparison.job_page import job_page

    printed_page = job_page(work.plan, work.title)
    return chart_page(printed_page.printed, suffix, printed_page.ticks)


def overlap_picture(
    suffix: str,
    work: PreparedDrawing,
    marks: _core.Marks,
    long_side_px: int | None = None,
    places: Iterable[report.Place] = (),
) -> bytes:
    """Return a picture of missing and excess paint as the bytes of a .png or .svg.

    An .svg needs the outlines of the marks.

    long_side_px: the size of a small .png without legend.
    places: places of the report, which are numbered in the picture.

    Raises Error for a plan, which has no target.
    """
    if work.strokes is None:
        raise Error("a plan does not have the target shapes: give the drawing", code="plan-without-target")
    if suffix == ".svg":
        target = figures.target_rings(work.strokes)
        at_mm = {place.number: place.place_mm for place in places}
        return overlap_svg(target, marks.outline_mm, work.plan.sheet_mm, work.title, at_mm).encode()
    from ..show.overlap_png import overlap_png
    from ..show.png_canvas import PNG_LONG_SIDE_PX

    px_per_mm = min(20.0, (long_side_px or PNG_LONG_SIDE_PX) / max(work.plan.sheet_mm))
    window = (0.0, 0.0, *work.plan.sheet_mm)
    target = _core.target_coverage(work.strokes, window, px_per_mm)
    painted = _core.coverage(marks, work.brush, window, px_per_mm)
    height_mm = work.plan.sheet_mm[1]
    at_px = {
        place.number: (place.place_mm[0] * px_per_mm, (height_mm - place.place_mm[1]) * px_per_mm) for place in places
    }
    return overlap_png(target, painted, long_side_px is None, at_px)


def make_animation(
    work: PreparedDrawing, loads: PlanInLoads, marks: _core.Marks, cell: Cell, speed: float = 1.0
) -> bytes:
    """Return an HTML page that plays tool and paint over time.

    loads: the plan of the work in loads.
    marks: the marks of this plan, with outlines.
    speed: the speed of the playback at its start, relative to the robot.
    """
    _core.refuse_tilted(work.plan.passes, "the tool is shown upright")
    # The machine errors are left out, to show the tool where it goes and not where it is commanded.
    ideal_cell = replace(cell, machine=None)
    moves = timeline(whole_program(loads, work.brush, ideal_cell), marks)
    target = [_core.target_outline(stroke, TARGET_TOLERANCE_MM) for stroke in work.strokes or ()]
    return animation(moves, loads, work.brush, marks, target, cell.stations, work.title, speed)


def make_report(
    work: PreparedDrawing,
    marks: _core.Marks,
    cell: Cell,
    warnings: Iterable[Notice] | None = None,
    forbidden: Iterable[Notice] = (),
    drawn: Sequence[_core.Stroke] | None = None,
    seconds: float | None = None,
    advice: str = "",
    as_run: _core.Plan | None = None,
) -> report.Report:
    """Return the figures of a work.

    warnings: None for the warnings of the work.
    forbidden: the warnings for which no program would be written.
    drawn: see figures.measure.
    seconds: the duration, if it is known better than from the plan.
    advice: advice on the size.
    as_run: the plan that the marks belong to, if a machine cuts corners of the work's plan.
    """
    known_warnings = warnings if warnings is not None else work.notices
    if seconds is None:
        seconds = time_s(split_into_loads(work.plan, work.brush, cell), work.brush, cell)
    work, marks, as_run = remove_margin_strokes(work, marks, as_run)
    is_tilted_plan = any(map(is_tilted, work.plan.passes))
    is_drawing = work.strokes is not None
    painted = figures.PaintedPlan(
        work.plan,
        marks,
        work.brush,
        work.strokes,
        work.options.tolerance_mm,
        drawn,
        work.options.compensation,
        work.unreached,
    )
    rows, total = figures.measure_figures(painted)
    confidence = None if is_tilted_plan else estimate_confidence(as_run or work.plan, work.brush, marks)
    return report.Report(
        title=work.title,
        brush=work.plan.brush,
        compensation=work.options.compensation if is_drawing else "",
        tolerance_mm=work.options.tolerance_mm if is_drawing else None,
        strokes=rows,
        total=total,
        time_s=seconds,
        warnings=tuple(known_warnings),
        refused=tuple(work.refused),
        forbidden=tuple(forbidden),
        confidence=confidence,
        is_tilted=is_tilted_plan,
        groups=figures.group_touching_strokes(marks, work.brush, work.strokes),
        advice=advice,
        assumed=list_assumed_laws(work.brush),
        without_interval=list_laws_without_interval(work.brush),
        places=places.worst_places(painted) if is_drawing else (),
    )


def list_assumed_laws(brush: _core.Brush) -> tuple[str, ...]:
    """Return the names of the laws that were never measured. A pen has none: there is nothing to calibrate."""
    if brush.is_rigid():
        return ()
    return tuple(name for law, name in _NAMES_BY_LAW.items() if getattr(brush, law).assumed)


def list_laws_without_interval(brush: _core.Brush) -> tuple[str, ...]:
    """Return the names of the measured laws of which nobody knows how exact they are. A pen has none."""
    if brush.is_rigid():
        return ()
    return tuple(
        name
        for law, name in _NAMES_BY_LAW.items()
        if not (getattr(brush, law).assumed or is_law_interval_known(brush, law))
    )
