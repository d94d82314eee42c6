"""Pens of DXF entities: layer, colour and line weight.

Entities inherit them from layers and blocks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from .ezdxf_import import ezdxf
from .file import printable

_BYBLOCK, _BYLAYER = 0, 256  # colour numbers
_WEIGHT_BYLAYER, _WEIGHT_BYBLOCK = -1, -2
_OWN_TRANSPARENCY, _TRANSPARENCY_BYBLOCK = 0x02000000, 0x01000000
_DEFAULT_WIDTH_MM = 0.25  # width of line weight "default" in CAD programs; the DXF format does not define it
_BLACK = "#000000"


@dataclass(frozen=True)
class LineType:
    """A line type.

    pattern_mm: lengths of dash, gap, dash, gap ...; () if the line type has letters or shapes, or is damaged.
    """

    name: str
    pattern_mm: tuple[float, ...]


@dataclass(frozen=True)
class Pen:
    """The properties with which an entity is drawn.

    layer: name of the layer, for messages; key: name of the layer, for look-ups.
    width_mm: line width.
    line_type: None if unbroken; line_scale: factor of its pattern.
    hidden: the reason why the layer is not painted, "" if it is painted.
    frozen: whether blocks inserted on this layer are hidden with all that they contain.
    see_through: whether it is transparent, which paint cannot be.
    """

    layer: str = "0"
    key: str = "0"
    colour: str = _BLACK
    width_mm: float = _DEFAULT_WIDTH_MM
    line_type: LineType | None = None
    line_scale: float = 1.0
    hidden: str = ""
    frozen: bool = False
    see_through: bool = False


class Pens:
    """The pens of a document: its layers, and the pens of its entities."""

    def __init__(self, document: ezdxf.document.Drawing, mm_per_unit: float):
        scale = document.header.get("$LTSCALE", 1.0) * mm_per_unit
        types = ((_fold_name(line.dxf.name), _line_type(line, scale)) for line in document.linetypes)
        self._line_types = {key: line_type for key, line_type in types if line_type is not None}
        self._layers = {_fold_name(layer.dxf.name): self._layer_pen(layer) for layer in document.layers}

    def hidden(self) -> dict[str, str]:
        """Return for each layer the reason why it is not painted, "" if it is painted."""
        return {pen.layer: pen.hidden for pen in self._layers.values()}

    def pen(self, entity, outer: Pen | None) -> Pen:
        """Return the pen of an entity.

        outer: the pen of the block reference that contains the entity, None outside of blocks.
        """
        dxf, block = entity.dxf, outer or Pen()
        name, key = printable(dxf.layer), _fold_name(dxf.layer)
        if key == "0":
            name, key = block.layer, block.key
        layer = self._layers.get(key) or Pen(name, key)
        line_type = _fold_name(dxf.get("linetype", "BYLAYER"))
        inherited = {"bylayer": layer.line_type, "byblock": block.line_type}
        return Pen(
            layer.layer,
            key,
            self._colour(entity, layer, block),
            self._width_mm(dxf.get("lineweight", _WEIGHT_BYLAYER), layer, block),
            inherited.get(line_type, self._line_types.get(line_type)),
            dxf.get("ltscale", 1.0),
            layer.hidden,
            layer.frozen,
            self._see_through(entity, layer, block),
        )

    def filling(self, entity, pen: Pen, outer: Pen | None) -> Pen:
        """Return the pen that fills an MPOLYGON. Its own pen draws the border."""
        layer = self._layers.get(pen.key) or Pen()
        number = entity.dxf.get("fill_color", _BYLAYER)
        return replace(pen, colour=self._indexed_colour(number, layer, outer or Pen()))

    def _layer_pen(self, layer) -> Pen:
        name = layer.dxf.name
        hidden = ""
        if layer.is_frozen():
            hidden = "the layer is frozen"
        elif layer.is_off():
            hidden = "the layer is off"
        elif not layer.dxf.get("plot", 1) or _fold_name(name) == "defpoints":
            hidden = "the layer is not for plotting"
        return Pen(
            printable(name),
            _fold_name(name),
            _hex_colour(layer.rgb, layer.color),
            self._width_mm(layer.dxf.get("lineweight", -3), Pen(), Pen()),
            self._line_types.get(_fold_name(layer.dxf.get("linetype", ""))),
            hidden=hidden,
            frozen=layer.is_frozen(),
            see_through=layer.transparency > 0,
        )

    def _colour(self, entity, layer: Pen, block: Pen) -> str:
        number = entity.dxf.get("color", _BYLAYER)
        if entity.dxf.hasattr("true_color"):
            return _hex_colour(entity.rgb, number)
        return self._indexed_colour(number, layer, block)

    @staticmethod
    def _see_through(entity, layer: Pen, block: Pen) -> bool:
        value = entity.dxf.get("transparency", 0)
        if value & _OWN_TRANSPARENCY:
            return ezdxf.colors.transparency2float(value) > 0
        return block.see_through if value & _TRANSPARENCY_BYBLOCK else layer.see_through

    @staticmethod
    def _indexed_colour(number: int, layer: Pen, block: Pen) -> str:
        if number == _BYLAYER:
            return layer.colour
        return block.colour if number == _BYBLOCK else _hex_colour(None, number)

    @staticmethod
    def _width_mm(weight: int, layer: Pen, block: Pen) -> float:
        """Return the line width.

        weight: in 1/100 mm. The weight 0 means "as thin as possible". A brush uses the default width instead.
        """
        if weight == _WEIGHT_BYLAYER:
            return layer.width_mm
        if weight == _WEIGHT_BYBLOCK:
            return block.width_mm
        return weight / 100 if weight > 0 else _DEFAULT_WIDTH_MM


def _line_type(line, scale: float) -> LineType | None:
    tags = line.pattern_tags
    elements = [tag.value for tag in tags.tags if tag.code == 49]
    if tags.is_complex_type():
        return LineType(printable(line.dxf.name), ())
    if not any(element < 0 for element in elements):  # no gaps
        return None
    return LineType(printable(line.dxf.name), tuple(scale * length for length in _dash_pattern(elements)))


def _dash_pattern(elements: list[float]) -> list[float]:
    """Return the lengths of dash, gap, dash, gap ... of a line type.

    The result is [] if there is no dash. CAD programs start lines with a whole dash, so the pattern does, too.

    elements: lengths of the line type; gaps are negative.
    """
    first = next((k for k, element in enumerate(elements) if not element < 0), len(elements))
    pattern: list[float] = []
    for element in elements[first:] + elements[:first] if first < len(elements) else []:
        if len(pattern) % 2 == (element < 0):
            pattern.append(abs(element))
        else:
            pattern[-1] += abs(element)
    if len(pattern) % 2:
        pattern[0] += pattern.pop()
    return pattern


def _hex_colour(true_colour: tuple[int, int, int] | None, number: int) -> str:
    """Return a colour as "#rrggbb", with black in place of white.

    CAD programs show black as white on a black background. Colour number 7 stands for both.
    """
    if true_colour is None:
        true_colour = ezdxf.colors.aci2rgb(number) if 0 < number < 256 and number != 7 else (0, 0, 0)
    colour = "#{:02x}{:02x}{:02x}".format(*true_colour)
    return _BLACK if colour == "#ffffff" else colour


def _fold_name(name: str) -> str:
    return name.casefold()
