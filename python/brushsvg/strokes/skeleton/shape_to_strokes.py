"""Strokes with which a brush would paint filled outlines.

The steps are the medial axis of the shape (C++), its branches joined to lines (graph), lines in the direction and
order of writing (writing_order, reading_order), and each line as few cubics with a smooth width (C++).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.rings import with_holes, without_slivers
from ...geometry.rotation import rotation
from .cut_ends import run_to_cuts
from .graph import Skeleton, build_skeleton
from .reading_order import order_strokes
from .rough_outlines import smooth_rough_outlines
from .shared_corners import with_shared_corners
from .touching_dots import part_touching_dots
from .writing_order import join_pieces

# How far a middle line may leave the medial axis to be smooth, as a share of the half width. With less it follows
# every dent of the outline; with more the difference shows in the overlap.
MAX_SMOOTHING = 0.03
# Area that a branch must add to be painted, in squares of the half width where it leaves. A corner of 90 degrees
# adds 0.21, one of 60 degrees 0.69, one of 45 degrees 1.24. These are ends of strokes, not strokes.
MIN_BRANCH_AREA = 0.8
# The bar of a t is thin next to its stem. It stays if it adds this much to the stem's disc, and to a disc of its
# own width what any branch must add. With more, bars and serifs are lost; with less, the teeth of a rough edge
# become hairs.
MIN_LIMB_AREA = 0.1
# Branches of a shape: each takes a millisecond, and a page of letters has some thousands.
MAX_BRANCHES = 20_000
MAX_CUT_POINTS = 200_000  # points of a shape times its strokes: letters have some thousands
# Slivers remain where curves cross that should touch. A stroke that is no wider than this anywhere would leave a
# touch of the brush, or is refused as less than a program can express. Where slivers touch the shape, the medial
# axis fails: moving their corners apart makes their sides cross, and the axis leaves the shape by as much as 28 m.
SLIVER_MM = 0.01
# Least width as a share of a stroke's greatest width: no brush paints a point of no width.
MIN_WIDTH_SHARE = 0.01
# Where the surroundings of an end are checked for other strokes: the directions, and the distance in half widths.
# The last value is the share of directions that must be covered. At a stem below thin serifs less than half are,
# outside of a corner a quarter.
_CHECKED_ANGLES_RAD, _CHECKED_DISTANCE, _MIN_COVERED_SHARE = np.radians(np.linspace(-80, 80, 9)), 1.15, 0.35
_UNIT_CIRCLE = np.array([[np.cos(angle), np.sin(angle)] for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False)])


@dataclass(frozen=True)
class OutlineStroke:
    """A stroke found in an outline.

    middle_mm: cubics (n, 8); half_width: [(fraction of arc length, mm)]; target_mm: rings of its part of the shape.
    The parts of all strokes make up the shape, and none is empty. Where strokes cross, the place belongs to both.
    covered: whether other strokes cover its start and its end, because most of the surroundings are in the shape.
    """

    middle_mm: np.ndarray
    half_width: list[tuple[float, float]]
    closed: bool
    target_mm: list[np.ndarray]
    covered: tuple[bool, bool] = (False, False)


def outline_strokes(rings: list[np.ndarray], script: str = "auto") -> list[OutlineStroke]:
    """Return the strokes of a shape in the order and direction of writing.

    rings: as _core.fill returns them; script: as in DIRECTION_WEIGHTS. Raises Error if the shape has more branches
    than any lettering.
    """
    areas = [[without_slivers(ring, SLIVER_MM) for ring in area] for area in with_holes(smooth_rough_outlines(rings))]
    axes = [_core.medial_axis(area, MIN_BRANCH_AREA, MIN_LIMB_AREA) for area in areas]
    if (count := sum(len(branches) for _, branches in axes)) > MAX_BRANCHES:
        raise Error(f"its shape branches into {count} lines, more than {MAX_BRANCHES}", code="outline-too-complex")
    strokes_by_area = [_find_area_strokes(area, *axis, script) for area, axis in zip(areas, axes, strict=True)]
    boxes = np.array([[*area[0].min(axis=0), *area[0].max(axis=0)] for area in areas]).reshape(-1, 4)
    order = order_strokes(boxes, [[line for line, _ in each] for each in strokes_by_area], script)
    ordered = [strokes_by_area[area][k][1] for area, k in order]
    return [stroke for stroke in ordered if 2 * max(half for _, half in stroke.half_width) > SLIVER_MM]


def _find_area_strokes(
    area: list[np.ndarray], nodes: np.ndarray, branches: list, script: str
) -> list[tuple[np.ndarray, OutlineStroke]]:
    """Return the strokes of a connected area, each with its middle line (k, 3)."""
    area_skeleton = build_skeleton(area, nodes, branches)
    if not area_skeleton.pieces:  # the whole shape is roughly one disc
        return [(disc[None, :3], _make_dab(disc, area)) for disc in area_skeleton.dabs[:1]]
    if dots := part_touching_dots(area_skeleton.pieces, area):
        return [(disc[None, :3], _make_dab(disc, part)) for disc, part in dots]
    chains = [run_to_cuts(chain, area) for chain in join_pieces(area_skeleton.pieces, area_skeleton, script)]
    lines = [np.vstack([piece.line for piece in chain]) for chain in chains]
    if len(chains) == 1:
        return [(lines[0], _make_stroke(chains[0], area, area))]
    can_cut = len(chains) * sum(map(len, area)) < MAX_CUT_POINTS
    parts = [_find_chain_part(chain, area_skeleton, area if can_cut else None) for chain in chains]
    kept = [k for k, part in enumerate(parts) if part]
    strokes = [_make_stroke(chains[k], parts[k], area) for k in kept]
    return list(zip([lines[k] for k in kept], with_shared_corners(strokes, area) if can_cut else strokes, strict=True))


def _make_dab(disc: np.ndarray, target_mm: list[np.ndarray]) -> OutlineStroke:
    x, y, radius = disc.tolist()
    return OutlineStroke(np.array([[x, y] * 4]), [(0.0, radius)], False, target_mm)


def _find_chain_part(chain, area_skeleton: Skeleton, area: list[np.ndarray] | None) -> list[np.ndarray]:
    """Return the part of the shape that belongs to a chain of pieces.

    It is the area nearest to the chain's branches and, if the area is given, what the chain paints inside of
    crossings.
    """
    nearest = [ring for piece in chain for branch in piece.branches for ring in area_skeleton.parts[branch]]
    if area is None:
        return _core.unite(nearest)
    across = [
        _core.convex_hull(
            np.vstack([line[0, :2] + line[0, 2] * _UNIT_CIRCLE, line[-1, :2] + line[-1, 2] * _UNIT_CIRCLE])
        )
        for piece in chain
        for line in piece.inside
    ]
    if across:
        across = _core.intersect(_core.unite(across), area)
    return _core.unite([*nearest, *across])


def _make_stroke(chain, target_mm: list[np.ndarray], area: list[np.ndarray]) -> OutlineStroke:
    middles, knots, at_mm = [], [], 0.0
    for piece in chain:
        line = piece.line
        middle, widths = _core.fit_cubics(line, max(MAX_SMOOTHING * float(line[:, 2].mean()), 1e-3), piece.closed)
        length_mm = _length_mm(middle)
        knots += [(at_mm + at * length_mm, half) for at, half in widths]
        at_mm += length_mm
        middles.append(middle)
    least_half = MIN_WIDTH_SHARE * max(half for _, half in knots)
    half_width = [(min(at / at_mm, 1.0) if at_mm > 0 else 0.0, max(half, least_half)) for at, half in knots]
    closed = len(chain) == 1 and chain[0].closed
    line = np.vstack([piece.line for piece in chain])
    covered = (False, False) if closed else (_is_covered(line[::-1], area), _is_covered(line, area))
    return OutlineStroke(np.vstack(middles), half_width, closed, target_mm, covered)


def _is_covered(line: np.ndarray, rings: list[np.ndarray]) -> bool:
    """Return whether other strokes paint ahead of the end of a line.

    line: (k, 3). They do if the outline is further away than a cap of the line's own, in enough of all directions.
    """
    x, y, half = line[-1]
    is_back = np.hypot(*(line[:, :2] - (x, y)).T) > half
    if not is_back.any():
        return False
    along = np.array([x, y]) - line[is_back][-1, :2]
    ways = np.array([along / np.hypot(*along) @ rotation(turn) for turn in _CHECKED_ANGLES_RAD])
    reached = np.array(_core.first_crossings(rings, np.tile([x, y], (len(ways), 1)), ways))
    return bool(np.mean(reached > _CHECKED_DISTANCE * half) > _MIN_COVERED_SHARE)


def _length_mm(middle_mm: np.ndarray) -> float:
    return float(_core.flatten(_core.Stroke(middle_mm=middle_mm, half_width=[(0.0, 1.0)]))[-1, 2])
