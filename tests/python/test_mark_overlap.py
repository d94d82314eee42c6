"""Overlaps measured in pixels agree with shapes whose answer is known."""

import numpy as np
import pytest

from brushsvg import Error, Stroke, _core, compensate, find_brush, simulate, trace_outlines


def box(x0, y0, x1, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], float)


def straight(name, a, b, half):
    a, b = np.array(a, float), np.array(b, float)
    return Stroke(
        name,
        np.concatenate([a, a + (b - a) / 3, a + 2 * (b - a) / 3, b])[None],
        half_width=[(0, half), (1, half)],
    )


def test_groups_contain_the_marks_that_touch():
    strokes = [
        straight("a", (0, 0), (20, 0), 1.0),
        straight("b", (10, 5), (10, 1.9), 1.0),
        # The box of "near" meets the box of a, but the marks are 0.3 mm apart.
        straight("near", (0, 2.3), (5, 2.3), 0.99),
        straight("c", (10, 6), (30, 30), 1.0),
        straight("diagonal", (28, 8), (40, 20), 1.0),  # inside the box of c
    ]
    assert _core.group_touching(strokes) == [[0, 1, 3]]
    halves = [straight("left", (0, 40), (5, 40), 1), straight("right", (9, 40), (15, 40), 1)]
    assert _core.group_touching(halves) == []
    halves[0].target_mm, halves[1].target_mm = (
        [box(0, 38, 7, 42)],
        [box(7, 38, 15, 42)],
    )  # both are parts of one letter
    assert _core.group_touching(halves) == [[0, 1]]


def test_pixels_agree_with_rings():
    """Pixels agree with rings, with and without tiles.

    The test uses one drawing that needs tiles and one that does not.
    """
    brush = find_brush("round-6")
    rng = np.random.default_rng(3)
    strokes = [
        straight(f"s{k}", rng.uniform(20, 580, 2), rng.uniform(20, 580, 2), float(half))
        for k, half in enumerate(rng.uniform(0.3, 4.0, 12))
    ]
    marks = simulate(compensate(strokes, brush, (600, 600)).plan, brush)
    trace_outlines(marks, brush)
    for some in (slice(0, 1), slice(0, 12)):
        painted = _core.unite([ring for trace in marks.passes[some] for ring in trace.outline_mm])
        target = _core.unite([ring for s in strokes[some] for ring in _core.target_outline(s, 0.01)])
        found = _core.common_area(marks.passes[some], strokes[some], brush)
        assert found.overlap == pytest.approx(_core.overlap(painted, target), abs=1e-3)
        assert found.union_mm2 == pytest.approx(_core.area(_core.unite([*painted, *target])), rel=1e-3)


def test_groups_have_the_same_overlap_alone_and_together():
    brush = find_brush("round-6")
    strokes = [straight(f"s{k}", (10, 10 + 9 * k), (40, 12 + 6 * k), 1.0 + 0.2 * k) for k in range(5)]
    marks = simulate(compensate(strokes, brush, (100, 100)).plan, brush).passes
    groups = [[0, 1], [2], [1, 4, 3], []]
    found = _core.common_areas(marks, strokes, groups, brush)
    alone = [_core.common_area([marks[k] for k in some], [strokes[k] for k in some], brush) for some in groups]
    assert found == alone
    assert len({area.overlap for area in found}) == 4
    with pytest.raises(Error) as reported:
        _core.common_areas(marks, strokes, [[0], [1, 5]], brush)
    assert reported.value.code == "out-of-range"


def test_tracking_errors_belong_to_their_pass():
    brush = find_brush("round-6")
    strokes = [straight(f"s{k}", (10, 10 + 9 * k), (40, 12 + 6 * k), 1.0 + 0.2 * k) for k in range(3)]
    passes = compensate(strokes, brush, (100, 100)).plan.passes
    passes[1].poses_mm = passes[1].poses_mm + np.array([0, 0.4, 0])
    found = _core.tracking_errors_of(passes, strokes, brush, 0.2)
    pairs = zip(passes, strokes, strict=True)
    assert found == [_core.tracking_error_of(one, stroke, brush, 0.2) for one, stroke in pairs]
    assert [miss.within_tolerance for miss in found] == [True, False, True]
    with pytest.raises(Error) as reported:
        _core.tracking_errors_of(passes, strokes[:2], brush)
    assert reported.value.code == "sizes-differ"
