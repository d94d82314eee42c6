"""The aim that predicts best finds no other brush than the true one; the slow stepping simulator paints."""

from functools import cache

import numpy as np
import painter
import pytest

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

import brushsvg  # noqa: E402
from brushsvg.calibration import machine_found  # noqa: E402
from brushsvg.calibration.by_overlap import Target, largest_overlap  # noqa: E402
from brushsvg.calibration.by_overlap_report import report  # noqa: E402

pytestmark = pytest.mark.long

ASIDE_MM = 1.5


@cache
def sheet():
    """Marks of a round tail that lie 1.5 mm aside by chance, as those of real robots do."""
    rng = np.random.default_rng(3)
    brush = painter.random_brush(rng)
    brush.round_tail, brush.widest_per_half = True, brush.widest_per_half - 0.8
    strokes = painter.chart_strokes(brush.deepest, 3)
    painted = painter.paint(rng, brush, strokes, painter.Faults(displacement=ASIDE_MM), painter.swept)
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
        "expected": {"displacement_mm": ASIDE_MM},
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


LEAN, MAP = np.array([0.3, -0.2]), np.array([[0.0, -0.03], [0.02, 0.01]])


def test_a_machine_that_leans_and_turns_comes_back():
    rng = np.random.default_rng(5)
    brush = painter.random_brush(rng)
    brush.round_tail, brush.widest_per_half = True, brush.widest_per_half - 0.8
    told = painter.chart_strokes(brush.deepest, 3)
    centre = np.vstack([poses[:, :2] for _, poses in told]).mean(axis=0)

    def run(poses):
        aside = (poses[:, :2] - centre) @ MAP.T - poses[:, 2:] * LEAN
        return np.column_stack([poses[:, :2] + aside, poses[:, 2]])

    faults = painter.Faults(displacement=0.3, placement=0.0, turn=0.0, height=0.0)
    painted = painter.paint(rng, brush, [(name, run(poses)) for name, poses in told], faults, painter.swept)
    targets = [target(poses, rings) for (_, poses), (_, _, rings) in zip(told, painted.marks, strict=True)]
    options = core.MarkOptions()
    options.deepest_mm, options.displacement_mm = brush.deepest, 0.5
    options.height_mm = core.Prior(0.0, 0.3)
    machine_found.ask_for(options, ("lean", "axes"))
    depths = np.linspace(0, brush.deepest, 30)
    half = np.polyfit(depths, [brush.law("half_width")(d) for d in depths], 2)[::-1]
    lag = np.polyfit(depths, [brush.law("lag")(d) for d in depths], 2)[::-1]
    laws = core.MarkLaws(
        lag.tolist(), [0.0, brush.law("tip_gap")(1.0)], [0.0, *half[1:]], brush.widest_per_half, 1.0, True
    )
    led = largest_overlap(targets, laws, 0.0, options).led
    assert led.lean_mm_per_mm == pytest.approx(LEAN, abs=0.1)
    assert led.map == pytest.approx(MAP, abs=0.012)


def target(poses, rings) -> Target:
    seen = np.vstack([poses[:, :2], *rings])
    low = seen.min(axis=0) - 8
    size = np.ceil(seen.max(axis=0) + 8 - low)
    window = (*low.tolist(), *size.tolist())
    return Target(poses, core.coverage(rings, window, 2.0), window, 2.0)
