"""Join pressure strokes of a tablet pen.

Some programs export a pressure stroke as many short lines, each with its own width.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from ..geometry.arc_length import knots
from .design import Design, Element, Notice, SubPath

MAX_GAP_SHARE = 0.1  # share of a line's width: ends that are closer are the same point, rounded differently
MIN_PIECES = 3  # two lines that meet at a corner with two widths may be drawn on purpose
MAX_WIDTH_RATIO = 2.0  # largest ratio of the widths of neighbouring pieces; pressure changes less between two samples


def join_pressure_strokes(design: Design) -> Design:
    """Join each run of short lines to one line of varying width.

    The lines of a run meet end to end, have the same colour and different widths. Xournal++, Tuhi and fabric.js
    write pressure strokes in this form. A notice reports how many lines were joined.
    """
    elements: list[Element] = []
    strokes = pieces = 0
    for run in _group_into_runs(design.elements):
        widths = {element.stroke_width_mm for element in run}
        if len(run) < MIN_PIECES or len(widths) == 1:
            elements += run
            continue
        elements.append(_join_run(run))
        strokes += 1
        pieces += len(run)
    if not strokes:
        return design
    sentence = (
        f"{pieces} lines that meet end to end, each with its own width, are read as {strokes} "
        f"{'stroke' if strokes == 1 else 'strokes'} of varying width"
    )
    notice = Notice("drawing", sentence, code="pressure-strokes")
    return replace(design, elements=tuple(elements), notices=(*design.notices, notice))


def _group_into_runs(elements: tuple[Element, ...]) -> list[list[Element]]:
    runs: list[list[Element]] = []
    for element in elements:
        if runs and _continues(runs[-1][-1], element):
            runs[-1].append(element)
        else:
            runs.append([element])
    return runs


def _is_joinable(element: Element) -> bool:
    paths = element.subpaths
    is_line = not element.fill_rule and element.stroke_width_mm > 0
    return is_line and len(paths) == 1 and not paths[0].closed and paths[0].widths is None


def _continues(before: Element, after: Element) -> bool:
    if not (_is_joinable(before) and _is_joinable(after)):
        return False
    if (before.colour, before.layer, before.settings) != (after.colour, after.layer, after.settings):
        return False
    thin, wide = sorted((before.stroke_width_mm, after.stroke_width_mm))
    gap = after.subpaths[0].cubics[0, 0] - before.subpaths[0].cubics[-1, 3]
    return bool(wide <= MAX_WIDTH_RATIO * thin and np.hypot(*gap) <= MAX_GAP_SHARE * thin)


def _join_run(run: list[Element]) -> Element:
    """Return a run of pieces as one line of varying width.

    The line has the width of each piece in the middle of this piece, and linear changes in between.
    """
    cubics = [element.subpaths[0].cubics.copy() for element in run]
    for before, after in pairwise(cubics):
        after[0, 0] = before[-1, 3]
    lengths = np.array([float(knots(piece)[:, -1].sum()) for piece in cubics])
    ends = np.cumsum(lengths)
    at = (ends - lengths / 2) / max(ends[-1], 1e-12)
    widths = np.array([element.stroke_width_mm for element in run])
    rows = np.column_stack([np.r_[0.0, at, 1.0], np.r_[widths[0], widths, widths[-1]]])
    line = SubPath(np.concatenate(cubics), widths=rows)
    return replace(run[0], subpaths=(line,), stroke_width_mm=float(widths.max()))
