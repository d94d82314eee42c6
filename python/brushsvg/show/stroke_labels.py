"""Numbers for the strokes of a picture: which of them are one entry of its list, and what they must not cover."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from ..geometry.polylines import lengths

FOLDED = 6  # strokes alike from which on they are one entry
CELL_PX = 8.0  # half the height of a number


@dataclass(frozen=True)
class Run:
    """Strokes first to last that are one entry of the list; is_one: sub-paths or dashes of one element."""

    first: int
    last: int
    is_one: bool = False


def runs_of(strokes: list) -> list[Run]:
    """Strokes that follow each other, alike in width and layer, are one entry if they are many: sub-paths of one
    element, or elements that are numbered on."""
    runs: list[Run] = []
    keys = []
    for stroke in strokes:
        keys.append((*_place(stroke.origin), width_text(stroke), stroke.layer))
    first = 0
    for k, key in enumerate(keys):
        kind, number, *alike = key
        follows = k + 1 < len(keys) and keys[k + 1] == (kind, number + 1, *alike) and number >= 0
        if not follows:
            if k - first + 1 < FOLDED:
                runs += [Run(each, each) for each in range(first, k + 1)]
            else:
                runs.append(Run(first, k, strokes[k].origin.part > 0))
            first = k + 1
    return runs


def _place(origin) -> tuple[tuple, int]:
    """What strokes of one entry share, and the number by which they follow each other; -1: by none."""
    others = (origin.repeat, origin.lane)
    if origin.part:
        return (origin.element, True, *others), origin.part
    stem, number = re.fullmatch("(.*?)([0-9]*)", origin.element, re.DOTALL).groups()
    return (stem, False, *others), int(number[-18:] or -1)


def width_text(stroke) -> str:
    """The width of a stroke [mm], or the least and the greatest."""
    widths = sorted(2 * knot[1] for knot in stroke.half_width)
    return f"{widths[0]:.3g}" + (f" to {widths[-1]:.3g}" if widths[-1] > widths[0] else "")


def ahead(line: np.ndarray) -> np.ndarray:
    """Direction in which a line starts, a unit vector."""
    away = np.hypot(*(line - line[0]).T)
    far = line[int(np.argmax(away >= 6.0))] if (away >= 6.0).any() else line[-1]
    length = math.dist(far, line[0])
    return (far - line[0]) / length if length > 0 else np.array([1.0, 0.0])


def cells_of(lines: list[np.ndarray], size: tuple[float, float]) -> np.ndarray:
    """Cells of CELL_PX in a picture of that width and height that lines go through."""
    cells = np.zeros((math.ceil(size[1] / CELL_PX), math.ceil(size[0] / CELL_PX)), bool)
    for line in lines:
        at = lengths(line)
        dense = np.linspace(0.0, at[-1], math.ceil(2 * at[-1] / CELL_PX) + 1)
        points = np.column_stack([np.interp(dense, at, line[:, k]) for k in (0, 1)])
        x, y = (points // CELL_PX).astype(int).clip(0, (cells.shape[1] - 1, cells.shape[0] - 1)).T
        cells[y, x] = True
    return cells
