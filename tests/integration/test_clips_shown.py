"""Forty drawings with clip paths are read as Chromium shows them."""

import random

import numpy as np
import pytest
from shown import difference, painted, shown

STAR = "M100 20L124 90L196 92L140 136L160 190L100 158L40 190L60 136L4 92L76 90Z"
RING = "M100 20A80 80 0 1 1 99.9 20ZM100 60A40 40 0 1 1 99.9 60Z"
# outlines of letters, as drawing programs convert text
LETTERS = "M20 40H50V130H90V160H20ZM120 40H150L190 160H158L150 135H122L116 160H86ZM128 108H146L137 78Z"
CLIPS = {
    "circle": '<circle cx="100" cy="95" r="62"/>',
    "rect turned": '<rect x="40" y="50" width="120" height="80" transform="rotate(20 100 100)"/>',
    "star": f'<path d="{STAR}"/>',
    "star evenodd": f'<path d="{STAR}" clip-rule="evenodd"/>',
    "ring evenodd": f'<path d="{RING}" clip-rule="evenodd"/>',
    "ring nonzero": f'<path d="{RING}"/>',
    "two shapes": '<circle cx="60" cy="80" r="40"/><rect x="90" y="70" width="90" height="60" rx="12"/>',
    "letters": f'<path d="{LETTERS}"/>',
    "used": '<use href="#dot" x="30" y="10"/>',
    "ellipse": '<ellipse cx="100" cy="110" rx="90" ry="42"/>',
}
AROUND = ("on the shape", "on a group", "on a use", "clip in clip", "two groups")


def drawing(name: str, around: str, chance: random.Random) -> str:
    x, y, turn = chance.uniform(-15, 15), chance.uniform(-15, 15), chance.uniform(-40, 40)
    units = 'transform="translate(6 -4) scale(.9)"' if chance.random() < 0.4 else ""
    second = '<clipPath id="d"><rect x="25" y="30" width="150" height="130"/></clipPath>'
    own = 'clip-path="url(#d)"' if around == "clip in clip" else ""
    clip = f'<clipPath id="c" {units} {own}>{CLIPS[name]}</clipPath>'
    definitions = f'<circle id="dot" cx="70" cy="80" r="55"/>{second}{clip}'
    fill = chance.choice(['fill-rule="evenodd"', ""])
    moved = f'transform="translate({x:.2f} {y:.2f}) rotate({turn:.2f} 100 100)"'
    shapes = f'<path id="s" d="{chance.choice([STAR, RING])}" {fill} {moved}{{}}/>'
    lines = "".join(
        f'<path fill="none" stroke="#000" stroke-width="2.5" d="M{chance.uniform(0, 40):.1f} {v:.1f}'
        f'Q100 {chance.uniform(-60, 260):.1f} {chance.uniform(150, 200):.1f} {v:.1f}"{{0}}/>'
        for v in (30, 75, 120, 165)
    )
    body = chance.choice([shapes, lines])
    attribute = ' clip-path="url(#c)"'
    if around in ("on the shape", "clip in clip"):
        body = body.format(attribute)
    elif around == "on a group":
        body = f'<g transform="scale(.95)"{attribute}>{body.format("")}</g>'
    elif around == "two groups":
        body = f'<g clip-path="url(#d)"><g transform="translate(4 2)"{attribute}>{body.format("")}</g></g>'
    else:
        body = f'<defs><g id="all">{body.format("")}</g></defs><use href="#all" x="12"{attribute}/>'
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" width="200" height="200" viewBox="0 0 200 200">'
        f"<defs>{definitions}</defs>{body}</svg>"
    )


MASK_UNITS = (
    "",
    'maskUnits="userSpaceOnUse" x="20" y="10" width="150" height="160"',
    'x="0" y="5%" width="0.9" height="80%"',
)
MASKED = {
    "on the shape": '<path d="{0}" mask="url(#m)"/>',
    "on a group": '<g transform="rotate(9)" mask="url(#m)"><path d="{0}"/></g>',
    "on a use": '<defs><path id="s" d="{0}"/></defs><use href="#s" x="10" mask="url(#m)"/>',
}


def test_masks_of_white_and_black_shapes_agree_with_chromium(tmp_path):
    chance, drawings = random.Random(7), {}
    for name, shape in CLIPS.items():
        around = chance.choice([*MASKED])
        units = chance.choice(MASK_UNITS if around == "on the shape" else MASK_UNITS[:2])
        shape = shape.replace("clip-rule", "fill-rule")
        hole = f'<g fill="black" transform="translate(30 {chance.uniform(0, 40):.1f}) scale(.5)">{CLIPS["star"]}</g>'
        mask = f'<mask id="m" {units}><g fill="white">{shape}</g>{hole}</mask>'
        drawings[name, around, units] = (
            '<svg xmlns="http://www.w3.org/2000/svg" width="200" height="200" viewBox="0 0 200 200">'
            f'<defs><circle id="dot" cx="70" cy="80" r="55"/></defs>{mask}{MASKED[around].format(RING)}</svg>'
        )
    seen = shown(list(drawings.values()), tmp_path)
    for (name, text), dark in zip(drawings.items(), seen, strict=True):
        ours, reported = painted(text)
        assert not reported and difference(dark, ours) <= 0.01, (name, reported)


@pytest.fixture(scope="module")
def pairs(tmp_path_factory):
    chance = random.Random(52)
    names = [(name, around) for name in CLIPS for around in AROUND][:50]
    drawings = {each: drawing(*each, chance) for each in chance.sample(names, 40)}
    dark = shown(list(drawings.values()), tmp_path_factory.mktemp("clips"))
    return {each: (text, seen) for (each, text), seen in zip(drawings.items(), dark, strict=True)}


def test_clipped_drawings_agree_with_chromium(pairs):
    """Lines are cut at their middle: where one runs along the edge of a clip path, half of its width is too much or
    missing."""
    alike = {}
    for each, (text, seen) in pairs.items():
        ours, reported = painted(text, cap="flat")
        assert not [one for one in reported if "clip" in one and "left out" not in one and "lengthwise" not in one], (
            each,
            reported,
        )
        alike[each] = 1.0 - difference(seen, ours)
    assert len(alike) == 40
    worst = sorted(alike.items(), key=lambda item: item[1])
    assert worst[2][1] >= 0.99, worst[:5]
    assert np.mean(list(alike.values())) >= 0.99
