"""Each cause of an error is found in a stroke that has this cause."""

import numpy as np
import pytest
from svg_text import read

from brushsvg import _core, compensate, find_brush, flatten, simulate
from brushsvg.show.evaluation import figures
from brushsvg.show.evaluation.error_causes import SCALE_UP, _path_cause, _sharpest_corner_deg, _StrokePlace
from brushsvg.show.evaluation.places import worst_places
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.wide_shapes import within_reach


def stroke(points, half, closed=False, target=None):
    p = np.asarray(points, float)
    a, b = p[:-1], p[1:]
    cubics = np.hstack([a, a + (b - a) / 3, a + 2 * (b - a) / 3, b])
    halves = np.broadcast_to(half, 2)
    made = _core.Stroke("s", cubics, closed, [(0.0, float(halves[0])), (1.0, float(halves[1]))])
    made.target_mm = target or []
    return made


def arc(radius, turns, count=40):
    angle = np.linspace(0, 2 * np.pi * turns, count)
    return 60 + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def box(x0, y0, x1, y1):
    return [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], float)]


def painted_plan(target, how="closed", name="round-6", tolerance_mm=0.05):
    brush = find_brush(name)
    painted, target, _ = within_reach([target], brush, "clamp")
    plan = compensate(painted, brush, (120, 120), how, tolerance_mm).plan
    return figures.PaintedPlan(plan, simulate(plan, brush), brush, target, tolerance_mm, compensation=how)


def found(target, how="closed", name="round-6", tolerance_mm=0.05):
    rows, _ = figures.measure_figures(painted_plan(target, how, name, tolerance_mm))
    return rows[0].worst


@pytest.mark.parametrize(
    ("target", "code", "says", "near"),
    [
        (
            stroke([(30, 40), (30, 40)], 2.0),
            "shorter-than-footprint",
            "",
            (30, 40),
        ),
        (stroke([(30, 40), (60, 40)], 8, target=box(22, 32, 68, 48)), "wider-than-brush", "16 mm", None),
        (stroke([(20, 40), (70, 40)], 0.3), "thinner-than-measured", "", None),
        (stroke([(20, 40), (60, 40), (25, 50)], 1.5), "sharp-corner", "164", (60, 40)),
        (stroke(arc(4.0, 1.0, 60), 3.9, True), "tighter-than-lag", "", None),
        (
            stroke([(30, 30), (70, 30), (70, 70), (30, 70), (30, 30)], 1.5, True),
            "sharp-corner",
            "90",
            None,
        ),
        (stroke(arc(20.0, 1.0, 200), 1.5, True), "off-middle-line", "0.0", None),
        (stroke([(20, 40), (70, 40)], 2.0), "stroke-start", "", (19, 40)),
        (stroke([(20, 40), (50, 40)], (0.6, 4.0)), "stroke-end", "", None),
    ],
)
def test_the_cause_of_an_error_is_reported(target, code, says, near):
    worst = found(target)
    assert worst.code == code and says in worst.reason
    if near:
        assert worst.place_mm == pytest.approx(near, abs=3.0)


def test_a_refined_job_is_not_advised_to_refine():
    tight = stroke(arc(4.0, 1.0, 60), 3.9, True)
    places = {how: worst_places(painted_plan(tight, how))[0] for how in ("closed", "refined")}
    assert {place.code for place in places.values()} == {"tighter-than-lag"}
    assert "refined" in places["closed"].remedy
    assert places["refined"].remedy == SCALE_UP


@pytest.mark.parametrize(("half", "is_missing"), [(2.0, True), (0.2, False)], ids=["wider", "thinner"])
def test_a_brush_of_one_width_is_reported_as_the_cause(half, is_missing):
    """A brush of one width is reported as the cause.

    The middle of a line 4 mm wide was once reported as 0.04 mm off, where the pen paints 1 mm.
    """
    bend = np.column_stack([np.linspace(20, 100, 60), 60 + 5 * np.sin(np.linspace(0, 6, 60))])
    worst = found(stroke(bend, half), name="rigid")
    assert worst.is_missing == is_missing
    assert worst.code == "one-width"
    assert f"{2 * half:g} mm" in worst.reason and "1 mm" in worst.reason


def test_a_round_nib_is_not_reported_as_pointed():
    square = stroke([(30, 40), (60, 40)], 0.5, target=box(28.8, 39.5, 60.4, 40.5))
    worst = found(square, name="rigid")
    assert worst.code == "stroke-start"


def test_a_coarse_tolerance_is_reported_as_the_cause():
    """A coarse tolerance is reported as the cause.

    With 5 mm, the footprint on bends was once reported, although the middle was off by more.
    """
    worst = found(stroke(arc(15.0, 1.0, 200), 2.0, True), "closed", tolerance_mm=5.0)
    assert worst.code == "coarse-tolerance" and "5 mm" in worst.reason
    fine = found(stroke(arc(15.0, 1.0, 200), 2.0, True), "closed")
    assert fine.code != "coarse-tolerance"


def test_the_middle_of_a_diamond_is_reported_as_a_change_of_width():
    """The width rises up to the middle and falls after it, so that its central difference is 0 there.

    The cause was once a tracking error of 2.8e-14 mm.
    """
    (diamond,), _ = strokes(read('<path d="M50 10L54 18L50 26L46 18Z" fill="red" stroke="none"/>'))
    line = flatten(diamond, 0.01)
    widest = _StrokePlace(diamond, line, find_brush("round-6"), int(line[:, 3].argmax()), True)
    assert _path_cause(widest).code == "steep-width"


def test_an_uncompensated_lag_is_reported_as_the_cause():
    target = stroke([(20, 40), (60, 40), (60, 80)], 1.5)
    assert found(target, "none").code == "lag-not-compensated"


def test_a_closed_line_has_a_corner_at_its_seam():
    """A closed line also has a corner at its seam.

    The worst place of a square was its beginning, and bends were once blamed.
    """
    square = flatten(stroke([(30, 30), (70, 30), (70, 70), (30, 70), (30, 30)], 1.5, True), 0.01)
    for s in (0.0, 1.0, 159.0, 160.0):
        assert _sharpest_corner_deg(square, s, 3.0, True) == pytest.approx(90)
        assert _sharpest_corner_deg(square, s, 3.0, False) == 0.0
    assert _sharpest_corner_deg(square, 20.0, 3.0, True) == 0.0


def test_a_flattened_dab_has_no_corner():
    line = flatten(stroke([(30, 40), (30, 40)], 2.0), 0.01)
    assert len(line) == 1
