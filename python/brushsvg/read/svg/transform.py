"""Matrices of SVG, and the transform attribute. css/transform.py reads CSS.

A matrix (a, b, c, d, e, f) maps (x, y) to (a x + c y + e, b x + d y + f).
"""

from __future__ import annotations

import math
import re

from ...errors import Error
from .paths.path_data import parse_numbers, snippet

Matrix = tuple[float, float, float, float, float, float]
IDENTITY: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)


def multiply(outer: Matrix, inner: Matrix) -> Matrix:
    """Return the matrix that applies inner first, then outer."""
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
    """Return the greatest and least stretch of a matrix (its singular values)."""
    a, b, c, d = matrix[:4]
    turning, mirroring = math.hypot(a + d, b - c), math.hypot(a - d, b + c)
    return (turning + mirroring) / 2, abs(turning - mirroring) / 2


def _rotation(degrees: float, x: float = 0.0, y: float = 0.0) -> Matrix:
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if degrees % 90 == 0:
        cos, sin = round(cos), round(sin)
    return (cos, sin, -sin, cos, x - cos * x + sin * y, y - sin * x - cos * y)


FUNCTIONS = {
    "matrix": ((6,), lambda *v: v),
    "translate": ((1, 2), lambda x, y=0.0: (1.0, 0.0, 0.0, 1.0, x, y)),
    "scale": ((1, 2), lambda x, y=None: (x, 0.0, 0.0, x if y is None else y, 0.0, 0.0)),
    "rotate": ((1, 3), _rotation),
    "skewX": ((1,), lambda angle: (1.0, 0.0, _tan(angle), 1.0, 0.0, 0.0)),
    "skewY": ((1,), lambda angle: (1.0, _tan(angle), 0.0, 1.0, 0.0, 0.0)),
}
_SEPARATOR = re.compile(r"\s*+,?\s*+(?!$)|\s*+$")
_CALL = re.compile(r"([a-zA-Z]++)\s*+\(([^()]*+)\)")


def parse_transform(text: str) -> Matrix:
    """Return the matrix of a transform attribute.

    Raises Error with the number of the first character that cannot be read.
    """
    matrix = IDENTITY
    if text.strip() == "none":
        return matrix
    position = len(text) - len(text.lstrip())
    while position < len(text):
        call = _CALL.match(text, position)
        counts, make = FUNCTIONS.get(call[1], ((), None)) if call else ((), None)
        values = parse_numbers(call[2].strip()) if call else None
        if values is None or len(values) not in counts or not all(map(math.isfinite, values)):
            sentence = f"transform is damaged at character {position + 1}: found {snippet(text, position)}"
            raise Error(sentence, code="transform-unread")
        matrix = multiply(matrix, make(*values))
        separator = _SEPARATOR.match(text, call.end())
        position = separator.end() if separator else call.end()
    return matrix


def _tan(degrees: float) -> float:
    return math.tan(math.radians(degrees))
