"""Where paint and drawing differ most, on squares whose answer is known."""

import numpy as np
import pytest

from brushsvg.reporting.worst_areas import MIN_AREA_MM2, worst_areas

PX = 20.0  # per mm
LINES = [np.array([(1.0, 5.0), (9.0, 5.0)]), np.array([(1.0, 15.0), (9.0, 15.0)])]


def sheet(*boxes):
    """Return a raster of 10 x 20 mm; boxes are left, bottom, right, top in mm."""
    out = np.zeros((round(20 * PX), round(10 * PX)), np.float32)
    for left, bottom, right, top in boxes:
        out[round((20 - top) * PX) : round((20 - bottom) * PX), round(left * PX) : round(right * PX)] = 1.0
    return out


def found(target, painted, most=5):
    return worst_areas(target, painted, (0.0, 20.0), PX, LINES, most)


def test_the_largest_area_is_first_with_place_size_and_stroke():
    target = sheet((1, 4, 9, 6), (1, 14, 9, 16))
    painted = sheet((2, 4, 9, 6), (1, 14, 9, 16), (1, 16, 4, 16.5))
    missing, outside = found(target, painted)
    assert (missing.stroke, outside.stroke) == (0, 1)
    assert (missing.missing_mm2, missing.outside_mm2) == pytest.approx((2.0, 0.0), abs=0.1)
    assert (outside.missing_mm2, outside.outside_mm2) == pytest.approx((0.0, 1.5), abs=0.1)
    assert missing.at_mm == pytest.approx((1.5, 5.0), abs=0.6) and outside.at_mm[1] == pytest.approx(16.25, abs=0.2)
    assert missing.is_missing and not outside.is_missing
    assert [area.stroke for area in found(target, painted, most=1)] == [0]


def test_displaced_paint_is_one_area():
    (area,) = found(sheet((1, 4, 5, 6)), sheet((1.2, 4.4, 5, 6.4)))
    assert area.missing_mm2 > 1 and area.outside_mm2 > 1
    assert area.words.count("mm^2") == 2


def test_slivers_and_specks_are_not_reported():
    target = sheet((1, 4, 9, 6))
    assert found(target, sheet((1, 4, 9, 6.15))) == []
    assert len(found(target, sheet((1, 4, 9, 6.25)))) == 1
    side = 0.9 * MIN_AREA_MM2**0.5
    assert found(target, sheet((1, 4, 9, 6), (2, 7, 2 + side, 7 + side))) == []
    assert len(found(target, sheet((1, 4, 9, 6), (2, 7, 2.5, 7.5)))) == 1
    assert found(target, target) == []


def test_area_at_a_dot_belongs_to_the_dot():
    """The middle line of a dot has one point."""
    lines = [LINES[0], np.array([(5.0, 15.0)])]
    (area,) = worst_areas(sheet(), sheet((4, 14, 6, 16)), (0.0, 20.0), PX, lines, 1)
    assert area.stroke == 1
