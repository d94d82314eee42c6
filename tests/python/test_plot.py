"""Pictures of brushes have bands where there is a covariance.

Without matplotlib, a message says how to install it.
"""

import sys
import warnings

import matplotlib
import numpy as np
import pytest
from diagnostics import in_json
from sampling import sample

import brushsvg
from brushsvg import _core, brush_like, find_brush
from brushsvg.calibration.chart.page import chart_page
from brushsvg.comparison.job_page import job_page
from brushsvg.model.describe import describe_brush
from brushsvg.model.plot import brush_picture, brush_picture_on, law_band, new_figure


@sample("name", ["round-6", "rigid"], keep=1)
@pytest.mark.slow
def test_svg_and_png_pictures_are_reproducible(name):
    brush = find_brush(name)
    for suffix, start in ((".svg", b"<?xml"), (".png", b"\x89PNG")):
        picture = brush_picture(brush, suffix)
        assert picture.startswith(start)
        assert picture == brush_picture(brush, suffix)


def test_a_picture_leaves_the_settings_of_matplotlib_alone():
    """A picture of a brush once changed how the figures of the same process were saved."""
    before = dict(matplotlib.rcParams)
    brush_picture(find_brush("round-6"), ".svg")
    assert dict(matplotlib.rcParams) == before


def test_a_name_in_letters_that_the_font_lacks_gives_no_python_warning():
    brush = find_brush("round-6")
    brush.name = "\u6bdb\u7b14"
    page = job_page(
        brushsvg.compensate([brushsvg.stroke_from_path("M20 40H90", 3)], brush, sheet_mm=(140, 100)).plan, brush.name
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for suffix in (".svg", ".png"):
            assert brush_picture(brush, suffix)
        assert chart_page(page.printed, ".pdf")


def test_bands_follow_rmse_and_covariance():
    brush, depths = find_brush("round-6"), np.linspace(0, 10, 7)
    half, what = law_band(brush, "lag", depths)
    assert np.all(half == 0.58) and "RMSE" in what
    assert law_band(brush, "half_width", depths) is None
    # Computed by hand: of the 13 coefficients, only c0 and c1 of tip_gap vary, and they vary together.
    covariance = np.zeros((13, 13))
    covariance[5:7, 5:7] = [[0.04, -0.01], [-0.01, 0.01]]
    brush.covariance = covariance.tolist()
    half, what = law_band(brush, "tip_gap", depths)
    np.testing.assert_allclose(half, 1.959963985 * np.sqrt(0.04 - 0.02 * depths + 0.01 * depths**2))
    assert "95 %" in what
    assert "RMSE" in law_band(brush, "lag", depths)[1]


def test_a_law_taken_from_another_brush_is_not_shown_as_measured():
    """The picture and the description said that a brush nobody measured was measured from 1 to 10 mm."""
    brush = brush_like("mine", find_brush("round-6"))
    figure = new_figure((11, 7.2))
    brush_picture_on(figure, brush)
    assert {line.get_linestyle() for axes in figure.axes[:4] for line in axes.lines} == {":"}
    assert "measured at depths" in describe_brush(find_brush("round-6"))
    assert "measured at depths" not in describe_brush(brush)


def test_paint_is_drawn_if_the_brush_has_paint():
    """The paint picture shows the decay of the brush's paint.

    The middle line falls to the value of the law, and the band around it widens with the length.
    """
    brush = find_brush("round-6")
    brush.paint = _core.Paint(0.5, calibrated_mm=(0, 800), lasts_mm=600, covariance=[[0.01, 0], [0, 400]])
    figure = new_figure((11, 7.2))
    brush_picture_on(figure, brush)
    (axes,) = (each for each in figure.axes if each.get_title().startswith("paint"))
    x, y = axes.lines[0].get_data()
    assert x[-1] == 800 and y[0] == 100 and y[-1] == pytest.approx(100 * np.exp(-0.4))
    low = axes.collections[0].get_paths()[0].vertices[:, 1].min()
    assert low == pytest.approx(100 * np.exp(-0.8 * (0.5 + 1.959963985 * 0.1)))
    assert [each.get_position()[0] for each in axes.texts].count(600) == 1, "where hairs run dry"


def test_each_curve_is_labelled_once_and_no_label_covers_a_law():
    """Each curve is named once, and no name covers a law.

    The names are in one legend below the laws. Each law has its line, its band and its measurements.
    """
    brush = find_brush("round-6")
    figure = new_figure((11, 7.2))
    brush_picture_on(figure, brush, {"lag": np.array([[1, 4.0], [9, 13.0]])})
    figure.draw_without_rendering()
    (legend,) = figure.legends
    names = [text.get_text() for text in legend.get_texts()]
    assert len(names) == len(set(names)) == 4
    below = legend.get_window_extent().y1
    assert all(axes.get_legend() is None and axes.get_window_extent().y0 > below for axes in figure.axes)
    drawn = [each for axes in figure.axes[:4] for each in (*axes.lines, *axes.collections)]
    assert all(each.get_label() in names for each in drawn)


def test_missing_matplotlib_is_reported_with_the_install_command(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, _, ((_, reported),) = in_json(capsys, "brush", "plot", "round-6", "-o", tmp_path / "out.svg")
    assert (status, reported.code) == (1, "package-missing")
    assert reported.sentence.endswith(f" {sys.executable} -m pip install matplotlib")
    assert not list(tmp_path.iterdir())
