"""Programs read back: the plan comes back from every language, and what was broken is named with its line."""

import re

import numpy as np
import pytest

from brushsvg import _core, checking, convert, machine
from brushsvg.cell_file import SHIPPED, find_cell
from brushsvg.cli import main
from brushsvg.errors import Error
from brushsvg.readback import read_program

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">
<title>two</title><g fill="none" stroke="#000" stroke-width="3"><path id="curve" d="M20 50 C40 10 60 10 90 40"/>
<path id="hook (1)" d="M20 60 h30 v-20 h-12"/></g></svg>"""
LANGUAGES = {
    "linuxcnc-3axis": ".ngc",
    "grbl-3axis": ".gcode",
    "grbl-servo": ".nc",
    "ur5e": ".script",
}


@pytest.fixture
def desk(tmp_path, monkeypatch):
    (tmp_path / "two.svg").write_text(DRAWING)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def text_of(work, name, **job):
    cell = machine.as_exact_as(find_cell(name), 0.05)
    text = "".join(machine.encode(LANGUAGES[name], work.plan, work.brush, "two", (), cell, **job))
    return text, cell


def ran(text, cell, work):
    return checking.run(read_program(text, LANGUAGES[cell.name], cell), work.brush, cell, work.plan.sheet_mm)


@pytest.mark.parametrize("name", LANGUAGES)
def test_what_was_planned_comes_back(desk, name):
    work = convert.prepare("two.svg")
    back = ran(*text_of(work, name), work)
    assert back.problems == []
    assert [p.stroke for p in back.plan.passes] == ["curve", "hook (1)" if name == "ur5e" else "hook [1]"]
    for meant, found in zip(work.plan.passes, back.plan.passes, strict=True):
        away = np.linalg.norm(found.poses_mm[None] - meant.poses_mm[:, None], axis=2).min(axis=1)
        assert away.max() < (0.1 if name == "grbl-servo" else 2e-3), "every pose is passed"
        assert found.speed_mm_s == pytest.approx(meant.speed_mm_s, rel=1e-3)
    planned = _core.simulate(work.plan, work.brush)
    for marks in (planned, back.marks):
        _core.trace_outlines(marks, work.brush)
    assert _core.overlap(planned.outline_mm, back.marks.outline_mm) > (
        0.985 if name == "grbl-servo" else 0.998
    )


def edited(old, new, count=1):
    def edit(text):
        assert re.search(old, text), old
        return re.sub(old, new, text, count=count)

    return edit


BROKEN = {
    "a rapid into the paper": (
        edited(r"(?m)^G1 (.* Z0\.0000)", r"G0 \1"),
        "line \\d+: a rapid move while the brush touches",
    ),
    "low travel": (
        edited(r"(?m)^(G0 X2.*) Z10\.0000", r"\1 Z2.0000"),
        "line \\d+: .* at 2.00 mm, below the safe height",
    ),
    "too fast": (edited("F1200.0", "F1600.0"), "speed 26.7 mm/s while the brush touches, limit 25.0 mm/s"),
    "off the sheet": (edited(r"X(\d+)\.(\d+) Y(\d+\.\d+) Z-", r"X1\1.\2 Y\3 Z-", 0), "beyond the right edge"),
    "too deep": (edited(r"Z-\d\.\d+", "Z-11.5"), r"depth 11\.\d+ mm of pose 1 is outside the range"),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_a_dangerous_program_is_told_by_line(desk, fault):
    work = convert.prepare("two.svg")
    text, cell = text_of(work, "linuxcnc-3axis")
    edit, words = BROKEN[fault]
    try:
        told = [sentence for _, sentence in ran(edit(text), cell, work).problems]
    except Error as refusal:
        told = [str(refusal)]
    assert any(re.search(words, sentence) for sentence in told), told


UNREADABLE = {
    "linuxcnc-3axis": [
        (edited("G21", "G20"), "line \\d+: .*not a line that brushsvg writes"),
        (edited("G90 ", ""), "G90 is missing"),
        (edited(r"(?m)^M2$", ""), "M2 is missing"),
        (edited(r"(?m)^M2$", "M2\nG0 Z5"), "stands behind the end"),
        (edited(r"(?m)^G1 X", "G5 X"), "not a line that brushsvg writes"),
        (edited(r"(?m)^F.*\n", "", 0), "has no feed"),
        (edited(r"X(\d+\.\d+) Y", r"X\1 X\1 Y"), "a word twice"),
        (edited(r"\)", ""), "not a line that brushsvg writes"),
        (edited("Z-", "Z-2.7e-17 Z-"), "not a line that brushsvg writes"),
        (lambda text: text + "\u00e9", "not 7-bit text"),
    ],
    "ur5e": [
        (edited("movep", "movej"), "line \\d+: .*not a line that brushsvg writes"),
        (edited(r"(?m)^  paper = .*\n", ""), "the line that sets the paper is missing"),
        (edited(r"brushsvg\(\)\n", ""), "half of the program was lost"),
        (edited(r"on_paper\((\S+), ", r"on_paper(1e3, "), "not a line that brushsvg writes"),
        (edited("  end\n", "  end\n  set_digital_out(1, True)\n"), "not a line that brushsvg writes"),
    ],
}


@pytest.mark.parametrize("name", UNREADABLE)
def test_what_is_not_ours_is_refused(desk, name):
    work = convert.prepare("two.svg")
    text, cell = text_of(work, name)
    for edit, words in UNREADABLE[name]:
        with pytest.raises(Error, match=words):
            ran(edit(text), cell, work)


def call(capsys, *words):
    status = main(list(words))
    told = capsys.readouterr()
    return status, told.out, told.err.splitlines()


def test_the_command_compares_with_the_drawing(desk, capsys):
    assert call(capsys, "convert", "two.svg", "two.ngc", "--z-offset", "0.4")[0] == 0
    status, out, err = call(capsys, "check", "two.ngc", "two.svg", "--preview", "two.png")
    assert (status, err) == (0, [])
    assert re.search(r"(?m)^all +0\.9\d\d ", out)
    assert out.endswith("two.ngc: nothing forbids to run it\n")
    assert (desk / "two.png").exists()
    status, out, _ = call(capsys, "check", "two.ngc")
    assert status == 0 and re.search(r"(?m)^all +- ", out), (
        "without a drawing there is nothing to overlap with"
    )
    (desk / "two.svg").write_text(DRAWING.replace('id="curve"', 'id="arch"'))
    status, out, err = call(capsys, "check", "two.ngc", "two.svg")
    assert status == 1
    assert "brushsvg: two.ngc: curve: the drawing has no such stroke" in err
    assert "brushsvg: two.ngc: arch: the program does not paint this stroke" in err


def test_a_resumed_program_is_no_lost_one(desk, capsys):
    assert call(capsys, "convert", "two.svg", "two.ngc", "--from-stroke", "2")[0] == 0
    assert call(capsys, "check", "two.ngc", "two.svg")[0] == 0


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (edited(r"\(cell: linuxcnc-3axis,", "(cell: my-own,"), "cell 'my-own' is not known"),
        (edited(r"\(title: .*\)\n", ""), "brushsvg did not write this program"),
        (edited(r"\(sheet: .*\)\n", ""), "does not say how large the sheet is"),
    ],
)
def test_a_header_that_does_not_tell_is_refused(desk, capsys, edit, words):
    assert call(capsys, "convert", "two.svg", "two.ngc")[0] == 0
    (desk / "two.ngc").write_text(edit((desk / "two.ngc").read_text()))
    status, _, err = call(capsys, "check", "two.ngc")
    assert status == 1 and words in err[0]


def test_a_program_of_another_language_is_refused(desk, capsys):
    assert call(capsys, "convert", "two.svg", "two.ngc")[0] == 0
    status, _, err = call(capsys, "check", "two.ngc", "--cell", "ur5e")
    assert status == 1 and "cell ur5e speaks URScript for Universal Robots in .script" in err[0]


def test_a_stroke_in_parts_is_one_stroke_of_the_drawing(desk, capsys):
    paint = '[reload]\nwhen = "length"\nevery_mm = 60\n[[stations]]\nname = "ink"\nplace_mm = [-10, 10]\ndepth_mm = 5\n'
    (desk / "painter.toml").write_text((SHIPPED / "linuxcnc-3axis.toml").read_text() + paint)
    assert call(capsys, "convert", "two.svg", "two.ngc", "--cell", "painter.toml")[0] == 0
    assert "curve+2)" in (desk / "two.ngc").read_text()
    status, out, err = call(capsys, "check", "two.ngc", "two.svg", "--cell", "painter.toml")
    assert (status, err) == (0, [])
    assert re.search(r"(?m)^curve\+2 +- ", out)
    assert re.search(r"(?m)^all +0\.9[67]\d ", out)


def without_moves(text: str, first: int, last: int) -> str:
    """The program without some of its straight moves in paint, counted from 0."""
    lines = text.splitlines(keepends=True)
    moves = [number for number, line in enumerate(lines) if line.startswith(("G1 X", "X"))]
    return "".join(line for number, line in enumerate(lines) if number not in moves[first:last])


CHANGED = {
    ".ngc": [
        (edited(r"(?m)^G64.*\n", ""), "for these strokes and this cell brushsvg would write 'G64 P0.0100'"),
        (edited(r"G64 P\S+", "G64 P5.0000"), "would write 'G64 P0.0100'"),
        (edited(r"(?m)^(\(stroke 2.*\n)", r"\1G0 X5000.0000 Y5000.0000 Z10.0000\n"), "line \\d+: 'G0 X5000"),
        (edited(r"(?m)^G0 Z10.*\n", ""), "would write 'G0 Z10.0000'"),
        (edited("F1500.0", "F99999.0"), "would write 'F1500.0'"),
        (edited("F1200.0", "F600.0", 0), "painted at 10.0 mm/s, the drawing asks for 20.0 mm/s"),
        (edited(r"Y(\d)", r"Y1\1", 0), "away from where the drawing asks it to"),
        (
            lambda text: re.sub(r"Z-(\d)\.5", r"Z-\1.6", text),
            "runs 0.10 mm away from where the drawing asks it to",
        ),
        (lambda text: without_moves(text, 3, 8), "mm away from where"),
        (edited("(?m)^G3 ", "G2 "), "away from where the drawing asks it to"),
    ],
    ".script": [
        (edited(r"(?m)^  set_tcp.*\n", ""), "would write 'set_tcp"),
        (edited(r"paper = p\[-0\.15", "paper = p[-0.25"), "would write 'paper = p"),
        (edited("3.1415927", "0.0000000"), "would write 'return pose_trans"),
        (edited("a=0.5000", "a=9.5000"), "for these strokes and this cell"),
        (edited(r"r=0\.0", "r=0.1"), "for these strokes and this cell"),
        (edited(r"(?m)^  if here.*\n.*\n  end\n", ""), "for these strokes and this cell"),
    ],
}


@pytest.mark.parametrize("suffix", CHANGED)
def test_whatever_was_changed_is_told(desk, capsys, suffix):
    """Seen by comparing with the drawing's own plan, and with what would be written for the same strokes."""
    cell = ("--cell", "ur5e") if suffix == ".script" else ()
    drawing = DRAWING.replace("h-12", "h-12 l12 2")  # a corner too sharp for anything but a turn in place
    (desk / "two.svg").write_text(drawing)
    assert call(capsys, "convert", "two.svg", f"two{suffix}", *cell)[0] == 0
    text = (desk / f"two{suffix}").read_text()
    assert call(capsys, "check", f"two{suffix}", "two.svg")[0] == 0
    for edit, words in CHANGED[suffix]:
        (desk / f"two{suffix}").write_text(edit(text))
        status, _, err = call(capsys, "check", f"two{suffix}", "two.svg")
        assert (status, any(re.search(words, line) for line in err)) == (1, True), (words, err)


def test_paint_fetched_otherwise_is_told(desk, capsys):
    paint = '[reload]\nwhen = "stroke"\n[[stations]]\nname = "ink"\nplace_mm = [-10, 10]\ndepth_mm = 5\n'
    (desk / "painter.toml").write_text((SHIPPED / "linuxcnc-3axis.toml").read_text() + paint)
    assert call(capsys, "convert", "two.svg", "two.ngc", "--cell", "painter.toml")[0] == 0
    text = (desk / "two.ngc").read_text()
    parts = re.split(r"(?m)^(?=\((?:paint|stroke))", text)
    (desk / "two.ngc").write_text("".join(part for k, part in enumerate(parts) if k != 3))
    status, _, err = call(capsys, "check", "two.ngc", "two.svg", "--cell", "painter.toml")
    assert status == 1
    assert any("before it the program visits nothing, the cell asks for ink" in line for line in err), err
