"""Outlines wider than the brush: the nearest width, several passes, or a refusal."""

import re

import numpy as np
import pytest
from diagnostics import agrees, refused
from sampling import sample
from searched import mark_of, passes_of
from svg_text import read

from brushsvg import _core, find_brush
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.swept_areas import region
from brushsvg.strokes.wide_shapes import within_reach

WIDE = "M10 10H90V26H10Z"  # 16 mm wide; round-6 paints up to 8.4 mm
WEDGE = "M10 20L90 12V28Z"


def of(d: str, rest: str = 'fill="red" stroke="none"'):
    return strokes(read(f'<path id="p" d="{d}" {rest}/>'))[0]


@pytest.fixture
def brush():
    return find_brush("round-6")


def painted(made) -> list:
    bare = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in made]
    return _core.unite([ring for stroke in bare for ring in _core.target_outline(stroke, 0.01)])


def test_reachable_shapes_and_drawn_lines_stay_unchanged(brush):
    narrow = of("M10 20H60V26H10Z")
    line = of("M10 20H60", 'fill="none" stroke="red" stroke-width="20"')
    for made in (narrow, line):
        assert within_reach(made, brush) == (made, made, [])
    with refused("width-out-of-reach 20.000"):
        _core.compensate(line, brush, (100, 50))


@pytest.mark.parametrize(("width", "is_painted"), [(8.41, True), (8.59, True), (8.7, False)])
def test_a_line_too_wide_by_an_invisible_amount_is_painted(brush, width, is_painted):
    """A line that is too wide by less than the eye can see is painted.

    A brush made for a typed width of 4.8 mm painted 4.791 mm, and a job was refused for one dot of 4.8 mm.
    """
    line = of("M10 20H60", f'fill="none" stroke="red" stroke-width="{width}"')
    (made,), target, notices = within_reach(line, brush)
    assert target == line and not notices
    assert max(half for _, half in made.half_width) == pytest.approx(4.2 if is_painted else width / 2)
    if is_painted:
        _core.compensate([made], brush, (100, 50))


def test_clamp_paints_the_nearest_width_with_the_outline_as_target(brush):
    made = of(WEDGE)
    (narrower,), target, (notice,) = within_reach(made, brush, "clamp")
    assert target == made
    halves = np.array(narrower.half_width)
    assert halves[:, 1].max() == pytest.approx(4.2)
    assert np.interp(0.2, *halves.T) == pytest.approx(np.interp(0.2, *np.array(made[0].half_width).T))
    assert [r.tolist() for r in narrower.target_mm] == [r.tolist() for r in made[0].target_mm]
    widest = 2 * max(half for _, half in made[0].half_width)
    assert agrees(notice, f"width-out-of-reach '{widest:.3g} mm wide' '[0, 8.4] mm' round-6", "p")
    assert re.findall(r"[\d.]+", notice.sentence) == [f"{widest:.3g}", "0", "8.4", "6"], "no count of widths"


def test_passes_cover_the_shape_and_stay_inside_it(brush):
    for d in (
        WIDE,
        WEDGE,
        "M30 25A14 14 0 1 1 58 25A14 14 0 1 1 30 25Z",
        "M10 5H60A20 20 0 0 1 60 45V33A8 8 0 0 0 60 17H10Z",
        "M10 4H26V24H60V40H10Z",
        "M10 30Q25 4 50 18T90 15V17Q70 38 48 30T12 32Z",
    ):
        made = of(d)
        (notice,) = within_reach(made, brush, "passes")[2]
        assert notice.code == "width-out-of-reach"
        passes = passes_of(made, brush)
        assert [each.id for each in passes] == ["p", *(f"p~{k}" for k in range(2, len(passes) + 1))]
        assert len(passes) > 1
        assert max(half for each in passes for _, half in each.half_width) <= 4.2 + 1e-9
        shape, paint = made[0].target_mm, mark_of(passes_of(made, brush), brush)
        beyond = region(paint).difference(region(shape).buffer(0.1))
        assert beyond.area < 0.001 * _core.area(shape)
        assert _core.overlap(paint, shape) > 0.97, d


def test_a_line_thinner_than_the_brush_is_painted_at_the_smallest_width():
    """A line thinner than the brush is painted at the brush's smallest width.

    The whole job was once refused for such a line.
    """
    liner = find_brush("liner-1")  # 1 to 2 mm wide
    for width, is_reported in ((0.9, False), (0.4, True)):
        made = of("M10 20H60", f'fill="none" stroke="red" stroke-width="{width}"')
        (painted_line,), target, notices = within_reach(made, liner)
        assert target == made
        assert [half for _, half in painted_line.half_width] == [0.5]
        assert [agrees(notice, f"width-out-of-reach {width} '[1, 2] mm' nearest", "p") for notice in notices] == (
            [True] * is_reported
        )
        with refused(f"width-out-of-reach {width} '[1, 2] mm'", "p"):
            within_reach(made, liner, "refuse")
    rigid = find_brush("rigid")
    assert within_reach(made, rigid, "passes")[0] == made  # a brush with a single width is not checked


def test_a_sliver_that_is_less_than_half_of_the_smallest_mark_is_left_out():
    liner = find_brush("liner-1")  # its smallest mark has an area of 0.79 mm2
    sliver, dot = "M60 10h0.6v0.6h-0.6z", "M60 10h0.7v0.7h-0.7z"
    made = of(f"M10 20H50V21.5H10Z{sliver}")
    passes, target, (notice,) = within_reach(made, liner)
    assert len(made) == 2 and len(passes) == len(target) == 1
    assert agrees(notice, "width-out-of-reach 0.36 0.79 liner-1", next(s.id for s in made if s != target[0]))
    assert len(within_reach(of(f"M10 20H50V21.5H10Z{dot}"), liner)[0]) == 2
    assert len(within_reach(made, find_brush("round-6"))[0]) == 2  # round-6 has no smallest width
    with refused("nothing-to-paint 0.36", "p"):
        within_reach(of(sliver), liner)
    with refused("width-out-of-reach"):
        within_reach(made, liner, "refuse")


def test_a_refusal_names_stroke_width_and_range(brush):
    with refused("width-out-of-reach 16 '[0, 8.4] mm' round-6", "p") as caught:
        within_reach(of(WIDE), brush, "refuse")
    assert caught.value.value == pytest.approx(16, abs=0.1)


def test_a_pen_of_one_width_is_not_checked(brush):
    made = of(WIDE)
    assert within_reach(made, find_brush("rigid"), "refuse") == (made, made, [])


def overlap(strokes, shape, brush) -> float:
    marks = _core.simulate(_core.compensate(strokes, brush, (200, 200), start="auto", end="auto").plan, brush)
    _core.trace_outlines(marks, brush)
    return _core.overlap(marks.outline_mm, shape)


@pytest.mark.slow
@sample(
    "d",
    [
        *(f"M10 10H90V{10 + wide_mm}H10Z" for wide_mm in (9.0, 10.3, 10.8, 12.0, 24.0)),
        "M44.8 30a5.2 5.2 0 1 0 10.4 0a5.2 5.2 0 1 0 -10.4 0Z",
        "M41 30a9 9 0 1 0 18 0a9 9 0 1 0 -18 0Z",
    ],
    keep=3,
)
def test_a_shape_wider_than_the_brush_is_painted_whole_except_with_clamp(brush, d):
    """A shape wider than the brush is painted whole, except with "clamp".

    Half of a bar of 16 mm was once left blank, and a disc of 9.4 mm became a drop.
    """
    made = of(d)
    shape = made[0].target_mm
    assert _core.overlap(mark_of(passes_of(made, brush), brush), shape) > 0.975
    (narrower,), (expected,), (notice,) = within_reach(made, brush, "clamp")
    assert expected is made[0]
    assert max(half for _, half in narrower.half_width) == pytest.approx(4.2)
    assert notice.code == "width-out-of-reach"


def test_the_stems_of_a_drawing_have_one_weight(brush):
    """All stems of a drawing have one weight.

    In the word h66 in a bold serif, the h was filled with stems 11 mm wide, but the 6 was kept at 8.4 mm.
    """
    for d in ("M10 40H90V49H10Z", "M10 5H90V29H10Z"):
        made = of(d)
        mark = region(mark_of(passes_of(made, brush), brush))
        assert mark.bounds == pytest.approx(region(made[0].target_mm).bounds, abs=0.3)


def test_a_width_hardly_out_of_reach_causes_no_warning(brush):
    """A width that is hardly out of reach causes no warning.

    Nine strokes of a word were once reported for a width of 8.45 mm instead of 8.4.
    """
    for wide_mm, is_reported in ((8.45, False), (8.55, False), (8.7, True)):
        painted, _, notices = within_reach(of(f"M10 10H90V{10 + wide_mm}H10Z"), brush)
        assert bool(notices) == is_reported
        assert max(half for _, half in painted[0].half_width) <= 4.2
    with refused("width-out-of-reach"):
        within_reach(of("M10 10H90V18.45H10Z"), brush, "refuse")


def test_an_arm_hardly_too_wide_causes_no_passes_in_other_letters(brush):
    """An arm that is hardly too wide does not cause passes in other letters.

    The trial of a letter with this arm was once refused and not counted, and all other letters were filled.
    """
    arm, bar = "M10 10H90V18.45H54.8V60H44.2V18.45H10Z", "M10 70H90V80.4H10Z"
    bare = 'fill="red" stroke="none"'
    both = strokes(read(f'<path id="arm" d="{arm}" {bare}/><path id="bar" d="{bar}" {bare}/>'))[0]
    _, _, notices = within_reach(both, brush)
    reported = [each.text for each in notices]
    assert any("would overlap" in each for each in reported) or not any("as others" in each for each in reported)
