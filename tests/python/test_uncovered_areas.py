"""Areas that no stroke reaches are named, shown, and explained in the report."""

import json
from pathlib import Path

import numpy as np
import pytest
from diagnostics import agrees, is_reported

import brushsvg
from brushsvg import _core, find_brush
from brushsvg.jobs import outputs
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.show.evaluation import figures
from brushsvg.strokes.uncovered_areas import UncoveredArea, notices_of_areas, uncovered_areas
from brushsvg.strokes.wide_shapes import within_reach

SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60"><path id="p" d="{}"/></svg>'
)
T = "M21 5H29V15H33V18H29V45H21V18H17V15H21Z"
THIN = "M20 5H22V45H20Z"
BLOCK = "M20 5H28V30H20Z"
WIDE = "M10 10H50V40H10Z"


def prepared(tmp_path, d: str, **options):
    file = tmp_path / "p.svg"
    file.write_text(SVG.format(d))
    return prepare(file, Options(**options))


def unreached(drawn, painted, brush):
    """Return the areas that no stroke reaches."""
    passes = _core.compensate(painted, brush, None, start="auto", end="auto").plan.passes
    return [each for each in uncovered_areas(drawn, painted, list(passes), brush) if not each.is_reached]


def bar_less(tmp_path):
    """Return the strokes of a t, and its stem alone."""
    drawn = list(prepared(tmp_path, T).drawn)
    stem = max(drawn, key=lambda stroke: max(half for _, half in stroke.half_width))
    return drawn, stem


def test_a_bar_without_a_stroke_is_reported_with_place_and_share(tmp_path):
    drawn, stem = bar_less(tmp_path)
    found = unreached(drawn, [stem], find_brush("round-6"))
    assert len(found) == 2
    assert {round(piece.at_mm[0] / 4) * 4 for piece in found} == {20, 32}
    assert all(abs(piece.at_mm[1] - 43.5) < 1.5 for piece in found)
    assert all(piece.share == pytest.approx(12 / 344, rel=0.3) for piece in found)
    (notice,) = notices_of_areas(found)
    assert agrees(notice, "unreached 2", "p")
    assert unreached(drawn, drawn, find_brush("round-6")) == []


@pytest.mark.parametrize("measured_mm", [(0.0, 10.0), None])
def test_a_brush_whose_width_starts_at_0_is_handled_normally(tmp_path, measured_mm):
    """A brush whose width begins at 0 is handled like any other brush.

    Photographed brushes are measured from depth 0. With such a file, each filled shape once ended in a
    ZeroDivisionError.
    """
    file = brush_file(tmp_path, lambda lag: lag.update(calibrated_mm=measured_mm) or lag)
    drawn, stem = bar_less(tmp_path)
    found = unreached(drawn, [stem], find_brush("round-6"))
    same = unreached(drawn, [stem], find_brush(file))
    assert [piece.at_mm for piece in same] == [piece.at_mm for piece in found]
    assert prepared(tmp_path, T, brush=find_brush(file)).unreached == ()


def brush_file(tmp_path, changed) -> str:
    """Write a brush file of round-6 with another lag and return its name."""
    shipped = json.loads((Path(brushsvg.__file__).parent / "data/brushes/round-6.json").read_text())
    lag = {key: value for key, value in changed(shipped["lag"]).items() if value is not None}
    file = tmp_path / "other.json"
    file.write_text(json.dumps({**shipped, "lag": lag}))
    return str(file)


def test_blunt_corners_are_not_reported(tmp_path):
    assert prepared(tmp_path, "M20 5H28V25H20Z").unreached == ()


def test_corners_at_a_butt_end_are_not_reported(tmp_path):
    """Corners at a squared end are not reported as unreached.

    Discs leave these corners blank, and a corner of 45 degrees counts as a limb.
    """
    work = prepared(tmp_path, "M8 10H19L51 42H40Z")
    assert work.unreached == ()
    assert not is_reported(work.notices, "unreached")


def test_a_shape_far_wider_than_the_brush_is_reported_unless_filled(tmp_path):
    work = prepared(tmp_path, WIDE, wide="clamp")
    assert sum(piece.share for piece in work.unreached) > 0.3
    assert is_reported(work.notices, "unreached", "p")
    assert all(piece.is_rim for piece in work.unreached)  # the stroke runs along the middle of the shape
    rim = prepared(tmp_path, "M20 5H31V45H20Z", wide="clamp")
    assert agrees(*notices_of_areas(rim.unreached), "unreached", "p")
    (row, *_), _ = figures.measure_figures(
        figures.PaintedPlan(rim.plan, predict(rim), rim.brush, rim.strokes, unreached=rim.unreached)
    )
    assert row.worst.code == "wider-than-brush"
    filled = prepared(tmp_path, WIDE, wide="passes")
    assert filled.unreached == ()


def test_the_unpainted_part_of_a_blunt_start_is_reported_with_place_and_share(tmp_path):
    """The unpainted part next to a blunt beginning is reported with place and share.

    A seventh of a short stem stays blank next to its pointed beginning, and this was not reported.
    """
    import shapely

    from brushsvg.strokes.swept_areas import region

    work = prepared(tmp_path, BLOCK, start="pointed")
    assert work.unreached == ()
    blank = region(work.drawn[0].target_mm).difference(region(predict(work).outline_mm))
    assert shapely.area(blank) / (8 * 25) == pytest.approx(sum(piece.share for piece in work.missed), abs=0.05)
    assert all(blank.contains(shapely.Point(piece.at_mm)) for piece in work.missed)
    (notice,) = [each for each in work.notices if each.code == "mark-misses"]
    assert notice.where == "p"
    assert f"{work.missed[0].at_mm[1]:.1f} mm" in notice.sentence
    assert b'class="blank"' in outputs.make_picture(".svg", work, predict(work))
    assert not prepared(tmp_path, THIN).missed


def test_uncovered_areas_are_outlined_in_every_picture(tmp_path):
    import cv2

    work = prepared(tmp_path, WIDE, wide="clamp")
    marks = predict(work)
    assert b'class="blank"' in outputs.make_picture(".svg", work, marks)
    picture = outputs.make_picture(".png", work, marks)
    image = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR)
    assert (np.abs(image.astype(int) - (0x1F, 0x43, 0xD1)).sum(axis=2) < 60).any()
    small = prepared(tmp_path, THIN)
    assert b'class="blank"' not in outputs.make_picture(".svg", small, predict(small))


def test_the_report_names_an_uncovered_area_as_the_reason(tmp_path):
    """The report names an unreached area as the reason for a fault.

    The bar of a t was once explained with "8.43 mm wide, wider than 8.4".
    """
    brush = find_brush("round-6")
    drawn, _ = bar_less(tmp_path)
    stem = _core.Stroke("p", np.array([[25, 51, 25, 40, 25, 30, 25, 19]], float), False, [(0.0, 4.215)])
    stem.target_mm = _core.unite([ring for stroke in drawn for ring in stroke.target_mm])
    painted, target, _ = within_reach([stem], brush)
    plan = _core.compensate(painted, brush, (60, 60), "closed", 0.05, None).plan
    marks = _core.simulate(plan, brush)

    def worst(unreached):
        return figures.measure_figures(figures.PaintedPlan(plan, marks, brush, target, unreached=unreached))[0][0].worst

    assert worst(()).is_missing
    assert worst(()).code != "wider-than-brush"
    x, y = worst(()).place_mm
    square = np.array([(x - 2, y - 2), (x + 2, y - 2), (x + 2, y + 2), (x - 2, y + 2)])
    assert worst([UncoveredArea("p", (x, y), 0.04, [square])]).code == "unreached"
    assert worst([UncoveredArea("q", (x, y), 0.04, [square])]).code != "unreached"


def test_a_corner_left_blank_by_discs_is_not_a_tracking_error(tmp_path):
    """A corner that discs leave blank is not a tracking error.

    For the corners of a bar with slanted cuts, the report once said: tracking error up to 0.012 mm.
    """
    work = prepared(tmp_path, "M10 10H50L45 16H15Z")
    (row, *_), _ = figures.measure_figures(figures.PaintedPlan(work.plan, predict(work), work.brush, work.strokes))
    assert row.worst.code == "shape-corner"
