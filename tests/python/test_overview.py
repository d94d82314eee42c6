import xml.etree.ElementTree as ET

import cv2
import numpy as np
from svg_text import read

from brushsvg.overview import overview
from brushsvg.strokes import strokes

BODY = """<path id="a" d="M10 10H60" stroke-width="6"/><path id="b&lt;" d="M10 30h30"/>
  <circle r="5" cx="80" cy="20" fill="red" stroke="none"/>"""


def test_svg_numbers_names_and_warnings():
    design = read(BODY)
    made, notices = strokes(design)
    tree = ET.fromstring(overview(".svg", design, made, [*design.notices, *notices]))
    words = [node.text for node in tree.iter("{http://www.w3.org/2000/svg}text")]
    assert "1" in words and "2" in words
    assert any(word.startswith("1  a: 6 mm") for word in words)
    assert any(word.startswith("2  b<: 1 mm") for word in words)
    assert any(word.startswith("3  stroke1: 9.97 mm") for word in words)


def test_png_shows_the_band_as_wide_as_the_stroke_where_it_was_drawn():
    design = read(BODY)
    image = cv2.imdecode(
        np.frombuffer(overview(".png", design, strokes(design)[0], []), np.uint8), cv2.IMREAD_COLOR
    )
    column = image[:, 40 + (30 * 15)].astype(int)  # x = 30 mm at 15 px/mm, clear of arrows and numbers
    painted = np.flatnonzero(np.abs(column - 255).sum(axis=1) > 60)
    top = 100
    band = painted[(painted > top + 5 * 15) & (painted < top + 15 * 15)]
    assert abs(len(band) - 6 * 15) <= 3
    assert abs(band.mean() - (top + 10 * 15)) <= 2


def test_without_strokes_there_is_still_something_to_look_at():
    design = read('<circle r="5" cx="80" cy="20" fill="red" stroke="none"/>')
    assert overview(".png", design, [], []).startswith(b"\x89PNG")
