"""Outline rings and coverage agree with a dense shapely union of footprints.

Rows keep their tolerance.
"""

import functools
import itertools

import numpy as np
import oracle
import pytest
import shapely
from made_up_brushes import LAGS, law, make_brush, make_plan, random_poses, section_6_footprints
from sampling import sample

core = pytest.importorskip("brushsvg._core")

LEAST = 2.0  # the crescent is measured from here on; below it is scaled


def crescent(depth, slim=1.0):
    """Return a footprint that is concave in front.

    It has two horns at the widest section. The hollow between them is half as deep as the patch.
    """
    long, half = 0.75 * depth, 0.42 * depth * slim
    t = np.linspace(0, 1, 8)
    outer = np.stack([long * t**2, -half * np.sin(np.pi / 2 * t)], axis=1)
    s = np.linspace(-1, 1, 9)[1:-1]
    inner = np.stack([0.5 * long * (1 + s**2), half * s], axis=1)
    return np.concatenate([outer, inner, (outer * [1, -1])[:0:-1]])


def few_vertices():
    """Return every third vertex of the round brush, with tip and both flanks.

    The outline is still convex, and quicker to unite.
    """
    return [(d, np.vstack([o[:1], o[1::3]])) for d, o in section_6_footprints()]


def round_footprints():
    """Return the round brush pressed straight down.

    It is rounder and shorter than the dragged footprint, with as many vertices.
    """
    return [(d, o * [0.7, 1.1]) for d, o in few_vertices()]


BRUSHES = {
    "round": (few_vertices(), []),
    "round, pressed apart": (few_vertices(), round_footprints()),
    "crescent": ([(d, crescent(d)) for d in (LEAST, 5.0, 10.0)], []),
    "crescent, pressed apart": (
        [(d, crescent(d)) for d in (LEAST, 5.0, 10.0)],
        [(d, crescent(d, 0.6)) for d in (LEAST, 4.0, 8.0)],
    ),
}

PASSES = {
    "straight": [[0, 0, 0], [6, 0, -4], [30, 0, -4], [34, 0, 0]],
    "press in place": [[0, 0, 0], [0, 0, -5], [25, 0, -2], [25, 0, -7], [25, 0, 0]],
    "corner": [[0, 0, 0], [4, 0, -3], [20, 0, -5], [20, 22, -2.5], [20, 22, 0]],
    "reversal": [[0, 0, 0], [5, 0, -4], [20, 0, -4], [4, 0.4, -4], [-8, 1, -3], [-8, 1, 0]],
    "straight back": [[0, 0, 0], [5, 0, -4], [20, 0, -4], [-12, 0, -4], [-12, 0, 0]],
    "circle": [*([14 * np.cos(a), 14 * np.sin(a), -3] for a in np.linspace(0, 7.2, 120)), [8, 11, 0]],
    "small circle": [*([4 * np.cos(a), 4 * np.sin(a), -6] for a in np.linspace(0, 4.0, 50)), [4, 4, 0]],
    "two dabs": [[0, 0, 0], [1, 0, -3], [1, 0, 2], [12, 1, 2], [12.5, 2, -4], [12, 4, 0]],
    "straight down": [[3, 4, 0], [3, 4, -6], [3, 4, 0]],
    "crossing": [
        [0, 0, 0],
        [4, 0, -4],
        [30, 0, -4],
        [30, 0, 2],
        [15, 14, 2],
        [15, 10, -3],
        [14, -18, -5],
        [14, -20, 0],
    ],
}


CASES = [
    *((name, "round") for name in PASSES),
    *((name, "round, pressed apart") for name in ("press in place", "corner", "reversal", "two dabs", "crossing")),
    *((name, "crescent") for name in ("straight", "press in place", "corner", "reversal", "circle", "two dabs")),
    *((name, "crescent, pressed apart") for name in ("press in place", "straight back", "two dabs")),
]


def brush_of(shape, lag="round"):
    dragged, pressed = BRUSHES[shape]
    return make_brush(LAGS[lag], footprints=dragged, pressed=pressed)


@functools.cache
def target_mark(name, shape):
    return dense_union(PASSES[name], shape)


def dense_union(poses, shape, lag="round", close_mm=2e-4):
    """Return the painted region of the event-driven reference.

    Outlines are sampled closely: half way between two of them, every vertex is within `close_mm` of the line
    between, and no vertex moves far. If the TCP passes exactly over the patch, the heading jumps and nothing
    is swept.
    """
    dragged, pressed = BRUSHES[shape]
    # poses that do not begin and end at z = 0 are set down and lifted on the spot
    poses = np.array(poses, float)
    poses = np.vstack([poses[:1] * [1, 1, 0], poses, poses[-1:] * [1, 1, 0]])
    reference = oracle.Reference(poses, law(lag))
    moves = np.arange(len(poses))
    known = [h for h in (reference.at(p)[1] for p in np.linspace(0, moves[-1], 2000)) if not np.isnan(h)]
    first = known[0] if known else 0.0

    def outline(pose):
        depth = -np.interp(pose, moves, poses[:, 2])
        contact, heading, _, pull = reference.at(pose)
        if np.isnan(contact[0]) or depth < 0:
            return None
        shape_there = oracle.footprint_at(dragged, pressed, depth, 0.0 if np.isnan(pull) else pull)
        return oracle.placed(shape_there, contact, first if np.isnan(heading) else heading, 0.52 * depth)

    pieces, convex = [], not shape.startswith("crescent")

    def sample(p0, p1, a, b):
        """Return all outlines after a up to b, and None where there is a break."""
        middle = 0.5 * (p0 + p1)
        between = outline(middle)
        if a is None or b is None or between is None:
            return [None, b] if (a is None and b is None) or p1 - p0 < 1e-9 else halves(p0, middle, p1, a, between, b)
        if np.max(np.abs(between - 0.5 * (a + b))) < close_mm and np.max(np.abs(a - b)) < 1e3 * close_mm:
            return [between, b]
        return [None, b] if p1 - p0 < 1e-9 else halves(p0, middle, p1, a, between, b)

    def halves(p0, middle, p1, a, between, b):
        return sample(p0, middle, a, between) + sample(middle, p1, between, b)

    start = np.unique(np.concatenate([np.linspace(0, moves[-1], 8 * moves[-1] + 1), reference.events()]))
    run, last = [outline(start[0])], outline(start[0])
    for p0, p1 in itertools.pairwise(start):
        following = outline(p1)
        run += sample(p0, p1, last, following)
        last = following
    for present, group in itertools.groupby(run, key=lambda o: o is not None):
        if present:
            group = list(group)
            swept = oracle.swept(group, convex, oracle.united) if len(group) > 1 else oracle.union_of(group)
            pieces.append(swept)
    return shapely.union_all(pieces)


def region_of(rings):
    """Return the shapely region of rings of marks.json, and their signed areas."""
    signed = [0.5 * np.sum(r[:, 0] * np.roll(r[:, 1], -1) - r[:, 1] * np.roll(r[:, 0], -1)) for r in rings]
    outer = shapely.union_all([shapely.Polygon(r) for r, a in zip(rings, signed, strict=True) if a > 0])
    holes = shapely.union_all([shapely.Polygon(r) for r, a in zip(rings, signed, strict=True) if a < 0])
    return outer - holes, np.array(signed)


def marks_of(poses, brush, tolerance_mm=0.02):
    marks = core.simulate(make_plan(np.array(poses, float)), brush, tolerance_mm, may_rise=True)
    core.trace_outlines(marks, brush)
    return marks


@sample(("name", "shape"), CASES, keep=6)
def test_the_outline_area_agrees_with_a_dense_union(name, shape):
    target = target_mark(name, shape)
    marks = marks_of(PASSES[name], brush_of(shape), 5e-4)
    rings = marks.passes[0].outline_mm
    region, signed = region_of(rings)
    assert all(len(r) >= 3 and not np.array_equal(r[0], r[-1]) for r in rings)
    assert all(shapely.Polygon(r).is_simple for r in rings)
    # holes are inside, and outer rings do not overlap
    assert signed.sum() == pytest.approx(region.area, rel=1e-9)
    assert core.area(rings) == pytest.approx(signed.sum(), rel=1e-9)
    assert signed.sum() == pytest.approx(target.area, rel=2e-4)
    assert region.symmetric_difference(target).area < 4e-4 * target.area + 1e-3 * target.length
    assert (signed < -1e-3).sum() == sum(shapely.Polygon(h).area > 1e-3 for h in holes_of(target))


def holes_of(region):
    return [h for part in shapely.get_parts(region) for h in part.interiors]


def test_the_outline_is_exact_at_the_default_tolerance():
    """At the default tolerance, no edge of the outline is more than 0.02 mm off.

    Chords of rows are up to 0.02 mm off the curve.
    """
    for name, shape in CASES:
        target = target_mark(name, shape)
        region, _ = region_of(marks_of(PASSES[name], brush_of(shape)).outline_mm)
        assert region.difference(target.buffer(0.021)).area < 1e-6, (name, shape)
        assert target.difference(region.buffer(0.021)).area < 1e-6, (name, shape)


def test_the_outline_area_of_random_passes_agrees_with_a_dense_union():
    rng = np.random.default_rng(4)
    for shape in ("round", "crescent"):
        poses = random_poses(rng, 6)
        marks = marks_of(poses, brush_of(shape), 5e-4)
        assert core.area(marks.outline_mm) == pytest.approx(dense_union(poses, shape).area, rel=2e-4)


@sample(
    ("name", "shape"),
    [c for c in CASES if c[0] in ("straight", "corner", "circle", "two dabs", "crossing")],
    keep=4,
)
def test_coverage_agrees_with_rings_and_union(name, shape):
    brush, target = brush_of(shape), target_mark(name, shape)
    marks = marks_of(PASSES[name], brush, 2e-4)
    left, bottom, right, top = core.painted_bounds(marks.passes[0], brush)
    assert (left, bottom, right, top) == pytest.approx(target.bounds, abs=0.01)
    # small marks need small pixels, since an edge is as wide as a pixel
    px = 40.0 if name == "two dabs" else 20.0
    size = np.ceil((np.array([right - left, top - bottom]) + 1) * px) / px
    window = (left - 0.5, bottom - 0.5, *size)
    image = core.coverage(marks, brush, window, px)
    assert image.dtype == np.float32
    assert image.shape == (round(size[1] * px), round(size[0] * px))
    assert image.min() >= 0
    assert image.max() <= 1
    assert image.sum(dtype=float) / px**2 == pytest.approx(target.area, rel=2e-4)
    rings = core.coverage(marks.outline_mm, window, px)
    assert rings.sum(dtype=float) / px**2 == pytest.approx(core.area(marks.outline_mm), rel=2e-4)
    assert np.abs(image - rings).mean() * image.size / max(1.0, target.length * px) < 0.05

    rng = np.random.default_rng(1)
    edge = np.argwhere((image > 0) & (image < 1))
    picked = np.concatenate([edge[rng.permutation(len(edge))[:300]], rng.integers(0, image.shape, (200, 2))])
    x, y = window[0] + picked[:, 1] / px, window[1] + size[1] - (picked[:, 0] + 1) / px  # row 0 is the top
    shapely.prepare(target)
    exact = shapely.area(shapely.intersection(shapely.box(x, y, x + 1 / px, y + 1 / px), target)) * px**2
    found = image[picked[:, 0], picked[:, 1]]
    assert np.abs(found - exact).mean() < 0.05
    assert np.abs(found - exact).max() < 0.35
    assert abs(np.mean(found - exact)) < 0.02  # neither widened nor narrowed


def test_coverage_of_a_window_equals_that_part_of_the_whole():
    brush = brush_of("round")
    marks = marks_of(PASSES["corner"], brush)
    whole = core.coverage(marks, brush, (-2.0, -6.0, 30.0, 36.0), 10.0)
    part = core.coverage(marks, brush, (12.0, -3.0, 9.0, 12.0), 10.0)
    assert part == pytest.approx(whole[210:330, 140:230], abs=1e-3)
    assert core.coverage(marks, brush, (500.0, 500.0, 5.0, 5.0), 10.0).max() == 0


def test_the_mark_of_two_passes_is_their_union():
    """The mark of two crossing passes is their union.

    Each pass keeps its own outline.
    """
    brush = brush_of("round")
    plan = make_plan(
        np.array([[0, 0, 0], [4, 0, -4], [30, 0, -4], [30, 0, 0.0]]),
        np.array([[15, 15, 0], [15, 11, -4], [15, -15, -4], [15, -15, 0.0]]),
    )
    marks = core.simulate(plan, brush, 0.005)
    core.trace_outlines(marks, brush)
    regions = [region_of(p.outline_mm)[0] for p in marks.passes]
    assert core.area(marks.outline_mm) == pytest.approx(shapely.union_all(regions).area, rel=1e-4)
    assert core.area(marks.outline_mm) < sum(r.area for r in regions) - 5
    both = core.overlap(marks.passes[0].outline_mm, marks.passes[1].outline_mm)
    exact = regions[0].intersection(regions[1]).area / shapely.union_all(regions).area
    assert both == pytest.approx(exact, rel=1e-4)


def test_rows_are_parallel_and_span_the_poses():
    rng = np.random.default_rng(6)
    brush = brush_of("round")
    for lifts in (False, True):
        poses = random_poses(rng, 8, lifts=lifts)
        rows = marks_of(poses, brush).passes[0]
        count = len(rows.pose)
        for column in (rows.tcp_mm, rows.contact_mm, rows.heading_rad, rows.depth_mm, rows.taut, rows.pull):
            assert len(column) == count
        assert rows.pose[0] == 0
        assert rows.pose[-1] == len(poses) - 1
        assert np.all(np.diff(rows.pose) >= 0)
        assert set(range(len(poses))) <= set(rows.pose)
        moving = [np.interp(rows.pose, np.arange(len(poses)), poses[:, k]) for k in range(3)]
        assert rows.tcp_mm == pytest.approx(np.column_stack(moving[:2]), abs=1e-9)
        down = moving[2] <= 0
        assert rows.depth_mm[down] == pytest.approx(-moving[2][down], abs=1e-9)
        assert np.all(rows.depth_mm[moving[2] > 1e-9] < 0)
        assert np.all((rows.pull >= 0) & (rows.pull <= 1 + 1e-12))
        assert np.all(np.isfinite(rows.contact_mm))
        assert np.all(np.isfinite(rows.heading_rad))


@pytest.mark.parametrize("shape", BRUSHES)
def test_footprints_are_blended_between_depths(shape):
    dragged, pressed = BRUSHES[shape]
    table = brush_of(shape).footprints
    for depth in (0.0, 0.4, 1.0, 1.99, 2.0, 3.7, 5.0, 8.5, 10.0, 12.0):
        for pull in (0.0, 0.3, 1.0):
            target = oracle.footprint_at(dragged, pressed, depth, pull)
            assert core.footprint_at(table, depth, pull) == pytest.approx(target, abs=1e-12)


def test_a_pass_at_depth_zero_paints_nothing():
    brush = brush_of("round")
    marks = marks_of([[0, 0, 0], [0, 0, 0], [0, 0, 0]], brush)
    assert core.area(marks.outline_mm) == 0
    assert core.coverage(marks, brush, (-5.0, -5.0, 10.0, 10.0), 10.0).max() == 0
