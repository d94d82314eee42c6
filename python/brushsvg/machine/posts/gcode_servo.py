"""Moves -> G-code for grbl machines whose brush hangs on a servo: M3 S... sets a value instead of a height."""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator
from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..cells.cell import Cell, Servo, servo_parts, servo_stands
from ..motion import Move, Program, Wait
from .gcode import DIALECTS, HELD_UP, MODES, grbl_comment, wait
from .text import ROWS_AT_ONCE, feed_mm_min, number, rows

TOUCHING = (
    "land",
    "paint",
    "lift",
    "dip",
    "wipe",
)  # here the lift goes at the programmed speed; in the air at once


def grbl_servo(program: Program) -> Iterator[str]:
    """Heights become values of the servo's table, held along each line; a line is split where the height
    changes by more than the servo's step. The machine must run in grbl's laser mode ($32=1), in which a new S
    takes effect with the move that it stands in and does not stop it. There grbl switches the output off where
    the motion mode is not G1, G2 or G3, at M5 and at M2, and the brush would fall: so all is G1, from the first line
    to the last, and the program ends without M2, the brush held up."""
    servo = program.cell.servo
    yield "".join(grbl_comment(line) for line in program.header)
    yield grbl_comment("note: set $32=1, so that S changes along with the moves")
    yield f"{MODES}\n"
    feed = feed_mm_min(program.cell.speeds.travel_mm_s)
    yield f"G1 F{feed:.1f}\n"
    here, value = None, 0
    for section in program.sections():
        if here is None:  # up before going anywhere
            here = np.array([0.0, 0.0, program.rise_mm])
            value = int(value_at(servo, here[2]))
            yield f"M3 S{value}\n"
            yield f"G4 P{number(servo.settle_s, 3)}\n" if servo.settle_s else ""
        yield "\n" + grbl_comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield wait(step, DIALECTS["grbl-servo"])
                continue
            feed_word = feed_mm_min(step.speed_mm_s)
            if feed_word != feed:
                yield f"F{feed_word:.1f}\n"
                feed = feed_word
            fastest = program.touching_mm_s if step.meaning in TOUCHING else math.inf
            value, feed = yield from _lines(step, here, value, program.cell, fastest, feed)
            here = step.points_mm[-1]
    yield "\n" + grbl_comment(HELD_UP)


def value_at(servo: Servo, height_mm):
    """The servo's value for a height, or for each of an array."""
    return np.rint(np.interp(height_mm, *_by_height(servo.table))).astype(int)


def height_at(servo: Servo, value: float) -> float:
    """The height that a value gives."""
    return float(np.interp(value, *_by_value(servo.table)))


@lru_cache(maxsize=8)
def _by_height(table: tuple) -> tuple[np.ndarray, np.ndarray]:
    heights, values = np.array(sorted(table), dtype=float).T
    return heights, values


@lru_cache(maxsize=8)
def _by_value(table: tuple) -> tuple[np.ndarray, np.ndarray]:
    heights, values = np.array(sorted(table, key=lambda row: row[1]), dtype=float).T
    return values, heights


def _lines(
    move: Move, here: np.ndarray, value: int, cell: Cell, fastest_mm_s: float, feed: float
) -> Generator[str, None, tuple[int, float]]:
    """A move's lines, and the servo's value and the feed [mm/min] that hold afterwards; value, feed: those before;
    fastest_mm_s: of the tip."""
    servo = cell.servo
    path = np.concatenate([here[None], move.points_mm])
    way = path[1:] - path[:-1]
    still = servo_stands(way, cell)
    begins = (np.flatnonzero(still[1:] != still[:-1]) + 1).tolist() if len(still) > 1 else []
    for first, end in pairwise([0, *begins, len(still)]):
        if not still[first]:
            feeds = feeds_mm_min(way[first:end], move.speed_mm_s, fastest_mm_s)
            value, feed = yield from _ways(path[first:end], way[first:end], feeds, feed, cell)
            continue
        step_mm = servo.step_mm if move.meaning in TOUCHING else np.inf
        for from_mm, to_mm in pairwise(path[first : end + 1, 2].tolist()):
            lifts = lifted(from_mm, to_mm, value, move.speed_mm_s, step_mm, servo)
            if lifts:
                yield _lifts(lifts, servo.settle_s)
                value = lifts[-1][0]
    return value, feed


@lru_cache(maxsize=256)  # most strokes of a drawing are landed and lifted alike
def _lifts(lifts: tuple[tuple[int, int], ...], settle_s: float) -> str:
    lines = "".join(f"M3 S{value}\nG4 P{number(wait_ms / 1e3, 3)}\n" for value, wait_ms in lifts)
    return lines + (f"G4 P{number(settle_s, 3)}\n" if settle_s else "")


@lru_cache(maxsize=256)
def lifted(
    from_mm: float, to_mm: float, value: int, speed_mm_s: float, step_mm: float, servo: Servo
) -> tuple[tuple[int, int], ...]:
    """The lift alone: step by step its value and how long to wait [ms], as long as the way takes at the speed. The way
    is that between the values, which are whole: after a line it begins where its last part was held."""
    feed_mm_s = feed_mm_min(speed_mm_s) / 60
    count = max(1, math.ceil(abs(to_mm - from_mm) / step_mm - 1e-9))
    servo_values = value_at(servo, from_mm + (to_mm - from_mm) * np.arange(1, count + 1) / count)
    servo_values = np.concatenate([[value], servo_values])
    servo_values = servo_values[np.concatenate([[True], servo_values[1:] != servo_values[:-1]])]
    at_mm = np.interp(servo_values, *_by_value(servo.table))
    waits_ms = np.ceil(1e3 * np.abs(at_mm[1:] - at_mm[:-1]) / feed_mm_s).astype(int)
    return tuple(zip(servo_values[1:].tolist(), waits_ms.tolist(), strict=True))


def _ways(
    starts: np.ndarray, ways: np.ndarray, feeds: np.ndarray, feed: float, cell: Cell
) -> Generator[str, None, tuple[int, float]]:
    """Straight lines at their feeds, each in parts on which the height is the one half way along the part; the last
    part's value and feed. starts, ways: (n, 3) of each line; feed: the one before."""
    decimals = cell.decimals
    pattern = f"G1 X%.{decimals}f Y%.{decimals}f S%d"
    for first in range(0, len(ways), ROWS_AT_ONCE):
        start, way = starts[first : first + ROWS_AT_ONCE], ways[first : first + ROWS_AT_ONCE]
        counts = servo_parts(way, cell)
        which = np.repeat(np.arange(len(way)), counts)
        number = np.arange(1, len(which) + 1) - (np.cumsum(counts) - counts)[which]
        start, way, counts = start[which], way[which], counts[which]
        points = start + way * (number / counts)[:, None]
        points[:, 2] = values = value_at(cell.servo, start[:, 2] + way[:, 2] * (number - 0.5) / counts)
        text = "".join(rows(pattern, points, decimals))
        at = feeds[first + which]
        changes = [0] * bool(at[0] != feed) + (np.flatnonzero(at[1:] != at[:-1]) + 1).tolist()
        if changes:
            lines = text.split("\n")
            for k in changes:
                lines[k] = f"F{at[k]:.1f}\n{lines[k]}"
            text = "\n".join(lines)
        feed = at[-1]
        yield text
    return int(values[-1]), feed


def feeds_mm_min(way: np.ndarray, speed_mm_s: float, fastest_mm_s: float) -> np.ndarray:
    """(n,) the feed [mm/min] of each line (n, 3). It is that of the way without the lift: where both together
    would be faster than the tip may be, it is lower, in hundredths of the fastest, so that few lines change it."""
    feeds = np.full(len(way), feed_mm_min(speed_mm_s))
    if math.isinf(fastest_mm_s):
        return feeds
    part = np.linalg.norm(way[:, :2], axis=1) / np.linalg.norm(way, axis=1)
    is_steep = speed_mm_s > fastest_mm_s * part + 1e-9
    part = np.where(part > 0.1, np.floor(100 * part + 1e-9) / 100, part)
    for k in np.flatnonzero(is_steep):
        feeds[k] = feed_mm_min(fastest_mm_s * part[k])
    return feeds
