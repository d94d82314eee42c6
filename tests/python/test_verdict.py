"""The verdict of a report changes at each threshold; the tests try both sides."""

from dataclasses import replace

import pytest
from diagnostics import gives

from brushsvg import _core
from brushsvg.calibration.numbers.from_widths import new_brush
from brushsvg.errors import Notice
from brushsvg.jobs import outputs
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict_plan_marks
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.reporting.report_text import (
    GOOD,
    GOOD_OVERLAP,
    USABLE_OVERLAP,
    Report,
    format_overlap,
    overlap_reasons,
    percent,
    verdict,
)
from brushsvg.show.evaluation import figures, report
from brushsvg.show.evaluation.uncertainty import Confidence, PlanConfidence
from brushsvg.show.evaluation.verdict import UNCERTAIN_MM

ROW = figures.Figures("s", 0.97, 0.01, 0.04, 0.1, 0, 60.0, 81.5, 42)
MADE = report.Report("T", "mine", "closed", 0.05, (ROW,), ROW, 5)
BUT, NOT = "usable, but ", "do not use, because "


def with_overlap(overlap):
    return replace(MADE, total=replace(ROW, overlap=overlap))


def known_to(middle_mm):
    interval = Confidence(middle_mm, 0.1, 0.1)
    return replace(MADE, confidence=PlanConfidence("covariance", "", (interval,), interval))


@pytest.mark.parametrize(
    ("made", "begins", "named"),
    [
        (MADE, GOOD, ()),
        (with_overlap(GOOD_OVERLAP), GOOD, ()),
        (with_overlap(GOOD_OVERLAP - 0.001), BUT, ("94 %",)),
        (with_overlap(USABLE_OVERLAP), BUT, ("70 %",)),
        (with_overlap(USABLE_OVERLAP - 0.001), NOT, ("69 %",)),
        (with_overlap(None), BUT, ()),
        (replace(MADE, refused=(Notice("t", "SENTENCE"),)), BUT, ("1 of 2",)),
        (replace(MADE, strokes=(), refused=(Notice("t", "SENTENCE"),)), NOT, ()),
        (replace(MADE, strokes=()), NOT, ()),
        (replace(MADE, forbidden=(Notice("t", "SENTENCE"),)), NOT, ("SENTENCE",)),
        (replace(MADE, warnings=(Notice("t", "SENTENCE", code="odd"),)), GOOD, ()),
        *(
            (replace(MADE, warnings=(Notice("t", "SENTENCE", code=code),)), BUT, ("1",))
            for code in ("off-middle-line", "paint-outside")
        ),
        (replace(MADE, assumed=("lag", "width")), BUT, ("lag", "width", "mine")),
        (
            replace(MADE, without_interval=("lag", "width")),
            BUT,
            ("lag and width", "mine", "interval"),
        ),
        (known_to(UNCERTAIN_MM - 0.01), GOOD, ()),
        (known_to(UNCERTAIN_MM), BUT, ("mine", "1.0 mm")),
        (known_to(None), GOOD, ()),
        (replace(known_to(1.5), without_interval=("width",)), BUT, ("width", "interval", "1.5 mm")),
    ],
)
def test_each_reason_changes_the_verdict(made, begins, named):
    assert made.verdict.startswith(begins) and gives(made.verdict, *named)
    assert (made.verdict == GOOD) == (begins == GOOD)


TWO_LAGS, FOUR_LAGS = [(2, 6), (5, 8)], [(1, 3), (3, 5.1), (5, 7), (7, 9)]
TWO_WIDTHS, FOUR_WIDTHS = [(1, 1.5), (7, 7)], [(1, 1.5), (3, 3.4), (5, 5.1), (7, 7)]


@pytest.mark.parametrize(
    ("lags", "widths", "expected", "named"),
    [
        (TWO_LAGS, TWO_WIDTHS, BUT, ("lag and width", "interval")),
        (FOUR_LAGS, TWO_WIDTHS, BUT, ("the width", "interval")),
        (TWO_LAGS, FOUR_WIDTHS, BUT, ("lag of", "interval")),
        (FOUR_LAGS, FOUR_WIDTHS, GOOD, ()),
        (6.0, TWO_WIDTHS, BUT, ("never measured",)),
        (0.0, [(1, 3.0)], GOOD, ()),
    ],
)
def test_a_brush_without_confidence_interval_is_not_called_good(lags, widths, expected, named, tmp_path):
    """Three measurements have an interval, which may be wide. Two have none.

    A pen does not trail. It was to be calibrated, which `calibrate` refuses.
    """
    (tmp_path / "d.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60">'
        '<path d="M20 30 h50" fill="none" stroke="#000" stroke-width="3"/></svg>'
    )
    work = prepare(tmp_path / "d.svg", Options(brush=new_brush("mine", lags, widths)))
    made = outputs.make_report(work, predict_plan_marks(work.plan, work.brush), find_cell())
    assert made.verdict.startswith(expected) and gives(made.verdict, *named), made.verdict


def test_a_brush_file_without_rmse_has_laws_without_interval():
    """The keys about exactness are optional in a brush file. An RMSE of 0 says that a law is exact."""
    brush, coefficients = new_brush("mine", FOUR_LAGS, FOUR_WIDTHS), [0.0, 0.5]
    for half_width, names in (
        (brush.half_width, ()),
        (_core.Profile(coefficients, rmse_mm=0.0), ()),
        (_core.Profile(coefficients), ("width",)),
        (_core.Profile(coefficients, assumed=True), ()),
    ):
        brush.half_width = half_width
        assert outputs.list_laws_without_interval(brush) == names


def test_the_thresholds_equal_the_documentation():
    assert (GOOD_OVERLAP, USABLE_OVERLAP, UNCERTAIN_MM) == (0.95, 0.7, 1.0)


def test_errors_precede_warnings_and_further_ones_are_counted():
    assert verdict(["A"], ["B"]) == f"{NOT}A"
    assert verdict([], ["A", "", "B"]) == f"{BUT}A, and B"
    assert gives(verdict([], ["A", "B", "C", "D"]), "A", "B", "2") and "C" not in verdict([], ["A", "B", "C"])
    assert overlap_reasons(None, "X") == ([], [])


@pytest.mark.parametrize(("share", "words"), [(1.0, "100 %"), (0.999, "99 %"), (0.989, "98 %"), (0.0, "0 %")])
def test_only_a_complete_share_is_100_percent(share, words):
    assert percent(share) == words


@pytest.mark.parametrize(("overlap", "words"), [(0.9496, "0.949"), (0.95, "0.950"), (0.29, "0.290"), (1.0, "1.000")])
def test_overlap_is_rounded_down(overlap, words):
    assert format_overlap(overlap) == words


def test_a_report_has_ten_lines_and_details_list_everything():
    made = Report(GOOD, tuple("abcdefghijk"), ("table",))
    assert len(made.text().splitlines()) == 10 and gives(made.text().splitlines()[-1], "3")
    assert made.text(details=True).splitlines() == [GOOD, *"abcdefghijk", "", "table"]
    assert Report(GOOD, tuple("abcdefghi")).text().splitlines()[-1] == "i"
