"""Write G-code for grbl machines with the brush on a servo.

M3 S... sets a value instead of a height.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator
from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..cells.cell import Cell, Servo, servo_parts, servo_stands
from ..moves import Move, Program, Wait
from .gcode import DIALECTS, HELD_UP, MODE_WORDS, grbl_comment, write_wait
from .text import MAX_ROWS_AT_ONCE, feed_of_speed_mm_min, format_number, format_rows

# In these moves the lift goes at the programmed speed. In the air it moves at once.
TOUCHING_MEANINGS = ("land", "paint", "lift", "dip", "wipe")


def grbl_servo(program: Program) -> Iterator[str]:
    """Write a program for grbl with the brush on a servo.

    Heights become values of the servo's table, and each line has one value. A line is split where the height changes
    by more than the servo's step.

    The machine must run in grbl's laser mode ($32=1). In this mode, a new S takes effect with its own move and does not
    stop the machine. However, grbl then switches the output off at M5, at M2, and in motion modes other than G1, G2 and
    G3, and the brush would fall. All moves are therefore G1, and the program ends without M2, with the brush held up.
    """
    servo = program.cell.servo
    yield "".join(grbl_comment(line) for line in program.header)
    yield grbl_comment("note: set $32=1, so that S changes along with the moves")
    yield f"{MODE_WORDS}\n"
    feed = feed_of_speed_mm_min(program.cell.speeds.travel_mm_s)
    yield f"G1 F{feed:.1f}\n"
    here, value, behind_mm = None, 0, 0.0
    for section in program.sections():
        if here is None:  # raise the brush before the first move
            here = np.array([0.0, 0.0, program.rise_mm])
            value = int(servo_values_at(servo, here[2]))
            yield f"M3 S{value}\n"
            yield f"G4 P{format_number(servo.settle_s, 3)}\n" if servo.settle_s else ""
        yield "\n" + grbl_comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield write_wait(step, DIALECTS["grbl-servo"])
                continue
            feed_word = feed_of_speed_mm_min(step.speed_mm_s)
            if feed_word != feed:
                yield f"F{feed_word:.1f}\n"
                feed = feed_word
            fastest = program.touching_mm_s if step.meaning in TOUCHING_MEANINGS else math.inf
            value, behind_mm, feed = yield from _move_lines(step, here, value, behind_mm, program.cell, fastest, feed)
            here = step.points_mm[-1]
    yield "\n" + grbl_comment(HELD_UP)


def servo_values_at(servo: Servo, height_mm):
    """Return the servo's value for a height [mm] or an array of heights."""
    return np.rint(np.interp(height_mm, *_table_by_height(servo.table))).astype(int)


def height_at(servo: Servo, value: float) -> float:
    """Return the height [mm] for a servo's value."""
    return float(np.interp(value, *_table_by_value(servo.table)))


@lru_cache(maxsize=8)
def _table_by_height(table: tuple) -> tuple[np.ndarray, np.ndarray]:
    heights, values = np.array(sorted(table), dtype=float).T
    return heights, values


@lru_cache(maxsize=8)
def _table_by_value(table: tuple) -> tuple[np.ndarray, np.ndarray]:
    heights, values = np.array(sorted(table, key=lambda row: row[1]), dtype=float).T
    return values, heights


def _move_lines(
    move: Move, here: np.ndarray, value: int, behind_mm: float, cell: Cell, fastest_mm_s: float, feed: float
) -> Generator[str, None, tuple[int, float, float]]:
    """Yield a move's lines, and return the servo's value, behind_mm and the feed [mm/min] after it.

    behind_mm: rise [mm] for which the last line, which set the value, was too short.
    fastest_mm_s: limit of the tip.
    """
    servo = cell.servo
    path = np.concatenate([here[None], move.points_mm])
    steps = path[1:] - path[:-1]
    is_lift = servo_stands(steps, cell)
    run_starts = (np.flatnonzero(is_lift[1:] != is_lift[:-1]) + 1).tolist() if len(is_lift) > 1 else []
    for first, end in pairwise([0, *run_starts, len(is_lift)]):
        if not is_lift[first]:
            feeds = line_feeds_mm_min(steps[first:end], move.speed_mm_s, fastest_mm_s)
            value, behind_mm, feed = yield from _line_parts(path[first:end], steps[first:end], feeds, value, feed, cell)
            continue
        step_mm = servo.step_mm if move.meaning in TOUCHING_MEANINGS else np.inf
        for from_mm, to_mm in pairwise(path[first : end + 1, 2].tolist()):
            lifts = lift_steps(from_mm, to_mm, value, move.speed_mm_s, step_mm, servo)
            if lifts:
                rise_mm = height_at(servo, lifts[0][0]) - height_at(servo, value)
                if behind_mm and abs(behind_mm + rise_mm) > 2 * step_mm:
                    yield _wait_line(int(_wait_ms(behind_mm, move.speed_mm_s)))
                yield _lift_lines(lifts, servo.settle_s)
                value, behind_mm = lifts[-1][0], 0.0
    return value, behind_mm, feed


@lru_cache(maxsize=256)  # most strokes of a drawing have the same landing and lift
def _lift_lines(lifts: tuple[tuple[int, int], ...], settle_s: float) -> str:
    lines = "".join(f"M3 S{value}\n{_wait_line(wait_ms)}" for value, wait_ms in lifts)
    return lines + (_wait_line(1e3 * settle_s) if settle_s else "")


def _wait_line(wait_ms: float) -> str:
    return f"G4 P{format_number(wait_ms / 1e3, 3)}\n"


def _wait_ms(rises_mm, speed_mm_s: float) -> np.ndarray:
    """Return the time [ms] of a rise [mm], or of each of an array, at the feed that is written for a speed."""
    return np.ceil(1e3 * np.abs(rises_mm) / (feed_of_speed_mm_min(speed_mm_s) / 60)).astype(int)


@lru_cache(maxsize=256)
def lift_steps(
    from_mm: float, to_mm: float, value: int, speed_mm_s: float, step_mm: float, servo: Servo
) -> tuple[tuple[int, int], ...]:
    """Return the steps of a lift, each with its value and its wait [ms].

    The lift has no sideways move. The waits give the lift its speed. Heights are those of the whole values, so a lift
    after a line begins at the height of the line's last part.
    """
    count = max(1, math.ceil(abs(to_mm - from_mm) / step_mm - 1e-9))
    servo_values = servo_values_at(servo, from_mm + (to_mm - from_mm) * np.arange(1, count + 1) / count)
    servo_values = np.concatenate([[value], servo_values])
    servo_values = servo_values[np.concatenate([[True], servo_values[1:] != servo_values[:-1]])]
    at_mm = np.interp(servo_values, *_table_by_value(servo.table))
    waits_ms = _wait_ms(at_mm[1:] - at_mm[:-1], speed_mm_s)
    return tuple(zip(servo_values[1:].tolist(), waits_ms.tolist(), strict=True))


def _line_parts(
    starts: np.ndarray, ways: np.ndarray, feeds: np.ndarray, value: int, feed: float, cell: Cell
) -> Generator[str, None, tuple[int, float, float]]:
    """Yield straight lines at their feeds.

    Returns the servo's value in the last part, the rise [mm] for which that part was too short, and its feed. Each line
    is written in parts. The height of a part is the height at its middle.

    starts, ways: (n, 3) start and displacement of each line.
    feeds: (n,) feed of each line [mm/min].
    value, feed: the servo's value and the feed [mm/min] before the first line.
    """
    decimals = cell.decimals
    pattern = f"G1 X%.{decimals}f Y%.{decimals}f S%d"
    for first in range(0, len(ways), MAX_ROWS_AT_ONCE):
        start, way = starts[first : first + MAX_ROWS_AT_ONCE], ways[first : first + MAX_ROWS_AT_ONCE]
        counts = servo_parts(way, cell)
        line_numbers = np.repeat(np.arange(len(way)), counts)
        part_numbers = np.arange(1, len(line_numbers) + 1) - (np.cumsum(counts) - counts)[line_numbers]
        start, way, counts = start[line_numbers], way[line_numbers], counts[line_numbers]
        points = start + way * (part_numbers / counts)[:, None]
        points[:, 2] = values = servo_values_at(cell.servo, start[:, 2] + way[:, 2] * (part_numbers - 0.5) / counts)
        text = "".join(format_rows(pattern, points, decimals))
        part_feeds = feeds[first + line_numbers]
        changed_rows = [0] * bool(part_feeds[0] != feed) + (
            np.flatnonzero(part_feeds[1:] != part_feeds[:-1]) + 1
        ).tolist()
        if changed_rows:
            lines = text.split("\n")
            for k in changed_rows:
                lines[k] = f"F{part_feeds[k]:.1f}\n{lines[k]}"
            text = "\n".join(lines)
        feed = part_feeds[-1]
        yield text
        value_before, value = ([value, *values.astype(int).tolist()])[-2:]
    rise_mm = height_at(cell.servo, value) - height_at(cell.servo, value_before)
    part_mm = float(np.linalg.norm(way[-1, :2])) / counts[-1]
    return value, math.copysign(max(abs(rise_mm) - part_mm, 0.0), rise_mm), feed


def line_feeds_mm_min(way: np.ndarray, speed_mm_s: float, fastest_mm_s: float) -> np.ndarray:
    """Return the feed [mm/min] of each line (n, 3), (n,).

    A feed does not include the lift. If the lift would make the tip too fast, the feed is lower. It is then a multiple
    of a hundredth of the highest feed, so that few lines change it.
    """
    feeds = np.full(len(way), feed_of_speed_mm_min(speed_mm_s))
    if math.isinf(fastest_mm_s):
        return feeds
    flat_share = np.linalg.norm(way[:, :2], axis=1) / np.linalg.norm(way, axis=1)
    is_steep = speed_mm_s > fastest_mm_s * flat_share + 1e-9
    flat_share = np.where(flat_share > 0.1, np.floor(100 * flat_share + 1e-9) / 100, flat_share)
    for k in np.flatnonzero(is_steep):
        feeds[k] = feed_of_speed_mm_min(fastest_mm_s * flat_share[k])
    return feeds
