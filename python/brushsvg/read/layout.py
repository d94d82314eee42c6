"""Place a drawing on the sheet and choose the layers to paint: Design to Design."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import Error, Notice, list_first
from ..geometry.cubics import extremes
from .design import Design, Element, SubPath


@dataclass(frozen=True)
class Layout:
    """Options for a drawing as a whole.

    A value that is None or empty leaves the drawing as drawn.

    layers: names of the layers to paint, with all that they contain.
    needs_layers: refuse a drawing that has no layers at all, instead of painting all of it.
    width_mm: width of every line, in place of the drawing's widths. Filled shapes have none.
    fit_mm: (width, height); the target marks are scaled to fill this size as far as their shape allows, and placed
    in the middle of the sheet.
    scale: a factor in place of fit_mm, about the middle of the marks.
    origin_mm: (x, y) of the lower left corner of the marks, in place of the middle of the sheet or their own place.
    """

    layers: tuple[str, ...] = ()
    width_mm: float | None = None
    fit_mm: tuple[float, float] | None = None
    scale: float | None = None
    origin_mm: tuple[float, float] | None = None
    needs_layers: bool = True


AS_DRAWN = Layout()
# Codes of the notices about widths. These notices are dropped if width_mm replaces the widths.
WIDTH_NOTICE_CODES = ("gcode-no-width", "stretched-unevenly")
_MAX_NAMED_LAYERS = 20  # layers that a sentence names
_MAX_NAMED_SHAPES = 3  # filled shapes that a sentence names


def arrange(design: Design, layout: Layout) -> Design:
    """Choose the layers of a drawing, set its widths, scale and place its marks.

    Widths are scaled with the drawing, except for layout.width_mm. The sheet stays the same.

    Raises Error for a layer that does not exist or has nothing to paint, and for marks that cannot be fitted.
    """
    if layout.layers:
        design = _select_layers(design, layout)
    if layout.width_mm is not None:
        elements = tuple(_set_width(e, layout.width_mm) for e in design.elements)
        notices = tuple(notice for notice in design.notices if notice.code not in WIDTH_NOTICE_CODES)
        design = replace(design, elements=elements, notices=(*notices, *_report_shapes_without_width(elements)))
    if layout.fit_mm is not None or layout.scale is not None or layout.origin_mm is not None:
        design = _place(design, layout)
    joining = _report_joining_dashes(design.elements)
    return replace(design, notices=(*design.notices, *joining)) if joining else design


def _place(design: Design, layout: Layout) -> Design:
    keeps_width = layout.width_mm is not None
    lines, marks = bounds_mm(design.elements, with_widths=False), bounds_mm(design.elements)
    scale = layout.scale or 1.0
    if layout.fit_mm is not None:
        scale = _fitting_scale(lines, marks, layout.fit_mm, keeps_width)
    margin = (marks - lines) * (1.0 if keeps_width else scale)
    scaled = lines * scale + margin  # bounds of the scaled marks, before they are moved
    if layout.origin_mm is not None:
        shift = np.array(layout.origin_mm) - scaled[:2]
    elif layout.fit_mm is not None:
        shift = np.array(design.sheet_mm) / 2 - (scaled[:2] + scaled[2:]) / 2
    else:
        shift = (marks[:2] + marks[2:]) / 2 - (scaled[:2] + scaled[2:]) / 2
    width_scale = 1.0 if keeps_width else scale
    return replace(design, elements=tuple(scale_and_move(e, scale, shift, width_scale) for e in design.elements))


def bounds_mm(elements: Iterable[Element], with_widths: bool = True) -> np.ndarray:
    """Return the bounds x0, y0, x1, y1 [mm] of the target marks, shape (4,).

    with_widths: include half the stroke widths; otherwise the bounds of the middle lines and outlines alone.
    """
    box = np.array([math.inf, math.inf, -math.inf, -math.inf])
    for element in elements:
        if not element.subpaths:
            continue
        halves = [half_width_mm(element, subpath) if with_widths else 0.0 for subpath in element.subpaths]
        half = np.repeat(halves, [len(subpath.cubics) for subpath in element.subpaths])[:, None]
        points = extremes(np.concatenate([subpath.cubics for subpath in element.subpaths]))
        half = np.tile(half, (len(points) // len(half), 1))
        box[:2] = np.minimum(box[:2], (points - half).min(axis=0))
        box[2:] = np.maximum(box[2:], (points + half).max(axis=0))
    return box


def half_width_mm(element: Element, subpath: SubPath) -> float:
    return (element.stroke_width_mm if subpath.widths is None else float(subpath.widths[:, 1].max())) / 2


def _fitting_scale(lines: np.ndarray, marks: np.ndarray, fit_mm: tuple[float, float], keeps_width: bool) -> float:
    """Return the largest scale at which the marks are not larger than fit_mm."""
    size, margin = lines[2:] - lines[:2], (marks[2:] - marks[:2]) - (lines[2:] - lines[:2])
    room = np.array(fit_mm) - (margin if keeps_width else 0.0)
    growing = size if keeps_width else size + margin
    if (room <= 0).any():
        sentence = f"strokes {margin.max():.4g} mm wide do not fit {fit_mm[0]:g} x {fit_mm[1]:g} mm"
        raise Error(sentence, where="fit", code="drawing-does-not-fit")
    with np.errstate(divide="ignore"):
        scale = float((room / growing).min())
    if not math.isfinite(scale):
        raise Error("marks without a size cannot be fitted", where="fit", code="drawing-does-not-fit")
    return scale


def _select_layers(design: Design, layout: Layout) -> Design:
    painted = [element.layer for element in design.elements if element.layer]
    noticed = [notice.layer for notice in design.notices if notice.layer]
    paths = list(dict.fromkeys([*painted, *filter(None, design.layers), *noticed]))
    if not paths and not layout.needs_layers:
        return design
    requested = [_find_layer(name, paths) for name in layout.layers]

    def is_chosen(layer: str | None, among: list[str] = requested) -> bool:
        return any(layer == path or (layer or "").startswith(path + "/") for path in among)

    for path in requested:
        if not any(is_chosen(element.layer, [path]) for element in design.elements):
            raise Error(_explain_empty_layer(design, path, is_chosen), where="layer", code="nothing-to-paint")
    elements = tuple(element for element in design.elements if is_chosen(element.layer))
    notices = tuple(notice for notice in design.notices if notice.layer is None or is_chosen(notice.layer))
    return replace(design, elements=elements, notices=notices)


def _find_layer(name: str, paths: list[str]) -> str:
    """Return the layer that a name refers to.

    The exact name comes first, then the only layer that ends with it, then both without regard to case and
    underscores.
    """

    def plain(text: str) -> str:
        return text.casefold().replace("_", " ")

    if any(path.startswith(name + "/") for path in paths):  # "Ink", if only "Ink/Fine" exists
        return name
    for matches in (
        lambda path: path == name,
        lambda path: path.endswith("/" + name),
        lambda path: plain(path) == plain(name),
        lambda path: plain(path).endswith("/" + plain(name)),
    ):
        matching = [path for path in paths if matches(path)]
        if len(matching) == 1:
            return matching[0]
        if matching:
            listed = ", ".join(map(repr, matching[:_MAX_NAMED_LAYERS]))
            sentence = f"{name!r} names {len(matching)} layers: {listed}; write the whole name"
            raise Error(sentence, where="layer", code="layer-ambiguous")
    available = list_first(paths, _MAX_NAMED_LAYERS)
    sentence = f"there is no layer {name!r}; there are: {available or 'none'}"
    raise Error(sentence, where="layer", code="layer-unknown")


def _explain_empty_layer(design: Design, path: str, is_chosen) -> str:
    if why := design.layers.get(path):
        return f"layer {path!r} cannot be painted: {why}"
    of_layers = [notice for notice in design.notices if is_chosen(notice.layer, [path])]
    sentence = f"layer {path!r} has nothing to paint"
    if of_layers:
        first = next((notice for notice in of_layers if notice.damaged), of_layers[0])
        sentence += f": {first.where}: {first.sentence}"
    return sentence


def _report_shapes_without_width(elements: tuple[Element, ...]) -> list[Notice]:
    names = [element.id or "filled" for element in elements if not element.is_stroked]
    if not names:
        return []
    named = ", ".join(names[:_MAX_NAMED_SHAPES]) + " ..." * (len(names) > _MAX_NAMED_SHAPES)
    sentence = f"--width has no effect on filled shapes, which keep their outline: {named}"
    return [Notice("", sentence, code="width-without-effect", about="width")]


def _report_joining_dashes(elements: tuple[Element, ...]) -> list[Notice]:
    """Return notices on dashed lines that are painted without gaps.

    Each dash is painted half a width beyond its ends. Only the final widths and sizes show whether dashes join.
    """
    return [
        Notice(
            element.id,
            f"the gaps of its dashes, {element.dash_gap_mm:.3g} mm, are not wider than the line, "
            f"{element.stroke_width_mm:.3g} mm: the dashes join on paper",
            layer=element.layer,
            code="dashes-join",
            advice="draw wider gaps, or a narrower line",
        )
        for element in elements
        if len(element.subpaths) > 1 and 0 < element.dash_gap_mm <= element.stroke_width_mm
    ]


def _set_width(element: Element, width_mm: float) -> Element:
    if not element.is_stroked:
        return element
    plain = tuple(replace(subpath, widths=None) for subpath in element.subpaths)
    settings = {name: value for name, value in element.settings.items() if name != "width_mm"}
    return replace(element, stroke_width_mm=width_mm, subpaths=plain, settings=settings)


def scale_and_move(element: Element, scale: float, shift: np.ndarray, width_scale: float) -> Element:
    """Return the element scaled about the origin and then moved by a shift [mm], with scaled widths."""
    return replace(
        element,
        stroke_width_mm=element.stroke_width_mm * width_scale,
        dash_gap_mm=element.dash_gap_mm * scale,
        settings={
            name: value * width_scale if name == "width_mm" else value for name, value in element.settings.items()
        },
        subpaths=tuple(
            replace(
                subpath,
                cubics=subpath.cubics * scale + shift,
                widths=None if subpath.widths is None else subpath.widths * (1.0, width_scale),
            )
            for subpath in element.subpaths
        ),
    )
