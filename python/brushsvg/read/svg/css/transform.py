"""Parse the transforms of CSS, and the origin of a transform.

CSS is stricter than the attribute of SVG: lengths and angles have units, and commas separate numbers. A value that
browsers do not accept is not accepted here either.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from ....errors import Error
from ....units import NUMBER, length_px
from ..paths.path_data import snippet
from ..transform import FUNCTIONS, IDENTITY, Matrix, multiply

ReferenceBox = tuple[float, float, float, float]  # x, y, width, height in user units

_CALL = re.compile(r"\s*+([a-zA-Z]++)\(([^()]*+)\)\s*+")
_ANGLE = re.compile(rf"({NUMBER})(deg|rad|grad|turn)", re.IGNORECASE)
_DEGREES = {"deg": 1.0, "rad": 180 / math.pi, "grad": 0.9, "turn": 360.0}
_NUMBER_OR_PERCENTAGE = re.compile(rf"({NUMBER})(%?)")
_BARE_NUMBER = re.compile(NUMBER)

# The kinds of the arguments of each function. "x" and "y" are lengths or percentages of this side of the box.
_ARGUMENT_KINDS = {
    "matrix": ("number",) * 6,
    "translate": ("x", "y"),
    "translatex": ("x",),
    "translatey": ("y",),
    "scale": ("share", "share"),
    "scalex": ("share",),
    "scaley": ("share",),
    "rotate": ("angle",),
    "skew": ("angle", "angle"),
    "skewx": ("angle",),
    "skewy": ("angle",),
}
_MATRIX_MAKERS = {name.lower(): make for name, (_, make) in FUNCTIONS.items()} | {
    "translatex": lambda x: (1.0, 0.0, 0.0, 1.0, x, 0.0),
    "translatey": lambda y: (1.0, 0.0, 0.0, 1.0, 0.0, y),
    "scalex": lambda x: (x, 0.0, 0.0, 1.0, 0.0, 0.0),
    "scaley": lambda y: (1.0, 0.0, 0.0, y, 0.0, 0.0),
    "skew": lambda x, y=0.0: (1.0, FUNCTIONS["skewY"][1](y)[1], FUNCTIONS["skewX"][1](x)[2], 1.0, 0.0, 0.0),
}
_X_KEYWORDS = {"left": 0.0, "center": 0.5, "right": 1.0}
_Y_KEYWORDS = {"top": 0.0, "center": 0.5, "bottom": 1.0}
_NO_TRANSFORM = ("none", "initial", "unset", "revert")


def css_transform(text: str, box: Callable[[], ReferenceBox], em_px: float) -> Matrix:
    """Return the matrix of the property `transform`.

    box: returns the reference box of percentages. Raises Error if the text is not CSS, or a transform in 3D.
    """
    matrix, position = IDENTITY, 0
    if text.strip().lower() in _NO_TRANSFORM:
        return matrix
    while position < len(text):
        call = _CALL.match(text, position)
        name = call[1].lower() if call else ""
        words = [word.strip() for word in call[2].split(",")] if call else []
        kinds = _ARGUMENT_KINDS.get(name, ())
        if not kinds or not (len(words) == len(kinds) or (len(kinds) == 2 and len(words) == 1)):
            sentence = f"transform is not read from character {position + 1} on: found {snippet(text, position)}"
            raise Error(sentence, code="transform-unread")
        matrix = multiply(matrix, _MATRIX_MAKERS[name](*_values(words, kinds, box, em_px)))
        position = call.end()
    return matrix


def individual_transform(name: str, text: str, box: Callable[[], ReferenceBox], em_px: float) -> Matrix:
    """Return the matrix of the property `translate`, `rotate` or `scale`.

    Raises Error if the text is not CSS, or a transform in 3D.
    """
    words = text.split()
    if text.strip().lower() in _NO_TRANSFORM:
        return IDENTITY
    kinds = _ARGUMENT_KINDS[name]
    if not 1 <= len(words) <= len(kinds):
        raise Error(f"{name} {text[:40]!r} is not read", code="transform-unread")
    return _MATRIX_MAKERS[name](*_values(words, kinds, box, em_px))


def transform_origin(text: str, is_css: bool, box: Callable[[], ReferenceBox], em_px: float) -> tuple[float, float]:
    """Return the point (x, y) of `transform-origin`.

    is_css: whether lengths need units, as in CSS. Raises Error if the text is invalid.
    """
    words = text.lower().split()
    if not 1 <= len(words) <= 3:
        raise Error(f"transform-origin {text[:40]!r} is not read", code="transform-unread")
    if len(words) == 3:  # the third number is the depth, which has no effect
        if (depth := words.pop()).endswith("%"):
            raise Error(f"transform-origin {text[:40]!r} is not read", code="transform-unread")
        _length(depth, 0.0, is_css, em_px)
    if len(words) == 1:
        words = ["center", *words] if words[0] in _Y_KEYWORDS else [*words, "center"]
    elif words[0] in _Y_KEYWORDS and words[1] in _X_KEYWORDS:
        words.reverse()
    x, y, width, height = box()
    across, down = (
        side * names[word] if word in names else _length(word, side, is_css, em_px)
        for word, names, side in zip(words, (_X_KEYWORDS, _Y_KEYWORDS), (width, height), strict=True)
    )
    return x + across, y + down


def about_point(point: tuple[float, float], matrix: Matrix) -> Matrix:
    """Return a matrix that applies another matrix about a point."""
    x, y = point
    return multiply(multiply((1.0, 0.0, 0.0, 1.0, x, y), matrix), (1.0, 0.0, 0.0, 1.0, -x, -y))


def _values(words: list[str], kinds: tuple[str, ...], box: Callable[[], ReferenceBox], em_px: float) -> list[float]:
    values = [_value(word, kind, box, em_px) for word, kind in zip(words, kinds, strict=False)]
    for word, value in zip(words, values, strict=False):
        if not math.isfinite(value):
            raise Error(f"transform: {word[:24]!r} is too large", code="transform-unread")
    return values


def _value(word: str, kind: str, box: Callable[[], ReferenceBox], em_px: float) -> float:
    if kind in ("x", "y"):
        side = box()[2 if kind == "x" else 3] if word.endswith("%") else 0.0
        return _length(word, side, True, em_px)
    if kind == "angle":
        match = _ANGLE.fullmatch(word)
        if match:
            return float(match[1]) * _DEGREES[match[2].lower()]
        if _BARE_NUMBER.fullmatch(word) and float(word) == 0:
            return 0.0
        sentence = f"transform: {word[:24]!r} is not an angle as CSS writes it, for example 30deg"
        raise Error(sentence, code="transform-unread")
    match = _NUMBER_OR_PERCENTAGE.fullmatch(word)
    if not match or (match[2] and kind == "number"):
        raise Error(f"transform: {word[:24]!r} is not a number", code="transform-unread")
    return float(match[1]) / (100 if match[2] else 1)


def _length(word: str, percent_of: float, is_css: bool, em_px: float) -> float:
    if is_css and _BARE_NUMBER.fullmatch(word) and float(word) != 0:
        sentence = f"transform: {word[:24]!r} has no unit, which CSS asks for: write {word[:24]}px"
        raise Error(sentence, code="transform-unread")
    return length_px(word, percent_of, em_px)
