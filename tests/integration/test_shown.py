"""No part of a small drawing is lost without a notice.

The test compares Chromium's picture of each drawing with our painting. If the pictures differ, brushsvg must
report the reason. Plain drawings must be painted as shown, without a notice. Dashes are always reported, so
their notice does not count. Caps and joins are round here, since ours are always round.
"""

import numpy as np
import pytest
import shown
import svg_shown

LEAST = 0.03  # share of the area; edges of pixels change dashes and thin lines by less than 0.02


DRAWINGS = {name: text for table in svg_shown.TABLES.values() for name, text in table.items()}
SOUND = svg_shown.page('<path d="M40 50H150V140Z" transform="rotate(5)"/>')
TAMPERED = {
    "nothing": ("", "", False),
    "a line four pixels wider": ("<path", '<path stroke-width="12"', True),
    "turned by two degrees": ("rotate(5)", "rotate(7)", True),
    "moved by two pixels": ("M40 50", "M42 52", True),
    "filled": ("<path", '<path fill="#000"', True),
    "fainter": ("<path", '<path opacity=".8"', True),
    "one less": ("<path", "<g", True),
}


def tampered(change: str) -> str:
    before, after, _ = TAMPERED[change]
    return SOUND.replace(before, after) if before else SOUND


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """Return the darkness of each drawing in Chromium, by its text."""
    texts = [*dict.fromkeys([*DRAWINGS.values(), *map(tampered, TAMPERED)])]
    return dict(zip(texts, shown.shown(texts, tmp_path_factory.mktemp("shown")), strict=True))


@pytest.mark.parametrize("name", svg_shown.TABLES)
def test_differences_from_the_rendered_svg_are_reported(name, pictures):
    table = svg_shown.TABLES[name]
    silent = {}
    for drawing, text in table.items():
        ours, reported = shown.painted(text)
        off = shown.difference(pictures[text], ours)
        if off > LEAST and not reported and drawing not in svg_shown.CHROMIUMS_OWN:
            silent[drawing] = round(off, 2)
    assert silent == {}


def test_plain_drawings_agree_with_chromium_without_notices(pictures):
    found = {}
    for name in svg_shown.PLAIN:
        theirs = pictures[DRAWINGS[name]]
        ours, reported = shown.painted(DRAWINGS[name])
        if reported or not theirs.any() or shown.difference(theirs, ours) > LEAST:
            found[name] = reported, round(shown.difference(theirs, ours), 2)
    assert found == {}


@pytest.mark.parametrize("change", TAMPERED)
def test_the_comparison_detects_another_picture(change, pictures):
    ours, _ = shown.painted(SOUND)
    assert ours.shape == pictures[SOUND].shape and np.ptp(ours) == 1
    assert (shown.difference(pictures[tampered(change)], ours) > LEAST) == TAMPERED[change][2]
