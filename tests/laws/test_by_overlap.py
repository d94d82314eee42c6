"""The aim that predicts best finds no other brush than the true one; the slow stepping simulator paints."""

import re
from copy import copy
from functools import cache
from types import SimpleNamespace

import numpy as np
import painter
import pytest

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

import brushsvg  # noqa: E402
from brushsvg.calibration import by_overlap, machine_found  # noqa: E402
from brushsvg.calibration.by_overlap_report import report  # noqa: E402

pytestmark = pytest.mark.long

ASIDE_MM, ASIDE_LITTLE_MM = 1.5, 0.1
NUMBER = re.compile(r"[+-]\d+\.\d+")


@cache
def sheet():
    """Marks of a round tail that lie 1.5 mm aside by chance, as those of real robots do."""
    return painted(ASIDE_MM)


def painted(aside_mm, lean=(0.0, 0.0), by_map=((0.0, 0.0), (0.0, 0.0)), **faults):
    """A brush, and the marks of a machine that leans and runs ways by a map, as a file of them."""
    rng = np.random.default_rng(3)
    brush = painter.random_brush(rng)
    brush.round_tail, brush.widest_per_half = True, brush.widest_per_half - 0.8
    strokes = painter.chart_strokes(brush.deepest, 3)
    centre = np.vstack([poses for _, poses in strokes])[:, :2].mean(axis=0)
    led = [
        (
            name,
            poses
            + np.pad((poses[:, :2] - centre) @ np.transpose(by_map) - poses[:, 2:] * lean, ((0, 0), (0, 1))),
        )
        for name, poses in strokes
    ]
    painted = painter.paint(rng, brush, led, painter.Faults(displacement=aside_mm, **faults), painter.swept)
    return brush, {
        "plan": {
            "passes": [
                {"stroke": name, "poses_mm": poses.tolist(), "speed_mm_s": 20} for name, poses in strokes
            ]
        },
        "marks": [
            {"stroke": name, "outline_mm": [ring.tolist() for ring in rings]}
            for name, _, rings in painted.marks
        ],
        "expected": {"displacement_mm": aside_mm},
    }


@cache
def calibrated():
    told = []
    return brushsvg.calibrate(sheet()[1], "b", aim="overlap", progress=told.append), told


def test_where_marks_lie_aside_the_brush_is_little_wider_than_it_is():
    # by the overlap where marks lie alone it was 38 % wider at half of the depth, its lag 10 % longer
    brush, _ = sheet()
    made, _ = calibrated()
    for share, wider in ((0.5, 0.2), (1.0, 0.1)):
        depth = share * brush.deepest
        assert made.brush.half_width(depth) == pytest.approx(brush.law("half_width")(depth), rel=wider)
        assert made.brush.lag(depth) == pytest.approx(brush.law("lag")(depth), rel=0.08)


def test_marks_overlap_no_less_than_by_edges_and_no_interval_is_claimed():
    made, told = calibrated()
    assert made.found.overlap >= made.found.before
    assert not any(made.brush.half_width.half_interval_95)
    assert not len(made.brush.covariance)
    assert told and all("overlaps" in each for each in told)
    assert "no intervals" in report(made)


def test_lean_that_edges_did_not_look_for_comes_back():
    # a simplex alone held lean for lag: 0.06 and -0.18
    _, marks = painted(ASIDE_LITTLE_MM, lean=(0.3, -0.2), turn=0.0, height=0.1)
    led = machine_beside(brushsvg.calibrate(marks, "b")).led
    assert led.lean_mm_per_mm == pytest.approx((0.3, -0.2), abs=0.08)
    assert led.map == pytest.approx(np.zeros((2, 2)), abs=0.006)


def test_a_map_that_edges_did_not_look_for_comes_back_with_the_turn():
    by_map = np.array([[0.01, -0.03], [0.05, 0.012]])
    _, marks = painted(ASIDE_LITTLE_MM, by_map=by_map, turn=0.0, height=0.1)
    made = brushsvg.calibrate(marks, "b")
    untold = SimpleNamespace(
        laws=made.fit.laws, turn_rad=0.0, shift_mm=(0.0, 0.0), centre_mm=made.fit.centre_mm
    )
    assert machine_beside(made, untold).led.map == pytest.approx(by_map, abs=0.006)


def machine_beside(made, fit=None):
    """As for the largest overlap, of edges that held the machine for one that does as it is told."""
    options = copy(made.expected)
    options.deepest_mm = made.brush.depth_range_mm[1]
    machine_found.ask_for(options, ("lean", "axes"))
    edges = SimpleNamespace(brush=made.brush, fit=fit or made.fit)
    targets = [
        by_overlap._target(*each, edges) for each in zip(made.painted.marks, made.fit.marks, strict=True)
    ]
    return by_overlap.largest_overlap(targets, made.fit.laws, made.fit.height_mm, options)


def test_the_report_says_lean_and_map_of_edges_and_overlap_together():
    lean, by_map = (0.3, -0.2), ((0.02, 0.01), (0.0, -0.02))
    _, marks = painted(ASIDE_LITTLE_MM, lean, by_map, turn=0.0, height=0.1)
    text = report(brushsvg.calibrate(marks, "b", aim="overlap", machine=("lean", "axes")))
    said = {line.split(":")[0]: NUMBER.findall(line) for line in text.splitlines()}
    assert np.array(said["lean"][:2], float) == pytest.approx(lean, abs=0.08)
    assert np.array(said["ways"][:4], float) == pytest.approx(np.ravel(by_map), abs=0.006)
