"""Convert path commands to cubics on paper.

The commands are drawn in user units and mapped by one matrix. A path ends where it leaves the range.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ....geometry.cubics import arc_count
from ...design import SubPath
from .path_data import Command

MAX_COORDINATE_MM = 1e6  # a larger coordinate is damage, because no table is that large
# Tolerance of arcs, far below a brush hair. Up to a radius of 23 mm, two cubics per quarter are enough.
_ARC_TOLERANCE_MM = 1e-4
_MIN_SEGMENT_MM = 1e-6  # size of a segment below which its direction consists of rounding errors


@dataclass(frozen=True)
class TracedPath:
    """The result of path commands.

    subpaths: in mm on paper.
    lone_movetos: number of movetos without a line.
    beyond: the position in the text at which the path left the range and ended, or None.
    """

    subpaths: tuple[SubPath, ...]
    lone_movetos: int
    beyond: int | None


def trace(commands: list[Command], paper_from_user: tuple[float, ...], scale: float) -> TracedPath:
    """Draw commands on paper [mm].

    paper_from_user: matrix from user units to mm; scale: greatest stretch of the matrix [mm per user unit].
    """
    a, b, c, d, e, f = paper_from_user
    subpaths: list[SubPath] = []
    lone_movetos = 0
    for segments, places, closed in _user_subpaths(commands, scale):
        if not segments:
            lone_movetos += 1
            continue
        # Most paths are short. Plain numbers are then faster than a matrix product, and equal on every machine.
        points = [
            (
                *(a * x0 + c * y0 + e, b * x0 + d * y0 + f, a * x1 + c * y1 + e, b * x1 + d * y1 + f),
                *(a * x2 + c * y2 + e, b * x2 + d * y2 + f, a * x3 + c * y3 + e, b * x3 + d * y3 + f),
            )
            for x0, y0, x1, y1, x2, y2, x3, y3 in segments
        ]
        cubics = np.array(points).reshape(-1, 4, 2)
        # The comparison is False for nan as well.
        if all(-MAX_COORDINATE_MM <= v <= MAX_COORDINATE_MM for p in points for v in p):
            has_tiny = any(abs(p[6] - p[0]) < _MIN_SEGMENT_MM and abs(p[7] - p[1]) < _MIN_SEGMENT_MM for p in points)
            subpaths.append(_remove_tiny_segments(cubics, closed) if has_tiny else SubPath(cubics, closed))
            continue
        broken = int(np.argmin((np.abs(cubics) <= MAX_COORDINATE_MM).all(axis=(1, 2))))
        if broken:
            subpaths.append(_remove_tiny_segments(cubics[:broken], False))
        return TracedPath(tuple(subpaths), lone_movetos, places[broken])
    return TracedPath(tuple(subpaths), lone_movetos, None)


def _remove_tiny_segments(cubics: np.ndarray, closed: bool) -> SubPath:
    tiny = np.abs(cubics - cubics[:, :1]).max(axis=(1, 2)) < _MIN_SEGMENT_MM
    if tiny.all():
        return SubPath(np.repeat(cubics[:1, :1], 4, axis=1))
    if tiny.any():
        remaining = cubics[~tiny]
        joined = np.concatenate((remaining[:1, 0], remaining[:-1, 3]))
        handle = (remaining[:, 1] == remaining[:, 0]).all(axis=1)
        remaining[handle, 1] = joined[handle]
        remaining[:, 0] = joined
        if closed:
            remaining[-1, 3] = remaining[0, 0]
        cubics = remaining
    return SubPath(cubics, closed)


def _user_subpaths(commands: list[Command], scale: float) -> Iterator[tuple[list, list[int], bool]]:
    """Yield sub-paths in user units: segments, positions, closed.

    A segment has eight numbers, and its position is an index into the text. A lone moveto has no segments.
    """
    segments: list[tuple[float, ...]] = []
    places: list[int] = []
    x = y = start_x = start_y = handle_x = handle_y = 0.0
    before = ""
    for place, letter, v in commands:
        kind = letter.upper()
        if kind == "M":
            if before not in ("", "Z"):
                yield segments, places, False
            segments, places = [], []
            x, y = v if letter == "M" else (x + v[0], y + v[1])
            start_x, start_y = x, y
        elif kind == "Z":
            if before == "Z":
                continue
            _close(segments, places, place, x, y, start_x, start_y, scale)
            yield segments, places, True
            segments, places = [], []
            x, y = start_x, start_y
        elif kind == "A":
            ex, ey = (v[5], v[6]) if letter == "A" else (x + v[5], y + v[6])
            pieces = _arc(x, y, *v[:5], ex, ey, scale)
            segments.extend(pieces)
            places.extend([place] * len(pieces))
            x, y = ex, ey
        else:
            ox, oy = (0.0, 0.0) if letter == kind else (x, y)
            if kind == "C":
                x1, y1, x2, y2 = ox + v[0], oy + v[1], ox + v[2], oy + v[3]
                ex, ey = ox + v[4], oy + v[5]
                handle_x, handle_y = x2, y2
            elif kind == "S":
                x1, y1 = (2 * x - handle_x, 2 * y - handle_y) if before in ("C", "S") else (x, y)
                x2, y2, ex, ey = ox + v[0], oy + v[1], ox + v[2], oy + v[3]
                handle_x, handle_y = x2, y2
            elif kind in "QT":
                if kind == "Q":
                    handle_x, handle_y = ox + v[0], oy + v[1]
                else:
                    smooth = before in ("Q", "T")
                    handle_x, handle_y = (2 * x - handle_x, 2 * y - handle_y) if smooth else (x, y)
                ex, ey = ox + v[-2], oy + v[-1]
                x1, y1 = x + (handle_x - x) * 2 / 3, y + (handle_y - y) * 2 / 3
                x2, y2 = ex + (handle_x - ex) * 2 / 3, ey + (handle_y - ey) * 2 / 3
            else:
                ex = x if kind == "V" else ox + v[0]
                ey = y if kind == "H" else oy + v[-1]
                x1, y1 = x + (ex - x) / 3, y + (ey - y) / 3
                x2, y2 = ex - (ex - x) / 3, ey - (ey - y) / 3
            segments.append((x, y, x1, y1, x2, y2, ex, ey))
            places.append(place)
            x, y = ex, ey
        before = kind
    if before not in ("", "Z"):
        yield segments, places, False


def _close(segments, places, place, x, y, start_x, start_y, scale: float) -> None:
    gap = max(abs(x - start_x), abs(y - start_y)) * scale
    if segments and gap <= _ARC_TOLERANCE_MM:
        # Relative commands rarely come back exactly. A tiny closing line would add a corner.
        segments[-1] = (*segments[-1][:6], start_x, start_y)
        return
    dx, dy = (start_x - x) / 3, (start_y - y) / 3
    segments.append((x, y, x + dx, y + dy, start_x - dx, start_y - dy, start_x, start_y))
    places.append(place)


def _arc(x, y, rx, ry, turn_deg, large, sweep, ex, ey, scale: float) -> list[tuple[float, ...]]:
    """Return the cubics of an elliptical arc, by SVG 2 appendix B.2.4 and B.2.5.

    The appendix computes the centre from the end points.
    """
    rx, ry = abs(rx), abs(ry)
    is_in_range = all(abs(value) * scale <= MAX_COORDINATE_MM for value in (rx, ry, x, y, ex, ey))  # NaN is not
    if not is_in_range or not math.isfinite(turn_deg):
        return [(x, y, x, y, math.nan, math.nan, ex, ey)]
    straight = (x, y, x + (ex - x) / 3, y + (ey - y) / 3, ex - (ex - x) / 3, ey - (ey - y) / 3, ex, ey)
    if rx * scale < _MIN_SEGMENT_MM or ry * scale < _MIN_SEGMENT_MM:
        return [straight]
    cos, sin = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    # Half the chord, in the frame in which the ellipse is the unit circle.
    px = (cos * (x - ex) + sin * (y - ey)) / 2 / rx
    py = (-sin * (x - ex) + cos * (y - ey)) / 2 / ry
    half_chord = math.hypot(px, py)
    if half_chord < 1e-12:
        return [straight]
    if half_chord >= 1:
        rx, ry, px, py = rx * half_chord, ry * half_chord, px / half_chord, py / half_chord
        half_chord = 1.0
    offset = math.sqrt((1 - half_chord) * (1 + half_chord)) / half_chord
    if bool(large) == bool(sweep):
        offset = -offset
    ux, uy = offset * py, -offset * px
    first = math.atan2(py - uy, px - ux)
    swept = math.atan2(-py - uy, -px - ux) - first
    if sweep and swept < 0:
        swept += math.tau
    elif not sweep and swept > 0:
        swept -= math.tau
    centre_x = (x + ex) / 2 + cos * rx * ux - sin * ry * uy
    centre_y = (y + ey) / 2 + sin * rx * ux + cos * ry * uy
    count = arc_count(abs(swept), max(rx, ry) * scale, _ARC_TOLERANCE_MM)
    step = swept / count
    reach = 4 / 3 * math.tan(step / 4)

    def on_page(u: float, v: float) -> tuple[float, float]:
        return centre_x + cos * rx * u - sin * ry * v, centre_y + sin * rx * u + cos * ry * v

    points: list[tuple[float, ...]] = []
    here = (x, y)
    for k in range(count):
        c0, s0 = math.cos(first + k * step), math.sin(first + k * step)
        c1, s1 = math.cos(first + (k + 1) * step), math.sin(first + (k + 1) * step)
        there = (ex, ey) if k == count - 1 else on_page(c1, s1)
        handles = *on_page(c0 - reach * s0, s0 + reach * c0), *on_page(c1 + reach * s1, s1 - reach * c1)
        points.append((*here, *handles, *there))
        here = there
    return points
