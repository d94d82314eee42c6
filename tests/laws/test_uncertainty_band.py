"""The uncertainty on paper agrees with Monte Carlo.

Brushes drawn from the covariance paint the same plan.
"""

import numpy as np
import pytest
import shapely

from brushsvg import _core, find_brush
from brushsvg.calibration.numbers.from_measurements import calibrate
from brushsvg.calibration.numbers.measurements import Measurements, Row
from brushsvg.jobs import prediction
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation import preparation
from brushsvg.model.perturbed import with_lag
from brushsvg.show.evaluation import uncertainty

LAWS = uncertainty.LAWS
DRAWN = 400


def sure_of(brush, law):
    """Return half of a 95 % interval in standard deviations."""
    return _core.interval_factor_95(getattr(brush, law).degrees_of_freedom)


@pytest.fixture(scope="module")
def brush():
    """Return round-6 measured at ten depths, with two values each.

    The tip gap comes from sums, so the laws depend on each other.
    """
    rng, truth = np.random.default_rng(8), find_brush("round-6")
    depths = np.repeat(np.arange(1, 11.0), 2)

    def rows(kind, value, noise):
        read = [value(d) + rng.normal(0, noise) for d in depths]
        return [
            Row(kind, f"{kind}[{i}]", d, {"value_mm": v}) for i, (d, v) in enumerate(zip(depths, read, strict=True))
        ]

    measured = {
        "lag": rows("lag", truth.lag, 0.3),
        "tip_to_widest": rows("tip_to_widest", lambda d: max(-2.35 + 2.75 * d - 0.42 * d**2 + 0.024 * d**3, 0), 0.15),
        "half_width": rows("half_width", truth.half_width, 0.1),
        "side_view": rows("side_view", lambda d: truth.lag(d) + truth.tip_gap(d) - truth.lag(0.0), 0.3),
    }
    made = calibrate(Measurements(measured, depth_range_mm=(0.0, 10.0), depths_mm=sorted(set(depths))), "measured")
    assert np.abs(np.array(made.brush.covariance)[:5, 5:7]).max() > 0
    return made.brush


@pytest.fixture(scope="module")
def painted(brush):
    work = preparation.prepare("examples/vincent.svg", Options(brush=brush, start="pointed"))
    marks = prediction.predict(work)
    rng = np.random.default_rng(9)
    mean = np.concatenate([getattr(brush, law).coefficients for law in LAWS])
    draws = rng.multivariate_normal(mean, np.array(brush.covariance), DRAWN, method="eigh")
    return work, marks, [drawn(brush, c) for c in draws]


def drawn(brush, coefficients):
    other = with_lag(brush, 0.0)
    first = 0
    for law in LAWS:
        profile = getattr(brush, law)
        last = first + len(profile.coefficients)
        changed = _core.Profile(coefficients[first:last].tolist(), floor=profile.floor, floor_slope=profile.floor_slope)
        setattr(other, law, changed)
        first = last
    return other


def seen(brush, trace, pose):
    """Return middle and tip of the mark (n, 2) and its half width (n,) at poses."""
    depth, heading = np.asarray(trace.depth_mm), np.asarray(trace.heading_rad)
    u = np.column_stack([np.cos(heading), np.sin(heading)])
    tip = trace.contact_mm - np.array([brush.tip_gap(d) for d in depth])[:, None] * u
    middle = tip + np.array([brush.tip_to_widest(d) for d in depth])[:, None] * u
    half = np.array([brush.half_width(d) for d in depth])
    columns = np.column_stack([middle, tip, half])
    return np.column_stack([np.interp(pose, trace.pose, column) for column in columns.T])


@pytest.mark.thorough
def test_the_band_agrees_with_monte_carlo(brush, painted):
    work, marks, brushes = painted
    reported = uncertainty.estimate_confidence(work.plan, brush, marks)
    assert reported.source == uncertainty.COVARIANCE
    runs = [_core.simulate(work.plan, each) for each in brushes]
    compared = 0
    for k, (trace, sure) in enumerate(zip(marks.passes, reported.strokes, strict=True)):
        taut = np.flatnonzero(np.asarray(trace.taut, bool) & (np.asarray(trace.depth_mm) > 0))
        if sure.middle_mm is None:
            assert not len(taut)
            continue
        pose = np.asarray(trace.pose)
        found = np.array([seen(b, run.passes[k], pose) for b, run in zip(brushes, runs, strict=True)])
        middle = _core.widest_points(trace, brush)[taut]
        step = np.gradient(middle, axis=0) if len(taut) > 1 else np.zeros((1, 2))  # the rows of a dab
        length = np.hypot(*step.T)
        heading = np.asarray(trace.heading_rad)[taut]
        u = np.column_stack([np.cos(heading), np.sin(heading)])
        tangent = np.where(length[:, None] > 1e-6, step / np.maximum(length, 1e-12)[:, None], u)
        normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
        across = np.einsum("dij,ij->di", found[:, taut, :2], normal).std(axis=0)
        ends = np.einsum("dij,ij->di", found[:, taut[[0, -1]], 2:4], u[[0, -1]]).std(axis=0)
        width = 2 * found[:, taut, 4].std(axis=0)
        assert sure.middle_mm == pytest.approx(sure_of(brush, "lag") * across.max(), rel=0.13)
        assert sure.ends_mm == pytest.approx(sure_of(brush, "lag") * ends.max(), rel=0.13)
        assert sure.width_mm == pytest.approx(sure_of(brush, "half_width") * width.max(), rel=0.1)
        compared += 1
    assert compared >= 10


def test_the_band_contains_95_percent_of_the_edges(brush, painted):
    """The band contains about 95 % of the edges of brushes drawn from the covariance."""
    work, marks, brushes = painted
    band = uncertainty.make_band(work.plan, brush, marks)
    k = next(k for k, a_pass in enumerate(work.plan.passes) if a_pass.stroke == "n-arch")
    shells = [shapely.Polygon(ring) for ring in band.rings[k]]
    region = shapely.make_valid(shells[0])
    for shell in shells[1:]:
        region = region.symmetric_difference(shapely.make_valid(shell))
    shares = []
    for each in brushes[:60]:
        own = _core.Marks()
        own.passes = [_core.simulate(work.plan, each).passes[k]]
        _core.trace_outlines(own, each)  # its outlines are from the measured brush
        edge = shapely.LineString(own.passes[0].outline_mm[0])
        shares.append(edge.intersection(region).length / edge.length)
    assert 0.9 < np.mean(shares) < 0.995
