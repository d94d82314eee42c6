"""Strokes -> SVG to go on drawing with: single lines with a width, which Inkscape can edit.

A width that varies is a PowerStroke: the line in inkscape:original-d, its half widths in the offset points of a path
effect, and in d, for programs that do not know it, the outline of both.
"""

from __future__ import annotations

import re
from html import escape
from itertools import groupby

import numpy as np

from .. import _core
from ..geometry.arc_length import knots, parameters_at
from ..read.svg.paths.power_stroke import johan

EVEN = 0.02  # of the width: what varies less is one width
_OUTLINE_MM = 0.01
_PER_SEGMENT = 8  # places at which the widths between offset points are looked at
_AT_NODE = 0.02  # of a cubic: a width as near to a node as this is the node's
_BETA = 0.1  # nearly straight between widths
_SETTINGS = {
    "brush": "brush",
    "end": "end",
    "order": "order",
    "passes": "passes",
    "reload": "reload",
    "speed_mm_s": "speed",
    "start": "start",
}


def lines_svg(strokes: list, sheet_mm: tuple[float, float], title: str = "") -> str:
    """One path per stroke in millimetres of the sheet, y down, in layers; what is painted in several passes once.

    Read again these are the strokes, widths within EVEN of them. data-stroke: what a stroke is called; data-outline:
    that it was found in the outline of a shape.
    """
    width, height = sheet_mm
    once = [stroke for stroke in strokes if stroke.origin.repeat == 1]
    names = _names(once)
    drawn = [_drawn(stroke, name, height) for stroke, name in zip(once, names, strict=True)]
    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"',
        f' width="{width:.9g}mm" height="{height:.9g}mm" viewBox="0 0 {width:.9g} {height:.9g}">',
        f"<title>{escape(_printable(title), quote=False)}</title>",
        "<defs>",
        *(effect for effect, _ in drawn if effect),
        "</defs>",
    ]
    for layer, pairs in groupby(zip(once, drawn, strict=True), key=lambda pair: pair[0].layer):
        paths = [path for _, (_, path) in pairs]
        if layer:
            lines += [f'<g inkscape:groupmode="layer" inkscape:label={_quoted(layer)}>', *paths, "</g>"]
        else:
            lines += paths
    return "\n".join([*lines, "</svg>", ""])


def _names(strokes: list) -> list[str]:
    """Ids of the paths, of letters that an id may have, no two alike."""
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


def _drawn(stroke, name: str, height_mm: float) -> tuple[str, str]:
    """The path effect, "" if it needs none, and the path."""
    halves = np.array([half for _, half in stroke.half_width])
    line = _line(stroke, height_mm)
    found = ' data-outline="yes"' * bool(stroke.wanted_mm)
    said = f'<path id="{name}" data-stroke={_quoted(stroke.id)}{found}{_settings(stroke)}'
    if np.ptp(halves) <= EVEN * halves.max():
        style = (
            f"fill:none;stroke:{stroke.colour};stroke-width:{halves.min() + halves.max():.6g};"
            "stroke-linecap:round;stroke-linejoin:round;stroke-dasharray:none"
        )
        return "", f'{said} d="{line}" style="{style}"/>'
    points = " | ".join(f"{place:.6g},{half:.6g}" for place, half in offset_points(stroke).tolist())
    effect = (
        f'<inkscape:path-effect effect="powerstroke" id="width-{name}" is_visible="true" lpeversion="1.3" '
        f'scale_width="1" offset_points="{points}" not_jump="true" sort_points="true" '
        f'interpolator_type="CubicBezierJohan" interpolator_beta="{_BETA:g}" start_linecap_type="round" '
        'linejoin_type="round" miter_limit="4" end_linecap_type="round"/>'
    )
    style = f"fill:{stroke.colour};fill-rule:nonzero;stroke:none"
    return effect, (
        f'{said} inkscape:path-effect="#width-{name}" inkscape:original-d="{line}" '
        f'd="{_outline(stroke, height_mm)}" style="{style}"/>'
    )


def offset_points(stroke) -> np.ndarray:
    """Place and half width [mm], (k, 2), as few as keep the widths within half of EVEN of the stroke's, and one at
    each node. A place counts cubics, and is the parameter in them, where the stroke counts its length.

    Without those at the nodes, and with widths that are interpolated Linear, Inkscape 1.2 fails to draw one stroke of
    twenty ("An exception occurred during execution of the Path Effect") and shows its line, filled: there its geometry
    library finds one crossing of a node twice, a rounding apart.
    """
    cubics = stroke.middle_mm.reshape(-1, 4, 2)
    at, half = np.array(stroke.half_width).T
    known = knots(cubics)
    before = np.cumsum([0.0, *known[:, -1]])
    total = before[-1]
    number, t = parameters_at(cubics, known, np.clip(at, 0.0, 1.0) * total)
    points = np.column_stack([np.round(number + t, 6), half])
    points = points[np.abs(points[:, 0] - np.round(points[:, 0])) > _AT_NODE]
    points = points[np.unique(points[:, 0], return_index=True)[1]]
    at_nodes = np.column_stack([np.arange(len(before)), np.interp(before / total, at, half)])
    points = np.vstack([points, at_nodes])
    table = np.linspace(0.0, 1.0, known.shape[1])
    inner = np.linspace(0.0, 1.0, _PER_SEGMENT + 1)[:-1]
    places = np.append((np.arange(len(cubics))[:, None] + inner).ravel(), len(cubics))
    lengths = [before[k] + np.interp(inner, table, known[k]) for k in range(len(cubics))]
    target = np.interp(np.append(np.concatenate(lengths), total) / total, at, half)
    for _ in range(len(places)):
        points = points[np.argsort(points[:, 0], kind="stable")]
        off = np.abs(johan(points, places, _BETA) - target)
        if off.max() <= EVEN / 2 * half.max():
            break
        points = np.vstack([points, [places[off.argmax()], target[off.argmax()]]])
    return points


def _line(stroke, height_mm: float) -> str:
    cubics = stroke.middle_mm.reshape(-1, 4, 2) * (1.0, -1.0) + (0.0, height_mm)
    rows = ["C" + " ".join(f"{value:.6g}" for value in cubic[1:].ravel() + 0.0) for cubic in cubics]
    first = " ".join(f"{value:.6g}" for value in cubics[0, 0] + 0.0)
    if len(cubics) == 1 and np.ptp(cubics[0], axis=0).max() == 0:
        return f"M{first}h0"
    return f"M{first}" + "".join(rows) + "Z" * stroke.closed


def _outline(stroke, height_mm: float) -> str:
    parts = []
    for ring in _core.wanted_outline(stroke.replaced(wanted_mm=[]), _OUTLINE_MM):
        points = np.round(np.column_stack([ring[:, 0], height_mm - ring[:, 1]]), 3) + 0.0
        parts.append(("M" + "L".join(["%.6g,%.6g"] * len(points)) + "Z") % tuple(points.ravel().tolist()))
    return "".join(parts)


def _settings(stroke) -> str:
    named = {name: getattr(stroke.settings, key) for key, name in _SETTINGS.items()}
    words = {True: "yes", False: "no"}
    return "".join(
        f" data-brushsvg-{name}={_quoted(words[value] if isinstance(value, bool) else f'{value}')}"
        for name, value in named.items()
        if value is not None
    )


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text)


def _quoted(text: str) -> str:
    return f'"{escape(_printable(text))}"'
