"""Drawn lines that meet end to end, joined.

The result is what a hand would draw without lifting.
"""

from __future__ import annotations

import numpy as np

from .. import _core
from ..errors import list_first, require_type
from ..read.design import Notice
from .corners import begin_amid_side

MAX_GAP_MM = 0.01
# A line that turns further does not continue the first one.
_MAX_TURN_RAD = np.radians(100)
_MAX_WIDTH_DIFFERENCE = 0.02


def join_lines(strokes: list) -> tuple[list, list[Notice]]:
    """Join drawn lines that meet within 0.01 mm.

    Lines are joined where they have the same layer, colour and settings, and the same width within 2 %, and where
    the straightest continuation turns by no more than 100 degrees. A line keeps its place, id and direction. Others
    are added behind and before it, reversed where necessary. A ring that closes in this way begins as closed lines
    do. Returns the strokes, and notices of what was joined.
    """
    for stroke in strokes:
        require_type(stroke, _core.Stroke, "a stroke")
    lines = {k: stroke for k, stroke in enumerate(strokes) if _is_open_line(stroke)}
    near: dict[tuple, list[int]] = {}
    for k, stroke in lines.items():
        for place in {grid_cell(stroke.middle_mm[0, :2]), grid_cell(stroke.middle_mm[-1, 6:])}:
            near.setdefault(place, []).append(k)
    used: set[int] = set()
    joined_strokes, notices = [], []
    for k, stroke in enumerate(strokes):
        if k in used:
            continue
        if k not in lines:
            joined_strokes.append(stroke)
            continue
        used.add(k)
        chain, names = _Chain(stroke), []
        for at_end in (True, False):
            while not chain.is_ring and (other := _find_continuation(chain, at_end, near, lines, used)) is not None:
                used.add(other)
                names.append(lines[other].id)
                chain.add(lines[other], at_end)
        joined_strokes.append(chain.stroke() if names else stroke)
        if names:
            sentence = f"joined with {list_first(names, 3)}, which meet it end to end"
            notices.append(Notice(stroke.id, sentence, code="lines-joined"))
    return joined_strokes, notices


def report_unjoined_lines(strokes: list) -> list[Notice]:
    """Report a drawing that would have less than half as many strokes if its lines were joined.

    CAD programs break up curves in this way.
    """
    joined_strokes, _ = join_lines(strokes)
    if 2 * len(joined_strokes) >= len(strokes):
        return []
    sentence = f"the drawing has {len(strokes)} strokes, because its lines meet end to end and are not joined"
    return [Notice("", sentence, code="lines-meet", advice=f"--join reduces them to {len(joined_strokes)}")]


class _Chain:
    """A line that grows at both ends.

    cubics: (n, 4, 2); widths: rows (length before it [mm], half width).
    """

    def __init__(self, first):
        self.first = first
        self.cubics = first.middle_mm.reshape(-1, 4, 2)
        self.widths = _widths_mm(first)

    @property
    def is_ring(self) -> bool:
        return bool(np.hypot(*(self.cubics[0, 0] - self.cubics[-1, 3])) <= MAX_GAP_MM)

    def end(self, at_end: bool) -> tuple[np.ndarray, np.ndarray, float]:
        """Return the place of an end, the direction out of it, and half the width there."""
        cubics = self.cubics[-1] if at_end else self.cubics[0][::-1]
        return cubics[3], _end_direction(cubics), self.widths[-1 if at_end else 0, 1]

    def add(self, other, at_end: bool) -> None:
        cubics, widths = other.middle_mm.reshape(-1, 4, 2), _widths_mm(other)
        place = self.end(at_end)[0]
        if (np.hypot(*(cubics[0, 0] - place)) <= MAX_GAP_MM) != at_end:
            cubics, widths = cubics[::-1, ::-1], [widths[-1, 0], 0] + widths[::-1] * [-1, 1]
        parts = [(self.cubics, self.widths), (cubics, widths)]
        (first, before), (second, after) = parts if at_end else parts[::-1]
        second = second.copy()
        second[0, 0] = first[-1, 3]  # the two ends are within MAX_GAP_MM
        self.cubics = np.concatenate([first, second])
        after = after + np.array([before[-1, 0], 0])
        self.widths = np.concatenate([before, after[1:]])

    def stroke(self):
        cubics, widths = self.cubics, self.widths / [self.widths[-1, 0], 1]
        half_width = [tuple(knot) for knot in widths.tolist()] if np.ptp(widths[:, 1]) else [(0.0, widths[0, 1])]
        if self.is_ring:
            cubics = cubics.copy()
            cubics[-1, 3] = cubics[0, 0]
            cubics, half_width = begin_amid_side(cubics, half_width)
        return self.first.replaced(
            middle_mm=cubics.reshape(-1, 8), closed=self.is_ring, half_width=half_width, target_mm=[]
        )


def _find_continuation(chain: _Chain, at_end: bool, near: dict, lines: dict, used: set[int]) -> int | None:
    """Return the line that continues an end of the chain with the least turn."""
    place, out, half = chain.end(at_end)
    turns = []
    x, y = grid_cell(place)
    candidates = {k for dx in (-1, 0, 1) for dy in (-1, 0, 1) for k in near.get((x + dx, y + dy), ())}
    for k in sorted(candidates - used):
        other = lines[k]
        if not _can_join(chain.first, other):
            continue
        cubics, widths = other.middle_mm.reshape(-1, 4, 2), other.half_width
        for points, knot in ((cubics[0], widths[0]), (cubics[-1][::-1], widths[-1])):
            if np.hypot(*(points[0] - place)) <= MAX_GAP_MM and abs(knot[1] - half) <= _MAX_WIDTH_DIFFERENCE * half:
                onward = -_end_direction(points[::-1])
                turn = abs(np.arctan2(out[0] * onward[1] - out[1] * onward[0], out @ onward))
                turns.append((round(float(turn), 6), k))
    turn, k = min(turns, default=(np.inf, None))
    return k if turn <= _MAX_TURN_RAD else None


def _is_open_line(stroke) -> bool:
    if stroke.closed or stroke.target_mm or not len(stroke.middle_mm):
        return False
    return np.hypot(*(stroke.middle_mm[0, :2] - stroke.middle_mm[-1, 6:])) > MAX_GAP_MM


def _can_join(one, other) -> bool:
    repeats = one.origin.repeat, other.origin.repeat
    return repeats[0] == repeats[1] and (one.layer, one.colour, one.settings) == (
        other.layer,
        other.colour,
        other.settings,
    )


def _widths_mm(stroke) -> np.ndarray:
    length_mm = _core.flatten(stroke, 0.01)[-1, 2]
    knots = np.array(stroke.half_width)
    if len(knots) == 1:
        knots = np.array([[0.0, knots[0, 1]], [1.0, knots[0, 1]]])
    return knots * [length_mm, 1]


def _end_direction(cubic: np.ndarray) -> np.ndarray:
    """Return the direction in which a cubic leaves its last point."""
    moves = cubic[3] - cubic[:3]
    return moves[2 - (np.hypot(*moves.T) > 1e-9)[::-1].argmax()]


def grid_cell(place: np.ndarray) -> tuple[int, int]:
    """Return the cell of a grid whose side is the largest gap between ends that meet."""
    return tuple(np.floor(place / MAX_GAP_MM).astype(int).tolist())
