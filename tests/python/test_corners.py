"""Corners of drawn lines: where closed lines begin and where the brush lifts."""

import itertools
import re

import numpy as np
import pytest
from svg_text import read

from brushsvg import _core, find_brush
from brushsvg.__main__ import main
from brushsvg.strokes import corners
from brushsvg.strokes.corners import lifted_at_corners
from brushsvg.strokes.extraction import strokes

LINE = 'fill="none" stroke="black" stroke-width="4"'
RECT = "M15 15H55V45H15Z"
STAR = "M50 2L55 16H70L58 25L62 40L50 31L38 40L42 25L30 16H45Z"
APEX = "M25 50L40 12L55 50"


def of(d: str, rest: str = LINE) -> list:
    return strokes(read(f'<path id="p" d="{d}" {rest}/>'))[0]


@pytest.fixture
def brush():
    return find_brush("round-6")


def marks_of(some: list, brush):
    marks = _core.simulate(_core.compensate(some, brush, (100, 60)).plan, brush)
    _core.trace_outlines(marks, brush)
    return marks.outline_mm


def length_mm(stroke) -> float:
    return _core.flatten(stroke, 0.01)[-1, 2]


def test_a_closed_line_starts_in_the_middle_of_its_longest_side_without_a_thorn(brush):
    (made,) = of(RECT)
    start = made.middle_mm[0, :2]
    assert start == pytest.approx([35, 35], abs=1e-9) or start == pytest.approx([35, 5], abs=1e-9)
    assert made.middle_mm[-1, 6:] == pytest.approx(start, abs=1e-12)
    assert length_mm(made) == pytest.approx(140, abs=1e-6)
    target = _core.target_outline(made, 0.01)
    points = np.concatenate(marks_of([made], brush))
    box = np.concatenate(target)
    beyond = np.maximum(box.min(axis=0) - points.min(axis=0), points.max(axis=0) - box.max(axis=0))
    assert beyond.max() < 0.3  # it was 1.7 once


@pytest.mark.parametrize(
    "d", ["M10 30a20 20 0 1 0 40 0a20 20 0 1 0 -40 0Z", "M10 10C40 10 40 50 10 50C30 40 30 20 10 10Z"]
)
def test_closed_lines_without_a_corner_at_the_start_or_a_straight_side_start_as_drawn(d):
    (made,) = of(d)
    assert made.middle_mm[0, 0] == pytest.approx(10, abs=1e-9)


def test_widths_stay_at_their_points_if_a_line_starts_elsewhere():
    from brushsvg.strokes.corners import begin_amid_side

    corners = np.array([[0, 0], [30, 0], [30, 10], [0, 10], [0, 0]], float)
    cubics = np.stack([corners[:-1] + k / 3 * np.diff(corners, axis=0) for k in range(4)], axis=1)
    begun, widths = begin_amid_side(cubics, [(0.0, 1.0), (0.5, 3.0), (1.0, 1.0)])
    assert begun[0, 0] == pytest.approx([15, 0])
    at, half = np.array(widths).T
    assert (np.diff(at) >= 0).all()
    assert (at[0], at[-1]) == (0, 1)
    # 15, 45 and 65 mm along the old line of 80 mm are 0, 30 and 50 mm along the new one
    assert np.interp(np.array([0, 30, 50, 65, 80]) / 80, at, half) == pytest.approx([1.75, 2.75, 1.75, 1.0, 1.75])


@pytest.mark.parametrize(("d", "count"), [(STAR, 5), (APEX, 2), ("M35 5H60L35 20H60", 3)])
def test_the_brush_lifts_at_sharp_corners_where_a_turn_would_leave_a_blot(brush, d, count):
    made = of(d)
    parts = lifted_at_corners(made, brush)
    assert [part.id for part in parts] == ["p", *(f"p~{k}" for k in range(2, count + 1))]
    assert sum(map(length_mm, parts)) == pytest.approx(length_mm(made[0]), abs=1e-6)
    assert all(a.middle_mm[-1, 6:] == pytest.approx(b.middle_mm[0, :2]) for a, b in itertools.pairwise(parts))
    target = _core.target_outline(made[0], 0.01)
    turned, lifted = (_core.overlap(marks_of(some, brush), target) for some in (made, parts))
    assert lifted > turned + 0.004


@pytest.mark.parametrize("d", [RECT, "M10 10L40 10L60 30L90 30", "M10 30C30 0 60 0 90 30"])
def test_the_brush_turns_in_place_where_a_lift_is_no_better(brush, d):
    made = of(d)
    assert lifted_at_corners(made, brush) == made


def test_pens_without_lag_and_letter_strokes_are_not_lifted_at_corners(brush):
    made = of(APEX)
    assert lifted_at_corners(made, find_brush("rigid")) == made
    letter = of("M10 10H15L35 50H30Z", 'fill="black" stroke="none"')
    assert lifted_at_corners(letter, brush) == letter


def test_parts_keep_the_widths_of_their_line(brush):
    stroke = of(APEX)[0]
    stroke.half_width = [(0.0, 1.0), (0.25, 2.0), (1.0, 3.0)]
    first, second = lifted_at_corners([stroke], brush)
    there = 2 + 1 / 3
    assert np.array(first.half_width) == pytest.approx(np.array([(0, 1), (0.5, 2), (1, there)]))
    assert np.array(second.half_width) == pytest.approx(np.array([(0, there), (1, 3)]))


@pytest.mark.parametrize(("flags", "count"), [([], 2), (["--corners", "turn"], 1), (["--compensation", "none"], 1)])
def test_corners_can_be_chosen_and_check_accepts_them(tmp_path, capsys, flags, count):
    drawing = tmp_path / "apex.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="60mm" viewBox="0 0 80 60">'
        f'<path id="p" d="{APEX}" {LINE}/></svg>'
    )
    program = tmp_path / "apex.ngc"
    assert main(["convert", str(drawing), "-o", str(program), "--lenient", *flags]) == 0
    assert re.search(rf"; {count}\b", capsys.readouterr().err)
    assert main(["check", str(program), str(drawing), *(flags if flags[:1] == ["--corners"] else [])]) == 0


def test_a_zigzag_finer_than_its_width_is_not_lifted_or_tried(brush, monkeypatch):
    """A zigzag finer than its width is not lifted, and no lift is tried.

    Five hundred corners once took half a minute.
    """
    zigzag = "M10 30" + "".join(f"L{10.4 + 0.4 * k:.1f} {30 + 3 * (k % 2)}" for k in range(60))
    (made,) = of(zigzag)
    monkeypatch.setattr(corners, "_is_better_lifted", None)
    assert lifted_at_corners([made], brush) == [made]


def test_strokes_without_width_or_length_stay_unchanged(brush):
    (made,) = of(APEX)
    made.half_width = []
    assert lifted_at_corners([made], brush) == [made]
    still = _core.Stroke("s", np.full((3, 8), 5.0), half_width=[(0.0, 1.0)])
    assert lifted_at_corners([still], brush) == [still]


def test_parts_of_two_lines_have_different_names(brush):
    drawn = strokes(read(f'<path id="a~2" d="{APEX}" {LINE}/><path id="a" d="{APEX}" {LINE}/>'))[0]
    names = [stroke.id for stroke in lifted_at_corners(drawn, brush)]
    assert len(names) == 4 and len(set(names)) == 4, names
