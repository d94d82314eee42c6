"""G-code as plotter owners write it is read as the lines that were intended.

There are many styles, with four drawings each.
"""

import math
import random

import numpy as np
import pytest
import shapely
from diagnostics import agrees, in_json, is_reported, refused

from brushsvg.read import ReadOptions
from brushsvg.read.gcode import read_gcode

MARK_MM = 1.0


def drawing(chance):
    """Return the lines (n, 2) of a small sketch, away from the pots on the left."""
    lines = []
    for _ in range(chance.randint(3, 9)):
        x, y, turn = chance.uniform(40, 150), chance.uniform(20, 120), chance.uniform(0, math.tau)
        count, step = chance.randint(1, 24), chance.uniform(2, 9)
        bend = chance.uniform(-0.3, 0.3)
        points = [(x, y)]
        for k in range(count):
            x, y = x + step * math.cos(turn + bend * k), y + step * math.sin(turn + bend * k)
            points.append((x, y))
        lines.append(np.round(np.maximum(points, (30, 2)), 3))
    return lines


def at(point, before="G1", after=""):
    return f"{before} X{point[0]:g} Y{point[1]:g}{after}"


def by_z(lines, up, down, travel="G0", draw="G1", head=("G21", "G90"), hop=None, dip=None):
    """Yield a program with the pen on Z.

    up and down are the heights of the pen, hop is the height between strokes that are near, and dip yields
    lines before each stroke.
    """
    yield from head
    yield f"G0 Z{up:g}"
    for k, line in enumerate(lines):
        if dip:
            yield from dip(k)
        yield at(line[0], travel)
        yield f"{draw} Z{down:g} F800"
        yield from (at(point, draw, " F1500" if n == 0 else "") for n, point in enumerate(line[1:]))
        yield f"{travel} Z{(hop if hop is not None and k + 1 < len(lines) else up):g}"
    yield f"G0 Z{up:g}"
    yield "M2"


def by_servo(lines, up, down, travel="G0", off=False):
    yield from ("G21", "G90", f"M3 S{up:g}" if not off else "M5", "G4 P0.2")
    for line in lines:
        yield at(line[0], travel, " F3000")
        yield f"M3 S{down:g}"
        yield "G4 P0.15"
        yield from (at(point, "G1", " F1500") for point in line[1:])
        yield "M5" if off else f"M3 S{up:g}"
    yield from ("M5", "M2")


def inverted(lines, travel="G0"):
    """Return a program with the pen up at Z0 and down at Z5."""
    return by_z(lines, 0, 5, travel=travel)


def parked(lines, up, down):
    """Yield a program that begins and ends at z 0, where the pen is up."""
    yield from ("G21", "G90", "G1 X0 Y0 Z0 F3000")
    for line in lines:
        yield from (f"G1 Z{up:g}", at(line[0]), f"G1 Z{down:g} F800")
        yield from (at(point) for point in line[1:])
    yield from (f"G1 Z{up:g}", "G1 X0 Y0", "G1 Z0", "M2")


def pot(comment):
    def dip(k):
        if comment:
            yield f"; --- Dip Cycle {k} ---"
        yield from ("G0 X5 Y5", "G1 Z0 F800", "G1 X8 Y5", "G1 X5 Y8", "G1 X5 Y5", "G0 Z10")
        if comment:
            yield "; --- End Dip ---"

    return dip


def with_backlash_hops(lines):
    """Yield a program whose pen hops a little in the middle of each line.

    The hops counter backlash, and the line goes on after each hop.
    """
    yield from ("G21", "G90", "G0 Z5")
    for line in lines:
        yield at(line[0], "G0")
        yield "G1 Z0 F800"
        for n, point in enumerate(line[1:]):
            if n == len(line) // 2:
                yield from ("G1 Z1", at(line[n] + (0.2, 0), "G1"), at(line[n], "G1"), "G1 Z0")
            yield at(point, "G1", " F1500")
        yield "G0 Z5"
    yield "M2"


def pressed(lines, chance):
    """Yield a program of a brush whose depth changes along its strokes."""
    yield from ("G21", "G90", "G0 Z6")
    for line in lines:
        yield at(line[0], "G0")
        yield "G1 Z-0.5 F600"
        for point in line[1:]:
            yield at(point, "G1", f" Z{-chance.uniform(0.3, 3):.2f} F1200")
        yield "G0 Z6"
    yield "M30"


HEADER = (
    "\ufeffO1000 (a word)|$H|G21 G90 G94|G10 L20 P1 X0 Y0 Z0|G43 H1|G53 G0 Z0|G64 P0.05|M300 S440 P100|"
    "M0 load the brush|X0 Y0"
)
SPINDLE = ("G00 G17 G40 G21 G54", "G90", "M3 S800", "M8")
STYLES = {
    "z 0 paints": lambda lines, chance: by_z(lines, 5, 0),
    "z 0 paints, up 2": lambda lines, chance: by_z(lines, 2, 0),
    "below 0 paints": lambda lines, chance: by_z(lines, 3, -1.5),
    "rapids paint": lambda lines, chance: by_z(lines, 10, 0, draw="G0"),
    "travel by G1": lambda lines, chance: by_z(lines, 6, 0, travel="G1"),
    "low hops between strokes": lambda lines, chance: by_z(lines, 10, 0, travel="G1", hop=2.5),
    "spindle on all along": lambda lines, chance: by_z(lines, 5, 0, head=SPINDLE),
    "servo rises with S": lambda lines, chance: by_servo(lines, 30, 90),
    "servo falls with S": lambda lines, chance: by_servo(lines, 90, 50, travel="G1"),
    "servo and M5": lambda lines, chance: by_servo(lines, 0, 1000, off=True),
    "dips with comments": lambda lines, chance: by_z(lines, 10, 0, dip=pot(True)),
    "dips without comments": lambda lines, chance: by_z(lines, 10, 0, dip=pot(False)),
    "backlash hops": lambda lines, chance: with_backlash_hops(lines),
    "pressure": pressed,
    "z falls to lift": lambda lines, chance: inverted(lines),
    "z falls to lift, travel by G1": lambda lines, chance: inverted(lines, "G1"),
    "below 0 is up": lambda lines, chance: by_z(lines, -4, 0.5),
    "parked on the paper": lambda lines, chance: parked(lines, 5, 0),
    "parked up, z falls to lift": lambda lines, chance: parked(lines, 0, 5),
    "machine's own lines": lambda lines, chance: by_z(lines, 5, 0, head=HEADER.split("|")),
}
CORPUS = [(style, seed) for style in STYLES for seed in range(4)]


def mark_of(lines):
    return shapely.union_all([shapely.LineString(line).buffer(MARK_MM) for line in lines])


@pytest.mark.parametrize(("style", "seed"), CORPUS)
def test_plotter_programs_are_read_as_intended(style, seed):
    chance = random.Random(f"{style} {seed}")
    lines = drawing(chance)
    text = "\n".join(STYLES[style](lines, chance))
    design = read_gcode(text.encode(), ReadOptions(sheet_mm=(200, 150)))
    found = [np.vstack([s.cubics[:1, 0], s.cubics[:, 3]]) for e in design.elements for s in e.subpaths]
    ours, expected = mark_of(found), mark_of(lines)
    overlap = ours.intersection(expected).area / ours.union(expected).area
    assert overlap >= 0.97, design.notices
    assert len(found) == len(lines)
    assert is_reported(design.notices, "pen-reading")
    dips = [notice for notice in design.notices if notice.code == "dips-left-out"]
    assert bool(dips) == style.startswith("dips") and all(agrees(each, f"dips-left-out {len(lines)}") for each in dips)


def test_the_corpus_has_eighty_programs():
    assert len(CORPUS) == 80


SKETCH = "\n".join(by_z([np.array([(40, 40), (80, 40)]), np.array([(40, 60), (80, 60)])], 5, 0)).encode()


def lines_of(text, **options):
    return len(read_gcode(text, ReadOptions(sheet_mm=(200, 150), **options)).elements)


def test_the_pen_can_be_chosen():
    text = b"G21\nG90\nM5\nG0 Z2\nG0 X10 Y10\nM3 S90\nG1 Z0 F500\nG1 X50 Y10\nG0 Z2\nG1 X50 Y40\nM5\nM2\n"
    assert lines_of(text, pen="z") == 1 and lines_of(text, pen="servo") == 1
    lengths = [
        sum(
            np.abs(np.diff(s.cubics[:, ::3], axis=1)).sum()
            for e in read_gcode(text, ReadOptions(pen=pen)).elements
            for s in e.subpaths
        )
        for pen in ("z", "servo")
    ]
    assert lengths == pytest.approx([40, 70])


def test_the_height_of_the_paper_can_be_given():
    two = b"G21\nG90\nG0 Z8\nG0 X10 Y10\nG1 Z3 F500\nG1 X50 Y10\nG1 Z1\nG1 X50 Y40\nG0 Z8\nM2\n"
    assert lines_of(two, paper_z_mm=3.0) == 1
    (element,) = read_gcode(two, ReadOptions(paper_z_mm=1.0)).elements
    assert np.ptp(element.subpaths[0].cubics.reshape(-1, 2), axis=0) == pytest.approx((0, 30))
    with refused("nothing-to-paint"):
        lines_of(two, paper_z_mm=-5.0)


def test_strokes_can_be_left_out():
    assert lines_of(SKETCH) == 2
    assert lines_of(SKETCH, skip_regions_mm=((30, 30, 100, 50),)) == 1
    commented = SKETCH.replace(b"G0 X40 Y60", b"; palette two\nG0 X40 Y60")
    assert lines_of(commented, skip_comments=("Palette",)) == 1


def test_several_coats_at_one_place_are_not_dips():
    coats = [np.array([(40, 40), (80, 40)])] * 3 + [np.array([(40, 60), (80, 60)])]
    assert lines_of("\n".join(by_z(coats, 5, 0)).encode()) == 4


def test_a_reading_that_loses_most_is_refused():
    """A reading that loses most of the drawing is refused.

    The strokes change height without a lift, so it is unclear which of the two heights draws.
    """
    text = ["G21", "G90", "G0 Z10", "G0 X0 Y0", "G1 Z0 F500", "G1 X10 Y0"]
    text += [f"G1 X{20 + 5 * k} Y{10 * (k % 2)} Z4" for k in range(30)]
    text += [
        "G0 Z10",
        *["G0 X5 Y90", "G1 Z0", "G1 X9 Y90", "G1 Z4", "G1 X30 Y90", "G1 Z0", "G1 X33 Y90", "G0 Z10"] * 3,
    ]
    with refused("pen-unclear"):
        lines_of("\n".join(text).encode())
    assert lines_of("\n".join(text).encode(), paper_z_mm=4.0) >= 1


def test_starting_and_ending_at_z_0_does_not_invert_z():
    """Beginning and ending at z 0 does not invert z.

    All moves are G1 and all strokes single lines, so nothing else shows which height draws. Usually, z 0 is
    paper.
    """
    hatch = [np.array([(40, y), (80, y)]) for y in (40, 50, 60)]
    design = read_gcode("\n".join(parked(hatch, 5, 0)).encode(), ReadOptions(sheet_mm=(200, 150)))
    assert is_reported(design.notices, "pen-reading 0 5")
    inner = [each for each in design.elements if each.subpaths[0].cubics[0, 0, 0] == 40]
    assert [np.ptp(each.subpaths[0].cubics.reshape(-1, 2), axis=0).tolist() for each in inner] == [[40, 0]] * 3


def test_an_inverted_z_axis_is_recognized():
    lines = [np.array([(40, 40), (80, 40), (80, 50)]), np.array([(40, 60), (80, 60)])]
    text = "\n".join(inverted(lines)).encode()
    assert lines_of(text) == lines_of(text, paper_z_mm=5.0) == 2
    with refused("nothing-to-paint"):
        lines_of(text, paper_z_mm=9.0)


def test_check_refuses_an_inverted_z_axis(tmp_path, monkeypatch, capsys):
    """Check refuses a program whose z falls to lift the pen.

    The program draws at z 0.5 and travels at -4. Check once predicted the travel as paint.
    """
    monkeypatch.chdir(tmp_path)
    lines = [np.array([(40, 40), (80, 40)]), np.array([(40, 60), (80, 60)])]
    (tmp_path / "falls.gcode").write_text("\n".join(by_z(lines, -4, 0.5)))
    status, _, reported = in_json(capsys, "check", "falls.gcode")
    assert status == 1 and is_reported(reported, "z-inverted 0.5 -4")
    status, _, reported = in_json(capsys, "convert", "falls.gcode", "-o", "out.ngc", "--width", "3")
    assert status == 0 and is_reported(reported, "pen-reading 0.5 -4")


def test_check_accepts_the_paper_height(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "touches.gcode").write_bytes(SKETCH)
    status, _, reported = in_json(capsys, "check", "touches.gcode")
    assert status == 1 and is_reported(reported, "nothing-painted")
    status, _, reported = in_json(capsys, "check", "touches.gcode", "--paper-z", "2")
    assert status == 0, reported


def test_the_flags_reach_the_reader(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sketch.gcode").write_bytes(SKETCH)
    words = "--width 3 --paper-z 0 --pen z --skip-region 30,30,100,50 --skip-comment nothing".split()
    assert is_reported(in_json(capsys, "convert", "sketch.gcode", "-o", "out.ngc")[2], "gcode-no-width 1 --width")
    status, _, reported = in_json(capsys, "convert", "sketch.gcode", "-o", "out.ngc", *words)
    assert not is_reported(reported, "gcode-no-width"), "they have one"
    assert status == 0 and is_reported(reported, "strokes-skipped 1 2"), reported


def test_words_about_the_drawing_are_not_read_as_dips():
    """Words about the drawing do not count as dips.

    A header, a text and remarks mention dips. Only one stroke, outside the drawing, is a dip.
    """
    lines = [
        [(20, 20), (40, 20)],
        [(20, 30), (60, 60)],
        [(-20, 5), (-18, 5)],
        [(10, 10), (60, 10)],
        [(70, 10), (80, 30)],
    ]
    comments = {0: "(this stroke dips below the baseline)", 2: "(dip)"}
    words = ["G21", "G90", "; file: washington_diploma.svg", '; Text: "brush dip pen"', "G0 Z5"]
    for k, ((x, y), (u, v)) in enumerate(lines):
        words += [comments.get(k, ""), f"G0 X{x} Y{y}", "G1 Z0 F500", f"G1 X{u} Y{v}", "G0 Z5"]
    text = "\n".join([*words, "M2"])
    design = read_gcode(text.encode())
    assert len(design.elements) == 4 and is_reported(design.notices, "dips-left-out 1 19")
    assert len(read_gcode(text.encode(), ReadOptions(skip_comments=("none",))).elements) == 5
