"""A tilted brush agrees with geometry and with a simulation in small steps.

The simulation shares no code with the package.
"""

import numpy as np
import oracle
import pytest
from made_up_brushes import LAGS, WIDEST, law, make_brush
from scipy.spatial.transform import Rotation

core = pytest.importorskip("brushsvg._core")

STEPS = 2000  # number of steps of each move


def unit_axes(lean):
    """Return unit axes that go sideways by `lean` (n, 2) per mm of height."""
    up = np.column_stack([lean, np.ones(len(lean))])
    return up / np.linalg.norm(up, axis=1, keepdims=True)


def simulated(tips, depths, axes, brush, **how):
    one = core.Pass("s", np.column_stack([tips, -np.asarray(depths, float)]), tool_axes=axes)
    return core.simulate(core.Plan(passes=[one]), brush, **how)


def axis_on_paper(tip, depth, axis):
    """Return the place of the axis at the paper's height.

    The tip is `depth` below the paper.
    """
    return (np.array([*tip, -depth]) + depth / axis[2] * axis)[:2]


def axes_on_paper(tips, depths, axes):
    return [axis_on_paper(*each) for each in zip(tips, depths, axes, strict=True)]


def stepped(places, depths, lag):
    """Simulate in small steps; return contact, way from contact to axis, and depth.

    The patch is pulled to within lag(depth) of the place where the axis meets the paper. This place moves
    straight from pose to pose.
    """
    contact, rows = places[0], [(places[0], np.full(2, np.nan), depths[0])]
    for k in range(len(places) - 1):
        for t in np.linspace(0, 1, STEPS + 1)[1:]:
            handle, depth = (1 - t) * places[k] + t * places[k + 1], (1 - t) * depths[k] + t * depths[k + 1]
            away = handle - contact
            reach = np.hypot(*away)
            if reach > lag(depth):
                contact = handle - away / reach * lag(depth)
            rows.append((contact, handle - contact, depth))
    return [np.array(column) for column in zip(*rows, strict=True)]


WAYS = [  # tips, depths, lean
    ([[0, 0], [10, 0], [50, 0]], [0, 4, 4], [[0.2, 0.0]] * 3),
    ([[0, 0], [10, 0], [50, 0]], [0, 4, 4], [[-0.2, 0.0]] * 3),
    ([[0, 0], [10, 0], [50, 0]], [0, 4, 4], [[0.0, 0.3]] * 3),
    # here the handle swings while the tip stays
    ([[0, 0], [20, 0], [20, 0], [20, 0]], [0, 5, 5, 5], [[0, 0], [0, 0], [0.5, 0], [0, 0.5]]),
    (
        [[0, 0], [9, 3], [20, 18], [5, 30], [-9, 21]],
        [0, 3, 6, 2, 7],
        [[0.1, 0], [0.2, -0.1], [0, 0.4], [-0.3, 0.2], [0.5, 0]],
    ),
]


@pytest.mark.parametrize("name", LAGS)
@pytest.mark.parametrize("way", range(len(WAYS)))
def test_the_contact_trails_the_point_where_the_axis_meets_the_paper(way, name):
    tips, depths, lean = (np.array(part, float) for part in WAYS[way])
    axes = unit_axes(lean)
    contact, _, _ = stepped(axes_on_paper(tips, depths, axes), depths, law(name))
    rows = simulated(tips, depths, axes, make_brush(LAGS[name])).passes[0]
    for pose in range(1, len(tips)):
        at = np.flatnonzero(rows.pose == pose)[0]
        assert rows.contact_mm[at] == pytest.approx(contact[pose * STEPS], abs=0.02)
        assert rows.tcp_mm[at] == pytest.approx(tips[pose], abs=1e-9)


def test_an_upright_axis_changes_nothing():
    tips, depths, _ = (np.array(part, float) for part in WAYS[4])
    brush = make_brush()
    assert simulated(tips, depths, unit_axes(np.zeros((5, 2))), brush) == simulated(
        tips, depths, np.zeros((0, 3)), brush
    )


def test_turning_the_sheet_turns_the_mark():
    tips, depths, lean = (np.array(part, float) for part in WAYS[4])
    turn = Rotation.from_euler("z", 0.7).as_matrix()
    brush = make_brush()
    one = simulated(tips, depths, unit_axes(lean), brush).passes[0]
    other = simulated(tips @ turn[:2, :2].T, depths, unit_axes(lean) @ turn.T, brush).passes[0]
    at = [np.flatnonzero(rows.pose == 4)[0] for rows in (one, other)]
    assert one.contact_mm[at[0]] @ turn[:2, :2].T == pytest.approx(other.contact_mm[at[1]], abs=1e-9)


def section(outline, axis):
    """Return where the bristles of a tilted brush cross the paper.

    The bristles cross a plane at a right angle to the brush in the points of `outline` (n, 2), seen from its
    axis. The brush then turns about a line in the paper until it points along `axis`.
    """
    up = np.array([0.0, 0.0, 1.0])
    about = np.cross(up, axis)
    sine = np.linalg.norm(about)
    turn = Rotation.from_rotvec(about / sine * np.arctan2(sine, axis[2]) if sine > 0 else np.zeros(3))
    bristles = turn.apply(np.column_stack([outline, np.zeros(len(outline))]))
    return (bristles - bristles[:, 2:] / axis[2] * axis)[:, :2]


def oracle_mark(tips, depths, lean, brush, dragged):
    """Return the swept area of the stepped simulation."""
    places = axes_on_paper(tips, depths, unit_axes(lean))
    # The brush is lifted on the spot at the end.
    contact, away, depth = stepped([*places, places[-1]], [*depths, 0.0], law("round"))
    lean = np.vstack([lean, lean[-1:]])
    whole = np.arange(len(contact)) / STEPS
    lean = np.column_stack([np.interp(whole, np.arange(len(lean)), column) for column in lean.T])
    outlines = []
    for k in range(0, len(contact), 10):
        heading = np.arctan2(*away[max(k, 1)][::-1])
        shape = oracle.placed(
            oracle.footprint_at(dragged, [], depth[k], 1.0), np.zeros(2), heading, brush.tip_gap(depth[k])
        )
        outlines.append(contact[k] + section(shape, unit_axes(lean[k : k + 1])[0]))
    return oracle.swept(outlines, True)


@pytest.mark.parametrize(
    "lean",
    [
        [[0.5, 0.0]] * 3,  # tilted along the way, the mark is longer
        [[0.0, 0.5]] * 3,  # tilted across the way, the mark is wider
        [[0.3, -0.4]] * 3,
        [[0.0, 0.0], [0.3, 0.3], [-0.4, 0.3]],
    ],
)
def test_the_mark_is_the_sweep_of_the_tilted_sections(lean):
    dragged = [(float(d), oracle.section_6_outline(float(WIDEST(d)), 0.42 * d, 33)) for d in range(1, 11)]
    brush, lean = make_brush(footprints=dragged), np.array(lean, float)
    tips, depths = np.array([[0, 0], [15, 2], [45, 20.0]]), np.array([0.0, 6.0, 6.0])
    target = oracle_mark(tips, depths, lean, brush, dragged)
    marks = simulated(tips, depths, unit_axes(lean), brush)
    core.trace_outlines(marks, brush)
    found = oracle.union_of([np.array(ring) for ring in marks.passes[0].outline_mm])
    assert found.symmetric_difference(target).area < 0.02 * target.length
    upright = simulated(tips, depths, np.zeros((0, 3)), brush)
    core.trace_outlines(upright, brush)
    before = oracle.union_of([np.array(ring) for ring in upright.passes[0].outline_mm])
    assert before.symmetric_difference(target).area > 0.2 * target.length


def test_the_widest_point_is_stretched_with_the_mark():
    brush = make_brush()
    tips, depths, lean = np.array([[0, 0], [60, 0.0]]), np.array([5.0, 5.0]), np.array([[0.5, 0.0]] * 2)
    one = simulated(tips, depths, unit_axes(lean), brush).passes[0]
    at = np.flatnonzero(one.pose == 1)[0]
    longer = np.sqrt(1 + 0.5**2)  # 1 / cos of the tilt
    away = WIDEST(5.0) - 0.52 * 5.0
    assert core.widest_points(one, brush)[at] - one.contact_mm[at] == pytest.approx([away * longer, 0], abs=1e-3)


def test_landing_in_place_puts_the_patch_under_the_axis():
    brush, tips, lean = make_brush(), np.array([[0, 0], [40, 9.0]]), np.array([[0.4, 0.1], [-0.2, 0.5]])
    axes = unit_axes(lean)
    short = simulated(tips, [5.0, 7.0], axes, brush).passes[0]
    whole = simulated(tips[[0, 0, 1, 1]], [0.0, 5.0, 7.0, 0.0], axes[[0, 0, 1, 1]], brush).passes[0]
    assert short.contact_mm == pytest.approx(whole.contact_mm, abs=1e-12)
    assert short.pose == pytest.approx(np.clip(whole.pose - 1, 0, 1), abs=1e-12)
    assert (short.pose[0], short.pose[-1], short.depth_mm[0], short.depth_mm[-1]) == (0, 1, 0, 0)
    assert short.tcp_mm[[0, -1]] == pytest.approx(tips)
    assert short.contact_mm[0] == pytest.approx(axis_on_paper(tips[0], 5.0, axes[0]))


@pytest.mark.parametrize("depths", [[3.0, 5.0, 4.0], [0.0, 5.0, 0.0], [5.0, 0.0, 5.0], [3.0, 5.0, 5.0]])
@pytest.mark.parametrize("spot", [False, True])
def test_a_negligible_tilt_equals_an_upright_brush(depths, spot):
    brush, tips = make_brush(), np.array([[0, 0], [0.0 if spot else 20, 0], [40, 15.0]])
    if depths[-1] == 0.0 and spot:
        tips[2] = tips[1]  # the third pose makes a dab
    areas, ends = [], []
    for lean in ([0, 0], [1e-7, 0], [-1e-7, 0], [0, 1e-7]):
        marks = simulated(tips, depths, unit_axes(np.array([lean] * 3, float)), brush)
        core.trace_outlines(marks, brush)
        areas.append(sum(core.area([ring]) for ring in marks.outline_mm))
        ends.append(marks.passes[0].contact_mm[-1])
    assert areas == pytest.approx([areas[0]] * 4, abs=0.05)
    assert np.array(ends) == pytest.approx(np.array([ends[0]] * 4), abs=1e-5)
