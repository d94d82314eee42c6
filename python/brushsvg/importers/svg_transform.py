"""Matrices of SVG, and the transforms they are written as.

A matrix (a, b, c, d, e, f) maps (x, y) to (a x + c y + e, b x + d y + f).
"""

from __future__ import annotations

import math
import re

from ..errors import Error
from ..units import NUMBER, PX_PER, length_px
from .svg_path import numbers, snippet

Matrix = tuple[float, float, float, float, float, float]
IDENTITY: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)


def multiply(outer: Matrix, inner: Matrix) -> Matrix:
    """The map that applies inner first."""
    a, b, c, d, e, f = outer
    g, h, i, j, k, m = inner
    return (
        a * g + c * h,
        b * g + d * h,
        a * i + c * j,
        b * i + d * j,
        a * k + c * m + e,
        b * k + d * m + f,
    )


def scales(matrix: Matrix) -> tuple[float, float]:
    """Greatest and least stretch of a matrix (its singular values)."""
    a, b, c, d = matrix[:4]
    turning, mirroring = math.hypot(a + d, b - c), math.hypot(a - d, b + c)
    return (turning + mirroring) / 2, abs(turning - mirroring) / 2


def _rotation(degrees: float, x: float = 0.0, y: float = 0.0) -> Matrix:
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if degrees % 90 == 0:
        cos, sin = round(cos), round(sin)
    return (cos, sin, -sin, cos, x - cos * x + sin * y, y - sin * x - cos * y)


_FUNCTIONS = {
    "matrix": ((6,), lambda *v: v),
    "translate": ((1, 2), lambda x, y=0.0: (1.0, 0.0, 0.0, 1.0, x, y)),
    "translateX": ((1,), lambda x: (1.0, 0.0, 0.0, 1.0, x, 0.0)),
    "translateY": ((1,), lambda y: (1.0, 0.0, 0.0, 1.0, 0.0, y)),
    "scale": ((1, 2), lambda x, y=None: (x, 0.0, 0.0, x if y is None else y, 0.0, 0.0)),
    "scaleX": ((1,), lambda x: (x, 0.0, 0.0, 1.0, 0.0, 0.0)),
    "scaleY": ((1,), lambda y: (1.0, 0.0, 0.0, y, 0.0, 0.0)),
    "rotate": ((1, 3), _rotation),
    "skew": ((1, 2), lambda x, y=0.0: (1.0, _tan(y), _tan(x), 1.0, 0.0, 0.0)),
    "skewX": ((1,), lambda angle: (1.0, 0.0, _tan(angle), 1.0, 0.0, 0.0)),
    "skewY": ((1,), lambda angle: (1.0, _tan(angle), 0.0, 1.0, 0.0, 0.0)),
}
_SEPARATOR = re.compile(r"[\s,]*+")
_CALL = re.compile(r"([a-zA-Z]++)\s*+\(([^()]*+)\)")
_ARGUMENT = re.compile(rf"({NUMBER})([a-zA-Z]*|%)")
# CSS writes units; angles count in degrees, lengths in px.
_UNITS = {"": 1.0, "deg": 1.0, "rad": 180 / math.pi, "grad": 0.9, "turn": 360.0, **PX_PER}
_SCALES = {"": 1.0, "%": 0.01}


def parse_transform(text: str) -> Matrix:
    """The matrix of a transform attribute or property. Error names the character where it stops making sense."""
    matrix = IDENTITY
    if text.strip() == "none":
        return matrix
    position = _SEPARATOR.match(text).end()
    while position < len(text):
        call = _CALL.match(text, position)
        counts, make = _FUNCTIONS.get(call[1], ((), None)) if call else ((), None)
        values = _arguments(call[2].strip(), _SCALES if "scale" in call[1] else _UNITS) if call else None
        if values is None or len(values) not in counts or not all(map(math.isfinite, values)):
            raise Error(f"transform is damaged at character {position + 1}: found {snippet(text, position)}")
        matrix = multiply(matrix, make(*values))
        position = _SEPARATOR.match(text, call.end()).end()
    return matrix


def _arguments(text: str, units: dict[str, float]) -> list[float] | None:
    if (plain := numbers(text)) is not None:
        return plain
    parts = [_ARGUMENT.fullmatch(part) for part in text.replace(",", " ").split()]
    if not all(part and part[2].lower() in units for part in parts):
        return None
    return [float(part[1]) * units[part[2].lower()] for part in parts]


def _tan(degrees: float) -> float:
    return math.tan(math.radians(degrees))


_SIDES = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}


def about_origin(matrix: Matrix, origin: str, viewport: tuple[float, float], em_px: float) -> Matrix:
    """A transform about its transform-origin, "x y" with percentages of the viewport. Error if that is not one."""
    words = origin.replace(",", " ").split()[:2]
    if words[:1] in (["top"], ["bottom"]) or words[1:] in (["left"], ["right"]):
        words.reverse()
    words += ["center"] * (2 - len(words))
    x, y = (
        length_px(_SIDES.get(word, word), side, em_px) for word, side in zip(words, viewport, strict=True)
    )
    return multiply(multiply((1.0, 0.0, 0.0, 1.0, x, y), matrix), (1.0, 0.0, 0.0, 1.0, -x, -y))
