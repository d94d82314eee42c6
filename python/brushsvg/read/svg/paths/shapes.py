"""Convert the basic shapes of SVG to path commands.

The starting points and directions are as SVG prescribes.
"""

from __future__ import annotations

import math

import tinycss2

from ....errors import Error
from ....units import FONT_PX, length_px
from .path_data import MOST_COMMANDS, Command, parse_path, parse_points, snippet


class DamageError(Exception):
    """Damaged geometry: a sentence about it, and the commands up to the error."""

    def __init__(self, sentence: str, commands: list[Command]):
        super().__init__(sentence)
        self.commands = commands


def shape_commands(
    tag: str, attributes: dict[str, str], viewport: tuple[float, float], em_px: float = FONT_PX
) -> list[Command]:
    """Return the path commands of a shape in user units.

    The result is [] for a shape that SVG does not render.

    viewport: (width, height), the base of percentages. Raises DamageError if the geometry is damaged.
    """
    return _SHAPES[tag](attributes, _Lengths(attributes, viewport, em_px))


class _Lengths:
    def __init__(self, attributes: dict[str, str], viewport: tuple[float, float], em_px: float):
        self.attributes = attributes
        self.viewport = viewport
        self.em_px = em_px

    def __call__(self, name: str, base: str, minimum: float = -math.inf) -> float:
        value = self.optional(name, base, minimum)
        return 0.0 if value is None else value

    def optional(self, name: str, base: str, minimum: float = 0.0) -> float | None:
        text = self.attributes.get(name)
        if text is None or text.strip() in ("", "auto"):
            return None
        try:
            value = length_px(text, self._base(base), self.em_px)
        except Error as error:
            raise DamageError(f"{name}: {error}", []) from None
        if value < minimum:
            raise DamageError(f"{name}: {snippet(text, 0)} is negative", [])
        return value

    def _base(self, name: str) -> float:
        width, height = self.viewport
        return {"x": width, "y": height, "r": math.hypot(width, height) / math.sqrt(2)}[name]


def _damage_error(name: str, text: str, error: int, commands: list[Command]) -> DamageError:
    if len(commands) >= MOST_COMMANDS:
        return DamageError(f"{name} has more than {MOST_COMMANDS} commands; read up to there", commands)
    found = f"found {snippet(text, error)}; read up to there"
    return DamageError(f"{name} is damaged at character {error + 1}: {found}", commands)


def _path(attributes: dict[str, str], _length: _Lengths) -> list[Command]:
    d = attributes.get("d", "")
    if d.strip() == "none":
        return []
    commands, error = parse_path(d)
    if error is not None:
        raise _damage_error("d", d, error, commands)
    return commands


def path_data_of(value: str) -> str | None:
    """Return the path data in a value of d: path("..."), "" for none, else None."""
    if value.lower() == "none":
        return ""
    tokens = tinycss2.parse_component_value_list(value, skip_comments=True)
    if len(tokens) != 1 or tokens[0].type != "function" or tokens[0].lower_name != "path":
        return None
    arguments = [argument for argument in tokens[0].arguments if argument.type not in ("whitespace", "comment")]
    return arguments[0].value if len(arguments) == 1 and arguments[0].type == "string" else None


def _rect(_attributes: dict[str, str], length: _Lengths) -> list[Command]:
    x, y = length("x", "x"), length("y", "y")
    width, height = length("width", "x", 0.0), length("height", "y", 0.0)
    rx, ry = length.optional("rx", "x"), length.optional("ry", "y")
    rx, ry = (ry if rx is None else rx) or 0.0, (rx if ry is None else ry) or 0.0
    if width == 0 or height == 0:
        return []
    rx, ry = min(rx, width / 2), min(ry, height / 2)
    if rx == 0 or ry == 0:
        return _commands(("M", x, y), ("H", x + width), ("V", y + height), ("H", x), ("Z",))
    right, bottom = x + width, y + height
    parts = [("M", x + rx, y)]
    for begin, end in (
        ((right - rx, y), (right, y + ry)),
        ((right, bottom - ry), (right - rx, bottom)),
        ((x + rx, bottom), (x, bottom - ry)),
        ((x, y + ry), (x + rx, y)),
    ):
        parts += [("L", *begin), ("A", rx, ry, 0.0, 0.0, 1.0, *end)]
    return _commands(*parts, ("Z",))


def _ellipse_at(x: float, y: float, rx: float, ry: float) -> list[Command]:
    if rx == 0 or ry == 0:
        return []
    quarters = ((x, y + ry), (x - rx, y), (x, y - ry), (x + rx, y))
    return _commands(("M", x + rx, y), *(("A", rx, ry, 0.0, 0.0, 1.0, *end) for end in quarters), ("Z",))


def _circle(_attributes: dict[str, str], length: _Lengths) -> list[Command]:
    r = length("r", "r", 0.0)
    return _ellipse_at(length("cx", "x"), length("cy", "y"), r, r)


def _ellipse(_attributes: dict[str, str], length: _Lengths) -> list[Command]:
    rx, ry = length.optional("rx", "x"), length.optional("ry", "y")
    rx, ry = (ry if rx is None else rx) or 0.0, (rx if ry is None else ry) or 0.0
    return _ellipse_at(length("cx", "x"), length("cy", "y"), rx, ry)


def _line(_attributes: dict[str, str], length: _Lengths) -> list[Command]:
    begin = ("M", length("x1", "x"), length("y1", "y"))
    return _commands(begin, ("L", length("x2", "x"), length("y2", "y")))


def _polyline(attributes: dict[str, str], _length: _Lengths, last: tuple[Command, ...] = ()) -> list[Command]:
    points = attributes.get("points", "")
    if not points.strip():
        return []
    commands, error = parse_points(points)
    if error is not None:
        raise _damage_error("points", points, error, commands)
    return [*commands, *last]


def _polygon(attributes: dict[str, str], length: _Lengths) -> list[Command]:
    return _polyline(attributes, length, ((0, "Z", ()),))


def _commands(*parts: tuple) -> list[Command]:
    return [(0, letter, values) for letter, *values in parts]


_SHAPES = {
    "path": _path,
    "rect": _rect,
    "circle": _circle,
    "ellipse": _ellipse,
    "line": _line,
    "polyline": _polyline,
    "polygon": _polygon,
}
TAGS = frozenset(_SHAPES)
