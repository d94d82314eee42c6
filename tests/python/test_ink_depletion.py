"""The marks of a sheet from which the length of its one load of paint is known."""

import pytest

from brushsvg.calibration.marks.ink_depletion import find_ink_depletion
from brushsvg.calibration.marks.mark_input import read_painted

LENGTHS = (40.0, 30.0, 50.0, 20.0, 60.0)


def sheet(shares):
    """Return painted marks of straight strokes, and their full outlines.

    The strokes are 4 mm wide and have no names. Each share is the painted part of a stroke; an L before the
    strokes gives the lag.
    """
    ways = [[[0, 0, -2], [30, 0, -1], [30, 30, -1]]]
    ways += [[[0, 50 + 25 * k, -2], [length, 50 + 25 * k, -1]] for k, length in enumerate(LENGTHS)]
    plan = {"passes": [{"stroke": "", "poses_mm": poses, "speed_mm_s": 20} for poses in ways]}
    marks = [{"stroke": "stroke1", "outline_mm": [box(0, 0, 30, 4)]}]
    marks += [
        {"stroke": f"stroke{k + 2}", "outline_mm": [box(0, 48 + 25 * k, share * length, 4)]}
        for k, (share, length) in enumerate(zip(shares, LENGTHS, strict=True))
        if share
    ]
    painted = read_painted(plan, marks, None)
    full = [[box(0, 0, mark.poses_mm[-1][0], 4)] for mark in painted.marks]
    return painted, full


def box(x, y, long, wide):
    return [[x, y], [x + long, y], [x + long, y + wide], [x, y + wide]]


@pytest.mark.parametrize(
    ("shares", "whole", "between"),
    [
        ((1, 1, 1, 0, 0), "stroke4", (180, 200)),
        ((1, 1, 1, 0.5, 0), "stroke4", (180, 200)),
        ((1, 0, 1, 1, 0.6), "stroke5", (200, 260)),
        ((0.8, 0.85, 0.8, 0.75, 0), "stroke5", (200, 260)),
    ],
)
def test_the_last_complete_mark_and_the_next_mark_bound_the_load(shares, whole, between):
    painted, full = sheet(shares)
    found = find_ink_depletion(painted, full)
    assert (found.whole, found.dry) == (whole, f"stroke{int(whole[-1]) + 1}")
    assert (found.whole_mm, found.dry_mm) == pytest.approx(between)
    assert found.variance_mm2 == pytest.approx((between[1] - between[0]) ** 2 / 3)


@pytest.mark.parametrize("shares", [(1, 1, 1, 1, 1), (1, 0, 0.4, 1, 1), (0.7, 0.7, 0.7, 0.7, 0.7)])
def test_a_complete_last_mark_shows_no_depletion(shares):
    painted, full = sheet(shares)
    assert find_ink_depletion(painted, full) is None
    assert painted.way_mm == pytest.approx(60 + sum(LENGTHS))
