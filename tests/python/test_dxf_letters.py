"""Text of a DXF is set in test fonts in which every letter is a known box."""

import platform
import subprocess
import sys

import numpy as np
import pytest
from diagnostics import agrees, are_reported, is_reported, refused
from dxf_text import drawing, encoded, only, read, save_font, text_dxf

from brushsvg.read import ReadOptions
from brushsvg.read.dxf import read_dxf, text_entities
from brushsvg.read.dxf.ezdxf_import import ezdxf

ALIGN = ezdxf.enums.TextEntityAlignment
FOLDERS = ezdxf.fonts.font_manager.FONT_DIRECTORIES
LIKE_SHX = "SHX"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The only folder that is searched for fonts."""
    monkeypatch.setitem(FOLDERS, platform.system(), [str(tmp_path)])
    return tmp_path


@pytest.fixture
def fonts(folder):
    (folder / "more").mkdir()
    save_font(folder / "more" / "Boxes.TTF", "Boxes")
    save_font(folder / "boxesbd.ttf", "Boxes Bold", 900)
    save_font(folder / "PlainSans.ttf", "Plain Sans", 400)
    (folder / "Arial.ttf").write_bytes(b"\0\1\0\0 no font")


def in_boxes(version="R2010"):
    document = drawing(version=version)
    document.styles.add("Boxes", font="boxes.ttf")
    return document


def boxes(element):
    """Return the lower left and upper right corners of each outline, left to right."""
    found = [
        [*s.cubics.min(axis=(0, 1)).round(6) + 0.0, *s.cubics.max(axis=(0, 1)).round(6) + 0.0] for s in element.subpaths
    ]
    return sorted(map(tuple, found))


def test_text_is_a_filled_shape_in_its_font(fonts):
    document = in_boxes()
    text = document.modelspace().add_text("A px", height=7, dxfattribs={"style": "Boxes", "insert": (3, 4), "color": 1})
    design = read(document)
    (element,) = design.elements
    assert boxes(element) == [(3, 4, 9, 11), (17, 2, 23, 9), (24, 4, 30, 9)]
    assert all(s.closed and len(s.cubics) == 4 for s in element.subpaths)
    assert (element.id, element.stroke_width_mm, element.fill_rule, element.colour) == (
        f"TEXT-{text.dxf.handle}",
        0,
        "nonzero",
        "#ff0000",
    )
    (notice,) = design.notices
    assert agrees(notice, "text-outlined 'A px' Boxes", element.id)
    assert (notice.damaged, notice.layer) == (False, "0")


@pytest.mark.parametrize(
    ("align", "box"),
    [
        ("LEFT", (0, 0, 13, 7)),
        ("CENTER", (-7, 0, 6, 7)),
        ("RIGHT", (-14, 0, -1, 7)),
        ("TOP_LEFT", (0, -7, 13, 0)),
        ("MIDDLE_CENTER", (-7, -3.5, 6, 3.5)),
    ],
)
@pytest.mark.parametrize("turned", [0, 90])
def test_text_is_aligned_rotated_and_stretched(fonts, align, box, turned):
    document = in_boxes()
    text = document.modelspace().add_text("AA", height=7, rotation=turned, dxfattribs={"style": "Boxes", "width": 2})
    text.set_placement((50, 60), align=ALIGN[align])
    (element,) = read(document).elements
    points = np.concatenate([s.cubics.reshape(-1, 2) for s in element.subpaths]) - (50, 60)
    if turned:
        points = points @ np.array([[0, -1], [1, 0]])
    corners = np.concatenate((points.min(axis=0), points.max(axis=0)))
    assert corners / (2, 1, 2, 1) == pytest.approx(np.array(box), abs=1e-9)


def test_text_fits_between_two_points(fonts):
    document = in_boxes()
    text = document.modelspace().add_text("AA", height=7, dxfattribs={"style": "Boxes"})
    text.set_placement((0, 0), (28, 0), align=ALIGN.FIT)
    (element,) = read(document).elements
    assert boxes(element) == [(0, 0, 12, 7), (14, 0, 26, 7)]  # the distance to a next letter is 2


def test_text_is_read_in_blocks_and_mirrored(fonts):
    document = in_boxes()
    document.blocks.new("b").add_text("A", height=7, dxfattribs={"style": "Boxes", "insert": (1, 0)})
    document.modelspace().add_blockref("b", (100, 0), {"xscale": -2, "yscale": 3})
    document.modelspace().add_text(
        "A", height=7, dxfattribs={"style": "Boxes", "insert": (-60, 5), "extrusion": (0, 0, -1)}
    )
    design = read(document)
    assert [boxes(element) for element in design.elements] == [[(86, 0, 98, 21)], [(54, 5, 60, 12)]]
    assert are_reported(design.notices, "text-outlined A 1 Boxes")


def test_attributes_are_text_at_their_own_position(fonts):
    document = in_boxes()
    document.blocks.new("b").add_circle((0, 0), 1)
    insert = document.modelspace().add_blockref("b", (50, 50), {"color": 3, "xscale": 5})
    for hidden in (False, True):
        attribute = insert.add_attrib("TAG", "A", (10, 0), {"style": "Boxes", "height": 7, "color": 0})
        attribute.is_invisible = hidden
    element, _ = read(document).elements
    assert element.id.startswith(f"INSERT-{insert.dxf.handle}/ATTRIB-")
    assert boxes(element) == [(10, 0, 16, 7)]
    assert element.colour == "#00ff00"


def test_constant_attributes_are_text_and_definitions_elsewhere_are_named(fonts):
    document = in_boxes()
    block, msp = document.blocks.new("b"), document.modelspace()
    for flags in (0, 1, 2, 3):
        block.add_attdef("T", (20 * flags, 0), "A", height=7, dxfattribs={"style": "Boxes", "flags": flags})
    msp.add_blockref("b", (0, 0))
    msp.add_attdef("T", (0, 50), "A", height=7, dxfattribs={"style": "Boxes"})
    design = read(document)
    (element,) = design.elements
    assert boxes(element) == [(40, 0, 46, 7)]
    assert is_reported(design.notices, "attribute-definition 1")


def test_text_control_codes_are_replaced(fonts):
    document = in_boxes()
    for words in ("%%065", "%%uA"):
        document.modelspace().add_text(words, height=7, dxfattribs={"style": "Boxes"})
    design = read(document)
    assert [boxes(element) for element in design.elements] == [[(0, 0, 6, 7)]] * 2
    assert sum(agrees(notice, "text-unread 'lines along'") for notice in design.notices) == 1


@pytest.mark.parametrize("written", ["A \u05d0", "A\u0301"])
def test_letters_that_are_not_set_one_by_one_from_the_left_are_reported(fonts, written):
    document = in_boxes()
    for words in (written, "A A"):
        document.modelspace().add_text(words, height=7, dxfattribs={"style": "Boxes"})
    first = read(document).elements[0].id
    assert [n.where for n in read(document).notices if agrees(n, "text-unread CAD")] == [first]


@pytest.mark.parametrize("kind", ["TEXT", "MTEXT"])
def test_text_without_a_height_is_damaged(fonts, kind):
    line = "0 LINE 8 0 10 0 20 0 11 5 21 5"
    design = read_dxf(text_dxf(line, f"0 {kind} 8 0 10 0 20 0 1 A"), ReadOptions(sheet_mm=(99, 99), units="mm"))
    assert are_reported(design.notices, "geometry-damaged height") and design.notices[0].damaged


def test_letters_of_several_heights_share_one_baseline(fonts):
    document = in_boxes()
    document.modelspace().add_mtext(r"A{\H2x;A}", {"style": "Boxes", "char_height": 7, "insert": (0, 50)})
    small, large = read(document).elements
    assert (boxes(small), boxes(large)) == ([(0, 36, 6, 43)], [(7, 36, 19, 50)])


@pytest.mark.parametrize(
    ("words", "attributes", "expected"),
    [
        (r"A{\T2;A}", {}, "text-unread distances letters"),
        ("A", {"bg_fill": 3}, "text-unread background"),
        ("A", {"flow_direction": 3}, "text-unread letters below"),
        (r"A{\H2x;A}", {"line_spacing_style": 2}, "text-unread lines apart"),
        (r"A {\H0;A}", {}, "geometry-damaged height 0.0"),
    ],
)
def test_an_unsupported_part_of_mtext_is_named(fonts, words, attributes, expected):
    document = in_boxes()
    document.modelspace().add_line((0, 0), (5, 5))
    document.modelspace().add_mtext(words, {"style": "Boxes", "char_height": 7} | attributes)
    assert is_reported(read(document).notices, expected)


def test_an_attribute_may_have_several_lines(fonts):
    document = in_boxes(version="R2018")
    document.blocks.new("b").add_circle((0, 0), 1)
    attribute = document.modelspace().add_blockref("b", (0, 0)).add_attrib("TAG", "", (0, 0))
    lines = ezdxf.entities.MText.new(
        dxfattribs={"insert": (0, 50), "char_height": 7, "style": "Boxes", "width": 90}, doc=document
    )
    lines.text = r"A\PA"
    attribute.embed_mtext(lines)
    shapes = [element for element in read(document).elements if element.fill_rule]
    assert [boxes(element)[0][0] for element in shapes] == [0, 0]
    assert boxes(shapes[0])[0][3] == 50
    assert boxes(shapes[1])[0][3] < 43


def test_dimensions_show_their_text(fonts):
    document = in_boxes()
    dimension = document.modelspace().add_linear_dim((0, 30), (0, 0), (50, 0), text="A")
    dimension.render()
    (shape,) = (e for e in read(document).elements if "TEXT" in e.id)
    assert shape.fill_rule == "nonzero"
    assert len(shape.subpaths) == 1


def test_mtext_is_split_into_words_and_lines(fonts):
    document = in_boxes()
    text = document.modelspace().add_mtext(
        r"A \H14;A\H7; {\C1;x}\P{\fBoxes|b1|i0;A}\L x\l",
        {"insert": (10, 90), "char_height": 7, "style": "Boxes", "width": 200},
    )
    elements = read(document).elements
    words = [element for element in elements if element.fill_rule]
    first, tall, red, bold, last = (boxes(element)[0] for element in words)
    assert first == (10, 76, 16, 83)  # as high as the line's highest letter
    assert tall == (24, 76, 36, 90)  # after advances of 7 and 7
    assert red == (45, 76, 51, 81)  # and after advances of 14 and 7
    assert bold[2] - bold[0] == pytest.approx(9)
    assert (last[2] - last[0], last[3] - last[1]) == pytest.approx((6, 5))
    assert [element.colour for element in words] == ["#000000"] * 2 + ["#ff0000"] + ["#000000"] * 2
    (line,) = (element for element in elements if not element.fill_rule)
    assert line.stroke_width_mm == 0.25
    assert line.id.startswith(f"MTEXT-{text.dxf.handle}/LINE-")


def test_mtext_breaks_lines_only_if_it_has_a_width(fonts):
    for width, lines in ((0, 1), (200, 1), (64, 2), (62, 3)):
        document = in_boxes()
        document.modelspace().add_mtext(
            "AAAA AAAA AAAA", {"char_height": 7, "style": "Boxes", "width": width, "insert": (50, 50)}
        )
        tops = {boxes(element)[0][3] for element in read(document).elements}
        assert len(tops) == lines


def test_mtext_without_width_is_read_if_its_style_names_a_font_family(fonts):
    """MTEXT without a width is read if its style names a font family.

    Programs have written such styles since 2007. The text once counted as damaged, because ezdxf has no fonts
    here from which it could guess the width.
    """
    document = in_boxes()
    style = document.styles.get("Boxes")
    style.set_extended_font_data("Boxes")
    document.modelspace().add_mtext("A A", {"char_height": 7, "style": "Boxes", "insert": (50, 50)})
    design = read(document)
    assert [boxes(element)[0] for element in design.elements] == [(50, 43, 56, 50), (64, 43, 70, 50)]
    assert not any(notice.damaged for notice in design.notices)


@pytest.mark.parametrize(
    "long",
    ["AAAA AAAA", r"\H14;AA AA", r"\fBoxes|b1|i0;AA A A", r"A\S1/2; A A", r"{\W2;A A}A"],
)
def test_a_short_line_is_centred_below_the_longest(long, fonts):
    """A short line stands below the middle of the longest line.

    In a text without a width, the longest line is as wide as the text. With a margin, shorter lines are
    displaced.
    """
    document = in_boxes()
    content = rf"\pxqc;{{{long}}}\PA"
    document.modelspace().add_mtext(content, {"char_height": 7, "style": "Boxes", "insert": (10, 90)})
    found = [box for element in read(document).elements if element.fill_rule for box in boxes(element)]
    *above, below = found
    assert len({round(box[1]) for box in above}) <= 3 and below[3] < min(box[1] for box in above)
    left, right = min(box[0] for box in above), max(box[2] for box in above)
    assert left == pytest.approx(10, abs=2.5), "where the text was set"
    assert (below[0] + below[2]) / 2 == pytest.approx((left + right) / 2, abs=2.5)


@pytest.mark.parametrize(
    ("font", "family", "name", "why"),
    [
        ("boxes.ttf", "", "Boxes", ""),
        ("C:\\Fonts\\BOXES.ttf", "", "Boxes", ""),
        ("boxes", "", "Boxes", ""),
        ("", "Boxes", "Boxes", ""),
        ("txt", "", "Plain Sans", LIKE_SHX),
        ("romans.shx", "", "Plain Sans", LIKE_SHX),
        ("arial.ttf", "", "Plain Sans", "arial.ttf"),  # this font file is broken
        ("gone.ttf", "Gone", "Plain Sans", "Gone"),
    ],
)
def test_fonts_are_found_by_name_or_replaced(fonts, font, family, name, why):
    document = drawing()
    style = document.styles.add("Some", font=font)
    if family:
        style.set_extended_font_data(family)
    document.modelspace().add_text("A", dxfattribs={"style": "Some"})
    (notice,) = read(document).notices
    assert agrees(notice, f"text-outlined A '{name}' {why}") and (": " in notice.sentence) == bool(why)


def test_a_missing_style_is_reported_and_replaced(fonts):
    document = drawing(lambda m: m.add_text("A", dxfattribs={"style": "Nowhere"}))
    reported = read(document).notices
    assert are_reported(reported, "dxf-repaired Nowhere", f"text-outlined A 'Plain Sans' {LIKE_SHX}")


def test_letters_without_a_glyph_are_left_out_and_named(fonts):
    document = in_boxes()
    document.modelspace().add_text("AÄ漢A", height=7, dxfattribs={"style": "Boxes"})
    design = read(document)
    assert [box[0] for box in boxes(design.elements[0])] == [0, 21]
    assert agrees(design.notices[1], "glyph-missing Boxes Ä 漢")


def test_text_is_left_out_if_there_is_no_font(folder):
    def draw(msp):
        msp.add_text("A")
        msp.add_mtext("A")
        msp.add_circle((0, 0), 5)

    design = read(drawing(draw))
    assert len(design.elements) == 1
    assert are_reported(design.notices, "text-unread TEXT explode 1", "text-unread MTEXT explode 1")


def test_empty_text_is_reported(fonts):
    design = read(drawing(lambda m: [m.add_text("  "), m.add_circle((0, 0), 5)]))
    assert are_reported(design.notices, "geometry-empty")
    assert only(drawing(lambda m: [m.add_mtext(""), m.add_circle((0, 0), 5)])).id.startswith("CIRCLE")


# Made to break --------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["add_text", "add_mtext"])
def test_long_text_is_refused_even_if_repeated_by_insertions(fonts, kind, monkeypatch):
    monkeypatch.setattr(text_entities, "_MAX_LETTERS", 2000)
    document = in_boxes()
    getattr(document.blocks.new("b"), kind)("A" * 100, dxfattribs={"style": "Boxes"})
    grid = {"row_count": 30, "column_count": 30, "row_spacing": 9, "column_spacing": 9}
    document.modelspace().add_blockref("b", (0, 0), grid)
    with refused("drawing-too-large 2000"):
        read(document)


@pytest.mark.parametrize(
    "attributes",
    [
        {"width": 1e300},
        {"width": 1e300, "char_height": 1e-300},
        {"char_height": 1e300},
        {"char_height": 0},
        {"line_spacing_factor": 1e300},
        {"text_direction": (0, 0, 0)},
    ],
)
def test_mtext_with_extreme_numbers_is_read_in_bounded_time(fonts, attributes):
    def draw(msp):
        msp.add_mtext(r"A\pxt1e9,5;A" + "{" * 500 + r"\H1e99x;A\S1/2;", attributes)
        msp.add_circle((0, 0), 5)

    design = read(drawing(draw))
    assert design.elements[-1].id.startswith("CIRCLE")
    assert all(np.isfinite(s.cubics).all() for element in design.elements for s in element.subpaths)


@pytest.mark.parametrize("height", ["0", "-1", "nan", "1e300"])
def test_text_of_zero_height_is_damaged(fonts, height):
    data = text_dxf(f"0 TEXT 8 0 10 0 20 0 40 {height} 1 A", "0 CIRCLE 8 0 10 0 20 0 40 5")
    design = read_dxf(data, ReadOptions(units="mm"))
    assert [element.id[:6] for element in design.elements] == ["CIRCLE"]
    assert next(notice.damaged for notice in design.notices if notice.where.startswith("TEXT"))


@pytest.mark.slow
def test_reading_text_writes_no_files_to_the_home_folder(tmp_path):
    """Reading text leaves no files in the home folder, with any installed fonts."""
    (tmp_path / "a.dxf").write_bytes(encoded(drawing(lambda m: [m.add_text("Aé"), m.add_circle((0, 0), 5)])))
    script = "import brushsvg.read as i; print(i.read_drawing('a.dxf'))"
    runs = [
        subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env={"HOME": str(tmp_path)}, capture_output=True)
        for _ in range(2)
    ]
    assert {(done.returncode, done.stderr) for done in runs} == {(0, b"")}
    assert runs[0].stdout == runs[1].stdout
    assert [path.name for path in tmp_path.iterdir()] == ["a.dxf"]


@pytest.mark.parametrize("stack", ["A^x", "AA^A"])
def test_a_stack_with_a_caret_may_have_a_blank(fonts, stack):
    def letters(text):
        document = in_boxes()
        attributes = {"char_height": 7, "style": "Boxes", "insert": (10, 90)}
        document.modelspace().add_mtext(f"A\\S{text};", attributes)
        return [boxes(each) for each in read(document).elements]

    assert letters(stack) == letters(stack.replace("^", "^ "))
    assert len(letters(stack)) == 3  # the text before, above and below
