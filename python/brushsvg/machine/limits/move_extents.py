"""Exact bounds, distances and box intersections of lines and circles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..moves import Move, Section

ROUNDING_MM = 1e-6  # slack for the rounding of numbers
MAX_MOVES_AT_ONCE = 10_000  # more moves need more memory, fewer moves are slower


@dataclass(frozen=True)
class Ways:
    """Straight and circular moves in one frame [mm].

    starts, ends: (n, 3) ends of the straight moves.
    centre, spoke, across: (m, 3) the circles, at centre + spoke cos t + across sin t for t from 0 to sweep_rad.
    rise: (m, 3) how far each circle climbs, across its plane. A climbing circle is judged by everything that its circle
        and its rise span.
    sweep_rad: (m,) angle of each circle.
    """

    starts: np.ndarray
    ends: np.ndarray
    centre: np.ndarray
    spoke: np.ndarray
    across: np.ndarray
    rise: np.ndarray
    sweep_rad: np.ndarray


def make_paths(paths, circles=()) -> Ways:
    """Make Ways from paths and circles.

    paths: arrays (n, 3) of points [mm] that straight lines connect.
    circles: (start, end, (centre x, centre y, turn)) in x-y planes. turn is 1 for counter-clockwise and -1 for
        clockwise. A circle that ends where it starts goes all the way round.
    """
    paths = [np.asarray(path, dtype=float).reshape(-1, 3) for path in paths]
    # a path of one point is a move that stays at this point
    starts = [path[:-1] if len(path) > 1 else path for path in paths]
    ends = [path[1:] if len(path) > 1 else path for path in paths]
    no_points = np.zeros((0, 3))
    start = np.array([circle[0] for circle in circles], dtype=float).reshape(-1, 3)
    end = np.array([circle[1] for circle in circles], dtype=float).reshape(-1, 3)
    x, y, turn = np.array([circle[2] for circle in circles], dtype=float).reshape(-1, 3).T
    centre = np.column_stack([x, y, start[:, 2]])
    spoke = start - centre
    across = turn[:, None] * np.column_stack([-spoke[:, 1], spoke[:, 0], np.zeros(len(spoke))])
    last, first = end - centre, np.arctan2(spoke[:, 1], spoke[:, 0])
    sweep = (np.arctan2(last[:, 1], last[:, 0]) - first) * turn % (2 * np.pi)
    sweep[sweep == 0] = 2 * np.pi
    rise = np.column_stack([np.zeros((len(end), 2)), end[:, 2] - start[:, 2]])
    return Ways(np.vstack([no_points, *starts]), np.vstack([no_points, *ends]), centre, spoke, across, rise, sweep)


def paths_in_frame(frame: np.ndarray, moves: Ways) -> Ways:
    """Transform moves into the frame in which their own frame is given. frame: (4, 4) pose of the moves' frame."""
    turned, shift = frame[:3, :3].T, frame[:3, 3]
    places = (points @ turned + shift for points in (moves.starts, moves.ends, moves.centre))
    return Ways(*places, moves.spoke @ turned, moves.across @ turned, moves.rise @ turned, moves.sweep_rad)


def measure_bounds(moves: Ways) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest and the largest x, y and z, (3,) each.

    A line reaches them at its ends, a circle perhaps between its ends.
    """
    lows, highs = _circle_bounds(moves)
    both = [moves.starts, moves.ends]
    return np.vstack([*both, lows]).min(axis=0), np.vstack([*both, highs]).max(axis=0)


def _circle_bounds(moves: Ways) -> tuple[np.ndarray, np.ndarray]:
    least, greatest = _harmonic_range(moves.spoke, moves.across, moves.sweep_rad[:, None])
    return (
        moves.centre + least + np.minimum(moves.rise, 0),
        moves.centre + greatest + np.maximum(moves.rise, 0),
    )


def distances_from_origin(moves: Ways) -> tuple[float, float]:
    """Return the smallest and the largest distance [mm] of moves from the origin."""
    step = moves.ends - moves.starts
    square = (step**2).sum(axis=1)
    along = -(moves.starts * step).sum(axis=1) / np.where(square > 0, square, 1)
    nearest = moves.starts + np.clip(along, 0, 1)[:, None] * step
    ends_of_lines = [moves.starts, moves.ends]

    def dot(a, b):
        return (a * b).sum(axis=1)

    # |centre + spoke cos t + across sin t + k rise|^2, where spoke, across and rise are at right angles
    least, greatest = _harmonic_range(dot(moves.centre, moves.spoke), dot(moves.centre, moves.across), moves.sweep_rad)
    climb, height = dot(moves.rise, moves.rise), dot(moves.centre, moves.rise)
    height_fraction = np.clip(-height / np.where(climb > 0, climb, 1), 0, 1)
    squared_radius = dot(moves.centre, moves.centre) + dot(moves.spoke, moves.spoke)
    lowest = squared_radius + 2 * least + (2 * height + height_fraction * climb) * height_fraction
    highest = squared_radius + 2 * greatest + np.maximum(0, 2 * height + climb)
    return (
        float(np.sqrt(max(0.0, np.concatenate([dot(nearest, nearest), lowest]).min()))),
        float(np.sqrt(np.concatenate([*(dot(each, each) for each in ends_of_lines), highest]).max())),
    )


def find_place_inside(moves: Ways, low, high) -> np.ndarray | None:
    """Return a place (3,) where a move is inside a box, or None.

    low, high: (3,) corners of the box.
    """
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    step = moves.ends - moves.starts
    moving = step != 0
    divisor = np.where(moving, step, 1)
    at_low, at_high = (low - moves.starts) / divisor, (high - moves.starts) / divisor
    is_within = (moves.starts > low) & (moves.starts < high)
    enters = np.where(moving, np.minimum(at_low, at_high), np.where(is_within, -np.inf, np.inf)).max(axis=1)
    leaves = np.where(moving, np.maximum(at_low, at_high), np.where(is_within, np.inf, -np.inf)).min(axis=1)
    enters, leaves = np.maximum(enters, 0), np.minimum(leaves, 1)
    if (hits := np.flatnonzero(enters < leaves)).size:
        k = hits[0]
        return moves.starts[k] + (enters[k] + leaves[k]) / 2 * step[k]
    lows, highs = _circle_bounds(moves)
    for k in np.flatnonzero((lows < high).all(axis=1) & (highs > low).all(axis=1)):
        if moves.rise[k].any():
            return moves.centre[k] + moves.spoke[k]
        between = _angles_between_planes(moves, k, low, high)
        places = moves.centre[k] + np.outer(np.cos(between), moves.spoke[k])
        places += np.outer(np.sin(between), moves.across[k])
        if (inside := ((places > low) & (places < high)).all(axis=1)).any():
            return places[inside][0]
    return None


def _angles_between_planes(moves: Ways, k: int, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return one angle [rad] in each part of a circle between planes. The planes are those of a box's six sides."""
    amplitude = np.hypot(moves.spoke[k], moves.across[k])
    phase = np.arctan2(moves.across[k], moves.spoke[k])
    crossing_angles = []
    for side in (low, high):
        ratio = np.divide(side - moves.centre[k], amplitude, out=np.full(3, 2.0), where=amplitude > 0)
        is_crossed = np.abs(ratio) <= 1
        half_angle = np.arccos(ratio[is_crossed])
        crossing_angles += [*(phase[is_crossed] + half_angle), *(phase[is_crossed] - half_angle)]
    crossing_angles = np.array(crossing_angles) % (2 * np.pi)
    angles = np.sort([0.0, *crossing_angles[crossing_angles < moves.sweep_rad[k]], moves.sweep_rad[k]])
    return (angles[1:] + angles[:-1]) / 2


def _harmonic_range(spoke: np.ndarray, across: np.ndarray, sweep_rad: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the range of spoke cos t + across sin t for t from 0 to sweep_rad."""
    end = spoke * np.cos(sweep_rad) + across * np.sin(sweep_rad)
    amplitude, phase = np.hypot(spoke, across), np.arctan2(across, spoke)
    least = np.where((phase + np.pi) % (2 * np.pi) <= sweep_rad, -amplitude, np.minimum(spoke, end))
    greatest = np.where(phase % (2 * np.pi) <= sweep_rad, amplitude, np.maximum(spoke, end))
    return least, greatest


def group_sections(sections: Iterable[Section]) -> Iterator[list[Section]]:
    """Yield groups of sections, each with about MAX_MOVES_AT_ONCE moves."""
    group, moves = [], 0
    for section in sections:
        group.append(section)
        moves += sum(len(move.points_mm) for move in section.moves)
        if moves >= MAX_MOVES_AT_ONCE:
            yield group
            group, moves = [], 0
    if group:
        yield group


def paths_of_moves(moves: Sequence[Move], here: np.ndarray | None) -> Ways:
    """Return the paths of moves.

    They begin at the tool's place, or at the first point if that is not known. Circles are also included as chords.
    """
    paths = [move.points_mm for move in moves]
    points = np.vstack(paths if here is None else [here, *paths])
    ends = np.cumsum([len(path) for path in paths]) + (here is not None)
    circles = [
        (points[last - len(move.points_mm) - 1], points[last - 1], (*move.arc.centre_mm, move.arc.turn))
        for move, last in zip(moves, ends.tolist(), strict=True)
        if move.arc is not None and last > len(move.points_mm)
    ]
    return make_paths([points], circles)
