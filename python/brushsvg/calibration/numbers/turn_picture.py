"""Find the middle line of an angular stroke's mark in a picture.

The steps are paint, outline, skeleton and its longest path.
"""

from __future__ import annotations

import cv2
import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.rings import signed_area, with_holes
from ...photo.mask_contours import mask_outlines
from ...photo.photo import LIGHT, read_photo

POINT_SPACING_MM = 0.5  # distance of the points along the line
# Share that a branch of the skeleton must add, as for letters. Smaller branches are corners of the outline.
MIN_BRANCH_SHARE = 0.8
# Half widths that are removed at either end, because the skeleton of a stroke bends towards the corners of its ends.
TRIMMED_HALF_WIDTHS = 1.5
MIN_LIGHT_DIFFERENCE = 0.1  # least difference of light between paint and paper
_DIRECTIONS = {"right": (1, 0), "left": (-1, 0), "up": (0, 1), "down": (0, -1)}  # direction of the second line, y up


def centre_line(data: bytes, mm_per_px: float, corner_px, towards: str = "right", where: str = "") -> np.ndarray:
    """Find the middle line of the mark in a picture of an angular stroke.

    data: a picture of one dark stroke on light paper, seen straight from above, with the second line of the stroke
    along the edges of the picture. mm_per_px: scale of the picture. corner_px: where the handle turns (x right, y
    down). towards: direction of the second line, "right", "left", "up" or "down". where: the place in the file, for
    messages.

    Return points (n, 2) [mm] every 0.5 mm in the order of painting. The handle's corner is the origin, its second line
    runs along +x. Raises Error for a file that is not a picture, and for a picture without such a stroke.
    """
    light = LIGHT[cv2.cvtColor(read_photo(data), cv2.COLOR_BGR2GRAY)]
    light = cv2.GaussianBlur(light, (0, 0), 1.0)
    level, _ = cv2.threshold(np.uint8(255 * light), 0, 255, cv2.THRESH_OTSU)
    paint, paper = light[light <= level / 255], light[light > level / 255]
    if not paint.size or not paper.size or float(paper.mean() - paint.mean()) < MIN_LIGHT_DIFFERENCE:
        raise Error("the picture shows no dark stroke on light paper", where, code="photo-without-paint")
    middle = 0.5 * float(np.median(paint) + np.median(paper))
    left_top = np.array([-corner_px[0], corner_px[1]]) * mm_per_px
    rings = mask_outlines(1.0 - light, 1.0 - middle, mm_per_px, left_top)
    if not rings:
        raise Error("the picture shows no stroke", where, code="photo-without-paint")
    area = max(with_holes(rings), key=lambda outline: abs(signed_area(outline[0])))
    line = _find_longest_path(*_core.medial_axis([area[0]], MIN_BRANCH_SHARE))
    if line is None:
        raise Error("the mark is a dab, not a stroke", where, code="not-a-turn")
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    kept_range = (
        TRIMMED_HALF_WIDTHS * float(line[0, 2]),
        length[-1] - TRIMMED_HALF_WIDTHS * float(line[-1, 2]),
    )
    if kept_range[1] - kept_range[0] < 6 * POINT_SPACING_MM:
        raise Error("the mark is too short to show a turn", where, code="not-a-turn")
    at = np.arange(*kept_range, POINT_SPACING_MM)
    points = np.column_stack([np.interp(at, length, line[:, k]) for k in (0, 1)])
    x, y = _DIRECTIONS[towards]
    points = points @ np.array([[x, y], [-y, x]]).T  # coordinates along and across the second line
    if points[0, 0] > points[-1, 0]:
        points = points[::-1]
    return points if np.median(points[:, 1]) < 0 else points * [1.0, -1.0]


def _find_longest_path(nodes: np.ndarray, branches: list) -> np.ndarray | None:
    """Return the longest path through a skeleton as x, y, half width (n, 3)."""
    if not branches:
        return None
    neighbours: dict[int, list] = {}
    for branch in branches:
        line = np.asarray(branch.line)
        size = float(np.hypot(*np.diff(line[:, :2], axis=0).T).sum())
        neighbours.setdefault(branch.start, []).append((branch.end, size, line))
        neighbours.setdefault(branch.end, []).append((branch.start, size, line[::-1]))

    def find_farthest(start: int) -> tuple[int, list]:
        best, stack, visited = (0.0, start, []), [(0.0, start, [])], {start}
        while stack:
            distance, node, lines = stack.pop()
            best = max(best, (distance, node, lines), key=lambda path: path[0])
            for other, size, line in neighbours[node]:
                if other not in visited:
                    visited.add(other)
                    stack.append((distance + size, other, [*lines, line]))
        return best[1], best[2]

    _, lines = find_farthest(find_farthest(branches[0].start)[0])
    return np.vstack(lines)[:, :3] if lines else None
