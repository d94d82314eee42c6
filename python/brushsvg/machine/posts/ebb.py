"""Moves -> commands of an EBB (.ebb), the board of AxiDraw and NextDraw: steps of two motors in so many milliseconds, a
servo's pulse in 1/12 microseconds. Lines that begin with # are for readers; a sender leaves them out."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..cells.cell import (
    LEAST_SPEED_MM_S,
    min_part_mm,
    mm_from_step_counts,
    servo_parts,
    servo_stands,
    steps_from_mm,
)
from ..motion import Move, Program, Wait
from ..trajectory import joint_speed_limits, time_lines
from .gcode_servo import TOUCHING_MEANINGS, lift_steps, line_feeds_mm_min, servo_values_at
from .text import feed_of_speed_mm_min, plain_text

LINE_LIMIT = 100
LEAST_MS = 16  # no slice is shorter: firmware 2.4 left gaps between such (evil-mad/EggBot, issues 71 and 72)
SLOWEST_S = 0.5  # no slice takes longer: below 1.31 steps in a second a command, the board refuses
STEPS_MS = 25  # no motor makes more in a millisecond
HOME = "end: back to where it began"
EBB_END = "end: the brush is held up, over where it began"


def ebb(program: Program) -> Iterator[str]:
    """The board knows no speed that changes: each move is cut into slices of an even one, with the cell's acceleration
    between them. A slice that would be too short for the board is one with its neighbour where both are on the same
    straight line at the same height, and else takes longer: no place and no height is left out. Places are rounded to
    whole steps first, so that no differences add up. A servo's height is held along each slice, as in grbl_servo. The
    board counts from where its motors were switched on: there the program begins, the brush over the origin, and there
    it ends."""
    cell = program.cell
    writer = _Writer(program)
    yield "".join(map(comment, program.header))
    yield comment("note: begin with the brush over the origin; leave lines with # out when sending")
    yield "SR,0,1\nEM,1,1\n"  # a servo that is not switched off after a minute; motors on, 16 microsteps
    yield writer.risen(program.rise_mm)
    for section in program.sections():
        yield comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield _waited(step.seconds)
            else:
                yield from writer.moved(step)
    yield comment(HOME)
    there = np.array([[0.0, 0.0, writer.here[2]]])
    yield from writer.moved(Move("travel", there, cell.speeds.travel_mm_s))
    yield comment(EBB_END)


def comment(text: str) -> str:
    return f"# {plain_text(text, LINE_LIMIT - 2)}\n"


def _waited(seconds: float) -> str:
    return f"SM,{round(seconds * 1e3)},0,0\n" if round(seconds * 1e3) else ""


class _Writer:
    def __init__(self, program: Program):
        self.cell, self.touching_mm_s = program.cell, program.touching_mm_s
        self.here = np.array([0.0, 0.0, program.rise_mm])
        self.steps, self.value, self.feed = np.zeros(2, dtype=int), 0, 0.0

    def risen(self, height_mm: float) -> str:
        """Up before going anywhere."""
        self.value = int(servo_values_at(self.cell.servo, height_mm))
        return self._set(self.value, 0) + _waited(self.cell.servo.settle_s)

    def moved(self, move: Move) -> Iterator[str]:
        motors, here = self.cell.motors, self.here
        steps = steps_from_mm(move.points_mm, motors)
        height_mm = float(move.points_mm[-1, 2])
        if len(steps) == 1 and (steps[0] == self.steps).all():  # most moves by far
            self.here = np.array([*here[:2], height_mm])
            yield self._lifted(move, here[2], height_mm)
            return
        path = np.vstack([here, np.column_stack([mm_from_step_counts(steps, motors), move.points_mm[:, 2]])])
        self.here = path[-1]
        ways = path[1:] - path[:-1]
        still = servo_stands(ways, self.cell)
        fastest_mm_s = self.touching_mm_s if move.meaning in TOUCHING_MEANINGS else math.inf
        for run in np.split(np.arange(len(still)), np.flatnonzero(still[1:] != still[:-1]) + 1):
            if still[run[0]]:
                for k in run:
                    yield self._lifted(move, path[k, 2], path[k + 1, 2])
                continue
            feeds = line_feeds_mm_min(ways[run], move.speed_mm_s, fastest_mm_s)
            feeds = np.maximum(feeds, feed_of_speed_mm_min(LEAST_SPEED_MM_S["ebb"]))
            yield self._ways(path[run[0] : run[-1] + 2], feeds, move.blends_mm, run)

    def _lifted(self, move: Move, from_mm: float, to_mm: float) -> str:
        servo = self.cell.servo
        step_mm = servo.step_mm if move.meaning in TOUCHING_MEANINGS else np.inf
        lifts = lift_steps(from_mm, to_mm, self.value, move.speed_mm_s, step_mm, servo)
        if not lifts:
            return ""
        self.value = lifts[-1][0]
        set_lifts = "".join(self._set(*lift) for lift in lifts)
        return self._set_feed(feed_of_speed_mm_min(move.speed_mm_s)) + set_lifts + _waited(servo.settle_s)

    def _set_feed(self, feed: float) -> str:
        """The line that says the most that the moves have which follow, where it is another one."""
        before, self.feed = self.feed, feed
        return "" if feed == before else f"# feed {feed:.1f} mm/min\n"

    def _set(self, value: int, wait_ms: int) -> str:
        return f"S2,{value},{self.cell.motors.servo_pin},0,{wait_ms}\n"

    def _ways(
        self, path: np.ndarray, feeds: np.ndarray, blends_mm: np.ndarray | None, run: np.ndarray
    ) -> str:
        """Straight lines, each in parts on which the height is the one half way along, and in slices of time."""
        cell, ways = self.cell, np.diff(path, axis=0)
        lengths = np.hypot(ways[:, 0], ways[:, 1])
        caps = joint_speed_limits(blends_mm, run + 1, ways[:, :2], lengths, cell.speeds.acceleration_mm_s2)
        counts = servo_parts(ways, cell)
        which = np.repeat(np.arange(len(ways)), counts)
        number = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
        inner = np.full(len(which) - 1, np.inf)
        inner[np.cumsum(counts)[:-1] - 1] = caps
        heights = path[which, 2] + ways[which, 2] * (number + 0.5) / counts[which]
        values = servo_values_at(cell.servo, heights)
        parts_mm, tops = (lengths / counts)[which], feeds[which] / 60
        part, when_s, done_mm = self._rows(parts_mm.tolist(), inner.tolist(), tops.tolist())
        line = which[part]
        along = (number[part] * parts_mm[part] + done_mm) / lengths[line]
        part, when_s, places = _none_long(
            part, when_s, path[line, :2] + ways[line, :2] * along[:, None], path[0, :2]
        )
        return self._slices(part, when_s, places, values, feeds[which])

    def _rows(self, parts_mm: list[float], caps: list[float], tops: list[float]) -> tuple[np.ndarray, ...]:
        """(n,) part, when [s], how far on it [mm]: no slice is shorter than a move may be."""
        least_mm, last_mm = min_part_mm(self.cell), 0.0
        part, when, done = [], [], []
        for k, when_s, done_mm in time_lines(parts_mm, caps, tops, self.cell.speeds.acceleration_mm_s2):
            if done_mm is None:
                last_mm, far_mm = 0.0, parts_mm[k]
            elif min(done_mm - last_mm, parts_mm[k] - done_mm) >= least_mm:
                last_mm = far_mm = done_mm
            else:
                continue
            part.append(k)
            when.append(when_s)
            done.append(far_mm)
        return np.array(part), np.array(when), np.array(done)

    def _slices(
        self,
        part: np.ndarray,
        when_s: np.ndarray,
        places: np.ndarray,
        values: np.ndarray,
        feeds: np.ndarray,
    ) -> str:
        motors = self.cell.motors
        steps = np.vstack([self.steps, steps_from_mm(places, motors)])
        self.steps = steps[-1]
        moves = steps[1:] - steps[:-1]
        goes = moves.any(axis=1)  # where it stands, what follows takes the time, too
        part, when_s, moves = part[goes], when_s[goes], moves[goes]
        ways_mm = np.hypot(*mm_from_step_counts(moves, motors).T)
        # never faster than allowed, with any rounding of ways and times
        least_s = np.maximum(_steps(when_s, 0.0), 60 * ways_mm / feeds[part])
        times_ms = np.ceil(np.maximum(1e3 * least_s, np.abs(moves).max(axis=1) / STEPS_MS) - 1e-6)
        first = _none_short(part, times_ms)
        part, moves = part[first], np.add.reduceat(moves, first)
        times_ms = np.maximum(np.add.reduceat(times_ms, first), LEAST_MS)
        values, feeds = values[part], feeds[part]
        new_value, new_feed = _steps(values, self.value) != 0, _steps(feeds, self.feed) != 0
        rows = zip(times_ms.astype(int).tolist(), *moves.T.tolist(), strict=True)
        lines = [f"SM,{time_ms},{one},{two}\n" for time_ms, one, two in rows]
        for k in np.flatnonzero(new_value):
            lines[k] = self._set(values[k], 0) + lines[k]
        for k in np.flatnonzero(new_feed):
            lines[k] = self._set_feed(feeds[k]) + lines[k]
        self.value = int(values[-1]) if len(values) else self.value
        return "".join(lines)


def _steps(values: np.ndarray, before: float) -> np.ndarray:
    """(n,) how far each value is beyond the one before."""
    steps = values - before
    steps[1:] = values[1:] - values[:-1]
    return steps


def _none_short(part: np.ndarray, times_ms: np.ndarray) -> np.ndarray:
    """(n,) the first row of each slice: rows of one part are together where one alone, or the rest, would be too
    short."""
    done_ms = np.cumsum(times_ms)
    left_ms = done_ms[np.searchsorted(part, part, "right") - 1] - done_ms + times_ms  # of the part
    first: list[int] = []
    slice_ms, before = 0.0, -1
    for k, (here, time_ms, rest_ms) in enumerate(
        zip(part.tolist(), times_ms.tolist(), left_ms.tolist(), strict=True)
    ):
        if here == before and min(slice_ms, rest_ms) < LEAST_MS:
            slice_ms += time_ms
            continue
        first.append(k)
        slice_ms, before = time_ms, here
    return np.array(first, dtype=int)


def _none_long(
    part: np.ndarray, when_s: np.ndarray, places: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same rows, with more where one takes long."""
    times_s = _steps(when_s, 0.0)
    counts = np.maximum(1, np.ceil(times_s / SLOWEST_S - 1e-9)).astype(int)
    if (counts == 1).all():
        return part, when_s, places
    which = np.repeat(np.arange(len(part)), counts)
    left = (np.repeat(np.cumsum(counts), counts) - 1 - np.arange(len(which))) / counts[which]
    before = np.vstack([start, places[:-1]])
    places = places[which] - (places - before)[which] * left[:, None]
    return part[which], when_s[which] - times_s[which] * left, places
