"""By default, each stroke begins in the way that paints it best."""

from itertools import product

import numpy as np
import pytest

import brushsvg
from brushsvg import _core, compensate, find_brush


def overlap(stroke, brush, start, end="auto"):
    marks = _core.simulate(compensate([stroke], brush, (200, 200), start=start, end=end).plan, brush)
    _core.trace_outlines(marks, brush)
    return _core.overlap(marks.outline_mm, _core.target_outline(stroke, 0.01))


def test_a_wide_stroke_that_bends_at_once_begins_round():
    """A wide stroke that bends at once begins round.

    The round beginning of an S has a long way back. The comparison once looked at a part where it painted too
    little, and chose the pointed beginning.
    """
    middle = np.array(
        [
            [39.8, 53.7, 39.6, 54.6, 39.5, 55.5, 39.2, 56.3],
            [39.2, 56.3, 38.7, 57.4, 37.8, 58.3, 37.0, 59.1],
            [37.0, 59.1, 33.4, 62.5, 29.0, 60.5, 26.8, 56.7],
            [26.8, 56.7, 26.1, 55.5, 25.5, 53.9, 25.4, 52.5],
            [25.4, 52.5, 25.4, 52.5, 25.6, 50.8, 25.6, 50.8],
            [25.6, 50.8, 25.6, 50.1, 25.6, 49.7, 25.7, 49.0],
            [25.7, 49.0, 26.6, 44.5, 32.3, 41.1, 35.9, 38.6],
            [35.9, 38.6, 39.1, 36.5, 42.3, 33.8, 41.6, 29.5],
        ]
    )
    widths = [
        (0.0, 4.2),
        (0.067, 4.2),
        (0.134, 4.1),
        (0.184, 3.5),
        (0.217, 3.3),
        (0.266, 3.3),
        (0.383, 3.6),
        (0.4, 3.6),
        (0.433, 3.8),
        (0.466, 3.7),
        (0.5, 4.0),
        (0.549, 4.1),
        (0.583, 4.0),
        (0.683, 3.6),
        (0.717, 3.6),
        (0.783, 3.2),
        (0.8, 3.2),
        (0.817, 3.2),
        (0.867, 3.6),
        (0.966, 3.9),
        (1.0, 3.9),
        (1.0, 3.9),
    ]
    stroke = _core.Stroke(middle_mm=middle, half_width=widths)
    brush = find_brush("round-6")
    assert overlap(stroke, brush, "auto") > overlap(stroke, brush, "pointed") + 0.02


def arc(radius_mm, half_mm, from_rad, sweep_rad):
    at = np.linspace(from_rad, from_rad + sweep_rad, int(abs(sweep_rad) / 0.4) + 2)
    places = 100 + radius_mm * np.column_stack([np.cos(at), np.sin(at)])
    handles = radius_mm * 4 / 3 * np.tan((at[1] - at[0]) / 4) * np.column_stack([-np.sin(at), np.cos(at)])
    cubics = np.hstack([places[:-1], (places + handles)[:-1], (places - handles)[1:], places[1:]])
    return _core.Stroke(middle_mm=cubics, half_width=[(0.0, half_mm)])


@pytest.mark.thorough
def test_automatic_ends_of_arcs_are_as_good_as_the_best_requested_ends():
    """The automatic ends of arcs are as good as the best ends that you can request.

    The arcs are wide. Every second one has a radius of at most 11 mm and nearly the brush's full width. Of
    those arcs, 18 once began pointed. The judge extended the path by half a width along its first chord, not
    along its tangent.
    """
    brush, rng = find_brush("round-6"), np.random.default_rng(21)
    worse = []
    for k in range(100):
        radius_mm, width_mm = (
            (rng.uniform(8, 11), rng.uniform(8.2, 8.4)) if k % 2 else (rng.uniform(8, 20), rng.uniform(4, 8.2))
        )
        stroke = arc(
            radius_mm,
            width_mm / 2,
            rng.uniform(0, 2 * np.pi),
            rng.uniform(1, 1.5 * np.pi) * rng.choice([-1, 1]),
        )
        ways = product(("pointed", "round", "butt"), ("round", "butt"))
        lost = max(overlap(stroke, brush, *way) for way in ways) - overlap(stroke, brush, "auto")
        if lost > 0.005:
            worse.append((radius_mm, width_mm, lost))
    assert len(worse) <= 5, worse


def ball(radius_mm, half_mm, before):
    """Return a line round a bend that begins in a ball.

    The line begins before the ball's middle; `before` is the relative width there.
    """
    widths = [(0.0, before), (0.08, 1.0), (0.25, 0.6), (0.4, 0.4), (1.0, 0.8)]
    line = arc(radius_mm, 1.0, 0.0, 4.5)
    return line.replaced(half_width=[(at, half * half_mm) for at, half in widths])


def test_a_ball_at_the_start_is_turned_in_place_if_that_is_better():
    brush = find_brush("round-6")
    for half_mm in (2.2, 2.8):
        stroke = ball(5.0, half_mm, 1.0)
        for start in ("auto", "round", "butt"):  # These lines have no straight cut that needs square ends.
            assert overlap(stroke, brush, start) > 0.972, "going back 0.959 and 0.962 were reached"


def test_a_ball_is_filled_if_the_line_begins_next_to_its_middle():
    """A ball is filled if the line begins next to the ball's middle.

    A disc about the line's first point, as wide as the line is there, leaves a crescent of the ball of a c
    bare.
    """
    brush = find_brush("round-6")
    stroke = ball(3.5, 2.8, 0.7)
    assert overlap(stroke, brush, "auto") > 0.965


def test_a_dot_with_sides_keeps_the_depths_of_its_turns(tmp_path):
    """A dot that has sides keeps the depths of its turns.

    The moves of such a dot may be lines, which have no turn: a depth of 185 km was once read from them.
    """
    drawing = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="70mm" viewBox="0 0 100 70">'
        '<circle id="dot" cx="70" cy="40" r="1.2"/></svg>'
    )
    (tmp_path / "dot.svg").write_text(drawing)
    done = brushsvg.convert(tmp_path / "dot.svg", brush="liner-1")
    assert [notice.code for notice in done.notices] == ["width-out-of-reach"]
