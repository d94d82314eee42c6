"""Fit a brush to a file of measurements or of painted marks."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np

from .. import _core
from ..errors import Error, need_one_of, require_type
from ..files import read_bytes
from .marks.from_marks import MarkCalibration, calibrate_marks, options_for
from .marks.machine_found import refuse_unknown_parts, request_machine_parts
from .marks.mark_input import read_painted
from .marks.paint_found import calibrate_paint
from .numbers.from_measurements import Calibration
from .numbers.from_measurements import calibrate as calibrate_measured
from .numbers.measurements import FORMAT, Measurements, Row, read_measurements
from .numbers.turn_picture import centre_line
from .overlap.by_overlap import OverlapCalibration, maximize_overlap

AIMS = ("edges", "overlap")


def fit_measurements(
    measured: str | os.PathLike[str] | Mapping[str, Any],
    name: str = "",
    *,
    default_name: str = "",
    absolute: bool = False,
    total: bool = False,
    machine: tuple[str, ...] = (),
    paint: bool = False,
    aim: Literal["edges", "overlap"] = "edges",
    progress: Callable[[str], object] | None = None,
) -> Calibration | MarkCalibration | OverlapCalibration:
    """Fit a brush to measured numbers or painted marks.

    The options are described in jobs.calibrating.CalibrationOptions.

    measured: a path, or the contents of a measurement .json. name: the name of the brush, by default the one in the
    measurements, else default_name, else the name of the file. Raises Error for a file that cannot be read, for
    measurements that leave a law undetermined, and for measurements that no brush can have.
    """
    require_type(measured, (str, os.PathLike, dict), "a path, or a dict of measurements")
    require_type(name, str, "the name of a brush")
    need_one_of(aim, AIMS, "aim")
    refuse_unknown_parts(machine)
    if isinstance(measured, dict):
        folder, stem = "", "measured"
        contents = read_measurements(_to_json(measured), ".json")
    else:
        path = os.fspath(measured)
        folder, (stem, suffix) = os.path.dirname(path), os.path.splitext(os.path.basename(path))
        contents = read_measurements(read_bytes(path), suffix.lower())

    def read(file: str) -> bytes:
        return read_bytes(os.path.join(folder, file))

    name = name or contents.name or default_name or stem
    if contents.marks is None:
        if machine:
            sentence = "--machine needs painted marks: measured numbers do not show errors of the machine"
            raise Error(sentence, code="options-contradict")
        if paint:
            sentence = "--paint needs painted marks: measured numbers do not show in which order marks were painted"
            raise Error(sentence, code="options-contradict")
        if aim == "overlap":
            sentence = "--aim overlap needs painted marks: measured numbers have no outlines"
            raise Error(sentence, code="options-contradict")
        _read_pictures(contents, read)
        return calibrate_measured(contents, name, bool(absolute), bool(total))
    if absolute or total:
        flag = "--norm absolute" if absolute else "--total"
        sentence = f"{flag} is for measured numbers: the fit of painted marks detects outliers itself"
        raise Error(sentence, code="options-contradict")
    painted = read_painted(contents.plan, contents.marks, read)
    options = options_for(contents.expected)
    request_machine_parts(options, machine)
    if paint and aim == "overlap":
        sentence = "--paint needs --aim edges: --aim overlap cannot estimate how marks narrow"
        raise Error(sentence, code="options-contradict")
    fit = calibrate_paint if paint else calibrate_marks
    calibration = fit(painted, name, contents.depth_range_mm, contents.max_speed_mm_s, options)
    return maximize_overlap(calibration, progress or (lambda text: None)) if aim == "overlap" else calibration


def _to_json(measured: dict) -> bytes:
    try:
        return json.dumps({"format": FORMAT, "version": 1} | measured, default=_to_plain_value).encode()
    except (TypeError, ValueError, RecursionError):
        sentence = "measurements must be numbers, texts, lists and dicts, see docs/reference/measurements.md"
        raise Error(sentence, code="wrong-type") from None


def _to_plain_value(value):
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, _core.Plan):
        return json.loads(_core.write_plan(value))
    if isinstance(value, _core.Marks):
        return [{"stroke": mark.stroke, "outline_mm": list(mark.outline_mm)} for mark in value.passes]
    raise TypeError


def _read_pictures(found: Measurements, read) -> None:
    """Replace pictures of angular strokes by the points of their centre lines."""
    lines = found.rows.get("centre_line", [])
    for i, row in enumerate(lines):
        if "picture" in row.numbers:
            picture_numbers = dict(row.numbers)
            data = read(picture_numbers.pop("picture"))
            points = centre_line(data, **picture_numbers, where=row.where)
            lines[i] = Row(row.kind, row.where, row.depth_mm, {"points_mm": points})
