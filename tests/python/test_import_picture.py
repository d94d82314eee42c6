import re
import xml.etree.ElementTree as ET

import cv2
import numpy as np
import pytest
from diagnostics import gives
from svg_text import read

from brushsvg.cli.arguments.parser import parse
from brushsvg.read import ReadOptions
from brushsvg.read.design import Notice
from brushsvg.read.svg import read_svg
from brushsvg.show.import_picture import draw_import_picture
from brushsvg.show.png_canvas import write_text
from brushsvg.strokes.extraction import strokes

BODY = """<path id="a" d="M10 10H60" stroke-width="6"/><path id="b&lt;" d="M10 30h30"/>
  <circle r="5" cx="80" cy="20" fill="red" stroke="none"/>"""


def test_svg_shows_numbers_names_and_warnings():
    design = read(BODY)
    made, notices = strokes(design)
    tree = ET.fromstring(draw_import_picture(".svg", design, made, [*design.notices, *notices]))
    words = [node.text for node in tree.iter("{http://www.w3.org/2000/svg}text")]
    assert "1" in words and "2" in words
    assert any(word.startswith("1  a: 6 mm") for word in words)
    assert any(word.startswith("2  b<: 1 mm") for word in words)
    assert any(word.startswith("3  stroke1: 9.97 mm") for word in words)


def test_png_shows_the_stroke_at_its_place_and_width():
    design = read(BODY)
    image = cv2.imdecode(
        np.frombuffer(draw_import_picture(".png", design, strokes(design)[0], []), np.uint8), cv2.IMREAD_COLOR
    )
    column = image[:, 40 + (30 * 15)].astype(int)  # x = 30 mm at 15 px/mm, clear of arrows and numbers
    painted = np.flatnonzero(np.abs(column - 255).sum(axis=1) > 60)
    top = 100
    band = painted[(painted > top + 5 * 15) & (painted < top + 15 * 15)]
    assert abs(len(band) - 6 * 15) <= 3
    assert abs(band.mean() - (top + 10 * 15)) <= 2


@pytest.mark.parametrize(
    ("title", "from_the_left"),
    [
        ("\u05d0\u05d1\u05d2", "\u05d2\u05d1\u05d0"),
        ("\u0645\u0631 2026", "2026 \u0631\u0645"),
        ("\u05d0\u05d1 (ab) 12", "\u05d1\u05d0 (ab) 12"),
        ("1  \u05d0\u05d1\u200e: 3 mm", "1  \u05d1\u05d0: 3 mm"),
        ("ab (\u05d0\u05d1) 12", "ab (\u05d1\u05d0) 12"),
        ("(\u05d0) \u05d1", "(\u05d0) \u05d1"),
        ("\u05d0 (\u05d1)", "(\u05d1) \u05d0"),
        ("Gr\u00fc\u00dfe (2)", "Gr\u00fc\u00dfe (2)"),
    ],
)
def test_png_shows_hebrew_and_arabic_from_right_to_left(title, from_the_left):
    """The letters once stood from left to right, as OpenCV writes all letters."""
    made, expected = (np.full((60, 400, 3), 255, np.uint8) for _ in range(2))
    write_text(made, title, (20, 40), 28, 400, "#000000")
    cv2.putText(expected, from_the_left, (20, 40), (0, 0, 0), cv2.FontFace("sans"), 28, 400)
    assert (made == expected).all() and (made < 255).any()


def test_the_width_of_a_stroke_stays_behind_a_hebrew_name():
    """Without a mark of direction after the name, its letters took the number to the left of them."""
    words = [text for text, *_ in words_of('<path id="\u05d0\u05d1" d="M10,10 h40" stroke="#000" stroke-width="3"/>')]
    assert "1  \u05d0\u05d1\u200e: 3 mm" in words


def test_a_drawing_without_strokes_still_gives_a_picture():
    design = read('<circle r="5" cx="80" cy="20" fill="red" stroke="none"/>')
    assert draw_import_picture(".png", design, [], []).startswith(b"\x89PNG")


def words_of(body, notices=()):
    design = read(body)
    made, _ = strokes(design)
    tree = ET.fromstring(draw_import_picture(".svg", design, made, [*design.notices, *notices]))
    return [
        (node.text, float(node.get("x")), float(node.get("y")), node.get("fill"))
        for node in tree.iter("{http://www.w3.org/2000/svg}text")
    ]


def test_many_dashes_are_one_entry_in_one_colour():
    words = words_of('<path id="path7" d="M2 10H98" stroke-dasharray="1 1"/><path id="z" d="M2 30H98"/>')
    texts = [word for word, *_ in words]
    assert "1-48  path7/1 ... path7/48: 1 mm (48 strokes)" in texts
    assert "49  z: 1 mm" in texts
    numbers = [(int(word), x, ink) for word, x, _, ink in words if word.isdigit() and int(word) < 49]
    assert numbers[0][0] == 1
    assert 8 < len(numbers) < 20
    assert len({ink for *_, ink in numbers}) == 1


def test_only_equal_strokes_share_one_entry():
    line = '<path id="{}" d="M{} 5v9" stroke-width="{}"/>'.format
    alike = "".join(line(f"p{k}", 5 + 3 * k, 1) for k in range(6))
    texts = [word for word, *_ in words_of(alike + line("p6", 50, 2) + line("p8", 60, 1) + line("q", 70, 1))]
    assert texts[-4:] == ["1-6  p0 ... p5: 1 mm (6 strokes)", "7  p6: 2 mm", "8  p8: 1 mm", "9  q: 1 mm"]
    assert {"1", "2", "3", "4", "5", "6", "7", "8", "9"} <= set(texts)
    assert len({ink for word, *_, ink in words_of(alike) if word.isdigit()}) == 6


def test_an_entry_keeps_the_number_and_the_width_of_a_stroke_with_a_long_name():
    """A word in Arabic or Devanagari is one shape, whose name was longer than the entry of each of its strokes."""
    name = "glyph-1-u0628u0627u0644u0639u0627u0644u0645"
    body = f'<path id="{name}" d="M10 5v9M20 5v9M30 5v9" stroke-width="1.25"/>'
    entries = [word for word, *_ in words_of(body) if "glyph" in word]
    assert [word.rsplit("/", 1)[1] for word in entries] == ["1: 1.25 mm", "2: 1.25 mm", "3: 1.25 mm"]
    assert all("glyph-1-u06" in word and len(word) <= 46 for word in entries)


def test_numbers_do_not_overlap():
    crowd = "".join(f'<path d="M{30 + k % 15} {20 + k // 15}h.5" stroke-width=".3"/>' for k in range(150))
    boxes = [(x, y, 11.0 * len(word)) for word, x, y, _ in words_of(crowd) if word.isdigit()]
    assert 15 < len(boxes) < 150
    for k, (x, y, w) in enumerate(boxes):
        assert all(x + w <= a or a + b <= x or abs(y - c) >= 16 for a, c, b in boxes[:k])


def test_warnings_with_one_code_are_one_line():
    notices = [Notice(f"p{k}", f"depth 0.{k} mm is outside the range [1, 10] mm", code="depth") for k in range(9)]
    texts = [word for word, *_ in words_of('<path d="M1 1H9"/>', [*notices, Notice("x", "another")])]
    assert gives(texts[-2], "p0", "8", "0.0 mm") and texts[-1] == "x: another"


def test_a_warning_about_the_whole_drawing_is_its_sentence_alone():
    notice = Notice("", "it has no widths")
    assert notice.text in [word for word, *_ in words_of(BODY, [notice])]


def test_elements_named_like_parts_keep_their_own_colours():
    line = '<path id="icon/{}" d="M{} 5v9"/>'.format
    words = words_of("".join(line(k, 5 + 3 * k) for k in range(1, 7)))
    assert "1-6  icon/1 ... icon/6: 1 mm (6 strokes)" in [word for word, *_ in words]
    assert len({ink for word, *_, ink in words if word.isdigit()}) == 6


def test_extra_strokes_of_a_filled_shape_are_announced():
    (filled,) = [word for word, *_ in words_of(BODY) if word.startswith("sheet ")]
    (words,) = re.findall("; (.*) shows", filled)
    assert parse([*words.split(), "a.svg", "-o", "a.png"]).show == "paint", "a command that exists"
    (lines,) = [word for word, *_ in words_of('<path d="M10 10H60"/>') if word.startswith("sheet ")]
    assert ";" not in lines


def test_lists_stay_on_the_picture_and_entries_do_not_overlap():
    """Lists stay on the picture, and entries do not overlap.

    The picture is narrow and has long names, in the PNG's own font. Names of blocks in a DXF are as long.
    """
    names = [f"INSERT-93.1.{k}/LWPOLYLINE-8{k}" for k in range(9)]
    lines = "".join(
        f'<path id="{name}" d="M{5 + 5 * k} 5v9" stroke-width="{1 + k / 10}"/>' for k, name in enumerate(names)
    )
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="150mm" viewBox="0 0 60 150" stroke="red">'
    long = Notice("TEXT-95", "the outlines of a font that is not the drawing's " * 4, code="x")
    design = read_svg(f"{head}{lines}</svg>".encode(), ReadOptions())
    made, _ = strokes(design)
    tree = ET.fromstring(draw_import_picture(".svg", design, made, [long]))
    width = float(tree.get("width"))
    rows: dict[float, list] = {}
    for node in tree.iter("{http://www.w3.org/2000/svg}text"):
        size = int(node.get("font-size"))
        (_, _, wide, _) = cv2.getTextSize((1, 1), node.text, (0, 0), cv2.FontFace("sans"), size, 400)
        rows.setdefault(float(node.get("y")), []).append((float(node.get("x")), wide, node.text))
    entries = [word for row in rows.values() for *_, word in row if "INSERT" in word]
    assert len(entries) == 9 and all(word.endswith(" mm") for word in entries)
    for row in (sorted(row) for row in rows.values() if any("  " in word or "font" in word for *_, word in row)):
        for (x, wide, word), (after, *_) in zip(row, [*row[1:], (width, 0, "")], strict=True):
            assert x + wide < after, word
