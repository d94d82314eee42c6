"""Convert a shape of an SVG file to an Element: paint, geometry and dashes."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np

from ...errors import Error
from ...geometry.arc_length import knots
from ...geometry.cubics import extremes, flattened
from ...geometry.polylines import length
from ...geometry.rings import signed_area
from ...units import MM_PER, number
from ..background import is_light
from ..design import Element, SubPath
from .context import Context, NoticeList, local_name
from .css.cascade import MARKERS
from .paint_servers import PaintServers
from .paths import shapes
from .paths.path_to_cubics import MAX_COORDINATE_MM, trace
from .paths.power_stroke import PowerStroke, add_widths, read_power_stroke
from .transform import IDENTITY, scales

_WITH_MARKERS = frozenset(("path", "line", "polyline", "polygon"))
_MAX_EVEN_RATIO = 1.05  # ratio of the scales; below it the width differs by less than the scatter of a brush
_FLATTENING_TOLERANCE_MM = 0.05
# A page of text has a hundredth of these numbers of dashes and of characters of path data.
_MAX_DASHES = 100_000
_MAX_PATH_DATA = 10_000_000


class PaintedElements:
    """The painted elements of a drawing. Each call of add converts a shape.

    elements: the converted elements, in the order in which they are painted.
    in_group_effects: the SVG elements whose outlines are changed by path effects of groups.
    """

    def __init__(
        self,
        by_id: dict[str, ET.Element],
        notes: NoticeList,
        paints: PaintServers,
        in_group_effects: set[ET.Element],
    ):
        self.elements: list[Element] = []
        self.by_id = by_id
        self.paints = paints
        self.in_group_effects = in_group_effects
        self.notes = notes
        self.unnamed = self.path_data_length = 0
        self.dashes_left = _MAX_DASHES

    def add(self, node: ET.Element, tag: str, context: Context) -> None:
        """Convert the undamaged part of a shape and add it to the elements."""
        properties = context.style.inherited
        stroke, stroke_notices = self.paints.find_paint(properties, "stroke")
        fill, fill_notices = self.paints.find_paint(properties, "fill") if tag != "line" else ("none", [])
        attributes = {**node.attrib, **context.style.geometry} if context.style.geometry else node.attrib
        power, unread = (
            read_power_stroke(node, self.by_id, node in self.in_group_effects) if tag == "path" else (None, [])
        )
        greatest, least = scales(context.matrix)
        if least <= 1e-12 * greatest:
            self.notes.add(node, context, "its transforms flatten it to nothing: left out", code="geometry-empty")
            return
        mm_per_user = math.sqrt(greatest * least)
        width_mm = context.length(properties["stroke-width"], context.diagonal) * mm_per_user
        if context.counts_in_screen_px:
            width_mm *= MM_PER["px"] / mm_per_user
        if power:
            attributes = {**attributes, "d": power.d}
            stroke, stroke_notices = (fill, fill_notices) if fill != "none" else (stroke, stroke_notices)
            fill = "none"
        if "width_mm" in context.settings:
            width_mm, power = context.settings["width_mm"], None
            # Only an element without any paint gets a stroke. A filled shape stays a filled shape.
            if stroke == "none" and fill == "none":
                stroke = properties["color"][:7]
        if power is None and width_mm == 0:
            stroke = "none"
        if stroke == "none" and fill == "none":
            sentence = f"{self._why_unpainted(properties, tag, width_mm)}: left out"
            self.notes.add(node, context, sentence, code="neither-stroke-nor-fill")
            return
        if not width_mm <= MAX_COORDINATE_MM:
            sentence = f"its stroke-width {width_mm:.6g} mm is beyond 1e6 mm: left out"
            self.notes.add(node, context, sentence, damaged=True, code="geometry-out-of-range")
            return
        before = len(self.notes.notices)
        outline = self._outline_on_paper(node, tag, attributes, context, power)
        subpaths, gap_mm = self._with_dashes(node, context, outline) if stroke != "none" else (outline, 0.0)
        if not subpaths:
            return
        has_even_width = "width_mm" in context.settings or (context.counts_in_screen_px and power is None)
        if stroke != "none" and greatest > _MAX_EVEN_RATIO * least and not has_even_width:
            sentence = f"its transforms stretch it unevenly: its width counts as {width_mm:.4g} mm, the mean"
            self.notes.add(node, context, sentence, code="stretched-unevenly")
        for notice in unread + fill_notices * (fill != "none") + stroke_notices * (stroke != "none"):
            self.notes.add(node, context, notice.sentence, code=notice.code, about=notice.about)
        if any(is_light(colour) for colour in (fill, stroke) if colour.startswith("#")):
            sentence = (
                "it is white or nearly white, and painted like any colour: what it hides in the drawing is painted, "
                'too; data-brushsvg-skip="yes" on it leaves it out'
            )
            self.notes.add(node, context, sentence, code="white-paint")
        # A black fill by default is rarely intended next to a stroke of another colour.
        is_two = properties["fill"] and "none" not in (fill, stroke) and fill != stroke
        order = properties["paint-order"].split()
        is_under_fill = is_two and "stroke" in order and "fill" not in order[: order.index("stroke")]
        if stroke == "none" and "width_mm" in context.settings:
            sentence = "data-brushsvg-width has no effect: it is a filled shape without a stroke"
            self.notes.add(node, context, sentence, code="width-without-effect", about="data-brushsvg-width")
        if tag in _WITH_MARKERS and any(properties[name] != "none" for name in MARKERS):
            self.notes.add(node, context, "markers are not read: left out", code="markers-unread")
        element = Element(
            id=self._name_element(node, context, before),
            subpaths=subpaths,
            stroke_width_mm=0.0 if stroke == "none" else width_mm,
            colour=fill if stroke == "none" else stroke,
            layer=context.layer,
            settings=context.settings,
            fill_rule="" if fill == "none" else properties["fill-rule"],
            fill_colour=fill if is_two else "",
            dash_gap_mm=gap_mm,
            is_under_fill=is_under_fill,
        )
        elements = [element]
        # The dashes do not enclose the filled area, so the fill keeps the outline without dashes.
        if element.fill_rule and subpaths is not outline and _encloses(outline, width_mm):
            shape, line = replace(element, fill_colour=element.fill_colour or element.colour).by_colour()
            elements = [replace(shape, subpaths=outline), line]
        if context.clip is not None:
            elements = [piece for whole in elements for piece in self._clipped(node, context, whole)]
        self.elements += elements

    def _clipped(self, node: ET.Element, context: Context, element: Element) -> list[Element]:
        from ..clipping import clip_element, reach_beyond_edge_mm

        pieces = clip_element(element, context.clip)
        if reach_mm := max((reach_beyond_edge_mm(p, context.clip) for p in pieces if p is not element), default=0.0):
            sentence = (
                "a clip path, mask or viewport cuts it lengthwise, which is read for shapes only: painted "
                f"{reach_mm:.2g} mm beyond the edge; make it a shape, in Inkscape with Path > Stroke to Path"
            )
            self.notes.add(node, context, sentence, code="clipping-unread")
        if not pieces:
            # Lines are cut where their middle line crosses the edge, so the width may still reach in.
            what = "its middle line" if element.is_stroked else "it"
            sentence = f"{what} is outside the clip path, mask or viewport that would show it: left out"
            self.notes.add(node, context, sentence, code="clipped-away")
        return pieces

    def _why_unpainted(self, properties: dict[str, str], tag: str, width_mm: float) -> str:
        """Return the reason why an element has neither stroke nor fill."""
        kinds = [name for name in ("stroke", "fill") if properties[name] != "none" and (name, tag) != ("fill", "line")]
        causes = [
            "its stroke-width is 0"
            if name == "stroke" and width_mm == 0
            else self.paints.explain_no_paint(properties, name)
            for name in kinds
        ]
        return " and ".join(causes) or "it has neither stroke nor fill"

    def bounds(self, node: ET.Element, context: Context) -> tuple[float, float, float, float] | None:
        """Return the bounds (x, y, width, height) of a shape in its own user units.

        The result is None if the shape has no geometry or damaged geometry.
        """
        attributes = {**node.attrib, **context.style.geometry}
        try:
            commands = shapes.shape_commands(local_name(node), attributes, context.viewport, context.em_px)
        except shapes.DamageError:
            return None
        line = trace(commands, IDENTITY, 1.0)
        if line.beyond is not None or not line.subpaths:
            return None
        points = np.concatenate([extremes(subpath.cubics) for subpath in line.subpaths])
        (x, y), (width, height) = points.min(axis=0).tolist(), np.ptp(points, axis=0).tolist()
        return x, y, width, height

    def _name_element(self, node: ET.Element, context: Context, first: int) -> str:
        """Return a painted element's name; one without id gets a name, used by notices from `first` on too."""
        if name := context.name(node):
            return name
        self.unnamed += 1
        name = f"stroke{self.unnamed}"
        notices = self.notes.notices
        if len(notices) > first:
            label = f"{name} ({self.notes.label(node)})"
            notices[first:] = [replace(notice, where=label) for notice in notices[first:]]
        return name

    def _outline_on_paper(
        self, node, tag: str, attributes, context: Context, power: PowerStroke | None
    ) -> tuple[SubPath, ...]:
        """Return the geometry of an element on paper, without dashes."""
        greatest, least = scales(context.matrix)
        subpaths = self._trace_geometry(node, tag, attributes, context, greatest)
        return add_widths(power, subpaths, math.sqrt(greatest * least)) if power else subpaths

    def _with_dashes(self, node, context: Context, subpaths: tuple[SubPath, ...]) -> tuple[tuple[SubPath, ...], float]:
        greatest, least = scales(context.matrix)
        mm_per_unit = MM_PER["px"] if context.counts_in_screen_px else math.sqrt(greatest * least)
        return self._cut_dashes(node, context, subpaths, mm_per_unit)

    def _trace_geometry(self, node, tag: str, attributes, context: Context, greatest: float) -> tuple[SubPath, ...]:
        self.path_data_length += len(attributes.get("d", "")) + len(attributes.get("points", ""))
        if self.path_data_length > _MAX_PATH_DATA:
            sentence = f"the drawing has more than {_MAX_PATH_DATA} characters of path data"
            raise Error(sentence, self.notes.label(node), code="drawing-too-large")
        try:
            commands = shapes.shape_commands(tag, attributes, context.viewport, context.em_px)
            if not commands:
                self.notes.add(node, context, "it has no geometry: left out", code="geometry-empty")
        except shapes.DamageError as damage:
            self.notes.add(node, context, str(damage), damaged=True, code="geometry-damaged")
            commands = damage.commands
        line = trace(commands, context.matrix, greatest)
        if line.beyond is not None:
            self.notes.add(
                node,
                context,
                _out_of_range_sentence(attributes, tag, line.beyond),
                damaged=True,
                code="geometry-out-of-range",
            )
        if line.lone_movetos:
            count = "a moveto" if line.lone_movetos == 1 else f"{line.lone_movetos} movetos"
            self.notes.add(node, context, f"{count} without a line to follow: skipped", code="moveto-alone")
        return line.subpaths

    def _cut_dashes(self, node, context: Context, subpaths, mm_per_unit: float) -> tuple[tuple[SubPath, ...], float]:
        """Return the dashes of an element and the smallest gap between them, 0 if it is not cut."""
        properties = context.style.inherited
        if properties["stroke-dasharray"] == "none" or not subpaths:
            return subpaths, 0.0
        from ..dashes import cut_into_dashes, find_smallest_gap_mm

        words = [word for part in properties["stroke-dasharray"].split(",") for word in part.split() or [""]]
        try:
            scale = mm_per_unit * self._dash_unit_scale(node, context, subpaths, mm_per_unit)
            pattern = [context.length(word, context.diagonal) * scale for word in words]
            offset = context.length(properties["stroke-dashoffset"], context.diagonal) * scale
        except Error as error:
            self.notes.add(node, context, f"stroke-dasharray: {error}: the line counts as solid", code="dashes-unread")
            return subpaths, 0.0
        if min(pattern, default=0.0) < 0:
            self.notes.add(
                node,
                context,
                "stroke-dasharray has a negative length: the line counts as solid",
                code="dashes-unread",
            )
            return subpaths, 0.0
        if not 0 < sum(pattern) < math.inf:
            return subpaths, 0.0
        if subpaths[0].widths is not None:
            self.notes.add(node, context, "its dashes are not read: its width varies", code="dashes-unread")
            return subpaths, 0.0
        pieces: list[SubPath] = []
        try:
            for subpath in subpaths:
                pieces += cut_into_dashes(subpath, pattern, offset, self.dashes_left - len(pieces))
        except Error as error:
            raise Error(str(error), where=self.notes.label(node), code=error.code) from None
        self.dashes_left -= len(pieces)
        self.notes.add(node, context, f"it is dashed: {len(pieces)} dashes, each a stroke", code="dashed")
        return tuple(pieces), find_smallest_gap_mm(pattern) if len(pieces) > len(subpaths) else 0.0

    def _dash_unit_scale(self, node, context: Context, subpaths, mm_per_unit: float) -> float:
        """Return the length of a dash unit as a multiple of mm_per_unit.

        pathLength can define how many units the path has. Without it the result is 1.
        """
        text = (node.get("pathLength") or "").strip()
        if not text:
            return 1.0
        try:
            path_length = number(text)
        except Error as error:
            self.notes.add(node, context, f"pathLength: {error}; it is ignored", code="path-length-unread")
            return 1.0
        if path_length < 0:
            return 1.0
        length_mm = sum(float(knots(subpath.cubics)[:, -1].sum()) for subpath in subpaths)
        return length_mm / mm_per_unit / path_length if path_length else math.inf


def _encloses(subpaths: tuple[SubPath, ...], width_mm: float) -> bool:
    """Whether an outline encloses more area than a line along it covers."""
    rings = [flattened(subpath.cubics, _FLATTENING_TOLERANCE_MM) for subpath in subpaths]
    return sum(abs(signed_area(ring)) for ring in rings) > sum(map(length, rings)) * width_mm / 2


def _out_of_range_sentence(attributes, tag: str, place: int) -> str:
    name = {"path": "d", "polyline": "points", "polygon": "points"}.get(tag)
    if name is None:
        return "its geometry is beyond 1e6 mm: left out"
    found = shapes.snippet(attributes[name], place)
    return f"{name} goes beyond 1e6 mm at character {place + 1}: found {found}; read up to there"
