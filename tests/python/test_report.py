"""Figures of the report agree with shapes whose answer is known."""

import csv
import dataclasses
import json
import re

import numpy as np
import pytest
from diagnostics import gives

from brushsvg import Stroke, compensate, find_brush, simulate
from brushsvg.errors import Notice
from brushsvg.reporting.report_text import format_overlap
from brushsvg.show.evaluation import figures
from brushsvg.show.evaluation.figures import Figures, Group, PaintedPlan, Worst, group_touching_strokes, measure_figures
from brushsvg.show.evaluation.places import Place, worst_places
from brushsvg.show.evaluation.report import Report, as_text, to_csv, to_json, to_text
from brushsvg.show.evaluation.uncertainty import Confidence, PlanConfidence


def straight(stroke_id, start, end, half_width, knots=None):
    a, b = np.array(start, float), np.array(end, float)
    cubic = np.concatenate([a, a + (b - a) / 3, a + 2 * (b - a) / 3, b])[None]
    return Stroke(stroke_id, cubic, half_width=knots or [(0, half_width), (1, half_width)])


@pytest.fixture(scope="module")
def two_strokes():
    brush = find_brush("round-6")
    strokes = [straight("a", (10, 20), (70, 20), 1.5), straight("b", (10, 40), (30, 40), 1.5)]
    found = {}
    for how in ("none", "closed"):
        plan = compensate(strokes, brush, (90, 60), how).plan
        marks = simulate(plan, brush)
        found[how] = measure_figures(PaintedPlan(plan, marks, brush, strokes))
    return found


def test_compensation_improves_the_figures(two_strokes):
    (_, without), (rows, with_it) = two_strokes["none"], two_strokes["closed"]
    assert without.overlap < 0.85 < 0.93 < with_it.overlap <= 1
    assert with_it.centre_largest_mm < 0.05
    assert with_it.width_error_mm < 0.1
    assert [row.overlap for row in rows] == pytest.approx([with_it.overlap] * 2, abs=0.05)
    assert len({row.overlap for row in (*rows, with_it)}) == 3
    assert rows[0].drawn_mm == pytest.approx(60)
    assert rows[0].painted_mm > 60
    assert with_it.drawn_mm == pytest.approx(80)


def test_the_total_is_weighted_by_length(two_strokes):
    rows, total = two_strokes["none"]
    expected = (60 * rows[0].width_error_mm + 20 * rows[1].width_error_mm) / 80
    assert total.width_error_mm == pytest.approx(expected)
    assert total.centre_largest_mm == max(row.centre_largest_mm for row in rows)
    assert total.poses == sum(row.poses for row in rows)


def test_widths_out_of_reach_are_counted():
    brush = find_brush("round-6")
    stroke = straight("a", (0, 0), (9, 0), 0, [(0, 1.0), (0.5, 4.3), (1, 0.5)])
    assert figures._out_of_reach(stroke, brush) == 1
    assert figures._out_of_reach(stroke, find_brush("rigid")) == 0


UNKNOWN = Figures("p", None, None, None, None, None, None, 12.0, 7)
ROW = Figures("s/1", 0.9512345678, 0.01, 0.04, 0.125, 0, 60.0, 81.5, 42)


def test_a_line_that_tapers_to_nothing_is_measured():
    """Compensation gets the widths that a brush can paint, the report compares with the drawn ones."""
    brush = find_brush("round-6")
    drawn = straight("s", (20, 30), (80, 30), 2.0, [(0, 0.0), (0.5, 2.0), (1, 0.0)])
    plan = compensate([drawn.replaced(half_width=[(0, 0.1), (0.5, 2.0), (1, 0.1)])], brush, (100, 60)).plan
    _, total = measure_figures(PaintedPlan(plan, simulate(plan, brush), brush, [drawn]))
    assert total.overlap > 0.9 and total.centre_largest_mm < 0.2


def test_json_is_complete_and_without_nan():
    made = Report(
        "T",
        "round-6",
        "closed",
        0.05,
        (ROW,),
        ROW,
        75.04,
        (Notice("s/1", "odd", code="strange", advice="fix"),),
    )
    read = json.loads(to_json(made), parse_constant=lambda name: pytest.fail(name))
    assert read["format"] == "brushsvg/report"
    assert read["strokes"][0]["overlap"] == 0.951235
    assert read["total"]["poses"] == 42
    reported = {
        "where": "s/1",
        "sentence": "odd; fix",
        "code": "strange",
        "advice": "fix",
        "damaged": False,
        "refused": False,
    }
    assert read["warnings"] == [reported]


def test_text_names_every_stroke_and_marks_unknown_values():
    made = Report("", "round-6", "", None, (UNKNOWN,), UNKNOWN, 75.4)
    for details in (False, True):
        text = to_text(made, details)
        assert "nan" not in text.lower()
        assert "None" not in text
        assert "1 min 15 s" in text
    assert any(gives(line, "1", "round-6") for line in text.splitlines())
    both = Report("T", "round-6", "closed", 0.05, (ROW, ROW), ROW, 5, (Notice("", "odd"),))
    long = to_text(both, details=True)
    assert any(gives(line, "T: 2", "round-6", "closed", "0.05 mm") for line in long.splitlines())
    assert long.startswith(to_text(both)) and "s/1 " not in to_text(both)
    assert long.count("s/1 ") == 3
    assert long.endswith(": 1\n  odd\n")


def test_strokes_that_touch_are_compared_together():
    brush = find_brush("round-6")
    strokes = [
        straight("down", (40, 60), (40, 20), 2.0),
        straight("alone", (70, 60), (70, 20), 2.0),
        straight("across", (25, 41), (60, 41), 2.0),
    ]
    plan = compensate(strokes, brush, (90, 80)).plan
    marks = simulate(plan, brush)
    (letter,) = group_touching_strokes(marks, brush, strokes)
    assert letter.strokes == ("down", "across")
    rows, total = measure_figures(PaintedPlan(plan, marks, brush, strokes))
    assert max(rows[0].overlap, rows[2].overlap) - 0.03 < letter.overlap
    assert group_touching_strokes(marks, brush, None) == ()
    text = to_text(Report("T", "round-6", "closed", 0.05, rows, total, 5, groups=(letter,)), details=True)
    assert f"down + across    {format_overlap(letter.overlap)}" in text


def test_a_repeated_stroke_does_not_lower_the_overlap_of_its_letter():
    brush = find_brush("round-6")
    strokes = [straight("a", (20, 20), (60, 20), 2.0), straight("b", (60, 20), (20, 20), 2.0)]
    plan = compensate(strokes, brush, (90, 80)).plan
    marks = simulate(plan, brush)
    rows, _ = measure_figures(PaintedPlan(plan, marks, brush, strokes))
    (letter,) = group_touching_strokes(marks, brush, strokes)
    # Each mark covers the pointed start of the other mark.
    assert letter.overlap > max(row.overlap for row in rows) + 0.01


WORST = Worst((12.34, 5.67), True, 0.5, "too short", "shorter-than-footprint")


def test_the_worst_place_is_reported():
    row = Figures("s", 0.9, 0.01, 0.04, 0.125, 0, 60.0, 81.5, 42, WORST)
    made = Report("T", "round-6", "closed", 0.05, (row,), ROW, 5, advice="Size: fine.")
    assert re.search(r"42  x 12\.3, y 5\.7: .*; too short\n", to_text(made, details=True))
    assert to_text(made, details=True).endswith("\n\nSize: fine.\n")
    read = json.loads(to_json(made))
    assert read["strokes"][0]["worst"] == {
        "place_mm": [12.34, 5.67],
        "is_missing": True,
        "area_mm2": 0.5,
        "reason": "too short",
        "code": "shorter-than-footprint",
    }
    assert read["total"]["worst"] is None
    assert read["groups"] == []


def test_json_contains_groups():
    made = Report("T", "b", "closed", 0.05, (ROW,), ROW, 5, groups=(Group(("a", "b"), 0.9512345678),))
    assert json.loads(to_json(made))["groups"] == [{"strokes": ["a", "b"], "overlap": 0.951235}]


PLACE = Place(1, "s", (12.34, 5.67), 0.5, 0.0, 0.3, "REASON", "shape-corner", "REMEDY", "SIZE")


def test_the_text_is_at_most_ten_lines():
    notices = tuple(Notice(f"s{k}", f"SENTENCE {k}", code=f"c{k}") for k in range(20))
    places = tuple(dataclasses.replace(PLACE, number=k) for k in range(1, 6))
    rows = (ROW,) * 30
    full = Report("T", "b", "closed", 0.05, rows, ROW, 5, notices, notices[:3], advice="Size: fine.", places=places)
    lines = to_text(full, picture="p.png").splitlines()
    assert len(lines) == 10
    assert gives(lines[1], "T", "95 %", "0.951", "5 s")
    assert [line[:2] for line in lines[2:7]] == ["1.", "2.", "3.", "4.", "5."]
    assert gives(lines[2], "1", "s", "12.3", "5.7", "SIZE", "REASON", "REMEDY")
    assert gives(lines[7], "3", "s0") and gives(lines[8], "20", "s0") and gives(lines[9], "p.png")
    assert len(to_text(full, details=True).splitlines()) > 60


def test_json_contains_places_and_the_verdict():
    made = Report("T", "b", "closed", 0.05, (ROW,), ROW, 5, places=(PLACE,))
    read = json.loads(to_json(made))
    assert read["verdict"] == made.verdict == to_text(made).splitlines()[0]
    assert read["places"] == [
        {
            "number": 1,
            "stroke": "s",
            "place_mm": [12.34, 5.67],
            "missing_mm2": 0.5,
            "outside_mm2": 0.0,
            "tracking_error_mm": 0.3,
            "reason": "REASON",
            "code": "shape-corner",
            "remedy": "REMEDY",
        }
    ]


def test_csv_has_a_row_per_stroke_and_empty_cells_for_unknown_values():
    row = Figures('a "b", c', 0.9, 0.01, 0.04, 0.125, 0, 60.0, 81.5, 42, WORST)
    interval = Confidence(0.4, None, 0.2)
    known = PlanConfidence("covariance", "words", (interval, interval), interval)
    made = Report("T", "b", "closed", 0.05, (row, UNKNOWN), ROW, 5, confidence=known)
    first, second = csv.DictReader(to_csv(made).splitlines())
    assert (first["stroke"], first["overlap"], first["poses"]) == ('a "b", c', "0.9", "42")
    assert (first["worst_x_mm"], first["worst_y_mm"], first["worst_code"]) == ("12.34", "5.67", WORST.code)
    assert (first["middle_mm_95"], first["ends_mm_95"]) == ("0.4", "")
    assert (second["overlap"], second["worst_x_mm"], second["painted_mm"]) == ("", "", "12.0")
    bare = as_text(".csv", Report("T", "b", "closed", 0.05, (ROW,), ROW, 5))
    assert len(bare.splitlines()) == 2 and "_95" not in bare


def test_the_worst_place_is_where_the_lag_is_not_compensated():
    brush = find_brush("round-6")
    straight_on = straight("a", (10, 20), (70, 20), 1.5)
    bend = Stroke("bend", np.array([[10, 40, 40, 40, 60, 50, 60, 70]], float), half_width=[(0, 1.5), (1, 1.5)])
    plan = compensate([straight_on, bend], brush, (90, 90), "none").plan
    marks = simulate(plan, brush)
    places = worst_places(PaintedPlan(plan, marks, brush, [straight_on, bend], compensation="none"))
    assert places[0].stroke == "bend" and [place.number for place in places] == [*range(1, len(places) + 1)]
    assert places[0].code == "lag-not-compensated" and places[0].remedy
    assert places[0].missing_mm2 + places[0].outside_mm2 > 10
    good = compensate([straight_on, bend], brush, (90, 90)).plan
    places = worst_places(PaintedPlan(good, simulate(good, brush), brush, [straight_on, bend]))
    assert {place.code for place in places} <= {"stroke-start", "stroke-end"}, "plain ends are pointed"


def test_paint_of_another_stroke_is_not_a_difference():
    brush = find_brush("round-6")
    strokes = [straight("down", (40, 60), (40, 20), 2.0), straight("across", (25, 41), (60, 41), 2.0)]
    plan = compensate(strokes, brush, (90, 80)).plan
    marks = simulate(plan, brush)
    both = worst_places(PaintedPlan(plan, marks, brush, strokes))
    one = worst_places(PaintedPlan(plan, marks, brush, [strokes[0], None], drawn=strokes[:1]))
    assert max(place.outside_mm2 for place in both) < 1 < 40 < one[0].outside_mm2
    assert {place.stroke for place in one} == {"down"}
