"""Calibrate a brush from measurements or photographs.

These are the steps of `brushsvg calibrate`, which Python users can call as well.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic, Literal, Required, TypedDict, TypeVar, Unpack, overload

from .. import _core
from ..calibration.chart.dabs import dabs_of, is_of_dabs
from ..calibration.chart.file import read_chart, write_chart
from ..calibration.chart.layout import Chart
from ..calibration.chart.photograph import (
    ChartReading,
    edge_mm,
    get_expected_errors,
    list_measured_marks,
    read_chart_photos,
    report_reading_notices,
)
from ..calibration.chart.photograph import describe_reading as reading_in_words
from ..calibration.dabs import dab_report
from ..calibration.dabs.from_dabs import calibrate_dabs
from ..calibration.from_file import fit_measurements
from ..calibration.marks import mark_report, photo_report
from ..calibration.marks.from_marks import MarkCalibration, calibrate_marks, options_for
from ..calibration.marks.machine_found import (
    BIASING_PARTS,
    refuse_unknown_parts,
    report_inseparable_lean,
    request_machine_parts,
)
from ..calibration.marks.mark_input import read_painted
from ..calibration.marks.paint_found import calibrate_paint
from ..calibration.numbers import law_report
from ..calibration.numbers.from_measurements import Calibration
from ..calibration.overlap import by_overlap_report, lag_by_outlines_report
from ..calibration.overlap.by_overlap import OverlapCalibration, maximize_overlap
from ..calibration.overlap.lag_by_outlines import lag_by_outlines, refuse_assumed
from ..calibration.prior import update_report
from ..calibration.prior.from_prior import other_brush, refuse_learned, with_lineage
from ..comparison.learned_brush import learn_brush
from ..comparison.repeats import read_displacement_mm
from ..errors import Error, Notice, name_file_in_errors, need_number, need_one_of, need_truth, require_type
from ..files import read_bytes
from ..machine.cells.cell import Cell, list_uncorrectable_keys
from ..model.plot import brush_picture
from ..reporting.report_text import Report
from .calibration_options import AIMS, MAX_DPI, MIN_DPI, CalibrationOptions, find_contradiction, is_photograph
from .json_files import read_plan
from .options import load_brush, load_cell

Warn = Callable[[str, Iterable[Notice]], object]  # called with a file and the warnings about the file
CELL_KEY_BY_PART = {  # keys in the table machine of a cell, by the part of `calibrate --machine` that estimates them
    "lean": "lean_mm_per_mm",
    "axes": "scale",
    "tilt": "tilt_mm_per_mm",
    "backlash": "backlash_mm",
    "field": "field_mm",
}

Fit = TypeVar("Fit")
Rows = Sequence[Mapping[str, object]]


class MeasuredNumbers(TypedDict, total=False):
    """Measured numbers, as in a file.

    Type checkers compare a dict in a call with this class.
    """

    name: str
    about: str
    depth_range_mm: Sequence[float]
    max_speed_mm_s: float
    lag: Rows
    tip_gap: Rows
    tip_to_widest: Rows
    half_width: Rows
    width: Rows
    angular: Rows
    side_view: Rows
    straight: Rows
    angles: Rows
    centre_line: Rows
    video: Rows


class PaintedMarks(TypedDict, total=False):
    """Painted marks with their plan, as in a file."""

    name: str
    about: str
    depth_range_mm: Sequence[float]
    max_speed_mm_s: float
    plan: Required[_core.Plan | str | Mapping[str, object]]
    marks: Required[_core.Marks | str | Rows]
    expected: Mapping[str, float]


class GivenOptions(TypedDict, total=False):
    """The fields of CalibrationOptions as keyword arguments."""

    absolute: bool
    total: bool
    machine: tuple[str, ...] | list[str]
    cell: str | os.PathLike[str] | Cell
    paint: bool
    aim: Literal["edges", "overlap"]
    chart: str | os.PathLike[str] | Chart
    bar_mm: float
    dpi: float
    mirrored: bool
    height_mm: float
    spread: str | os.PathLike[str]
    brush: str | os.PathLike[str] | _core.Brush
    plan: str | os.PathLike[str] | _core.Plan
    prior: str | os.PathLike[str] | _core.Brush


@dataclass(frozen=True)
class BrushCalibration(Generic[Fit]):
    """A calibrated brush, and how it was found.

    brush: a Brush, with lengths in mm, which save_brush writes.
    kind: "numbers", "marks", "overlap", "dabs", "lag" or "job".
    fit: details of that kind of fit, such as laws and remarks for numbers, or predicted marks and machine faults
        for marks.
    report: the verdict, lines and details that the command prints. report.text(details=True) has all tables, and
        the coefficients last.
    reading: how well the photographs were read, in words.
    notices: warnings.
    """

    brush: _core.Brush
    kind: str
    fit: Fit = field(repr=False, compare=False)
    report: Report = field(repr=False)
    reading: str = ""
    notices: tuple[Notice, ...] = ()
    _read: ChartReading | None = field(default=None, repr=False, compare=False)

    @property
    def text(self) -> str:
        """The report in at most ten lines, the verdict first."""
        return self.report.text()

    def plot(self, suffix: str = ".png") -> bytes:
        """Return a picture of the laws with their data and residuals.

        suffix: ".png" or ".svg".
        """
        if self.kind == "job":
            raise Error("a brush that a job updated has no picture of its fit", code="nothing-to-show")
        if self.kind == "lag":
            return brush_picture(self.brush, suffix)
        return _REPORT_MODULES[self.kind].report_picture(self.fit, suffix)

    def picture(self) -> bytes:
        """Return the flattened photograph with the read and predicted outlines, as a PNG."""
        if self._read is None:
            raise Error("this calibration was not made from photographs of a chart", code="nothing-to-show")
        if self.kind == "dabs":
            return photo_report.dabs_picture(self._read, self.fit)
        return photo_report.read_picture(self._read, self.fit if self.kind == "marks" else self.fit.mark_calibration)


_REPORT_MODULES = {
    "numbers": law_report,
    "marks": mark_report,
    "overlap": by_overlap_report,
    "dabs": dab_report,
}


@overload
def calibrate(
    source: MeasuredNumbers, name: str = "", *, absolute: bool = False, total: bool = False
) -> BrushCalibration[Calibration]: ...
@overload
def calibrate(
    source: PaintedMarks, name: str = "", *, machine: tuple[str, ...] = (), paint: bool = False
) -> BrushCalibration[MarkCalibration]: ...
@overload
def calibrate(
    source: Mapping[str, Any],
    name: str = "",
    *,
    progress: Callable[[str], object] | None = None,
    **options: Unpack[GivenOptions],
) -> BrushCalibration[Calibration | MarkCalibration | OverlapCalibration]: ...
@overload
def calibrate(
    source: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    name: str = "",
    *,
    progress: Callable[[str], object] | None = None,
    **options: Unpack[GivenOptions],
) -> BrushCalibration[Any]: ...
def calibrate(
    source: Any,
    name: str = "",
    *,
    progress: Callable[[str], object] | None = None,
    **options: Any,
) -> BrushCalibration[Any]:
    """Calibrate a brush, as `brushsvg calibrate` does.

    source: the path of measurements (.csv .json), or the contents of such a .json as a dict. In the dict, a Plan
        and Marks replace their files, and arrays replace lists. Or the path, or a list of paths, of photographs of
        one painted chart or job.
    name: the name of the brush, by default the name in the measurements or of the first file.
    progress: called with words on the progress.

    The options for measured numbers:
    absolute: bool, minimize absolute residuals instead of squares.
    total: bool, use total least squares for series of angles.

    The options for painted marks and photographs:
    machine: a list of "lean", "axes", "tilt", "backlash", "field", to estimate as well.
    cell: a name, path or Cell; only parts of the machine that this cell can undo are estimated.
    paint: bool, estimate how marks narrow along the way.
    aim: "edges", "overlap".

    The options for photographs of a chart:
    chart: the path of its chart.json, or the Chart.
    bar_mm: the measured length of the printed bar.
    dpi: the resolution of a flatbed scan without a printed page.
    mirrored: bool, the photograph was taken through a clear sheet.
    height_mm: the standard deviation of the height of the paper.
    spread: the path of a .json of `compare --sheets`.
    brush: a name, path or Brush, whose lag (for dabs) or outlines (for strokes) are known.

    The options for photographs of a job:
    plan: the path of the painted plan.json, or the Plan.
    prior: a name, path or Brush, the brush that painted it.

    Raises Error for a file that cannot be read, and for options that contradict each other. Measurements that leave
    a law undetermined, or that no brush can have, also raise Error.
    """
    if isinstance(source, (tuple, list)):
        require_type(source, (tuple, list), "a list of paths")
        for each in source:
            require_type(each, (str, os.PathLike), "the path of a photograph")
        if not source:
            raise Error("there is no photograph", "source", code="wrong-type")
        given = [os.fspath(each) for each in source]
    else:
        require_type(source, (str, os.PathLike, dict), "a path, a list of paths, or a dict of measurements")
        given = source if isinstance(source, dict) else os.fspath(source)
    require_type(name, str, "the name of a brush")
    if progress is not None and not callable(progress):
        require_type(progress, Callable, "a callable", "progress")
    notices: list[Notice] = []
    calibration = run_calibration(
        given,
        name,
        make_checked_options(options),
        progress or (lambda text: None),
        lambda _, warnings: notices.extend(warnings),
    )
    return replace(calibration, notices=tuple(notices))


def make_checked_options(options: Mapping[str, Any]) -> CalibrationOptions:
    """Return the options of a calibration, checked.

    Raises TypeError for an unknown name, and Error for a wrong value.
    """
    option_fields = CalibrationOptions.__dataclass_fields__
    for name in options:
        if name not in option_fields:
            raise TypeError(f"{name!r} is no option of calibrate; known are {', '.join(option_fields)}")
    options = {
        name: value for name, value in options.items() if value is not None or option_fields[name].default is not None
    }
    refuse_unknown_parts(options.get("machine", ()))
    for name in ("absolute", "total", "paint", "mirrored"):
        need_truth(options.get(name, False), name)
    for name, minimum, maximum in (
        ("bar_mm", 0.001, 1e3),
        ("dpi", MIN_DPI, MAX_DPI),
        ("height_mm", 0.001, 10.0),
    ):
        if name in options:
            options[name] = need_number(options[name], name, minimum, maximum)
    for name, loaded, kinds in (
        ("chart", (Chart,), "a path or a Chart"),
        ("spread", (), "a path"),
        ("plan", (_core.Plan,), "a path or a Plan"),
        ("brush", (_core.Brush,), "a name, a path or a Brush"),
        ("prior", (_core.Brush,), "a name, a path or a Brush"),
        ("cell", (Cell,), "a name, a path or a Cell"),
    ):
        if name in options:
            require_type(options[name], (str, os.PathLike, *loaded), kinds, name)
            if not isinstance(options[name], loaded):
                options[name] = os.fspath(options[name])
    need_one_of(options.get("aim", "edges"), AIMS, "aim")
    return CalibrationOptions(**options)


def run_calibration(
    source: str | Mapping | Sequence[str],
    name: str,
    options: CalibrationOptions,
    stage,
    warn: Warn,
    default_name: str = "",
) -> BrushCalibration:
    """Return a brush with its report; see calibrate.

    default_name: the name of a brush whose measurements have none, instead of the name of their first file.
    warn: called with a file and the warnings about the file.
    """
    if why := find_contradiction(source, options):
        raise Error(why, code="options-contradict")
    if options.cell is not None:
        cell = load_cell(options.cell)
        machine, left_out = select_correctable_parts(options.machine, cell)
        options = replace(options, machine=machine)
        warn(cell.name, left_out)
    if isinstance(source, (tuple, list)) and len(source) == 1:
        source = source[0]
    several = isinstance(source, (tuple, list))
    photos = source if several else [source] if is_photograph(source) else None
    if not photos:
        return _calibrate_from_measurements(source, name, default_name, options, stage, warn)
    name = name or default_name or os.path.splitext(os.path.basename(photos[0]))[0]
    if options.plan is not None:
        return _update_from_job(photos, name, options, stage, warn)
    chart = _load_chart(options)
    of_dabs = is_of_dabs(chart)
    if of_dabs:
        _refuse_stroke_options(options)
    if options.spread is not None:
        read_displacement_mm(options.spread)  # a file that is refused is refused before the photographs are read
    known_brush = None if options.brush is None else _load_known_brush(options.brush, of_dabs)
    read = _read_photographs_of(chart, photos, options, stage, warn)
    if of_dabs:
        return _calibrate_from_dabs(photos, read, name, known_brush, warn)
    if known_brush is not None:
        return _fit_lag_from_strokes(photos, read, name, known_brush, options, stage, warn)
    return _calibrate_from_strokes(photos, read, name, options, stage, warn)


def _path_of(file) -> str:
    """Return the path of a file, or "" for its contents."""
    return file if isinstance(file, str) else ""


def _load_chart(options: CalibrationOptions) -> Chart:
    with name_file_in_errors(_path_of(options.chart)):
        # a chart that was made in Python must be valid as a file
        data = write_chart(options.chart).encode() if isinstance(options.chart, Chart) else read_bytes(options.chart)
        return read_chart(data)


def _load_known_brush(source, of_dabs: bool) -> _core.Brush:
    """Load the brush whose lag (for dabs) or outlines (for strokes) are known."""
    known_brush = load_brush(source)
    if not of_dabs:
        with name_file_in_errors(_path_of(source)):
            refuse_assumed(known_brush)
    return known_brush


def read_chart_photographs(photos: Sequence[str], options: CalibrationOptions, stage, warn: Warn) -> ChartReading:
    """Read the photographs of one painted chart, and warn of missing strokes."""
    return _read_photographs_of(_load_chart(options), photos, options, stage, warn)


def _read_photographs_of(chart: Chart, photos: Sequence[str], options, stage, warn: Warn) -> ChartReading:
    with name_file_in_errors(photos[0]):
        stage("reading the photographs")
        read = read_chart_photos(
            chart,
            [(path, read_bytes(path)) for path in photos],
            options.bar_mm,
            options.dpi,
            options.mirrored,
        )
    warn(photos[0], report_reading_notices(read))
    return read


def _calibrate_from_measurements(source, name, default_name, options, stage, warn) -> BrushCalibration:
    file = "" if isinstance(source, Mapping) else source
    with name_file_in_errors(file):
        calibration = fit_measurements(
            source,
            name,
            default_name=default_name,
            absolute=options.absolute,
            total=options.total,
            machine=options.machine,
            paint=options.paint,
            aim=options.aim,
            progress=stage,
        )
    if isinstance(calibration, OverlapCalibration):
        warn(file, report_inseparable_lean(calibration.by_edges.painted, calibration.by_edges.expected))
        kind = "overlap"
    elif isinstance(calibration, MarkCalibration):
        warn(file, report_inseparable_lean(calibration.painted, calibration.expected))
        kind = "marks"
    else:
        warn(file, calibration.doubts)
        kind = "numbers"
    make_report = _REPORT_MODULES[kind].report
    if kind == "numbers":
        return BrushCalibration(calibration.brush, kind, calibration, make_report(calibration))
    report = make_report(calibration, advised_parts=_list_advised_parts(options))
    return BrushCalibration(calibration.brush, kind, calibration, report)


def _list_advised_parts(options: CalibrationOptions) -> tuple[str, ...]:
    """Return the parts of the machine that the report may advise to estimate as well."""
    if options.cell is None:
        return BIASING_PARTS
    return select_correctable_parts(BIASING_PARTS, load_cell(options.cell))[0]


def _calibrate_from_strokes(photos, read: ChartReading, name, options, stage, warn) -> BrushCalibration:
    """Return a brush from the painted strokes of a chart."""
    with name_file_in_errors(photos[0]):
        edge_fit = calibration = _fit_strokes(read, name, options, stage)
        if options.aim == "overlap":
            calibration = maximize_overlap(edge_fit, stage)
    warn(photos[0], mark_report.list_strays(edge_fit) + report_inseparable_lean(edge_fit.painted, edge_fit.expected))
    kind = "overlap" if options.aim == "overlap" else "marks"
    report = _REPORT_MODULES[kind].report(calibration, of_photo=True, advised_parts=_list_advised_parts(options))
    return BrushCalibration(calibration.brush, kind, calibration, report, reading_in_words(read), _read=read)


def _fit_strokes(read: ChartReading, name, options, stage) -> MarkCalibration:
    stage("fitting the brush")
    painted = read_painted(json.loads(_core.write_plan(read.chart.plan)), list_measured_marks(read), read_bytes)
    uncertainties = {"displacement_mm": read_displacement_mm(options.spread)} if options.spread else {}
    uncertainties |= {"height_mm": options.height_mm} if options.height_mm is not None else {}
    fit_options = options_for(get_expected_errors(read) | uncertainties)
    request_machine_parts(fit_options, options.machine)
    calibrate_painted = calibrate_paint if options.paint else calibrate_marks
    return calibrate_painted(painted, name, options=fit_options, edge_mm=edge_mm(read), leave_out_strays=True)


def _refuse_stroke_options(options: CalibrationOptions) -> None:
    """Raise Error if options do not belong to a chart of dabs."""
    for is_broken, why in (
        (
            options.brush is None,
            f"{_path_of(options.chart) or 'this'} is a chart of dabs: give the brush whose lag is known, --brush FILE",
        ),
        (bool(options.machine), "--machine needs strokes: dabs say nothing about the machine"),
        (options.spread is not None, "--spread is for strokes: calibrate averages the places of dabs"),
        (options.height_mm is not None, "--height is for strokes: calibrate takes the depths of dabs from the chart"),
    ):
        if is_broken:
            raise Error(why, code="options-contradict")


def _calibrate_from_dabs(photos, read: ChartReading, name, known_brush, warn) -> BrushCalibration:
    """Return a brush whose lag is known, with outlines from dabs."""
    joined_strokes = tuple(stroke for pair in read.marks.joined for stroke in pair)
    with name_file_in_errors(photos[0]):
        calibration = calibrate_dabs(dabs_of(read), known_brush, name, edge_mm(read), joined_strokes)
    warn(photos[0], calibration.remarks)
    report = dab_report.report(calibration)
    return BrushCalibration(calibration.brush, "dabs", calibration, report, reading_in_words(read), _read=read)


def _fit_lag_from_strokes(photos, read: ChartReading, name, known_brush, options, stage, warn) -> BrushCalibration:
    """Return a brush whose outlines are known, with the lag of painted strokes."""
    with name_file_in_errors(photos[0]):
        stroke_fit = _fit_strokes(read, name, options, stage)
        lag_fit = lag_by_outlines(stroke_fit, known_brush, name)
    warn(photos[0], mark_report.list_strays(stroke_fit))
    report = lag_by_outlines_report.report(lag_fit, _list_advised_parts(options))
    return BrushCalibration(lag_fit.brush, "lag", lag_fit, report, reading_in_words(read), _read=read)


def _update_from_job(photos, name, options, stage, warn) -> BrushCalibration:
    """Return a known brush, updated by photographs of a painted job."""
    prior_brush = load_brush(options.prior)
    with name_file_in_errors(_path_of(options.plan)):
        plan = read_plan(_core.write_plan(options.plan) if isinstance(options.plan, _core.Plan) else options.plan)
    with name_file_in_errors(options.spread or ""):
        spread_mm = read_displacement_mm(options.spread) if options.spread else None
    pictures = [(path, read_bytes(path)) for path in photos]
    digests = [hashlib.sha256(data).hexdigest() for _, data in pictures]
    with name_file_in_errors("" if isinstance(options.prior, _core.Brush) else options.prior):
        refuse_learned(prior_brush, digests)
    warn(_path_of(options.plan), other_brush(plan, prior_brush))
    with name_file_in_errors(photos[0]):
        stage("reading the photographs and fitting the brush")
        learned = learn_brush(plan, prior_brush, pictures, name, options.machine, spread_mm)
    with_lineage(learned.updated.brush, prior_brush, digests)
    warn(photos[0], list(learned.notices))
    return BrushCalibration(learned.updated.brush, "job", learned.updated, update_report.report(learned.updated))


def select_correctable_parts(parts: tuple[str, ...], cell: Cell) -> tuple[tuple[str, ...], list[Notice]]:
    """Return the parts that this cell can undo, and a notice on the other parts."""
    left_out = list_uncorrectable_keys(cell)
    uncorrectable = [part for part in parts if CELL_KEY_BY_PART[part] in left_out]
    if not uncorrectable:
        return parts, []
    why = "; ".join(dict.fromkeys(left_out[CELL_KEY_BY_PART[part]] for part in uncorrectable))
    sentence = f"cell {cell.name} cannot undo {', '.join(uncorrectable)}, so it is not estimated: {why}"
    kept = tuple(part for part in parts if part not in uncorrectable)
    return kept, [Notice("machine", sentence, code="machine-not-undone")]
