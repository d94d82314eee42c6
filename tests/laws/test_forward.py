"""The forward law agrees with references.

These are its differential equation, slow stepping, printed values and its symmetries.
"""

import itertools

import numpy as np
import oracle
import pytest
from diagnostics import refused
from hypothesis import example, given
from hypothesis import strategies as st
from made_up_brushes import LAGS, law, make_brush, make_pass, make_plan, profile, random_poses
from sampling import sample

core = pytest.importorskip("brushsvg._core")

ROUND = law("round")


def rows_of(poses, brush, tolerance_mm=0.02):
    return core.simulate(make_plan(poses), brush, tolerance_mm, may_rise=True).passes[0]


def at_poses(rows):
    """Return the numbers of the rows at the poses."""
    whole = np.flatnonzero(rows.pose == np.round(rows.pose))
    _, first = np.unique(rows.pose[whole], return_index=True)
    return whole[first]


# The taut law against its differential equation -------------------------------------------------------------


@pytest.mark.parametrize("name", LAGS)
def test_the_taut_law_solves_its_differential_equation(name):
    rng = np.random.default_rng(3)
    for _ in range(40):
        depths = rng.uniform(0.3, 10, 2)
        length = rng.choice([0.0, rng.uniform(0, 0.5), rng.uniform(0.5, 40)])
        start, phi, theta = rng.uniform(-50, 50, 2), *rng.uniform(-np.pi, np.pi, 2)
        poses = np.array([[*start, depths[0]], [*(start + length * oracle.unit(phi)), depths[1]]])
        contact = start - law(name)(depths[0]) * oracle.unit(theta)
        found = core.lag.drag_straight(contact, poses[0, :2], poses[1, :2], *depths, profile(*LAGS[name]))
        kinks = [(k - depths[0]) / (depths[1] - depths[0]) for k in law(name).kinks()]
        cuts = [0.0, *sorted(t for t in kinks if 0 < t < 1), 1.0]
        for a, b in itertools.pairwise(cuts):
            target, heading = oracle.taut(law(name), poses[0] + np.outer([a, b], poses[1] - poses[0]), theta)
            theta = heading[0]
        assert found == pytest.approx(target[0], abs=1e-9)


@pytest.mark.parametrize("depths", [(0.0, 10.0), (10.0, 0.0), (0.0, 1e-3), (4.0, 4.0), (2.0, 8.0)])
def test_the_taut_law_holds_over_the_whole_depth_range(depths):
    poses = np.array([[0, 0, depths[0]], [12.0, 5.0, depths[1]]])
    target, _ = oracle.taut(ROUND, poses, 2.0)
    contact = -ROUND(depths[0]) * oracle.unit(2.0)
    found = core.lag.drag_straight(contact, [0, 0], [12.0, 5.0], *depths, profile(*LAGS["round"]))
    assert found == pytest.approx(target[0], abs=1e-9)


@pytest.mark.parametrize("lag", [0.1, 3.0, 8.0, 39.999, 40.0, 40.001, 60.0])
@pytest.mark.parametrize("curvature", [0.0, 1 / 40, -1 / 40, 1e-9])
def test_an_arc_solves_its_differential_equation(lag, curvature):
    from scipy.integrate import solve_ivp

    for psi0 in (-1.3, -0.2, 0.0, 0.7, 1.5):
        path = solve_ivp(
            lambda s, y, k=curvature: [-np.sin(y[0]) / lag - k],
            (0, 20),
            [psi0],
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
        )
        if np.all(np.abs(path.y[0]) < np.pi / 2):
            assert core.lag.drag_arc(psi0, curvature, lag, 20.0) == pytest.approx(path.y[0, -1], abs=1e-9)


# Whole passes -------------------------------------------------------------------------------------


@pytest.mark.parametrize("lifts", [False, True])
@sample("name", LAGS, keep=2)
def test_the_simulator_agrees_with_solve_ivp_with_events(name, lifts):
    rng = np.random.default_rng([5, lifts, *name.encode()])
    brush, pulls = make_brush(LAGS[name]), []
    for _ in range(8):
        poses = random_poses(rng, 9, lifts=lifts)
        rows, reference = rows_of(poses, brush, 0.2), oracle.Reference(poses, law(name))
        for k, pose in enumerate(rows.pose):
            contact, heading, taut, pull = reference.at(pose)
            if rows.depth_mm[k] < 0 or np.isnan(contact[0]):
                continue
            assert rows.contact_mm[k] == pytest.approx(contact, abs=2e-9), (pose, taut)
            reach = np.hypot(*(rows.tcp_mm[k] - contact))
            if reach > 1e-6 and not np.isnan(heading):
                turn = np.angle(np.exp(1j * (rows.heading_rad[k] - heading)))
                assert abs(turn) * reach < 3e-9
            if not np.isnan(pull) and rows.depth_mm[k] > 1e-6:
                assert rows.pull[k] == pytest.approx(pull, abs=1e-8)
                pulls.append(pull)
            if np.min(np.abs(pose - reference.starts)) > 1e-6:
                assert rows.taut[k] == taut, pose
        for event in reference.events():
            assert np.min(np.abs(rows.pose - event)) < 1e-6, "no row at an event"
    assert np.min(pulls) < 0.5  # the plans do go loose


@pytest.mark.parametrize("lifts", [False, True])
def test_the_simulator_agrees_with_slow_stepping(lifts):
    rng = np.random.default_rng(7)
    names = [name for name in LAGS if name != "floor"] * 8
    plans = [random_poses(rng, 9, lifts=lifts) for _ in names]
    stepped = oracle.step_all(plans, [law(n) for n in names], 1200)
    for name, poses, target in zip(names, plans, stepped, strict=True):
        rows = rows_of(poses, make_brush(LAGS[name]))
        down = poses[:, 2] <= 0
        assert rows.contact_mm[at_poses(rows)][down] == pytest.approx(target[down], abs=1e-5)


def test_the_simulator_agrees_with_slow_stepping_of_a_law_with_a_floor():
    rng = np.random.default_rng(8)
    plans = [random_poses(rng, 6) for _ in range(12)]
    stepped = oracle.step_all(plans, [law("floor")] * 12, 1000)
    for poses, target in zip(plans, stepped, strict=True):
        rows = rows_of(poses, make_brush(LAGS["floor"]))
        assert rows.contact_mm[at_poses(rows)] == pytest.approx(target, abs=1e-5)


def test_the_two_slow_simulators_and_the_reference_agree():
    rng = np.random.default_rng(9)
    names = list(LAGS)
    plans, laws = [random_poses(rng, 5, lifts=True) for _ in names], [law(n) for n in names]
    article = oracle.step_all(plans, laws, 800)
    coarse, fine = (oracle.step_all(plans, laws, n, "rope") for n in (800, 1600))
    for k, poses in enumerate(plans):
        reference = oracle.Reference(poses, laws[k])
        exact = np.array([reference.at(i)[0] for i in range(len(poses))])
        assert article[k] == pytest.approx(exact, abs=1e-5, nan_ok=True)
        assert fine[k] == pytest.approx(exact, abs=5e-3, nan_ok=True)
        assert 2 * fine[k] - coarse[k] == pytest.approx(exact, abs=5e-5, nan_ok=True)


def test_pressing_fast_loosens_inside_a_move():
    """Fast pressing loosens the brush inside a move.

    The brush is settled at depth 2, then pressed at 1 mm per mm. The patch rests, then is dragged again.
    """
    poses = np.array([[0, 0, 0], [9, 0, -2], [60, 0, -2], [67, 0, -9], [110, 0, -9], [110, 0, 0.0]])
    rows, reference = rows_of(poses, make_brush()), oracle.Reference(poses, ROUND)
    inside = (rows.pose > 2) & (rows.pose < 3)
    assert (~rows.taut[inside]).any()
    assert len(reference.events()) >= 3
    for k in range(len(rows.pose)):
        assert rows.contact_mm[k] == pytest.approx(reference.at(rows.pose[k])[0], abs=1e-9)
    poses[3, 2] = poses[4, 2] = -2 - 0.6 * 7
    rows = rows_of(poses, make_brush())
    assert rows.taut[(rows.pose > 2) & (rows.pose < 3)].all()
    poses[3, 2] = poses[4, 2] = -2 - 0.65 * 7
    rows = rows_of(poses, make_brush())
    assert not rows.taut[(rows.pose > 2) & (rows.pose < 3)].all()


def test_brush_tightens_and_loosens_again_within_one_move():
    """A brush can tighten and loosen again within one move.

    f is negative at both ends of the move and positive between them. Only isolating all roots finds this.
    """
    lag = oracle.Law([6.0, -2.2, 0.3])  # 6 at depth 0, 2.0 at depth 4, 7.8 at depth 8
    poses = np.array([[0, 0, 0.0], [2.5, 0, -0.2], [5.0, 1.0, -8.0], [5.0, 1.0, 0.0]])
    reference, rows = (
        oracle.Reference(poses, lag),
        rows_of(poses, make_brush(([6.0, -2.2, 0.3], -np.inf, 0.0))),
    )
    middle = [k for s, _, k, _ in reference.phases if 1 <= s < 2]
    assert middle == ["loose", "taut", "loose"]
    for k in range(len(rows.pose)):
        assert rows.contact_mm[k] == pytest.approx(reference.at(rows.pose[k])[0], abs=1e-9)


def test_passing_over_the_patch_keeps_the_last_heading():
    poses = np.array([[0, 0, -4.0], [20, 0, -4], [10, 0, -4], [10, 0, -4], [-20, 0, -4]])
    lag = float(ROUND(4.0))
    rows = rows_of(poses, make_brush())
    end = at_poses(rows)[-1]
    assert rows.contact_mm[end] == pytest.approx([-20 + lag, 0], abs=1e-9)
    assert abs(rows.heading_rad[end]) == pytest.approx(np.pi, abs=1e-12)
    stops = rows_of(np.array([[0, 0, -4.0], [20, 0, -4], [20 - lag, 0, -4]]), make_brush())
    end = at_poses(stops)[-1]
    assert stops.contact_mm[end] == pytest.approx([20 - lag, 0], abs=1e-9)
    if np.array_equal(stops.tcp_mm[end], stops.contact_mm[end]):
        assert stops.heading_rad[end] == 0


def test_the_heading_before_the_first_motion_is_the_first_heading():
    poses = np.array([[1, 1, 0.0], [1, 1, -3], [1, 1, -2], [-4, 1 + 5 * np.sqrt(3), -3], [9, 9, -3]])
    rows = rows_of(poses, make_brush())
    first = rows.pose <= 2
    assert rows.heading_rad[first] == pytest.approx(np.full(first.sum(), 2 * np.pi / 3), abs=1e-12)
    assert rows.pull[first][rows.depth_mm[first] > 0] == pytest.approx(0.0, abs=1e-12)
    assert rows_of([[1, 1, 0.0], [1, 1, -3], [1, 1, 0.0]], make_brush()).heading_rad == pytest.approx(0.0, abs=0)


def test_rigid_pen_follows_the_tcp():
    rng = np.random.default_rng(2)
    poses = random_poses(rng, 9)
    rows = rows_of(poses, make_brush(([0.0], -np.inf, 0.0), tip_gap=(0.0,)))
    assert rows.contact_mm == pytest.approx(rows.tcp_mm, abs=1e-12)
    for k, pose in enumerate(rows.pose):
        i = min(int(pose), len(poses) - 2)
        step = poses[i + 1, :2] - poses[i, :2]
        if pose != i and np.hypot(*step) > 0:
            assert oracle.unit(rows.heading_rad[k]) == pytest.approx(step / np.hypot(*step), abs=1e-9)


@pytest.mark.parametrize("tolerance", [0.2, 0.02, 0.002])
def test_row_spacing_follows_the_tolerance(tolerance):
    """Rows are as close as the tolerance requires.

    Half way between two rows, no point of the footprint is further from the line between them.
    """
    rng = np.random.default_rng(11)
    outlines = core.footprint_at
    for name in ("round", "constant"):
        brush = make_brush(LAGS[name])
        poses = random_poses(rng, 8, lifts=True)
        rows, reference = rows_of(poses, brush, tolerance), oracle.Reference(poses, law(name))
        for k in range(len(rows.pose) - 1):
            if rows.depth_mm[k] <= 0 or rows.depth_mm[k + 1] <= 0 or rows.pose[k + 1] - rows.pose[k] < 1e-9:
                continue

            def outline(contact, heading, depth, pull, brush=brush):
                shape = outlines(brush.footprints, depth, pull)
                return oracle.placed(shape, contact, heading, brush.tip_gap(depth))

            ends = [
                outline(rows.contact_mm[j], rows.heading_rad[j], rows.depth_mm[j], rows.pull[j]) for j in (k, k + 1)
            ]
            contact, heading, _, pull = reference.at(0.5 * (rows.pose[k] + rows.pose[k + 1]))
            if np.isnan(heading):
                continue
            between = outline(contact, heading, 0.5 * (rows.depth_mm[k] + rows.depth_mm[k + 1]), pull)
            assert np.max(np.hypot(*(between - 0.5 * (ends[0] + ends[1])).T)) <= tolerance * 1.01, rows.pose[k]


# Check values ------------------------------------------------------------------------

FIGURE_3 = np.array(
    [
        [0.3, 1.470962578, 0.000996016, -2.985062247, -0.098671978, -3.980082996, 2.942418246],
        [1, 1.243469712, 0.035461787, -2.840715761, -0.286050950, -3.787621015, 2.502940052],
        [3, 0.705026844, 0.715217532, -1.944162821, -0.046376624, -2.592217095, 1.603727440],
        [6, 0.269035991, 3.107917260, -0.797406687, 2.143889680, -1.063208915, 0.940211420],
        [12, 0.036627182, 9.002012101, -0.109856980, 8.002682801, -0.146475974, 0.448761937],
    ]
)


def test_figure_3_of_the_article_is_reproduced():
    poses = [[0, -10, -5.0], [0, 0, -5.0], *([s, 0, -5.0] for s in FIGURE_3[:, 0])]
    rows = rows_of(poses, make_brush(LAGS["constant"], tip_gap=(1.0,)))
    rows_at = at_poses(rows)[2:]
    u = oracle.unit(rows.heading_rad[rows_at])
    assert rows.heading_rad[rows_at] == pytest.approx(FIGURE_3[:, 1], abs=1e-8)
    assert rows.contact_mm[rows_at] == pytest.approx(FIGURE_3[:, 2:4], abs=1e-8)
    assert rows.contact_mm[rows_at] - u == pytest.approx(FIGURE_3[:, 4:6], abs=1e-8)
    for s, alpha, beta in FIGURE_3[:, [0, 1, 6]]:
        assert core.lag.tip_direction(np.pi / 2, alpha, s, 3.0, 1.0) == pytest.approx(beta, abs=1e-8)


def test_the_example_of_depth_2_to_8_is_reproduced():
    start = np.array([0.0, 0.0]) - ROUND(2.0) * oracle.unit(1.2)
    contact = core.lag.drag_straight(start, [0, 0], [20, 0], 2.0, 8.0, profile(*LAGS["round"]))
    assert np.arctan2(-contact[1], 20 - contact[0]) == pytest.approx(0.160941370, abs=1e-8)
    assert np.hypot(*(contact - [20, 0])) == pytest.approx(ROUND(8.0), abs=1e-9)
    assert np.log(np.tan(0.6) / np.tan(0.5 * 0.160941370)) == pytest.approx(2.138103176, abs=2e-8)


def test_the_arc_example_is_reproduced():
    assert core.lag.drag_arc(0.7, 1 / 40, 8.0, 60.0) == pytest.approx(-0.200791034, abs=1e-8)
    settled = core.lag.drag_arc(0.7, 1 / 40, 8.0, 2000.0)
    assert np.sin(settled) == pytest.approx(-8 / 40, abs=1e-12)


def test_figure_12_of_the_article_is_reproduced():
    poses = [[0, -40, -5.0], *([s, 0, -5.0] for s in (0, 10, 20, 40, 80))]
    rows = rows_of(poses, make_brush([13.0]))
    away = -rows.contact_mm[at_poses(rows)[2:], 1]
    assert away == pytest.approx([9.918081, 5.336474, 1.196081, 0.055257], abs=5e-7)


@pytest.mark.parametrize(("depth", "tail"), [(3, 4.2), (6, 8.2), (10, 10.6)])
def test_a_plain_vertical_lift_drags_a_tail(depth, tail):
    rows = rows_of([[0, 0, -depth], [40, 0, -depth], [40, 0, 0]], make_brush())
    before, after = rows.contact_mm[at_poses(rows)[1:]]
    assert after - before == pytest.approx([ROUND(depth) - ROUND(0), 0], abs=1e-8)
    assert after[0] - before[0] == pytest.approx(tail, abs=0.05)


@pytest.mark.parametrize("psi0", [1.6, 2.0, 2.5, 3.1, -1.7, -3.0])
def test_loose_brush_rests_until_the_mirrored_angle(psi0):
    turn = oracle.unit(-psi0)
    rest = -2 * 3.0 * np.cos(psi0)
    poses = [[-20, 0, -5], [0, 0, -5], [*(rest * turn), -5], [*((rest + 4) * turn), -5]]
    rows = rows_of(poses, make_brush(LAGS["constant"]))
    resting = (rows.pose >= 1) & (rows.pose <= 2)
    assert rows.contact_mm[resting] == pytest.approx(np.tile([-3.0, 0], (resting.sum(), 1)), abs=1e-8)
    psi = np.angle(np.exp(1j * (rows.heading_rad[at_poses(rows)[2]] + psi0)))
    assert psi == pytest.approx(np.sign(psi0) * np.pi - psi0, abs=1e-8)
    start = np.sign(psi0) * np.pi - psi0
    psi = np.angle(np.exp(1j * (rows.heading_rad[-1] + psi0)))
    assert np.tan(psi / 2) == pytest.approx(np.tan(start / 2) * np.exp(-4 / 3.0), abs=1e-8)


def test_a_circle_smaller_than_the_lag_brings_the_patch_to_rest():
    turn = np.linspace(0, 6 * np.pi, 3 * 3600 + 1)
    circle = 2.0 * oracle.unit(turn)
    poses = np.column_stack([circle, np.full(len(turn), -5.0)])
    rows = rows_of(np.vstack([[[2.0, -9.0, -5.0]], poses]), make_brush(LAGS["constant"]))
    assert np.hypot(*rows.contact_mm[-1]) == pytest.approx(1.0, abs=1e-5)
    assert rows.contact_mm[at_poses(rows)[-3600]] == pytest.approx(rows.contact_mm[-1], abs=1e-12)


def test_bristle_check_values_are_reproduced():
    third = core.bristle_coefficients("third_derivative")
    free = core.bristle_coefficients("shear_free")
    assert third == pytest.approx(np.array([4, 3, -4, 1]) / (2 * np.e - 3), abs=1e-12)
    assert free == pytest.approx([1.531832855, 1.163953414, -1.531832855, 0.367879441], abs=1e-8)
    for c, end in ((third, 0.0260351676), (free, 0.0318328549)):
        assert c[0] + c[1] + (c[2] + c[3]) * np.e + 0.5 == pytest.approx(end, abs=1e-8)
        assert core.bristle_deflection(c, 1.0) == pytest.approx(end, abs=1e-8)
        assert core.bristle_deflection(c, 0.0) == pytest.approx(0.0, abs=1e-15)
        for z in (0.2, 0.7):  # (e^(1-z) w'')'' = e^(1-z), by the derivatives of each term
            e = np.exp(z)
            w2, w3, w4 = ((c[2] + c[3] * (z + n)) * e + (n == 2) for n in (2, 3, 4))
            assert w2 - 2 * w3 + w4 == pytest.approx(1.0, abs=1e-12)


def test_round_6_is_the_brush_of_the_article():
    brush = pytest.importorskip("brushsvg.model.library").find_brush("round-6")
    assert brush.lag.coefficients == pytest.approx(LAGS["round"][0], abs=0)
    for d in np.linspace(0, 10, 41):
        assert brush.tip_gap(d) == pytest.approx(0.52 * d, abs=1e-12)
        assert brush.half_width(d) == pytest.approx(0.42 * d, abs=1e-12)
        widest = max(0, -2.35 + 2.75 * d - 0.42 * d**2 + 0.024 * d**3, 0.3 * 0.42 * d)
        assert brush.tip_to_widest(d) == pytest.approx(widest, abs=1e-12)
    assert [f.depth_mm for f in brush.footprints.dragged] == list(range(1, 11))
    for footprint in brush.footprints.dragged:
        d = footprint.depth_mm
        target = oracle.section_6_outline(brush.tip_to_widest(d), 0.42 * d)
        assert footprint.outline_mm == pytest.approx(target, abs=1e-4)


# Symmetries ---------------------------------------------------------------------------------------

lengths = st.one_of(st.just(0.0), st.sampled_from([1.0, 3.0, 8.0]), st.floats(0.01, 15))
turns = st.one_of(st.sampled_from([0.0, np.pi / 2, np.pi, -np.pi / 2]), st.floats(-3.2, 3.2))
moves = st.lists(st.tuples(lengths, turns, st.floats(0.05, 9.5)), min_size=1, max_size=7)
names = st.sampled_from(list(LAGS))


def poses_from(steps):
    xy, heading, poses = np.zeros(2), 0.3, [[0.0, 0.0, 0.0]]
    for length, turn, depth in steps:
        heading += turn
        xy = xy + length * oracle.unit(heading)
        poses.append([*xy, -depth])
    return np.array([*poses, [*xy, 0.0]])


def patch_at_poses(poses, brush):
    """Return contact and lever (n, 4) at every pose.

    The lever stays continuous where the heading jumps.
    """
    rows = rows_of(poses, brush)
    k = at_poses(rows)
    reach = np.hypot(*(rows.tcp_mm[k] - rows.contact_mm[k]).T)
    return np.hstack([rows.contact_mm[k], reach[:, None] * oracle.unit(rows.heading_rad[k])])


@given(moves, names, st.integers(2, 5))
def test_splitting_a_move_changes_nothing(steps, name, parts):
    poses, brush = poses_from(steps), make_brush(LAGS[name])
    whole = patch_at_poses(poses, brush)
    assert patch_at_poses(oracle.subdivide(poses, parts), brush)[::parts] == pytest.approx(whole, abs=2e-9)


# begins without a lag, and its first way is a rounding error
@example([(8.0, 0.0, 7.0)], "small near 0", 2.0, 2.0, False)
@given(moves, names, st.floats(-3, 3), st.floats(-200, 200), st.booleans())
def test_marks_follow_rotation_mirroring_and_translation_of_the_sheet(steps, name, angle, shift, mirror):
    poses, brush = poses_from(steps), make_brush(LAGS[name])
    here = patch_at_poses(poses, brush)
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.array([[c, -s], [s, c]]) @ np.diag([1.0, -1.0 if mirror else 1.0])
    there = poses.copy()
    there[:, :2] = poses[:, :2] @ matrix.T + [shift, 2 * shift]
    found = patch_at_poses(there, brush)
    assert found[:, :2] == pytest.approx(here[:, :2] @ matrix.T + [shift, 2 * shift], abs=1e-8)
    assert found[:, 2:] == pytest.approx(here[:, 2:] @ matrix.T, abs=1e-8)


def test_a_brush_lifted_in_place_keeps_its_heading():
    """A brush that is lifted on the spot keeps its heading.

    Its lever shrinks to 0 there, and no move gives a heading.
    """
    poses = np.array([[0, 0, 0], [0, 0, -3.0], [0, 1e-10, -3.0], [0, 1e-10, -1e-9], [0, 1e-10, 0]])
    heading = rows_of(poses, make_brush(LAGS["small near 0"])).heading_rad
    assert heading[-1] == pytest.approx(np.pi / 2)


@given(moves, names, st.floats(0.4, 1.0))
def test_scaling_everything_scales_the_mark(steps, name, scale):
    poses = poses_from(steps)
    coefficients, floor, slope = LAGS[name]
    scaled = ([c * scale ** (1 - k) for k, c in enumerate(coefficients)], floor * scale, slope)
    here, there = (
        patch_at_poses(poses, make_brush(LAGS[name])),
        patch_at_poses(scale * poses, make_brush(scaled)),
    )
    assert there == pytest.approx(scale * here, abs=1e-8)


@given(moves, names, st.floats(-2, 2), st.floats(-2, 2))
def test_patches_never_drift_apart(steps, name, dx, dy):
    """Patches never drift apart.

    The patch is pulled into a moving disc, so two patches under one TCP path only come nearer.
    """
    poses, brush = poses_from(steps), make_brush(LAGS[name])
    if name == "small near 0":  # at depth 0 a first difference vanishes
        return
    poses[0, 2] = -1.0
    one = rows_of(np.vstack([[[0.4, 0, -1]], poses]), brush)
    other = rows_of(np.vstack([[[0.4 + dx, dy, -1]], poses]), brush)
    apart = np.hypot(*(one.contact_mm[at_poses(one)] - other.contact_mm[at_poses(other)]).T)
    assert np.all(np.diff(apart) <= 1e-9)


def test_impossible_poses_are_refused():
    for poses in ([[0, 0, 0], [5, 0, -10.5]], [[0, 0, 0], [np.nan, 0, -1]], [[0, 0, 0], [np.inf, 0, -1.0]]):
        with pytest.raises(ValueError, match=r"."):
            core.simulate(core.Plan(passes=[make_pass(np.array(poses, float))]), make_brush())


def test_poses_above_the_paper_are_refused_except_in_realised_motion():
    rising = [[0, 0, 0], [8, 0, -4], [20, 0, 0.5], [30, 0, -4], [40, 0, 0]]
    plan, brush = make_plan(np.array(rising, float)), make_brush()
    with refused("above-paper 'pose 2' 0.5") as caught:
        core.simulate(plan, brush)
    assert caught.value.value == 0.5
    ran = core.simulate(plan, brush, may_rise=True).passes[0]
    assert ran.depth_mm.min() == -0.5
    # Plans are written to 1e-7 mm, so a rise by rounding does not count.
    flat = [[0, 0, 0], [8, 0, -4], [20, 0, -4], [40, 0, 1e-7]]
    assert core.simulate(make_plan(np.array(flat, float)), brush).passes[0].depth_mm[-1] <= 1e-7


@pytest.mark.parametrize(("first", "last"), [(-4.0, -6.0), (0.0, -6.0), (-4.0, 0.0), (0.0, 0.0)])
def test_each_pose_has_a_row_even_if_a_pass_starts_or_ends_on_the_paper(first, last):
    poses = np.array([[0, 0, first], [9, 0, -4], [40, 0, -6], [40, 30, last]])
    rows = core.simulate(make_plan(poses), make_brush()).passes[0]
    at = rows.pose_rows
    assert rows.pose[at] == pytest.approx(np.arange(4), abs=1e-9)
    assert rows.tcp_mm[at] == pytest.approx(poses[:, :2], abs=1e-9)
    assert rows.depth_mm[at] == pytest.approx(-poses[:, 2], abs=1e-9)
    # The patch trails the last pose by the lag. The rows after it belong to the lift on the spot.
    end = at[-1]
    assert np.hypot(*(rows.contact_mm[end] - poses[-1, :2])) == pytest.approx(ROUND(-last), abs=1e-3)
    assert (len(rows.pose) > end + 1) == (last < 0)
    if last < 0:
        assert rows.depth_mm[-1] == 0
        assert np.hypot(*(rows.contact_mm[-1] - rows.contact_mm[end])) > 3.0
