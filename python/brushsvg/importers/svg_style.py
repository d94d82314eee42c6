"""Which SVG properties an element has: attributes, style="", inheritance. CSS rules are not read yet."""

from __future__ import annotations

import re
from functools import lru_cache

from ..errors import Error
from ..units import length_px
from .svg_colour import parse_colour

INHERITED = {
    "stroke": "none",
    "stroke-width": "1",
    "stroke-opacity": "1",
    "stroke-dasharray": "none",
    "fill": "",  # "" is SVG's default black that nobody asked for
    "color": "#000000",
    "visibility": "visible",
    "marker-start": "none",
    "marker-mid": "none",
    "marker-end": "none",
}
_OWN = {
    "display": "inline",
    "opacity": "1",
    "vector-effect": "none",
    "clip-path": "none",
    "mask": "none",
    "filter": "none",
}
# Geometry as CSS properties: only style="" can say it this way.
_GEOMETRY = ("transform", "d", "x", "y", "width", "height", "cx", "cy", "r", "rx", "ry")

_DECLARATION = re.compile(r"""(?:[^;("']|\([^)]*+\)?|"[^"]*+"?|'[^']*+'?)+""")
_COMMENT = re.compile(r"/\*.*?(?:\*/|\Z)", re.DOTALL)
_URL = re.compile(r"url\(([^)]*+)\)(.*)", re.DOTALL)

Problem = tuple[str, bool]  # a sentence, and whether geometry is damaged


def cascade(
    parent: dict[str, str], attributes: dict[str, str], diagonal: float
) -> tuple[dict[str, str], dict[str, str], list[Problem]]:
    """An element's inherited properties and its own ones, and what was wrong with them.

    Colours come back as "#rrggbb", "none", "currentcolor" or url(...), widths as written. What is not valid
    falls back to the parent's, as CSS asks. diagonal: of the viewport [px], base of percentages.
    """
    said = {name: value for name in (*INHERITED, *_OWN) if (value := attributes.get(name)) is not None}
    problems: list[Problem] = []
    for name, value in _declarations(attributes.get("style", "")):
        if name == "marker":
            said.update(dict.fromkeys(("marker-start", "marker-mid", "marker-end"), value))
        elif name in INHERITED or name in _OWN:
            said[name] = value
        elif name in _GEOMETRY and value not in ("none", "auto"):
            problems.append((f"{name} in style is not read yet: only the attribute counts", False))
    inherited, own = dict(parent), dict(_OWN)
    for name, text in said.items():
        value = text.strip()
        keyword = value.lower()
        if keyword in ("initial", "unset", "revert", "inherit"):
            if keyword == "initial" and name in INHERITED:
                inherited[name] = INHERITED[name]
            elif keyword == "inherit" and name in _OWN:
                problems.append((f"{name} 'inherit' is not read yet: left out", False))
        elif name in _OWN:
            own[name] = keyword
        elif name in ("stroke", "fill", "color"):
            colour = _paint(value)
            if colour is None:
                problems.append((f"{name} {value[:40]!r} is not a colour: it counts as not given", False))
            elif name != "color" or colour not in ("none", "currentcolor"):
                inherited[name] = colour
        elif name == "stroke-width":
            try:
                if length_px(value, diagonal) < 0:
                    raise Error(f"{value[:24]!r} is negative")
                inherited[name] = value
            except Error as error:
                problems.append((f"stroke-width: {error}; it counts as not given", True))
        else:
            inherited[name] = keyword if name == "visibility" else value
    return inherited, own, problems


@lru_cache
def _declarations(style: str) -> tuple[tuple[str, str], ...]:
    parts = (text.partition(":") for text in _DECLARATION.findall(_COMMENT.sub(" ", style)))
    pairs = ((name.strip().lower(), _without_important(value)) for name, _, value in parts)
    return tuple(pair for pair in pairs if pair[1])


def _without_important(value: str) -> str:
    head, mark, tail = value.rpartition("!")
    return head.strip() if mark and tail.strip().lower() == "important" else value.strip()


def _paint(value: str) -> str | None:
    if value.lower() == "currentcolor":
        return "currentcolor"
    if _URL.match(value):
        return value
    return parse_colour(value)


def stroke_colour(properties: dict[str, str]) -> tuple[str, str | None]:
    """ "#rrggbb" or "none", and a sentence if the stroke is painted with something else than a colour."""
    stroke = properties["stroke"]
    if is_zero(properties["stroke-opacity"]):
        return "none", None
    if stroke == "currentcolor":
        return properties["color"], None
    if found := _URL.match(stroke):
        fallback = parse_colour(found[2]) if found[2].strip() else None
        colour = fallback if fallback not in (None, "none") else "#000000"
        return colour, f"the stroke's paint {found[1][:40]} is not read yet: it counts as {colour}"
    return stroke, None


def is_zero(number: str) -> bool:
    """Whether an opacity leaves nothing to see: 0, 0.0, 0%."""
    try:
        return length_px(number, 1.0) <= 0
    except Error:
        return False


def unread(properties: dict[str, str], own: dict[str, str], has_vertices: bool) -> list[str]:
    """Sentences about properties of a painted element that change its look and are not read yet."""
    sentences = []
    dashes = properties["stroke-dasharray"].replace(",", " ").split()
    if dashes != ["none"] and not all(map(is_zero, dashes)):
        sentences.append("dashes are not read yet: the line counts as solid")
    if has_vertices and any(properties[f"marker-{place}"] != "none" for place in ("start", "mid", "end")):
        sentences.append("markers are not read yet: left out")
    if properties["stroke-opacity"] not in ("1", "1.0", "100%"):
        sentences.append("stroke-opacity is not read yet: it counts as 1")
    if own["vector-effect"] != "none":
        sentences.append(f"vector-effect {own['vector-effect'][:40]} is not read yet: left out")
    return sentences


def unread_own(own: dict[str, str]) -> list[str]:
    """Sentences about properties of an element or group that apply to all it holds and are not read yet."""
    effects = [name for name in ("clip-path", "mask", "filter") if own[name] != "none"]
    sentences = [f"{name} is not read yet: it counts as none" for name in effects]
    if own["opacity"] not in ("1", "1.0", "100%"):
        sentences.append("opacity is not read yet: it counts as 1")
    return sentences
