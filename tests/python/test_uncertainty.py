"""Uncertainty of a brush: in the report, in the picture, and in one notice.

The notice appears once if nothing is known.
"""

import json
import re

import cv2
import numpy as np
import pytest
from diagnostics import gives

from brushsvg import _core, find_brush, marks_png, marks_svg
from brushsvg.cli import main
from brushsvg.show.evaluation import uncertainty

DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
    '<path id="line" fill="none" stroke="#000000" stroke-width="3" d="M20 20 H95"/>'
    '<path id="bow" fill="none" stroke="#000000" stroke-width="3" d="M20 40 C40 20 60 60 95 40"/></svg>'
)


@pytest.fixture
def drawing(tmp_path):
    path = tmp_path / "two.svg"
    path.write_text(DRAWING)
    return str(path)


def report(drawing, capsys, *flags):
    assert main(["preview", drawing, *flags]) == 0
    return capsys.readouterr()


def test_the_report_states_uncertainty_and_its_source(drawing, capsys):
    reported = report(drawing, capsys, "--details").out
    (titles,) = [line for line in reported.splitlines() if line.startswith("stroke ")]
    assert titles.count("+-") == 3
    assert gives(reported, "95 %", "RMSE", "half_width")
    found = json.loads(report(drawing, capsys, "--json").out)
    assert found["uncertainty_from"] == "RMSE"
    line, bow = (row["uncertainty_95"] for row in found["strokes"])
    # Here, r and b have the errors of single readings, so the ends of any stroke follow from (16) alone.
    ends = 1.959963985 * np.hypot(0.58, 0.85)
    assert line["ends_mm"] == pytest.approx(ends, rel=0.02) == bow["ends_mm"]
    assert line["middle_mm"] < 0.1 < bow["middle_mm"]  # a wrong lag shows where the line bends
    assert line["width_mm"] is None
    assert found["total"]["uncertainty_95"]["middle_mm"] == bow["middle_mm"]


def test_a_measured_width_is_part_of_the_uncertainty(drawing, tmp_path, capsys):
    brush = find_brush("round-6")
    law = brush.half_width
    brush.half_width = _core.Profile(law.coefficients, rmse_mm=0.2)
    (tmp_path / "own.json").write_text(_core.write_brush(brush))
    found = json.loads(report(drawing, capsys, "--json", "--brush", str(tmp_path / "own.json")).out)
    assert found["strokes"][0]["uncertainty_95"]["width_mm"] == pytest.approx(2 * 1.959963985 * 0.2)


def test_missing_rmse_and_covariance_are_reported_once(drawing, tmp_path, capsys):
    reported = report(drawing, capsys, "--brush", "rigid", "--details").out
    assert "+-" not in reported
    assert reported.count("RMSE") == 1
    assert json.loads(report(drawing, capsys, "--brush", "rigid", "--json").out)["uncertainty_from"] is None
    out = tmp_path / "p.svg"
    assert main(["preview", drawing, "-o", str(out), "--brush", "rigid", "--band"]) == 0
    assert capsys.readouterr().err.count("RMSE") == 1
    assert 'class="band"' not in out.read_text()


@pytest.mark.parametrize("suffix", [".svg", pytest.param(".png", marks=pytest.mark.slow)])
def test_a_picture_shows_the_band_and_a_legend(drawing, tmp_path, suffix):
    plain, banded = tmp_path / f"plain{suffix}", tmp_path / f"banded{suffix}"
    assert main(["preview", drawing, "-o", str(plain)]) == 0
    assert main(["preview", drawing, "-o", str(banded), "--band"]) == 0
    if suffix == ".svg":
        text = banded.read_text()
        assert text.count('class="band"') == 2 and "RMSE" in text
        assert "band" not in plain.read_text()
        return
    plain, banded = (cv2.imread(str(path)).astype(int) for path in (plain, banded))
    changed = np.abs(plain - banded).max(axis=2) > 20
    assert changed[: changed.shape[0] * 9 // 10].mean() > 0.01  # around the marks
    assert changed[changed.shape[0] * 9 // 10 :].mean() > 0.001  # the legend


@pytest.mark.parametrize("sheet_mm", [(100.0, 100.0), (60.0, 200.0)])
def test_the_legend_of_a_band_ends_inside_the_sheet(sheet_mm):
    """On a square sheet, its last words were once cut off."""
    plan = _plan_of([20, 20, -5], [30, 20, -5])
    brush = find_brush("round-6")
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    band = uncertainty.make_band(plan, brush, marks)
    text = marks_svg(marks, sheet_mm, ["#000000"], band=band).split("<text ")[1]
    x, size = (float(re.search(f'{name}="([0-9.]+)"', text)[1]) for name in ("x", "font-size"))
    assert x + 0.55 * size * len(band.words) <= sheet_mm[0]
    image = cv2.imdecode(np.frombuffer(marks_png(marks, brush, sheet_mm, ["#000000"], band=band), np.uint8), 0)
    dark = (image[-image.shape[0] // 20 :] < 128).any(axis=0).nonzero()[0]
    assert len(dark) and dark.max() < 0.99 * image.shape[1]


def test_a_band_is_refused_for_other_formats(drawing, tmp_path, capsys):
    assert main(["preview", drawing, "-o", str(tmp_path / "m.json"), "--band"]) == 2
    assert gives(capsys.readouterr().err, "--band")


def test_a_law_on_its_floor_does_not_move():
    law = _core.Profile([-1.0, 1.0], floor=0.0)
    moved = uncertainty._law_derivatives(law, np.array([0.5, 2.0]))
    np.testing.assert_allclose(moved, [[0, 0], [1, 2]])


def _plan_of(*poses):
    plan = _core.Plan()
    plan.passes = [_core.Pass("s", poses)]
    return plan


def test_a_law_is_followed_at_depths_smaller_than_the_least_one():
    brush = find_brush("round-6")
    brush.depth_range_mm = (4, 10)
    brush.lag = _core.Profile([0.5, 0.5], floor=2.0)  # its floor ends at 3 mm
    plan = _plan_of([0, 0, -7], [50, 0, 0])
    marks = _core.simulate(plan, brush)
    ((contact, _),) = _core.follow_lags(plan.passes, marks.passes, [brush.lag], brush.depth_range_mm)
    assert contact[:, :, 0] == pytest.approx(np.array(marks.passes[0].contact_mm), abs=1e-9)


def test_a_lag_of_zero_at_touch_down_has_a_finite_uncertainty():
    brush = find_brush("round-6")
    brush.lag = _core.Profile([0.0, 1.2, 0.01])
    count = sum(len(getattr(brush, law).coefficients) for law in uncertainty.LAWS)
    brush.covariance = np.diag([0.0, 1e-4, 1e-6, *[0.0] * (count - 3)]).tolist()
    plan = _plan_of([0, 0, -7], [50, 0, -3], [50, 40, -3])
    (effects,) = uncertainty._all_effects(plan, brush, _core.simulate(plan, brush))
    assert np.isfinite(effects.d_middle).all() and np.any(effects.d_middle)


def test_the_uncertainty_is_proportional_to_that_of_the_lag():
    """A large step once made the lag negative at depths smaller than the least one."""
    brush = find_brush("round-6")
    brush.depth_range_mm, brush.lag = (4, 10), _core.Profile([0.05, 1.0])
    count = sum(len(getattr(brush, law).coefficients) for law in uncertainty.LAWS)
    plan = _plan_of([0, 0, -7], [50, 0, -0.5], [50, 40, -0.2], [90, 40, -5])
    found = []
    for deviation in (1e-3, 1.0):
        brush.covariance = np.diag([deviation**2, *[0.0] * (count - 1)]).tolist()
        (effects,) = uncertainty._all_effects(plan, brush, _core.simulate(plan, brush))
        found.append(np.array(effects.d_middle) / deviation)
    assert np.isfinite(found).all() and np.abs(found[0]).max() > 0.1
    assert found[1] == pytest.approx(found[0], abs=0.05 * np.abs(found[0]).max())
