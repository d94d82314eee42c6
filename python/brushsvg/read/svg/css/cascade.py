"""The CSS cascade: the properties of an element.

They come from attributes, CSS rules, style="" and inheritance, in the order that CSS prescribes.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from operator import itemgetter

from ....errors import Notice
from ....units import FONT_PX, NUMBER
from ..paths.shapes import path_data_of
from .declarations import Declaration, declarations
from .math import compute_length
from .values import compute_value, find_problem, substitute_variables

INHERITED = {
    "font-size": f"{FONT_PX:g}",  # px
    "stroke": "none",
    "stroke-width": "1",
    "stroke-opacity": "1",
    "stroke-dasharray": "none",
    "stroke-dashoffset": "0",
    "fill": "",  # not set by the drawing; the default of SVG is black
    "fill-opacity": "1",
    "fill-rule": "nonzero",
    "clip-rule": "nonzero",
    "color": "#000000",
    "visibility": "visible",
    "paint-order": "normal",
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
    "mask-type": "luminance",
    "filter": "none",
    "overflow": "",
}
# Properties that exist in CSS only and are not read, with the value that has no effect.
_CSS_ONLY = {
    "mask-image": "none",
    "mix-blend-mode": "normal",
    "backdrop-filter": "none",
    "offset-path": "none",
    "animation": "none",
    "animation-name": "none",
    "content-visibility": "visible",
    "all": "",
}
_UNREAD_PROPERTIES = ("filter", *_CSS_ONLY)
OWN |= _CSS_ONLY
# Attributes that CSS can also set. CSS takes precedence.
_GEOMETRY_PROPERTIES = frozenset(
    "transform transform-origin transform-box translate rotate scale d x y width height cx cy r rx ry".split()
)
_LENGTH_PROPERTIES = frozenset("x y width height cx cy r rx ry".split())
_COMPUTED_LENGTHS = ("font-size", "stroke-width", "stroke-dashoffset")
_BARE_NUMBER = re.compile(NUMBER)  # a valid length in an attribute; in CSS only 0 is valid without a unit
_OLD_PREFIX = "-webkit-"  # browsers still accept some properties with this prefix
_PREFIXED_PROPERTIES = frozenset(
    "transform transform-origin clip-path mask mask-image filter animation animation-name".split()
)
# Properties that can be attributes.
_PRESENTATION_ATTRIBUTES = tuple(name for name in (*INHERITED, *OWN) if name not in _CSS_ONLY)
_READ_PROPERTIES = frozenset((*INHERITED, *OWN)) | _GEOMETRY_PROPERTIES
MARKERS = ("marker-start", "marker-mid", "marker-end")


@dataclass(frozen=True)
class Style:
    """The computed values of an element.

    Colours are "#rrggbb", "#rrggbbaa", "none", "currentcolor" or url(...). Widths are as written.

    inherited: properties that children inherit, including custom properties.
    own: properties that children do not inherit.
    geometry: attributes that CSS replaces.
    """

    inherited: dict[str, str]
    own: dict[str, str]
    geometry: dict[str, str]


INITIAL = Style(INHERITED, OWN, {})


def cascade(
    parent: Style, attributes: dict[str, str], rules: list[Declaration], diagonal: float
) -> tuple[Style, list[Notice]]:
    """Return the style of an element, and notices about invalid values.

    An invalid value falls back to a weaker declaration or to the parent's value, as CSS prescribes.

    parent: style of the parent; attributes: of the element; rules: declarations of the style sheets, the strongest
    last; diagonal: of the viewport [px], the base of percentages.
    """
    inline = declarations(attributes["style"]) if "style" in attributes else ()
    declared: dict[str, list[str]] = {
        name: [attributes[name]] for name in _PRESENTATION_ATTRIBUTES if name in attributes and attributes[name].strip()
    }
    if not (declared or rules or inline):
        return Style(parent.inherited, OWN, {}), []
    for name, value, _ in sorted((*rules, *inline), key=itemgetter(2)):
        if name.startswith(_OLD_PREFIX) and name.removeprefix(_OLD_PREFIX) in _PREFIXED_PROPERTIES:
            name = name.removeprefix(_OLD_PREFIX)
        for longhand in MARKERS if name == "marker" else (name,):
            if longhand in _READ_PROPERTIES or longhand.startswith("--"):
                declared.setdefault(longhand, []).append(value)
    inherited, own, geometry = dict(parent.inherited), dict(OWN), {}
    inherited.update((name, declared.pop(name)[-1]) for name in list(declared) if name.startswith("--"))
    if "font-size" in declared:  # first, because other lengths depend on it
        declared = {"font-size": declared["font-size"], **declared}
    problems: list[Notice] = []
    for name, values in declared.items():
        for text in reversed(values):  # the strongest valid declaration counts
            value = text.strip()
            if "var(" in value.lower():
                value, problem = substitute_variables(value, inherited)
                if problem:  # here CSS does not fall back to a weaker declaration
                    sentence = f"{name} {text[:40]!r} {problem}: it is ignored"
                    if name != "font-size":
                        is_damage = name == "stroke-width" or name in _GEOMETRY_PROPERTIES
                        problems.append(Notice("", sentence, is_damage, code="css-invalid", about=name))
                    break
            if "(" in value and (name in _LENGTH_PROPERTIES or name in _COMPUTED_LENGTHS):
                value = compute_length(value)
            if name == "d":
                if (text := path_data_of(value)) is not None:
                    geometry[name] = text
                    break
                continue
            if name in _LENGTH_PROPERTIES and _BARE_NUMBER.fullmatch(value) and float(value):
                sentence = f"{name} {value[:40]!r} of its style has no unit: it is ignored"
                problems.append(Notice("", sentence, code="css-invalid", about=name))
                continue
            if name in _GEOMETRY_PROPERTIES:
                geometry[name] = value
                break
            if name == "all":
                own[name] = value
                break
            target, initial = (inherited, INHERITED) if name in INHERITED else (own, OWN)
            keyword = value.lower()
            if keyword in ("inherit", "initial", "unset", "revert"):
                if keyword == "initial" or (keyword != "inherit" and target is own):
                    target[name] = initial[name]
                elif keyword == "inherit":
                    target[name] = (parent.inherited if target is inherited else parent.own)[name]
                break
            problem = find_problem(name, value, diagonal)
            if problem is None:
                target[name] = compute_value(name, value, inherited)
                break
            problems.append(problem)
    return Style(inherited, own, geometry), problems


def list_unread_properties(own: dict[str, str]) -> list[tuple[str, str]]:
    """Return (property, sentence) for unread properties of an element or group.

    These properties affect all that the element or group contains.
    """
    effects = [name for name in _UNREAD_PROPERTIES if own[name] != OWN[name]]
    unread = [(name, f"{name} is not read: it counts as {OWN[name] or 'not given'}") for name in effects]
    if own["display"] == "contents":
        unread.append(("display", "display: contents is not read: it counts as inline"))
    if own["opacity"] != "1":
        unread.append(("opacity", "opacity is not read: it counts as 1"))
    return unread
