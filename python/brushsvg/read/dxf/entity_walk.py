"""Walk over the model space of a DXF and collect its lines on paper.

Blocks are unfolded. The lines keep the order in which they were drawn.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...errors import Error
from ..design import Notice
from ..svg.paths.path_to_cubics import MAX_COORDINATE_MM
from . import entity_curves as dxf_curves
from .entity_curves import Curve
from .ezdxf_import import ezdxf
from .file import exception_text, printable, unread_phrase
from .fonts import NoFontError
from .pens import Pen, Pens
from .text_entities import TextConverter

_CURVE_TOLERANCE_MM = 1e-4
# A brush paints some thousand strokes a day. Only a malicious drawing unfolds to more entities.
_MAX_ENTITIES = 100_000
_MAX_CUBICS = 1_000_000
_MAX_DISTANCE_MM = 1e11  # distance from the origin; beyond it the precision of 64 bits is too low
_MAX_BLOCK_DEPTH = 50  # nesting depth of blocks
_JOINABLE_TYPES = frozenset(("LINE", "ARC", "ELLIPSE", "SPLINE"))
_SILENT_TYPES = frozenset(("VIEWPORT", "SEQEND"))
_TEXT_TYPES = frozenset(("TEXT", "ATTRIB", "ATTDEF"))
_TEXT_ADVICE = "text is not read: explode it into lines in the program that made the drawing"
_ENDLESS_TYPES = frozenset(("RAY", "XLINE"))


@dataclass(frozen=True)
class Piece:
    """The lines or the filled shape that one entity paints.

    id: name of the entity, with the names of the block references around it.
    block: the block reference that contains the entity, "" for the drawing itself.
    curves: cubics (n, 4, 3) on paper [mm], with z left to the caller; widths in mm.
    fill_rule: "" for lines.
    joinable: whether the piece may be part of a longer line.
    """

    id: str
    block: str
    pen: Pen
    curves: tuple[Curve, ...]
    fill_rule: str = ""
    joinable: bool = False


@dataclass(frozen=True)
class _Placement:
    """The place of the entities of a block.

    mm_from_block: (4, 4), maps row vectors, so it stands to the right of a point.
    pen: the pen of the block reference.
    name: the name of the block reference.
    blocks: the blocks around it, to detect a block that inserts itself.
    """

    mm_from_block: np.ndarray
    pen: Pen | None = None
    name: str = ""
    blocks: tuple[str, ...] = ()

    @cached_property
    def stretch(self) -> float:
        """Greatest length on paper of one unit [mm]."""
        return float(np.linalg.norm(self.mm_from_block[:3, :3], 2))

    def widths_mm(self, line: Curve, normal) -> np.ndarray:
        """Return the widths (n, 2) of a line on paper [mm].

        A block can be squeezed, so a width depends on the direction across the line, in the plane of the polyline.
        """
        mean = math.sqrt(abs(float(np.linalg.det(self.mm_from_block[:2, :2]))))
        along = line.cubics[:, (1, 3)] - line.cubics[:, (0, 2)]  # at the start and end of each
        along /= np.linalg.norm(along, axis=2, keepdims=True)
        across = np.cross(np.asarray(normal, dtype=float), along)
        (tx, ty), (nx, ny) = ((vectors @ self.mm_from_block[:3, :2]).transpose(2, 0, 1) for vectors in (along, across))
        squeezed = np.abs(tx * ny - ty * nx) / np.hypot(tx, ty) / mean
        # Rounding keeps equal widths equal. A piece without length has no direction, so its factor is 1.
        return line.widths * mean * np.where(np.isfinite(squeezed), squeezed.round(9), 1.0)


def _translation(by) -> np.ndarray:
    """Return the (4, 4) matrix of a translation for row vectors, as ezdxf has them."""
    matrix = np.eye(4)
    matrix[3, :3] = by
    return matrix


def _top_level_name(name: str) -> str:
    """Return the first part of a name: names of blocks in blocks can have any length."""
    return name.partition("/")[0]


def _attribute_text_entity(attribute):
    """Return the text entity of an attribute: an MTEXT if it can have several lines."""
    return attribute.virtual_mtext_entity() if attribute.has_embedded_mtext_entity else attribute


class EntityWalk:
    """The walk over a model space. Call run, then use pieces and notices."""

    def __init__(self, document: ezdxf.document.Drawing, mm_per_unit: float):
        self.document = document
        self.pens = Pens(document, mm_per_unit)
        self.text = TextConverter(document)
        self.top = _Placement(np.diag([mm_per_unit, mm_per_unit, mm_per_unit, 1.0]))
        self.pieces: list[Piece] = []
        self.notices: list[Notice] = []
        self._counts: Counter[tuple[str, str, str | None, str]] = Counter()
        self._curve_cache: dict[tuple[str | None, float], list[Curve] | None] = {}
        self._reported: set[tuple[str, str]] = set()
        self._entities = self._cubics = 0

    def run(self) -> None:
        with np.errstate(all="ignore"):
            self._walk(self.document.modelspace(), self.top)
        for layout in self.document.layouts:
            if not layout.is_modelspace:
                count = sum(entity.dxftype() not in _SILENT_TYPES for entity in layout)
                self._leave_out(printable(layout.name), "paper space is not painted", code="paper-space", count=count)
        for (where, why, layer, code), count in self._counts.items():
            if count:
                entities = "1 entity" if count == 1 else f"{count} entities"
                self.notices.append(Notice(where, f"{why}: {entities} left out", layer=layer, code=code))
        self.notices += self.text.notices

    def _walk(self, entities, place: _Placement) -> None:
        for number, entity in enumerate(entities, 1):
            self._entities += 1
            if self._entities > _MAX_ENTITIES:
                raise Error(
                    f"the drawing unfolds to more than {_MAX_ENTITIES} entities, blocks in blocks counted "
                    "each time they are inserted",
                    where=_top_level_name(place.name),
                    code="drawing-too-large",
                )
            kind = printable(entity.dxftype(), 40)
            name = f"{place.name}/" if place.name else ""
            name += f"{kind}-{entity.dxf.handle or number}"
            layer = None
            try:
                if kind in _SILENT_TYPES:
                    continue
                if not isinstance(entity, ezdxf.entities.DXFGraphic):
                    self._leave_out(kind, unread_phrase(kind), code="dxf-entity-unread")
                    continue
                if kind == "ATTDEF" and place.blocks and not (entity.is_const and not entity.is_invisible):
                    continue  # an ATTRIB of the INSERT takes the place of the definition
                pen = self.pens.pen(entity, place.pen)
                layer = pen.layer
                self._visit_entity(entity, kind, name, pen, place)
            except Error:
                raise
            except NoFontError:
                self._leave_out(kind, _TEXT_ADVICE, layer, code="text-unread")
            except Exception as problem:  # ezdxf raises anything on arbitrary numbers
                self._note(
                    name,
                    f"it is damaged ({exception_text(problem)}): left out",
                    layer,
                    damaged=True,
                    code="geometry-damaged",
                )

    def _visit_entity(self, entity, kind: str, name: str, pen: Pen, place: _Placement) -> None:
        if entity.dxf.get("invisible", 0):
            self._leave_out("invisible", "entities made invisible are not painted", code="hidden")
        elif kind == "INSERT":
            self._walk_insert(entity, name, pen, place)
        elif pen.hidden:
            self._leave_out(pen.layer, pen.hidden, pen.layer, code="hidden")
        elif kind == "ATTDEF" and not place.blocks:
            sentence = "attribute definitions are no text of the drawing"
            self._leave_out(kind, sentence, pen.layer, code="attribute-definition")
        elif kind in _TEXT_TYPES:
            lines = self.text.outlines(entity, name, pen.layer)
            self._add_piece(entity, kind, name, pen, place, lines)
        elif kind == "MTEXT":
            parts = self.text.parts(entity, name, pen.layer)
            # The letters have their own colours, where "by block" refers to the block around the whole text.
            self._walk_parts(parts, name, place.pen, place)
        elif kind in _ENDLESS_TYPES:
            self._leave_out(kind, f"{kind} has no ends", code="line-without-ends")
        elif (lines := self._cached_curves(entity, place.stretch)) is not None:
            self._add_piece(entity, kind, name, pen, place, lines)
        elif isinstance(entity, ezdxf.protocols.SupportsVirtualEntities):
            parts = list(ezdxf.protocols.virtual_entities(entity))
            if not parts:
                self._leave_out(kind, unread_phrase(kind), code="dxf-entity-unread")
            self._walk_parts(parts, name, pen, place)
        else:
            self._leave_out(kind, unread_phrase(kind), code="dxf-entity-unread")

    def _walk_parts(self, parts: list, name: str, pen: Pen | None, place: _Placement) -> None:
        self._check_depth(name, place)
        self._walk(parts, _Placement(place.mm_from_block, pen, name, (*place.blocks, name)))

    def _cached_curves(self, entity, stretch: float) -> list[Curve] | None:
        """Return cached curves of a block's entity, one conversion per size rounded up to a power of 2."""
        stretch = 2.0 ** math.ceil(math.log2(stretch))
        key = entity.dxf.handle, stretch
        if key not in self._curve_cache or key[0] is None:
            self._curve_cache[key] = dxf_curves.entity_to_curves(entity, _CURVE_TOLERANCE_MM / stretch)
        return self._curve_cache[key]

    def _walk_insert(self, insert, name: str, pen: Pen, place: _Placement) -> None:
        if pen.frozen:
            self._leave_out(pen.layer, pen.hidden, pen.layer, code="hidden")
            return
        shown_here = [attribute for attribute in insert.attribs if not attribute.is_invisible]
        attributes = [_attribute_text_entity(attribute) for attribute in shown_here]
        cells = self._insert_cells(insert, name)
        for suffix, shift in cells if attributes else ():
            shifted = replace(place, mm_from_block=_translation(shift) @ place.mm_from_block)
            self._walk_parts(attributes, name + suffix, pen, shifted)
        block = insert.block()
        block_name = printable(insert.dxf.get("name", ""), 40)
        if block is None:
            self._note(name, f"there is no block {block_name!r}: left out", pen.layer, damaged=True, code="dxf-block")
            return
        if block.block.is_xref:
            sentence = f"block {block_name!r} is kept in another file, which is not read: left out"
            self._note(name, sentence, pen.layer, code="dxf-block")
            return
        key = insert.dxf.name.casefold()
        if key in place.blocks:
            raise Error(f"block {block_name!r} inserts itself", where=_top_level_name(name), code="dxf-block")
        if ezdxf.xclip.XClip(insert).is_clipping_enabled:
            self._note(
                name,
                "its clipping (XCLIP) is not read: it counts as whole",
                pen.layer,
                code="clipping-unread",
            )
        self._check_depth(name, place)
        matrix = np.array(list(insert.matrix44())).reshape(4, 4)
        for suffix, shift in cells:
            moved = matrix.copy()
            moved[3, :3] += shift
            inner = moved @ place.mm_from_block
            self._walk(block, _Placement(inner, pen, name + suffix, (*place.blocks, key)))

    def _insert_cells(self, insert, name: str):
        """Return (name suffix, shift in the insert's world) for each cell of its rows and columns."""
        dxf = insert.dxf
        rows = dxf.get("row_count", 1) if dxf.get("row_spacing", 0.0) else 1
        columns = dxf.get("column_count", 1) if dxf.get("column_spacing", 0.0) else 1
        rows, columns = max(rows, 1), max(columns, 1)
        if rows * columns > _MAX_ENTITIES:
            sentence = f"{rows} rows of {columns} columns are more than {_MAX_ENTITIES} entities"
            raise Error(sentence, where=_top_level_name(name), code="drawing-too-large")
        if rows == columns == 1:
            return [("", np.zeros(3))]
        turn = math.radians(dxf.get("rotation", 0.0))
        ocs = insert.ocs()
        places = []
        for row, column in itertools.product(range(rows), range(columns)):
            self._entities += 1
            x, y = column * dxf.get("column_spacing", 0.0), row * dxf.get("row_spacing", 0.0)
            shift = (x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), 0.0)
            places.append((f".{row + 1}.{column + 1}", np.array(ocs.to_wcs(ezdxf.math.Vec3(shift)).xyz)))
        return places

    def _check_depth(self, name: str, place: _Placement) -> None:
        if len(place.blocks) >= _MAX_BLOCK_DEPTH:
            sentence = f"blocks are nested more than {_MAX_BLOCK_DEPTH} deep"
            raise Error(sentence, where=_top_level_name(name), code="drawing-too-large")

    def _add_piece(self, entity, kind: str, name: str, pen: Pen, place: _Placement, lines: list[Curve]) -> None:
        fill_rule = "nonzero" if kind in _TEXT_TYPES else "evenodd" if kind in dxf_curves.FILLED_TYPES else ""
        curves = []
        for line in lines:
            self._cubics += len(line.cubics)
            if self._cubics > _MAX_CUBICS:
                sentence = f"the drawing unfolds to more than {_MAX_CUBICS} curves"
                raise Error(sentence, where=_top_level_name(name), code="drawing-too-large")
            cubics = line.cubics @ place.mm_from_block[:3, :3] + place.mm_from_block[3, :3]
            widths = None if line.widths is None else place.widths_mm(line, entity.dxf.extrusion.normalize())
            if not (
                np.abs(cubics).max() <= _MAX_DISTANCE_MM and np.ptp(cubics, axis=(0, 1)).max() <= MAX_COORDINATE_MM
            ):
                sentence = "its geometry is not finite or beyond 1e6 mm: left out"
                self._note(name, sentence, pen.layer, damaged=True, code="geometry-out-of-range")
                return
            if widths is not None and not (widths.min() >= 0 and widths.max() <= MAX_COORDINATE_MM):
                sentence = "its widths are outside the range [0, 1e6] mm: left out"
                self._note(name, sentence, pen.layer, damaged=True, code="geometry-out-of-range")
                return
            curves.append(Curve(cubics, line.closed, widths, line.pattern_restarts))
        if not curves:
            self._note(name, "it has no geometry: left out", pen.layer, code="geometry-empty")
            return
        filling = pen
        if kind == "MPOLYGON":
            self.pieces.append(Piece(f"{name}.border", place.name, pen, tuple(curves)))
            if not (entity.dxf.solid_fill or entity.dxf.pattern_name not in ("", "SOLID")):
                return
            filling = self.pens.filling(entity, pen, place.pen) if entity.dxf.solid_fill else pen
        if kind in ("HATCH", "MPOLYGON"):
            if not entity.dxf.solid_fill:
                self._note(name, "its pattern is not read: it counts as filled", pen.layer, code="paint-unread")
            elif entity.gradient is not None and entity.gradient.number_of_colors:
                self._note(name, "its gradient is not read: it counts as filled", pen.layer, code="paint-unread")
        self._report_unpainted(entity, kind, name, pen, bool(fill_rule) or curves[0].widths is not None)
        joinable = kind in _JOINABLE_TYPES and len(curves) == 1 and not curves[0].closed
        self.pieces.append(Piece(name, place.name, filling, tuple(curves), fill_rule, joinable))

    def _report_unpainted(self, entity, kind: str, name: str, pen: Pen, filled: bool) -> None:
        header, dxf = self.document.header, entity.dxf
        if pen.see_through:
            self._note(name, "it is see-through: it counts as opaque", pen.layer, code="opacity-unread")
        if dxf.hasattr("thickness") and dxf.thickness and np.hypot(*dxf.extrusion.vec2) > 1e-9:
            sentence = "its thickness, which would show from above, is not read"
            self._note(name, sentence, pen.layer, code="thickness-unread")
        if kind == "POINT" and (mode := header.get("$PDMODE", 0)):
            self._note_once("$PDMODE", f"points are shown as marks of kind {mode}: they are painted as dabs")
        if filled and kind not in _TEXT_TYPES and not header.get("$FILLMODE", 1):
            self._note_once(
                "$FILLMODE",
                "shapes and wide lines are shown by their outlines alone: they are painted filled",
            )

    def _note_once(self, where: str, sentence: str) -> None:
        if (where, sentence) not in self._reported:
            self._reported.add((where, sentence))
            self._note(where, sentence, None, code="shown-otherwise")

    def _leave_out(self, where: str, why: str, layer: str | None = None, *, code: str, count: int = 1) -> None:
        self._counts[where, why, layer, code] += count

    def _note(self, where: str, sentence: str, layer: str | None, damaged: bool = False, *, code: str) -> None:
        self.notices.append(Notice(where, sentence, damaged, layer, code=code))
