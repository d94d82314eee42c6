"""Pixels laid over each other, against shapes whose answer is known."""

import numpy as np
import pytest

from brushsvg import Stroke, _core, compensate, find_brush, score, simulate, trace_outlines
from brushsvg.score import View, areas, meant, touching, width_error, widths_across, worst_place

WINDOW = (-12.0, -12.0, 64.0, 64.0)


def box(x0, y0, x1, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], float)


def hole(x0, y0, x1, y1):
    return box(x0, y0, x1, y1)[::-1]


def seen(wanted, painted=(), px_per_mm=10.0):
    pixels = [_core.coverage(list(rings), WINDOW, px_per_mm) for rings in (wanted, painted)]
    return View(WINDOW, px_per_mm, *pixels)


@pytest.mark.parametrize("turn_deg", [0, 30, 90, 213])
@pytest.mark.parametrize(
    ("rings", "width"),
    [
        ([box(0, 3.5, 20, 7)], 3.5),
        ([box(0, 5.5, 20, 7)], 1.5),  # beside the line, but within reach
        ([box(0, 9, 20, 12)], 0.0),  # too far off to be this line's mark
        ([box(0, 3, 20, 7), hole(1, 4, 19, 6)], 1.0),  # the line runs in the hole
        ([box(0, 3, 20, 7), box(0, 7.5, 20, 30)], 4.0),  # another mark beside it
        ([], 0.0),
    ],
)
def test_width_across_a_line(turn_deg, rings, width):
    c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    turn, middle = np.array([[c, s], [-s, c]]), np.array([10.0, 5.0])
    view = seen([(ring - middle) @ turn + 20 for ring in rings])
    along = np.array([[1.0, 0.0]]) @ turn
    found = widths_across(np.array([[20.0, 20.0]]), along, view.wanted, view, 3.0)
    assert found == pytest.approx([width], abs=0.03)


def line_of(*rows):
    xy = np.array([row[:2] for row in rows], float)
    arc = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))])
    return np.column_stack([xy, arc, [row[2] for row in rows]])


def test_width_error_is_the_mean_absolute_difference():
    line = line_of((0, 0, 2), (40, 0, 2))
    wanted = [box(-2, -2, 42, 2)]
    half_right = [np.array([(-2, -2), (42, -2), (42, 2), (20, 2), (20, 2.5), (-2, 2.5)], float)]
    assert width_error(line, seen(wanted, wanted)) == pytest.approx(0, abs=1e-9)
    assert width_error(line, seen(wanted, half_right)) == pytest.approx(0.25, abs=0.01)
    assert width_error(line, seen(wanted)) == pytest.approx(4, abs=0.01)


def test_width_is_not_measured_where_the_line_crosses_itself():
    line = line_of((0, 0, 1), (40, 0, 1))
    crossing = [np.array([(0, -1), (18, -1), (18, -9), (22, -9), (22, -1), (40, -1), (40, 1), (0, 1)], float)]
    assert width_error(line, seen(crossing, [box(0, -1, 40, 1)])) == pytest.approx(0, abs=1e-6)
    assert width_error(line, seen([box(0, -5, 40, 5)], crossing)) is None


def test_a_dab_has_no_width_error():
    assert width_error(line_of((3, 3, 1), (3, 3, 1)), seen([box(2, 2, 4, 4)], [box(2, 2, 4, 4)])) is None


def test_areas_and_the_worst_place():
    view = seen([box(0, 0, 20, 4)], [box(0, 0, 18, 4), box(5, 4, 6, 5)])
    found = areas(view)
    assert (found.common, found.together) == pytest.approx((72.0, 81.0), abs=0.01)
    assert found.overlap == pytest.approx(72 / 81, abs=1e-4)
    place, is_missing, area = worst_place(view, 2.0)
    assert is_missing
    assert place == pytest.approx((19, 2), abs=1.1)
    assert area == pytest.approx(4.0, abs=0.05)
    place, is_missing, area = worst_place(seen([box(0, 0, 20, 4)], [box(0, 0, 20, 4), box(5, 4, 6, 5)]), 1.0)
    assert not is_missing
    assert place == pytest.approx((5.5, 4.5), abs=0.11)
    assert area == pytest.approx(1.0, abs=0.03)


def test_nothing_wanted_and_nothing_painted_overlap():
    assert areas(seen([], [])).overlap == 1.0


def straight(name, a, b, half):
    a, b = np.array(a, float), np.array(b, float)
    return Stroke(
        name,
        np.concatenate([a, a + (b - a) / 3, a + 2 * (b - a) / 3, b])[None],
        half_width=[(0, half), (1, half)],
    )


def test_who_touches_whom():
    strokes = [
        straight("a", (0, 0), (20, 0), 1.0),
        straight("b", (10, 5), (10, 1.9), 1.0),
        straight("near", (0, 2.3), (5, 2.3), 0.99),  # its box meets that of a, 0.3 mm are between them
        straight("c", (10, 6), (30, 30), 1.0),
        straight("diagonal", (28, 8), (40, 20), 1.0),  # within the box of c
    ]
    assert touching(list(map(meant, strokes))) == [[0, 1, 3]]
    halves = [straight("left", (0, 40), (5, 40), 1), straight("right", (9, 40), (15, 40), 1)]
    assert touching(list(map(meant, halves))) == []
    halves[0].wanted_mm, halves[1].wanted_mm = (
        [box(0, 38, 7, 42)],
        [box(7, 38, 15, 42)],
    )  # shares of one letter
    assert touching(list(map(meant, halves))) == [[0, 1]]


def test_pixels_agree_with_rings():
    """On a drawing that needs tiles as well as on one that does not."""
    brush = find_brush("round-6")
    rng = np.random.default_rng(3)
    strokes = [
        straight(f"s{k}", rng.uniform(20, 580, 2), rng.uniform(20, 580, 2), float(half))
        for k, half in enumerate(rng.uniform(0.3, 4.0, 12))
    ]
    marks = simulate(compensate(strokes, brush, (600, 600)).plan, brush)
    trace_outlines(marks, brush)
    for some in (slice(0, 1), slice(0, 12)):
        painted = _core.unite([ring for trace in marks.passes[some] for ring in trace.outline_mm])
        wanted = _core.unite([ring for s in strokes[some] for ring in _core.wanted_outline(s, 0.01)])
        found = score.areas_of_sheet(marks.passes[some], list(map(meant, strokes[some])), brush)
        assert found.overlap == pytest.approx(_core.overlap(painted, wanted), abs=1e-3)
        assert found.together == pytest.approx(_core.area(_core.unite([*painted, *wanted])), rel=1e-3)
