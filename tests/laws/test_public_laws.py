"""brushsvg.laws agrees with the article's check values and scipy's integration."""

import numpy as np
import oracle
import pytest
from diagnostics import refused
from made_up_brushes import LAGS, law, profile, random_poses
from scipy.integrate import quad, solve_bvp, solve_ivp

import brushsvg
from brushsvg import laws
from brushsvg.model.laws.numbers import FARTHEST_MM

FIGURE_3 = np.array(  # s, alpha, p, tip, beta; r = 3, b = 1, from 90 degrees
    [
        [0.3, 1.470962578, 0.000996016, -2.985062247, -0.098671978, -3.980082996, 2.942418246],
        [1, 1.243469712, 0.035461787, -2.840715761, -0.286050950, -3.787621015, 2.502940052],
        [3, 0.705026844, 0.715217532, -1.944162821, -0.046376624, -2.592217095, 1.603727440],
        [6, 0.269035991, 3.107917260, -0.797406687, 2.143889680, -1.063208915, 0.940211420],
        [12, 0.036627182, 9.002012101, -0.109856980, 8.002682801, -0.146475974, 0.448761937],
    ]
)


def test_figure_3_is_reproduced_with_arrays():
    s, alpha, beta = FIGURE_3[:, 0], FIGURE_3[:, 1], FIGURE_3[:, 6]
    tcp = np.column_stack([s, 0 * s])
    found = laws.alpha_after(np.pi / 2, s, 3.0)
    assert found == pytest.approx(alpha, abs=1e-9)
    assert tcp + laws.contact_offset(found, 3.0) == pytest.approx(FIGURE_3[:, 2:4], abs=1e-8)
    assert tcp + laws.tip_offset(found, 3.0, 1.0) == pytest.approx(FIGURE_3[:, 4:6], abs=1e-8)
    assert laws.tip_direction(np.pi / 2, found, s, 3.0, 1.0) == pytest.approx(beta, abs=1e-8)


def test_theorem_1_solves_its_differential_equation():
    lag = profile(*LAGS["round"])
    rng = np.random.default_rng(1)
    alpha0, s = rng.uniform(-3, 3, 12), rng.uniform(0.1, 40, 12)
    depth = rng.uniform(0.2, 10, (2, 12))
    found = laws.alpha_on_ramp(alpha0, s, lag, *depth)
    for k in range(12):
        way = solve_ivp(
            lambda x, a, k=k: -np.sin(a) / lag(depth[0, k] + (depth[1, k] - depth[0, k]) * x / s[k]),
            (0, s[k]),
            [alpha0[k]],
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
        )
        assert found[k] == pytest.approx(way.y[0, -1], abs=1e-10)
    assert laws.alpha_on_ramp(1.2, 20.0, lag, 2.0, 8.0) == pytest.approx(0.160941370, abs=1e-9)


def test_a_ramp_of_one_depth_next_to_a_floor_is_finite():
    law = laws.Profile([0.5, 0.5], floor=2.0, floor_slope=0.01)
    kink = 1.5 / 0.49  # here the floor ends
    for depth in (kink, np.nextafter(kink, 0.0), kink - 5e-10, kink + 5e-10):
        found = laws.alpha_on_ramp(1.0, 2.0, law, depth, depth)
        assert found == pytest.approx(laws.alpha_after(1.0, 2.0, law(depth)), abs=1e-8)


def test_arrays_broadcast_and_constant_depth_equals_a_ramp():
    alpha0, s, lag = (
        np.linspace(-1.5, 1.5, 5)[:, None, None],
        np.linspace(0, 30, 4)[:, None],
        np.array([2.0, 9.0]),
    )
    both = laws.alpha_after(alpha0, s, lag)
    assert both.shape == (5, 4, 2)
    assert laws.alpha_on_ramp(alpha0[..., 0], s[:, 0], 9.0, 3.0, 3.0) == pytest.approx(both[..., 1], abs=1e-13)
    assert laws.contact_offset(both, lag).shape == (5, 4, 2, 2)
    assert laws.alpha_after(1.0, [0.0, 1.0], 0.0) == pytest.approx([1.0, 0.0])  # a rigid pen


def test_the_loose_rule_agrees_with_an_integration_with_events():
    lag, s = 7.0, np.linspace(0, 40, 41)
    start = np.array([[-200.0, 0, 0], [-190, 0, -2], [0, 0, -2]])
    for turn in (-2.9, -1.7, 1.2, 1.9, 2.6):
        way = oracle.unit(turn)
        poses = np.vstack([start, [[*(x * way), -2] for x in s[1:]]])
        reference = oracle.Reference(poses, oracle.Law([lag]))
        heading = np.array([reference.at(2 + k)[1] for k in range(len(s))])
        found = laws.alpha_after_turn(-turn, s, lag)
        assert np.exp(1j * (found + turn)) == pytest.approx(np.exp(1j * heading), abs=1e-8)
        followed = laws.follow(poses[:, :2], -poses[:, 2], lag)
        assert followed.heading_rad[2:] == pytest.approx(heading, abs=1e-8)


def test_the_heading_before_the_first_motion_is_the_first_heading():
    found = laws.follow([(0, 0), (0, 0), (0, 5)], 2.0, 4.0)
    assert found.heading_rad == pytest.approx([np.pi / 2] * 3)


def test_lag_and_tip_gap_together_are_limited_like_a_contact():
    """Each may be half of the limit of contact_offset, so that their sum is within it."""
    laws.tip_offset(0.5, FARTHEST_MM / 2, FARTHEST_MM / 2)
    for lengths in ((0.6 * FARTHEST_MM, 1.0), (1.0, 0.6 * FARTHEST_MM)):
        with refused(f"out-of-range {FARTHEST_MM / 2:g}"):
            laws.tip_offset(0.5, *lengths)


@pytest.mark.parametrize("name", LAGS)
def test_a_whole_path_agrees_with_an_integration_with_events(name):
    rng = np.random.default_rng(2)
    for _ in range(2):
        poses = random_poses(rng, 7)
        reference = oracle.Reference(poses, law(name))
        found = laws.follow(poses[:, :2], -poses[:, 2], profile(*LAGS[name]))
        exact = np.array([reference.at(k)[0] for k in range(len(poses))])
        assert found.contact_mm == pytest.approx(exact, abs=2e-9)
        for k in range(1, len(poses)):  # the path can continue from any place if the patch is known
            if found.taut[k - 1] and poses[k - 1, 2] < 0:
                again = laws.follow(
                    poses[k - 1 : k + 1, :2],
                    -poses[k - 1 : k + 1, 2],
                    profile(*LAGS[name]),
                    found.contact_mm[k - 1],
                )
                assert again.contact_mm[1] == pytest.approx(found.contact_mm[k], abs=1e-9)


def test_theorem_2_is_the_displacement_of_the_tip():
    rng = np.random.default_rng(4)
    alpha0, s = rng.uniform(0.05, np.pi / 2, (6, 1)), rng.uniform(0.1, 30, 8)
    lag, gap = 9.3, 3.6
    alpha1 = laws.alpha_after(alpha0, s, lag)
    moved = np.stack([s + 0 * alpha1, 0 * alpha1], axis=-1)
    moved = moved + laws.tip_offset(alpha1, lag, gap) - laws.tip_offset(alpha0, lag, gap)
    assert laws.tip_direction(alpha0, alpha1, s, lag, gap) == pytest.approx(
        np.arctan2(moved[..., 1], moved[..., 0]), abs=1e-12
    )
    across = (lag + gap) / lag * quad(lambda x: np.sin(2 * laws.alpha_after(1.2, x, lag)) / 2, 0, 20)[0]
    along = 20 - (lag + gap) / lag * quad(lambda x: np.sin(laws.alpha_after(1.2, x, lag)) ** 2, 0, 20)[0]
    beta = laws.tip_direction(1.2, laws.alpha_after(1.2, 20.0, lag), 20.0, lag, gap)
    assert 1 / np.tan(beta) == pytest.approx(along / across, rel=1e-10)  # (11) as printed


def test_theorems_3_and_4_recover_lag_and_tip_gap():
    lag, gap = np.array([[3.0, 9.3], [13.0, 0.8]]), np.array([[1.0, 3.6], [5.2, 0.1]])
    alpha0 = np.array([[1.5, 1.2], [0.9, np.pi / 2]])
    s = np.linspace(0.2, 1.2, 5) * lag[..., None]
    alpha = laws.alpha_after(alpha0[..., None], s, lag[..., None])
    beta = laws.tip_direction(alpha0[..., None], alpha, s, lag[..., None], gap[..., None])
    for total in (False, True):
        found = laws.from_angles(alpha0, s, alpha, beta, total=total)
        assert found.lag_mm == pytest.approx(lag, rel=1e-11)
        assert found.tip_gap_mm == pytest.approx(gap, rel=1e-10)
        assert not found.left_out.any()
    assert np.isnan(laws.from_angles(1.5, s[0, 0], alpha[0, 0]).tip_gap_mm)


def test_fit_law_agrees_with_numpy():
    rng = np.random.default_rng(6)
    depth = np.arange(1, 11.0)
    value = 3 + 0.9 * depth + rng.normal(0, 0.5, 10)
    fit = laws.fit_law(depth, value, 2)
    assert fit.law.coefficients == pytest.approx(np.polynomial.polynomial.polyfit(depth, value, 2), rel=1e-9)
    left = value - fit.law(depth)
    assert fit.r_squared == pytest.approx(1 - left @ left / np.sum((value - value.mean()) ** 2))
    assert fit.law.rmse_mm == pytest.approx(np.sqrt(left @ left / 7))


@pytest.mark.parametrize("end", ["shear_free", "third_derivative"])
def test_lemma_1_holds_in_general(end):
    z = np.linspace(0, 1, 201)
    of_article = laws.bristle(lambda x: np.exp(1 - x), lambda x: np.exp(1 - x), end)
    assert of_article(z) == pytest.approx(laws.bristle_of_article(z, end), abs=1e-12)
    target = {"shear_free": 0.0318328549, "third_derivative": 0.0260351676}[end]
    assert of_article(1.0) == pytest.approx(target, abs=1e-10)

    def rigidity(x):
        return 1.3 + np.sin(3 * x)

    def load(x):
        return x * np.cos(5 * x)

    solved = laws.bristle(rigidity, load, end)

    def rate(x, y):  # w, w', M, M'
        return np.stack([y[1], y[2] / rigidity(x), y[3], load(x)])

    def ends(root, tip):
        third = tip[3] / rigidity(1.0) - tip[2] * 3 * np.cos(3.0) / rigidity(1.0) ** 2
        return np.array([root[0], root[1], tip[1], third if end == "third_derivative" else tip[3]])

    judge = solve_bvp(rate, ends, z, np.zeros((4, 201)), tol=1e-10, max_nodes=20000)
    assert judge.success
    assert solved(z) == pytest.approx(judge.sol(z)[0], abs=1e-9)
    assert solved.slope(z) == pytest.approx(judge.sol(z)[1], abs=1e-9)
    assert solved.moment(z) == pytest.approx(judge.sol(z)[2], abs=1e-8)
    assert solved.shear(z) == pytest.approx(judge.sol(z)[3], abs=1e-8)


def test_the_printed_condition_does_not_make_every_bristle_unique():
    def stiffer_to_the_tip(z):
        return 1 / (1 + np.sqrt(3) * (1 - z))

    with pytest.raises(brushsvg.Error) as refused:
        laws.bristle(stiffer_to_the_tip, np.ones_like, "third_derivative")
    assert refused.value.code == "bristle-undetermined"
    assert laws.bristle(stiffer_to_the_tip, np.ones_like)(1.0) > 0
    with pytest.raises(brushsvg.Error) as refused:
        laws.bristle(lambda z: np.where(z < 0.5, 1.0, 2.0), np.ones_like)
    assert refused.value.code == "not-smooth"


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: laws.alpha_after(1.0, -1.0, 3.0), "out-of-range"),
        (lambda: laws.alpha_after(np.nan, 1.0, 3.0), "out-of-range"),
        (lambda: laws.alpha_after(np.zeros(3), np.zeros(2), 3.0), "sizes-differ"),
        (lambda: laws.alpha_after("x", 1.0, 3.0), "wrong-type"),
        (lambda: laws.alpha_on_ramp(1.0, 5.0, laws.Profile([2, -1]), 1.0, 4.0), "law-negative"),
        (lambda: laws.alpha_on_ramp(1.0, 5.0, laws.Profile([0.1] * 12), 1.0, 4.0), "law-terms"),
        (lambda: laws.follow([[0, 0], [9, 0]], [1, 1, 1], 3.0), "sizes-differ"),
        (lambda: laws.follow([[0, 0], [9, 0]], 1.0, 3.0, (-5, 0)), "out-of-range"),
        (lambda: laws.tip_direction(2.0, 1.0, 3.0, 3.0, 1.0), "out-of-range"),
        (lambda: laws.from_angles(1.5, [], []), "measurement-missing"),
        (lambda: laws.fit_law([1, 2, 3], [1, 2, 4], 1, floor_mm=[0, 1]), "wrong-type"),
        (lambda: laws.bristle(3.0, np.ones_like), "wrong-type"),
        (lambda: laws.bristle(np.zeros_like, np.ones_like), "out-of-range"),
        (lambda: laws.bristle_of_article(0.5, "free"), "choice-unknown"),
    ],
)
def test_impossible_arguments_are_refused(call, code):
    with pytest.raises(brushsvg.Error) as refused:
        call()
    assert refused.value.code == code


def test_depths_that_a_brush_cannot_have_are_refused():
    lag = brushsvg.find_brush("round-6").lag  # its polynomial gives 7100 mm at 50 mm
    for call in (
        lambda: laws.follow([[0, 0], [10, 0]], [2, 50], lag),
        lambda: laws.alpha_on_ramp(1.0, 5.0, lag, 2.0, 50.0),
        lambda: laws.alpha_on_ramp(1.0, 5.0, lag, [2.0, 50.0], 3.0),
    ):
        with refused("depth-out-of-range"):
            call()


def test_a_degree_from_an_array_is_a_degree():
    depth, value = [1, 2, 4, 6, 8], [4, 5, 7, 8, 9]
    assert laws.fit_law(depth, value, np.arange(3)[2]) == laws.fit_law(depth, value, 2)


@pytest.mark.parametrize("integer", [False, True])
def test_masked_entries_are_refused_as_nan_is(integer):
    values = np.ma.array([3, 99, 5], int if integer else float, mask=[False, True, False])
    for call in (
        lambda: laws.fit_law(values, [3, 4, 5.0], 0),
        lambda: laws.fit_law([1, 2, 3.0], values, 0),
        lambda: laws.contact_offset(0.5, values),
        lambda: laws.contact_offset(0.5, [values, values]),
        lambda: laws.contact_offset(0.5, np.ma.masked),
    ):
        with refused("out-of-range"):
            call()
    unmasked = np.ma.array([3.0, 4.0], mask=[False, False])
    assert np.array_equal(laws.contact_offset(0.5, unmasked), laws.contact_offset(0.5, [3.0, 4.0]))
    assert type(laws.contact_offset(0.5, unmasked)) is np.ndarray


def test_results_of_follow_are_read_only():
    found = laws.follow([[0, 0], [9, 0.0]], [0, 3], brushsvg.find_brush("round-6").lag)
    with pytest.raises(ValueError, match="read-only"):
        found.contact_mm[0] = 0
