"""Write commands for an EBB (.ebb), the board of AxiDraw and NextDraw.

Each command has the steps of two motors and a duration in milliseconds, or a servo's pulse in 1/12 microseconds. Lines
that begin with # are for readers. The sender must leave them out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..cells.cell import min_part_mm, mm_from_step_counts, servo_parts, servo_stands, steps_from_mm
from ..cells.language_limits import LEAST_SPEED_MM_S
from ..moves import Move, Program, Wait
from ..timed_moves import joint_speed_limits, time_lines
from .gcode_servo import TOUCHING_MEANINGS, lift_steps, line_feeds_mm_min, servo_values_at
from .text import feed_of_speed_mm_min, plain_text

LINE_LIMIT = 100
MIN_SLICE_MS = 16  # shorter slices leave gaps in firmware 2.4 (evil-mad/EggBot, issues 71 and 72)
MAX_SLICE_S = 0.5  # the board refuses commands of less than 1.31 steps per second
MAX_STEPS_PER_MS = 25  # highest speed of a motor in steps per millisecond
HOME = "end: back to where it began"
EBB_END = "end: the brush is held up, over where it began"


def ebb(program: Program) -> Iterator[str]:
    """Write a program for an EBB.

    The board has no changing speeds. Each move is divided into slices of constant speed, with the cell's acceleration
    between them. A slice that is too short for the board is merged with its neighbour if both are on the same straight
    line at the same height. Otherwise it is made longer, so no place and no height is left out.

    Places are first rounded to whole steps, so that rounding does not add up. The servo's height is constant along each
    slice, as in grbl_servo. The board counts steps from the place where its motors were switched on. The program begins
    and ends there, with the brush over the origin.
    """
    cell = program.cell
    writer = _EbbWriter(program)
    yield "".join(map(comment, program.header))
    yield comment("note: begin with the brush over the origin; leave lines with # out when sending")
    yield "SR,0,1\nEM,1,1\n"  # do not switch the servo off after a minute; motors on with 16 microsteps
    yield writer.write_rise(program.rise_mm)
    for section in program.sections():
        yield comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield _wait_command(step.seconds)
            else:
                yield from writer.write_move(step)
    yield comment(HOME)
    origin = np.array([[0.0, 0.0, writer.here[2]]])
    yield from writer.write_move(Move("travel", origin, cell.speeds.travel_mm_s))
    yield comment(EBB_END)


def comment(text: str) -> str:
    return f"# {plain_text(text, LINE_LIMIT - 2)}\n"


def _wait_command(seconds: float) -> str:
    return f"SM,{round(seconds * 1e3)},0,0\n" if round(seconds * 1e3) else ""


class _EbbWriter:
    def __init__(self, program: Program):
        self.cell, self.touching_mm_s = program.cell, program.touching_mm_s
        self.here = np.array([0.0, 0.0, program.rise_mm])
        self.steps, self.value, self.feed = np.zeros(2, dtype=int), 0, 0.0

    def write_rise(self, height_mm: float) -> str:
        """Return the commands that raise the brush before the first move."""
        self.value = int(servo_values_at(self.cell.servo, height_mm))
        return self._servo_command(self.value, 0) + _wait_command(self.cell.servo.settle_s)

    def write_move(self, move: Move) -> Iterator[str]:
        motors, here = self.cell.motors, self.here
        steps = steps_from_mm(move.points_mm, motors)
        height_mm = float(move.points_mm[-1, 2])
        if len(steps) == 1 and (steps[0] == self.steps).all():  # nearly all moves
            self.here = np.array([*here[:2], height_mm])
            yield self._lift_commands(move, here[2], height_mm)
            return
        path = np.vstack([here, np.column_stack([mm_from_step_counts(steps, motors), move.points_mm[:, 2]])])
        self.here = path[-1]
        ways = path[1:] - path[:-1]
        is_lift = servo_stands(ways, self.cell)
        fastest_mm_s = self.touching_mm_s if move.meaning in TOUCHING_MEANINGS else math.inf
        for run in np.split(np.arange(len(is_lift)), np.flatnonzero(is_lift[1:] != is_lift[:-1]) + 1):
            if is_lift[run[0]]:
                for k in run:
                    yield self._lift_commands(move, path[k, 2], path[k + 1, 2])
                continue
            feeds = line_feeds_mm_min(ways[run], move.speed_mm_s, fastest_mm_s)
            feeds = np.maximum(feeds, feed_of_speed_mm_min(LEAST_SPEED_MM_S["ebb"]))
            yield self._line_commands(path[run[0] : run[-1] + 2], feeds, move.blends_mm, run)

    def _lift_commands(self, move: Move, from_mm: float, to_mm: float) -> str:
        servo = self.cell.servo
        step_mm = servo.step_mm if move.meaning in TOUCHING_MEANINGS else np.inf
        lifts = lift_steps(from_mm, to_mm, self.value, move.speed_mm_s, step_mm, servo)
        if not lifts:
            return ""
        self.value = lifts[-1][0]
        set_lifts = "".join(self._servo_command(*lift) for lift in lifts)
        return self._feed_line(feed_of_speed_mm_min(move.speed_mm_s)) + set_lifts + _wait_command(servo.settle_s)

    def _feed_line(self, feed: float) -> str:
        """Return the line with the highest feed of the next moves. It is "" if the feed is unchanged."""
        before, self.feed = self.feed, feed
        return "" if feed == before else f"# feed {feed:.1f} mm/min\n"

    def _servo_command(self, value: int, wait_ms: int) -> str:
        return f"S2,{value},{self.cell.motors.servo_pin},0,{wait_ms}\n"

    def _line_commands(self, path: np.ndarray, feeds: np.ndarray, blends_mm: np.ndarray | None, run: np.ndarray) -> str:
        """Return commands of straight lines in parts and time slices, each part at the height of its middle."""
        cell, ways = self.cell, np.diff(path, axis=0)
        lengths = np.hypot(ways[:, 0], ways[:, 1])
        caps = joint_speed_limits(blends_mm, run + 1, ways[:, :2], lengths, cell.speeds.acceleration_mm_s2)
        counts = servo_parts(ways, cell)
        line_numbers = np.repeat(np.arange(len(ways)), counts)
        part_numbers = np.arange(len(line_numbers)) - np.repeat(np.cumsum(counts) - counts, counts)
        joint_limits = np.full(len(line_numbers) - 1, np.inf)
        joint_limits[np.cumsum(counts)[:-1] - 1] = caps
        heights = path[line_numbers, 2] + ways[line_numbers, 2] * (part_numbers + 0.5) / counts[line_numbers]
        values = servo_values_at(cell.servo, heights)
        parts_mm, part_speeds = (lengths / counts)[line_numbers], feeds[line_numbers] / 60
        part, when_s, done_mm = self._time_parts(parts_mm.tolist(), joint_limits.tolist(), part_speeds.tolist())
        line_of_row = line_numbers[part]
        along = (part_numbers[part] * parts_mm[part] + done_mm) / lengths[line_of_row]
        part, when_s, places = _split_long_rows(
            part, when_s, path[line_of_row, :2] + ways[line_of_row, :2] * along[:, None], path[0, :2]
        )
        return self._slice_commands(part, when_s, places, values, feeds[line_numbers])

    def _time_parts(self, parts_mm: list[float], caps: list[float], tops: list[float]) -> tuple[np.ndarray, ...]:
        """Return part, time [s] and path length [mm] of each row; slices are no shorter than a shortest part."""
        least_mm, last_mm = min_part_mm(self.cell), 0.0
        parts, times, lengths_done = [], [], []
        for k, when_s, done_mm in time_lines(parts_mm, caps, tops, self.cell.speeds.acceleration_mm_s2):
            if done_mm is None:
                last_mm, row_mm = 0.0, parts_mm[k]
            elif min(done_mm - last_mm, parts_mm[k] - done_mm) >= least_mm:
                last_mm = row_mm = done_mm
            else:
                continue
            parts.append(k)
            times.append(when_s)
            lengths_done.append(row_mm)
        return np.array(parts), np.array(times), np.array(lengths_done)

    def _slice_commands(
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
        is_moving = moves.any(axis=1)  # the next slice also takes the time of a slice without steps
        part, when_s, moves = part[is_moving], when_s[is_moving], moves[is_moving]
        ways_mm = np.hypot(*mm_from_step_counts(moves, motors).T)
        # rounding of lengths and times never makes a slice faster than allowed
        min_s = np.maximum(_differences(when_s, 0.0), 60 * ways_mm / feeds[part])
        times_ms = np.ceil(np.maximum(1e3 * min_s, np.abs(moves).max(axis=1) / MAX_STEPS_PER_MS) - 1e-6)
        first_rows = _merge_short_slices(part, times_ms)
        part, moves = part[first_rows], np.add.reduceat(moves, first_rows)
        times_ms = np.maximum(np.add.reduceat(times_ms, first_rows), MIN_SLICE_MS)
        values, feeds = values[part], feeds[part]
        new_value, new_feed = _differences(values, self.value) != 0, _differences(feeds, self.feed) != 0
        rows = zip(times_ms.astype(int).tolist(), *moves.T.tolist(), strict=True)
        lines = [f"SM,{time_ms},{first_steps},{second_steps}\n" for time_ms, first_steps, second_steps in rows]
        for k in np.flatnonzero(new_value):
            lines[k] = self._servo_command(values[k], 0) + lines[k]
        for k in np.flatnonzero(new_feed):
            lines[k] = self._feed_line(feeds[k]) + lines[k]
        self.value = int(values[-1]) if len(values) else self.value
        return "".join(lines)


def _differences(values: np.ndarray, before: float) -> np.ndarray:
    """Return the difference of each value (n,) to the value before it."""
    steps = values - before
    steps[1:] = values[1:] - values[:-1]
    return steps


def _merge_short_slices(part: np.ndarray, times_ms: np.ndarray) -> np.ndarray:
    """Return the first row of each slice.

    Rows of one part are merged if one of them, or the rest of the part, would be too short.
    """
    done_ms = np.cumsum(times_ms)
    left_ms = done_ms[np.searchsorted(part, part, "right") - 1] - done_ms + times_ms  # time left in the part
    first_rows: list[int] = []
    slice_ms, last_part = 0.0, -1
    for k, (part_number, time_ms, rest_ms) in enumerate(
        zip(part.tolist(), times_ms.tolist(), left_ms.tolist(), strict=True)
    ):
        if part_number == last_part and min(slice_ms, rest_ms) < MIN_SLICE_MS:
            slice_ms += time_ms
            continue
        first_rows.append(k)
        slice_ms, last_part = time_ms, part_number
    return np.array(first_rows, dtype=int)


def _split_long_rows(
    part: np.ndarray, when_s: np.ndarray, places: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Split rows that take longer than MAX_SLICE_S."""
    times_s = _differences(when_s, 0.0)
    counts = np.maximum(1, np.ceil(times_s / MAX_SLICE_S - 1e-9)).astype(int)
    if (counts == 1).all():
        return part, when_s, places
    row_numbers = np.repeat(np.arange(len(part)), counts)
    left_fraction = (np.repeat(np.cumsum(counts), counts) - 1 - np.arange(len(row_numbers))) / counts[row_numbers]
    previous_places = np.vstack([start, places[:-1]])
    places = places[row_numbers] - (places - previous_places)[row_numbers] * left_fraction[:, None]
    return part[row_numbers], when_s[row_numbers] - times_s[row_numbers] * left_fraction, places
