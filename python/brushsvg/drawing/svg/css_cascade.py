"""Which SVG properties an element has: attributes, CSS rules, style="", inheritance, in the order CSS prescribes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from operator import itemgetter

import tinycss2

from ...errors import Error, Notice
from ...units import FONT_PX, NUMBER, length_px
from .colour import parse_colour
from .css_declarations import Declaration, declarations
from .paint_servers import URL

INHERITED = {
    "font-size": f"{FONT_PX:g}",  # in px
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
# What CSS alone says and nobody here reads, with the value that changes nothing.
_CSS_ALONE = {
    "mask-image": "none",
    "mix-blend-mode": "normal",
    "backdrop-filter": "none",
    "offset-path": "none",
    "animation": "none",
    "animation-name": "none",
    "content-visibility": "visible",
    "all": "",
}
_UNREAD = ("clip-path", "mask", "filter", *_CSS_ALONE)
OWN |= _CSS_ALONE
# Attributes that CSS may set as well; CSS wins.
_GEOMETRY = frozenset(
    "transform transform-origin transform-box translate rotate scale d x y width height cx cy r rx ry".split()
)
_OLD_PREFIX = "-webkit-"  # still means the same where nothing else does
_PREFIXED = frozenset(
    "transform transform-origin clip-path mask mask-image filter animation animation-name".split()
)
_PRESENTED = tuple(name for name in (*INHERITED, *OWN) if name not in _CSS_ALONE)  # as attributes
_READ = frozenset((*INHERITED, *OWN)) | _GEOMETRY
_LENGTHS = frozenset(("stroke-width", "stroke-dasharray", "stroke-dashoffset"))
_OPACITIES = frozenset(("opacity", "stroke-opacity", "fill-opacity"))
_SHARE = re.compile(rf"{NUMBER}%?")
MARKERS = ("marker-start", "marker-mid", "marker-end")
_OF_FONT = re.compile(rf"({NUMBER})(r?em|ex)\b", re.IGNORECASE)
_FONT_SIZES = {
    "xx-small": 9.0,
    "x-small": 10.0,
    "small": 13.0,
    "medium": 16.0,
    "large": 18.0,
    "x-large": 24.0,
    "xx-large": 32.0,
}
_LONGEST_VALUE = 10_000  # of custom properties put into each other


@dataclass(frozen=True)
class Style:
    """Computed values. Colours are "#rrggbb", "#rrggbbaa", "none", "currentcolor" or url(...), widths as written.

    inherited: what children start from, custom properties among them; own: what they do not; geometry:
    attributes that CSS replaces.
    """

    inherited: dict[str, str]
    own: dict[str, str]
    geometry: dict[str, str]


INITIAL = Style(INHERITED, OWN, {})


def cascade(
    parent: Style, attributes: dict[str, str], rules: list[Declaration], diagonal: float
) -> tuple[Style, list[Notice]]:
    """An element's style, and what was wrong with it: what is not valid falls back to the parent's, as CSS asks.

    rules: declarations of the style sheets, the strongest last; diagonal: of the viewport [px], base of percentages.
    """
    inline = declarations(attributes["style"]) if "style" in attributes else ()
    said: dict[str, list[str]] = {
        name: [attributes[name]] for name in _PRESENTED if name in attributes and attributes[name].strip()
    }
    if not (said or rules or inline):
        return Style(parent.inherited, OWN, {}), []
    for name, value, _ in sorted((*rules, *inline), key=itemgetter(2)):
        if name.startswith(_OLD_PREFIX) and name.removeprefix(_OLD_PREFIX) in _PREFIXED:
            name = name.removeprefix(_OLD_PREFIX)
        for each in MARKERS if name == "marker" else (name,):
            if each in _READ or each.startswith("--"):
                said.setdefault(each, []).append(value)
    inherited, own, geometry = dict(parent.inherited), dict(OWN), {}
    inherited.update((name, said.pop(name)[-1]) for name in list(said) if name.startswith("--"))
    if "font-size" in said:  # others count in it
        said = {"font-size": said["font-size"], **said}
    problems: list[Notice] = []
    for name, values in said.items():
        for text in reversed(values):  # the strongest that is valid
            value = text.strip()
            if "var(" in value.lower():
                value, problem = _substituted(value, inherited)
                if problem:  # CSS does not fall back to a weaker declaration here
                    sentence = f"{name} {text[:40]!r} {problem}: it counts as not given"
                    if name != "font-size":
                        is_damage = name == "stroke-width" or name in _GEOMETRY
                        problems.append(Notice("", sentence, is_damage, code="css-invalid", about=name))
                    break
            if name == "d":
                if (text := _path_text(value)) is not None:
                    geometry[name] = text
                    break
                continue
            if name in _GEOMETRY:
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
            problem = _problem(name, value, diagonal)
            if problem is None:
                target[name] = _computed(name, value, inherited)
                break
            problems.append(problem)
    return Style(inherited, own, geometry), problems


def _problem(name: str, value: str, diagonal: float) -> Notice | None:
    """Why a value is not one of its property, as far as it matters."""
    if name in ("stroke", "fill", "color"):
        if not URL.match(value) and parse_colour(value) is None:
            return Notice(
                "",
                f"{name} {value[:40]!r} is not a colour: it counts as not given",
                code="colour-invalid",
                about=name,
            )
    elif name == "stroke-width":
        try:
            if length_px(value, diagonal) < 0:
                raise Error(f"{value[:24]!r} is negative", code="out-of-range")
        except Error as error:
            return Notice(
                "", f"stroke-width: {error}; it counts as not given", True, code="stroke-width-invalid"
            )
    elif name in _OPACITIES and not _SHARE.fullmatch(value):
        return Notice(
            "",
            f"{name} {value[:40]!r} is not a number: it counts as not given",
            code="css-invalid",
            about=name,
        )
    return None


def _computed(name: str, value: str, inherited: dict[str, str]) -> str:
    if name in ("stroke", "fill"):
        return value if URL.match(value) else parse_colour(value)
    if name == "color":
        colour = None if URL.match(value) else parse_colour(value)
        return inherited["color"] if colour in (None, "none", "currentcolor") else colour
    if name in _OPACITIES:
        return f"{min(1.0, max(0.0, length_px(value, 1.0))):.15g}"
    if name == "visibility":
        return value.lower() if value.lower() in ("visible", "hidden", "collapse") else inherited[name]
    if name == "fill-rule":
        return "evenodd" if value.lower() == "evenodd" else "nonzero"
    if name == "font-size":
        return _font_size(value.lower(), inherited["font-size"])
    if name in _LENGTHS:  # what is said in em is handed down in px
        return _OF_FONT.sub(
            lambda found: f"{length_px(found[0], 0.0, float(inherited['font-size'])):.15g}", value
        )
    return value if name in MARKERS else value.lower()


def _font_size(value: str, parents: str) -> str:
    em_px = float(parents)
    if value in ("larger", "smaller"):
        return f"{em_px * (1.2 if value == 'larger' else 1 / 1.2):.15g}"
    try:
        size_px = _FONT_SIZES[value] if value in _FONT_SIZES else length_px(value, em_px, em_px)
    except Error:
        return parents
    return f"{size_px:.15g}" if 0 <= size_px <= 1e6 else parents


def _substituted(value: str, inherited: dict[str, str]) -> tuple[str, str]:
    """A value with its var(--name, fallback) replaced, and why that leads nowhere, "" if it does not."""
    problem = ""

    @cache  # or variables that name two others each would take for ever
    def at(depth: int, value: str) -> str:
        nonlocal problem
        parts = []
        for token in tinycss2.parse_component_value_list(value):
            if token.type != "function" or token.lower_name != "var":
                parts.append(tinycss2.serialize([token]))
                continue
            name, comma, fallback = tinycss2.serialize(token.arguments).partition(",")
            found = inherited.get(name.strip(), fallback.strip() if comma else None)
            if found is None:
                problem = problem or f"names {name.strip()[:40]}, which nothing says"
            elif depth > 20:
                problem = problem or f"leads through {name.strip()[:40]} in a circle, or too far"
            elif len(found) + sum(map(len, parts)) > _LONGEST_VALUE:
                problem = problem or f"grows beyond {_LONGEST_VALUE} characters"
            else:
                parts.append(at(depth + 1, found) if "var(" in found.lower() else found)
        return "".join(parts).strip()

    return at(0, value), problem


def _path_text(value: str) -> str | None:
    """The text in d: path("..."), "" for none; None if it is neither."""
    if value.lower() == "none":
        return ""
    token, *others = tinycss2.parse_component_value_list(value, skip_comments=True)
    if others or token.type != "function" or token.lower_name != "path":
        return None
    told = [each for each in token.arguments if each.type not in ("whitespace", "comment")]
    return told[0].value if len(told) == 1 and told[0].type == "string" else None


def unread_own(own: dict[str, str]) -> list[tuple[str, str]]:
    """(property, sentence) for those of an element or group that apply to all it holds and are not read."""
    effects = [name for name in _UNREAD if own[name] != OWN[name]]
    told = [(name, f"{name} is not read: it counts as {OWN[name] or 'not given'}") for name in effects]
    if own["display"] == "contents":
        told.append(("display", "display: contents is not read: it counts as inline"))
    if own["opacity"] != "1":
        told.append(("opacity", "opacity is not read: it counts as 1"))
    return told
