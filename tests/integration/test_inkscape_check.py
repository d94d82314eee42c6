"""Brush check in the real Inkscape marks unpaintable elements with the reason."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from command import OPEN, SOUND
from diagnostics import gives

from brushsvg import read_drawing
from brushsvg.read import ReadOptions

SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
BODY = """<g id="layer" transform="translate(5,2)"><g id="turned" transform="rotate(-10) scale(1.1)">
 <path id="wide" d="M 10,40 H 60" style="fill:none;stroke:#102030;stroke-width:20"/></g>
 <path id="sharp" d="M 20,45 C 110,45 110,48 22,49" style="fill:none;stroke:#0000ff;stroke-width:3"/>
 <path id="sound" d="M 20,30 H 90" style="fill:none;stroke:#a00000;stroke-width:3"/></g>"""


def checked(plugin, tmp_path, body, name="drawing"):
    source = tmp_path / f"{name}.svg"
    source.write_text(body if body.startswith("<svg") else f"{OPEN}{body}</svg>")
    out = plugin.effect("check", source, tmp_path / f"{name}-checked.svg")
    (layer,) = (node for node in ET.parse(out).iter() if node.get("id") == "brushsvg-check")
    return out, layer


def ends_mm(path, select):
    elements = read_drawing(path, ReadOptions(select=select)).elements
    return [np.vstack([each.subpaths[0].cubics[0, 0], each.subpaths[0].cubics[-1, 3]]) for each in elements]


@pytest.mark.parametrize("own", ["", 'transform="translate(4,3) rotate(3)"'])
def test_unpaintable_elements_are_marked_in_place(plugin, tmp_path, own):
    out, layer = checked(plugin, tmp_path, f"{OPEN}<g {own}>{BODY}</g></svg>")
    assert gives(layer.get(f"{INKSCAPE}label"), "round-6", "1", "1")
    texts = [" ".join(text.itertext()) for text in layer.iter(f"{SVG}text")]
    assert re.search(r"22\.000 mm .*\[0\.000, 8\.400\] mm", texts[0])
    assert gives(texts[1], "0.05 mm")
    colours = [path.get("style").split("stroke:")[1][:7] for path in layer.iter(f"{SVG}path")]
    assert colours == ["#d4351c", "#e08700"]
    shown = tmp_path / "shown.svg"
    shown.write_text(out.read_text().replace('data-brushsvg-skip="yes"', ""))
    for marked, drawn in zip(ends_mm(shown, "#brushsvg-check path"), ends_mm(out, "#wide, #sharp"), strict=True):
        assert np.abs(marked - drawn).max() < 0.01


def test_letters_refused_by_document_settings_are_marked_in_place(plugin, tmp_path):
    fat = OPEN.replace("<svg ", '<svg data-brushsvg-wide="refuse" ') + '<path id="fat" d="M20 20h60v14h-60z"/>'
    _, layer = checked(plugin, tmp_path, f'{fat}<path id="thin" d="M20 45h60v4h-60z"/></svg>')
    assert gives(layer.get(f"{INKSCAPE}label"), "round-6", "1", "0")
    (text,) = (" ".join(text.itertext()) for text in layer.iter(f"{SVG}text"))
    assert gives(text, "14 mm")


def test_the_check_layer_is_replaced_and_originals_are_unchanged(plugin, tmp_path):
    out, layer = checked(plugin, tmp_path, BODY)
    again, layer_again = checked(plugin, tmp_path, out.read_text().partition("?>")[2].strip(), "again")
    assert len(layer) == len(layer_again)
    for text in (out.read_text(), again.read_text()):
        names = ("layer", "turned", "wide", "sharp", "sound")
        originals = [node for node in ET.fromstring(text).iter() if node.get("id") in names]
        drawn = ET.fromstring(f"{OPEN}{BODY}</svg>")
        expected = [node for node in drawn.iter() if node.get("id") in names]
        assert [node.attrib for node in originals] == [node.attrib for node in expected]


def test_elements_that_prevent_a_program_are_marked_as_unpaintable(plugin, tmp_path):
    _, layer = checked(plugin, tmp_path, '<path id="off" d="M 1,30 H 60" stroke="#000" fill="none" stroke-width="5"/>')
    assert gives(layer.get(f"{INKSCAPE}label"), "round-6", "0")
    assert gives(" ".join(layer.itertext()), "left")
    assert [path.get("style").split("stroke:")[1][:7] for path in layer.iter(f"{SVG}path")] == ["#d4351c"]


def test_a_drawing_without_problems_has_an_empty_check_layer(plugin, tmp_path):
    _, layer = checked(plugin, tmp_path, SOUND)
    assert gives(layer.get(f"{INKSCAPE}label"), "round-6")
    assert len(layer) == 0


def test_a_drawing_without_paintable_elements_is_marked(plugin, tmp_path):
    body = "".join(f'<path id="p{k}" d="M20 30 H90" stroke="#000" stroke-width="{30 + k}"/>' for k in range(5))
    _, layer = checked(plugin, tmp_path, body)
    assert len(list(layer.iter(f"{SVG}path"))) == 5


def test_odd_ids_and_texts_are_marked(plugin, tmp_path):
    body = SOUND.replace('id="line"', 'id="a&quot;b&apos;" stroke-width="30"').replace('stroke-width="3"', "")
    source = tmp_path / "drawing.svg"
    source.write_text(body.replace("</svg>", '<text id="word" x="10" y="10">a</text></svg>'))
    done = plugin.script("check", source)
    assert done.returncode == 0, done.stderr
    (layer,) = (node for node in ET.fromstring(done.stdout).iter() if node.get("id") == "brushsvg-check")
    assert len(list(layer.iter(f"{SVG}text"))) == 2


def test_equal_warnings_of_copies_are_reported_once(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    copied = '<text id="word" x="10" y="10">a</text><use xlink:href="#word" y="20"/></svg>'
    head = SOUND.replace("<svg ", '<svg xmlns:xlink="http://www.w3.org/1999/xlink" ')
    source.write_text(head.replace("</svg>", copied))
    done = plugin.script("check", source)
    assert b"2 warned of" in done.stdout and done.stdout.count(b"text is not read") == 1
