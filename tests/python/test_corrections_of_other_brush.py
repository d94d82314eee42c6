"""Corrections from a sheet that was planned for another brush are accepted.

The strokes of that sheet began elsewhere, by up to a lag.
"""

from dataclasses import replace

import numpy as np
import pytest
from diagnostics import refused

from brushsvg import _core, find_brush
from brushsvg.comparison.corrections import Correction, apply_corrections

BRUSH = find_brush("round-6")  # its lag is 10.2 mm at a depth of 5 mm
POSES = [(30, 30, 0), (32, 30, -5), (70, 30, -5), (72, 30, 0)]


def plan():
    return _core.Plan("round-6", BRUSH.sha256, (100.0, 60.0), [_core.Pass("a", np.array(POSES, float), 20.0)])


def correction(away_mm, replanned):
    return Correction("a", (30 - away_mm, 30), (50, 30), (0.5, 0.0), 0.0, BRUSH.sha256, replanned)


def test_a_stroke_may_start_up_to_twice_the_lag_away():
    """A stroke may begin up to twice the brush's lag away.

    A limit of one lag was 6 mm short. The second sheet's corrections were then refused as corrections of
    another job.
    """
    (made,) = apply_corrections(plan(), (correction(5.8, True),), BRUSH).passes
    assert made.poses_mm[0].tolist() == pytest.approx([30.5, 30, 0])


def test_the_width_of_a_stroke_without_depth_is_not_corrected():
    grazing = _core.Pass("a", np.array(POSES, float) * (1, 1, 0), 20.0)
    without_depth = _core.Plan("round-6", BRUSH.sha256, (100.0, 60.0), [grazing])
    wider = replace(correction(0.0, False), wider_mm=0.3)
    moved = apply_corrections(without_depth, (wider,), BRUSH).passes[0].poses_mm
    np.testing.assert_allclose(moved, grazing.poses_mm + np.array((0.5, 0.0, 0.0)))


@pytest.mark.parametrize(("away_mm", "replanned"), [(5.8, False), (21.0, True)])
def test_a_stroke_that_starts_further_away_is_refused_as_another_job(away_mm, replanned):
    with refused("corrections-of-another-job", "a"):
        apply_corrections(plan(), (correction(away_mm, replanned),), BRUSH)
