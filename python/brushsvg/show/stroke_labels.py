"""Numbers for the strokes of a picture: which of them are one entry of its list, and where there is room for them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from ..geometry.polylines import lengths

FOLDED = 6  # strokes alike from which on they are one entry
CELL_PX = 8.0  # grid of the room for numbers: half their height


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


class Room:
    """Where numbers still fit between lines and other numbers, on a grid of CELL_PX."""

    def __init__(self, lines: list[np.ndarray]):
        self.lines: set[tuple[int, int]] = set()
        self.numbers: set[tuple[int, int]] = set()
        for line in lines:
            at = lengths(line)
            dense = np.linspace(0.0, at[-1], math.ceil(2 * at[-1] / CELL_PX) + 1)
            points = np.column_stack([np.interp(dense, at, line[:, k]) for k in (0, 1)])
            self.lines.update(map(tuple, (points // CELL_PX).astype(int).tolist()))

    def take(self, start: np.ndarray, ahead: np.ndarray, w: float, h: float) -> tuple[float, float] | None:
        """Upper left corner of w x h px near a start, behind it first; None where numbers would pile up."""
        found = None
        for reach in (1.0, 1.7):
            for turn in (0.0, 0.6, -0.6, 1.2, -1.2, 1.9, -1.9):
                cos, sin = math.cos(turn), math.sin(turn)
                away = -np.array([cos * ahead[0] - sin * ahead[1], sin * ahead[0] + cos * ahead[1]])
                x, y = start + away * (np.array([w, h]) / 2 + 7.0) * reach - np.array([w, h]) / 2
                columns = range(int(x // CELL_PX), int((x + w) // CELL_PX) + 1)
                cells = {
                    (c, r) for c in columns for r in range(int(y // CELL_PX), int((y + h) // CELL_PX) + 1)
                }
                if not self.numbers.isdisjoint(cells):
                    continue
                crossed = len(self.lines & cells)
                if found is None or crossed < found[0]:
                    found = crossed, cells, (x, y)
            if found and found[0] == 0:
                break
        if found is None:
            return None
        self.numbers |= found[1]
        return found[2]
