"""Lines along the edge of a filled shape, as far inside of it as they are half wide."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import shapely

from .. import _core
from .offset_passes import FITTED, Line

LANDING = 2.5  # in half widths of a line, before a bare place and behind it
EVEN_MM = 0.2
_CORNER_RAD = np.radians(30)  # there one line ends, and another one begins
_FLAT_MM = 0.02
_ROOM = 0.9  # of a line's half width, that the shape has beside it


class Run(NamedTuple):
    """A stretch of an outline between corners, counter-clockwise round the shape; by how much its outline turns to the
    left where it begins and ends, None where it is a ring without a corner."""

    line: shapely.LineString
    turns_rad: tuple[float, float] | None

    def at(self, at_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places and directions there, straight on beyond its ends."""
        whole = self.line.length
        if self.turns_rad is None:
            at_mm = at_mm % whole
        near = np.clip(at_mm, 0.5 * EVEN_MM, whole - 0.5 * EVEN_MM)
        a, b = (
            shapely.get_coordinates(shapely.line_interpolate_point(self.line, near + by))
            for by in (-0.5 * EVEN_MM, 0.5 * EVEN_MM)
        )
        along = (b - a) / np.maximum(np.hypot(*(b - a).T), 1e-9)[:, None]
        return (a + b) / 2 + (at_mm - near)[:, None] * along, along


class Corner(NamedTuple):
    """A corner of an outline that points outwards, and the direction from it that bisects the shape there."""

    at_mm: np.ndarray
    inwards: np.ndarray


class Side(NamedTuple):
    """A run of the outline that a bare piece lies beside: arc lengths between which it does, how far into the shape
    it reaches, and the share of its places that are nearest to this run."""

    run: Run
    ends_mm: tuple[float, float]
    deep_mm: float
    share: float


def runs_of(shape) -> tuple[list[Run], list[Corner]]:
    """An outline between its corners, and those that point outwards."""
    made, tips = [], []
    for polygon in shapely.get_parts(shapely.orient_polygons(shape.simplify(_FLAT_MM))):
        for ring in (polygon.exterior, *polygon.interiors):
            points = np.array(ring.coords)[:-1]
            before, edges = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
            cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
            turns = np.arctan2(cross, (before * edges).sum(axis=1))
            corners = np.flatnonzero(np.abs(turns) > _CORNER_RAD)
            for k in corners[turns[corners] > 0]:
                inwards = edges[k] / np.hypot(*edges[k]) - before[k] / np.hypot(*before[k])
                tips.append(Corner(points[k], inwards / np.hypot(*inwards)))
            if not len(corners):
                made.append(Run(shapely.LineString(np.vstack([points, points[:1]])), None))
                continue
            for a, b in zip(corners, [*corners[1:], corners[0] + len(points)], strict=True):
                some = points[np.arange(a, b + 1) % len(points)]
                made.append(Run(shapely.LineString(some), (turns[a], turns[b % len(points)])))
    return made, tips


def sides_of(places: np.ndarray, runs: list[Run]) -> Iterator[Side]:
    """The runs that places (n, 2) of a bare piece lie nearest to."""
    points = shapely.points(places)
    off = np.array([shapely.distance(run.line, points) for run in runs])
    nearest = off.argmin(axis=0)
    for k in np.unique(nearest).tolist():
        run, own = runs[k], nearest == k
        at = shapely.line_locate_point(run.line, points[own])
        ends = float(at.min()), float(at.max())
        if run.turns_rad is None and ends[1] - ends[0] > run.line.length / 2:  # across where the ring begins
            behind = at > run.line.length / 2
            ends = float(at[behind].min()), float(at[~behind].max()) + run.line.length
        yield Side(run, ends, float(off[k, own].max()), float(own.mean()))


def lines_along(side: Side, width: float, edge) -> list[Line]:
    """A line of this half width along an edge, beside a bare piece and as far beyond as it needs, and the same back;
    none where the shape has no room for it. edge: the shape's whole outline."""
    run, ends = side.run, side.ends_mm
    first, last = ends[0] - LANDING * width, ends[1] + LANDING * width
    if run.turns_rad is not None:
        low, high = (_short_of(turn, width) for turn in run.turns_rad)
        first, last = max(first, low), min(last, run.line.length - high)
    if last - first < width:
        return []
    at = np.linspace(first, last, max(int((last - first) / EVEN_MM), 4))
    places, along = run.at(at)
    middle = places + width * along[:, ::-1] * (-1, 1)
    fits = shapely.distance(edge, shapely.points(middle)) > _ROOM * width
    before, behind = np.flatnonzero(~fits & (at < ends[0])), np.flatnonzero(~fits & (at > ends[1]))
    some = slice(before[-1] + 1 if len(before) else 0, behind[0] if len(behind) else len(at))
    if not fits[some].all() or len(at[some]) < 4:
        return []
    return both_ways(middle[some], width)


def both_ways(middle: np.ndarray, width: float) -> list[Line]:
    """A line of this half width through places (n, 2), and the same back."""
    rows = np.column_stack([middle, np.full(len(middle), width)])
    return [Line(*_core.fit_curve(way, FITTED * width), start="exposed") for way in (rows, rows[::-1])]


def _short_of(turn_rad: float, width: float) -> float:
    """How far before a corner a line beside the edge ends, so that its mark stays in the shape; negative where it runs
    on past an inner corner."""
    if turn_rad < 0:
        return -LANDING * width
    return width * float(np.tan(turn_rad / 2))
