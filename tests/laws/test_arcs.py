"""Arcs in plans agree with the differential equation, chords, printed values and symmetries."""

import itertools

import numpy as np
import oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_brushes import law, make_brush, make_plan

core = pytest.importorskip("brushsvg._core")
find_brush = pytest.importorskip("brushsvg.model.library").find_brush

DEPTH = 5.0
LAG = float(law("round")(DEPTH))
BRUSH = make_brush()


class Chain:
    """Return a pass with a run-up of 2 lags along +x, then moves.

    A move is (corner before it [rad], radius or None, turn [rad] or length).
    """

    def __init__(self, moves, depth=DEPTH, lag=LAG, steps=1, turned=0.0, shift=(0.0, 0.0)):
        self.moves, self.shift, heading = moves, np.asarray(shift, float), turned
        start = self.shift
        at = start + 2 * lag * oracle.unit(heading)
        self.poses, self.arcs, self.motions = [[*start, 0.0], [*start, -depth], [*at, -depth]], [], []
        for corner, radius, amount in moves:
            heading += corner
            if radius is None:
                self._line(at, heading, amount, depth)
            else:
                self._arc(at, heading, radius, amount, depth, steps)
                heading += amount
            at = np.array(self.poses[-1][:2])
        self.heading = turned  # position of the settled brush before the first move
        self.start = start + 2 * lag * oracle.unit(turned)

    def _line(self, at, heading, length, depth):
        along = oracle.unit(heading)
        self.motions.append((lambda t: at + t * length * along, lambda t: length * along, 1))
        self.poses.append([*(at + length * along), -depth])

    def _arc(self, at, heading, radius, turn, depth, steps):
        side = np.sign(turn)
        centre = at + radius * oracle.unit(heading + side * np.pi / 2)
        begin = np.arctan2(*(at - centre)[::-1])
        count = int(np.ceil(abs(turn) / 2.5)) * steps
        self.motions.append(
            (
                lambda t: centre + radius * oracle.unit(begin + t * turn),
                lambda t: radius * abs(turn) * oracle.unit(heading + t * turn),
                count,
            )
        )
        first = len(self.poses) - 1
        for k in range(1, count + 1):
            self.poses.append([*(centre + radius * oracle.unit(begin + k / count * turn)), -depth])
        self.arcs.append(core.Arc(first, len(self.poses) - 1, tuple(centre), int(side)))

    def plan(self):
        plan = make_plan(self.poses)
        plan.passes[0].arcs = self.arcs
        return plan

    def rows(self, brush=BRUSH, tolerance_mm=0.05):
        return core.simulate(self.plan(), brush, tolerance_mm).passes[0]


def contacts(rows):
    """Return the contact at every pose, from its first row."""
    whole = np.flatnonzero(rows.pose == np.round(rows.pose))
    _, first = np.unique(rows.pose[whole], return_index=True)
    return rows.contact_mm[whole[first]]


angle = st.floats(-3.1, 3.1)
radius = st.one_of(st.floats(0.3, 60.0), st.floats(0.999, 1.001).map(lambda k: k * LAG), st.just(LAG))
turn = st.floats(0.02, 6.0).flatmap(lambda x: st.sampled_from([x, -x]))
arc = st.tuples(angle, radius, turn)
move = st.one_of(arc, arc, st.tuples(angle, st.none(), st.floats(0.1, 30.0)))
chains = st.lists(move, min_size=1, max_size=5)


@given(chains)
def test_arcs_agree_with_solve_ivp_with_events(moves):
    chain = Chain(moves)
    rows = chain.rows()
    state = (chain.start - LAG * oracle.unit(chain.heading), chain.heading, True)
    pose, found = 2, contacts(rows)
    for tcp, velocity, count in chain.motions:
        *state, events = oracle.follow(tcp, velocity, LAG, *state)
        assert found[pose + count] == pytest.approx(state[0], abs=2e-6)
        for event in events:
            assert np.min(np.abs(rows.pose - (pose + count * event))) < 1e-6, "no row at an event"
        pose += count


@pytest.mark.parametrize(
    ("moves", "states"),
    [
        ([(0.0, 30.0, 2.0)], "taut"),
        ([(0.0, 4.0, 6.0)], "taut loose"),
        ([(3.0, 30.0, 1.5)], "loose taut"),
        ([(3.0, 8.0, 6.0)], "loose taut loose"),
        ([(0.0, 4.0, 4.0), (2.0, 20.0, 3.0)], "taut loose taut"),
    ],
)
def test_the_brush_goes_loose_and_taut_on_arcs(moves, states):
    """These cases are the elements of the random chains."""
    rows = Chain(moves).rows()
    taut = rows.taut[(rows.pose > 2) & (rows.pose < rows.pose[-1])]
    assert " ".join("taut" if key else "loose" for key, _ in itertools.groupby(taut)) == states


@given(chains)
def test_more_poses_on_the_same_arcs_change_nothing(moves):
    one, many = Chain(moves), Chain(moves, steps=3)
    assert contacts(many.rows())[-1] == pytest.approx(contacts(one.rows())[-1], abs=2e-6)


@given(chains, st.floats(-3, 3), st.tuples(st.floats(-500, 500), st.floats(-500, 500)))
def test_turning_the_sheet_turns_the_mark(moves, turned, shift):
    plain, other = contacts(Chain(moves).rows()), contacts(Chain(moves, turned=turned, shift=shift).rows())
    c, s = oracle.unit(turned)
    assert other == pytest.approx(plain @ np.array([[c, s], [-s, c]]) + shift, abs=2e-6)


@given(chains)
def test_mirroring_the_sheet_mirrors_the_mark(moves):
    mirrored = [(-a, r, amount if r is None else -amount) for a, r, amount in moves]
    plain, other = contacts(Chain(moves).rows()), contacts(Chain(mirrored).rows())
    assert other == pytest.approx(plain * [1, -1], abs=2e-6)


@given(st.lists(arc, min_size=1, max_size=3))
def test_an_arc_is_the_limit_of_its_chords(moves):
    """If chords are halved, the error falls by a factor of four, or is a rounding error."""
    exact = contacts(Chain(moves).rows())[-1]
    off = []
    for steps in (40, 160):
        chain = Chain(moves, steps=steps)
        chain.arcs = []
        off.append(np.hypot(*(contacts(chain.rows(tolerance_mm=1.0))[-1] - exact)))
    assert off[1] < 0.02 and off[1] <= 0.5 * off[0] + 1e-4


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("off_mm", [0.0, 1e-9, -1e-9, 1e-4, -1e-4, 1e-3])
def test_a_turn_in_place_keeps_the_contact(side, off_mm):
    """q moves on a circle of radius r about p; rounding of the radius must not move p."""
    chain = Chain([(side * np.pi / 2, LAG + off_mm, side * 3.1)], steps=8)
    found = contacts(chain.rows())
    resting = chain.start - LAG * oracle.unit(chain.heading)
    assert np.hypot(*(found[2:] - resting).T).max() <= max(0.0, off_mm) * (1 + 3.1**2 / 2) + 1e-9


def test_an_arc_has_the_documented_check_value():
    """The check value is for k = 1/40, r = 8, psi0 = 0.7, s = 60."""
    chain = Chain([(-0.7, 40.0, 1.5)], lag=8.0)
    rows = chain.rows(make_brush([8.0]))
    last = np.flatnonzero(rows.pose == 3)[0]
    assert rows.heading_rad[last] - (-0.7 + 1.5) == pytest.approx(-0.200791034, abs=1e-8)


@pytest.mark.parametrize("radius", [1.0, 3.0, 6.0, 7.9])
def test_on_a_circle_smaller_than_the_lag_the_patch_comes_to_rest(radius):
    rows = Chain([(0.0, radius, 40.0)], lag=8.0).rows(make_brush([8.0]))
    centre = np.array([16.0, radius])
    away = np.hypot(*(rows.contact_mm - centre).T)
    assert away[rows.pose <= rows.pose[-1] - 1][-1] == pytest.approx(8.0 - radius, abs=1e-8)


@pytest.mark.parametrize("degrees", [100, 120, 150, 180, -135])
@pytest.mark.parametrize("half_width", [1.68, 0.4])
def test_planned_arcs_paint_the_same_as_chords(degrees, half_width):
    a = np.radians(degrees)
    points = np.array([[20, 50], [60, 50], [60 + 30 * np.cos(a), 50 + 30 * np.sin(a)]])
    cubics = np.array([np.concatenate([p, p + (q - p) / 3, q - (q - p) / 3, q]) for p, q in itertools.pairwise(points)])
    stroke = core.Stroke(id="s", middle_mm=cubics, half_width=[(0.0, half_width)])
    brush = find_brush("round-6")
    plan = core.compensate([stroke], brush, (100.0, 100.0), few_poses=False).plan
    assert len(plan.passes[0].arcs) == 1
    exact = contacts(core.simulate(plan, brush, 1e-3).passes[0])
    again = core.read_plan(core.write_plan(plan))
    assert contacts(core.simulate(again, brush, 1e-3).passes[0]) == pytest.approx(exact, abs=1e-6)
    plan.passes[0].arcs = []
    assert contacts(core.simulate(plan, brush, 1e-3).passes[0]) == pytest.approx(exact, abs=1e-3)
