"""Number the strokes of a picture: group strokes for its list, and find the cells that numbers must not cover."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from ..geometry.polylines import lengths

MIN_STROKES_IN_RUN = 6  # smallest number of similar strokes that become one entry
LABEL_CELL_PX = 8.0  # half the height of a number


@dataclass(frozen=True)
class Run:
    """Strokes first to last that are one entry of the list.

    is_one_element: they are sub-paths or dashes of one element.
    """

    first: int
    last: int
    is_one_element: bool = False


def group_runs(strokes: list) -> list[Run]:
    """Group consecutive similar strokes into entries of the list.

    The strokes have the same width and layer. The strokes of a group are sub-paths of one element, or elements with
    consecutive numbers. Fewer than MIN_STROKES_IN_RUN strokes stay separate entries.
    """
    runs: list[Run] = []
    keys = []
    for stroke in strokes:
        keys.append((*_series_key(stroke.origin), width_text(stroke), stroke.layer))
    first = 0
    for k, key in enumerate(keys):
        kind, number, *alike = key
        follows = k + 1 < len(keys) and keys[k + 1] == (kind, number + 1, *alike) and number >= 0
        if not follows:
            if k - first + 1 < MIN_STROKES_IN_RUN:
                runs += [Run(single, single) for single in range(first, k + 1)]
            else:
                runs.append(Run(first, k, strokes[k].origin.part > 0))
            first = k + 1
    return runs


def _series_key(origin) -> tuple[tuple, int]:
    """Return the key that the strokes of one entry share.

    Returns also the running number of the stroke, -1 for none.
    """
    others = (origin.repeat, origin.lane)
    if origin.part:
        return (origin.element, True, *others), origin.part
    stem, number = re.fullmatch("(.*?)([0-9]*)", origin.element, re.DOTALL).groups()
    return (stem, False, *others), int(number[-18:] or -1)


def width_text(stroke) -> str:
    """Return the width of a stroke [mm] in words, or its smallest and largest width."""
    widths = sorted(2 * knot[1] for knot in stroke.half_width)
    return f"{widths[0]:.3g}" + (f" to {widths[-1]:.3g}" if widths[-1] > widths[0] else "")


def start_direction(line: np.ndarray) -> np.ndarray:
    """Return the direction in which a line starts, as a unit vector."""
    distances = np.hypot(*(line - line[0]).T)
    ahead = line[int(np.argmax(distances >= 6.0))] if (distances >= 6.0).any() else line[-1]
    length = math.dist(ahead, line[0])
    return (ahead - line[0]) / length if length > 0 else np.array([1.0, 0.0])


def mark_cells(lines: list[np.ndarray], size: tuple[float, float]) -> np.ndarray:
    """Return the mask (rows, columns) of the cells that lines go through.

    Cells have sides of LABEL_CELL_PX. size: width and height of the picture [px].
    """
    cells = np.zeros((math.ceil(size[1] / LABEL_CELL_PX), math.ceil(size[0] / LABEL_CELL_PX)), bool)
    for line in lines:
        at = lengths(line)
        dense = np.linspace(0.0, at[-1], math.ceil(2 * at[-1] / LABEL_CELL_PX) + 1)
        points = np.column_stack([np.interp(dense, at, line[:, k]) for k in (0, 1)])
        x, y = (points // LABEL_CELL_PX).astype(int).clip(0, (cells.shape[1] - 1, cells.shape[0] - 1)).T
        cells[y, x] = True
    return cells
