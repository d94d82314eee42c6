"""Which SVG properties an element has: attributes, CSS rules, style="", inheritance, in the order CSS prescribes."""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass
from functools import cache, lru_cache
from operator import itemgetter

import tinycss2

from ..errors import Error
from ..units import length_px
from .svg_colour import parse_colour
from .svg_rules import Declaration, declarations

INHERITED = {
    "stroke": "none",
    "stroke-width": "1",
    "stroke-opacity": "1",
    "stroke-dasharray": "none",
    "stroke-dashoffset": "0",
    "fill": "",  # SVG's default, black, that nobody asked for
    "fill-opacity": "1",
    "fill-rule": "nonzero",
    "color": "#000000",
    "visibility": "visible",
    "marker-start": "none",
    "marker-mid": "none",
    "marker-end": "none",
}
OWN = {
    "display": "inline",
    "opacity": "1",
    "vector-effect": "none",
    "clip-path": "none",
    "mask": "none",
    "filter": "none",
    "overflow": "",
}
# Attributes that CSS may set as well; CSS wins.
_GEOMETRY = frozenset("transform transform-origin d x y width height cx cy r rx ry".split())
_PRESENTED = (*INHERITED, *OWN)  # as attributes, in the order of what is told about them
_READ = frozenset(_PRESENTED) | _GEOMETRY
_MARKERS = ("marker-start", "marker-mid", "marker-end")
_URL = re.compile(r"url\(([^)]*+)\)(.*)", re.DOTALL)
_LONGEST_VALUE = 10_000  # of custom properties put into each other

Problem = tuple[str, bool]  # a sentence, and whether geometry is damaged


@dataclass(frozen=True)
class Style:
    """Computed values. Colours are "#rrggbb", "none", "currentcolor" or url(...), widths as written.

    inherited: what children start from, custom properties among them; own: what they do not; geometry:
    attributes that CSS replaces.
    """

    inherited: dict[str, str]
    own: dict[str, str]
    geometry: dict[str, str]


INITIAL = Style(INHERITED, OWN, {})


def cascade(
    parent: Style, attributes: dict[str, str], rules: list[Declaration], diagonal: float
) -> tuple[Style, list[Problem]]:
    """An element's style, and what was wrong with it: what is not valid falls back to the parent's, as CSS asks.

    rules: declarations of the style sheets, the strongest last; diagonal: of the viewport [px], base of percentages.
    """
    inline = declarations(attributes["style"]) if "style" in attributes else ()
    said: dict[str, list[str]] = {name: [attributes[name]] for name in _PRESENTED if name in attributes}
    if not (said or rules or inline):
        return Style(parent.inherited, OWN, {}), []
    for name, value, _ in sorted((*rules, *inline), key=itemgetter(2)):
        for each in _MARKERS if name == "marker" else (name,):
            if each in _READ or each.startswith("--"):
                said.setdefault(each, []).append(value)
    inherited, own, geometry = dict(parent.inherited), dict(OWN), {}
    inherited.update((name, said.pop(name)[-1]) for name in list(said) if name.startswith("--"))
    problems: list[Problem] = []
    for name, values in said.items():
        for text in reversed(values):  # the strongest that is valid
            value = text.strip()
            if "var(" in value.lower():
                value = _substituted(value, inherited)
            if name in _GEOMETRY:
                geometry[name] = _path_text(value) if name == "d" else value
                break
            target, initial = (inherited, INHERITED) if name in INHERITED else (own, OWN)
            keyword = value.lower()
            if keyword in ("inherit", "initial", "unset", "revert"):
                if keyword == "initial" or (keyword != "inherit" and target is own):
                    target[name] = initial[name]
                elif keyword == "inherit":
                    target[name] = (parent.inherited if target is inherited else parent.own)[name]
                break
            problem = _problem(name, value, diagonal)
            if problem is None:
                target[name] = _computed(name, value, inherited)
                break
            problems.append(problem)
    return Style(inherited, own, geometry), problems


def _problem(name: str, value: str, diagonal: float) -> Problem | None:
    """Why a value is not one of its property."""
    if name in ("stroke", "fill", "color"):
        if not _URL.match(value) and parse_colour(value) is None:
            return f"{name} {value[:40]!r} is not a colour: it counts as not given", False
    elif name == "stroke-width":
        try:
            if length_px(value, diagonal) < 0:
                raise Error(f"{value[:24]!r} is negative")
        except Error as error:
            return f"stroke-width: {error}; it counts as not given", True
    return None


def _computed(name: str, value: str, inherited: dict[str, str]) -> str:
    if name in ("stroke", "fill"):
        return value if _URL.match(value) else parse_colour(value)
    if name == "color":
        colour = None if _URL.match(value) else parse_colour(value)
        return inherited["color"] if colour in (None, "none", "currentcolor") else colour
    if name == "fill-rule":
        return "evenodd" if value.lower() == "evenodd" else "nonzero"
    return value if name == "stroke-width" or name in _MARKERS else value.lower()


def _substituted(value: str, inherited: dict[str, str]) -> str:
    """A value with its var(--name, fallback) replaced; "" where that leads nowhere."""

    @cache  # or variables that name two others each would take for ever
    def at(depth: int, value: str) -> str:
        parts = []
        for token in tinycss2.parse_component_value_list(value):
            if token.type != "function" or token.lower_name != "var":
                parts.append(tinycss2.serialize([token]))
                continue
            name, _, fallback = tinycss2.serialize(token.arguments).partition(",")
            found = inherited.get(name.strip(), fallback.strip())
            if depth > 20 or len(found) + sum(map(len, parts)) > _LONGEST_VALUE:
                return ""
            parts.append(at(depth + 1, found) if "var(" in found.lower() else found)
        return "".join(parts).strip()

    return at(0, value)


def _path_text(value: str) -> str:
    """The text in d: path("...")."""
    for token in tinycss2.parse_component_value_list(value):
        if token.type == "function" and token.lower_name == "path":
            return next((each.value for each in token.arguments if each.type == "string"), "")
    return value


def paint(properties: dict[str, str], of: str, names: Container[str]) -> tuple[str, str | None]:
    """What "stroke" or "fill" paints with: "#rrggbb" or "none", and a sentence if it is not just a colour.

    names: ids in the drawing; a reference to none of them counts as its fallback, as SVG asks.
    """
    value = properties[of] or "#000000"
    if is_zero(properties[f"{of}-opacity"]):
        return "none", None
    if found := _URL.match(value):
        reference, fallback = found[1].strip(" \"'"), found[2].strip()
        value = (parse_colour(fallback) or "none") if fallback else "none"
        if reference.startswith("#") and reference[1:] in names:
            colour = value if value not in ("none", "currentcolor") else "#000000"
            return colour, f"the {of}'s paint {reference[:40]} is not read: it counts as {colour}"
    return properties["color"] if value == "currentcolor" else value, None


@lru_cache
def is_zero(number: str) -> bool:
    """Whether an opacity leaves nothing to see: 0, 0.0, 0%."""
    try:
        return length_px(number, 1.0) <= 0
    except Error:
        return False


def unread(properties: dict[str, str], of: str, has_vertices: bool) -> list[str]:
    """Sentences about properties of a painted element that change its look and are not read."""
    sentences = []
    if has_vertices and any(properties[name] != "none" for name in _MARKERS):
        sentences.append("markers are not read: left out")
    if properties[f"{of}-opacity"] not in ("1", "1.0", "100%"):
        sentences.append(f"{of}-opacity is not read: it counts as 1")
    return sentences


def unread_own(own: dict[str, str]) -> list[str]:
    """Sentences about properties of an element or group that apply to all it holds and are not read."""
    effects = [name for name in ("clip-path", "mask", "filter") if own[name] != "none"]
    sentences = [f"{name} is not read: it counts as none" for name in effects]
    if own["opacity"] not in ("1", "1.0", "100%"):
        sentences.append("opacity is not read: it counts as 1")
    return sentences
