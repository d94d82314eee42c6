"""Write strokes as an SVG that Inkscape can edit: single lines with a width.

A varying width becomes a PowerStroke: the line in inkscape:original-d, its half widths in the offset points of a path
effect. For programs that do not know this effect, d holds the outline of the line with its widths.
"""

from __future__ import annotations

import re
from html import escape
from itertools import groupby

import numpy as np

from .. import _core
from ..geometry.arc_length import knots, parameters_at
from ..read.svg.paths.power_stroke import johan
from .svg_text import printable, quoted

WIDTH_TOLERANCE = 0.02  # of the width: a width that varies less is written as constant
_OUTLINE_TOLERANCE_MM = 0.01
_SAMPLES_PER_SEGMENT = 8  # places at which the widths between offset points are compared
_MIN_NODE_DISTANCE = 0.02  # of a cubic: a width nearer to a node is replaced by the node's
_INTERPOLATOR_BETA = 0.1  # nearly linear between widths
_SETTINGS = {
    "brush": "brush",
    "end": "end",
    "order": "order",
    "passes": "passes",
    "reload": "reload",
    "speed_mm_s": "speed",
    "start": "start",
}


def lines_svg(
    strokes: list, sheet_mm: tuple[float, float], title: str = "", job_settings: dict[str, str | float] | None = None
) -> str:
    """Write one path per stroke, in millimetres of the sheet with y down, in layers.

    A stroke that is painted in several passes is written once. When the SVG is read, it gives the same strokes, with
    widths within WIDTH_TOLERANCE. data-stroke is the name of a stroke; data-outline marks strokes that come from the
    outline of a shape. job_settings: those of the drawing, as read.settings_in returns them.
    """
    width, height = sheet_mm
    first_passes = [stroke for stroke in strokes if stroke.origin.repeat == 1]
    names = _unique_ids(first_passes)
    said = {name: f"{value:.9g}mm" if name == "tolerance" else value for name, value in (job_settings or {}).items()}
    attributes = "".join(f" data-brushsvg-{name}={quoted(value)}" for name, value in said.items())
    drawn = [_effect_and_path(stroke, name, height) for stroke, name in zip(first_passes, names, strict=True)]
    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"',
        f' width="{width:.9g}mm" height="{height:.9g}mm" viewBox="0 0 {width:.9g} {height:.9g}"{attributes}>',
        f"<title>{escape(printable(title), quote=False)}</title>",
        "<defs>",
        *(effect for effect, _ in drawn if effect),
        "</defs>",
    ]
    for layer, pairs in groupby(zip(first_passes, drawn, strict=True), key=lambda pair: pair[0].layer):
        paths = [path for _, (_, path) in pairs]
        if layer:
            lines += [f'<g inkscape:groupmode="layer" inkscape:label={quoted(layer)}>', *paths, "</g>"]
        else:
            lines += paths
    return "\n".join([*lines, "</svg>", ""])


def _unique_ids(strokes: list) -> list[str]:
    """Return unique ids for the paths, with only the characters that an id may have."""
    names: list[str] = []
    taken: set[str] = set()
    for stroke in strokes:
        name = nominal = re.sub(r"[^\w.-]", "-", stroke.id)
        number = 1
        while name in taken:
            number += 1
            name = f"{nominal}-{number}"
        names.append(name)
        taken.add(name)
    return names


def _effect_and_path(stroke, name: str, height_mm: float) -> tuple[str, str]:
    """Return the path effect of a stroke, "" if it needs none, and its path element."""
    half_widths = np.array([half for _, half in stroke.half_width])
    line = _line_path(stroke, height_mm)
    outline_attribute = ' data-outline="yes"' * bool(stroke.target_mm)
    path_start = f'<path id="{name}" data-stroke={quoted(stroke.id)}{outline_attribute}{_setting_attributes(stroke)}'
    if np.ptp(half_widths) <= WIDTH_TOLERANCE * half_widths.max():
        style = (
            f"fill:none;stroke:{stroke.colour};stroke-width:{half_widths.min() + half_widths.max():.6g};"
            "stroke-linecap:round;stroke-linejoin:round;stroke-dasharray:none"
        )
        return "", f'{path_start} d="{line}" style="{style}"/>'
    points = " | ".join(f"{place:.6g},{half:.6g}" for place, half in offset_points(stroke).tolist())
    effect = (
        f'<inkscape:path-effect effect="powerstroke" id="width-{name}" is_visible="true" lpeversion="1.3" '
        f'scale_width="1" offset_points="{points}" not_jump="true" sort_points="true" '
        f'interpolator_type="CubicBezierJohan" interpolator_beta="{_INTERPOLATOR_BETA:g}" start_linecap_type="round" '
        'linejoin_type="round" miter_limit="4" end_linecap_type="round"/>'
    )
    style = f"fill:{stroke.colour};fill-rule:nonzero;stroke:none"
    return effect, (
        f'{path_start} inkscape:path-effect="#width-{name}" inkscape:original-d="{line}" '
        f'd="{_outline_path(stroke, height_mm)}" style="{style}"/>'
    )


def offset_points(stroke) -> np.ndarray:
    """Return the offset points of a PowerStroke, (k, 2): place and half width [mm].

    There is one point at each node, and as few others as keep the widths within half of WIDTH_TOLERANCE. A place is
    the number of a cubic plus the parameter in it, whereas the widths of a stroke are given by its length.

    Without points at the nodes, and with Linear interpolation of the widths, Inkscape 1.2 fails to draw one stroke in
    twenty ("An exception occurred during execution of the Path Effect") and shows its line, filled. Its geometry
    library then finds one crossing of a node twice, a rounding error apart.
    """
    cubics = stroke.middle_mm.reshape(-1, 4, 2)
    at, half = np.array(stroke.half_width).T
    lengths_table = knots(cubics)
    start_lengths = np.cumsum([0.0, *lengths_table[:, -1]])
    total = start_lengths[-1]
    number, t = parameters_at(cubics, lengths_table, np.clip(at, 0.0, 1.0) * total)
    points = np.column_stack([np.round(number + t, 6), half])
    points = points[np.abs(points[:, 0] - np.round(points[:, 0])) > _MIN_NODE_DISTANCE]
    points = points[np.unique(points[:, 0], return_index=True)[1]]
    at_nodes = np.column_stack([np.arange(len(start_lengths)), np.interp(start_lengths / total, at, half)])
    points = np.vstack([points, at_nodes])
    table = np.linspace(0.0, 1.0, lengths_table.shape[1])
    inner = np.linspace(0.0, 1.0, _SAMPLES_PER_SEGMENT + 1)[:-1]
    places = np.append((np.arange(len(cubics))[:, None] + inner).ravel(), len(cubics))
    lengths = [start_lengths[k] + np.interp(inner, table, lengths_table[k]) for k in range(len(cubics))]
    target = np.interp(np.append(np.concatenate(lengths), total) / total, at, half)
    for _ in range(len(places)):
        points = points[np.argsort(points[:, 0], kind="stable")]
        errors = np.abs(johan(points, places, _INTERPOLATOR_BETA) - target)
        if errors.max() <= WIDTH_TOLERANCE / 2 * half.max():
            break
        points = np.vstack([points, [places[errors.argmax()], target[errors.argmax()]]])
    return points


def _line_path(stroke, height_mm: float) -> str:
    cubics = stroke.middle_mm.reshape(-1, 4, 2) * (1.0, -1.0) + (0.0, height_mm)
    rows = ["C" + " ".join(f"{value:.6g}" for value in cubic[1:].ravel() + 0.0) for cubic in cubics]
    first = " ".join(f"{value:.6g}" for value in cubics[0, 0] + 0.0)
    if len(cubics) == 1 and np.ptp(cubics[0], axis=0).max() == 0:
        return f"M{first}h0"
    return f"M{first}" + "".join(rows) + "Z" * stroke.closed


def _outline_path(stroke, height_mm: float) -> str:
    parts = []
    for ring in _core.target_outline(stroke.replaced(target_mm=[]), _OUTLINE_TOLERANCE_MM):
        points = np.round(np.column_stack([ring[:, 0], height_mm - ring[:, 1]]), 3) + 0.0
        parts.append(("M" + "L".join(["%.6g,%.6g"] * len(points)) + "Z") % tuple(points.ravel().tolist()))
    return "".join(parts)


def _setting_attributes(stroke) -> str:
    named = {name: getattr(stroke.settings, key) for key, name in _SETTINGS.items()}
    words = {True: "yes", False: "no"}
    return "".join(
        f" data-brushsvg-{name}={quoted(words[value] if isinstance(value, bool) else f'{value}')}"
        for name, value in named.items()
        if value is not None
    )
