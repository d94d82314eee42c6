"""Check and compute the values of CSS properties, and substitute var()."""

from __future__ import annotations

import re
from functools import cache

import tinycss2

from ....errors import Error, Notice
from ....units import NUMBER, length_px
from ..colour import parse_colour
from ..paint_servers import URL

_LENGTH_PROPERTIES = frozenset(("stroke-width", "stroke-dasharray", "stroke-dashoffset"))
_OPACITY_PROPERTIES = frozenset(("opacity", "stroke-opacity", "fill-opacity"))
_SHARE = re.compile(rf"{NUMBER}%?")
_FONT_RELATIVE = re.compile(rf"({NUMBER})(r?em|ex)\b", re.IGNORECASE)
_FONT_SIZES = {
    "xx-small": 9.0,
    "x-small": 10.0,
    "small": 13.0,
    "medium": 16.0,
    "large": 18.0,
    "x-large": 24.0,
    "xx-large": 32.0,
}
_MAX_VALUE_LENGTH = 10_000  # characters of a value after the substitution of custom properties


def find_problem(name: str, value: str, diagonal: float) -> Notice | None:
    """Return a notice if a value is not valid for its property, otherwise None.

    Only properties whose invalid values matter are checked.
    """
    if name in ("stroke", "fill", "color"):
        if not URL.match(value) and parse_colour(value) is None:
            return Notice(
                "",
                f"{name} {value[:40]!r} is not a colour: it is ignored",
                code="colour-invalid",
                about=name,
            )
    elif name == "stroke-width":
        try:
            if length_px(value, diagonal) < 0:
                raise Error(f"{value[:24]!r} is negative", code="out-of-range")
        except Error as error:
            return Notice("", f"stroke-width: {error}; it has no effect", True, code="stroke-width-invalid")
    elif name in _OPACITY_PROPERTIES and not _SHARE.fullmatch(value):
        return Notice(
            "",
            f"{name} {value[:40]!r} is not a number: it is ignored",
            code="css-invalid",
            about=name,
        )
    return None


def compute_value(name: str, value: str, inherited: dict[str, str]) -> str:
    if name in ("stroke", "fill"):
        return value if URL.match(value) else parse_colour(value)
    if name == "color":
        colour = None if URL.match(value) else parse_colour(value)
        return inherited["color"] if colour in (None, "none", "currentcolor") else colour
    if name in _OPACITY_PROPERTIES:
        return f"{min(1.0, max(0.0, length_px(value, 1.0))):.15g}"
    if name == "visibility":
        return value.lower() if value.lower() in ("visible", "hidden", "collapse") else inherited[name]
    if name in ("fill-rule", "clip-rule"):
        return "evenodd" if value.lower() == "evenodd" else "nonzero"
    if name == "font-size":
        return _compute_font_size(value.lower(), inherited["font-size"])
    if name in _LENGTH_PROPERTIES:  # children inherit em values in px
        return _FONT_RELATIVE.sub(
            lambda replacement: f"{length_px(replacement[0], 0.0, float(inherited['font-size'])):.15g}", value
        )
    return value if name.startswith(("marker", "clip-path")) else value.lower()


def _compute_font_size(value: str, parents: str) -> str:
    em_px = float(parents)
    if value in ("larger", "smaller"):
        return f"{em_px * (1.2 if value == 'larger' else 1 / 1.2):.15g}"
    try:
        size_px = _FONT_SIZES[value] if value in _FONT_SIZES else length_px(value, em_px, em_px)
    except Error:
        return parents
    return f"{size_px:.15g}" if 0 <= size_px <= 1e6 else parents


def substitute_variables(value: str, inherited: dict[str, str]) -> tuple[str, str]:
    """Return a value with var(--name, fallback) substituted, and a problem.

    The problem is a phrase that says why the substitution fails, "" if it works.
    """
    problem = ""

    @cache  # without the cache, variables that each use two others would take exponential time
    def substitute(depth: int, value: str) -> str:
        nonlocal problem
        parts = []
        for token in tinycss2.parse_component_value_list(value):
            if token.type != "function" or token.lower_name != "var":
                parts.append(tinycss2.serialize([token]))
                continue
            name, comma, fallback = tinycss2.serialize(token.arguments).partition(",")
            replacement = inherited.get(name.strip(), fallback.strip() if comma else None)
            if replacement is None:
                problem = problem or f"names {name.strip()[:40]}, which is not defined"
            elif depth > 20:
                problem = problem or f"leads through {name.strip()[:40]} in a circle, or too deeply"
            elif len(replacement) + sum(map(len, parts)) > _MAX_VALUE_LENGTH:
                problem = problem or f"grows beyond {_MAX_VALUE_LENGTH} characters"
            else:
                parts.append(substitute(depth + 1, replacement) if "var(" in replacement.lower() else replacement)
        return "".join(parts).strip()

    return substitute(0, value), problem
