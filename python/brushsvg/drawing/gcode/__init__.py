"""A plotter's G-code to Design: where its pen is down, it drew a line. How it is read: docs/machines.md."""

from __future__ import annotations

import re

import numpy as np

from ...errors import Error
from .. import AS_DRAWN, ReadOptions
from ..design import Design, Element, Notice, SubPath
from ..empty_drawing import nothing_to_paint
from .toolpaths import pen_is_down, ways

MARGIN_MM = 20.0
WIDTH_MM = 1.0


def read_gcode(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """Its lines in the order drawn, in mm; the sheet is what is drawn and 20 mm around it, or the one given, at
    its zero.

    Error for a program of brushsvg's own, whose ways lead the brush and are no drawing, and for lines not read.
    """
    text = data.decode("utf-8", errors="replace")
    if is_ours(text):
        raise Error(
            "brushsvg wrote this program: its ways lead a brush and are no drawing; convert the drawing",
            code="program-ours",
        )
    some = ways(text)
    chains: list[list] = []
    is_drawn = False
    for way, is_down in zip(some, pen_is_down(some) if some else [], strict=True):
        was_drawn, is_drawn = is_drawn, is_down and bool(np.isfinite(way.points_mm[:, :2]).all())
        if is_drawn and not was_drawn:
            chains.append([])
        if is_drawn:  # the way to the first place begins where nobody knows
            chains[-1].append(way)
    elements = [_element(chain) for chain in chains]
    if not elements:
        raise nothing_to_paint([])
    ends = np.concatenate([sub.cubics[:, ::3].reshape(-1, 2) for each in elements for sub in each.subpaths])
    sentence = f"a program has no widths: its lines count as {WIDTH_MM:g} mm wide where --width tells none"
    notices = [Notice("", sentence, code="gcode-no-width")]
    down = np.concatenate([way.points_mm[:, 2] for chain in chains for way in chain])
    if np.isfinite(down).all() and np.ptp(down) > 1e-3:
        sentence = f"its pen goes at heights from {down.min():.6g} to {down.max():.6g} mm: they are left out"
        notices.append(Notice("z", sentence, code="gcode-not-flat"))
    if options.sheet_mm:
        return Design(options.sheet_mm, tuple(elements), tuple(notices))
    shift = MARGIN_MM - ends.min(axis=0)
    width, height = (ends.max(axis=0) + shift + MARGIN_MM).tolist()
    return Design((width, height), tuple(_moved(each, shift) for each in elements), tuple(notices))


def is_ours(text: str) -> bool:
    """Whether its header, or the remark above a stroke, says that brushsvg wrote it."""
    head = text[:4000]
    return any(f"({word}: " in head or f"; {word}: " in head for word in ("brush", "cell", "sheet")) or bool(
        re.search(r"(?m)^(?:\(|; ?)stroke \d+ of \d+: ", text)
    )


def _element(chain: list) -> Element:
    points = [chain[0].points_mm[:1, :2], *(way.points_mm[1:, :2] for way in chain)]
    path = np.concatenate(points)
    path = path[np.r_[True, np.diff(path, axis=0).any(axis=1)]]
    if len(path) == 1:
        path = np.repeat(path, 2, axis=0)
    a, b = path[:-1], path[1:]
    cubics = np.stack([a, a + (b - a) / 3, a + (b - a) * 2 / 3, b], axis=1)
    return Element(f"line{chain[0].line}", (SubPath(cubics),), WIDTH_MM)


def _moved(element: Element, shift: np.ndarray) -> Element:
    (line,) = element.subpaths
    return Element(element.id, (SubPath(line.cubics + shift),), element.stroke_width_mm)
