"""Filled shapes become strokes.

The tests check the number of strokes, their middle lines, their directions, their order and the part of the
shape that belongs to each stroke.
"""

import itertools

import numpy as np
import pytest
import shapely
from diagnostics import agrees, are_reported, refused
from svg_text import read

from brushsvg import _core
from brushsvg.errors import Error
from brushsvg.read.layout import Layout, arrange
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.skeleton.cut_ends import run_to_cut

BAR = "M10 20H60V26H10Z"


def painted(body: str, **settings):
    made, _ = strokes(read(f'<g fill="#123456" stroke="none">{body}</g>'), **settings)
    return made


def path(d: str, rest: str = "") -> str:
    return f'<path id="p" d="{d}" {rest}/>'


def ends(stroke) -> list[list[float]]:
    """Return the start and the end of a stroke in the drawing's frame, y down."""
    return [[round(x, 1), round(50 - y, 1)] for x, y in (stroke.middle_mm[0, :2], stroke.middle_mm[-1, 6:])]


def marks(made) -> list:
    """Return the area that discs of the found widths paint along the found lines."""
    bare = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in made]
    return _core.unite([ring for stroke in bare for ring in _core.target_outline(stroke, 0.01)])


def target(made) -> list:
    return _core.unite([ring for stroke in made for ring in stroke.target_mm])


def test_a_bar_is_one_stroke_that_ends_half_a_width_inside():
    (bar,) = painted(path(BAR))
    assert bar.id == "p"
    assert (bar.colour, bar.closed, len(bar.middle_mm)) == ("#123456", False, 1)
    assert ends(bar) == [[13, 23], [57, 23]]
    assert {round(half, 3) for _, half in bar.half_width} == {3}
    assert _core.area(bar.target_mm) == pytest.approx(300)


@pytest.mark.parametrize(("slant_mm", "is_straight"), [(0.6, True), (2.2, True), (6.0, True), (10.0, False)])
def test_a_leg_is_straight_up_to_a_cut_and_bends_into_a_sharper_corner(slant_mm, is_straight):
    """A leg stays straight up to a slanted cut and bends into a sharper corner.

    The cuts are at 84, 70, 45 and 31 degrees. The leg once made a hook towards a corner of 70 degrees, which
    the feet of an A have. Towards a corner of 45 degrees, which the arms of a k have, the stroke once had the
    shape of a leaf.
    """
    (leg,) = painted(path(f"M40 5V{40 + slant_mm}L46 40V5Z"))
    line = _core.flatten(leg, 0.01)[:, :2]
    assert (np.abs(line[:, 0] - 43).max() < 0.35) == is_straight
    assert (line[-1, 1] < 50 - 40) == (not is_straight)


@pytest.mark.parametrize(
    ("d", "half_mm"),
    [
        ("M8 25C8 10 24 6 36 11V18C26 13 15 14 15 25C15 36 26 37 36 32V39C24 44 8 40 8 25Z", 3.2),
        ("M10 45V24C16 14 26 9 36 9V16C28 16 20 20 17 27V45Z", 3.5),
    ],
)
def test_an_arm_with_bent_sides_keeps_its_width_up_to_its_cut(d, half_mm):
    """An arm with bent sides keeps its width up to its cut, as in C and r.

    The medial axis points past the middle of the cut. The stroke once ran on into the corner, where its half
    width was 2.0 and 1.8 mm.
    """
    (letter,) = painted(path(d))
    halves = letter.half_width[0][1], letter.half_width[-1][1]
    at = {x > 30: half for (x, _), half in zip(ends(letter), halves, strict=True)}
    assert at[True] == pytest.approx(half_mm, abs=0.1)


def polygon(shape) -> str:
    rings = [shape.exterior, *shape.interiors]
    return "".join("M" + "L".join(f"{x:.3f} {y:.3f}" for x, y in ring.coords[:-1]) + "Z" for ring in rings)


@pytest.mark.parametrize("slant_deg", [-10, 0, 10, 20])
def test_an_arm_of_a_round_c_ends_in_the_middle_of_its_cut(slant_deg):
    """An arm of a round C ends in the middle of its cut.

    The corner where a bent side ends was once dropped later than the other corner of the cut. The path into
    this corner counted as part of the line. Thick C, S and 2 ended in one corner of their cuts, and half of
    each cut stayed blank.
    """
    amid, way = (np.array([np.cos(t), np.sin(t)]) for t in np.radians([40, 40 + slant_deg]))
    upper = [15 * amid - 8 * way, 15 * amid + 12 * way]
    cut = shapely.Polygon([(0, 0), *upper, (60, 0), *((x, -y) for x, y in upper[::-1])])
    ring = shapely.Point(0, 0).buffer(19, quad_segs=17).difference(shapely.Point(0, 0).buffer(11, quad_segs=17))
    shape = shapely.transform(ring.difference(cut), lambda at: at + np.array([25, 25]))
    (letter,) = painted(path(polygon(shape)))
    for half in (letter.half_width[0][1], letter.half_width[-1][1]):
        assert half == pytest.approx(4, rel=0.12)


def test_a_bar_continues_through_its_stem_into_a_stub():
    """The left part of the bar of a bold f or t is painted.

    This part is too short for a branch of its own and once stayed blank.
    """
    _, bar = painted(path("M20 5H28V18H36V25H28V45H20V25H16V18H20Z"))
    assert ends(bar) == [[19.5, 21.5], [32.5, 21.5]]
    flush, _ = sorted(painted(path("M20 5H28V18H36V25H28V45H20Z")), key=lambda each: -ends(each)[1][0])
    assert ends(flush)[0][0] > 23.5


def test_a_corner_in_which_two_strokes_end_belongs_to_both():
    """Both strokes that end in one corner get the whole corner as their target.

    Neither stroke had a straight end in its part, and both ended round. Where a bar runs into a stem, the bar
    gets no extra area.
    """
    dee = painted(path("M20 5H35Q55 5 55 25Q55 45 35 45H20ZM28 11V39H35Q48 39 48 25Q48 11 35 11Z"))
    assert len(dee) == 2
    for y in (5.1, 44.7):
        corner = np.array([(20.1, y), (20.3, y), (20.3, y + 0.2), (20.1, y + 0.2)])
        for stroke in dee:
            assert _core.area(_core.intersect(stroke.target_mm, [corner])) == pytest.approx(0.04, abs=1e-4)
    tee = painted(path("M10 10H50V16H33V45H27V16H10Z"))
    parts = sum(_core.area(stroke.target_mm) for stroke in tee)
    assert parts < _core.area(target(tee)) + 6 * 6 + 1


def test_a_last_step_sideways_is_left_out():
    """A last step sideways, as at the end of the axis of an s, is left out.

    The code that squares an end looks for the cut along the last direction of the line.
    """
    bar = np.array([(0.0, -3.0), (40.0, -3.0), (40.6, 3.0), (0.0, 3.0)])
    along = np.column_stack([np.linspace(5, 37, 33), np.zeros(33), np.full(33, 3.0)])
    line = run_to_cut(np.vstack([along, (37.1, 0.1, 2.9)]), [bar])
    assert line[-1] - line[-2] == pytest.approx((line[-1, 0] - line[-2, 0], 0, 0), abs=1e-9)
    assert line[-1] == pytest.approx((40.3 - 3 * np.hypot(1, 0.1), 0, 3), abs=0.01)


def test_a_hairline_that_ends_in_a_ball_keeps_its_course():
    """A hairline that ends in a ball keeps its course, as in the tail of a y.

    The straight cut of the stem is far behind the end and does not belong to the end.
    """
    stem = [(0.0, 40.0 - k, 3.4) for k in range(28)]
    tail = [(3.3 - 0.5 * k, 10.2 - k, 0.15) for k in range(20)]
    ball = [(-6.8, -9.0, 3.9)]
    line = np.array(stem + tail + ball)
    hair = shapely.LineString([place[:2] for place in tail + ball]).buffer(0.15)
    shape = shapely.unary_union([shapely.box(-3.4, 10, 3.4, 44), hair, shapely.Point(ball[0][:2]).buffer(3.9)])
    ring = np.array(shapely.geometry.polygon.orient(shape).exterior.coords)[:-1]
    assert run_to_cut(line, [ring]) is line


def test_a_pointed_end_keeps_its_point():
    (leaf,) = painted(path("M10 30Q30 20 60 30Q30 40 10 30Z"))
    assert min(half for _, half in leaf.half_width) < 0.2
    assert sorted(x for x, _ in ends(leaf)) == pytest.approx([10, 60], abs=1.5)


@pytest.mark.parametrize("inner_mm", [12, 14, 16])
@pytest.mark.parametrize("blunt_mm", [5, 6, 7, 8])
def test_the_legs_of_an_apex_are_straight_and_begin_next_to_each_other(blunt_mm, inner_mm):
    """The legs of an apex are straight and begin next to each other.

    Both legs once began at one place and bent towards it, or one leg went on into the apex.
    """
    left, right = 25 - blunt_mm / 2, 25 + blunt_mm / 2
    legs = painted(path(f"M10 45L{left} 5H{right}L40 45H34L25 {inner_mm}L16 45Z"))
    assert len(legs) == 2
    for leg in legs:
        line = _core.flatten(leg, 0.01)[:, :2]
        along = (line[-1] - line[0]) / np.hypot(*(line[-1] - line[0]))
        assert np.abs((line - line[0]) @ [-along[1], along[0]]).max() < 0.1
    (one, _), (other, _) = (ends(leg)[0] for leg in legs)
    assert abs(one - other) > 0.08 * blunt_mm


@pytest.mark.parametrize(
    ("d", "least"),
    [
        ("M10 6H16.5V34L28.7 6H35.3L18.5 40Q14.3 48.5 10 40Z", 0.977),  # 0.970 if the lines end side by side
        ("M10 6H15.5V30.2L23 6H28.5L21.3 40Q15.7 46.1 10 40Z", 0.968),  # 0.948 towards one place
    ],
)
def test_lines_that_meet_in_a_round_corner_cover_it(d, least):
    """Two lines cover the round corner in which they meet.

    The comparison stops short of the lines' ends, because discs leave the ends blunt.
    """
    made = painted(path(d))
    shape = _core.intersect(target(made), [np.array([(0.0, 0.0), (60.0, 0.0), (60.0, 38.0), (0.0, 38.0)])])
    assert _core.area(_core.intersect(marks(made), shape)) > least * _core.area(shape)


def test_a_shape_that_turns_at_a_corner_is_one_line():
    """A shape that turns at a corner as one stroke has one connected line.

    A gap between the parts of the line would be refused.
    """
    (hook,) = painted(path("M10 10H40V20L16 45L12 41L32 16H10Z"))
    assert len(hook.middle_mm) > 2
    assert hook.middle_mm[1:, :2] == pytest.approx(hook.middle_mm[:-1, 6:])


@pytest.mark.parametrize(
    ("d", "start"),
    [
        (BAR, [13, 23]),  # to the right
        ("M40 5V45H46V5Z", [43, 8]),  # down
        ("M15 40L40 5L45 9L20 43Z", [41, 9]),  # down to the left
        ("M15 5L45 36L41 40L11 9Z", [16, 10]),  # down to the right
        ("M10 24L50 12V18L12 29Z", [13, 26]),  # flat and rising: to the right
        ("M10 28L45 6Q52 11 46 22Z", [45, 8]),  # narrow on the left: set down wide, lifted thin
    ],
)
def test_strokes_run_in_the_direction_of_writing(d, start):
    (stroke,) = painted(path(d))
    assert ends(stroke)[0] == pytest.approx(start, abs=2.5)


@pytest.mark.parametrize(
    ("name", "d", "count"),
    [
        ("T", "M10 5H50V11H33V45H27V11H10Z", 2),
        ("X", "M10 5H17L30 20L43 5H50L34 25L50 45H43L30 30L17 45H10L26 25Z", 2),
        ("L", "M10 5H16V39H40V45H10Z", 1),
        ("H", "M10 5H16V22H34V5H40V45H34V28H16V45H10Z", 3),
        ("V", "M10 5H16L25 36L34 5H40L28 45H22Z", 2),
        ("O", "M30 5A20 20 0 1 0 30 45A20 20 0 1 0 30 5ZM30 11A14 14 0 1 1 30 39A14 14 0 1 1 30 11Z", 1),
        ("D", "M10 5H25A20 20 0 0 1 25 45H10ZM16 11V39H25A14 14 0 0 0 25 11Z", 2),
        ("i", "M10 20H16V45H10ZM10 8H16V14H10Z", 2),
    ],
)
def test_letters_become_the_strokes_of_handwriting(name, d, count):
    made = painted(path(d))
    assert [stroke.id for stroke in made] == (["p"] if count == 1 else [f"p/{k}" for k in range(1, count + 1)])
    shape = target(made)
    assert _core.overlap(marks(made), shape) > 0.91
    assert made[0].closed == (name == "O")
    (outline,) = read(f'<g fill="red" stroke="none">{path(d)}</g>').elements
    from brushsvg.strokes.skeleton import filled_rings

    assert _core.overlap(shape, filled_rings(outline)) > 0.999, "the parts make up the shape"


def test_pointed_tips_can_be_painted():
    made = painted(path("M10 20L60 24L10 28Z"))
    halves = [half for _, half in made[0].half_width]
    assert 0.0099 * max(halves) < min(halves) < 0.1
    from brushsvg import find_brush

    assert _core.compensate(made, find_brush("round-6"), (100, 50)).plan.passes


def test_crossing_lines_stay_straight_and_both_cover_the_crossing():
    bar, stem = painted(path("M10 5H50V11H33V45H27V11H10Z"))
    line = _core.flatten(bar, 0.001)
    assert np.abs(line[:, 1] - 42).max() < 0.1, "the bar does not sag towards the stem"
    assert ends(bar) == [[13, 8], [47, 8]]
    assert ends(stem)[0][1] < 11, "the stem begins under the bar"
    assert _core.area(bar.target_mm) == pytest.approx(40 * 6, abs=1.5)


@pytest.mark.parametrize(("half_mm", "bar_half_mm"), [(4, 2.5), (5, 3)])
def test_a_thick_line_that_bends_where_a_thin_one_crosses_it_is_one_stroke(half_mm, bar_half_mm):
    """The thick line of an x stays one stroke where a thin line crosses it.

    The thick line turns by more than 60 degrees in all. It was once left as two arms with a gap between them.
    """
    thick = shapely.LineString([(6, 19), (24, 19), (36, 31), (54, 31)]).buffer(half_mm, cap_style="flat")
    thin = shapely.box(30 - bar_half_mm, 7, 30 + bar_half_mm, 43)
    made = painted(path(polygon(thick.union(thin))))
    assert len(made) == 2, "the thick line and the thin one"
    assert _core.overlap(marks(made), target(made)) > 0.93  # with two arms the overlap is below 0.9


def test_bars_precede_their_stems_and_words_go_from_left_to_right():
    assert [ends(stroke)[0][0] < 20 for stroke in painted(path("M10 5H50V11H33V45H27V11H10Z"))] == [
        True,
        False,
    ]
    falling, leg = painted(path("M43 8L47 12L7 46L3 42ZM13 33L42 44L40 49L11 37Z"))
    assert ends(falling)[0][0] > 40, "it begins further from the upper left than the leg, which hangs on it"
    assert ends(leg)[0][0] < 20
    words = painted("".join(path(f"M{x} 20V40H{x + 5}V20Z").replace('"p"', f'"p{x}"') for x in (50, 10, 30)))
    assert [stroke.id for stroke in words] == ["p50", "p10", "p30"], "elements keep the drawing's order"
    row = painted(path("M50 20V40H55V20ZM10 22V40H15V22ZM30 18V40H35V18Z"))
    assert [ends(stroke)[0][0] for stroke in row] == sorted(ends(stroke)[0][0] for stroke in row)


def test_a_stem_continues_to_its_serif_above_a_bowl():
    stem, bowl = painted(path("M6 9H22V15Q27 8 36 8V12Q28 13 22 22V48H14V13H6Z"))
    assert ends(stem) == [[8, 11], [18, 44]]
    assert ends(bowl)[0][0] < 22 < 33 < ends(bowl)[1][0], "the arm is a stroke of its own, from the stem"
    assert (
        _core.overlap(marks([stem, bowl]), target([stem, bowl])) > 0.94
    )  # with the stem bent into the bowl the overlap is 0.855


@pytest.mark.parametrize(("top", "valley"), [(6, 24), (7, 24)])
def test_a_stem_that_sticks_out_next_to_its_arch_is_a_separate_stroke(top, valley):
    """A stem that sticks out next to its arch is a stroke of its own.

    The humps of a script's n and m are too blunt for a branch of their own. They were once lost: the short
    stem was mistaken for the flick of its arch, and the arch turned at the corner below the humps.
    """
    stem = f"M10 44V{top + 18}C10 {top + 10} 13 {top} 17 {top}C20 {top} 22 {top + 4} {valley} 12"
    made = painted(path(f"{stem}C28 9 31 8 35 8C43 8 46 14 46 20V44H38V24C38 13 26 12 18 30V44Z"))
    assert len(made) == 2, "the stem, and the arch from it on"
    stem_line, arch_line = sorted((_core.flatten(each, 0.01) for each in made), key=lambda line: line[-1, 0])
    assert stem_line[0, 1] > stem_line[-1, 1], "one writes it down"
    assert stem_line[0, 1] > arch_line[0, 1] + 5, "it begins in the hump"
    letter = target(made)
    assert _core.area(_core.intersect(marks(made), letter)) > 0.93 * _core.area(letter)


def test_a_blob_with_holes_and_a_single_crossing_is_painted():
    disc = "M{0} 25A{1} {1} 0 1 0 {2} 25A{1} {1} 0 1 0 {0} 25Z".format
    made = painted(path(disc(10, 15, 40) + disc(22.5, 0.5, 23.5) + disc(26.5, 0.5, 27.5), 'fill-rule="evenodd"'))
    assert _core.area(target(made)) == pytest.approx(np.pi * (15**2 - 2 * 0.5**2), rel=0.01)


def test_the_inside_of_a_crossing_without_through_line_belongs_to_an_ending_line():
    from brushsvg.strokes.skeleton import outline_strokes

    square = [[4.3, 11.6], [7.1, 15.8], [2.2, 19.0], [-0.5, 14.8]]
    slanted = [[14.7, 1.2], [2.6, 13.5], [-1.6, 9.3], [10.4, -3.0]]
    stub = [[-1.2, 0.3], [4.5, 0.9], [4.2, 3.6], [-1.5, 3.0]]
    shape = _core.fill([np.array(bar) for bar in (square, stub, slanted)])
    assert _core.area(target(outline_strokes(shape))) == pytest.approx(_core.area(shape), rel=0.02)


def test_slivers_do_not_become_strokes():
    bar, sliver = "M0 5H20V9H0Z", "M20 9L40 9.004L20 9.008Z"
    (stroke,) = painted(path(bar + sliver))
    assert stroke.middle_mm[:, 0::2].max() < 21
    with refused("nothing-to-paint outline area"):
        painted(path(sliver))


def test_sliver_loops_leave_a_ring_for_any_start():
    from brushsvg.geometry.rings import signed_area, without_slivers

    bar = [[0, 0], [10, 0], [10, 4], [0, 4]]
    # The tail touches the bar at a corner and has a thin tail of its own.
    tail = [[10, 4], [14, 4.001], [14, 4.004]]
    ring = np.array(
        [*bar[:3], *tail[1:2], [14, 4.001], [16, 4.001], [16, 4.002], [14, 4.001], tail[2], *bar[2:]], float
    )
    for k in range(len(ring)):
        left = without_slivers(np.roll(ring, k, axis=0), 0.01)
        assert signed_area(left) == pytest.approx(40) and left[:, 0].max() == 10, k
    blob = [[10, 4], [14, 3], [14, 6]]
    both = np.array([*bar[:3], *blob[1:], *bar[2:]], float)
    assert (without_slivers(both, 0.01) == both).all()
    thin = np.array([[0, 0], [9, 0], [9, 0.001]])
    assert (without_slivers(thin, 0.01) == thin).all(), "there is nothing else"


def test_slivers_that_touch_a_shape_do_not_move_its_axis():
    """Slivers that touch a shape do not pull its axis away from the shape.

    Where slivers touch, their corners are moved apart. Their sides once crossed then, and the axis went on
    outside the shape, several meters away.
    """
    from brushsvg.strokes.skeleton import outline_strokes

    random = np.random.default_rng(1)
    for _ in range(100):
        count = random.integers(2, 8)
        x = np.cumsum([0, 2, *10 ** random.uniform(-3, 0.5, count)])
        joints = np.column_stack([x, 5 + 0.01 * random.normal(size=len(x))])
        half = np.array([0.6, *10 ** random.uniform(-4.5, -2.6, count)])
        middles = 0.5 * (joints[1:] + joints[:-1])
        below, above = (middles + np.outer(side * half, (0, 1)) for side in (-1, 1))
        there = np.stack([below, joints[1:]], axis=1).reshape(-1, 2)
        back = np.stack([above, joints[:-1]], axis=1)[::-1].reshape(-1, 2)
        ring = np.vstack([joints[:1], there, back[:-1]]).round(5)
        for stroke in outline_strokes([ring]):
            points = stroke.middle_mm.reshape(-1, 2)
            assert (np.abs(points - (1, 5)) < 1.1).all()


def test_branches_in_the_middle_of_a_sun_without_nearest_area_are_dropped():
    from brushsvg.strokes.skeleton import outline_strokes

    turn, random = np.linspace(0, 2 * np.pi, 88, endpoint=False), np.random.default_rng(2)
    radius = np.where(np.arange(88) % 2, 24.0, 7.3 + random.uniform(0, 1e-3, 88))
    made = outline_strokes([radius[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])])
    assert len(made) > 40 and all(stroke.target_mm for stroke in made)


def test_strokes_of_random_shapes_cover_the_shape_and_stay_inside_it():
    from brushsvg.strokes.skeleton import outline_strokes

    random = np.random.default_rng(5)
    for _ in range(40):
        bars = []
        for _ in range(random.integers(2, 8)):
            turn, (length, width) = random.uniform(0, np.pi), random.uniform((4, 1), (20, 6))
            corners = np.array([[-length, -width], [length, -width], [length, width], [-length, width]]) / 2
            turned = [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
            bars.append(corners @ turned + random.uniform(0, 20, 2))
        shape = _core.fill(bars)
        made = outline_strokes(shape)
        assert _core.area(target(made)) == pytest.approx(_core.area(shape), rel=0.03)
        assert _core.area(_core.unite([*marks(made), *shape])) < 1.1 * _core.area(shape)
        assert _core.overlap(marks(made), shape) > 0.7


def test_a_corner_of_a_shape_stays_a_corner_of_its_line():
    (ell,) = painted(path("M10 5H16V39H40V45H10Z"))
    line = _core.flatten(ell, 0.001)
    corner = np.hypot(line[:, 0] - 13, line[:, 1] - 8).min()
    assert corner < 0.3
    assert ends(ell) == [[13, 8], [37, 42]]


def test_a_bulge_in_a_line_is_painted_at_full_width():
    """A bulge in the middle of a line is painted at its full width.

    The corner of the bulge leaves a node of the axis there. The width once changed evenly from one arm of the
    node to the other, and the bulge became no wider than its arms.
    """
    body = shapely.union_all(
        [shapely.Point(30, 25).buffer(4), shapely.box(30, 25, 33.6, 28.6), shapely.box(10, 24.2, 50, 25.8)]
    )
    (line,) = painted(path(polygon(body)))
    assert max(half for _, half in line.half_width) == pytest.approx(4, abs=0.1)
    mark = shapely.union_all([shapely.Polygon(ring) for ring in marks([line])])
    want = shapely.union_all([shapely.Polygon(ring) for ring in line.target_mm])
    assert mark.intersection(want).area > 0.95 * want.area


@pytest.mark.parametrize(("turned_deg", "apart_mm"), [(0, 7.8), (12, 7.6), (90, 7.8)])
def test_dots_that_touch_stay_separate_dots(turned_deg, apart_mm):
    """Two squares that overlap at a corner, as in Arabic letters, are two dots.

    They once became a line with a waist and lost their corners.
    """
    square = shapely.affinity.rotate(shapely.box(27, 22, 33, 28), 45)
    pair = square | shapely.affinity.translate(square, apart_mm)
    made = painted(path(polygon(shapely.affinity.rotate(pair, turned_deg))))
    assert len(made) == 2
    for dot in made:
        assert np.ptp(dot.middle_mm.reshape(-1, 2), axis=0).max() == 0
        assert dot.half_width[0][1] == pytest.approx(3, abs=0.01)
        assert _core.area(dot.target_mm) == pytest.approx(pair.area / 2, rel=0.01)
    assert _core.area(_core.intersect(made[0].target_mm, made[1].target_mm)) < 1e-3


@pytest.mark.parametrize("waist_mm", [4.4, 2.4])
def test_a_line_with_a_waist_is_one_line(waist_mm):
    """A line with a waist is one line.

    The waist is hardly narrower than the ends, or it is narrow but long.
    """
    bar = shapely.union_all(
        [
            shapely.Point(25, 25).buffer(3),
            shapely.Point(30 if waist_mm > 3 else 36, 25).buffer(3),
            shapely.box(25, 25 - waist_mm / 2, 30 if waist_mm > 3 else 36, 25 + waist_mm / 2),
        ]
    )
    assert len(painted(path(polygon(bar)))) == 1


def test_a_dot_is_a_dab_and_a_ring_is_closed_and_turns_left_from_the_top():
    (dot,) = painted('<circle id="p" cx="20" cy="20" r="4"/>')
    assert np.ptp(dot.middle_mm) == pytest.approx(10, abs=0.1), "one point, x 20, y 30"
    assert dot.half_width[0][1] == pytest.approx(4, abs=0.05)
    (ring,) = painted(path("M30 5A20 20 0 1 0 30 45A20 20 0 1 0 30 5ZM30 11A14 14 0 1 1 30 39A14 14 0 1 1 30 11Z"))
    start, later = ring.middle_mm[0, :2], _core.flatten(ring, 0.01)[20, :2]
    assert start[1] > 40
    assert later[0] < start[0]


def test_fill_with_stroke_is_the_shape_grown_by_half_the_stroke_width():
    body = path(BAR, 'fill="red" stroke="red" stroke-width="2"')
    (grown,) = painted(body)
    assert {round(half, 2) for _, half in grown.half_width} == {4}
    assert _core.area(grown.target_mm) == pytest.approx(300 + 2 * 56 + np.pi, abs=0.1)
    (line,) = painted(body, paths_as="stroke")
    assert line.closed and line.half_width == ((0.0, 1.0),) and line.target_mm == ()
    (shape,) = painted(body, paths_as="outline")
    assert {round(half, 2) for _, half in shape.half_width} == {3}


def test_a_fill_hidden_by_its_stroke_becomes_a_line():
    (line,) = painted(path("M10 10L30 11L50 10", 'stroke="red" stroke-width="4"'))
    assert line.target_mm == ()
    assert ends(line) == [[10, 10], [50, 10]]
    assert len(painted(path("M10 10L30 30L50 10", 'stroke="red" stroke-width="4"'))[0].target_mm) == 1


def test_hairline_contours_can_be_read_as_shapes():
    contour = path(BAR, 'fill="none" stroke="red" stroke-width=".1"')
    assert painted(contour)[0].half_width == ((0.0, 0.05),)
    (shape,) = painted(contour, paths_as="outline")
    assert {round(half, 2) for _, half in shape.half_width} == {3}


HAIRLINE = 'fill="none" stroke="red" stroke-width=".1"'


def test_a_contour_inside_another_is_its_hole():
    """CAD programs export the counter of an O as a line of its own. It was once painted over."""
    flattening_mm2 = 0.02 * 2 * np.pi * 20
    circles = "".join(f'<circle id="r{r}" cx="60" cy="30" r="{r}" {HAIRLINE}/>' for r in (20, 14, 3))
    made = painted(circles, paths_as="outline")
    assert [stroke.id for stroke in made] == ["r20", "r3"]
    assert _core.area(target(made)) == pytest.approx(np.pi * (20**2 - 14**2 + 3**2), abs=flattening_mm2)
    two_colours = painted(circles.replace('stroke="red"', 'stroke="blue"', 1), paths_as="outline")
    assert _core.area(target(two_colours)) == pytest.approx(np.pi * 20**2, abs=flattening_mm2)


@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_lines_that_meet_end_to_end_are_one_outline(order):
    """Two sides in a row were once painted as a triangle, and single sides were left out."""
    sides = ["M10 20H60", "M60 26V20", "M60 26.005H10", "M10 20V26"]
    body = "".join(path(sides[k], HAIRLINE).replace('"p"', f'"p{k}"') for k in order)
    (shape,) = painted(body, paths_as="outline")
    assert shape.id == f"p{order[0]}"
    assert _core.area(shape.target_mm) == pytest.approx(300, abs=0.5)
    assert len(painted(body, paths_as="stroke")) == 4


def test_lines_with_three_ends_at_one_place_stay_separate():
    sides = ["M10 10H60", "M60 10L30 30", "M60 10V40H20"]
    body = "".join(path(side, HAIRLINE).replace('"p"', f'"p{k}"') for k, side in enumerate(sides))
    assert [stroke.id for stroke in painted(body, paths_as="outline")] == ["p2"]


def test_a_drawing_without_paintable_shapes_is_refused():
    with refused("nothing-to-paint 'no stroke'"):
        painted(path(BAR), paths_as="stroke")
    with refused("nothing-to-paint 'no area'"):
        painted(path("M10 10H50Z"))
    wide = arrange(read(path(BAR, 'fill="red" stroke="none"')), Layout(width_mm=2.0))
    with refused("nothing-to-paint 'no stroke'") as caught:
        strokes(wide, paths_as="stroke")
    assert "for example" not in caught.value.sentence, "a notice about no element is no example"
    _, notices = strokes(read(f'<g fill="red" stroke="none">{path(BAR)}<path id="thin" d="M0 0H5Z"/></g>'))
    assert are_reported(notices, "outline-empty thin")


def test_open_paths_are_closed_and_fill_rules_are_kept():
    (bar,) = painted(path("M10 20H60V26H10"))
    assert _core.area(bar.target_mm) == pytest.approx(300)
    square = "M10 5H50V45H10ZM20 15H40V35H20Z"
    assert _core.area(target(painted(path(square)))) == pytest.approx(1600)
    assert _core.area(target(painted(path(square, 'fill-rule="evenodd"')))) == pytest.approx(1200)


def test_the_same_shape_gives_the_same_strokes():
    d = "M10 5H50V11H33V45H27V11H10Z"
    one, two = (
        [(s.middle_mm.tolist(), s.half_width, [r.tolist() for r in s.target_mm]) for s in painted(path(d))]
        for _ in range(2)
    )
    assert one == two


HOSTILE = {
    "an eight": "M10 5L50 45H10L50 5Z",
    "an edge there and back": "M10 10H50H10V30H12V10Z",
    "the same contour three times": BAR * 3,
    "a needle": "M10 10L50 10.0001L10 10.0002Z",
    "a pixel": "M10 10h.01v.01h-.01Z",
    "pixels in a row": "".join(f"M{10 + k * 0.01:.2f} 10h.01v.01h-.01Z" for k in range(500)),
    "corners that touch": "M10 10H20V20H10ZM20 20H30V30H20Z",
    "a corner on an edge": "M10 10H40V20H10ZM25 20L30 30L20 30Z",
    "a hole that touches": "M10 10H40V40H10ZM10 25L25 15L25 35Z",
    "nested holes": "".join(f"M{k} {k}H{49 - k}V{49 - k}H{k}Z" for k in range(1, 24, 2)),
    "a comb": "M5 5" + "".join("h.2v30h.2v-30" for _ in range(200)) + "v-2H5Z",
    "a loop that folds over itself": "M10 30C60 -20 -10 -20 40 30C70 60 -20 60 10 30Z",
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("rule", ["nonzero", "evenodd"])
def test_hostile_outlines_are_read_or_refused(name, rule):
    design = read(f'<g fill="red" stroke="none" fill-rule="{rule}">{path(HOSTILE[name])}</g>')
    try:
        made, _ = strokes(design)
    except Error as refusal:
        assert refusal.code == "nothing-to-paint"
        return
    for stroke in made:
        assert np.isfinite(stroke.middle_mm).all()
        assert all(np.isfinite(knot).all() and knot[1] >= 0 for knot in stroke.half_width)
        assert stroke.target_mm
    from brushsvg.strokes.skeleton import filled_rings

    shape = filled_rings(design.elements[0])
    assert _core.area(target(made)) == pytest.approx(_core.area(shape), rel=0.02, abs=1e-3)
    if name not in ("an eight", "a loop that folds over itself", "nested holes", "a hole that touches"):
        assert _core.area(_core.unite([*marks(made), *shape])) < 1.1 * _core.area(shape) + 1e-3, "no paint outside"


def test_scribbles_that_are_too_complex_are_left_out_with_a_warning():
    points = np.random.default_rng(1).uniform(0, 50, (1000, 2)).round(2)
    scribble = "M" + "L".join(f"{x} {y}" for x, y in points) + "Z"
    design = read(f'<g fill="red" stroke="none">{path(scribble)}<path id="bar" d="{BAR}"/></g>')
    made, (notice,) = strokes(design)
    assert [stroke.id for stroke in made] == ["bar"]
    assert agrees(notice, "outline-too-complex 10000", "p")
    with refused("nothing-to-paint"):
        painted(path(scribble))


def nested(count: int) -> str:
    return "".join(f"M{k / 200} {k / 200}H{50 - k / 200}V{50 - k / 200}H{k / 200}Z" for k in range(count))


def zigzag(count: int) -> np.ndarray:
    k = np.arange(count)
    return np.column_stack([100 * k / count, 30 * (k % 2)])


def test_outlines_that_are_too_dense_are_left_out_with_a_warning():
    with refused("nothing-to-paint 4.5e+07 3e+07"):
        painted(path(nested(3000), 'fill-rule="evenodd"'))


def test_shapes_of_more_lines_than_any_page_are_refused():
    from brushsvg.strokes.skeleton import outline_strokes

    there = zigzag(10_100)
    with refused("outline-too-complex 20197 20000"):
        outline_strokes([np.vstack([there, np.add(there[::-1], (0, 0.2))])])


def test_parallel_edges_are_counted_in_bands():
    from brushsvg.strokes.skeleton.fill_rule import _count_compared_pairs

    def pairs(ring):
        ring = np.asarray(ring, float)
        both = np.array([ring, np.roll(ring, -1, axis=0)])
        low, high = both.min(axis=0), both.max(axis=0)
        order = np.argsort(low[:, 0])
        return _count_compared_pairs(low[order], high[order])

    teeth = zigzag(20_000)
    tilted = np.column_stack([teeth[:, 0], teeth[:, 1] + teeth[:, 0] / 10])
    assert pairs(tilted) < 1e5, "side by side, none above another"
    # All edges reach up to a line, and only one edge is above it. The edges are skipped one by one.
    assert pairs([*teeth, [100, 40], [0, 40]]) == pytest.approx(0.04 * 20_000**2 / 2, rel=0.02)
    angle = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
    assert pairs(np.column_stack([np.cos(angle), np.sin(angle)])) < 20_000 * 300
    level = np.array([[0, 1], [100, 0]] * 1000) + [[0, k // 2] for k in range(2000)]
    assert pairs(level) < 2000 * 300, "one above another, in bands"
    assert pairs(level * [1, 1e-3] + [[0, 10 * (k % 2)] for k in range(2000)]) > 1e6, "no bands"


def test_clearance_is_the_distance_from_the_outline_inside_and_out():
    import shapely

    random = np.random.default_rng(3)
    angle = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    star = (10 + 4 * np.sin(7 * angle))[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    rings = [star, np.array([[0, 0], [0, 1], [1, 1.0]])]
    points = random.uniform(-20, 20, (200, 2))
    lines = shapely.union_all([shapely.LinearRing(ring) for ring in rings])
    assert _core.clearance(rings, points) == pytest.approx(lines.distance(shapely.points(points)))


@pytest.mark.slow
@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_rings_with_invalid_numbers_are_refused(number):
    ring = np.array([[0, 0], [5, 0], [5, number], [0, 5.0]])
    for ask in (_core.area, _core.unite, _core.fill, lambda rings: _core.medial_axis(rings, 0.1)):
        with refused("geometry-out-of-range"):
            ask([ring])


@pytest.mark.thorough
def test_an_outline_of_a_hundred_thousand_vertices_is_read():
    angle = np.linspace(0, 2 * np.pi, 100_000, endpoint=False)
    ring = np.column_stack([30 + (20 + 0.01 * np.sin(900 * angle)) * np.cos(angle), 25 + 20 * np.sin(angle)])
    from brushsvg.strokes.skeleton import outline_strokes

    made = outline_strokes(_core.fill([ring], "nonzero"))
    assert len(made) == 1
