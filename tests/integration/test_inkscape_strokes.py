"""Convert to strokes works in the real Inkscape.

Filled letters become lines with a width, and Inkscape draws these lines like the letters.
"""

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import cv2
import numpy as np
import pytest
from command import OPEN, SOUND, brushsvg

from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg

SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
FONT = Path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")
OTHERS = """<path id="line" d="M 20,70 H 90" style="fill:none;stroke:#a00000;stroke-width:4"/>
 <text id="word" x="20" y="20">text</text>"""
HEADS = {
    "mm": 'width="150mm" height="130mm" viewBox="0 0 150 130"',
    "px": 'width="500" height="450"',
    "in": 'width="6in" height="5in" viewBox="-5 -8 160 130"',
    "wide": 'width="200mm" height="130mm" viewBox="0 0 150 130" preserveAspectRatio="xMaxYMid"',
}


def letters(text="oS", size_mm=50.0) -> str:
    svg, _ = text_svg(text, FONT.read_bytes(), size_mm=size_mm, width_mm=None, sheet_mm=None)
    root = ET.fromstring(svg)
    return "".join(
        f'<path id="{node.get("id")}" style="fill:#203060" d="{node.get("d")}"/>' for node in root.iter(f"{SVG}path")
    )


def drawing(head: str) -> str:
    body = f"""<g inkscape:groupmode="layer" inkscape:label="Ink" id="layer1" transform="translate(5,3)">
     <g id="turned" transform="rotate(8) scale(0.9)">{letters()}</g>{OTHERS}</g>"""
    body = f'<g id="all" transform="scale(3)">{body}</g>' if head == "px" else body
    spaces = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    return f"<svg {spaces} {HEADS[head]}>{body}</svg>"


def converted(plugin, source: Path, select: str = "turned") -> Path:
    return plugin.effect("strokes", source, source.with_name("strokes.svg"), select)


def lines_of(text: str) -> list:
    return [node for node in ET.fromstring(text).iter(f"{SVG}path") if node.get(f"{INKSCAPE}original-d")]


def redrawn(inkscape, file: Path, out: Path) -> Path:
    """Let Inkscape redraw path effects, as it does when a path changes."""
    ids = ",".join(node.get("id") for node in lines_of(file.read_text()))
    moves = "transform-translate:1,0;transform-translate:-1,0"
    inkscape(f"--actions=select-by-id:{ids};{moves};export-filename:{out};export-do", file)
    return out


def ink(inkscape, file: Path) -> np.ndarray:
    return cv2.imread(str(inkscape.paint(file, 8)), cv2.IMREAD_UNCHANGED)[..., 3] / 255


def overlap(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.minimum(a, b).sum() / np.maximum(a, b).sum())


@pytest.mark.parametrize("head", HEADS)
def test_converted_strokes_look_and_paint_like_their_letters(plugin, inkscape, tmp_path, head):
    source = tmp_path / "letters.svg"
    source.write_text(drawing(head))
    done = converted(plugin, source)
    changed = redrawn(inkscape, done, tmp_path / "redrawn.svg")
    before, ours, theirs = (ink(inkscape, file) for file in (source, done, changed))
    assert len(lines_of(done.read_text())) == 2
    for old, new in zip(lines_of(done.read_text()), lines_of(changed.read_text()), strict=True):
        assert old.get("d") != new.get("d"), "Inkscape has not drawn the effect"
    assert overlap(ours, theirs) > 0.99
    assert overlap(theirs, before) > 0.95
    assert theirs.sum() == pytest.approx(before.sum(), rel=0.04)
    assert_painted_alike(source, done)


def assert_painted_alike(letters: Path, strokes: Path) -> None:
    """Check that both files have equal strokes with equal marks.

    Poses may differ within the tolerance of the mark. A PowerStroke has no slanted cap. At a slanted end of a
    letter, as in an S, its stroke ends round, 0.13 mm from the cut.
    """
    plans, marks = [], []
    for drawn in (letters, strokes):
        for command, found in (("convert", plans), ("preview", marks)):
            out = drawn.with_suffix(f".{command}.json")
            # the search for filled shapes adds strokes to letters, but not to lines
            brushsvg(command, drawn, "-o", out, "--corners", "turn", cwd=drawn.parent, status=0)
            found.append(json.loads(out.read_text())["passes"])
    assert len(plans[0]) == len(plans[1])
    for letter, stroke in zip(*plans, strict=True):
        assert (letter["layer"], letter["colour"]) == (stroke["layer"], stroke["colour"])
    for plan, letter, stroke in zip(plans[0], *marks, strict=True):
        a, b = (np.vstack(each["outline_mm"]) for each in (letter, stroke))
        most_mm = 0.15 if "S" in plan["stroke"] else 0.1
        assert np.abs(a.min(axis=0) - b.min(axis=0)).max() < most_mm, plan["stroke"]
        assert np.abs(a.max(axis=0) - b.max(axis=0)).max() < most_mm, plan["stroke"]


def test_sheared_letters_are_converted_correctly(plugin, inkscape, tmp_path):
    source, out = tmp_path / "letters.svg", tmp_path / "strokes.svg"
    source.write_text(drawing("mm").replace("scale(0.9)", "skewX(20)"))
    out.write_bytes(plugin.script("strokes", source, "--id=turned").stdout)
    assert overlap(ink(inkscape, source), ink(inkscape, out)) > 0.95
    assert_painted_alike(source, out)


def attributes(text: str) -> dict:
    return {
        node.get("id"): dict(node.attrib)
        for node in ET.fromstring(text).iter()
        if re.fullmatch("glyph-[0-9]-[a-zA-Z]|line|word|layer1|turned", node.get("id") or "")
    }


def test_letters_stay_hidden_next_to_their_strokes_and_other_elements_unchanged(plugin, tmp_path):
    source = tmp_path / "letters.svg"
    source.write_text(drawing("mm"))
    done = converted(plugin, source)
    assert attributes(done.read_text()) == attributes(source.read_text())
    root = ET.fromstring(done.read_text())
    parents = {child: parent for parent in root.iter() for child in parent}
    for node in root.iter(f"{SVG}path"):
        if (node.get("id") or "") in ("glyph-1-o", "glyph-2-S"):
            hidden, group = parents[node], parents[parents[node]]
            assert hidden.get("style") == "display:none" and hidden.get("data-brushsvg-skip") == "yes"
            assert parents[group].get("id") == "turned" and len(group) >= 2
    names = [node.get("id") for node in root.iter() if node.get("id")]
    assert len(names) == len(set(names))


def test_only_the_selection_is_converted(plugin, tmp_path):
    source = tmp_path / "letters.svg"
    source.write_text(drawing("mm"))
    done = converted(plugin, source, "glyph-2-S")
    text = done.read_text()
    assert 'id="glyph-2-S-strokes"' in text and 'id="glyph-1-o-strokes"' not in text


def test_edited_widths_are_read_back(plugin, inkscape, tmp_path):
    """A PowerStroke that Inkscape has moved is read back as the moved stroke."""
    source = tmp_path / "letters.svg"
    source.write_text(f"{OPEN}{letters('S', 30)}</svg>")
    done = converted(plugin, source, "")
    moved = tmp_path / "moved.svg"
    (line,) = lines_of(done.read_text())
    move = f"select-by-id:{line.get('id')};transform-translate:10,0"
    inkscape(f"--actions={move};export-filename:{moved};export-do", done)
    (a,), (b,) = (
        read_svg(file.read_text().replace('data-brushsvg-skip="yes"', "").encode()).elements for file in (done, moved)
    )
    step_mm = np.ptp(b.subpaths[0].cubics - a.subpaths[0].cubics, axis=(0, 1))
    assert step_mm.max() < 1e-3, "all of it moves alike"
    assert b.subpaths[0].widths == pytest.approx(a.subpaths[0].widths, abs=2e-3)


@pytest.mark.parametrize(
    ("body", "reported"),
    [
        (SOUND, "no filled shape"),
        (f"{OPEN}</svg>", "nothing to paint"),
        (f'{OPEN}<text id="word" x="20" y="20"> </text></svg>', "nothing to paint"),
    ],
)
def test_elements_that_cannot_be_converted_are_reported(plugin, tmp_path, body, reported):
    source = tmp_path / "drawing.svg"
    source.write_text(body)
    done = plugin.script("strokes", source)
    assert done.returncode == 1 and not done.stdout
    assert reported in done.stderr.decode() and "Traceback" not in done.stderr.decode()


def test_copies_and_nested_drawings_are_converted(plugin, inkscape, tmp_path):
    inner = f'<svg id="inner" x="70" y="2" width="60" height="60" viewBox="10 0 80 80">{letters("S")}</svg>'
    copy = '<use id="copy" xlink:href="#glyph-1-S" transform="translate(-10,5) scale(0.7)"/>'
    source = tmp_path / "drawing.svg"
    spaces = OPEN.replace("<svg", '<svg xmlns:xlink="http://www.w3.org/1999/xlink"')
    source.write_text(f"{spaces}{inner}{copy}</svg>")
    done = plugin.script("strokes", source)
    assert done.returncode == 0, done.stderr
    out = tmp_path / "strokes.svg"
    out.write_bytes(done.stdout)
    assert overlap(ink(inkscape, source), ink(inkscape, out)) > 0.9


def test_converted_again_next_to_text_lines_stay_lines(plugin, tmp_path):
    """A second conversion next to text keeps lines.

    Inkscape draws text as paths for us. It then also draws every PowerStroke as an outline.
    """
    source = tmp_path / "letters.svg"
    source.write_text(drawing("mm"))
    once = converted(plugin, source)
    later = tmp_path / "later.svg"
    word = '<text id="later" x="20" y="120" style="font-size:20px;fill:#000">l</text></svg>'
    later.write_text(once.read_text().replace("</svg>", word))
    twice = plugin.effect("strokes", later, tmp_path / "twice.svg")
    names = {node.get("id") for node in ET.parse(twice).iter()}
    ours = [node.get("id") for node in lines_of(once.read_text())]
    assert "later-strokes" in names and ours
    assert not [name for name in ours if f"{name}-strokes" in names]


def test_copies_of_a_selected_letter_are_unchanged(plugin, tmp_path):
    source = tmp_path / "letters.svg"
    copies = '<g id="both">' + letters("o").replace('id="', 'id="copied-') + '<path id="bar" d="M5 90h60v4h-60z"/></g>'
    name = re.search('id="(copied-[^"]*)"', copies)[1]
    source.write_text(drawing("mm").replace("</svg>", f'{copies}<use id="copy" href="#both" x="40"/></svg>'))
    out = converted(plugin, source, name)
    names = {node.get("id") for node in ET.parse(out).iter()}
    assert f"{name}-strokes" in names and "copy-strokes" not in names
