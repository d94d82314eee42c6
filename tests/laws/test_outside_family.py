"""Intervals hold the truth of brushes whose laws are not the fit's polynomials.

The stepping simulator paints, and uses none of the library's polynomials.
"""

import json
from pathlib import Path

import numpy as np
import painter
import pytest

import brushsvg

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

from brushsvg.calibration.chart.layout import chart  # noqa: E402
from brushsvg.calibration.marks.from_marks import brush_of, height_at  # noqa: E402
from brushsvg.model.confidence import half_interval_mm, places  # noqa: E402

pytestmark = pytest.mark.long

SHARES = {"lag": (0.4, 0.7, 1.0), "tip_gap": (1.0,), "half_width": (0.4, 0.7, 1.0), "tip_to_widest": (1.0,)}


def fitted(brush, seed, ways=None, **faults):
    """Return [(name, error, half of the 95 % interval)] in mm, and the fit.

    seed is a number, or a Generator that continues.
    """
    rng, faults = np.random.default_rng(seed), painter.Faults(**faults)
    sheet = painter.paint(rng, brush, ways or painter.chart_strokes(brush.deepest), faults)
    options = core.MarkOptions()
    options.deepest_mm = brush.deepest
    options.height_mm = core.Prior(0.0, faults.height)
    options.displacement_mm = faults.displacement
    fit = core.fit_marks([core.PaintedMark(*mark) for mark in sheet.marks], None, options)
    found = brush_of(fit.laws, "found", (0.0, brush.deepest), np.array(fit.covariance))
    covariance, out = np.array(found.covariance), []
    for law, shares in SHARES.items():
        at, depths = places(found)[law], np.array(shares) * brush.deepest
        half = half_interval_mm(covariance[at, at], depths, None)
        for depth, interval in zip(depths, half, strict=True):
            error = getattr(found, law)(depth) - float(brush.law(law)(depth))
            out.append((f"{law} at {depth:.1f}", error, interval))
    height = height_at(fit)
    out.append(("height", fit.height_mm - sheet.height, 1.96 * np.sqrt(fit.covariance[height][height])))
    return out, fit


def round_6():
    file = Path(brushsvg.__file__).parent / "data/brushes/round-6.json"
    return painter.round_6(json.loads(file.read_text()))


def held(found):
    return np.array([abs(error) <= half for _, error, half in found])


@pytest.fixture(scope="module")
def strangers():
    out = []
    for seed, shape in ((31, "saturating"), (32, "kinked"), (33, "power"), (34, "logistic")):
        out += fitted(painter.random_stranger(np.random.default_rng(seed), shape), seed)[0]
    return out


def test_intervals_outside_the_model_family_contain_the_truth(strangers):
    """Intervals outside of the family hold the truth of 36 values of four brushes.

    Intervals of laws that may not depart from the family hold about 10.
    """
    missed = [row for row, good in zip(strangers, held(strangers), strict=True) if not good]
    assert len(missed) <= 7, missed


def test_a_brush_hardly_distinct_from_the_family_has_correct_intervals():
    """A brush that marks hardly separate from the family has right intervals.

    Its law has a hook near the touch, where another form looks like paper of another height. Laws once kept
    to their few numbers unless a departure was clearly likelier. Their intervals held 4 of 9 values.
    """
    found, _ = fitted(painter.random_stranger(np.random.default_rng(2), "hooked"), 2)
    assert held(found).sum() >= 8, found


def test_a_poorly_determined_height_widens_all_intervals():
    """A height that marks hardly determine widens all intervals.

    Powers of depth look nearly equal on paper 0.17 mm lower. Departures were once expected to be as small as
    the marks allow. This expectation chose the height, and the intervals held 2 of 9 values.
    """
    rng = np.random.default_rng(38)
    found, _ = fitted(painter.random_stranger(rng, "power"), rng)
    assert held(found).sum() >= 8, found
    assert max(half for what, _, half in found if what.startswith("lag")) < 1.0, found


def chart_ways(brush):
    """Return the chart of a user who roughly knows lag and width of the brush."""
    depths = np.linspace(0.0, brush.deepest, 30)
    lag = np.polynomial.polynomial.polyfit(depths, brush.law("lag")(depths), 2)
    half = np.linalg.lstsq(np.stack([depths, depths**2], 1), brush.law("half_width")(depths), rcond=None)[0]
    laws = core.MarkLaws(list(lag), [0.0, 0.4], [0.0, *half], 1.8, 1.0)
    made = chart(brush_of(laws, "roughly", (0.0, brush.deepest)), (210.0, 297.0), None)
    return [(one.stroke, np.array(one.poses_mm)) for one in made.plan.passes]


@pytest.mark.thorough
def test_widths_that_rise_as_square_roots_have_correct_intervals():
    """Widths that rise as roots from the touch have right intervals on two charts.

    With five numbers of a half width and departures that are smooth at the touch, intervals held 12 of 18
    values. The paper came out 0.07 and 0.13 mm too high.
    """
    found = []
    for seed in (75, 76):
        rng = np.random.default_rng(seed)
        brush = painter.of_other_functions(painter.random_brush(rng), rng)
        faults = {"noise": 0.05, "noise_length": 0.5, "displacement": 0.3, "height": 0.1}
        found += fitted(brush, rng, chart_ways(brush), **faults)[0]
    assert held(found).sum() >= 17, found


@pytest.mark.thorough
def test_round_6_is_recovered_from_its_own_chart():
    """round-6 comes back from its own chart without noise on its edges.

    The lag was once off by nine half-intervals, and the paper by six.
    """
    found, fit = fitted(round_6(), 1, noise=0.0)
    assert len(fit.laws.lag) > 4 and len(fit.laws.widest_by_depth) > 1
    assert held(found).mean() >= 0.6, found
    lag = [(error, half) for what, error, half in found if what.startswith("lag")]
    assert max(abs(error) for error, _ in lag) < 0.15, lag
