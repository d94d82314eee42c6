"""The overlap of the report agrees with a computation without _core.

It uses only the files of plan and brush, slow stepping and shapely.
"""

import itertools
import json
from pathlib import Path

import numpy as np
import oracle
import pytest
import shapely

core = pytest.importorskip("brushsvg._core")

EXAMPLES = Path(__file__).parents[2] / "examples"
# A lift starts where the patch is about to slip. With twice this step it slips, which changes the overlap of a dot by
# 0.006.
STEP_MM = 0.04
PARTS = 6  # smallest number of steps of a move, so that one step does not release the patch at a turn
OUTLINE_EVERY = 6  # hulls of neighbours 0.24 mm apart miss 1e-3 mm on the tightest bends


def law_of(value):
    return oracle.Law(value["coefficients"], value.get("floor", -np.inf), value.get("floor_slope", 0.0))


def stepped(plan, brush):
    """Return the shapely region that each pass of a plan.json paints with a brush.json."""
    law, gap = law_of(brush["lag"]), law_of(brush["tip_gap"])
    tables = [
        [(shape["depth_mm"], np.array(shape["outline_mm"])) for shape in brush["footprints"].get(kind, [])]
        for kind in ("dragged", "pressed")
    ]
    passes = [oracle.subdivide(each["poses_mm"], PARTS, STEP_MM) for each in plan["passes"]]
    longest = max(map(len, passes))
    padded = np.stack([np.vstack([p, np.repeat(p[-1:], longest - len(p), axis=0)]) for p in passes])
    contacts = oracle.step_all(padded, [law] * len(passes), 2)
    regions = []
    for poses, contact in zip(passes, contacts, strict=True):
        lever = poses[:, :2] - contact[: len(poses)]
        reach = np.hypot(*lever.T)
        heading = np.arctan2(lever[:, 1], lever[:, 0])
        known = np.flatnonzero(reach > 1e-9)
        if len(known):  # otherwise the brush is pressed straight down, and the heading is 0
            heading = heading[known[np.clip(np.searchsorted(known, np.arange(len(poses))), 0, len(known) - 1)]]
        outlines = []
        for k in sorted({*range(0, len(poses), OUTLINE_EVERY), len(poses) - 1}):
            depth = -poses[k, 2]
            pull = min(1.0, reach[k] / law(depth)) if law(depth) > 0 else 1.0
            shape = oracle.footprint_at(*tables, depth, pull)
            outlines.append(oracle.placed(shape, contact[k], heading[k], gap(depth)))
        regions.append(oracle.swept(outlines, convex=True))
    return regions


def target_region(stroke):
    """Return the union of the discs along the middle line, from hulls of neighbours."""
    if stroke.target_mm:
        return shapely.union_all([shapely.make_valid(shapely.Polygon(ring)) for ring in stroke.target_mm])
    t = np.linspace(0, 1, 81)
    points = np.vstack([oracle.bezier(cubic, t) for cubic in stroke.middle_mm])
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    at, half = np.array(stroke.half_width).T
    radii = np.interp(along / max(along[-1], 1e-9), at, half)
    discs = shapely.buffer(shapely.points(points), radii, quad_segs=32)
    pairs = [shapely.union(a, b) for a, b in itertools.pairwise(discs)]
    return shapely.union_all(shapely.convex_hull(pairs))


def overlap(a, b):
    return shapely.intersection(a, b).area / shapely.union(a, b).area


def check_figures(strokes, compensation, brush_name="round-6"):
    from brushsvg import _core, find_brush
    from brushsvg.show.evaluation import figures

    brush = find_brush(brush_name)
    done = _core.compensate(strokes, brush, (300.0, 300.0), compensation)
    marks = _core.simulate(done.plan, brush)
    rows, total = figures.measure_figures(figures.PaintedPlan(done.plan, marks, brush, strokes))
    groups = figures.group_touching_strokes(marks, brush, strokes)

    plan = json.loads(_core.write_plan(done.plan))
    for each, a_pass in zip(plan["passes"], done.plan.passes, strict=True):
        each["poses_mm"] = oracle.chords(a_pass.poses_mm, a_pass.arcs, 0.1)
    painted = stepped(plan, json.loads(_core.write_brush(brush)))
    target = [target_region(stroke) for stroke in strokes]
    for row, mark, expected in zip(rows, painted, target, strict=True):
        assert row.overlap == pytest.approx(overlap(mark, expected), abs=0.005), row.stroke
    assert total.overlap == pytest.approx(overlap(shapely.union_all(painted), shapely.union_all(target)), abs=0.005)
    number = {stroke.id: k for k, stroke in enumerate(strokes)}
    for group in groups:
        members = [number[name] for name in group.strokes]
        found = [shapely.union_all([regions[k] for k in members]) for regions in (painted, target)]
        assert group.overlap == pytest.approx(overlap(*found), abs=0.005), group.strokes
    return groups


@pytest.mark.thorough
def test_overlap_of_the_demo_drawing_agrees_with_the_report():
    import brushsvg

    strokes, _ = brushsvg.strokes(brushsvg.read_drawing(EXAMPLES / "vincent.svg"))
    assert check_figures(strokes, "closed")


def random_stroke(rng, name):
    """Return a chain of cubics, smooth or with corners, with a changing width."""
    count = int(rng.integers(1, 4))
    points, heading, cubics = rng.uniform(60, 240, 2), rng.uniform(-np.pi, np.pi), []
    for _ in range(count):
        heading += rng.choice([0.0, rng.uniform(-1.2, 1.2)])
        turn, length = rng.uniform(-1.0, 1.0), rng.uniform(8, 30)
        last = points + length * oracle.unit(heading + turn)
        cubics.append(
            [
                points,
                points + length / 3 * oracle.unit(heading),
                last - length / 3 * oracle.unit(heading + 2 * turn),
                last,
            ]
        )
        points, heading = last, heading + 2 * turn
    half = rng.uniform(0.4, 4.0, 2)
    return core.Stroke(name, np.reshape(cubics, (-1, 8)), half_width=[(0.0, float(half[0])), (1.0, float(half[1]))])


@pytest.mark.parametrize(("seed", "compensation"), [(0, "closed"), (1, "none"), (2, "closed")])
def test_overlap_of_random_strokes_agrees_with_the_report(seed, compensation):
    rng = np.random.default_rng(seed)
    check_figures([random_stroke(rng, f"s{k}") for k in range(3)], compensation)
