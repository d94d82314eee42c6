"""One load of paint gives back the freshly dipped brush and its narrowing.

The slow stepping simulator paints.
"""

import json
from functools import cache

import numpy as np
import painter
import pytest
from diagnostics import gives, refused
from sampling import sample

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

from brushsvg.calibration.chart.layout import chart  # noqa: E402
from brushsvg.calibration.from_file import fit_measurements as calibrate  # noqa: E402
from brushsvg.calibration.marks.from_marks import brush_of, calibrate_marks, expected_marks  # noqa: E402
from brushsvg.calibration.marks.mark_input import read_painted  # noqa: E402
from brushsvg.calibration.marks.mark_report import report  # noqa: E402
from brushsvg.calibration.marks.paint_found import expected_paint  # noqa: E402
from brushsvg.cli import main  # noqa: E402
from brushsvg.model.confidence import law_band  # noqa: E402

pytestmark = pytest.mark.long


@cache
def sheet(seed, narrows_per_m, mixed=False):
    """Return the true brush, and its sheet as a measurement file has it."""
    rng = np.random.default_rng(seed)
    brush = painter.random_brush(rng)
    strokes = painter.chart_strokes(brush.deepest, 3)
    if mixed:
        strokes = [strokes[k] for k in np.random.default_rng(1).permutation(len(strokes))]

    def regions(brush, strokes, height):
        return painter.swept(brush, strokes, height, narrows_per_m=narrows_per_m)

    painted = painter.paint(rng, brush, strokes, painter.Faults(), regions)
    passes = [{"stroke": name, "poses_mm": poses.tolist(), "speed_mm_s": 20} for name, poses in strokes]
    marks = [{"stroke": name, "outline_mm": [ring.tolist() for ring in rings]} for name, _, rings in painted.marks]
    return brush, {"plan": {"passes": passes}, "marks": marks}


@sample(("seed", "rate", "mixed"), [(1, 0.5, False), (6, 0.8, True)], keep=1)
def test_the_decay_rate_and_the_freshly_dipped_brush_are_recovered(seed, rate, mixed):
    brush, reported = sheet(seed, rate, mixed)
    made = calibrate(reported, "b", paint=True)
    paint = made.brush.paint
    sigma = np.sqrt(paint.covariance[0][0])
    assert abs(paint.narrows_per_m - rate) < 3 * sigma < 0.1
    assert 600 < paint.calibrated_mm[1] < 700
    plain = calibrate_marks(read_painted(reported["plan"], reported["marks"], None), "b").brush
    half = brush.law("half_width")(brush.deepest)
    assert made.brush.half_width(brush.deepest) == pytest.approx(half, rel=0.02)
    assert plain.half_width(brush.deepest) < 0.9 * half, "taken for marks of a brush always freshly dipped"
    for depth in np.linspace(0.2, 1.0, 5) * brush.deepest:
        assert made.brush.lag(depth) == pytest.approx(brush.law("lag")(depth), rel=0.03)
    laws = made.fit.laws
    # these terms follow those of lag and tip gap; the constant term is left out
    terms = len(laws.half_width) - 1
    at = slice(len(laws.lag) + len(laws.tip_gap) - 1, len(laws.lag) + len(laws.tip_gap) - 1 + terms)
    powers = brush.deepest ** np.arange(1, terms + 1)
    known, alone = (powers @ np.array(each)[at, at] @ powers for each in (made.covariance, made.fit.covariance))
    assert known > 1.3 * alone, "what the rate leaves open is in the laws' intervals"


@cache
def chart_sheet(seed, law):
    """Paint a chart for one load.

    Return the brush, the chart's report, the data for calibration, and the way in mm.
    """
    rng = np.random.default_rng(1000 + seed)
    brush = painter.random_brush(rng)
    laws = core.MarkLaws(
        brush.lag.tolist(),
        brush.tip_gap.tolist(),
        brush.half_width.tolist(),
        brush.widest_per_half,
        brush.front_per_half,
    )
    known = brush_of(laws, "b", (0.0, round(brush.deepest, 2)))
    made = chart(known, (210.0, 297.0), "few", one_load=True)
    reported = expected_paint(made.plan, known, 0.1, expected_marks(made.plan, known))
    strokes = [(one.stroke, np.array(one.poses_mm)) for one in made.plan.passes]

    def regions(brush, strokes, height):
        return painter.swept(brush, strokes, height, share=lambda way: law(way, reported.way_mm))

    sheet = painter.paint(rng, brush, strokes, painter.Faults(), regions)
    marks = [{"stroke": name, "outline_mm": [r.tolist() for r in rings]} for name, _, rings in sheet.marks]
    plan = json.loads(core.write_plan(made.plan))
    return brush, reported, calibrate({"plan": plan, "marks": marks}, "b", paint=True)


def rate_of(made):
    paint = made.brush.paint
    return paint.narrows_per_m, core.interval_factor_95(paint.degrees_of_freedom) * np.sqrt(paint.covariance[0][0])


@sample(("seed", "rate"), [(0, 0.7), (3, 0.25), (3, 0.0)], keep=1)
def test_a_chart_for_one_load_gives_laws_and_paint(seed, rate):
    brush, reported, made = chart_sheet(seed, lambda way, _: np.exp(-rate * way / 1000))
    found, half = rate_of(made)
    assert reported.explained_by_depth < 0.3
    assert abs(found - rate) < half < 0.06
    assert 0.4 < half / reported.half_per_m < 2.5, "as the chart reported"
    depths = np.linspace(0.2, 1.0, 5) * brush.deepest
    for law in ("lag", "half_width"):
        half = law_band(made.brush, law, depths)[0]
        off = np.array([getattr(made.brush, law)(d) - brush.law(law)(d) for d in depths])
        assert (np.abs(off) < 1.5 * half).all(), (law, off, half)
        assert half[-1] < 0.05 * brush.law(law)(brush.deepest)


@pytest.mark.thorough
def test_paint_that_runs_out_by_another_law_is_reported():
    """Paint that runs out by another law is reported.

    The marks narrow fast at first, then hardly. A constant rate makes the freshly dipped brush too narrow, by
    more than its interval.
    """
    brush, _, made = chart_sheet(1, lambda way, whole: 0.7 + 0.3 * np.exp(-way / (0.25 * whole)))
    assert made.paint_bends > 3
    half = law_band(made.brush, "half_width", np.array([brush.deepest]))[0][0]
    assert brush.law("half_width")(brush.deepest) - made.brush.half_width(brush.deepest) > half
    _, _, usual = chart_sheet(3, lambda way, _: np.exp(-0.25 * way / 1000))
    assert usual.paint_bends < 2
    assert len(report(made).details) > len(report(usual).details), "it is reported"


@pytest.mark.thorough
def test_constant_paint_is_not_reported_as_running_out():
    _, reported = sheet(8, 0.0)
    made = calibrate(reported, "b", paint=True)
    paint = made.brush.paint
    assert paint.narrows_per_m < 3 * np.sqrt(paint.covariance[0][0]) < 0.1


@pytest.mark.thorough
def test_slightly_widening_marks_count_as_constant():
    """Marks that seem to widen a little do not narrow.

    On a chart, early and late strokes of the largest depth have different shapes. For this brush, they
    imitate 0.042 per metre, which is five standard deviations of the edges' residuals.
    """
    brush, _, made = chart_sheet(6, lambda way, _: np.exp(-0.0 * way))
    found, half = rate_of(made)
    assert found == 0.0 and 0.03 < half < 0.06
    deepest = made.brush.depth_range_mm[1]  # the marks' depth range, by the fitted height of the paper
    assert deepest == pytest.approx(brush.deepest, abs=0.05)
    band = law_band(made.brush, "half_width", np.array([deepest]))[0][0]
    assert abs(made.brush.half_width(deepest) - brush.law("half_width")(deepest)) < band


def test_the_command_writes_the_paint_to_the_brush(tmp_path, capsys):
    _, reported = sheet(6, 0.8, True)
    path, out = tmp_path / "m.json", tmp_path / "b.json"
    path.write_text(json.dumps({"format": "brushsvg/measurements", "version": 1, **reported}))
    assert main(["calibrate", "--force", str(path), "-o", str(out), "--paint"]) == 0
    paint = json.loads(out.read_text())["paint"]
    assert paint["narrows_per_m"] == pytest.approx(0.8, abs=0.06) and paint["assumed"] is False
    assert f" {paint['narrows_per_m']:.3f} +- " in capsys.readouterr().out


def test_marks_that_get_wider_are_refused():
    """Marks that get wider are refused, since they are listed in another order."""
    _, reported = sheet(6, 0.8, True)
    with refused("paint-undetermined"):
        calibrate(
            {"plan": {"passes": reported["plan"]["passes"][::-1]}, "marks": reported["marks"]},
            "b",
            paint=True,
        )


def test_an_order_by_depth_alone_is_refused():
    """An order by depth alone is refused.

    Each depth has one stroke, and deeper strokes come later. The strokes are stretched, so the way within a
    stroke shows little.
    """
    _, reported = sheet(1, 0.5)
    arcs = [each for each in reported["plan"]["passes"] if not each["stroke"].startswith("ramp")]
    apart = [{"stroke": f"gap{k}", "poses_mm": [[0, -900, -1], [4000, -900, -1]], "speed_mm_s": 20} for k in range(3)]
    by_depth = [[each for each in arcs if each["stroke"].endswith(f"-{k}")] for k in (1, 2, 3)]
    passes = [one for k in range(3) for one in (apart[k], *by_depth[k])]
    names = {each["stroke"] for each in arcs}
    marks = [mark for mark in reported["marks"] if mark["stroke"] in names]
    with refused("paint-undetermined"):
        calibrate({"plan": {"passes": passes}, "marks": marks}, "b", paint=True)


def run_dry(lasts_mm, gone=()):
    """Return the measurement file of a sheet whose load ends too early.

    Also return the way to the end of each stroke. The load lasts for lasts_mm. The marks of the strokes in
    gone are missing.
    """
    rng = np.random.default_rng(6)
    brush = painter.random_brush(rng)
    strokes = painter.chart_strokes(brush.deepest, 3)
    strokes = [strokes[k] for k in np.random.default_rng(1).permutation(len(strokes))]
    ends = np.cumsum([np.hypot(*np.diff(poses[:, :2], axis=0).T).sum() for _, poses in strokes])
    left = np.maximum(lasts_mm - np.concatenate([[0.0], ends[:-1]]), 0.0)

    def regions(brush, strokes, height):
        return painter.swept(brush, strokes, height, lasts=np.maximum(left, 1e-3), narrows_per_m=0.8)

    painted = painter.paint(rng, brush, strokes, painter.Faults(), regions)
    passes = [{"stroke": name, "poses_mm": poses.tolist(), "speed_mm_s": 20} for name, poses in strokes]
    wet = {name for (name, _), way in zip(strokes, left, strict=True) if way > 0} - set(gone)
    marks = [
        {"stroke": name, "outline_mm": [ring.tolist() for ring in rings]}
        for name, _, rings in painted.marks
        if name in wet
    ]
    return {"plan": {"passes": passes}, "marks": marks}, dict(zip((name for name, _ in strokes), ends, strict=True))


@sample("share", [0.0, 0.4], keep=1)
def test_marks_that_end_dry_show_how_long_a_load_lasts(share):
    """Marks that end dry show how long a load lasts.

    The load ends between two strokes or within a stroke. A mark that is missing earlier does not count.
    """
    _, ends = run_dry(1e6)
    strokes, way = list(ends), list(ends.values())
    whole, dry = way[-4], way[-3]
    lasts_mm = whole + share * (dry - whole)
    reported, _ = run_dry(lasts_mm, {strokes[2]})
    made = calibrate(reported, "b", paint=True)
    paint = made.brush.paint
    assert paint.lasts_mm == pytest.approx(whole) and made.dry.dry_mm == pytest.approx(dry)
    assert (made.dry.whole, made.dry.dry) == (strokes[-4], strokes[-3])
    assert paint.lasts_mm - 1e-6 <= lasts_mm <= made.dry.dry_mm
    assert gives(report(made).text(True), f"{whole:.0f} mm", f"{dry:.0f} mm", strokes[-3])
    assert paint.narrows_per_m == pytest.approx(0.8, abs=0.15)
    again = core.read_brush(core.write_brush(made.brush)).paint
    assert again.lasts_mm == paint.lasts_mm and len(again.covariance) == 2


@pytest.mark.thorough
def test_a_load_that_lasts_is_reported():
    reported, ends = run_dry(1e6)
    made = calibrate(reported, "b", paint=True)
    assert made.dry is None and made.brush.paint.lasts_mm is None
    assert gives(report(made).text(True), f"{max(ends.values()):.0f} mm")
