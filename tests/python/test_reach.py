"""Outlines wider than the brush: the nearest width, several passes, or a refusal."""

import numpy as np
import pytest
from svg_text import read

from brushsvg import _core, find_brush
from brushsvg.errors import Error
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.width_limits import within_reach

WIDE = "M10 10H90V26H10Z"  # 16 mm; round-6 paints 8.4
WEDGE = "M10 20L90 12V28Z"


def of(d: str, rest: str = 'fill="red" stroke="none"'):
    return strokes(read(f'<path id="p" d="{d}" {rest}/>'))[0]


@pytest.fixture
def brush():
    return find_brush("round-6")


def painted(made) -> list:
    bare = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in made]
    return _core.unite([ring for stroke in bare for ring in _core.wanted_outline(stroke, 0.01)])


def test_what_is_in_reach_and_what_was_drawn_stays(brush):
    narrow = of("M10 20H60V26H10Z")
    line = of("M10 20H60", 'fill="none" stroke="red" stroke-width="20"')
    for made in (narrow, line):
        assert within_reach(made, brush) == (made, made, [])
    with pytest.raises(Error, match=r"width 20.000 mm is outside"):
        _core.compensate(line, brush, (100, 50))


def test_the_nearest_width_is_painted_and_the_outline_stays_wanted(brush):
    made = of(WEDGE)
    (narrower,), wanted, (notice,) = within_reach(made, brush)
    assert wanted == made
    halves = np.array(narrower.half_width)
    assert halves[:, 1].max() == pytest.approx(4.2)
    assert np.interp(0.2, *halves.T) == pytest.approx(np.interp(0.2, *np.array(made[0].half_width).T))
    assert [r.tolist() for r in narrower.wanted_mm] == [r.tolist() for r in made[0].wanted_mm]
    assert notice.where == "p"
    assert "outside the range [0, 8.4] mm of brush round-6: painted at the nearest" in notice.sentence


def test_passes_cover_the_shape_and_stay_in_it(brush):
    for d in (
        WIDE,
        WEDGE,
        "M30 25A14 14 0 1 1 58 25A14 14 0 1 1 30 25Z",
        "M10 5H60A20 20 0 0 1 60 45V33A8 8 0 0 0 60 17H10Z",
        "M10 4H26V24H60V40H10Z",
        "M10 30Q25 4 50 18T90 15V17Q70 38 48 30T12 32Z",
    ):
        made = of(d)
        passes, wanted, (notice,) = within_reach(made, brush, "passes")
        assert [each.id for each in passes] == ["p", *(f"p~{k}" for k in range(2, len(passes) + 1))]
        assert len(wanted) == len(passes) > 1
        assert f"painted in {len(passes)} passes" in notice.sentence
        assert max(half for each in passes for _, half in each.half_width) <= 4.2 + 1e-9
        shape, paint = made[0].wanted_mm, painted(passes)
        beyond = _core.area(_core.unite([*shape, *paint])) - _core.area(shape)
        assert beyond < 0.006 * _core.area(shape)
        assert _core.overlap(paint, shape) > 0.97, d


def test_refusal_names_stroke_width_and_range(brush):
    with pytest.raises(Error, match=r"width 16 mm .* \[0, 8.4\] mm of brush round-6") as refused:
        within_reach(of(WIDE), brush, "refuse")
    assert (refused.value.where, refused.value.value) == ("p", pytest.approx(16, abs=0.1))


def test_a_pen_of_one_width_is_not_asked(brush):
    made = of(WIDE)
    assert within_reach(made, find_brush("rigid"), "refuse") == (made, made, [])
