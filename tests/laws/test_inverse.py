"""Compensated strokes paint their middle lines.

The tests simulate each compensated stroke finely. The widest point must run along the middle line, and P must
come back.
"""

import itertools
import multiprocessing

import numpy as np
import oracle
import pytest
import shapely
from made_up_brushes import LAGS, WIDEST, make_brush, make_plan
from sampling import sample
from scipy.integrate import solve_ivp
from shapely import affinity

core = pytest.importorskip("brushsvg._core")
Error = pytest.importorskip("brushsvg").Error
find_brush = pytest.importorskip("brushsvg.model.library").find_brush
with_chords = pytest.importorskip("brushsvg.machine.realised.arc_chords").with_chords

ROUND = find_brush("round-6")
LAG = oracle.Law(*LAGS["round"])


def lever(depth):
    """Return e = x_w - b of the article's brush."""
    return WIDEST(depth) - 0.52 * depth


def line(*points):
    """Return straight cubics through points."""
    p = np.array(points, float)
    return np.array([np.concatenate([a, a + (b - a) / 3, a + 2 * (b - a) / 3, b]) for a, b in itertools.pairwise(p)])


def corner(degrees, arm=30.0):
    turn = np.radians(degrees)
    return line((0, 0), (arm, 0), (arm + arm * np.cos(turn), arm * np.sin(turn)))


def arc(radius, sweep, start=(0.0, 0.0), pieces_per_turn=48):
    """Return cubics along a circle from `start`, heading along +x and turning left.

    They deviate from the circle by 1e-10 of the radius.
    """
    count = max(1, int(np.ceil(sweep / (2 * np.pi) * pieces_per_turn)))
    knots = np.linspace(-np.pi / 2, -np.pi / 2 + sweep, count + 1)
    k = 4 / 3 * np.tan(sweep / count / 4)
    centre = np.add(start, [0, radius])
    out = []
    for a, b in itertools.pairwise(knots):
        ends, along = (
            centre + radius * oracle.unit(np.array([a, b])),
            radius * k * oracle.unit(np.array([a, b]) + np.pi / 2),
        )
        out.append(np.concatenate([ends[0], ends[0] + along[0], ends[1] - along[1], ends[1]]))
    return np.array(out)


def smooth(rng, pieces, turn=1.2):
    """Return cubics that join without a corner."""
    xy, heading, out = np.zeros(2), rng.uniform(-np.pi, np.pi), []
    for _ in range(pieces):
        length, turned = rng.uniform(8, 18), heading + rng.uniform(-turn, turn)
        end = xy + length * oracle.unit(0.5 * (heading + turned))
        third = length / 3
        out.append(np.concatenate([xy, xy + third * oracle.unit(heading), end - third * oracle.unit(turned), end]))
        xy, heading = end, turned
    return np.array(out)


def zigzag(rng, corners):
    xy, heading, points = np.zeros(2), rng.uniform(-np.pi, np.pi), [np.zeros(2)]
    for _ in range(corners + 1):
        xy = xy + rng.uniform(6, 20) * oracle.unit(heading)
        points.append(xy)
        heading += rng.choice([-1, 1]) * rng.uniform(0.1, np.pi / 2)
    return line(*points)


def widths(rng, length, least=0.125):
    """Return half widths that change by at most 0.13 mm per mm.

    Half of the strokes taper to 0.25 mm.
    """
    count = int(length // 9) + 1
    step = 0.13 * length / count
    h = [rng.uniform(0.3, 2.5)]
    for _ in range(count):
        h.append(np.clip(h[-1] + rng.uniform(-1, 1) * step, least, 3))
    if rng.random() < 0.5:
        thin = rng.integers(0, count + 1)
        h = np.minimum(h, least + step * np.abs(np.arange(count + 1) - thin))
    return [(i / count, float(x)) for i, x in enumerate(h)]


def stroke_of(middle, half_width, closed=False):
    return core.Stroke(id="s", middle_mm=middle, half_width=half_width, closed=closed)


def as_far_as_a_round_cap(stroke):
    """Return the middle line, longer by half a width.

    A footprint with a blunt front has to go beyond the drawn end.
    """
    cubics = np.asarray(stroke.middle_mm)
    end = cubics[-1, 6:]
    behind = next((p for p in cubics[::-1].reshape(-1, 4, 2)[:, ::-1].reshape(-1, 2) if (p != end).any()), end)
    way = stroke.half_width[-1][1] * (end - behind) / max(np.hypot(*(end - behind)), 1e-12)
    return np.vstack([cubics, np.concatenate([end + k / 3 * way for k in range(4)])[None]])


class Painted:
    """The true way of the widest point of a compensated stroke.

    The simulation cuts every move into parts.
    """

    def __init__(self, stroke, tolerance_mm, brush=ROUND, parts=6, step=0.25, **options):
        found = core.compensate([stroke], brush, (200.0, 200.0), tolerance_mm=tolerance_mm, **options)
        (planned,) = found.plan.passes
        self.tracking_error, self.warnings = found.tracking_errors[0], found.warnings
        self.poses = oracle.chords(planned.poses_mm, planned.arcs)
        plan = make_plan(oracle.subdivide(self.poses, parts, step))
        self.rows = core.simulate(plan, brush, max(tolerance_mm, 2e-3)).passes[0]
        depth = self.rows.depth_mm
        self.widest = self.rows.contact_mm + lever(depth)[:, None] * oracle.unit(self.rows.heading_rad)
        self.middle = oracle.Middle(stroke.middle_mm)
        self.distance, self.s = oracle.Middle(as_far_as_a_round_cap(stroke)).nearest(self.widest)
        self.taut = np.flatnonzero(self.rows.taut & (depth >= 0))

    def once_taut(self):
        """Return distances from the first taut row to the last, with rows between."""
        return self.distance[self.taut[0] : self.taut[-1] + 1]


def assert_follows(painted, tolerance_mm):
    assert painted.distance[painted.taut].max() <= tolerance_mm
    assert painted.tracking_error.largest_mm <= tolerance_mm
    assert painted.tracking_error.within_tolerance
    measured = painted.distance[painted.taut].max()
    assert (
        painted.tracking_error.largest_mm
        >= (0.85 if measured > 0.4 * tolerance_mm else 0.5) * measured - 1e-3 * tolerance_mm
    )
    assert painted.tracking_error.mean_mm <= painted.tracking_error.largest_mm
    forward = np.maximum.accumulate(painted.s[painted.taut]) - painted.s[painted.taut]
    assert forward.max() <= max(tolerance_mm, 1e-6)  # the point runs in the drawn direction
    poses = painted.poses
    assert poses[0, 2] == 0
    assert poses[-1, 2] == 0
    assert poses[:, 2].min() >= -10
    assert poses[:, 2].max() <= 0
    assert np.all(np.isfinite(poses))


# The widest point ---------------------------------------------------------------------------------


@sample("tolerance", [0.5, 0.05, 1e-3], keep=1)
def test_smooth_strokes_with_tapers_stay_within_the_tolerance(tolerance):
    rng = np.random.default_rng(21)
    for _ in range(80 if tolerance > 1e-3 else 20):
        middle = smooth(rng, rng.integers(2, 5))
        stroke = stroke_of(middle, widths(rng, oracle.Middle(middle).length))
        assert_follows(Painted(stroke, tolerance), tolerance)


@pytest.mark.parametrize("tolerance", [0.5, 0.05, 1e-3])
def test_turns_up_to_90_degrees_stay_within_the_tolerance(tolerance):
    rng = np.random.default_rng(22)
    for _ in range(20):
        middle = zigzag(rng, rng.integers(1, 4))
        stroke = stroke_of(middle, [(0.0, rng.uniform(0.7, 2.5)), (1.0, rng.uniform(0.7, 2.5))])
        assert_follows(Painted(stroke, tolerance), tolerance)


@pytest.mark.parametrize(
    ("middle", "half_width"),
    [
        (smooth(np.random.default_rng(1), 3), [(0.0, 0.25)]),
        (smooth(np.random.default_rng(2), 3), [(0.0, 2.0), (0.5, 0.125), (1.0, 2.0)]),
        (smooth(np.random.default_rng(3), 3), [(0.0, 0.125), (0.5, 2.0), (1.0, 0.125)]),
        (corner(90), [(0.0, 1.68)]),
        (corner(90), [(0.0, 0.25)]),
        (corner(60), [(0.0, 0.5)]),
        (zigzag(np.random.default_rng(4), 3), [(0.0, 1.0), (1.0, 1.9)]),
        (arc(9.0, 5.0), [(0.0, 0.4), (1.0, 1.6)]),
    ],
    ids=[
        "0.5 mm line",
        "taper 4 0.25 4",
        "taper 0.25 4 0.25",
        "corner",
        "corner 0.5 mm",
        "60 degrees",
        "zigzag",
        "arc",
    ],
)
@sample("tolerance", [0.5, 0.05, 1e-3, 1e-5], keep=1)
def test_widest_point_stays_within_the_tolerance(middle, half_width, tolerance):
    painted = Painted(stroke_of(middle, half_width), tolerance, parts=6 if tolerance > 1e-4 else 3)
    assert_follows(painted, tolerance)
    covered = np.unique(np.round(painted.s[painted.taut], 1))
    assert len(covered) > 0.85 * painted.middle.length / 0.1 * min(1.0, 0.1 / 0.25)


@pytest.mark.parametrize("half_width", [0.25, 1.0, 1.68, 2.5])
def test_the_brush_is_taut_from_the_landing_to_the_end(half_width):
    """The brush is taut from the landing to the end of a stroke.

    If the brush hung loose most of the way, the tolerance would mean little.
    """
    painted = Painted(stroke_of(smooth(np.random.default_rng(6), 4), [(0.0, half_width)]), 1e-3, step=0.01)
    s = np.sort(painted.s[painted.taut])
    depth = half_width / 0.42
    assert s[0] <= max(0.0, WIDEST(depth) - half_width) + 0.01
    assert s[-1] >= painted.middle.length - 0.01
    assert np.diff(s).max() < 0.3


@pytest.mark.parametrize("name", LAGS)
def test_compensation_works_for_any_lag_law(name):
    rng, brush = np.random.default_rng(23), make_brush(LAGS[name])
    for _ in range(4):
        middle = smooth(rng, 3)
        stroke = stroke_of(middle, [(0.0, rng.uniform(0.6, 2)), (1.0, rng.uniform(0.6, 2))])
        painted = Painted(stroke, 1e-3, brush)
        if name != "small near 0":
            assert_follows(painted, 1e-3)
            continue
        # With r = 0.8 d the brush is between taut and loose during landing and lift, so only the stroke
        # itself counts.
        drawn = np.interp(painted.s / painted.middle.length, *zip(*stroke.half_width, strict=True)) / 0.42
        proper = painted.taut[np.abs(painted.rows.depth_mm - drawn)[painted.taut] < 1e-3]
        assert len(proper) > 100
        assert painted.distance[proper].max() <= 1e-3


def _compensated_in_a_process(half_width, results):
    painted = Painted(stroke_of(line((0, 0), (30, 0)), half_width), 0.05)
    results.put((np.isfinite(painted.poses).all(), painted.tracking_error.largest_mm, painted.once_taut().max()))


@pytest.mark.parametrize("thick", [2.0, 2.5, 3.0])
def test_compensation_of_a_taper_too_steep_for_the_lever_terminates(thick):
    """Compensation of a taper from 0.25 mm to 5 mm within 7.5 mm terminates.

    In this taper, the lever e grows faster than the widest point advances.
    """
    for half_width in (
        [(0.0, 0.125), (0.25, thick), (1.0, thick)],
        [(0.0, thick), (0.25, 0.125), (0.5, thick), (1.0, thick)],
    ):
        results = multiprocessing.get_context("fork").Queue()
        worker = multiprocessing.get_context("fork").Process(
            target=_compensated_in_a_process, args=(half_width, results), daemon=True
        )
        worker.start()
        worker.join(10)
        if worker.is_alive():
            worker.terminate()
            pytest.fail("compensate does not come to an end")
        finite, reported, measured = results.get(timeout=1)
        assert finite
        assert reported == pytest.approx(measured, abs=0.01)


@pytest.mark.parametrize(("degrees", "remains"), [(100, 0.02), (120, 0.19), (150, 0.69), (180, 1.38)])
@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
def test_sharper_turns_report_what_remains(degrees, remains, tolerance):
    painted = Painted(stroke_of(corner(degrees), [(0.0, 1.68)]), tolerance, step=0.04, few_poses=False)
    measured = painted.once_taut().max()
    assert painted.tracking_error.largest_mm == pytest.approx(measured, rel=0.02, abs=0.05 * tolerance)
    assert painted.tracking_error.largest_mm == pytest.approx(remains, abs=0.01)
    assert painted.tracking_error.has_turn_in_place
    assert painted.tracking_error.within_tolerance == (measured <= tolerance)


# P ------------------------------------------------------------------------------------------------


def contact_behind(parts, depth_at, s, points):
    """Return P after m has run s along parts to `points`.

    A part is (length, curvature, corner before it). m drags P on the lever e > 0, starting along the middle
    line.
    """
    heading, psi, begin, found = 0.0, 0.0, 0.0, np.full((len(s), 2), np.nan)
    for length, curvature, corner_before in parts:
        heading, psi = heading + corner_before, psi - corner_before

        def rate(x, y, k=curvature):
            return -np.sin(y) / lever(depth_at(x)) - k

        path = solve_ivp(
            rate,
            (begin, begin + length),
            [psi],
            method="DOP853",
            rtol=1e-11,
            atol=1e-12,
            dense_output=True,
            max_step=0.5,
        )
        rows = (s >= begin) & (s <= begin + length)
        theta = heading + curvature * (s[rows] - begin) + path.sol(s[rows])[0]
        found[rows] = points[rows] - lever(depth_at(s[rows]))[:, None] * oracle.unit(theta)
        heading, psi, begin = heading + curvature * length, path.y[0, -1], begin + length
    return found


BENDS = {
    "arc": (np.vstack([line((-20, 0), (0, 0)), arc(12.0, np.pi)]), [(20, 0, 0), (12 * np.pi, 1 / 12, 0)]),
    "corner": (corner(60), [(30, 0, 0), (30, 0, np.pi / 3)]),
    "line": (line((3, 3), (43, 3)), [(40, 0, 0)]),
}


@pytest.mark.parametrize("wide", [(1.68, 1.68), (1.0, 2.0)])
@pytest.mark.parametrize("bend", BENDS)
def test_the_contact_follows_its_predicted_path_on_bends(bend, wide):
    middle_mm, parts = BENDS[bend]
    painted = Painted(stroke_of(middle_mm, [(0.0, wide[0]), (1.0, wide[1])]), 1e-6, parts=2, step=1.0, few_poses=False)
    length = sum(p[0] for p in parts)

    def depth_at(s):
        return (wide[0] + (wide[1] - wide[0]) * np.asarray(s) / length) / 0.42

    rows = painted.taut[(painted.s[painted.taut] > 5) & (painted.s[painted.taut] < length - 1e-3)]
    target = contact_behind(parts, depth_at, painted.s[rows], painted.widest[rows])
    assert len(rows) > 10
    assert painted.rows.contact_mm[rows] == pytest.approx(target, abs=1e-6)


@sample("half_width", [0.25, 0.4, 1.0, 2.0], keep=2)
def test_contact_settles_on_its_own_circle(half_width):
    """With m on a circle of radius R and the lever e, P runs at sqrt(R^2 - e^2).

    P is ahead of m if e is negative.
    """
    radius, depth = 12.0, half_width / 0.42
    painted = Painted(stroke_of(arc(radius, 4.0), [(0.0, half_width)]), 1e-6, parts=2, step=1.0)
    e = float(lever(depth))
    far = 20 * abs(e)  # the effect of the start (for e < 0, of the end) decays as exp(-s/|e|)
    s = painted.s[painted.taut]
    length = painted.middle.length
    rows = painted.taut[(s > far) & (s < length - 0.1)] if e > 0 else painted.taut[(s > 1) & (s < length - far)]
    away = painted.rows.contact_mm[rows] - [0, radius]
    assert len(rows) > 100
    assert np.hypot(*away.T) == pytest.approx(np.sqrt(radius**2 - e**2), abs=1e-6)
    behind = np.angle((painted.widest[rows] - [0, radius]) @ [1, 1j] / (away @ [1, 1j]))
    assert behind == pytest.approx(np.arcsin(e / radius), abs=1e-6)
    assert painted.rows.depth_mm[rows] == pytest.approx(depth, abs=1e-9)


def test_tcp_is_a_lag_ahead_along_the_heading():
    """Where the brush is taut, q = P + r T holds at the poses."""
    painted = Painted(stroke_of(smooth(np.random.default_rng(8), 3), [(0.0, 0.8), (1.0, 2.0)]), 1e-3, parts=1)
    rows, k = painted.rows, painted.taut
    ahead = LAG(rows.depth_mm[k])[:, None] * oracle.unit(rows.heading_rad[k])
    assert rows.tcp_mm[k] == pytest.approx(rows.contact_mm[k] + ahead, abs=1e-9)
    step = np.diff(rows.contact_mm[k], axis=0)
    moved = np.hypot(*step.T) > 1e-3
    along = np.angle((step @ [1, 1j]) / np.exp(0.5j * (rows.heading_rad[k][1:] + rows.heading_rad[k][:-1])))
    assert np.abs(along[moved]).max() < 0.02


# Ends ---------------------------------------------------------------------------------------------


def reach(painted, point, direction, rows):
    """Return how far the footprints of some rows reach beyond a point [mm]."""
    marks, farthest = painted.rows, -np.inf
    for k in rows:
        if marks.depth_mm[k] > 0:
            outline = core.footprint_at(ROUND.footprints, marks.depth_mm[k], marks.pull[k])
            outline = oracle.placed(outline, marks.contact_mm[k], marks.heading_rad[k], 0.52 * marks.depth_mm[k])
            farthest = max(farthest, ((outline - point) @ direction).max())
    return farthest


@pytest.mark.parametrize("half_width", [0.25, 0.5, 1.0, 1.68, 2.5, 4.0])
@sample("seed", [11, 12], keep=1)
def test_the_mark_has_no_tail_and_no_paint_before_its_start(half_width, seed):
    """A mark has no tail after the lift and no paint before the requested start.

    The patch rests while the brush is lifted.
    """
    painted = Painted(stroke_of(smooth(np.random.default_rng(seed), 3), [(0.0, half_width)]), 1e-3, parts=12, step=0.5)
    (start, end), (first, last) = painted.middle.at([0, painted.middle.length])
    near = np.array_split(np.arange(len(painted.rows.pose)), 2)
    halves = [rows[np.hypot(*(painted.widest[rows] - p).T) < 12] for rows, p in zip(near, (start, end), strict=True)]
    beyond = 2e-3 if half_width < 3 else 0.01  # a corner of a blunt front sticks out where the line bends
    depth = half_width / 0.42
    assert half_width - 0.06 <= reach(painted, end, last, halves[1]) <= half_width + beyond
    least = min(half_width, WIDEST(depth)) - 0.06
    assert least <= reach(painted, start, -first, halves[0]) <= half_width + 2e-3
    lifting = np.flatnonzero(painted.rows.depth_mm < 0.999 * depth)
    lifting = lifting[lifting > len(painted.rows.pose) // 2]
    held = painted.rows.contact_mm[lifting[0]]
    assert np.hypot(*(painted.rows.contact_mm[lifting] - held).T).max() < 1e-6
    landing = painted.rows.contact_mm[: painted.taut[0]]
    assert np.hypot(*(landing - landing[0]).T).max() < 1e-6


def test_a_plain_lift_would_leave_a_tail():
    """The measure of the test above finds the tail of an uncompensated stroke."""
    painted = Painted(stroke_of(line((0, 0), (40, 0)), [(0.0, 1.68)]), 1e-3, method="none", parts=12, step=0.5)
    contact = painted.rows.contact_mm
    lifting = painted.rows.pose >= painted.rows.pose[-1] - 12
    assert contact[-1, 0] - contact[lifting][0, 0] == pytest.approx(LAG(4.0) - LAG(0.0), abs=1e-8)


def test_a_dab_has_its_widest_section_where_it_was_drawn():
    stroke = stroke_of(np.array([[3.0, 4.0] * 4]), [(0.0, 1.0)])
    painted = Painted(stroke, 0.05)
    deepest = np.argmax(painted.rows.depth_mm)
    assert painted.rows.depth_mm[deepest] == pytest.approx(1 / 0.42, abs=1e-9)
    assert painted.widest[deepest] == pytest.approx([3, 4], abs=0.05)
    assert reach(painted, np.array([3.0, 4.0]), np.array([0.0, 1.0]), range(len(painted.rows.pose))) <= 1.0 + 1e-6


# None, constant, and what is refused --------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [0.5, 0.05, 1e-3])
def test_compensation_none_keeps_the_tcp_on_the_middle_line(tolerance):
    middle = np.vstack([smooth(np.random.default_rng(5), 3)])
    found = core.compensate([stroke_of(middle, [(0.0, 0.8), (1.0, 2.0)])], ROUND, (99.0, 99.0), "none", tolerance)
    poses, on = found.plan.passes[0].poses_mm, oracle.Middle(middle)
    assert poses[[0, -1], 2] == pytest.approx(0, abs=0)
    assert poses[[0, 1], :2] == pytest.approx(np.tile(middle[0, :2], (2, 1)), abs=1e-9)
    assert poses[[-2, -1], :2] == pytest.approx(np.tile(middle[-1, 6:], (2, 1)), abs=1e-9)
    distance, s = on.nearest(poses[1:-1, :2])
    assert distance.max() < 1e-9
    assert -poses[1:-1, 2] == pytest.approx((0.8 + 1.2 * s / on.length) / 0.42, abs=1e-6)
    assert np.all(np.diff(s) > 0)
    between = oracle.subdivide(poses[1:-1], 8)
    distance, s = on.nearest(between[:, :2])
    assert distance.max() <= tolerance
    assert -between[:, 2] == pytest.approx((0.8 + 1.2 * s / on.length) / 0.42, abs=max(tolerance, 1e-6))


@pytest.mark.parametrize("lag", [None, 5.0])
@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
def test_compensation_constant_runs_a_constant_lag_ahead(lag, tolerance):
    middle = line((0, 0), (20, 0), (20, 18))
    curve = smooth(np.random.default_rng(5), 3)
    for cubics, has_corner in ((middle, True), (curve, False)):
        stroke = stroke_of(cubics, [(0.0, 0.8), (0.6, 1.2), (1.0, 2.0)])
        found = core.compensate([stroke], ROUND, (99.0, 99.0), "constant", tolerance, lag)
        poses, on = found.plan.passes[0].poses_mm, oracle.Middle(cubics)
        grid = (np.arange(200001) + 0.5) / 200001
        r0 = lag or float(LAG(np.median(np.interp(grid, [0, 0.6, 1], [0.8, 1.2, 2.0]) / 0.42)))
        (start, end), (first, last) = on.at([0, on.length])
        assert poses[0] == pytest.approx([*start, 0], abs=1e-9)
        assert poses[1] == pytest.approx([*(start + r0 * first), -0.8 / 0.42], abs=2e-3)
        assert poses[-2] == pytest.approx([*(end + r0 * last), -2 / 0.42], abs=2e-3)
        assert poses[-1] == pytest.approx([*poses[-2, :2], 0], abs=0)
        s = np.linspace(0, on.length, 40001)
        points, tangents = on.at(s)
        target = points + r0 * tangents
        if has_corner:
            turn = np.linspace(0, np.pi / 2, 4001)
            target = np.vstack([target, [20, 0] + r0 * oracle.unit(turn)])
        near, _ = oracle.cKDTree(target).query(oracle.subdivide(poses[1:-1], 4)[:, :2])
        # 2e-3 is for the spacing of the samples and the rounding of the median
        assert near.max() <= tolerance + 2e-3
        far, _ = oracle.cKDTree(oracle.subdivide(poses[1:-1], 1, 1e-2)[:, :2]).query(target[::20])
        assert far.max() <= tolerance + 8e-3


def test_rigid_pen_follows_the_line():
    rigid = find_brush("rigid")
    middle = smooth(np.random.default_rng(7), 3)
    for method in ("none", "closed"):
        stroke = stroke_of(middle, [(0.0, rigid.half_width_range_mm()[1])])
        found = core.compensate([stroke], rigid, (99.0, 99.0), method, 1e-3)
        rows = core.simulate(found.plan, rigid).passes[0]
        distance, _ = oracle.Middle(middle).nearest(rows.contact_mm)
        assert distance.max() <= 1e-3


def test_widths_out_of_reach_are_refused_with_the_range():
    for half_width, code in ((4.3, "width-out-of-reach"), (-1.0, "out-of-range"), (np.nan, "out-of-range")):
        with pytest.raises(Error) as refusal:
            core.compensate([stroke_of(line((0, 0), (40, 0)), [(0.0, half_width)])], ROUND, (99.0, 99.0))
        assert (refusal.value.code, refusal.value.where) == (code, "s")
    with pytest.raises(ValueError, match=r"8\.4") as refusal:
        core.compensate([stroke_of(line((0, 0), (40, 0)), [(0.0, 1.0), (1.0, 4.5)])], ROUND, (99.0, 99.0))
    assert refusal.value.range is not None


def test_strokes_keep_their_order_and_names():
    strokes = [core.Stroke(id=f"n{k}", middle_mm=line((k, 0), (k + 20, 5)), half_width=[(0.0, 1.0)]) for k in range(5)]
    found = core.compensate(strokes, ROUND, (99.0, 99.0))
    assert [p.stroke for p in found.plan.passes] == [f"n{k}" for k in range(5)]
    assert len(found.tracking_errors) == 5
    assert all(p.speed_mm_s <= 25 for p in found.plan.passes)


def test_compensation_turns_with_the_sheet():
    """A turned stroke gives the turned plan.

    This stroke has two equally good plans, of 12 and of 13 poses. The last bits of its coordinates decide
    between them.
    """
    middle, plans = smooth(np.random.default_rng(9), 3), {}
    for angle in 0.37 * np.arange(16):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        turned = (middle.reshape(-1, 2) @ turn + [50, 20]).reshape(-1, 8)
        poses = np.array(Painted(stroke_of(turned, [(0.0, 1.0), (1.0, 1.8)]), 0.05).poses)
        poses[:, :2] = (poses[:, :2] - [50, 20]) @ turn.T
        assert poses == pytest.approx(plans.setdefault(len(poses), poses), abs=1e-6)
    assert len(plans) <= 2


# Beginnings ---------------------------------------------------------------------------------------


def every(poses, step):
    """Return fractional poses of a pass, with every pose among them.

    They are at most `step` [mm] apart.
    """
    counts = np.maximum(1, np.ceil(np.linalg.norm(np.diff(poses, axis=0), axis=1) / step)).astype(int)
    return np.append(np.concatenate([k + np.arange(n) / n for k, n in enumerate(counts)]), len(poses) - 1.0)


def painted_region(poses, step=0.25, from_x=-np.inf):
    """Return the mark by the slow reference.

    Footprints are placed at its events and between them, and swept. from_x is the least x of P. Steps of 0.25
    mm miss less than a ten thousandth of the area of a dot, and 0.02 mm at an edge.
    """
    reference = oracle.Reference(poses, LAG)
    dragged = [(d, np.asarray(each.outline_mm)) for d, each in zip(range(1, 11), ROUND.footprints.dragged, strict=True)]
    outlines = []
    heading = None
    for pose in np.unique(np.concatenate([every(poses, step), reference.events()])):
        contact, now, _, pull = reference.at(pose)
        heading = now if np.isfinite(now) else heading
        depth = float(np.interp(pose, np.arange(len(poses)), -poses[:, 2]))
        if heading is None or depth <= 0.0 or not np.isfinite(contact).all() or contact[0] < from_x:
            continue
        shape = oracle.footprint_at(dragged, [], depth, pull)
        outlines.append(oracle.placed(shape, contact, heading, 0.52 * depth))
    return oracle.swept(outlines, True, oracle.united)


def beginning(middle, half_width, start):
    """Compare the beginning of a mark with its target.

    Return the overlap within two half widths of the path's first point, and the largest distance of paint
    beyond the target mark there.
    """
    import shapely

    found = core.compensate([stroke_of(middle, [(0.0, half_width)])], ROUND, (200.0, 200.0), start=start)
    assert found.tracking_errors[0].within_tolerance
    poses = np.asarray(found.plan.passes[0].poses_mm)
    assert poses[0, 2] == poses[-1, 2] == 0.0
    assert (poses[1:-1, 2] < 0.0).all()  # one touch
    points = np.vstack([oracle.bezier(cubic, np.linspace(0, 1, 40)) for cubic in middle])
    target = shapely.LineString(points).buffer(half_width, quad_segs=64)
    near = shapely.Point(points[0]).buffer(2 * half_width)
    mark = painted_region(poses)
    here, expected = mark & near, target & near
    beyond = shapely.hausdorff_distance(here | expected, expected)
    return (here & expected).area / (here | expected).area, beyond


@pytest.mark.parametrize("half_width", [0.8, 1.4, 2.0])
@pytest.mark.parametrize("middle", [line((20, 20), (60, 20)), arc(25.0, 1.2), arc(12.0, 1.5)])
def test_a_round_start_is_round_and_stays_inside_the_stroke(middle, half_width):
    pointed, _ = beginning(middle, half_width, "pointed")
    rounded, beyond = beginning(middle, half_width, "round")
    assert pointed < 0.85
    assert rounded > 0.93
    assert beyond < 0.05 + 0.1 * half_width


@sample("half_width", [3.0, 3.5, 3.7, 4.2], keep=2)
def test_a_round_start_covers_the_rear_of_a_wide_footprint(half_width):
    middle = line((20, 20), (60, 20))
    pointed, _ = beginning(middle, half_width, "pointed")
    rounded, _ = beginning(middle, half_width, "round")
    assert pointed < 0.8
    assert rounded > 0.88  # the front of the footprint is blunt
    reaches = painted_region(poses_of(middle, [(0.0, half_width)], start="round")).bounds[0]
    assert reaches > 20.0 - half_width - 0.1  # a constant width would leave a thorn of 1.9 mm


def poses_of(middle, half_width, **options):
    found = core.compensate([stroke_of(middle, half_width)], ROUND, (200.0, 200.0), **options)
    return np.asarray(found.plan.passes[0].poses_mm)


@pytest.mark.parametrize(
    ("middle", "half_width"),
    [
        (line((20, 20), (60, 20)), [(0.0, 0.4)]),  # the widest section trails
        (line((20, 20), (60, 20)), [(0.0, 0.15), (0.5, 2.0), (1.0, 2.0)]),  # a taper
    ],
)
def test_a_start_that_cannot_be_round_is_pointed(middle, half_width):
    pointed = poses_of(middle, half_width)
    for start in ("round", "auto"):
        np.testing.assert_array_equal(poses_of(middle, half_width, start=start), pointed)


@sample(
    ("middle", "half_width", "least"),
    [
        (arc(6.0, 1.2), [(0.0, 3.0), (0.5, 2.0), (1.0, 0.5)], 0.96),  # a comma
        (arc(14.0, 1.0), [(0.0, 3.5), (0.2, 2.8), (0.5, 1.2), (1.0, 1.2)], 0.96),  # the ball of an f
        (line((20, 20), (22, 20), (22, 50)), [(0.0, 3.0)], 0.94),  # the tip would stick out beyond the corner
    ],
    keep=1,
)
def test_a_start_without_space_for_the_way_back_turns_first(middle, half_width, least):
    import shapely

    stroke = stroke_of(middle, half_width)
    found = core.compensate([stroke], ROUND, (200.0, 200.0), start="round")
    assert found.tracking_errors[0].within_tolerance
    turned = np.asarray(found.plan.passes[0].poses_mm)
    assert turned[0, 2] == turned[-1, 2] == 0.0
    assert (turned[1:-1, 2] < 0.0).all()  # one touch
    np.testing.assert_array_equal(poses_of(middle, half_width, start="auto"), turned)
    target = shapely.union_all([shapely.Polygon(ring) for ring in core.target_outline(stroke, 0.01)])
    near = shapely.Point(middle[0, :2]).buffer(2 * half_width[0][1])

    def overlap(poses):
        mark = painted_region(poses)
        return (mark & target & near).area / ((mark | target) & near).area

    assert overlap(turned) > least > overlap(poses_of(middle, half_width)) + 0.04


@sample(
    ("half_width", "length", "least"),
    [(1.5, 0.0, 0.99), (4.0, 0.0, 0.99), (2.0, 0.5, 0.99), (4.0, 0.9, 0.98), (1.5, 1.35, 0.955)],
    keep=2,
)
def test_a_dot_is_round(half_width, length, least):
    import shapely

    points = np.array([(50.0, 50.0), (50.0 + 0.6 * length * half_width, 50.0 + 0.8 * length * half_width)])
    target = (shapely.LineString(points) if length else shapely.Point(points[0])).buffer(half_width, 64)

    def overlap(poses):
        mark = painted_region(poses)
        return (mark & target).area / (mark | target).area

    stroke = stroke_of(line(*points), [(0.0, half_width)])
    found = core.compensate([stroke], ROUND, (200.0, 200.0), start="round")
    assert found.tracking_errors[0].within_tolerance
    rounded = np.asarray(found.plan.passes[0].poses_mm)
    assert rounded[0, 2] == rounded[-1, 2] == 0.0
    assert (rounded[1:-1, 2] < 0.0).all()  # one touch
    assert overlap(poses_of(line(*points), [(0.0, half_width)])) < 0.9
    assert overlap(rounded) > least
    np.testing.assert_array_equal(poses_of(line(*points), [(0.0, half_width)], start="auto"), rounded)


@sample(
    ("sides", "turned_rad", "least"),
    [((8.0, 8.0), 0.0, 0.965), ((8.4, 6.0), 0.0, 0.975), ((5.0, 4.0), 0.7, 0.955), ((3.0, 3.0), 0.3, 0.92)],
    keep=2,
)
def test_a_dot_with_corners_is_square(sides, turned_rad, least):
    import shapely

    length, width = max(sides), min(sides)
    along = np.array([np.cos(turned_rad), np.sin(turned_rad)])
    middle = np.array([50.0, 50.0])
    off = (length - width) / 2 * along
    box = shapely.box(-length / 2, -width / 2, length / 2, width / 2)
    target = shapely.affinity.translate(shapely.affinity.rotate(box, turned_rad, (0, 0), use_radians=True), *middle)
    stroke = stroke_of(line(middle - off, middle + off), [(0.0, width / 2)])
    stroke.target_mm = [np.asarray(target.exterior.coords)[:-1]]

    def overlap(start):
        found = core.compensate([stroke], ROUND, (200.0, 200.0), start=start)
        assert found.tracking_errors[0].within_tolerance
        poses = np.asarray(found.plan.passes[0].poses_mm)
        assert poses[0, 2] == poses[-1, 2] == 0.0
        assert (poses[1:-1, 2] < 0.0).all()  # one touch
        mark = painted_region(poses)
        return (mark & target).area / (mark | target).area, len(poses)

    (butt, count), (requested, _), (rounded, before) = map(overlap, ("auto", "butt", "round"))
    assert butt == requested > least > rounded + 0.1
    assert count < before + 75


@sample(
    ("corners", "rounded_mm", "least"),
    [
        ([(0, -4), (4.2, 0), (0, 4), (-4.2, 0)], 0.5, 0.955),
        ([(-1.2, -4), (4.4, -0.6), (1.2, 4), (-4.4, 0.6)], 0.4, 0.95),
        ([(0, -4), (3.5, -2), (3.5, 2.5), (-3, 3.2), (-3.5, -2)], 0.3, 0.96),
    ],
    ids=["diamond", "askew", "of five corners"],
    keep=1,
)
def test_dots_keep_other_corners(corners, rounded_mm, least):
    """Dots with other corners keep them, as in Arabic letters.

    None of these dots fills 0.92 of a rectangle, so they were once painted as discs.
    """
    import shapely

    drawn = shapely.Polygon(np.add(corners, 50.0)).buffer(-rounded_mm).buffer(rounded_mm)
    disc = shapely.maximum_inscribed_circle(drawn, 0.001)
    stroke = stroke_of(line(disc.coords[0], disc.coords[0]), [(0.0, disc.length)])
    stroke.target_mm = [np.asarray(shapely.geometry.polygon.orient(drawn).exterior.coords)[:-1]]

    def overlap(start):
        found = core.compensate([stroke], ROUND, (200.0, 200.0), start=start)
        assert found.tracking_errors[0].within_tolerance
        mark = painted_region(found.plan.passes[0].poses_mm)
        return (mark & drawn).area / (mark | drawn).area

    assert overlap("auto") > least > overlap("round") + 0.1


@sample(("radius_mm", "least"), [(5.2, 0.97), (6.4, 0.97), (6.8, None), (8.0, None)], keep=2)
def test_a_disc_wider_than_the_brush_gets_a_ring_if_no_gap_remains(radius_mm, least):
    import shapely

    drawn = shapely.Point(50, 50).buffer(radius_mm, 64)
    stroke = stroke_of(line((50, 50), (50, 50)), [(0.0, 4.2)])
    stroke.target_mm = [np.asarray(shapely.geometry.polygon.orient(drawn).exterior.coords)[:-1]]
    automatic, rounded = (
        core.compensate([stroke], ROUND, (200.0, 200.0), start=start).plan.passes[0].poses_mm
        for start in ("auto", "round")
    )
    if least is None:
        np.testing.assert_array_equal(automatic, rounded)
    else:
        mark = painted_region(automatic)
        assert (mark & drawn).area / (mark | drawn).area > least


@pytest.mark.parametrize("corners", [8, 90])
def test_a_dot_without_corners_stays_round(corners):
    angles = np.arange(corners) * 2 * np.pi / corners
    stroke = stroke_of(line((50, 50), (50, 50)), [(0.0, 3.0)])
    stroke.target_mm = [np.column_stack([50 + 3 * np.cos(angles), 50 + 3 * np.sin(angles)])]
    plans = [core.compensate([stroke], ROUND, (200.0, 200.0), start=start).plan for start in ("auto", "round")]
    np.testing.assert_array_equal(*(plan.passes[0].poses_mm for plan in plans))


@pytest.mark.parametrize(
    ("cubic", "half_width"),
    [
        ([45, 53, 53, 53, 60, 49, 69, 39], 3.5),
        ([63, 39, 54, 44, 51, 53, 50, 64], 3.9),
        ([58, 49, 48, 50, 38, 45, 30, 41], 3.3),
        ([67, 59, 73, 54, 74, 45, 73, 34], 3.2),
    ],
)
def test_wide_lines_start_round_for_any_bend(cubic, half_width):
    """A wide line begins round, however it bends.

    Lines without space for this once began pointed, with an overlap of 0.94.
    """
    stroke = stroke_of(np.array([cubic], float), [(0.0, half_width)])
    drawn = shapely.union_all([shapely.Polygon(ring) for ring in core.target_outline(stroke, 0.02)])

    def overlap(start):
        done = core.compensate([stroke], ROUND, (200.0, 200.0), start=start)
        assert done.tracking_errors[0].within_tolerance
        marks = core.simulate(done.plan, ROUND)
        core.trace_outlines(marks, ROUND)
        mark = shapely.union_all([shapely.Polygon(ring).buffer(0) for ring in marks.passes[0].outline_mm])
        return mark.intersection(drawn).area / mark.union(drawn).area

    assert overlap("pointed") < 0.945
    assert overlap("auto") > 0.985


@pytest.mark.parametrize("half_width", [1.0, 2.0, 3.0, 3.9, 4.1])
def test_bars_of_all_widths_start_alike(half_width):
    """Bars of all widths begin alike.

    Wide bars once began pointed next to round ones, which gave every stem of a sans a roof.
    """
    bar = line((60, 90), (60, 40))
    rounded = poses_of(bar, [(0.0, half_width)], start="round")
    np.testing.assert_array_equal(poses_of(bar, [(0.0, half_width)], start="auto"), rounded)


def test_auto_chooses_a_suitable_start_and_a_stroke_can_override_it():
    bar = line((20, 20), (60, 20))
    pointed, rounded = poses_of(bar, [(0.0, 2.0)]), poses_of(bar, [(0.0, 2.0)], start="round")
    assert len(rounded) > len(pointed)
    np.testing.assert_array_equal(poses_of(bar, [(0.0, 2.0)], start="auto"), rounded)
    # This beginning is drawn like the footprint's tail, pointed by 3.8 mm, so there is nothing to hide.
    points = [[18, 20], [21.8, 18], [60, 18], [60, 22], [21.8, 22]]
    sharp = stroke_of(bar, [(0.0, 2.0)])
    sharp.target_mm = [np.array(points, float)]
    plan = core.compensate([sharp], ROUND, (99.0, 99.0), start="auto").plan
    np.testing.assert_array_equal(plan.passes[0].poses_mm, pointed)
    with_setting = core.Stroke(id="s", middle_mm=bar, half_width=[(0.0, 2.0)], settings=core.Settings(start="round"))
    plan = core.compensate([with_setting], ROUND, (99.0, 99.0), start="pointed").plan
    np.testing.assert_array_equal(plan.passes[0].poses_mm, rounded)
    wrong = core.Stroke(id="s", middle_mm=bar, half_width=[(0.0, 2.0)], settings=core.Settings(start="soft"))
    with pytest.raises(Error) as refused:
        core.compensate([wrong], ROUND, (99.0, 99.0))
    assert (refused.value.where, refused.value.code) == ("s", "choice-unknown")


@pytest.mark.parametrize("half_width", [1.0, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("middle", [line((20, 20), (60, 20)), line((20, 20), (50, 20))])
def test_a_pointed_end_is_a_mirrored_pointed_start(middle, half_width):
    mark = painted_region(poses_of(middle, [(0.0, half_width)], start="pointed", end="pointed"))
    _, low, right, high = mark.bounds
    assert right == pytest.approx(middle[0, 6] + half_width, abs=0.05), "it ends where the drawing ends"
    mirrored = affinity.scale(mark, -1, 1, origin=(middle[0, [0, 6]].mean(), 20))
    assert mirrored.symmetric_difference(mark).area < 0.9 * half_width**2, "3 to 4 of a round end"
    assert high - low == pytest.approx(2 * half_width, abs=0.02)


# Ends, and beginnings that are cut ----------------------------------------------------------------


def cut_bar(half_width, slope):
    """Return a bar whose end is cut half a width beyond the end of its path.

    slope moves the cut further back on the left.
    """
    x, displaced = 40 + half_width, slope * half_width
    low, high = 20 - half_width, 20 + half_width
    return [(20.0, low), (x + displaced, low), (x - displaced, high), (20.0, high)]


def end_of_bar(half_width, slope, **options):
    """Compare the end of a mark with its bar.

    Return the overlap, the largest distance of paint beyond the bar there, and the poses.
    """
    import shapely

    stroke = stroke_of(line((20, 20), (40, 20)), [(0.0, half_width)])
    stroke.target_mm = [np.array(cut_bar(half_width, slope))]
    found = core.compensate([stroke], ROUND, (200.0, 200.0), **options)
    poses = np.asarray(found.plan.passes[0].poses_mm)
    assert found.tracking_errors[0].within_tolerance
    assert core.tracking_error_of(found.plan.passes[0], stroke, ROUND).largest_mm == found.tracking_errors[0].largest_mm
    assert poses[0, 2] == poses[-1, 2] == 0.0
    assert (poses[1:-1, 2] < 0.0).all()  # one touch
    target = shapely.Polygon(cut_bar(half_width, slope))
    near = shapely.box(40 - half_width, 0, 100, 40)
    here, expected = painted_region(poses, from_x=40 - 3 * half_width) & near, target & near
    beyond = shapely.hausdorff_distance(here | expected, expected)
    return (here & expected).area / (here | expected).area, beyond, poses


@sample(("half_width", "slope"), [(1.5, 0.0), (2.0, -0.6), (2.0, 1.0), (3.0, 0.3)], keep=2)
def test_a_butt_end_follows_its_cut(half_width, slope):
    rounded, _, _ = end_of_bar(half_width, slope)
    butt, beyond, there = end_of_bar(half_width, slope, end="butt")
    assert rounded < 0.9 - 0.05 * abs(slope)
    assert butt > 0.94
    assert beyond < 0.05 + 0.1 * half_width
    np.testing.assert_array_equal(end_of_bar(half_width, slope, end="auto")[2], there)


def mirrored(outline):
    return [(60.0 - x, y) for x, y in outline]


def begun_bar(half_width, slope):
    """Return a bar that begins with a cut at 20 mm and runs to the right."""
    start, *_, end = mirrored(cut_bar(half_width, slope))
    return [(80.0, start[1]), *mirrored(cut_bar(half_width, slope))[1:3], (80.0, end[1])]


def plan_of_bar(half_width, slope, **options):
    """Return a bar with a cut beginning, and its plan.

    The plan has one touch and is no deeper than its line requires.
    """
    stroke = stroke_of(line((20, 20), (80, 20)), [(0.0, half_width)])
    stroke.target_mm = [np.array(begun_bar(half_width, slope))]
    found = core.compensate([stroke], ROUND, (200.0, 200.0), **options)
    poses = np.asarray(found.plan.passes[0].poses_mm)
    assert found.tracking_errors[0].within_tolerance
    assert core.tracking_error_of(found.plan.passes[0], stroke, ROUND).largest_mm == found.tracking_errors[0].largest_mm
    assert poses[0, 2] == poses[-1, 2] == 0.0
    assert (poses[1:-1, 2] < 0.0).all()
    assert -poses[:, 2].min() < ROUND.depth_for_half_width(half_width) + 1e-9
    return poses


def beginning_of_bar(half_width, slope, poses):
    """Compare the beginning of a mark with its bar.

    The beginning ends where the stroke has its full width. Return the overlap there, and the largest distance
    of paint beyond the bar.
    """
    import shapely

    target = shapely.Polygon(begun_bar(half_width, slope))
    near = shapely.box(0, 0, 20 + 3 * half_width, 40)
    here, expected = painted_region(poses) & near, target & near
    beyond = shapely.hausdorff_distance(here | expected, expected)
    return (here & expected).area / (here | expected).area, beyond


@sample(
    ("half_width", "slope"),
    [(1.5, 0.0), (2.0, -0.6), (2.0, 1.0), (3.0, 0.3), (4.2, 0.0)],
    keep=2,
)
def test_a_butt_start_follows_its_cut(half_width, slope):
    plans = {start: plan_of_bar(half_width, slope, start=start) for start in ("round", "butt", "auto")}
    rounded, _ = beginning_of_bar(half_width, slope, plans["round"])
    butt, beyond = beginning_of_bar(half_width, slope, plans["butt"])
    assert rounded < 0.97 - 0.05 * abs(slope)
    assert butt > 0.975 - 0.015 * abs(slope)
    assert beyond < 0.05 + 0.1 * half_width
    np.testing.assert_array_equal(plans["auto"], plans["butt"])


def test_a_stroke_can_have_butt_ends_on_both_sides():
    import shapely

    middle = np.array([(20.0, 20.0, 35.0, 20.0, 45.0, 20.0, 60.0, 28.0)])
    points = oracle.bezier(middle[0], np.linspace(0, 1, 200))
    flat = shapely.LineString(points).buffer(2.0, cap_style="square")
    stroke = stroke_of(middle, [(0.0, 2.0)])
    stroke.target_mm = [np.array(flat.exterior.coords)[:-1]]
    plain = core.compensate([stroke], ROUND, (200.0, 200.0), start="round", end="round")
    found = core.compensate([stroke], ROUND, (200.0, 200.0), start="auto", end="auto")
    assert found.tracking_errors[0].within_tolerance

    def overlap(plan):
        mark = painted_region(with_chords(plan.passes[0]).poses_mm)
        return (mark & flat).area / (mark | flat).area

    assert overlap(plain.plan) < 0.975
    assert overlap(found.plan) > 0.985


ROUND_CAP = [
    (20, 18),
    *((60 + 2 * np.sin(t), 20 - 2 * np.cos(t)) for t in np.linspace(0, np.pi, 40)),
    (20, 22),
]


@pytest.mark.parametrize(
    ("half_width", "target"),
    [
        (2.0, ROUND_CAP),
        (
            0.5,
            [(20, 19.5), (60.5, 19.5), (60.5, 20.5), (20, 20.5)],
        ),  # finer than a path can follow into a corner
        (2.0, [(20, 18), (58, 18), (62, 20), (58, 22), (20, 22)]),  # pointed
        (2.0, [(20, 18), (62, 18), (60, 20), (62, 22), (20, 22)]),  # a swallow's tail
        (2.0, [(20, 18), (70, 18), (70, 22), (20, 22)]),  # goes on in another stroke
    ],
)
def test_an_outline_without_a_cut_at_its_end_ends_round(half_width, target):
    stroke = stroke_of(line((20, 20), (60, 20)), [(0.0, half_width)])
    stroke.target_mm = [np.array(target, float)]
    plans = [core.compensate([stroke], ROUND, (200.0, 200.0), end=end).plan for end in ("round", "butt")]
    np.testing.assert_array_equal(*(plan.passes[0].poses_mm for plan in plans))


@pytest.mark.parametrize(
    ("half_width", "target"),
    [
        (2.0, mirrored(ROUND_CAP)),
        (
            0.5,
            [(19.5, 19.5), (60, 19.5), (60, 20.5), (19.5, 20.5)],
        ),  # finer than a path can follow into a corner
        (2.0, [(22, 18), (60, 18), (60, 22), (22, 22), (18, 20)]),  # pointed
        (2.0, [(10, 18), (60, 18), (60, 22), (10, 22)]),  # goes on in another stroke
    ],
)
def test_an_outline_without_a_cut_at_its_start_starts_round(half_width, target):
    stroke = stroke_of(line((20, 20), (60, 20)), [(0.0, half_width)])
    stroke.target_mm = [np.array(target, float)]
    plans = [core.compensate([stroke], ROUND, (200.0, 200.0), start=start).plan for start in ("round", "butt")]
    np.testing.assert_array_equal(*(plan.passes[0].poses_mm for plan in plans))


@pytest.mark.parametrize("middle", [line((20, 20), (28, 20)), line((20, 20), (25, 20), (25, 50))])
def test_a_butt_start_without_space_for_the_way_back_is_round(middle):
    """A beginning without space for the way back is round.

    It is too short for a tip that is set down inside, or the tip would stick out next to a corner.
    """
    rounded = poses_of(middle, [(0.0, 3.0)], start="round")
    np.testing.assert_array_equal(poses_of(middle, [(0.0, 3.0)], start="butt"), rounded)


def test_automatic_starts_keep_round_caps():
    middle, half_width = line((20, 20), (60, 20)), [(0.0, 2.0)]
    rounded = poses_of(middle, half_width, start="round")
    np.testing.assert_array_equal(poses_of(middle, half_width, start="auto"), rounded)
    butt = poses_of(middle, half_width, start="butt")
    assert len(butt) > len(rounded)
    with_setting = core.Stroke(id="s", middle_mm=middle, half_width=half_width, settings=core.Settings(start="butt"))
    plan = core.compensate([with_setting], ROUND, (200.0, 200.0), start="pointed").plan
    np.testing.assert_array_equal(plan.passes[0].poses_mm, butt)


def test_automatic_ends_keep_round_caps():
    middle, half_width = line((20, 20), (60, 20)), [(0.0, 2.0)]
    rounded = poses_of(middle, half_width)
    np.testing.assert_array_equal(poses_of(middle, half_width, end="auto"), rounded)
    assert len(poses_of(middle, half_width, end="butt")) > len(rounded)
