"""Brushes whose laws are none of the fit's polynomials: the intervals hold what they may be off.

The stepping simulator paints; nothing of the library's polynomials is in what it paints with.
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

from brushsvg.brush.confidence import half_interval_mm, places  # noqa: E402
from brushsvg.calibration.from_marks import brush_of, height_at  # noqa: E402

pytestmark = pytest.mark.long

SHARES = {"lag": (0.4, 0.7, 1.0), "tip_gap": (1.0,), "half_width": (0.4, 0.7, 1.0), "tip_to_widest": (1.0,)}


def fitted(brush, seed, **faults):
    """[(what, error, half of the 95 % interval)], mm, and the fit."""
    rng, faults = np.random.default_rng(seed), painter.Faults(**faults)
    sheet = painter.paint(rng, brush, painter.chart_strokes(brush.deepest), faults)
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
