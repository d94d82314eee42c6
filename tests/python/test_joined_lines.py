"""Lines that meet end to end are painted as one line."""

import re

import numpy as np
import pytest
from svg_text import read

from brushsvg import _core
from brushsvg.__main__ import main
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.joining import join_lines, report_unjoined_lines

LINE = 'fill="none" stroke="black" stroke-width="4"'


def of(*lines: str, rest: str = LINE) -> list:
    return strokes(read("".join(f'<path id="{chr(97 + k)}" d="{d}" {rest}/>' for k, d in enumerate(lines))))[0]


def ends(stroke) -> list:
    return [*stroke.middle_mm[0, :2].round(6).tolist(), *stroke.middle_mm[-1, 6:].round(6).tolist()]


def length_mm(stroke) -> float:
    return _core.flatten(stroke, 0.01)[-1, 2]


def test_four_lines_of_a_rectangle_become_a_closed_line():
    made, notices = join_lines(of("M10 10H40", "M40 10V40", "M10 40H40", "M10 40V10"))
    assert [(stroke.id, stroke.closed) for stroke in made] == [("a", True)]
    assert length_mm(made[0]) == pytest.approx(120, abs=1e-6)
    assert ends(made[0])[:2] == ends(made[0])[2:]
    (notice,) = notices
    assert (notice.where, notice.code) == ("a", "lines-joined")
    assert all(name in notice.sentence for name in "bcd")


def test_a_line_keeps_its_direction_and_is_extended_at_its_start():
    made, _ = join_lines(of("M40 30H60", "M20 30H40", "M80 40L60 30"))
    assert [stroke.id for stroke in made] == ["a"]
    (sheet,) = {ends(stroke)[1] for stroke in of("M0 30H9")}
    assert ends(made[0]) == [20, sheet, 80, sheet - 10]
    steps = np.diff(_core.flatten(made[0], 0.01)[:, 0])
    assert (steps > 0).all()


def test_the_straightest_continuation_is_joined_and_no_line_reverses():
    made, _ = join_lines(of("M10 30H40", "M40 30L70 50", "M40 30H70", "M10 31H40.5", "M40.5 31L12 33"))
    assert [stroke.id for stroke in made] == ["a", "b", "d", "e"]
    assert ends(made[0])[2] == 70
    assert length_mm(made[0]) == pytest.approx(60)


@pytest.mark.parametrize(
    "other",
    [
        '<path id="b" d="M40 30H70" fill="none" stroke="red" stroke-width="4"/>',
        '<path id="b" d="M40 30H70" fill="none" stroke="black" stroke-width="5"/>',
        '<path id="b" d="M40.02 30H70" fill="none" stroke="black" stroke-width="4"/>',
        '<path id="b" d="M40 30H70" fill="none" stroke="black" stroke-width="4" data-brushsvg-speed="7"/>',
        '<path id="b" d="M40 30H70V34H40Z" fill="black"/>',
    ],
)
def test_lines_of_different_kinds_are_not_joined(other):
    made = strokes(read(f'<path id="a" d="M10 30H40" {LINE}/>{other}'))[0]
    assert join_lines(made) == (made, [])


def test_a_stroke_without_a_line_is_not_joined():
    made = [_core.Stroke()]
    assert join_lines(made) == (made, [])


def test_widths_are_continuous_at_the_joint():
    first, second = of("M10 30H40", "M50 30H40")
    first.half_width = [(0.0, 1.0), (1.0, 2.0)]
    second.half_width = [(0.0, 3.0), (0.5, 2.0), (1.0, 2.0)]
    ((both,), _) = join_lines([first, second])
    at, half = np.array(both.half_width).T
    assert np.interp([0, 30, 35, 40], at * 40, half) == pytest.approx([1, 2, 2, 3])


def test_lines_are_joined_only_on_request_and_check_accepts_it(tmp_path, capsys):
    paths = f'<path id="a" d="M10 30H40" {LINE}/><path id="b" d="M40 30L70 40" {LINE}/>'
    drawing, program = tmp_path / "two.svg", tmp_path / "two.ngc"
    drawing.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="60mm" viewBox="0 0 80 60">{paths}</svg>'
    )
    for flags, count in (([], 2), (["--join"], 1)):
        assert main(["convert", str(drawing), "-o", str(program), *flags]) == 0
        assert re.search(rf"; {count}\b", capsys.readouterr().err)
        assert main(["check", str(program), str(drawing), *flags]) == 0
    assert main(["check", str(program), str(drawing)]) == 1


@pytest.mark.parametrize(
    ("lines", "is_reported"),
    [
        ([f"M{x} 10h1" for x in range(9)], True),
        (["M10 10H40", "M40 10V40", "M10 40H40", "M10 40V10"], True),
        (["M10 10V40", "M10 40H30"], False),  # an L
        (["M10 40L20 10", "M20 10L30 40", "M14 30h12"], False),  # an A
        (["M10 10H40"] * 5, False),
        (["M10 10V40", "M40 10H60V30H40z", "M60 60H80V30H60z"], False),
    ],
)
def test_lines_that_a_program_broke_up_are_reported(lines, is_reported):
    codes = [notice.code for notice in report_unjoined_lines(of(*lines))]
    assert codes == ["lines-meet"] * is_reported


@pytest.mark.parametrize(("options", "is_reported"), [([], True), (["--join"], False)])
def test_joined_lines_are_not_reported(tmp_path, capsys, options, is_reported):
    drawing = tmp_path / "line.svg"
    parts = "".join(f'<path d="M{x} 20h2" {LINE}/>' for x in range(10, 50, 2))
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="99mm" height="99mm" viewBox="0 0 99 99">'
    drawing.write_text(f"{svg}{parts}</svg>")
    assert main(["convert", str(drawing), *options, "-o", str(tmp_path / "o.ngc")]) == 0
    assert ("--join" in "".join(capsys.readouterr())) == is_reported
