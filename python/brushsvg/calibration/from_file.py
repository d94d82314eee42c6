"""A file of measurements, or of painted marks, to a brush."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Required, TypedDict, overload

import numpy as np

from .. import _core
from ..errors import Error, need, need_one_of
from ..files import read_bytes
from .by_overlap import OverlapCalibration, by_overlap
from .from_marks import MarkCalibration, calibrate_marks, options_for
from .from_measurements import Calibration
from .from_measurements import calibrate as calibrate_measured
from .machine_found import ask_for, refuse_unknown_parts
from .mark_input import read_painted
from .measurements import FORMAT, Measurements, Row, read_measurements
from .paint_found import calibrate_paint
from .turn_picture import centre_line

AIMS = ("edges", "overlap")

Rows = Sequence[Mapping[str, object]]


class Measured(TypedDict, total=False):
    """Numbers, as a file has them; a dict that is written out in the call is held against this by type checkers."""

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
    """The same of painted marks."""

    name: str
    about: str
    depth_range_mm: Sequence[float]
    max_speed_mm_s: float
    plan: Required[_core.Plan | str | Mapping[str, object]]
    marks: Required[_core.Marks | str | Rows]
    expected: Mapping[str, float]


@overload
def calibrate(
    measured: Measured, name: str = "", *, absolute: bool = False, total: bool = False
) -> Calibration: ...
@overload
def calibrate(
    measured: PaintedMarks,
    name: str = "",
    *,
    machine: tuple[str, ...] = (),
    paint: bool = False,
    aim: Literal["edges"] = "edges",
) -> MarkCalibration: ...
@overload
def calibrate(
    measured: str | os.PathLike[str] | Mapping[str, Any],
    name: str = "",
    *,
    machine: tuple[str, ...] = (),
    aim: Literal["overlap"],
    progress: Callable[[str], object] | None = None,
) -> OverlapCalibration: ...
@overload
def calibrate(
    measured: str | os.PathLike[str] | Mapping[str, Any],
    name: str = "",
    *,
    absolute: bool = False,
    total: bool = False,
    machine: tuple[str, ...] = (),
    paint: bool = False,
    aim: Literal["edges"] = "edges",
    progress: Callable[[str], object] | None = None,
) -> Calibration | MarkCalibration: ...
def calibrate(
    measured: str | os.PathLike[str] | Mapping[str, Any],
    name: str = "",
    *,
    absolute: bool = False,
    total: bool = False,
    machine: tuple[str, ...] = (),
    paint: bool = False,
    aim: Literal["edges", "overlap"] = "edges",
    progress: Callable[[str], object] | None = None,
) -> Calibration | MarkCalibration | OverlapCalibration:
    """Calibrate a brush from numbers (.csv, .json) or painted marks (.json): see docs/reference/measurements.md.

    measured: the path, or what stands in such a .json, without format and version if you like, with a Plan and Marks
    for their files, and arrays for lists. name: of the brush, where the measurements do not say one; else the file's
    own. absolute: least absolute residuals instead of squares; total: total least squares for series of angles.
    machine: of painted marks, what else to find: "lean", "axes", "tilt", "backlash", "field". paint: they were painted
    in the plan's order with one load of paint: find how they narrow. aim: of painted marks, "edges" of the usual mark,
    or from there to the "overlap" that predicts further marks best, without intervals and not with paint; progress: is
    called with words that say how far that is. Returns what was found: brush, a Brush [mm] that save_brush writes; of
    numbers laws and remarks, too, of marks what moved and what is left.

    Raises Error for a file that cannot be read, and measurements that leave a law open or that no brush can have.
    """
    need(measured, (str, os.PathLike, dict), "a path, or a dict of measurements")
    need(name, str, "the name of a brush")
    need_one_of(aim, AIMS, "aim")
    refuse_unknown_parts(machine)
    if progress is not None and not callable(progress):
        need(progress, Callable, "a callable, which progress is")
    if isinstance(measured, dict):
        folder, stem = "", "measured"
        found = read_measurements(_json(measured), ".json")
    else:
        path = os.fspath(measured)
        folder, (stem, suffix) = os.path.dirname(path), os.path.splitext(os.path.basename(path))
        found = read_measurements(read_bytes(path), suffix.lower())

    def read(file: str) -> bytes:
        return read_bytes(os.path.join(folder, file))

    name = found.name or name or stem
    if found.marks is None:
        if machine:
            raise Error(
                "--machine needs painted marks: measured numbers say nothing of the machine",
                code="options-contradict",
            )
        if paint:
            raise Error(
                "--paint needs painted marks: measured numbers say nothing of the order they were painted in",
                code="options-contradict",
            )
        if aim == "overlap":
            raise Error(
                "--aim overlap needs painted marks: measured numbers have no outlines that could overlap",
                code="options-contradict",
            )
        _read_pictures(found, read)
        return calibrate_measured(found, name, bool(absolute), bool(total))
    painted = read_painted(found.plan, found.marks, read)
    options = options_for(found.expected)
    ask_for(options, machine)
    if paint and aim == "overlap":
        raise Error(
            "--paint is found by edges: with --aim overlap marks do not narrow along the way",
            code="options-contradict",
        )
    fit = calibrate_paint if paint else calibrate_marks
    made = fit(painted, name, found.depth_range_mm, found.max_speed_mm_s, options)
    return by_overlap(made, progress or (lambda text: None)) if aim == "overlap" else made


def _json(measured: dict) -> bytes:
    try:
        return json.dumps({"format": FORMAT, "version": 1} | measured, default=_plain).encode()
    except (TypeError, ValueError, RecursionError):
        raise Error(
            "measurements are numbers, texts, lists and dicts, as docs/reference/measurements.md has them",
            code="wrong-type",
        ) from None


def _plain(value):
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, _core.Plan):
        return json.loads(_core.write_plan(value))
    if isinstance(value, _core.Marks):
        return [{"stroke": each.stroke, "outline_mm": list(each.outline_mm)} for each in value.passes]
    raise TypeError


def _read_pictures(found: Measurements, read) -> None:
    """Pictures of angular strokes to the points of their centre lines."""
    lines = found.rows.get("centre_line", [])
    for i, row in enumerate(lines):
        if "picture" in row.numbers:
            seen = dict(row.numbers)
            data = read(seen.pop("picture"))
            points = centre_line(data, **seen, where=row.where)
            lines[i] = Row(row.kind, row.where, row.depth_mm, {"points_mm": points})
