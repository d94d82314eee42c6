"""Outlines of footprints that are assumed where none was measured.

The tip is at (0, 0), x points towards the TCP.
"""

from __future__ import annotations

import math

VERTICES = 65


def drop(half_mm: float, widest_mm: float, front_mm: float, vertices: int = VERTICES) -> list[list[float]]:
    """Return a drop: straight flanks, and half an ellipse in front of them.

    The flanks run from the tip to the widest section. The outline is counter-clockwise. half_mm: half of the
    greatest width; widest_mm: from the tip to the widest section; front_mm: how far the ellipse reaches beyond it;
    vertices: odd.
    """
    # Points along the half ellipse, both of its ends on the widest section.
    count = vertices - 1
    right = []
    for i in range(count // 2):
        angle = math.pi * i / (count - 1)
        right.append((widest_mm + front_mm * math.sin(angle), -half_mm * math.cos(angle)))
    left = [(x, -y) for x, y in reversed(right)]
    return _round_points([(0.0, 0.0), *right, *left])


def egg(half_mm: float, widest_mm: float, front_mm: float, vertices: int = 64) -> list[list[float]]:
    """Return an egg: half an ellipse to the widest section, another in front of it.

    The outline is counter-clockwise from the tip. half_mm, widest_mm, front_mm: as in `drop`.
    """
    turns = [2.0 * math.pi * i / vertices for i in range(vertices)]
    axes = [widest_mm if math.cos(t) > 0 else front_mm for t in turns]
    points = [(widest_mm - a * math.cos(t), -half_mm * math.sin(t)) for a, t in zip(axes, turns, strict=True)]
    return _round_points(points)


def disc(half_mm: float, vertices: int = 64) -> list[list[float]]:
    """Return a disc whose tip is the rearmost point of its rim."""
    turns = [2.0 * math.pi * i / vertices for i in range(vertices)]
    return _round_points([(half_mm * (1 - math.cos(t)), -half_mm * math.sin(t)) for t in turns])


def _round_points(points: list[tuple[float, float]]) -> list[list[float]]:
    """Round points to 1e-4 mm, without -0."""
    return [[round(x, 4) + 0.0, round(y, 4) + 0.0] for x, y in points]
