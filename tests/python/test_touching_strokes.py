"""Refined strokes that touch are kept only if they improve the letter."""

import numpy as np
import shapely

from brushsvg import Pass, Stroke, _core, compensate, find_brush
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.planning.touching_strokes import find_worse_strokes

SHORT_BAR = '<path d="M10 12H34V28H10Z"/>'


def test_refined_passes_do_not_lower_the_overlap_of_a_filled_shape(tmp_path):
    drawing = tmp_path / "bar.svg"
    drawing.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="50mm" height="40mm" viewBox="0 0 50 40">{SHORT_BAR}</svg>'
    )
    overlaps = {}
    for compensation in ("closed", "refined"):
        work = prepare(drawing, Options(compensation=compensation, wide="passes"))
        marks = _core.simulate(work.plan, work.brush)
        overlaps[compensation] = _core.common_area(marks.passes, work.strokes, work.brush).overlap
    assert overlaps["refined"] >= overlaps["closed"]  # refined one by one, the passes left 0.03 of the shape unpainted


def turned_deg(rings) -> float:
    lines = [np.array(shapely.LinearRing(ring).simplify(0.1).coords)[:-1] for ring in rings]
    ways = [np.roll(line, -1, axis=0) - line for line in lines]
    angles = [np.arctan2(way[:, 1], way[:, 0]) for way in ways]
    turns = [np.angle(np.exp(1j * (np.roll(each, -1) - each))) for each in angles]
    return float(np.degrees(sum(np.abs(each).sum() for each in turns)))


def test_only_the_stroke_that_adds_turning_counts_as_worse():
    """A stroke that makes its letter restless is worse, and its neighbour is not.

    Two bars touch. One is refined to cover a little more; the other waves and also covers more.
    """
    brush = find_brush("round-6")
    bars = [
        Stroke("stem", np.linspace((30, 20), (30, 70), 4).reshape(1, 8), half_width=[(0, 2.5), (1, 2.5)]),
        Stroke("bar", np.linspace((30, 45), (80, 45), 4).reshape(1, 8), half_width=[(0, 2.5), (1, 2.5)]),
    ]
    closed = compensate(bars, brush, (100, 90), start="auto", end="auto").plan.passes
    calm = list(closed)
    waving = Pass("bar", waved(closed[1].poses_mm), closed[1].speed_mm_s)
    # The target is wider than the mark in closed form, so a wave covers more of the target.
    wider = [bars[0], bars[1].replaced(half_width=[(0, 3.4), (1, 3.4)])]
    group = [[0, 1]]
    overlaps, marks = [], []
    for passes in (calm, [closed[0], waving]):
        painted = _core.simulate(_core.Plan(passes=passes), brush)
        _core.trace_outlines(painted, brush)
        overlaps.append(_core.common_area(painted.passes, wider, brush).overlap)
        marks.append(painted.outline_mm)
    assert overlaps[1] > overlaps[0]  # by overlap alone, the wave would be kept
    assert turned_deg(marks[1]) > turned_deg(marks[0]) + 270
    assert find_worse_strokes([closed[0], waving], closed, wider, brush, group) == [1]
    assert find_worse_strokes(calm, closed, wider, brush, group) == []


def waved(poses_mm: np.ndarray) -> np.ndarray:
    """Return poses that wave by 3 mm to either side, pressed deeper.

    There are five waves between landing and lift-off. The lag makes the waves in the mark smaller.
    """
    inside = np.linspace(poses_mm[2], poses_mm[-3], 60)
    inside[:, 1] += 3.0 * np.sin(np.linspace(0, 10 * np.pi, 60))
    inside[:, 2] -= 2.0
    return np.vstack([poses_mm[:2], inside, poses_mm[-2:]])
