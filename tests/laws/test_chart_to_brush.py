"""The outlines of a painted chart give back the brush.

Another brush paints the chart of round-6 on a displaced sheet. Each mark is displaced, and edges are uneven.
"""

import json

import numpy as np
import pytest
import shapely

from brushsvg import _core, find_brush
from brushsvg.calibration.chart.file import read_chart
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.marks.from_marks import brush_of, calibrate_marks, expected_brush
from brushsvg.calibration.marks.mark_input import read_painted
from brushsvg.cli import main
from brushsvg.model.confidence import law_band

NOISE_MM, DISPLACED_MM, TURN_RAD, SHIFT_MM = 0.1, 0.3, 0.008, np.array([0.8, -0.6])
DEPTHS = np.linspace(1, 10, 7)


def truth():
    laws = _core.MarkLaws([2.6, 1.3, 0.1, -0.009], [0.0, 0.45], [0.0, 0.5, -0.005], 1.6, 0.9)
    return brush_of(laws, "truth", (0.0, 10.0))


def uneven(ring, rng):
    """Return edge noise along the normals, with a correlation length of 1 mm."""
    closed = np.vstack([ring, ring[:1]])
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    at = np.arange(0, along[-1], 0.25)
    points = np.column_stack([np.interp(at, along, column) for column in closed.T])
    step = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    normal = np.column_stack([step[:, 1], -step[:, 0]]) / np.maximum(np.hypot(*step.T), 1e-9)[:, None]
    weights = np.exp(-((np.arange(-12, 13) * 0.25 / 0.5) ** 2))
    white = rng.normal(0, 1, len(points) + 24)
    noise = np.convolve(white, weights, "valid")[: len(points)] / np.sqrt(np.sum(weights**2))
    return points + NOISE_MM * noise[:, None] * normal


@pytest.fixture(scope="module")
def painted(tmp_path_factory):
    desk = tmp_path_factory.mktemp("desk")
    assert main(["chart", "-o", str(desk / "plan.json"), "--sheet", "a5", "--chart", str(desk / "chart.json")]) == 0
    made = read_chart((desk / "chart.json").read_bytes())
    brush, rng = truth(), np.random.default_rng(6)
    marks = _core.simulate(made.plan, brush)
    _core.trace_outlines(marks, brush)
    c, s = np.cos(TURN_RAD), np.sin(TURN_RAD)
    rows = []
    for trace in marks.passes:
        moved = SHIFT_MM + rng.normal(0, DISPLACED_MM, 2)
        rings = [uneven(ring, rng) @ np.array([[c, s], [-s, c]]) + moved for ring in trace.outline_mm]
        rows.append({"stroke": trace.stroke, "outline_mm": [ring.round(4).tolist() for ring in rings]})
    content = {"format": "brushsvg/measurements", "version": 1, "plan": "plan.json", "marks": rows}
    (desk / "marks.json").write_text(json.dumps(content | {"expected": {"displacement_mm": DISPLACED_MM}}))
    assert main(["calibrate", "--force", str(desk / "marks.json"), "-o", str(desk / "own.json")]) == 0
    return made, find_brush(desk / "own.json")


def test_the_brush_that_painted_the_chart_is_recovered(painted):
    _, found = painted
    was = truth()
    for depth in DEPTHS:
        assert found.lag(depth) == pytest.approx(was.lag(depth), rel=0.03)
        assert found.half_width(depth) == pytest.approx(was.half_width(depth), rel=0.03)
        assert found.tip_gap(depth) == pytest.approx(was.tip_gap(depth), rel=0.08)


def test_intervals_agree_with_the_prediction_before_painting(painted):
    made, found = painted
    expected, _ = expected_brush(made.plan, truth(), NOISE_MM)
    for law in ("lag", "tip_gap", "half_width"):
        before, after = (law_band(brush, law, DEPTHS)[0] for brush in (expected, found))
        ratio = np.mean(after) / np.mean(before)
        assert 0.5 < ratio < 2, (law, before, after)
        off = np.abs([getattr(found, law)(d) - getattr(truth(), law)(d) for d in DEPTHS])
        assert np.mean(off <= 1.5 * after) > 0.6, (law, off, after)


def test_intervals_include_a_common_shift_of_edges():
    """A picture shows all paint 0.04 mm too wide, which looks exactly like a wider brush."""
    made = chart(find_brush("round-6"), (148.0, 210.0), "few")
    marks = _core.simulate(made.plan, truth())
    _core.trace_outlines(marks, truth())
    rows = []
    for trace in marks.passes:
        shape = shapely.union_all([shapely.Polygon(ring).buffer(0) for ring in trace.outline_mm]).buffer(0.04)
        rows.append({"stroke": trace.stroke, "outline_mm": [np.array(shape.exterior.coords)[:-1].tolist()]})
    painted = read_painted(json.loads(_core.write_plan(made.plan)), rows, None)
    made = calibrate_marks(painted, "own", edge_mm=0.04)
    reported, known = made.brush, np.array(made.fit.covariance)
    blind = brush_of(made.fit.laws, "blind", reported.depth_range_mm, known)
    off = np.array([reported.half_width(d) - truth().half_width(d) for d in DEPTHS])
    before, after = (law_band(brush, "half_width", DEPTHS)[0] for brush in (blind, reported))
    assert (after > 1.5 * before).all() and (np.abs(off) < after).all(), (off, before, after)
