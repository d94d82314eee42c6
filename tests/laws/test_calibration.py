"""Calibration gives back the brush that made the measurements.

The measurements come from the slow stepping simulator.
"""

import itertools
import json
from functools import cache

import numpy as np
import oracle
import pytest
from diagnostics import refused
from made_up_brushes import law
from sampling import sample

from brushsvg import _core, laws
from brushsvg.calibration.numbers.angle_series import read_series, scatter_of_series
from brushsvg.calibration.numbers.centre_lines import read_turn
from brushsvg.calibration.numbers.from_measurements import calibrate
from brushsvg.calibration.numbers.measurements import read_measurements
from brushsvg.model.confidence import half_interval_mm

DEPTHS = np.arange(1.0, 11.0)
LAG = np.array([3.1, 0.86, 0.31, -5.0e-2, 2.1e-3])
GAP, HALF = 0.52, 0.42
WIDEST = np.array([0.1, 1.1, -0.06, 0.002])


def widest(depth):
    return np.polynomial.polynomial.polyval(depth, WIDEST)


def lag(depth):
    return np.polynomial.polynomial.polyval(depth, LAG)


def from_dict(**rows):
    head = {"format": "brushsvg/measurements", "version": 1, "depth_range_mm": [0, 10]}
    return read_measurements(json.dumps(head | rows).encode(), ".json")


def values(depths, numbers):
    return [{"depth_mm": float(d), "value_mm": float(v)} for d, v in zip(depths, numbers, strict=True)]


WIDTHS = values(DEPTHS, 2 * HALF * DEPTHS)


@cache
def corner(depth):
    """Return TCP and contact (17, 2) every 0.5 mm after a corner.

    The TCP runs along +x to (0, 0) until the brush is settled, then 8 mm along +y, all at one depth. The
    simulator only pulls the patch to within r of the TCP, in steps of 0.001 mm after the corner.
    """
    start = np.array([[[-80.0, 0.0, -depth], [0.0, 0.0, -depth]]])
    tcp = np.array([[0.0, 0.5 * k] for k in range(17)])
    contact = [oracle.step_all(start, [law("round")], 4000, "rope")[0, -1]]
    for q0, q1 in itertools.pairwise(tcp):
        p = contact[-1]
        for t in np.linspace(0, 1, 501)[1:]:
            lever = q0 + t * (q1 - q0) - p
            reach = np.hypot(*lever)
            p = p if reach <= lag(depth) else p + lever * (1 - lag(depth) / reach)
        contact.append(p)
    assert np.hypot(*contact[0]) == pytest.approx(lag(depth), abs=1e-3), "the patch trails by the lag"
    return tcp, np.array(contact)


def series(depth, rng=None, noise_deg=0.0):
    """Return the view of a camera under the glass.

    It sees the angles between motion and heading, and the way of the tip.
    """
    tcp, contact = corner(depth)
    heading = tcp - contact
    heading /= np.hypot(*heading.T)[:, None]
    tip = contact - GAP * depth * heading
    alpha = np.degrees(np.arctan2(heading[:, 0], heading[:, 1]))  # from +y, positive on the side it comes from
    moved = tip[1:] - tip[0]
    beta = np.degrees(np.arctan2(moved[:, 0], moved[:, 1]))
    if rng is not None:
        alpha, beta = (
            alpha + rng.normal(0, noise_deg, alpha.shape),
            beta + rng.normal(0, noise_deg, beta.shape),
        )
    s = tcp[1:, 1]
    return {
        "depth_mm": float(depth),
        "alpha0_deg": float(alpha[0]),
        "s_mm": s.tolist(),
        "alpha_deg": alpha[1:].tolist(),
        "beta_deg": beta.tolist(),
    }


def test_angle_series_give_lag_and_tip_gap():
    made = calibrate(from_dict(angles=[series(d) for d in DEPTHS], width=WIDTHS), "b")
    for depth in np.linspace(1, 10, 19):
        assert made.brush.lag(depth) == pytest.approx(lag(depth), rel=0.003)
        assert made.brush.tip_gap(depth) == pytest.approx(GAP * depth, rel=0.01)


def test_angle_series_with_one_degree_of_noise_give_the_laws():
    rng = np.random.default_rng(5)
    rows = [series(d, rng, 1.0) for d in np.repeat(DEPTHS, 3)]
    for total in (False, True):
        made = calibrate(from_dict(angles=rows, width=WIDTHS), "b", total=total)
        left = [made.brush.lag(d) - lag(d) for d in DEPTHS]
        assert np.sqrt(np.mean(np.square(left))) < 0.5


def noisy_series(rng, degrees, first_degrees):
    """Return five readings at each depth from the formulas.

    They cover an equal share of the lag. All angles have noise.
    """
    rows = []
    for d in DEPTHS:
        s = np.linspace(0.25, 1.2, 5) * lag(d)
        alpha = laws.alpha_after(np.radians(85), s, lag(d))
        beta = laws.tip_direction(np.radians(85), alpha, s, lag(d), GAP * d)
        rows.append(
            {
                "depth_mm": float(d),
                "alpha0_deg": float(min(85 + rng.normal(0, first_degrees), 95)),
                "s_mm": s.tolist(),
                "alpha_deg": (np.degrees(alpha) + rng.normal(0, degrees, 5)).tolist(),
                "beta_deg": (np.degrees(beta) + rng.normal(0, degrees, 5)).tolist(),
            }
        )
    return rows


@pytest.mark.parametrize(("degrees", "first_degrees"), [(1.0, 1.0), (2.0, 0.0)])
def test_intervals_of_angle_series_contain_the_truth(degrees, first_degrees):
    """Intervals of angle series contain the truth.

    The scatter of lag and tip gap grows with the lag. Without weights, the tip gap's interval held only 85 to
    90 %.
    """
    rng = np.random.default_rng(3)
    gap, lags = [], []
    for _ in range(200):
        made = calibrate(from_dict(angles=noisy_series(rng, degrees, first_degrees), width=WIDTHS), "b")
        gap.append(abs(made.brush.tip_gap.coefficients[1] - GAP) <= made.brush.tip_gap.half_interval_95[1])
        lags.append(np.abs(np.array(made.brush.lag.coefficients) - LAG) <= made.brush.lag.half_interval_95)
    assert 0.925 <= np.mean(gap) <= 0.985
    assert 0.925 <= np.mean(lags) <= 0.985


def test_the_scatter_of_a_series_agrees_with_repeated_readings():
    rng = np.random.default_rng(8)
    found = {d: [] for d in (2.0, 9.0)}
    for _ in range(400):
        for row in noisy_series(rng, 0.5, 0.5):
            if row["depth_mm"] in found:
                [read] = from_dict(angles=[row]).rows["angles"]
                lengths = read_series(read, False)
                found[row["depth_mm"]].append((lengths["lag_mm"], lengths["tip_gap_mm"]))
    for d, lengths in found.items():
        seen = np.std(lengths, axis=0) / np.radians(0.5)
        [row] = from_dict(angles=[noisy_series(np.random.default_rng(0), 0.0, 0.0)[int(d) - 1]]).rows["angles"]
        reported = scatter_of_series(row, lag(d), GAP * d, False)
        assert reported == pytest.approx(seen, rel=0.12)


def middle_line(depth, rng, mm):
    """Return the middle line of the mark of a turn by 90 degrees, by formula.

    e = x_w - b may have any sign.
    """
    r, e = lag(depth), SHALLOW(depth) - GAP * depth
    s = np.linspace(0, 2.2 * r, 30)
    after = np.column_stack([s - (r - e) * np.tanh(s / r), -(r - e) / np.cosh(s / r)])
    before = np.column_stack([np.zeros(4), -(r - e) - np.array([6, 4.5, 3, 1.5])])
    return (np.vstack([before, after]) + rng.normal(0, mm, (34, 2))).tolist()


SHALLOW = laws.Profile([-2.35, 2.75, -0.42, 0.024], floor=0)  # x_w of the article: e < 0 at depth 1


def centre_lines_and_footprints(rng, from_depth=2.0):
    read = DEPTHS[from_depth <= DEPTHS]
    return from_dict(
        tip_to_widest=values(read, SHALLOW(read) + rng.normal(0, 0.3, read.size)),
        centre_line=[{"depth_mm": float(d), "points_mm": middle_line(d, rng, 0.2)} for d in DEPTHS],
        tip_gap=values(DEPTHS, GAP * DEPTHS + rng.normal(0, 0.3, DEPTHS.size)),
        width=WIDTHS,
    )


def test_other_depths_decide_the_sign_of_e_for_a_centre_line():
    """Other depths decide the sign of e with which a centre line is read.

    Once each line was compared with laws fitted to that line, and the widest section at depth 1 was 0.4 mm
    off.
    """
    rng = np.random.default_rng(2)
    off, held, remarked = [], [], []
    for _ in range(4):
        made = calibrate(centre_lines_and_footprints(rng), "b")
        [fitted] = [each for each in made.laws if each.name == "tip_to_widest"]
        half = half_interval_mm(fitted.fit.covariance, np.array([1.0]), fitted.fit.degrees_of_freedom)[0]
        off.append(fitted.fit.law(1.0) - SHALLOW(1.0))
        held.append(abs(off[-1]) <= half)
        remarked.append(any("centre_line[0]" in remark for remark in made.remarks))
    assert np.mean(off) < 0.25
    assert all(is_held or is_said for is_held, is_said in zip(held, remarked, strict=True))


def test_centre_lines_are_weighted_by_the_scatter_of_their_points():
    """Centre lines are weighted by the scatter of their own points.

    Their scatter was once pulled towards the scatter of footprints, which is ten times larger. Intervals of
    the lag then held 99 %.
    """
    rng = np.random.default_rng(6)
    measured = centre_lines_and_footprints(rng)
    [lag_fit] = [each.fit for each in calibrate(measured, "b").laws if each.name == "lag"]
    own = [read_turn(row.numbers["points_mm"]).covariance_mm2[0, 0] for row in measured.rows["centre_line"]]
    powers = np.vander(DEPTHS, 5, increasing=True)
    deviation = np.sqrt(np.mean(np.diag(powers @ np.array(lag_fit.covariance) @ powers.T)))
    # a fit with weights by own scatter gives 1
    assert deviation < 1.35 * np.sqrt(np.mean(own) * 5 / len(own))


def test_joint_fits_and_single_fits_return_the_same_type():
    rng = np.random.default_rng(4)
    rows = {
        "lag": values(DEPTHS, lag(DEPTHS) + rng.normal(0, 0.1, DEPTHS.size)),
        "side_view": values(DEPTHS, lag(DEPTHS) + GAP * DEPTHS - lag(0.0) + rng.normal(0, 0.1, DEPTHS.size)),
        "width": WIDTHS,
    }
    made, again = (calibrate(from_dict(**rows), "b") for _ in range(2))
    fits = {each.name: each.fit for each in made.laws if each.fit is not None}
    assert set(fits) == {"lag", "tip_gap", "half_width"}
    assert {type(fit) for fit in fits.values()} == {laws.LawFit}
    assert all(isinstance(fit.degrees_of_freedom, float) for fit in fits.values())
    assert fits["lag"].degrees_of_freedom == fits["lag"].law.degrees_of_freedom > 4
    assert np.array(fits["tip_gap"].covariance).shape == (2, 2) and len(fits["lag"].residual_mm) == 10
    assert made == again and hash(fits["lag"]) == hash(again.laws[0].fit)
    rows["lag"][3]["value_mm"] += 0.1
    assert made != calibrate(from_dict(**rows), "b")


def test_the_angular_stroke_is_read_with_e():
    """The middle of an angular stroke turns r - e from the TCP's second line."""
    readings = []
    for depth in DEPTHS:
        _, contact = corner(depth)
        e = widest(depth) - GAP * depth
        readings.append(-(contact[0, 0] + e))  # the widest section's centre when the TCP turns
    rows = {"tip_to_widest": values(DEPTHS, widest(DEPTHS)), "tip_gap": values(DEPTHS, GAP * DEPTHS)}
    made = calibrate(from_dict(angular=values(DEPTHS, readings), width=WIDTHS, **rows), "b")
    np.testing.assert_allclose([made.brush.lag(d) for d in DEPTHS], lag(DEPTHS), atol=0.005)
    # The article reads this distance as the lag itself, which is too short by e.
    as_printed = calibrate(from_dict(lag=values(DEPTHS, readings), width=WIDTHS, **rows), "b")
    assert lag(10) - as_printed.brush.lag(10) == pytest.approx(widest(10) - GAP * 10, abs=0.01)


def test_side_view_and_straight_stroke_give_the_tip_gap():
    """Side view and straight stroke give the tip gap.

    (18) counts from the first touch. (17) as printed lacks the lag. In a straight slow landing, the tip
    begins to mark at 0. It is r + b behind the TCP, which has gone s_L. D is the distance from the mark's
    start to its widest place.
    """
    known = {
        "lag": values(DEPTHS, lag(DEPTHS)),
        "tip_to_widest": values(DEPTHS, widest(DEPTHS)),
        "width": WIDTHS,
    }
    side = values(DEPTHS, lag(DEPTHS) + GAP * DEPTHS - lag(0.0))
    made = calibrate(from_dict(side_view=side, **known), "b")
    assert made.brush.tip_gap.coefficients == pytest.approx([0, GAP], abs=1e-6)
    path = 60.0
    straight = [
        {"depth_mm": d, "path_mm": path, "distance_mm": path - lag(d) - GAP * d + widest(d)} for d in DEPTHS.tolist()
    ]
    made = calibrate(from_dict(straight=straight, **known), "b")
    assert made.brush.tip_gap.coefficients == pytest.approx([0, GAP], abs=1e-6)


@sample("kind", ["angular", "side_view"], keep=1)
def test_intervals_include_the_errors_of_corrections(kind):
    """The interval of a law includes the errors of the laws that corrected it."""
    rng = np.random.default_rng(11)
    depths = np.repeat(DEPTHS, 2)
    covered = []
    for _ in range(300):
        scale = rng.uniform(0.8, 1.5)
        rows = {
            "tip_to_widest": values(depths, widest(depths) + rng.normal(0, 0.1, depths.size)),
            "width": WIDTHS,
        }
        if kind == "angular":  # the lag comes from the sum, corrected by a poorly known tip gap
            rows["tip_gap"] = values(depths, GAP * depths + rng.normal(0, 0.6, depths.size))
            sums = scale * lag(depths) + GAP * depths - widest(depths)
            law_name, truth = "lag", scale * LAG
        else:
            rows["lag"] = values(depths, scale * lag(depths) + rng.normal(0, 0.15, depths.size))
            sums = scale * lag(depths) + GAP * depths - scale * lag(0.0)
            law_name, truth = "tip_gap", np.array([0, GAP])
        rows[kind] = values(depths, sums + rng.normal(0, 0.2, depths.size))
        made = calibrate(from_dict(**rows), "b")
        assert not any("held" in remark for fitted in made.laws for remark in fitted.remarks if fitted.name == "lag")
        profile = getattr(made.brush, law_name)
        off = np.abs(np.array(profile.coefficients) - truth)
        covered.append(off <= profile.half_interval_95)
    first = 1 if law_name == "tip_gap" else 0
    assert 0.92 <= np.mean(np.array(covered)[:, first:]) <= 0.985


@pytest.mark.thorough
def test_the_covariance_agrees_with_repeated_calibrations():
    """The covariance agrees with the scatter of 600 calibrations.

    It includes the correlations between laws.
    """
    rng = np.random.default_rng(2)
    depths = np.repeat(DEPTHS, 2)
    found, reported = [], []
    for _ in range(600):
        rows = {
            "tip_to_widest": values(depths, widest(depths) + rng.normal(0, 0.3, depths.size)),
            "width": WIDTHS,
        }
        rows["tip_gap"] = values(depths, GAP * depths + rng.normal(0, 0.15, depths.size))
        sums = lag(depths) + GAP * depths - widest(depths) + rng.normal(0, 0.2, depths.size)
        made = calibrate(from_dict(angular=values(depths, sums), **rows), "b")
        laws = [made.brush.lag, made.brush.tip_gap, made.brush.tip_to_widest]
        found.append(np.concatenate([each.coefficients for each in laws]))
        reported.append(np.array(made.brush.covariance)[:11, :11])
    reported, seen = np.mean(reported, axis=0), np.cov(np.array(found).T)
    # Compare the laws' values at depths, because the sizes of coefficients differ by thousands.
    at = np.array([2.0, 5.0, 9.0])
    values_of = np.zeros((9, 11))
    for k, (first, count) in enumerate(((0, 5), (5, 2), (7, 4))):
        values_of[3 * k : 3 * k + 3, first : first + count] = np.vander(at, count, increasing=True)
    reported, seen = (values_of @ c @ values_of.T for c in (reported, seen))
    size = np.sqrt(np.outer(np.diag(seen), np.diag(seen)))
    np.testing.assert_allclose(reported / size, seen / size, atol=0.15)


@pytest.mark.parametrize("total", [False, True])
def test_check_values_of_the_model(total):
    """The page of check values holds for r = 3, b = 1 and alpha0 = 90 degrees."""
    s = [0.3, 1, 3, 6, 12]
    alpha = [1.470962578, 1.243469712, 0.705026844, 0.269035991, 0.036627182]
    beta = [2.942418246, 2.502940052, 1.603727440, 0.940211420, 0.448761937]
    lines = _core.Lines.total if total else _core.Lines.plain
    found = _core.from_angles(np.pi / 2, s, alpha, beta, lines)
    assert found["lag_mm"] == pytest.approx(3, abs=1e-6)
    assert found["tip_gap_mm"] == pytest.approx(1, abs=1e-6)
    assert found["lag_rmse_mm"] < 1e-6 and found["left_out"] == 0


def test_plain_and_total_least_squares_agree_with_numpy():
    rng = np.random.default_rng(7)
    s = np.arange(1, 7.0)
    alpha = 2 * np.arctan(np.exp(-s / 5.0)) + rng.normal(0, 0.05, 6)
    e_foldings = np.log(np.tan(alpha / 2))  # (19) with alpha0 = 90 degrees: log cot 45 degrees = 0
    plain = -(np.linalg.pinv(e_foldings[:, None]) @ s)[0]
    assert _core.from_angles(np.pi / 2, s, alpha)["lag_mm"] == pytest.approx(plain, rel=1e-12)
    scale = np.linalg.norm(s) / np.linalg.norm(e_foldings)
    gram = np.array([scale * e_foldings, s]) @ np.array([scale * e_foldings, s]).T
    _, vectors = np.linalg.eigh(gram)
    total = scale * vectors[0, 0] / vectors[1, 0]
    assert _core.from_angles(np.pi / 2, s, alpha, [], _core.Lines.total)["lag_mm"] == pytest.approx(total, rel=1e-9)


@pytest.mark.parametrize(
    ("rows", "where", "expected"),
    [
        ({"width": WIDTHS}, "lag", "measurement-missing lag angles angular"),
        ({"lag": values(DEPTHS, lag(DEPTHS))}, "half_width", "measurement-missing width"),
        ({"lag": values([3, 3, 3], [7, 7, 7.1]), "width": WIDTHS}, "lag[0]", "depths-too-few 3 two"),
        (
            {"angular": values(DEPTHS, lag(DEPTHS)), "width": WIDTHS},
            "angular",
            "law-undetermined angular sum",
        ),
        ({"lag": values(DEPTHS, -lag(DEPTHS)), "width": WIDTHS}, "lag[9]", "law-negative 10"),
        (
            {"lag": values(DEPTHS / 1000, lag(DEPTHS) / 1000), "width": values(DEPTHS / 1000, DEPTHS / 1000)},
            "depth_mm",
            "depth-out-of-range 0.01",
        ),
        (
            {
                "angles": [{"depth_mm": 3, "alpha0_deg": 90, "s_mm": [1, 2], "alpha_deg": [95, 99]}],
                "width": WIDTHS,
            },
            "angles[0]",
            "measurement-missing",
        ),
        ({"lag": [{"depth_mm": 3}], "width": WIDTHS}, "lag[0]", "key-missing value_mm"),
        ({"lag": [{"depth_mm": 3, "value_mm": None}]}, "lag[0].value_mm", "not-a-number None"),
        ({"lag": [{"depth_mm": 3, "value_mm": float("nan")}]}, "lag[0].value_mm", "not-a-number nan"),
        ({"lags": []}, "lags", "key-unknown lag tip_gap"),
        ({"lag": [{"depth": 3}]}, "lag[0].depth", "key-unknown"),
        ({}, "", "measurement-missing"),
    ],
)
def test_impossible_calibrations_are_refused_with_a_remedy(rows, where, expected):
    with refused(expected, where):
        calibrate(from_dict(**rows), "b")
