"""Drawings can be read with all that drawing programs leave in their files.

Examples are backgrounds, notes, copies, other pages, other pixel sizes and clips.
"""

import re

import ezdxf
import numpy as np
import pytest
from diagnostics import agrees, are_reported, refused

import brushsvg
from brushsvg.read import ReadOptions
from brushsvg.read.svg import read_svg

PAGE = 'xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60"'
INKSCAPE = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
LINE = '<path id="line" fill="none" stroke="#000" stroke-width="3" d="M10 30h60"/>'


def read(body, page=PAGE, **options):
    return read_svg(f"<svg {page}>{body}</svg>".encode(), ReadOptions(lenient=True, **options))


def from_file(tmp_path, data, name="drawing.svg"):
    file = tmp_path / name
    file.write_bytes(data)
    return brushsvg.read_drawing(file, ReadOptions(lenient=True))


def ids(design):
    return [element.id for element in design.elements]


@pytest.mark.parametrize(
    "shape",
    [
        '<rect width="100" height="60" fill="#fff"/>',
        '<path d="M0 0C33 0 66 0 100 0C100 20 100 40 100 60C66 60 33 60 0 60Z" fill="#FDFDFD"/>',
        '<rect x="-5" y="-5" width="120" height="80" fill="#f8f8f4" stroke="#fff"/>',
        '<rect width="100" height="60" fill="#fff"/><rect width="100" height="60" fill="#fefefe"/>',
    ],
)
def test_a_white_shape_below_everything_is_background(shape):
    design = read(shape + LINE)
    assert ids(design) == ["line"]
    assert are_reported(design.notices, "background")
    assert len(read(shape + LINE, background="keep").elements) == 1 + shape.count("<rect") + shape.count("<path")


@pytest.mark.parametrize(
    "shape",
    [
        '<rect width="100" height="60" fill="#eee"/>',  # grey
        '<rect width="80" height="60" fill="#fff"/>',  # part of the page
        '<path d="M0 0H100V60H0Z M20 20V40H80V20Z" fill="#fff" fill-rule="evenodd"/>',  # a frame
    ],
)
def test_other_shapes_are_not_background(shape):
    assert len(read(shape + LINE).elements) == 2
    white = '<rect width="100" height="60" fill="#fff"/>'
    assert len(read(LINE + white).elements) == 2, "it covers what was drawn before"
    assert len(read(white).elements) == 1, "nothing else is there"


def test_a_background_is_recognized_by_the_page_for_any_requested_sheet():
    """A background is recognized by the page, for any requested sheet.

    The page is at the sheet's upper left.
    """
    design = read('<rect width="100" height="60" fill="#fff" stroke="#000"/>' + LINE, sheet_mm=(130.0, 80.0))
    assert ids(design)[-1] == "line" and len(design.elements) == 2
    assert not any(element.fill_rule for element in design.elements)
    assert sum(notice.code == "background" for notice in design.notices) == 1


@pytest.mark.parametrize(
    ("root", "sheet_mm"),
    [
        ('style="width:100mm;height:60mm" viewBox="0 0 100 60"', None),
        ('style="width:100mm;height:60mm" viewBox="0 0 100 60"', (130.0, 80.0)),
        ('width="377.953" height="226.772"', (130.0, 80.0)),  # without a viewBox
        ("", (100.0, 60.0)),
    ],
)
def test_a_background_is_recognized_for_any_form_of_page_size(root, sheet_mm):
    covers = '<rect width="377.953" height="226.772" fill="#fff"/>'
    body = covers if "viewBox" not in root else '<rect width="100" height="60" fill="#fff"/>'
    assert ids(read(body + LINE, f'xmlns="http://www.w3.org/2000/svg" {root}', sheet_mm=sheet_mm)) == ["line"]


def test_elements_off_the_page_are_left_out():
    body = (
        LINE
        + LINE.replace("M10", "M-200").replace('"line"', '"off"')
        + LINE.replace("M10", "M80").replace("line", "edge")
    )
    design = read(body)
    assert ids(design) == ["line", "edge"]
    assert are_reported(design.notices, "off-page off")
    alone = read(LINE.replace("M10", "M-200"))
    assert len(alone.elements) == 1 and not alone.notices, "all of it can still be moved with --fit"


@pytest.mark.parametrize("sheet_mm", [(30.0, 20.0), (400.0, 300.0)])
def test_requested_sheet_does_not_decide_which_elements_are_on_the_page(sheet_mm):
    """With --fit, the drawing is moved onto a smaller sheet, and its notes next to the page onto no larger one."""
    body = LINE + LINE.replace("M10", "M80").replace('"line"', '"edge"')
    body += LINE.replace("M10", "M150").replace('"line"', '"off"')
    assert ids(read(body, PAGE, sheet_mm=sheet_mm)) == ["line", "edge"]


def test_layers_of_notes_are_left_out():
    layer = '<g inkscape:groupmode="layer" inkscape:label="{}">' + LINE.replace('id="line"', "") + "</g>"
    design = read("".join(map(layer.format, ("1 ink", "%notes", "!2 pause"))), f"{PAGE} {INKSCAPE}")
    assert len(design.elements) == 2
    assert are_reported(design.notices, "layer-of-notes %notes")
    assert "%" in design.layers["%notes"], "--layer says why it is not painted"


def test_identical_lines_are_painted_once(tmp_path):
    twice = (
        LINE
        + LINE.replace("line", "copy")
        + '<path id="back" fill="none" stroke="#000" stroke-width="3" d="M70 30h-60"/>'
    )
    others = LINE.replace("line", "red").replace("#000", "red") + LINE.replace("line", "wide").replace('"3"', '"4"')
    design = from_file(tmp_path, f"<svg {PAGE}>{twice}{others}</svg>".encode())
    assert ids(design) == ["line", "red", "wide"]
    assert are_reported(design.notices, "drawn-twice copy back")


def test_rings_that_begin_at_different_points_are_painted_once(tmp_path):
    shapes = '<rect id="box" x="20" y="20" width="40" height="6"/><path id="copy" d="M60 20V26H20V20Z"/>'
    again = '<use href="#box"/><path id="larger" d="M60 20V27H20V20Z"/>'
    design = from_file(tmp_path, f"<svg {PAGE}>{shapes}{again}</svg>".encode())
    assert ids(design) == ["box", "larger"]
    assert are_reported(design.notices, "drawn-twice copy (like box)")
    assert "box (drawn again)" in design.notices[0].sentence


OLD_INKSCAPE = f'{INKSCAPE} width="744.09448" height="1052.3622" inkscape:version="0.91 r13725"'
ILLUSTRATOR = 'data-name="Layer 1" width="595.28" height="841.89" viewBox="0 0 595.28 841.89"'


# Illustrator's "Save as" writes this; its comment is removed here.
ILLUSTRATOR_STYLE = (
    'width="595.28px" height="841.89px" viewBox="0 0 595.28 841.89" style="enable-background:new 0 0 595.28 841.89;"'
)


@pytest.mark.parametrize(("root", "per_inch"), [(OLD_INKSCAPE, 90), (ILLUSTRATOR, 72), (ILLUSTRATOR_STYLE, 72)])
def test_programs_with_other_pixels_are_named(root, per_inch):
    design = read(LINE, f'xmlns="http://www.w3.org/2000/svg" {root}')
    (notice,) = design.notices
    assert agrees(notice, f"other-pixels {per_inch} 210 297")
    # Following the advice gives this size.
    kept = re.sub(r'(?:width|height)="[^"]*"', "", root)
    advised = read(LINE, f'xmlns="http://www.w3.org/2000/svg" {kept} {notice.advice.removeprefix("give its svg ")}')
    assert advised.sheet_mm == pytest.approx((210, 297), abs=0.01) and not advised.notices
    lengths = [np.ptp(each.elements[0].subpaths[0].cubics[..., 0]) for each in (advised, design)]
    assert lengths[0] / lengths[1] == pytest.approx(96 / per_inch, rel=1e-4)


def test_files_of_later_inkscape_use_css_pixels():
    assert not read(
        LINE,
        f'xmlns="http://www.w3.org/2000/svg" {INKSCAPE} width="100" height="60" inkscape:version="0.92.4"',
    ).notices


def test_a_size_in_em_is_taken_from_the_view_box():
    icon = read(LINE, 'xmlns="http://www.w3.org/2000/svg" width="1em" height="1em" viewBox="0 0 96 96"')
    assert icon.sheet_mm == pytest.approx((25.4, 25.4)) and are_reported(icon.notices, "size-assumed 25.4")
    plain = read(LINE, 'xmlns="http://www.w3.org/2000/svg" width="6em" height="12ex"')
    assert plain.sheet_mm == pytest.approx((25.4, 25.4))


@pytest.mark.parametrize(
    ("label", "codec", "name"),
    [
        ("gb2312", "gbk", "图层"),
        ("GBK", "gbk", "镕"),
        ("Shift_JIS", "cp932", "レイヤー①"),
        ("EUC-KR", "cp949", "층"),
        ("Big5", "big5", "層"),
    ],
)
def test_xml_in_encodings_of_two_bytes_is_read(label, codec, name):
    text = f'<?xml version="1.0" encoding="{label}"?><svg {PAGE}>{LINE.replace("line", name)}</svg>'
    assert ids(read_svg(text.encode(codec), ReadOptions())) == [name]


def test_bytes_that_are_invalid_in_the_encoding_are_refused():
    with refused("not-xml GBK"):
        read_svg(f'<?xml version="1.0" encoding="GBK"?><svg {PAGE}>'.encode() + b"\xff\xff</svg>", ReadOptions())


def clip(clips, body, more=""):
    return read(f'<defs><clipPath id="Clip" {more}>{clips}</clipPath></defs>{body}')


CUT = LINE.replace("/>", ' clip-path="url(#Clip)"/>')
MASKED = LINE.replace("/>", ' mask="url(#m)"/>')


def spans(element):
    return [(p.cubics[0, 0, 0], p.cubics[-1, 3, 0]) for p in element.subpaths]


def test_lines_are_cut_by_clip_paths():
    (element,) = clip('<circle cx="40" cy="30" r="15"/>', CUT).elements
    assert spans(element) == [pytest.approx((25, 55), abs=0.01)]
    (element,) = clip('<rect x="20" width="10" height="60"/><rect x="50" width="5" height="60"/>', CUT).elements
    assert np.ravel(spans(element)) == pytest.approx([20, 30, 50, 55])
    whole = clip('<rect width="100" height="60"/>', CUT)
    assert spans(whole.elements[0]) == [(10, 70)] and not whole.notices
    gone = clip('<rect x="90" width="10" height="60"/>', CUT + LINE.replace("line", "other"))
    assert ids(gone) == ["other"] and are_reported(gone.notices, "clipped-away line")
    wide = LINE.replace("line", "wide").replace('"3"', '"30"').replace("/>", ' clip-path="url(#Clip)"/>')
    shape = '<path id="shape" d="M60 0h9v9z" clip-path="url(#Clip)"/>'
    reaching_in = clip('<rect width="50" height="25"/>', wide + shape + LINE.replace("line", "other"))
    assert ids(reaching_in) == ["other"], "the middle line decides, as its notice says"
    assert are_reported(reaching_in.notices, "clipped-away wide 'middle line'", "clipped-away shape")
    assert sum("middle line" in notice.sentence for notice in reaching_in.notices) == 1


@pytest.mark.parametrize("is_upright", [False, True])
def test_a_mask_on_a_line_without_height_or_width_keeps_all_that_it_shows(is_upright):
    """The bounds of such a line have no area, of which the default rectangle of a mask is a part."""
    turn = ' transform="rotate(90 30 30)"' if is_upright else ""
    d = "M30 -10V50" if is_upright else "M10 30H70"
    line = f'<g{turn}><path id="line" fill="none" stroke="#000" stroke-width="2" d="{d}" mask="url(#m)"/></g>'
    shown = '<rect x="-60" y="-60" width="200" height="200" fill="#fff"/><circle cx="30" cy="30" r="5"/>'
    (element,) = read(f'<mask id="m">{shown}</mask>{line}').elements
    assert np.ravel(sorted(map(sorted, spans(element)))) == pytest.approx([10, 25, 35, 70], abs=0.01)
    hidden = read(f'<mask id="m" width="200%">{shown}</mask>{line}{LINE.replace("line", "other")}')
    assert ids(hidden) == ["other"] and are_reported(hidden.notices, "clipped-away line")


def test_a_line_that_a_clip_path_cuts_lengthwise_is_reported():
    """The width of a line is not cut, so paint goes beyond the edge, as with strokes that Figma draws inside."""
    line = '<path id="{}" d="{}" fill="none" stroke="#000" stroke-width="4" clip-path="url(#Clip)"/>'
    window = '<rect x="10" y="10" width="80" height="40"/>'
    along = line.format("along", "M10 11h80") + line.format("around", "M10 10h80v40h-80z")
    across = line.format("across", "M0 30h100") + line.format("slanted", "M60 0L100 40") + line.format("in", "M20 40h9")
    design = clip(window, along + across)
    assert are_reported(design.notices, "clipping-unread along '1 mm beyond'", "clipping-unread around '2 mm beyond'")


@pytest.mark.parametrize(
    ("kind", "fill", "is_read"),
    [
        ('style="mask-type:alpha"', "#D9D9D9", True),
        ('mask-type="alpha"', "#000", True),
        ('class="alpha"', "#D9D9D9", True),
        ('style="mask-type:luminance"', "#fff", True),
        ('style="mask-type:luminance"', "#D9D9D9", False),
        ('style="mask-type:alpha"', "#D9D9D980", False),
        ('style="mask-type:alpha"', "#fff' fill-opacity='.5", False),
    ],
)
def test_masks_of_opaque_shapes_are_read_for_their_alpha(kind, fill, is_read):
    """Figma writes each shape that is used as a mask as a grey one whose alpha counts."""
    shape = f"<rect x='20' width='30' height='60' fill='{fill}' stroke='none'/>"
    design = read(f'<style>.alpha{{mask-type:alpha}}</style><mask id="m" {kind}>{shape}</mask>{MASKED}')
    assert np.ravel(spans(design.elements[0])) == pytest.approx([20, 50] if is_read else [10, 70])
    assert are_reported(design.notices, *([] if is_read else ["clipping-unread line"]))


def test_shapes_are_intersected_with_clip_paths():
    square = '<rect id="s" x="10" y="10" width="40" height="40" clip-path="url(#Clip)"/>'
    (element,) = clip('<rect x="30" y="30" width="40" height="30"/>', square).elements
    points = np.concatenate([p.cubics[:, 0] for p in element.subpaths])
    assert points.min(axis=0) == pytest.approx((30, 10)) and points.max(axis=0) == pytest.approx((50, 30))
    half = 'clipPathUnits="objectBoundingBox"'
    (element,) = clip('<rect width=".5" height="1"/>', square, half).elements
    points = np.concatenate([p.cubics[:, 0] for p in element.subpaths])
    assert points.max(axis=0) == pytest.approx((30, 50))


def test_a_clipped_shape_has_no_stroke_along_the_clip():
    both = '<rect id="s" x="10" y="10" width="40" height="40" stroke="#000" stroke-width="2" clip-path="url(#Clip)"/>'
    shape, stroke = clip('<rect x="0" y="0" width="30" height="60"/>', both).elements
    assert (shape.id, stroke.id) == ("s", "s-stroke") and shape.stroke_width_mm == 0 and stroke.fill_rule == ""
    ends = stroke.subpaths[0].cubics
    assert {round(ends[0, 0, 0], 6), round(ends[-1, 3, 0], 6)} == {30.0}


def test_a_cut_line_keeps_its_widths():
    from brushsvg.read.clipping import clip_element, fill_region
    from brushsvg.read.design import Element, SubPath

    cubics = np.array([[(0, 0), (10, 0), (20, 0), (30, 0)]], float)
    line = SubPath(cubics, widths=np.array([(0.0, 1.0), (0.5, 3.0), (1.0, 1.0)]))
    window = fill_region([np.array([(10, -5), (25, -5), (25, 5), (10, 5.0)])], "nonzero")
    (piece,) = clip_element(Element("a", (line,), 0.0), window)[0].subpaths
    along = 10 + 15 * piece.widths[:, 0]
    assert piece.widths[:, 1] == pytest.approx(np.interp(along, [0, 15, 30], [1, 3, 1]), abs=1e-6)


def test_a_closed_line_of_varying_width_keeps_its_widths_where_it_begins_inside():
    """A closed line of varying width keeps its widths if it begins inside the clip.

    The two parts that meet at its beginning were once joined without their widths, and painted 0 mm wide.
    """
    from brushsvg.read.clipping import clip_element, fill_region
    from brushsvg.read.design import Element, SubPath

    corners = np.array([(0, 0), (30, 0), (30, 30), (0, 30), (0, 0)], float)
    a, b = corners[:-1], corners[1:]
    cubics = np.stack([a, a + (b - a) / 3, b - (b - a) / 3, b], axis=1)
    ring = SubPath(cubics, True, np.array([(0.0, 2.0), (0.5, 4.0), (1.0, 2.0)]))
    window = fill_region([np.array([(-5, -5), (15, -5), (15, 15), (-5, 15.0)])], "nonzero")
    first, last = clip_element(Element("a", (ring,), 0.0), window)[0].subpaths
    assert first.widths[[0, -1], 1] == pytest.approx([2.0, 2.5]) and last.widths[[0, -1], 1] == pytest.approx(
        [2.5, 2.0]
    )


@pytest.mark.parametrize(
    ("clips", "more"),
    [
        ("<text>A</text>", ""),
        ('<rect width="50" height="60" style="transform: translate(9px, 0)"/>', ""),
        ('<rect width="50" height="60"/>', 'clip-path="url(#Clip)"'),
    ],
)
def test_an_unsupported_clip_path_is_reported(clips, more):
    design = clip(clips, CUT, more)
    assert spans(design.elements[0]) == [(10, 70)]
    assert are_reported(design.notices, "clipping-unread")


POWER = (
    '<defs><inkscape:path-effect id="pe" effect="powerstroke" is_visible="true" scale_width="1" {caps}'
    ' interpolator_type="Linear" offset_points="0.2,1.2 | 0.8,1"/></defs>'
    '<path id="p" inkscape:path-effect="#pe" inkscape:original-d="M10 30H70" d="M10 30H70"/>'
)


def test_a_powerstroke_with_a_cap_of_zero_width_tapers():
    design = read(POWER.format(caps='start_linecap_type="zerowidth" end_linecap_type="round"'), f"{PAGE} {INKSCAPE}")
    at, widths = design.elements[0].subpaths[0].widths.T
    assert np.interp([0.0, 0.1, 0.2, 1.0], at, widths) == pytest.approx([0.0, 1.2, 2.4, 2.0])
    round_ends = read(POWER.format(caps=""), f"{PAGE} {INKSCAPE}").elements[0].subpaths[0].widths
    assert round_ends[0, 1] == pytest.approx(2.4)
    peak = read(POWER.format(caps='start_linecap_type="peak"'), f"{PAGE} {INKSCAPE}")
    assert are_reported(peak.notices, "path-effect-unread peak")


def saved(document, tmp_path):
    document.saveas(tmp_path / "a.dxf")
    return brushsvg.read_drawing(tmp_path / "a.dxf", ReadOptions(sheet_mm=(200, 200), lenient=True))


def test_attributes_of_a_block_array_are_in_each_cell(tmp_path):
    document = ezdxf.new("R2010", units=4)
    block = document.blocks.new("B")
    block.add_line((0, 0), (5, 0))
    insert = document.modelspace().add_blockref("B", (10, 10), {"row_count": 2, "column_count": 3})
    insert.dxf.row_spacing, insert.dxf.column_spacing = 20, 15
    insert.add_attrib("T", "I", (10, 12), {"height": 5})
    design = saved(document, tmp_path)
    places = [np.concatenate([p.cubics for p in e.subpaths]).reshape(-1, 2).min(axis=0) for e in design.elements]
    texts, lines = (
        [p for p, e in zip(places, design.elements, strict=True) if e.fill_rule],
        len(design.elements) - 6,
    )
    assert len(texts) == 6 and lines == 6
    assert np.ptp(texts, axis=0) == pytest.approx((30, 20), abs=1e-6)


def test_weights_of_a_spline_may_all_be_negative(tmp_path):
    found = []
    for sign in (1, -1):
        document = ezdxf.new("R2010", units=4)
        points = [(0, 0, 0), (0, 10, 0), (10, 10, 0), (10, 0, 0)]
        document.modelspace().add_open_spline(points).weights = [sign * w for w in (1, 2, 1, 1)]
        found.append(saved(document, tmp_path).elements[0].subpaths[0].cubics)
    assert np.array_equal(*found)


def pen_stroke(points, widths, element):
    """Return a pressure stroke as drawing programs write it.

    Each piece between two samples has a width of its own.
    """
    pairs = zip(points[:-1], points[1:], widths, strict=True)
    return "".join(element.format(*begin, *end, width) for begin, end, width in pairs)


PIECES = {
    "tuhi": '<line x1="{:.3f}" y1="{:.3f}" x2="{:.3f}" y2="{:.3f}" style="stroke-width:{:.3f};stroke-linecap:round"/>',
    "xournal": '<path d="M {:.4f} {:.4f} L {:.4f} {:.4f}" style="fill:none;stroke-width:{:.4f}"/>',
    "fabric": '<g><path d="M {:.2f} {:.2f} L {:.2f} {:.2f}" stroke-width="{:.2f}" fill="none"/></g>',
    "polyline": '<polyline points="{:.2f},{:.2f} {:.2f},{:.2f}" stroke-width="{:.1f}" fill="none"/>',
}


@pytest.mark.parametrize("program", PIECES)
def test_strokes_of_a_pressure_pen_are_one_line_each(tmp_path, program):
    t = np.linspace(0, 1, 81)
    paths = [np.column_stack([10 + 70 * t, y + 8 * np.sin(5 * t)]) for y in (15, 35)]
    widths = [2 + np.sin(4 * (t[1:] + t[:-1]) / 2 + k) for k in range(2)]
    body = "".join(pen_stroke(*each, PIECES[program]) for each in zip(paths, widths, strict=True))
    design = from_file(tmp_path, f'<svg {PAGE}><g stroke="#000">{body}</g></svg>'.encode())
    assert len(design.elements) == 2
    assert are_reported(design.notices, "pressure-strokes 160 2")
    for element, path, target in zip(design.elements, paths, widths, strict=True):
        (line,) = element.subpaths
        assert line.cubics[:, 3] * [1, -1] + [0, 60] == pytest.approx(path[1:], abs=0.01)
        middles = np.cumsum(np.hypot(*np.diff(path, axis=0).T)) - np.hypot(*np.diff(path, axis=0).T) / 2
        found = np.interp(middles / np.hypot(*np.diff(path, axis=0).T).sum(), *line.widths.T)
        assert found == pytest.approx(target, rel=0.05)


def test_lines_that_only_meet_are_not_joined_as_a_pressure_stroke(tmp_path):
    square = "".join(
        f'<path d="M{a}L{b}" stroke="#000" stroke-width="2"/>'
        for a, b in (("10 10", "50 10"), ("50 10", "50 40"), ("50 40", "10 40"))
    )
    corner = '<g stroke="#000"><path d="M60 10H80" stroke-width="1"/><path d="M80 10V40" stroke-width="1.5"/></g>'
    design = from_file(tmp_path, f'<svg {PAGE} fill="none">{square}{corner}</svg>'.encode())
    assert len(design.elements) == 5 and not design.notices
