"""Dabs are landed correctly; bad dabs are named and left out or refused."""

import numpy as np
import pytest
import shapely
from diagnostics import are_reported, refused

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

from dataclasses import replace  # noqa: E402

from brushsvg import find_brush  # noqa: E402
from brushsvg.calibration.chart.dabs import dab_depths, dab_poses, is_of_dabs, read_dab_landing  # noqa: E402
from brushsvg.calibration.chart.file import read_chart  # noqa: E402
from brushsvg.calibration.chart.layout import chart  # noqa: E402
from brushsvg.calibration.dabs.dab_outlines import Dab  # noqa: E402
from brushsvg.calibration.dabs.dab_report import describe_heading_difference  # noqa: E402
from brushsvg.calibration.dabs.from_dabs import calibrate_dabs  # noqa: E402
from brushsvg.calibration.numbers.from_widths import new_brush  # noqa: E402
from brushsvg.cli import main  # noqa: E402

BRUSH = find_brush("round-6")
DEPTHS, HEADINGS = (2.0, 4.0, 6.0, 8.0), np.radians([0, 180, 90, 270])
TURN = 2 * np.pi * np.arange(90) / 90


def seen_from_patch(depth):
    """Return an ellipse that is twice as long as wide.

    It begins behind the place where the brush was set down.
    """
    half = 0.42 * depth
    return np.column_stack([half * (0.8 - 2 * np.cos(TURN)), -half * np.sin(TURN)])


def dabs(outline=seen_from_patch, depths=DEPTHS):
    rng = np.random.default_rng(1)
    out = []
    for k, depth in enumerate(depths):
        for j, heading in enumerate(HEADINGS):
            place, u = np.array([20.0 + 25 * j, 20.0 + 25 * k]), np.array([np.cos(heading), np.sin(heading)])
            points = outline(depth) + rng.normal(0, 0.02, (len(TURN), 2))
            ring = points @ np.array([u, [-u[1], u[0]]]) + place + [0.4, -0.3] + rng.normal(0, 0.05, 2)
            out.append(Dab(f"dab-{len(out) + 1}", depth, place, heading, 0.95 * BRUSH.lag(depth), (ring,)))
    return out


def changed(number, change, of=None):
    """Return dabs in which one dab has other rings."""
    out = of or dabs()
    dab = out[number - 1]
    out[number - 1] = replace(dab, rings_mm=tuple(change(dab.rings_mm[0])))
    return out


def about(ring, share):
    return ring.mean(axis=0) + share * (ring - ring.mean(axis=0))


def combed(ring):
    """Return a ring with gaps between hairs, from one end to the middle."""
    shape = shapely.Polygon(ring)
    (x0, y0, x1, y1), wide = shape.bounds, np.ptp(ring, axis=0).max()
    gaps = [shapely.box(x0, y, (x0 + x1) / 2, y + 0.06 * wide) for y in np.arange(y0, y1, 0.12 * wide)]
    left = shapely.geometry.polygon.orient(shape.difference(shapely.union_all(gaps)))
    return [np.array(left.exterior.coords)[:-1]]


LEFT_OUT = {
    "no paint": (lambda: changed(6, lambda ring: []), "mark-missing dab-6"),
    "hollow": (lambda: changed(6, lambda ring: [ring, about(ring, 0.4)[::-1]]), "dab-hollow dab-6 16"),
    "in two parts": (
        lambda: changed(6, lambda ring: [ring, about(ring, 0.5) + np.array([4, 0])]),
        "dab-dry dab-6 2",
    ),
    "dry": (lambda: changed(6, combed), "dab-dry dab-6"),
    "smeared": (
        lambda: changed(6, lambda ring: [ring * [1.0, 1.3] - [0.0, 0.3 * ring[:, 1].mean()]]),
        "dab-unlike dab-6",
    ),
    "elsewhere": (lambda: changed(6, lambda ring: [ring + np.array([1.5, 0.0])]), "mark-astray dab-6"),
}


@pytest.mark.parametrize("what", LEFT_OUT)
def test_a_bad_dab_is_left_out_and_named(what):
    make, expected = LEFT_OUT[what]
    made = calibrate_dabs(make(), BRUSH, "own")
    assert are_reported(made.remarks, expected), made.remarks
    assert [len(shape.seen) for shape in made.outlines.shapes] == [4, 3, 4, 4]
    for shape in made.outlines.shapes:
        true = shapely.Polygon(seen_from_patch(shape.depth_mm))
        found = shapely.Polygon(shape.outline_mm)
        assert found.area == pytest.approx(true.area, rel=0.02)


def test_outlines_match_the_dabs_of_a_rotated_sheet():
    turn, about_mm, shift = 0.03, np.array([200.0, -50.0]), np.array([1.2, 0.7])
    turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    placed = [
        replace(dab, rings_mm=((dab.rings_mm[0] - about_mm) @ turned + about_mm + shift,))
        for dab in changed(6, lambda ring: [ring + np.array([1.5, 0.0])])
    ]
    found = calibrate_dabs(placed, BRUSH, "own").outlines.predicted_mm()
    assert set(found) == {dab.name for dab in placed} - {"dab-6"}
    for dab in placed:
        if dab.name in found:
            seen, computed = shapely.Polygon(dab.rings_mm[0]), shapely.Polygon(found[dab.name])
            assert seen.intersection(computed).area > 0.95 * seen.union(computed).area, dab.name


def test_dabs_that_touch_are_left_out():
    made = calibrate_dabs(dabs(), BRUSH, "own", joined=("dab-2", "dab-9"))
    assert are_reported(made.remarks, "dabs-touch dab-2", "dabs-touch dab-9")


def fixed_to_the_handle(headings=HEADINGS):
    """Return dabs with the same skewed shape on paper for any heading."""
    out = dabs()
    for k, dab in enumerate(out):
        away = dab.rings_mm[0] - dab.rings_mm[0].mean(axis=0)
        out[k] = replace(dab, rings_mm=(dab.rings_mm[0] + np.outer(away[:, 0] > 0, [0.3, 0.0]) * dab.depth_mm,))
    return out


def with_other(depth, outline):
    return [new if dab.depth_mm == depth else dab for dab, new in zip(dabs(), dabs(outline), strict=True)]


REFUSED = {
    "a depth without paint": (
        lambda: [replace(dab, rings_mm=()) if dab.depth_mm == 4 else dab for dab in dabs()],
        "dabs-too-few 0 4 2 dab-5",
    ),
    "one left of a depth": (
        lambda: [replace(dab, rings_mm=()) if dab.name in ("dab-5", "dab-6", "dab-8") else dab for dab in dabs()],
        "dabs-too-few 1 4 2 dab-8",
    ),
    "fixed to the handle": (fixed_to_the_handle, "dabs-turned"),
    "paint ran out": (lambda: with_other(8.0, lambda depth: 0.6 * seen_from_patch(depth)), "width-falls 8 6"),
    "landed for another lag": (
        lambda: [replace(dab, run_mm=1.3 * dab.run_mm) for dab in dabs()],
        "dabs-of-another-brush round-6",
    ),
    "deeper than the brush": (lambda: dabs(depths=(2.0, 6.0, 11.0)), "depth-out-of-range 11 10"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_dabs_that_determine_no_outline_are_refused(what):
    make, expected = REFUSED[what]
    with refused(expected):
        calibrate_dabs(make(), BRUSH, "own")


def test_the_patch_rests_while_a_dab_is_painted():
    """The patch rests while a dab is painted.

    This also holds for a lag that is short at first and then grows fast. A straight path would drag the
    patch.
    """
    late = new_brush("late", 5.0, [(4, 3.0), (8, 6.0)])
    late.lag = core.Profile([0.5, 0.0, 0.15])
    for brush in (BRUSH, late):
        for depth in (2.0, 8.0):
            plan = core.Plan(brush="x", brush_sha256="", sheet_mm=(100.0, 100.0))
            plan.passes = [core.Pass("dab", dab_poses(brush, depth, 90.0) + np.array([50, 50, 0]), 20.0)]
            trace = core.simulate(plan, brush).passes[0]
            np.testing.assert_allclose(trace.contact_mm, [[50, 50]] * len(trace.contact_mm), atol=1e-6)
            place, heading, run, deepest = read_dab_landing(plan.passes[0].poses_mm)
            assert (*place, heading, deepest) == pytest.approx((50, 50, np.pi / 2, depth))
            assert run == pytest.approx(0.95 * brush.lag(depth))


def test_a_chart_of_dabs_is_made():
    made = chart(BRUSH, (148.0, 210.0), "few", dabs=True)
    assert [stroke.kind for stroke in made.strokes] == ["dab"] * 16
    for depth in {stroke.depth_mm for stroke in made.strokes}:
        here = [one for one, stroke in zip(made.plan.passes, made.strokes, strict=True) if stroke.depth_mm == depth]
        headings = [round(np.degrees(read_dab_landing(one.poses_mm)[1])) % 360 for one in here]
        assert sorted(headings) == [0, 90, 180, 270]
    assert dab_depths(BRUSH, 3, 6.0) == [1.2, 3.6, 6.0]
    with refused("out-of-range liner 0.8 1.2", "brush"):
        chart(new_brush("liner", 6.0, [(2, 0.4), (5, 0.8)]), (148.0, 210.0), dabs=True)


def test_a_chart_of_dabs_writes_a_program_a_page_and_a_file(tmp_path, capsys):
    files = [str(tmp_path / name) for name in ("dabs.ngc", "page.svg", "dabs.json")]
    words = [
        "chart",
        "-o",
        files[0],
        "--dabs",
        "--sheet",
        "a5",
        "--strokes",
        "few",
        "--page",
        files[1],
        "--chart",
        files[2],
    ]
    assert main(words) == 0, capsys.readouterr().err
    made = read_chart((tmp_path / "dabs.json").read_bytes())
    assert is_of_dabs(made) and len(made.strokes) == 16
    assert "dab-16" in (tmp_path / "page.svg").read_text()
    program = (tmp_path / "dabs.ngc").read_text()
    assert program.count("(stroke ") == 16 and "Z-10.0000" in program
    assert not is_of_dabs(chart(BRUSH, (148.0, 210.0), "few"))
    assert (
        main(["chart", "-o", files[0], "--dabs", "--noise", "0.2"]) == 2
    )  # --noise is for intervals, which dabs do not show


def test_a_difference_between_headings_that_rounds_to_zero_is_called_equal():
    assert "0.02 mm" in describe_heading_difference(0.02)
    words = describe_heading_difference(0.004)
    assert "equal" in words and "0.00 " not in words
