"""Number of cubics that an arc needs."""

from __future__ import annotations

import math


def arc_count(swept: float, radius: float, tolerance: float) -> int:
    """Return the number of cubics for an arc.

    swept: the angle by which the arc turns [rad], for an ellipse the range of its parameter; radius: the greater
    one; tolerance: in the unit of the radius. A cubic over an angle t is off by (2/27) sin(t/4)^6 / cos(t/4)^2 of
    the radius.
    """
    count = max(1, math.ceil(swept / (math.pi / 2) - 1e-9))
    radius = min(radius, 1e15 * tolerance)  # a double has no more digits
    while radius * 2 / 27 * math.sin(swept / count / 4) ** 6 > tolerance * math.cos(swept / count / 4) ** 2:
        count += 1
    return count
