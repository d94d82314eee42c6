"""Brush preview in the real Inkscape shows the marks of `brushsvg preview`.

Original elements stay unchanged.
"""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from command import SOUND, brushsvg
from diagnostics import gives
from plugin import SOURCE, sentence

from brushsvg import read_drawing
from brushsvg.read import ReadOptions

SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
SODIPODI = "{http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd}"
BODY = """<g inkscape:groupmode="layer" inkscape:label="Ink" id="layer1" transform="translate({0},{0})">
  <g id="turned" transform="rotate(-10)">
   <path id="wave" d="M 10,40 C 20,0 40,0 50,20 S 80,40 90,20" style="fill:none;stroke:#102030;stroke-width:4"/></g>
  <path id="bar" d="M 20,60 H 90" style="fill:none;stroke:#a00000;stroke-width:4"/></g>
 <g inkscape:groupmode="layer" inkscape:label="More" id="layer2">
  <path id="sharp" d="M 20,90 C 110,90 110,93 22,95" style="fill:none;stroke:#0000ff;stroke-width:6"/>
  <use id="copy" href="#turned" x="8" y="52"/><text id="word" x="20" y="20">text</text></g>"""
HEADS = {
    "mm": 'width="150mm" height="130mm" viewBox="0 0 150 130"',
    "px": 'width="500" height="450"',
    "in": 'width="6in" height="5in" viewBox="-5 -8 160 130"',
    "wide": 'width="200mm" height="130mm" viewBox="0 0 150 130" preserveAspectRatio="xMaxYMid"',
    "slice": 'width="200mm" height="130mm" viewBox="0 0 150 130" preserveAspectRatio="xMinYMin slice"',
    "pt": 'width="420pt" height="370pt" viewBox="-12.5 37 210 185"',
    "moved": 'width="150mm" height="130mm" viewBox="-4 -3 165 143"',
    "stretched": 'width="200mm" height="130mm" viewBox="0 0 150 130" preserveAspectRatio="none"',
}


def drawing(head: str) -> str:
    spaces = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    body = BODY.format(5)
    if head == "px":
        body = f'<g id="all" transform="scale(3)">{body}</g>'
    return f"<svg {spaces} {HEADS[head]}>{body}</svg>"


def elements(text: str) -> dict:
    """Return path data, style, transform and parent of all original elements, by id."""
    root = ET.fromstring(text)
    parents = {child: parent for parent in root.iter() for child in parent}
    return {
        node.get("id"): (
            node.tag,
            node.get("d"),
            node.get("style"),
            node.get("transform"),
            parents[node].get("id") if parents[node] is not root else "",
        )
        for node in root.iter()
        if node.get("id") in ("layer1", "turned", "wave", "bar", "layer2", "sharp", "copy", "word", "all")
    }


def preview(text: str):
    (layer,) = (node for node in ET.fromstring(text) if node.get("id") == "brushsvg-preview")
    return layer


def rings_mm(path, tmp_path):
    """Return the corners (n, 2) of the preview's marks on paper, by our own reader."""
    text = path.read_text().replace('data-brushsvg-skip="yes"', "")
    (tmp_path / "shown.svg").write_text(text)
    design = read_drawing(tmp_path / "shown.svg", ReadOptions(select="#brushsvg-preview"))
    return [np.vstack([part.cubics[:, 0] for part in each.subpaths]) for each in design.elements]


def predicted_mm(tmp_path, *flags):
    brushsvg("preview", "drawing.svg", "-o", "marks.svg", *flags, cwd=tmp_path, status=0)
    return [
        np.vstack([part.cubics[:, 0] for part in each.subpaths])
        for each in read_drawing(tmp_path / "marks.svg").elements
    ]


def assert_alike(shown, predicted):
    assert len(shown) == len(predicted) > 0
    for ours, theirs in zip(shown, predicted, strict=True):
        assert ours.shape == theirs.shape
        assert np.abs(ours - theirs).max() < 0.01


@pytest.mark.parametrize("head", HEADS)
def test_marks_agree_with_preview_and_originals_stay(plugin, tmp_path, head):
    source = tmp_path / "drawing.svg"
    source.write_text(drawing(head))
    shown = plugin.effect("preview", source, tmp_path / "shown-in.svg")
    assert_alike(rings_mm(shown, tmp_path), predicted_mm(tmp_path))
    assert elements(shown.read_text()) == elements(source.read_text())


def test_the_preview_layer_is_locked_named_and_replaced(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(drawing("mm"))
    once = plugin.effect("preview", source, tmp_path / "once.svg")
    layer = preview(once.read_text())
    assert layer.get(f"{SODIPODI}insensitive") == "true"
    label = layer.get(f"{INKSCAPE}label")
    assert gives(label, "round-6, closed", "4") and gives(label.partition(" mm")[2], "1", "2")
    assert re.search(r"\d+\.\d\d mm", label)
    assert [("#d4351c" in path.get("style")) for path in layer.iter(f"{SVG}path")] == [
        False,
        False,
        True,
        False,
    ]
    twice = plugin.effect("preview", once, tmp_path / "twice.svg")
    assert_alike(rings_mm(twice, tmp_path), rings_mm(once, tmp_path))


def test_the_preview_layer_is_not_painted(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(drawing("mm"))
    plugin.effect("preview", source, tmp_path / "shown.svg")
    for name in ("drawing", "shown"):
        brushsvg("convert", f"{name}.svg", "-o", f"{name}.ngc", cwd=tmp_path, status=0)
    assert (tmp_path / "shown.ngc").read_bytes() == (tmp_path / "drawing.ngc").read_bytes()


@pytest.mark.parametrize(("select", "css"), [("bar", "#bar"), ("layer1", "#layer1"), ("wave,sharp", "#wave, #sharp")])
def test_only_the_selection_is_shown(plugin, tmp_path, select, css):
    source = tmp_path / "drawing.svg"
    source.write_text(drawing("in"))
    shown = plugin.effect("preview", source, tmp_path / "shown-in.svg", select=select)
    assert_alike(rings_mm(shown, tmp_path), predicted_mm(tmp_path, "--select", css))


def test_a_converted_letter_selects_its_strokes(plugin, tmp_path):
    """A converted letter is hidden but stays selected, next to its strokes."""
    source, strokes = tmp_path / "drawing.svg", tmp_path / "strokes.svg"
    source.write_text(SOUND.replace("</svg>", '<path id="i" d="M 95,10 h 3 v 40 h -3 z"/></svg>'))
    done = plugin.script("strokes", source, "--id=i")
    strokes.write_bytes(done.stdout)
    shown = plugin.script("preview", strokes, "--id=i")
    assert b": 1 stroke, " in shown.stdout and b'label="i' in shown.stdout, shown.stderr
    again = plugin.script("strokes", strokes, "--id=i")
    assert again.stderr.startswith(b"There is no filled shape")


def test_a_selected_preview_layer_is_ignored(plugin, tmp_path):
    source, shown = tmp_path / "drawing.svg", tmp_path / "shown.svg"
    source.write_text(SOUND)
    shown.write_bytes(plugin.script("preview", source).stdout)
    again = plugin.script("preview", shown, "--id=brushsvg-preview")
    assert again.stdout == shown.read_bytes(), again.stderr


def test_displaced_refined_marks_are_red(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(drawing("mm").replace("110,93 22,95", "110,91 22,92"))  # so sharp that refinement gains nothing
    plugin.set(preview__compensation="refined")
    try:
        shown = plugin.effect("preview", source, tmp_path / "shown-in.svg")
    finally:
        plugin.set()
    assert_alike(rings_mm(shown, tmp_path), predicted_mm(tmp_path, "--compensation", "refined"))
    layer = preview(shown.read_text())
    assert gives(layer.get(f"{INKSCAPE}label"), "round-6, refined", "4")
    assert "tolerance" not in layer.get(f"{INKSCAPE}label")
    red = ["#d4351c" in path.get("style") for path in layer.iter(f"{SVG}path")]
    assert red == [False, False, True, False], "the one that turns too sharply, which refinement left as it was"


def test_dialog_settings_override_the_document(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(drawing("mm"))
    plugin.set(preview__brush="rigid", preview__compensation="none")
    try:
        shown = plugin.effect("preview", source, tmp_path / "shown-in.svg")
    finally:
        plugin.set()
    assert_alike(rings_mm(shown, tmp_path), predicted_mm(tmp_path, "--brush", "rigid", "--compensation", "none"))


def test_odd_ids_can_be_selected(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(SOUND.replace('id="line"', 'id="a&quot;b\\c,d]"'))
    done = plugin.script("preview", source, '--id=a"b\\c,d]')
    assert done.returncode == 0, done.stderr
    assert b"1 stroke," in done.stdout


def test_a_user_element_with_the_id_of_the_preview_layer_is_kept(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(SOUND.replace('id="line"', 'id="brushsvg-preview"'))
    shown = ET.fromstring(plugin.script("preview", source).stdout)
    assert [node.get("d") for node in shown if node.get("id") == "brushsvg-preview"] == [
        "M20 40 C40 10 60 10 90 30",
        None,
    ]


def test_an_empty_aspect_ratio_of_a_page_is_ignored(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(SOUND.replace("<svg ", '<svg preserveAspectRatio=" " '))
    done = plugin.script("preview", source)
    assert done.returncode == 0, done.stderr


def test_too_many_selected_ids_are_refused_in_a_sentence(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(SOUND)
    reported = sentence(plugin.script("preview", source, *[f"--id=path{k}" for k in range(8000)]))
    assert gives(reported, "8000")
    done = plugin.script("preview", source, "--id=line", *[f"--id=path{k}" for k in range(3000)])
    assert re.search(rb"round-6, \w+: 1 ", done.stdout), done.stderr


@pytest.mark.parametrize("path", ["M 2,40 H 60", "M 10,40 H 60 L 70"])
def test_the_layer_label_announces_that_saving_will_be_refused(plugin, tmp_path, path):
    """The cases are paint over the edge of the sheet, and damaged path data."""
    source, saved = tmp_path / "drawing.svg", tmp_path / "saved.ngc"
    source.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" {HEADS["mm"]}>'
        f'<path id="edge" d="{path}" style="fill:none;stroke:#000;stroke-width:5"/></svg>'
    )
    label = preview(plugin.effect("preview", source, tmp_path / "shown.svg").read_text()).get(f"{INKSCAPE}label")
    assert gives(label, "refused", "edge") and "--" not in label
    plugin.save(source, saved)
    assert not saved.exists()


@pytest.mark.parametrize("kind", ["PAINTED", "MISSED"])
def test_marks_are_visible_on_ink_of_any_colour(kind, monkeypatch):
    """A mark differs from ink and paper below it by at least a fifth of a channel."""
    monkeypatch.syspath_prepend(SOURCE)
    import brushsvg_preview as shown

    white = np.array([255.0, 255.0, 255.0])
    for ink in np.stack(np.meshgrid(*3 * [np.arange(0, 256, 15)]), axis=-1).reshape(-1, 3):
        colour = np.array(shown.rgb(shown.seen_on(f"#{bytes(ink.tolist()).hex()}", getattr(shown, kind))))
        for under in (ink, white):
            assert np.linalg.norm(shown.OPACITY * (colour - under)) >= 0.2 * 255, (ink, under)


def test_marks_have_a_colour_different_from_the_ink(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    strokes = "".join(
        f'<path d="M10,{y} H90" style="fill:none;stroke:{ink};stroke-width:4"/>'
        for y, ink in ((20, "#000000"), (40, "#1c8fd4"))
    )
    source.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">{strokes}</svg>'
    )
    out = plugin.effect("preview", source, tmp_path / "out.svg")
    layer = preview(out.read_text())
    fills = [node.get("style").split(";")[0] for node in layer if node.tag == f"{SVG}path"]
    assert fills == ["fill:#1c8fd4", "fill:#d98200"]
