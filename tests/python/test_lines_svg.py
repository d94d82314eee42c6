"""Strokes that are written as lines with a width are read back unchanged."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from diagnostics import are_reported, gives, in_json, is_reported
from svg_text import HEAD, read

from brushsvg import strokes
from brushsvg.cli import main
from brushsvg.read import settings_in
from brushsvg.read.svg import read_svg
from brushsvg.show.editable_svg import WIDTH_TOLERANCE, lines_svg

SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
# A curved wedge, a bar of one width, a swelling ring, and a dot.
WEDGE = '<path id="wedge" d="M10 10C30 10 40 20 60 40L56 43C40 26 30 12 10 12Z" fill="#203060" stroke="none"/>'
BAR = '<path id="bar" d="M10 40H50V44H10Z" fill="#203060" stroke="none"/>'
RING = (
    '<path id="ring" d="M70 20A15 15 0 1 0 100 20A15 15 0 1 0 70 20ZM73 20A10 12 0 1 1 93 20A10 12 0 1 1 73 20Z" '
    'fill="red" stroke="none" fill-rule="evenodd" transform="translate(-4 4)"/>'
)
DOT = '<circle id="dot" cx="50" cy="10" r="2" fill="red" stroke="none"/>'
LINE = '<path id="line" d="M60 45H80" stroke-width="2.5"/>'


def again(body):
    before, _ = strokes(read(body))
    text = lines_svg(before, (100.0, 50.0), "a & b")
    design = read_svg(text.encode())
    assert not design.notices
    return before, strokes(design)[0], ET.fromstring(text)


def width_mm(stroke, at):
    return 2 * np.interp(at, *np.array(stroke.half_width).T)


@pytest.mark.parametrize("body", [WEDGE, BAR, RING, DOT, LINE, WEDGE + BAR + RING + DOT + LINE])
def test_written_strokes_are_read_back_unchanged(body):
    before, after, _ = again(body)
    assert len(before) == len(after) > 0
    at = np.linspace(0, 1, 201)
    for a, b in zip(before, after, strict=True):
        assert np.abs(a.middle_mm - b.middle_mm).max() < 1e-3
        assert (a.closed, a.colour, a.layer) == (b.closed, b.colour, b.layer)
        assert np.abs(width_mm(a, at) - width_mm(b, at)).max() < WIDTH_TOLERANCE * width_mm(a, at).max()


def test_a_constant_width_is_a_stroke_width_and_a_varying_one_a_power_stroke():
    _, _, root = again(WEDGE + LINE)
    wedge, line = root.iter(f"{SVG}path")
    assert "stroke-width:2.5;" in line.get("style") and line.get(f"{INKSCAPE}original-d") is None
    assert wedge.get(f"{INKSCAPE}path-effect") == "#width-wedge" and wedge.get("data-outline") == "yes"
    points = root.find(f".//{INKSCAPE}path-effect").get("offset_points").split(" | ")
    assert 2 <= len(points) < 15
    assert line.get("data-outline") is None


def test_layers_settings_and_odd_ids_are_kept():
    body = (
        '<g inkscape:groupmode="layer" inkscape:label="A &lt; B"><path id="a/b" d="M10 10H30" data-brushsvg-passes="2" '
        'data-brushsvg-speed="7" data-brushsvg-reload="yes"/><path id="a#b" d="M10 20H30"/></g>' + LINE
    )
    before, after, root = again(body)
    assert [stroke.layer for stroke in after] == [stroke.layer for stroke in before] == ["A < B"] * 3 + [""]
    assert [stroke.settings for stroke in after] == [stroke.settings for stroke in before]
    assert [path.get("id") for path in root.iter(f"{SVG}path")] == ["a-b", "a-b-2", "line"]
    assert [path.get("data-stroke") for path in root.iter(f"{SVG}path")] == ["a/b", "a#b", "line"]


def test_a_name_that_looks_like_a_repeat_is_not_a_repeat():
    """A name that looks like a repeat is not treated as a repeat.

    An element with the name a#2 that is painted twice was once left out with its repeats.
    """
    _, _, root = again('<path id="a#2" d="M10 10H30" data-brushsvg-passes="2"/>' + LINE)
    assert [path.get("data-stroke") for path in root.iter(f"{SVG}path")] == ["a#2", "line"]


def test_preview_writes_editable_strokes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.svg").write_text(f"{HEAD}{WEDGE}</svg>")
    (tmp_path / "empty.svg").write_text(f"{HEAD}</svg>")
    assert main(["preview", "in.svg", "-o", "out.svg", "--show", "strokes", "--editable"]) == 0
    assert "powerstroke" in (tmp_path / "out.svg").read_text()
    assert main(["preview", "empty.svg", "-o", "none.svg", "--show", "strokes", "--editable"]) == 1
    assert main(["preview", "in.svg", "-o", "out.png", "--show", "strokes", "--editable"]) == 2
    assert not (tmp_path / "none.svg").exists() and not (tmp_path / "out.png").exists()
    assert gives(capsys.readouterr().err.splitlines()[-1], "--editable")


def test_editable_strokes_keep_the_settings_of_the_whole_drawing(tmp_path, monkeypatch):
    """The brush, machine and tolerance of the drawing were once lost, and convert took its own."""
    monkeypatch.chdir(tmp_path)
    said = {"brush": "liner-1", "cell": "grbl-3axis", "compensation": "none", "tolerance": "0.2mm", "wide": "clamp"}
    said |= {"start": "butt", "end": "round"}
    attributes = "".join(f' data-brushsvg-{name}="{value}"' for name, value in said.items())
    (tmp_path / "in.svg").write_text(f"{HEAD.replace('<svg', f'<svg{attributes}', 1)}{LINE}</svg>")
    assert main(["preview", "in.svg", "-o", "out.svg", "--show", "strokes", "--editable"]) == 0
    before, after = settings_in("in.svg"), settings_in("out.svg")
    assert before == after and before.keys() == said.keys()


def test_editable_strokes_wider_than_the_brush_are_reported(tmp_path, monkeypatch, capsys):
    """convert fills wide shapes, but refuses wide lines. The drawing of lines was written without a warning."""
    monkeypatch.chdir(tmp_path)
    square = '<rect id="square" x="20" y="10" width="20" height="20" fill="red" stroke="none"/>'
    (tmp_path / "in.svg").write_text(f"{HEAD}{square}{WEDGE}</svg>")
    words = ("preview", "in.svg", "-o", "out.svg", "--show", "strokes", "--editable")
    status, _, reported = in_json(capsys, *words)
    assert status == 0 and are_reported([each for _, each in reported], "width-out-of-reach square 20 8.4] round-6")
    status, _, reported = in_json(capsys, "convert", "out.svg", "-o", "out.ngc")
    assert status == 1 and is_reported(reported, "width-out-of-reach 20.000 8.400]", "square"), reported
    assert in_json(capsys, *words, "--force", "--brush", "rigid")[2] == [], "a pen draws lines of any width as one"


def test_editable_strokes_wider_than_the_cell_can_press_are_reported(tmp_path, monkeypatch, capsys):
    """round-6 paints 8.4 mm, and 6.72 mm on a cell that can press it by 8 mm."""
    monkeypatch.chdir(tmp_path)
    bar = '<rect id="bar" x="10" y="20" width="80" height="7.2" fill="red" stroke="none"/>'
    (tmp_path / "in.svg").write_text(f"{HEAD}{bar}</svg>")
    words = ("preview", "in.svg", "-o", "out.svg", "--show", "strokes", "--editable", "--force")
    assert in_json(capsys, *words)[2] == []
    cell = ("--cell", "grbl-servo")
    status, _, reported = in_json(capsys, *words, *cell)
    assert status == 0 and is_reported(reported, "width-out-of-reach bar 7.2 6.72] grbl-servo"), reported
    status, _, reported = in_json(capsys, "convert", "out.svg", "-o", "out.gcode", *cell)
    assert status == 1 and is_reported(reported, "width-out-of-reach 7.200 6.720] grbl-servo", "bar"), reported
