"""Lines that meet end to end made one, as a hand would draw them without lifting."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..errors import need
from ..read.design import Notice
from .corners import begun_amid_a_side

MEET_MM = 0.01
_STRAIGHT_ON_RAD = np.radians(100)  # a line that turns further is another one
_SAME_WIDTH = 0.02


def joined(strokes: list) -> tuple[list, list[Notice]]:
    """The strokes, drawn lines that meet within 0.01 mm as one, and what was joined.

    Lines are joined where they have one layer, colour, settings and, within 2 %, one width there, and where the
    straightest way on turns by no more than 100 degrees. A line keeps its place, id and direction: others are added
    behind and before it, turned round where need be; rings that close so begin as closed lines do.
    """
    for stroke in strokes:
        need(stroke, _core.Stroke, "a stroke")
    lines = {k: stroke for k, stroke in enumerate(strokes) if _is_open_line(stroke)}
    near: dict[tuple, list[int]] = {}
    for k, stroke in lines.items():
        for place in {_cell(stroke.middle_mm[0, :2]), _cell(stroke.middle_mm[-1, 6:])}:
            near.setdefault(place, []).append(k)
    taken: set[int] = set()
    made, notices = [], []
    for k, stroke in enumerate(strokes):
        if k in taken:
            continue
        if k not in lines:
            made.append(stroke)
            continue
        taken.add(k)
        chain, names = _Chain(stroke), []
        for at_end in (True, False):
            while (
                not chain.is_ring and (other := _straightest(chain, at_end, near, lines, taken)) is not None
            ):
                taken.add(other)
                names.append(lines[other].id)
                chain.add(lines[other], at_end)
        made.append(chain.stroke() if names else stroke)
        if names:
            listed = ", ".join(names[:3]) + f" and {len(names) - 3} more" * (len(names) > 3)
            notices.append(
                Notice(stroke.id, f"joined with {listed}, which meet it end to end", code="lines-joined")
            )
    return made, notices


class _Chain:
    """A line that grows at both ends: cubics (n, 4, 2), and rows (length before it [mm], half width)."""

    def __init__(self, first):
        self.first = first
        self.cubics = first.middle_mm.reshape(-1, 4, 2)
        self.widths = _widths_mm(first)

    @property
    def is_ring(self) -> bool:
        return bool(np.hypot(*(self.cubics[0, 0] - self.cubics[-1, 3])) <= MEET_MM)

    def end(self, at_end: bool) -> tuple[np.ndarray, np.ndarray, float]:
        """Where it ends or begins, the direction out of it there, and half its width."""
        cubics = self.cubics[-1] if at_end else self.cubics[0][::-1]
        return cubics[3], _leaving(cubics), self.widths[-1 if at_end else 0, 1]

    def add(self, other, at_end: bool) -> None:
        cubics, widths = other.middle_mm.reshape(-1, 4, 2), _widths_mm(other)
        place = self.end(at_end)[0]
        if (np.hypot(*(cubics[0, 0] - place)) <= MEET_MM) != at_end:
            cubics, widths = cubics[::-1, ::-1], [widths[-1, 0], 0] + widths[::-1] * [-1, 1]
        parts = [(self.cubics, self.widths), (cubics, widths)]
        (first, before), (second, after) = parts if at_end else parts[::-1]
        second = second.copy()
        second[0, 0] = first[-1, 3]  # within MEET_MM of it
        self.cubics = np.concatenate([first, second])
        after = after + np.array([before[-1, 0], 0])
        self.widths = np.concatenate([before, after[1:]])

    def stroke(self):
        cubics, widths = self.cubics, self.widths / [self.widths[-1, 0], 1]
        half_width = (
            [tuple(knot) for knot in widths.tolist()] if np.ptp(widths[:, 1]) else [(0.0, widths[0, 1])]
        )
        if self.is_ring:
            cubics = cubics.copy()
            cubics[-1, 3] = cubics[0, 0]
            cubics, half_width = begun_amid_a_side(cubics, half_width)
        return self.first.replaced(
            middle_mm=cubics.reshape(-1, 8), closed=self.is_ring, half_width=half_width, wanted_mm=[]
        )


def _straightest(chain: _Chain, at_end: bool, near: dict, lines: dict, taken: set[int]) -> int | None:
    """The line that goes on from an end of the chain with the least turn."""
    place, out, half = chain.end(at_end)
    found = []
    x, y = _cell(place)
    some = {k for dx in (-1, 0, 1) for dy in (-1, 0, 1) for k in near.get((x + dx, y + dy), ())}
    for k in sorted(some - taken):
        other = lines[k]
        if not _is_alike(chain.first, other):
            continue
        cubics, widths = other.middle_mm.reshape(-1, 4, 2), other.half_width
        for points, knot in ((cubics[0], widths[0]), (cubics[-1][::-1], widths[-1])):
            if np.hypot(*(points[0] - place)) <= MEET_MM and abs(knot[1] - half) <= _SAME_WIDTH * half:
                onward = -_leaving(points[::-1])
                turn = abs(np.arctan2(out[0] * onward[1] - out[1] * onward[0], out @ onward))
                found.append((round(float(turn), 6), k))
    turn, k = min(found, default=(np.inf, None))
    return k if turn <= _STRAIGHT_ON_RAD else None


def _is_open_line(stroke) -> bool:
    ends = stroke.middle_mm[0, :2], stroke.middle_mm[-1, 6:]
    return not (stroke.closed or stroke.wanted_mm) and np.hypot(*(ends[0] - ends[1])) > MEET_MM


def _is_alike(one, other) -> bool:
    of = one.origin.repeat, other.origin.repeat
    return of[0] == of[1] and (one.layer, one.colour, one.settings) == (
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


def _leaving(cubic: np.ndarray) -> np.ndarray:
    """Direction in which a cubic leaves its last point."""
    moves = cubic[3] - cubic[:3]
    return moves[2 - (np.hypot(*moves.T) > 1e-9)[::-1].argmax()]


def _cell(place: np.ndarray) -> tuple[int, int]:
    return tuple(np.floor(place / MEET_MM).astype(int).tolist())
