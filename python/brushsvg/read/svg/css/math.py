"""Compute the lengths of calc(), min(), max() and clamp() in CSS."""

from __future__ import annotations

import math
from itertools import pairwise

import tinycss2

from ....errors import Error
from ....units import length_px

MAX_DEPTH = 20  # nesting depth of functions and brackets
_RELATIVE_UNITS = ("%", "em", "rem", "ex")  # units that depend on an element
Amount = tuple[float, str]  # value and unit: "" for a number, "px", or a unit of _RELATIVE_UNITS


def compute_length(value: str) -> str:
    """Return the length that a CSS function computes.

    The value is returned as it is if it is not a function, or if the function mixes units such as % and px.
    """
    tokens = _without_comments(tinycss2.parse_component_value_list(value))
    if len(tokens) != 1 or tokens[0].type != "function":
        return value
    amount = _parse_amount(tokens[0], 0)
    return value if amount is None or not math.isfinite(amount[0]) else f"{amount[0]:.15g}{amount[1]}"


def _without_comments(tokens: list) -> list:
    return [token for token in tokens if token.type != "comment"]


def _parse_amount(token, depth: int) -> Amount | None:
    if token.type == "number":
        return token.value, ""
    if token.type == "percentage":
        return token.value, "%"
    if token.type == "dimension":
        if token.lower_unit in _RELATIVE_UNITS:
            return token.value, token.lower_unit
        try:
            return token.value * length_px(f"1{token.lower_unit}", 0.0), "px"
        except Error:
            return None
    if depth > MAX_DEPTH:
        return None
    if token.type == "() block":
        return _parse_sum(_without_comments(token.content), depth + 1)
    if token.type != "function":
        return None
    parts: list[list] = [[]]
    for argument in _without_comments(token.arguments):
        if argument == ",":
            parts.append([])
        else:
            parts[-1].append(argument)
    amounts = [_parse_sum(part, depth + 1) for part in parts]
    if None in amounts or len({unit for _, unit in amounts}) != 1:
        return None
    values, unit = [value for value, _ in amounts], amounts[0][1]
    if token.lower_name == "calc" and len(values) == 1:
        return values[0], unit
    if token.lower_name in ("min", "max"):
        return {"min": min, "max": max}[token.lower_name](values), unit
    if token.lower_name == "clamp" and len(values) == 3:
        return max(values[0], min(values[1], values[2])), unit
    return None


def _parse_sum(tokens: list, depth: int) -> Amount | None:
    """Return a sum of products. CSS requires blanks around + and -."""
    ends = [k for k, token in enumerate(tokens) if token in ("+", "-")]
    blanks = [tokens[k + side].type == "whitespace" for k in ends for side in (-1, 1) if 0 <= k + side < len(tokens)]
    if len(blanks) < 2 * len(ends) or not all(blanks):
        return None
    products = [_parse_product(tokens[a + 1 : b], depth) for a, b in pairwise([-1, *ends, len(tokens)])]
    if None in products or len({unit for _, unit in products}) != 1:
        return None
    signs = [1.0, *(1.0 if tokens[k] == "+" else -1.0 for k in ends)]
    return sum(sign * value for sign, (value, _) in zip(signs, products, strict=True)), products[0][1]


def _parse_product(tokens: list, depth: int) -> Amount | None:
    words = [token for token in tokens if token.type != "whitespace"]
    if len(words) % 2 == 0 or any(sign not in ("*", "/") for sign in words[1::2]):
        return None
    amounts = [_parse_amount(token, depth) for token in words[::2]]
    if None in amounts:
        return None
    value, unit = amounts[0]
    for sign, (other, other_unit) in zip(words[1::2], amounts[1:], strict=True):
        if other_unit and (unit or sign == "/"):
            return None
        if sign == "/" and other == 0:
            return None
        value, unit = (value * other if sign == "*" else value / other), unit or other_unit
    return value, unit
