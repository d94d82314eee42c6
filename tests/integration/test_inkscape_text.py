"""Convert to strokes of text in the real Inkscape, which draws the letters."""

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from command import OPEN, brushsvg

SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
TEXT = """<g id="layer" transform="translate(8,2)"><text id="word" x="5" y="30" transform="rotate(3)"
 style="font-size:24px;font-family:'DejaVu Sans'"
 ><tspan id="part">ob<tspan id="red" style="fill:#ff0000">c</tspan></tspan></text></g>
 <path id="path1" d="M 90,10 h 3 v 40 h -3 z"/>"""


@pytest.fixture
def drawing(tmp_path):
    file = tmp_path / "drawing.svg"
    file.write_text(f"{OPEN}{TEXT}</svg>")
    return file


def text_of(root):
    (text,) = root.iter(f"{SVG}text")
    return [(node.attrib, node.text) for node in text.iter()]


@pytest.mark.parametrize("select", ["", "word", "layer"])
def test_text_becomes_the_strokes_of_its_letters(plugin, inkscape, drawing, select):
    """Without a display there must be no notice, because its dialog would block."""
    done = plugin.effect("strokes", drawing, drawing.with_name("strokes.svg"), select)
    root = ET.parse(done).getroot()
    parents = {child: parent for parent in root.iter() for child in parent}
    (text,) = root.iter(f"{SVG}text")
    kept, group = parents[text], parents[parents[text]]
    assert kept.get("style") == "display:none" and kept.get("data-brushsvg-skip") == "yes"
    assert parents[group].get("id") == "layer" and group.get(f"{INKSCAPE}label") == "obc, strokes"
    assert (root.find(".//*[@id='path1-strokes']") is not None) == (select == "")
    styles = " ".join(path.get("style") for path in group.findall(f"{SVG}path"))
    assert set(re.findall("#[0-9a-f]{6}", styles)) == {"#000000", "#ff0000"}
    paths = drawing.with_name("paths.svg")
    inkscape("--export-text-to-path", f"--export-filename={paths}", drawing)
    assert painted(done) == pytest.approx(painted(paths), abs=0.1)


def painted(file: Path) -> list[float]:
    """Return the boxes of the marks in mm, for the letters of the text and the path."""
    brushsvg("preview", file, "-o", file.with_suffix(".json"), cwd=file.parent, status=0)
    boxes = []
    for each in json.loads(file.with_suffix(".json").read_text())["passes"]:
        corners = [corner for ring in each["outline_mm"] for corner in ring]
        boxes += [pick(corner[axis] for corner in corners) for pick in (min, max) for axis in (0, 1)]
    return boxes


def test_original_text_is_unchanged(plugin, drawing):
    before = ET.parse(drawing).getroot()
    after = ET.fromstring(plugin.script("strokes", drawing).stdout)
    assert text_of(after) == text_of(before)


def test_missing_inkscape_is_reported_with_how_to_make_paths(plugin, drawing):
    plugin.env["INKSCAPE_COMMAND"] = "nowhere"
    try:
        done = plugin.script("strokes", drawing)
    finally:
        del plugin.env["INKSCAPE_COMMAND"]
    assert done.returncode == 0 and b'id="path1-strokes"' in done.stdout
    assert b"word: text is not read; turn it into paths with Path > Object to Path" in done.stderr


def test_inkscape_is_not_started_for_text_in_brushsvg_layers(plugin, tmp_path):
    source, started = tmp_path / "drawing.svg", tmp_path / "started"
    other = tmp_path / "inkscape"
    other.write_text(f"#!/bin/sh\ntouch {started}\n")
    other.chmod(0o755)
    ours = '<g data-brushsvg-skip="yes"><text id="said" x="9" y="9">no</text></g>'
    source.write_text(f'{OPEN}{ours}<path id="path1" d="M 90,10 h 3 v 40 h -3 z"/></svg>')
    plugin.env["INKSCAPE_COMMAND"] = str(other)
    try:
        done = plugin.script("strokes", source)
    finally:
        del plugin.env["INKSCAPE_COMMAND"]
    assert done.returncode == 0 and not done.stderr and not started.exists()
