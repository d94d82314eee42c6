"""Outlines of shapes, from lines that are drawn one by one.

CAD programs have no filled letters. Each side of a letter, and the outline of each hole in it, is a line of its own.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ..geometry.rings import is_within
from ..read.design import Element, SubPath
from .joining import MAX_GAP_MM, grid_cell
from .skeleton.fill_rule import FLATTENED_MM, flattened


def assemble_outlines(elements: Iterable[Element]) -> list[Element]:
    """Return elements, with lines joined to outlines, and outlines inside each other joined to one shape.

    Lines are joined where exactly two ends are within 0.01 mm. An outline inside another is a hole in it, and an
    outline inside the hole is a shape again. A joined element has the place and id of its first line, or of its outer
    outline. Elements with a fill stay as they are. Joined are only elements of the same layer, colour and settings.
    """
    groups: dict[tuple, list[int]] = defaultdict(list)
    kept: list[Element | None] = list(elements)
    for k, element in enumerate(kept):
        if element.subpaths and not element.fill_rule:
            groups[element.layer, element.colour, *sorted(element.settings.items())].append(k)
    for group in groups.values():
        _join_ends(kept, group)
        _join_holes(kept, [k for k in group if kept[k] is not None])
    return [element for element in kept if element is not None]


def _join_ends(kept: list[Element | None], group: list[int]) -> None:
    """Join the open lines of a group, and replace the joined ones by None."""
    lines = {k: kept[k].subpaths[0].cubics for k in group if _is_open_line(kept[k])}
    near: dict[tuple, list[tuple[int, bool]]] = defaultdict(list)
    for k, cubics in lines.items():
        for at_end in (False, True):
            near[grid_cell(_end(cubics, at_end))].append((k, at_end))
    ends = {k: [_end(cubics, at_end) for at_end in (False, True)] for k, cubics in lines.items()}

    def following(k: int, at_end: bool) -> tuple[int, bool] | None:
        place = ends[k][at_end]
        x, y = grid_cell(place)
        around = [each for dx in (-1, 0, 1) for dy in (-1, 0, 1) for each in near.get((x + dx, y + dy), ())]
        met = [(n, end) for n, end in around if (n, end) != (k, at_end) and _meet(ends[n][end], place)]
        return met[0] if len(met) == 1 else None

    for first in lines:
        if kept[first] is None:
            continue
        parts = [lines[first]]
        for forward in (True, False):
            last = (first, forward)
            while (met := following(*last)) and met[0] != first and kept[met[0]] is not None:
                k, at_end = met
                cubics = lines[k] if at_end != forward else lines[k][::-1, ::-1]
                parts = [*parts, cubics] if forward else [cubics, *parts]
                kept[k] = None
                last = (k, not at_end)
        if len(parts) > 1:
            cubics = np.concatenate(parts)
            cubics[1:, 0] = cubics[:-1, 3]
            closed = _meet(cubics[0, 0], cubics[-1, 3])
            if closed:
                cubics[-1, 3] = cubics[0, 0]
            kept[first] = replace(kept[first], subpaths=(SubPath(cubics, closed),))


def _join_holes(kept: list[Element | None], group: list[int]) -> None:
    """Add each outline inside another to it as a hole, and replace it by None."""
    rings = {k: [flattened(subpath.cubics, FLATTENED_MM) for subpath in kept[k].subpaths] for k in group}
    points = {k: np.vstack(outlines) for k, outlines in rings.items()}
    low = np.array([points[k].min(axis=0) for k in group])
    high = np.array([points[k].max(axis=0) for k in group])
    around: dict[int, list[int]] = {}
    for k in group:
        larger = ((low <= points[k].min(axis=0)) & (high >= points[k].max(axis=0))).all(axis=1)
        others = [group[j] for j in np.flatnonzero(larger) if group[j] != k]
        around[k] = [n for n in others if is_within(points[k], rings[n]).all()]
    for k, outer in around.items():
        shapes = [n for n in outer if len(around[n]) % 2 == 0]
        if len(outer) % 2 and shapes:
            nearest = max(shapes, key=lambda n: len(around[n]))
            kept[nearest] = replace(kept[nearest], subpaths=(*kept[nearest].subpaths, *kept[k].subpaths))
            kept[k] = None


def _is_open_line(element: Element) -> bool:
    cubics = element.subpaths[0].cubics
    return len(element.subpaths) == 1 and not element.subpaths[0].closed and not _meet(cubics[0, 0], cubics[-1, 3])


def _end(cubics: np.ndarray, at_end: bool) -> np.ndarray:
    return cubics[-1, 3] if at_end else cubics[0, 0]


def _meet(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(np.hypot(*(a - b)) <= MAX_GAP_MM)
