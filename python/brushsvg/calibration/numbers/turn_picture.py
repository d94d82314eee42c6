"""A picture of an angular stroke to the middle line of its mark: paint, outline, skeleton, its longest way."""

from __future__ import annotations

import cv2
import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.rings import signed_area, with_holes
from ...photo.mask_contours import mask_outlines
from ...photo.photo import LIGHT, read_photo

APART_MM = 0.5  # of the points along the line
# share that a branch of the skeleton must add, for example of letters: less are corners of its outline
LEAST_SHARE = 0.8
# The skeleton of a stroke bends towards the corners of its ends: so many half widths of either end are left out.
ENDS = 1.5
LEAST_LIGHT = 0.1  # of the light, by which paint and paper differ
_ALONG = {"right": (1, 0), "left": (-1, 0), "up": (0, 1), "down": (0, -1)}  # of the second line, y up


def centre_line(
    data: bytes, mm_per_px: float, corner_px, towards: str = "right", where: str = ""
) -> np.ndarray:
    """Points (n, 2) of the middle of the mark [mm], the handle's corner at the origin, its second line along +x, every
    0.5 mm from where the stroke comes from to where it goes.

    data: a picture that holds one dark stroke on light paper, seen straight from above, its second line along the
    picture's edges; corner_px: where the handle turns (x right, y down); towards: where the second line goes, "right",
    "left", "up" or "down". Raises Error for what is no picture, and a picture without such a stroke.
    """
    light = LIGHT[cv2.cvtColor(read_photo(data), cv2.COLOR_BGR2GRAY)]
    light = cv2.GaussianBlur(light, (0, 0), 1.0)
    level, _ = cv2.threshold(np.uint8(255 * light), 0, 255, cv2.THRESH_OTSU)
    paint, paper = light[light <= level / 255], light[light > level / 255]
    if not paint.size or not paper.size or float(paper.mean() - paint.mean()) < LEAST_LIGHT:
        raise Error("the picture shows no dark stroke on light paper", where, code="photo-without-paint")
    middle = 0.5 * float(np.median(paint) + np.median(paper))
    left_top = np.array([-corner_px[0], corner_px[1]]) * mm_per_px
    rings = mask_outlines(1.0 - light, 1.0 - middle, mm_per_px, left_top)
    if not rings:
        raise Error("the picture shows no stroke", where, code="photo-without-paint")
    area = max(with_holes(rings), key=lambda one: abs(signed_area(one[0])))
    line = _longest(*_core.medial_axis([area[0]], LEAST_SHARE))
    if line is None:
        raise Error("the mark is a dab, not a stroke", where, code="not-a-turn")
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    keep = (ENDS * float(line[0, 2]), length[-1] - ENDS * float(line[-1, 2]))
    if keep[1] - keep[0] < 6 * APART_MM:
        raise Error("the mark is too short for a turn", where, code="not-a-turn")
    at = np.arange(*keep, APART_MM)
    points = np.column_stack([np.interp(at, length, line[:, k]) for k in (0, 1)])
    x, y = _ALONG[towards]
    points = points @ np.array([[x, y], [-y, x]]).T  # along the second line, and across it
    if points[0, 0] > points[-1, 0]:
        points = points[::-1]
    return points if np.median(points[:, 1]) < 0 else points * [1.0, -1.0]


def _longest(nodes: np.ndarray, branches: list) -> np.ndarray | None:
    """The longest way through a skeleton: x, y, half width (n, 3)."""
    if not branches:
        return None
    ways: dict[int, list] = {}
    for branch in branches:
        line = np.asarray(branch.line)
        size = float(np.hypot(*np.diff(line[:, :2], axis=0).T).sum())
        ways.setdefault(branch.start, []).append((branch.end, size, line))
        ways.setdefault(branch.end, []).append((branch.start, size, line[::-1]))

    def farthest(start: int) -> tuple[int, list]:
        best, todo, seen = (0.0, start, []), [(0.0, start, [])], {start}
        while todo:
            gone, node, lines = todo.pop()
            best = max(best, (gone, node, lines), key=lambda one: one[0])
            for other, size, line in ways[node]:
                if other not in seen:
                    seen.add(other)
                    todo.append((gone + size, other, [*lines, line]))
        return best[1], best[2]

    _, lines = farthest(farthest(branches[0].start)[0])
    return np.vstack(lines)[:, :3] if lines else None
