"""Shapes from the fuzz target medial_axis whose axis was wrong.

Corners that touch were moved across an edge nearby.
"""

import numpy as np

from brushsvg import _core

INPUT = (
    "4e7891759c93024c2f3a5a0c595b1e581a22003972073b71488063534480583b2e1e463b5e767835482834814280392e"
    "50189f3925334b5c42413e4c180102445b940a2c09026f9d161a53667a6e73027e0a2600"
)
WRONG_MM = 1e-3


def drawn() -> list[np.ndarray]:
    """Return outlines that cross themselves and each other, as the fuzzer made them.

    The points are on a grid of 0.25 mm.
    """
    steps = np.frombuffer(bytes.fromhex(INPUT), np.uint8).astype(float)
    counts, points = (11, 12, 8, 11), 0.25 * steps.reshape(-1, 2) - 20.0
    return np.split(points, np.cumsum(counts)[:-1])


def test_axis_points_have_their_stated_distance_from_the_outline():
    shape = _core.fill(drawn(), "evenodd")
    _, branches = _core.medial_axis(shape, 0.7059)
    for branch in branches:
        line = np.asarray(branch.line)
        assert np.abs(np.array(_core.clearance(shape, line[:, :2])) - line[:, 2]).max() < WRONG_MM
