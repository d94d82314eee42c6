"""Figures of the report against shapes whose answer is known."""

import json

import numpy as np
import pytest

from brushsvg import Stroke, compensate, find_brush, report, simulate, trace_outlines
from brushsvg.report import Figures, Report, measure, to_json, to_text, width_error, widths_across


def straight(stroke_id, start, end, half_width, knots=None):
    a, b = np.array(start, float), np.array(end, float)
    cubic = np.concatenate([a, a + (b - a) / 3, a + 2 * (b - a) / 3, b])[None]
    return Stroke(stroke_id, cubic, half_width=knots or [(0, half_width), (1, half_width)])


def box(x0, y0, x1, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], float)


def hole(x0, y0, x1, y1):
    return box(x0, y0, x1, y1)[::-1]


AT = np.array([(5.0, 5.0)])


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
    turn = np.array([[c, s], [-s, c]])
    found = widths_across(
        AT @ turn, np.array([[1.0, 0.0]]) @ turn, [ring @ turn for ring in rings], np.array([3.0])
    )
    assert found == pytest.approx([width], abs=1e-9)


def line_of(*rows):
    xy = np.array([row[:2] for row in rows], float)
    arc = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))])
    return np.column_stack([xy, arc, [row[2] for row in rows]])


def test_width_error_is_the_mean_absolute_difference():
    line = line_of((0, 0, 2), (40, 0, 2))
    wanted = [box(-2, -2, 42, 2)]
    half_right = [np.array([(-2, -2), (42, -2), (42, 2), (20, 2), (20, 2.5), (-2, 2.5)], float)]
    assert width_error(line, wanted, wanted) == pytest.approx(0, abs=1e-12)
    assert width_error(line, half_right, wanted) == pytest.approx(0.25, abs=1e-9)
    assert width_error(line, [], wanted) == pytest.approx(4)


def test_width_is_not_measured_where_the_line_crosses_itself():
    line = line_of((0, 0, 1), (40, 0, 1))
    crossing = [np.array([(0, -1), (18, -1), (18, -9), (22, -9), (22, -1), (40, -1), (40, 1), (0, 1)], float)]
    assert width_error(line, [box(0, -1, 40, 1)], crossing) == pytest.approx(0, abs=1e-12)
    assert width_error(line, crossing, [box(0, -5, 40, 5)]) is None


def test_a_dab_has_no_width_error():
    assert width_error(line_of((3, 3, 1), (3, 3, 1)), [box(2, 2, 4, 4)], [box(2, 2, 4, 4)]) is None


@pytest.fixture(scope="module")
def two_strokes():
    brush = find_brush("round-6")
    strokes = [straight("a", (10, 20), (70, 20), 1.5), straight("b", (10, 40), (30, 40), 1.5)]
    found = {}
    for how in ("none", "closed"):
        plan = compensate(strokes, brush, (90, 60), how).plan
        marks = simulate(plan, brush)
        trace_outlines(marks, brush)
        found[how] = measure(plan, marks, brush, strokes)
    return found


def test_compensation_is_seen_in_the_figures(two_strokes):
    (_, without), (rows, with_it) = two_strokes["none"], two_strokes["closed"]
    assert without.overlap < 0.85 < 0.93 < with_it.overlap <= 1
    assert with_it.centre_largest_mm < 0.05
    assert with_it.width_error_mm < 0.1
    assert [row.overlap for row in rows] == pytest.approx([with_it.overlap] * 2, abs=0.05)
    assert len({row.overlap for row in (*rows, with_it)}) == 3
    assert rows[0].drawn_mm == pytest.approx(60)
    assert rows[0].painted_mm > 60
    assert with_it.drawn_mm == pytest.approx(80)


def test_the_sum_weighs_by_length(two_strokes):
    rows, total = two_strokes["none"]
    expected = (60 * rows[0].width_error_mm + 20 * rows[1].width_error_mm) / 80
    assert total.width_error_mm == pytest.approx(expected)
    assert total.centre_largest_mm == max(row.centre_largest_mm for row in rows)
    assert total.poses == sum(row.poses for row in rows)


def test_widths_out_of_reach_are_counted():
    brush = find_brush("round-6")
    stroke = straight("a", (0, 0), (9, 0), 0, [(0, 1.0), (0.5, 4.3), (1, 0.5)])
    assert report._out_of_reach(stroke, brush) == 1
    assert report._out_of_reach(stroke, find_brush("rigid")) == 0


UNKNOWN = Figures("p", None, None, None, None, None, None, 12.0, 7)
ROW = Figures("s/1", 0.9512345678, 0.01, 0.04, 0.125, 0, 60.0, 81.5, 42)


def test_json_is_complete_and_without_nan():
    made = Report("T", "round-6", "closed", 0.05, (ROW,), ROW, 75.04, (("s/1", "odd"),))
    read = json.loads(to_json(made), parse_constant=lambda name: pytest.fail(name))
    assert read["format"] == "brushsvg/report"
    assert read["strokes"][0]["overlap"] == 0.951235
    assert read["total"]["poses"] == 42
    assert read["warnings"] == [{"where": "s/1", "sentence": "odd"}]


def test_text_names_every_stroke_and_says_what_is_not_known():
    text = to_text(Report("", "round-6", "", None, (UNKNOWN,), UNKNOWN, 75.4))
    assert text.startswith("untitled: 1 stroke, brush round-6\n")
    assert "nan" not in text.lower()
    assert "None" not in text
    assert "1 min 15 s" in text
    both = to_text(Report("T", "round-6", "closed", 0.05, (ROW, ROW), ROW, 5, (("", "odd"),)))
    assert both.startswith("T: 2 strokes, brush round-6, compensation closed, tolerance 0.05 mm\n")
    assert both.count("s/1 ") == 3
    assert both.endswith("Warnings: 1\n  odd\n")
