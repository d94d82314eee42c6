"""How far moves reach on their whole way, by formula and not by points on it: straight lines and circles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Ways:
    """Moves in one frame [mm]. starts, ends: (n, 3) of straight ones.

    Circles, m of them: from centre + spoke on, at centre + spoke cos t + across sin t for t from 0 to sweep_rad (m,);
    rise: (m, 3) across their plane, what they climb. Those that climb are judged by all that circle and climb span.
    """

    starts: np.ndarray
    ends: np.ndarray
    centre: np.ndarray
    spoke: np.ndarray
    across: np.ndarray
    rise: np.ndarray
    sweep_rad: np.ndarray


def ways(paths, circles=()) -> Ways:
    """Straight lines through each path (n, 3); circles: (start, end, (centre x, centre y, turn)) in x-y planes, turn 1
    counter-clockwise, -1 clockwise. A circle that ends where it starts goes all the way round."""
    paths = [np.asarray(path, dtype=float).reshape(-1, 3) for path in paths]
    # a path of one place is a move that stays there
    starts = [path[:-1] if len(path) > 1 else path for path in paths]
    ends = [path[1:] if len(path) > 1 else path for path in paths]
    none = np.zeros((0, 3))
    start = np.array([each[0] for each in circles], dtype=float).reshape(-1, 3)
    end = np.array([each[1] for each in circles], dtype=float).reshape(-1, 3)
    x, y, turn = np.array([each[2] for each in circles], dtype=float).reshape(-1, 3).T
    centre = np.column_stack([x, y, start[:, 2]])
    spoke = start - centre
    across = turn[:, None] * np.column_stack([-spoke[:, 1], spoke[:, 0], np.zeros(len(spoke))])
    last, first = end - centre, np.arctan2(spoke[:, 1], spoke[:, 0])
    sweep = (np.arctan2(last[:, 1], last[:, 0]) - first) * turn % (2 * np.pi)
    sweep[sweep == 0] = 2 * np.pi
    rise = np.column_stack([np.zeros((len(end), 2)), end[:, 2] - start[:, 2]])
    return Ways(np.vstack([none, *starts]), np.vstack([none, *ends]), centre, spoke, across, rise, sweep)


def ways_in(frame: np.ndarray, some: Ways) -> Ways:
    """The same moves in the frame that theirs, (4, 4), is given in."""
    turned, shift = frame[:3, :3].T, frame[:3, 3]
    places = (each @ turned + shift for each in (some.starts, some.ends, some.centre))
    return Ways(*places, some.spoke @ turned, some.across @ turned, some.rise @ turned, some.sweep_rad)


def bounds(some: Ways) -> tuple[np.ndarray, np.ndarray]:
    """(3,) the least and the greatest x, y and z; a line has them at its ends, a circle perhaps on its way."""
    lows, highs = _bounds_of_circles(some)
    both = [some.starts, some.ends]
    return np.vstack([*both, lows]).min(axis=0), np.vstack([*both, highs]).max(axis=0)


def _bounds_of_circles(some: Ways) -> tuple[np.ndarray, np.ndarray]:
    least, greatest = _swings(some.spoke, some.across, some.sweep_rad[:, None])
    return (
        some.centre + least + np.minimum(some.rise, 0),
        some.centre + greatest + np.maximum(some.rise, 0),
    )


def from_origin(some: Ways) -> tuple[float, float]:
    """The least and the greatest distance from the origin."""
    way = some.ends - some.starts
    square = (way**2).sum(axis=1)
    along = -(some.starts * way).sum(axis=1) / np.where(square > 0, square, 1)
    nearest = some.starts + np.clip(along, 0, 1)[:, None] * way
    far = [some.starts, some.ends]

    def dot(a, b):
        return (a * b).sum(axis=1)

    # |c + cos s + sin a + k rise|^2, in which s, a and rise are at right angles
    least, greatest = _swings(dot(some.centre, some.spoke), dot(some.centre, some.across), some.sweep_rad)
    climb, height = dot(some.rise, some.rise), dot(some.centre, some.rise)
    at = np.clip(-height / np.where(climb > 0, climb, 1), 0, 1)
    round_ = dot(some.centre, some.centre) + dot(some.spoke, some.spoke)
    lowest = round_ + 2 * least + (2 * height + at * climb) * at
    highest = round_ + 2 * greatest + np.maximum(0, 2 * height + climb)
    return (
        float(np.sqrt(max(0.0, np.concatenate([dot(nearest, nearest), lowest]).min()))),
        float(np.sqrt(np.concatenate([*(dot(each, each) for each in far), highest]).max())),
    )


def place_inside(some: Ways, low, high) -> np.ndarray | None:
    """(3,) a place where a move is inside of the box from low to high; None where none ever is."""
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    way = some.ends - some.starts
    moving = way != 0
    pace = np.where(moving, way, 1)
    one, other = (low - some.starts) / pace, (high - some.starts) / pace
    is_within = (some.starts > low) & (some.starts < high)
    enters = np.where(moving, np.minimum(one, other), np.where(is_within, -np.inf, np.inf)).max(axis=1)
    leaves = np.where(moving, np.maximum(one, other), np.where(is_within, np.inf, -np.inf)).min(axis=1)
    enters, leaves = np.maximum(enters, 0), np.minimum(leaves, 1)
    if (hits := np.flatnonzero(enters < leaves)).size:
        k = hits[0]
        return some.starts[k] + (enters[k] + leaves[k]) / 2 * way[k]
    lows, highs = _bounds_of_circles(some)
    for k in np.flatnonzero((lows < high).all(axis=1) & (highs > low).all(axis=1)):
        if some.rise[k].any():
            return some.centre[k] + some.spoke[k]
        between = _between_planes(some, k, low, high)
        places = some.centre[k] + np.outer(np.cos(between), some.spoke[k])
        places += np.outer(np.sin(between), some.across[k])
        if (inside := ((places > low) & (places < high)).all(axis=1)).any():
            return places[inside][0]
    return None


def _between_planes(some: Ways, k: int, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """One angle [rad] of each part into which the planes of a box's six sides divide a circle."""
    size = np.hypot(some.spoke[k], some.across[k])
    top = np.arctan2(some.across[k], some.spoke[k])
    crossed = []
    for side in (low, high):
        share = np.divide(side - some.centre[k], size, out=np.full(3, 2.0), where=size > 0)
        is_met = np.abs(share) <= 1
        half = np.arccos(share[is_met])
        crossed += [*(top[is_met] + half), *(top[is_met] - half)]
    crossed = np.array(crossed) % (2 * np.pi)
    angles = np.sort([0.0, *crossed[crossed < some.sweep_rad[k]], some.sweep_rad[k]])
    return (angles[1:] + angles[:-1]) / 2


def _swings(spoke: np.ndarray, across: np.ndarray, sweep_rad: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The least and the greatest of spoke cos t + across sin t for t from 0 to sweep."""
    end = spoke * np.cos(sweep_rad) + across * np.sin(sweep_rad)
    size, top = np.hypot(spoke, across), np.arctan2(across, spoke)
    least = np.where((top + np.pi) % (2 * np.pi) <= sweep_rad, -size, np.minimum(spoke, end))
    greatest = np.where(top % (2 * np.pi) <= sweep_rad, size, np.maximum(spoke, end))
    return least, greatest
