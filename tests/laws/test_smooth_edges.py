"""With few poses, the painted edge is as smooth as with many.

It has no corner that the mark of the dense plan lacks. The edges are both ends of the widest section along the
simulated path, and the test measures them by plain geometry.
"""

import itertools
from pathlib import Path

import numpy as np
import pytest
import shapely
from sampling import sample
from scipy.spatial import cKDTree

core = pytest.importorskip("brushsvg._core")
brushsvg = pytest.importorskip("brushsvg")

ROUND = brushsvg.find_brush("round-6")
SHEET_MM = (400.0, 400.0)
CORNER_RAD = np.radians(8)
WINDOW_MM, STEP_MM = 0.25, 0.05  # a corner is a turn within two windows
SAME_MM = 0.6  # corners of both marks within this distance count as one
SHOWS_MM = 0.05  # distance from the outline of the mark; an inner edge that turns back is covered by paint
VINCENT = Path(__file__).parents[2] / "examples" / "vincent.svg"


def round_about(centre, radius, first, last, pieces=8):
    angle = np.linspace(first, last, pieces + 1)
    reach = 4 / 3 * np.tan((last - first) / pieces / 4)
    at = np.column_stack([np.cos(angle), np.sin(angle)])
    along = reach * np.column_stack([-np.sin(angle), np.cos(angle)])
    unit = np.hstack([at[:-1], at[:-1] + along[:-1], at[1:] - along[1:], at[1:]])
    return radius * unit + np.tile(centre, 4)


def an_s(name, half_width):
    bows = [round_about((50, 60), 10, 0.5, 1.5 * np.pi), round_about((50, 40), 10, 0.5 * np.pi, -2.6)]
    return core.Stroke(name, np.vstack(bows), half_width=half_width)


DRAWN = {
    "circle of 12 mm": [core.Stroke("o", round_about((50, 50), 6, 0, 2 * np.pi), half_width=[(0.0, 1.5)])],
    "circle of 60 mm": [core.Stroke("O", round_about((90, 90), 30, 0, 2 * np.pi), half_width=[(0.0, 2.5)])],
    "S": [an_s("s", [(0.0, 1.5)])],
    "S that swells": [an_s("s", [(0.0, 0.6), (0.5, 2.5), (1.0, 0.4)])],
    "vincent": list(brushsvg.strokes(brushsvg.read_drawing(VINCENT))[0]),
}


def plan_of(strokes, tolerance_mm, **how):
    return core.compensate(strokes, ROUND, SHEET_MM, "closed", tolerance_mm, **how).plan


def simulated(plan):
    marks = core.simulate(plan, ROUND, 1e-4)
    core.trace_outlines(marks, ROUND)
    return marks.passes


def edges(marks):
    """Return the paths of both ends of the widest section while the brush is taut."""
    taut = np.flatnonzero(marks.taut)
    if not len(taut):
        return []
    rows = slice(taut[0], taut[-1] + 1)
    middle, heading = core.widest_points(marks, ROUND)[rows], np.asarray(marks.heading_rad)[rows]
    half = np.array([ROUND.half_width(depth) for depth in np.asarray(marks.depth_mm)[rows]])
    across = half[:, None] * np.column_stack([-np.sin(heading), np.cos(heading)])
    return [middle + across, middle - across]


def turning(edge):
    """Return places along an edge, and the turn at each."""
    line = shapely.LineString(edge)
    at = np.arange(WINDOW_MM, line.length - WINDOW_MM, STEP_MM)
    before, here, after = (
        shapely.get_coordinates(shapely.line_interpolate_point(line, at + d)) for d in (-WINDOW_MM, 0, WINDOW_MM)
    )
    (x, y), (u, v) = (here - before).T, (after - here).T
    return here, np.arctan2(x * v - y * u, x * u + y * v)


def corners_beyond(few, dense):
    """Return corners of a visible edge at least 8 degrees sharper than the other mark's."""
    shape = shapely.union_all([shapely.Polygon(ring).buffer(0) for ring in few.outline_mm])
    count = 0
    for ours, theirs in zip(edges(few), edges(dense), strict=True):
        (here, turn), (there, known) = turning(ours), turning(theirs)
        if not len(here) or not len(there):
            continue
        near = cKDTree(there).query_ball_point(here, SAME_MM)
        most = np.array([max(known[k], default=0.0) for k in near])
        least = np.array([min(known[k], default=0.0) for k in near])
        sharp = np.maximum(turn - most, least - turn) > CORNER_RAD
        seen = shapely.distance(shape.boundary, shapely.points(here)) < SHOWS_MM
        places = np.flatnonzero(sharp & seen)
        count += int((np.diff(places, prepend=-100) > 8).sum())
    return count


@sample("name", DRAWN, keep=2)
def test_the_painted_edge_has_only_corners_of_the_dense_plan(name):
    few, dense = plan_of(DRAWN[name], 0.05), plan_of(DRAWN[name], 0.005, few_poses=False)
    pairs = zip(simulated(few), simulated(dense), strict=True)
    assert [corners_beyond(*pair) for pair in pairs] == [0] * len(DRAWN[name])


@pytest.mark.parametrize("name", DRAWN)
def test_a_coarser_tolerance_needs_no_more_poses(name):
    counts = [
        [len(each.poses_mm) for each in plan_of(DRAWN[name], tolerance).passes]
        for tolerance in (0.05, 0.1, 0.2, 0.5, 1.0)
    ]
    assert all(np.all(np.array(b) <= a) for a, b in itertools.pairwise(counts)), counts


def test_bends_at_one_depth_are_arcs():
    (circle,) = plan_of(DRAWN["circle of 12 mm"], 0.05).passes
    on_arcs = sum(arc.last - arc.first for arc in circle.arcs)
    assert on_arcs >= 0.5 * len(circle.poses_mm)
