"""Filled outlines to the strokes that a brush would paint them with.

The medial axis of the shape (C++), its branches joined to lines (graph), lines in the direction and order of writing
(writing_order, reading_order), each as few cubics with a smooth width (C++).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.rings import with_holes, without_slivers
from ...geometry.rotation import rotation
from .cut_ends import run_to_cuts
from .graph import Skeleton, skeleton
from .reading_order import order_strokes
from .rough_outlines import smooth_rough_outlines
from .shared_corners import with_shared_corners
from .touching_dots import touching_dots
from .writing_order import joined

# How far a middle line may leave the medial axis to be smooth, of the half width: less follows every dent of the
# outline, more shows in the overlap.
SMOOTHED = 0.03
# What a branch must add to be painted, in squares of the half width where it leaves. A corner of 90 degrees adds 0.21,
# of 60 degrees 0.69, of 45 degrees 1.24: those are ends of strokes, not strokes.
LEAST_SHARE = 0.8
# The bar of a t is thin next to its stem: it stays if it adds so much to the stem's disc, and to a disc of its own
# width what any branch must. More loses bars and serifs; with less the teeth of a rough edge become hairs.
LEAST_LIMB = 0.1
MOST_BRANCHES = 20_000  # of a shape: a millisecond each, where a page of letters has some thousands
MOST_CUT = 200_000  # points of a shape times its strokes: letters have some thousands
# Slivers are left where curves cross that should touch. To land for one, no wider than this anywhere, would leave a
# touch of the brush, or is refused as less than a program can express. And where they touch the shape, moving corners
# apart for the medial axis made their sides cross: it went out of the shape, by as much as 28 m.
SLIVER_MM = 0.01
HAIR = 0.01  # of a stroke's greatest width: no brush paints a point of no width
# Where the surroundings of an end are checked for other strokes, beyond its half width, in half widths, and the share
# that must be covered: at a stem below thin serifs less than half, outside of a corner a quarter.
_AHEAD_RAD, _BEYOND_CAP, _COVERED = np.radians(np.linspace(-80, 80, 9)), 1.15, 0.35
_ROUND = np.array([[np.cos(angle), np.sin(angle)] for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False)])


@dataclass(frozen=True)
class OutlineStroke:
    """middle_mm: cubics (n, 8); half_width: [(fraction of arc length, mm)]; wanted_mm: rings of its part of the shape.
    The parts of all strokes make up the shape, none is empty; where they cross, it belongs to both. covered: whether
    its start and its end are covered by others, most of their surroundings being in the shape."""

    middle_mm: np.ndarray
    half_width: list[tuple[float, float]]
    closed: bool
    wanted_mm: list[np.ndarray]
    covered: tuple[bool, bool] = (False, False)


def outline_strokes(rings: list[np.ndarray], script: str = "auto") -> list[OutlineStroke]:
    """Strokes of a shape, in the order and direction of writing; rings as _core.fill returns them; script: as in
    DIRECTION_WEIGHTS. Error if it has more branches than any lettering."""
    areas = [
        [without_slivers(ring, SLIVER_MM) for ring in area]
        for area in with_holes(smooth_rough_outlines(rings))
    ]
    axes = [_core.medial_axis(area, LEAST_SHARE, LEAST_LIMB) for area in areas]
    if (count := sum(len(branches) for _, branches in axes)) > MOST_BRANCHES:
        raise Error(
            f"its shape branches into {count} lines, more than {MOST_BRANCHES}", code="outline-too-complex"
        )
    made = [_strokes(area, *axis, script) for area, axis in zip(areas, axes, strict=True)]
    boxes = np.array([[*area[0].min(axis=0), *area[0].max(axis=0)] for area in areas]).reshape(-1, 4)
    order = order_strokes(boxes, [[line for line, _ in each] for each in made], script)
    found = [made[area][k][1] for area, k in order]
    return [stroke for stroke in found if 2 * max(half for _, half in stroke.half_width) > SLIVER_MM]


def _strokes(
    area: list[np.ndarray], nodes: np.ndarray, branches: list, script: str
) -> list[tuple[np.ndarray, OutlineStroke]]:
    """Each with its middle line (k, 3)."""
    found = skeleton(area, nodes, branches)
    if not found.pieces:  # all of it is one disc, more or less
        return [(disc[None, :3], _dab(disc, area)) for disc in found.dabs[:1]]
    if dots := touching_dots(found.pieces, area):
        return [(disc[None, :3], _dab(disc, part)) for disc, part in dots]
    chains = [run_to_cuts(chain, area) for chain in joined(found.pieces, found, script)]
    lines = [np.vstack([piece.line for piece in chain]) for chain in chains]
    if len(chains) == 1:
        return [(lines[0], _stroke(chains[0], area, area))]
    cuts = len(chains) * sum(map(len, area)) < MOST_CUT
    parts = [_part(chain, found, area if cuts else None) for chain in chains]
    kept = [k for k, part in enumerate(parts) if part]
    strokes = [_stroke(chains[k], parts[k], area) for k in kept]
    return list(
        zip([lines[k] for k in kept], with_shared_corners(strokes, area) if cuts else strokes, strict=True)
    )


def _dab(disc: np.ndarray, wanted_mm: list[np.ndarray]) -> OutlineStroke:
    x, y, radius = disc.tolist()
    return OutlineStroke(np.array([[x, y] * 4]), [(0.0, radius)], False, wanted_mm)


def _part(chain, found: Skeleton, area: list[np.ndarray] | None) -> list[np.ndarray]:
    """Return the area nearest to a chain's branches, and the part of the given area that it paints inside of
    crossings."""
    nearest = [ring for piece in chain for branch in piece.branches for ring in found.parts[branch]]
    if area is None:
        return _core.unite(nearest)
    across = [
        _core.convex_hull(np.vstack([line[0, :2] + line[0, 2] * _ROUND, line[-1, :2] + line[-1, 2] * _ROUND]))
        for piece in chain
        for line in piece.inside
    ]
    if across:
        across = _core.intersect(_core.unite(across), area)
    return _core.unite([*nearest, *across])


def _stroke(chain, wanted_mm: list[np.ndarray], area: list[np.ndarray]) -> OutlineStroke:
    middles, knots, at_mm = [], [], 0.0
    for piece in chain:
        line = piece.line
        middle, widths = _core.fit_curve(line, max(SMOOTHED * float(line[:, 2].mean()), 1e-3), piece.closed)
        length_mm = _length_mm(middle)
        knots += [(at_mm + at * length_mm, half) for at, half in widths]
        at_mm += length_mm
        middles.append(middle)
    least = HAIR * max(half for _, half in knots)
    half_width = [(min(at / at_mm, 1.0) if at_mm > 0 else 0.0, max(half, least)) for at, half in knots]
    closed = len(chain) == 1 and chain[0].closed
    line = np.vstack([piece.line for piece in chain])
    covered = (False, False) if closed else (_is_covered(line[::-1], area), _is_covered(line, area))
    return OutlineStroke(np.vstack(middles), half_width, closed, wanted_mm, covered)


def _is_covered(line: np.ndarray, rings: list[np.ndarray]) -> bool:
    """Return whether ahead of the end of a line (k, 3) the outline is further off than a cap of its own, in enough of
    all directions: other strokes paint there."""
    x, y, half = line[-1]
    is_back = np.hypot(*(line[:, :2] - (x, y)).T) > half
    if not is_back.any():
        return False
    along = np.array([x, y]) - line[is_back][-1, :2]
    ways = np.array([along / np.hypot(*along) @ rotation(turn) for turn in _AHEAD_RAD])
    reached = np.array(_core.first_crossings(rings, np.tile([x, y], (len(ways), 1)), ways))
    return bool(np.mean(reached > _BEYOND_CAP * half) > _COVERED)


def _length_mm(middle_mm: np.ndarray) -> float:
    return float(_core.flatten(_core.Stroke(middle_mm=middle_mm, half_width=[(0.0, 1.0)]))[-1, 2])
