"""Place a drawing on the sheet and choose which of its layers are painted: Design to Design."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..errors import Error
from ..geometry.cubics import extremes
from .design import Design, Element, SubPath


@dataclass(frozen=True)
class Layout:
    """Options for a drawing as a whole; None or empty: as drawn.

    layers: names of those to paint, with all they hold; width_mm: of every stroke, in place of the drawing's widths;
    fit_mm (w, h): the target marks fill this size as far as their shape allows, in the middle of the sheet;
    scale: instead, a factor, about the middle of the marks; origin_mm (x, y): where the lower left corner of the
    marks is, instead of the middle of the sheet or where it was.
    """

    layers: tuple[str, ...] = ()
    width_mm: float | None = None
    fit_mm: tuple[float, float] | None = None
    scale: float | None = None
    origin_mm: tuple[float, float] | None = None


AS_DRAWN = Layout()
OF_WIDTHS = ("gcode-no-width", "stretched-unevenly")  # notices on widths that are no longer used
_NAMED = 20  # layers in a sentence


def arrange(design: Design, layout: Layout) -> Design:
    """The drawing with its layers chosen, its widths set and its place found; widths are scaled with the drawing,
    but for layout.width_mm. The sheet stays.

    Error for a layer that is not there or has nothing to paint, or marks that cannot be fitted.
    """
    if layout.layers:
        design = _of_layers(design, layout.layers)
    if layout.width_mm is not None:
        elements = tuple(_with_width(e, layout.width_mm) for e in design.elements)
        notices = tuple(notice for notice in design.notices if notice.code not in OF_WIDTHS)
        design = replace(design, elements=elements, notices=notices)
    if layout.fit_mm is None and layout.scale is None and layout.origin_mm is None:
        return design
    keeps_width = layout.width_mm is not None
    lines, marks = bounds_mm(design, with_widths=False), bounds_mm(design)
    scale = layout.scale or 1.0
    if layout.fit_mm is not None:
        scale = _fitting_scale(lines, marks, layout.fit_mm, keeps_width)
    margin = (marks - lines) * (1.0 if keeps_width else scale)
    scaled = lines * scale + margin  # the marks' bounds, apart from their place
    if layout.origin_mm is not None:
        shift = np.array(layout.origin_mm) - scaled[:2]
    elif layout.fit_mm is not None:
        shift = np.array(design.sheet_mm) / 2 - (scaled[:2] + scaled[2:]) / 2
    else:
        shift = (marks[:2] + marks[2:]) / 2 - (scaled[:2] + scaled[2:]) / 2
    width_scale = 1.0 if keeps_width else scale
    return replace(design, elements=tuple(_moved(e, scale, shift, width_scale) for e in design.elements))


def bounds_mm(design: Design, with_widths: bool = True) -> np.ndarray:
    """Return the bounds of the target marks, or of their middle lines and outlines alone: x0, y0, x1, y1 [mm]."""
    box = np.array([math.inf, math.inf, -math.inf, -math.inf])
    for element in design.elements:
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


def _fitting_scale(
    lines: np.ndarray, marks: np.ndarray, fit_mm: tuple[float, float], keeps_width: bool
) -> float:
    """The largest scale at which marks are not larger than fit_mm."""
    size, margin = lines[2:] - lines[:2], (marks[2:] - marks[:2]) - (lines[2:] - lines[:2])
    room = np.array(fit_mm) - (margin if keeps_width else 0.0)
    growing = size if keeps_width else size + margin
    if (room <= 0).any():
        raise Error(
            f"strokes {margin.max():.4g} mm wide do not fit {fit_mm[0]:g} x {fit_mm[1]:g} mm",
            where="fit",
            code="drawing-does-not-fit",
        )
    with np.errstate(divide="ignore"):
        scale = float((room / growing).min())
    if not math.isfinite(scale):
        raise Error("marks without a size cannot be fitted", where="fit", code="drawing-does-not-fit")
    return scale


def _of_layers(design: Design, names: tuple[str, ...]) -> Design:
    painted = [element.layer for element in design.elements if element.layer]
    noticed = [notice.layer for notice in design.notices if notice.layer]
    paths = list(dict.fromkeys([*painted, *filter(None, design.layers), *noticed]))
    requested = [_layer(name, paths) for name in names]

    def chosen(layer: str | None, among: list[str] = requested) -> bool:
        return any(layer == path or (layer or "").startswith(path + "/") for path in among)

    for path in requested:
        if not any(chosen(element.layer, [path]) for element in design.elements):
            raise Error(_why_nothing(design, path, chosen), where="layer", code="nothing-to-paint")
    elements = tuple(element for element in design.elements if chosen(element.layer))
    notices = tuple(notice for notice in design.notices if notice.layer is None or chosen(notice.layer))
    return replace(design, elements=elements, notices=notices)


def _layer(name: str, paths: list[str]) -> str:
    """Return the layer that a name means: as written, or the only one that ends so, ignoring case and underscores."""

    def plain(text: str) -> str:
        return text.casefold().replace("_", " ")

    if any(path.startswith(name + "/") for path in paths):  # "Ink" where there is "Ink/Fine" alone
        return name
    for matches in (
        lambda path: path == name,
        lambda path: path.endswith("/" + name),
        lambda path: plain(path) == plain(name),
        lambda path: plain(path).endswith("/" + plain(name)),
    ):
        found = [path for path in paths if matches(path)]
        if len(found) == 1:
            return found[0]
        if found:
            listed = ", ".join(map(repr, found[:_NAMED]))
            raise Error(
                f"{name!r} names {len(found)} layers: {listed}; write the whole name",
                where="layer",
                code="layer-ambiguous",
            )
    there = ", ".join(paths[:_NAMED]) + (f" and {len(paths) - _NAMED} more" if len(paths) > _NAMED else "")
    raise Error(
        f"there is no layer {name!r}; there are: {there or 'none'}", where="layer", code="layer-unknown"
    )


def _why_nothing(design: Design, path: str, chosen) -> str:
    if why := design.layers.get(path):
        return f"layer {path!r} cannot be painted: {why}"
    of_layers = [notice for notice in design.notices if chosen(notice.layer, [path])]
    sentence = f"layer {path!r} has nothing to paint"
    if of_layers:
        first = next((notice for notice in of_layers if notice.damaged), of_layers[0])
        sentence += f": {first.where}: {first.sentence}"
    return sentence


def _with_width(element: Element, width_mm: float) -> Element:
    if not element.is_stroked:
        return element
    plain = tuple(replace(subpath, widths=None) for subpath in element.subpaths)
    settings = {name: value for name, value in element.settings.items() if name != "width_mm"}
    return replace(element, stroke_width_mm=width_mm, subpaths=plain, settings=settings)


def _moved(element: Element, scale: float, shift: np.ndarray, width_scale: float) -> Element:
    return replace(
        element,
        stroke_width_mm=element.stroke_width_mm * width_scale,
        settings={
            name: value * width_scale if name == "width_mm" else value
            for name, value in element.settings.items()
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
