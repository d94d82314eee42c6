"""The aim overlap finds the true brush.

The slow stepping simulator paints.
"""

import re
from copy import copy
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import painter
import pytest

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

import brushsvg  # noqa: E402
from brushsvg.calibration.marks import machine_found  # noqa: E402
from brushsvg.calibration.overlap import by_overlap, overlap_choice  # noqa: E402
from brushsvg.calibration.overlap.by_overlap_report import chosen_in_words, report  # noqa: E402
from brushsvg.calibration.overlap.overlap_search import SearchStart, Target  # noqa: E402

pytestmark = pytest.mark.long

DISPLACED_MM, DISPLACED_LITTLE_MM = 1.5, 0.1
NUMBER = re.compile(r"[+-]\d+\.\d+")


@cache
def sheet():
    """Return marks of a round tail, displaced at random by 1.5 mm as by real robots."""
    return painted(DISPLACED_MM)


def painted(displaced_mm, lean=(0.0, 0.0), by_map=((0.0, 0.0), (0.0, 0.0)), **faults):
    """Return a brush, and a file of the marks of a machine.

    The machine leans, and runs ways by a map.
    """
    rng = np.random.default_rng(3)
    brush = painter.random_brush(rng)
    brush.round_tail, brush.widest_per_half = True, brush.widest_per_half - 0.8
    strokes = painter.chart_strokes(brush.deepest, 3)
    centre = np.vstack([poses for _, poses in strokes])[:, :2].mean(axis=0)
    as_run = [
        (
            name,
            poses + np.pad((poses[:, :2] - centre) @ np.transpose(by_map) - poses[:, 2:] * lean, ((0, 0), (0, 1))),
        )
        for name, poses in strokes
    ]
    painted = painter.paint(rng, brush, as_run, painter.Faults(displacement=displaced_mm, **faults), painter.swept)
    return brush, {
        "plan": {"passes": [{"stroke": name, "poses_mm": poses.tolist(), "speed_mm_s": 20} for name, poses in strokes]},
        "marks": [
            {"stroke": name, "outline_mm": [ring.tolist() for ring in rings]} for name, _, rings in painted.marks
        ],
        "expected": {"displacement_mm": displaced_mm},
    }


@cache
def calibrated():
    reported = []
    return brushsvg.calibrate(sheet()[1], "b", aim="overlap", progress=reported.append).fit, reported


@pytest.mark.thorough
def test_displaced_marks_widen_the_brush_only_slightly():
    # by the overlap where marks are alone it was 38 % wider at half of the depth, its lag 10 % longer
    brush, _ = sheet()
    made, _ = calibrated()
    for share, wider in ((0.5, 0.2), (1.0, 0.1)):
        depth = share * brush.deepest
        assert made.brush.half_width(depth) == pytest.approx(brush.law("half_width")(depth), rel=wider)
        assert made.brush.lag(depth) == pytest.approx(brush.law("lag")(depth), rel=0.08)


def test_overlap_is_at_least_that_of_edges_and_no_interval_is_given():
    made, reported = calibrated()
    assert made.found.overlap >= made.found.before
    assert not any(made.brush.half_width.half_interval_95)
    assert not len(made.brush.covariance)
    assert reported and not re.search(r"\+- \d", report(made).text(True))


def test_lean_that_edges_did_not_estimate_is_recovered():
    # a simplex alone confused lean and lag: 0.06 and -0.18
    _, marks = painted(DISPLACED_LITTLE_MM, lean=(0.3, -0.2), turn=0.0, height=0.1)
    as_run = machine_added(brushsvg.calibrate(marks, "b").fit).offsets
    assert as_run.lean_mm_per_mm == pytest.approx((0.3, -0.2), abs=0.08)
    assert as_run.map == pytest.approx(np.zeros((2, 2)), abs=0.006)


@pytest.mark.thorough
def test_a_map_that_edges_did_not_estimate_is_recovered_with_the_rotation():
    by_map = np.array([[0.01, -0.03], [0.05, 0.012]])
    _, marks = painted(DISPLACED_LITTLE_MM, by_map=by_map, turn=0.0, height=0.1)
    made = brushsvg.calibrate(marks, "b").fit
    unreported = SimpleNamespace(laws=made.fit.laws, turn_rad=0.0, shift_mm=(0.0, 0.0), centre_mm=made.fit.centre_mm)
    assert machine_added(made, unreported).offsets.map == pytest.approx(by_map, abs=0.006)


def machine_added(made, fit=None):
    """Add the machine's errors to a fit, as for the largest overlap.

    The fit by edges assumed a machine without errors.
    """
    options = copy(made.expected)
    options.deepest_mm = made.brush.depth_range_mm[1]
    machine_found.request_machine_parts(options, ("lean", "axes"))
    edges = SimpleNamespace(brush=made.brush, fit=fit or made.fit)
    targets = [
        by_overlap._make_target(by_overlap._to_plan_frame(*each, edges), edges)
        for each in zip(made.painted.marks, made.fit.marks, strict=True)
    ]
    return overlap_choice.largest_overlap(targets, SearchStart(made.fit.laws, made.fit.height_mm), options)


@pytest.mark.thorough
def test_the_report_shows_lean_and_map_of_edges_and_overlap():
    lean, by_map = (0.3, -0.2), ((0.02, 0.01), (0.0, -0.02))
    _, marks = painted(DISPLACED_LITTLE_MM, lean, by_map, turn=0.0, height=0.1)
    made = brushsvg.calibrate(marks, "b", machine=("lean", "axes")).fit
    text = report(by_overlap._make_calibration(made, machine_added(made))).text(True)
    numbers = {line.split(":")[0]: NUMBER.findall(line) for line in text.splitlines()}
    assert np.array(numbers["lean"][:2], float) == pytest.approx(lean, abs=0.08)
    assert np.array(numbers["paths"][:4], float) == pytest.approx(np.ravel(by_map), abs=0.006)


@pytest.mark.thorough
def test_edges_with_the_known_machine_predict_best_and_keep_intervals():
    lean, by_map = (0.3, -0.2), ((0.02, 0.01), (0.0, -0.02))
    _, marks = painted(DISPLACED_LITTLE_MM, lean, by_map, turn=0.0, height=0.1)
    made = brushsvg.calibrate(marks, "b", aim="overlap", machine=("lean", "axes")).fit
    assert made.found.kind == "edges"
    assert all(made.brush.lag.half_interval_95)
    assert np.array(made.brush.covariance).size
    assert re.search(r"\+- \d", report(made).text(True))


def targets_of(strokes, brush, displaced=lambda k: np.zeros(2)):
    """Return the marks of the brush, each moved, without faults of edges."""
    faults = painter.Faults(0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    sheet = painter.paint(np.random.default_rng(1), brush, strokes, faults, painter.swept)
    out = []
    for k, (_, poses, rings) in enumerate(sheet.marks):
        moved = [np.asarray(ring) + displaced(k) for ring in rings]
        seen = np.vstack([poses[:, :2], *moved])
        corner, size = seen.min(axis=0) - 12.0, np.ceil(2 * np.ptp(seen, axis=0) + 48.0) / 2
        window = (*corner.tolist(), *size.tolist())
        out.append(Target(np.asarray(poses), core.coverage(moved, window, 2.0), window, 2.0))
    return out


def round_brush(lag) -> painter.TrueBrush:
    return painter.TrueBrush(4.0, np.array(lag), np.array([0, 0.6]), np.array([0, 0.6, 0.0]), 1.0, 1.0, round_tail=True)


def laws(brush, lag) -> object:
    return core.MarkLaws(lag, brush.tip_gap.tolist(), brush.half_width.tolist(), 1.0, 1.0, True)


def reported(brush) -> object:
    options = core.MarkOptions()
    options.deepest_mm, options.displacement_mm = brush.deepest, 1.5
    options.height_mm = core.Prior(0.0, 0.0)
    return options


@pytest.mark.thorough
def test_mark_ends_give_the_lag_at_touch_for_one_depth():
    # A lift lengthens the mark by 4 mm. With the lag held to the lag of the depth, a lift did not lengthen
    # it.
    found = by_one_depth(round_brush([2.0, 1.0]))
    assert found(0.0) == pytest.approx(2.0, abs=0.8)
    assert found(4.0) == pytest.approx(6.0, abs=0.3)


def by_one_depth(brush):
    """Return the lag from marks at the largest depth.

    The brush is set down and lifted on the spot.
    """
    strokes = [
        (name, np.column_stack([poses[:, :2], np.full(len(poses), -brush.deepest)]))
        for name, poses in painter.chart_strokes(brush.deepest, 2)
    ]
    begin = SearchStart(laws(brush, [float(brush.law("lag")(brush.deepest))]), 0.0)
    found = overlap_choice.largest_overlap(targets_of(strokes, brush), begin, reported(brush))
    return np.polynomial.Polynomial(found.laws.lag)


@pytest.mark.thorough
def test_changes_are_kept_if_they_predict_held_out_marks_and_reported():
    # The fit by edges keeps lean at 0. On marks that are left out, laws alone cannot replace the lean.
    brush, strokes = round_brush([1.0, 1.0]), painter.chart_strokes(4.0, 3)
    lean, moved = np.array([0.9, -0.7]), np.random.default_rng(4).normal(0, 0.3, (len(strokes), 2))
    as_run = [(name, poses + np.pad(-poses[:, 2:] * lean, ((0, 0), (0, 1)))) for name, poses in strokes]
    targets = [
        replace(target, poses_mm=poses)
        for target, (_, poses) in zip(targets_of(as_run, brush, lambda k: moved[k]), strokes, strict=True)
    ]
    marks = [
        core.PaintedMark(name, poses, outlines(target)) for (name, poses), target in zip(strokes, targets, strict=True)
    ]
    options = reported(brush)
    options.height_mm = core.Prior(0.0, 0.2)
    options.lag_terms, options.half_width_terms, options.round_tail = 2, 2, True
    options.widest_per_half, options.turn_rad = core.Prior(1.0, 0.4), 0.0
    machine_found.request_machine_parts(options, ("lean",))
    found = overlap_choice.find_best_prediction(marks, targets, SearchStart(laws(brush, [1.0, 1.0]), 0.0), options)
    assert found.kind == "machine"
    assert found.offsets.lean_mm_per_mm == pytest.approx(lean, abs=0.15)
    assert sum(found.left_out["machine"]) > sum(found.left_out["laws"]) + 0.02
    assert chosen_in_words(found)


def outlines(target):
    from brushsvg.photo.mask_contours import mask_outlines

    left, bottom, _, height = target.window_mm
    paint = np.uint8(np.round(255 * target.paint))
    return mask_outlines(paint, 127, 1 / target.px_per_mm, (left, bottom + height))


def test_few_marks_do_not_show_which_brush_predicts_best():
    brush, strokes = round_brush([1.0, 1.0]), painter.chart_strokes(4.0, 1)
    targets = targets_of(strokes, brush)
    marks = [
        core.PaintedMark(name, poses, outlines(target)) for (name, poses), target in zip(strokes, targets, strict=True)
    ]
    found = overlap_choice.find_best_prediction(
        marks, targets, SearchStart(laws(brush, [1.0, 1.0]), 0.0), reported(brush)
    )
    assert (found.kind, found.parts, found.left_out) == ("laws", 0, {})
    assert chosen_in_words(found)
