"""How many cubics an arc needs."""

from __future__ import annotations

import math


def arc_count(swept: float, radius: float, tolerance: float) -> int:
    """Cubics for an arc that turns by `swept` radians, of an ellipse its parameter; radius: the greater one.

    One over an angle t is off by (2/27) sin(t/4)^6 / cos(t/4)^2 of the radius. radius and tolerance in one unit.
    """
    count = max(1, math.ceil(swept / (math.pi / 2) - 1e-9))
    radius = min(radius, 1e15 * tolerance)  # beyond, a double has no such digits
    while radius * 2 / 27 * math.sin(swept / count / 4) ** 6 > tolerance * math.cos(swept / count / 4) ** 2:
        count += 1
    return count
