"""Run a program for an EBB.

The interpreter follows the published command set of firmware 2.6.0 to 2.8.1. SM moves both motors evenly for
a number of milliseconds. Without steps, SM waits. It refuses less than 1.31 and more than 25,000 steps per
second. S2 sets a servo's pulse, at once if it has no rate, and may delay the next command. SR and EM take
effect at once.

The program that sends the file removes lines that begin with #. Every other command counts as one that acts.
"""

from __future__ import annotations

import math
import re

import numpy as np

from .moves import Leg, RefusedError, Run

MOST_24_BITS = 16_777_215
SLOWEST, FASTEST = 1.31, 25_000.0
KNOWN = (
    "A AC BL C CS CU ES HM I L3 LM LT MR MW ND NI O PC PD PG PI PO QB QC QG QL QM QN QP QR QS QT QU R RB SC SE SL SN "
    "SP ST T T3 TD TP V XM"
)


def run_ebb(text: str, start, motors: dict, table) -> Run:
    """Run a program for an EBB.

    start is the place of the brush before the program. It must be over the origin, and only its height is
    used. motors come from the cell. table holds rows (height, value) of the cell's servo.
    """
    board = _Board(start[2], motors, table)
    try:
        for number, line in enumerate(text.split("\n"), 1):
            board.line(number, line)
    except RefusedError as refusal:
        board.run.refused = str(refusal)
    if any(board.steps):
        board.run.frame.append(f"it ends {board.steps.tolist()} steps from where it began")
    return board.run


class _Board:
    def __init__(self, height_mm: float, motors: dict, table):
        self.run, self.number = Run(), 0
        self.rows, self.pin = np.array(motors["steps_per_mm"], dtype=float), motors.get("servo_pin", 4)
        self.steps, self.height_mm = np.zeros(2, dtype=int), height_mm
        self.table = np.array(sorted(table, key=lambda row: row[1]), dtype=float)
        self.has_begun = False

    def line(self, number: int, line: str) -> None:
        self.number = number
        if line.startswith("#"):
            words = line.removeprefix("#").removeprefix(" ").rstrip()
            if words.startswith("feed "):  # the feed that the next moves keep
                self.run.frame.append(f"{len(self.run.legs)} {words}")
            elif self.has_begun:
                self.run.titles.append((words, len(self.run.legs)))
            else:
                self.run.header.append(words)
            return
        if "\r" in line:
            self._act("a return within a line")
        for command in filter(None, (each.strip() for each in line.split("\r"))):
            self.has_begun = True
            self._command(command)

    def _act(self, what: str) -> None:
        self.run.acts.append(f"line {self.number}: {what}")

    def _command(self, command: str) -> None:
        word, *reported = command.split(",")
        word = word.upper()
        if word not in ("SM", "S2", "SR", "EM"):
            if word in KNOWN.split():
                self._act(f"{word} does something else")
                return
            raise RefusedError(f"line {self.number}: !8 Err: Unknown command {word[:10]!r}")
        if not all(re.fullmatch(r"[+-]?\d+", each) for each in reported):
            raise RefusedError(f"line {self.number}: !7 Err: Invalid parameter")
        {"SM": self._move, "S2": self._servo, "SR": self._power, "EM": self._enable}[word](*map(int, reported[:6]))

    def _at(self) -> tuple:
        x, y = np.linalg.solve(self.rows, self.steps)
        return float(x), float(y), self.height_mm

    def _move(self, time_ms: int = 0, one: int = 0, two: int = 0, *more: int) -> None:
        if more or not 1 <= time_ms <= MOST_24_BITS or max(abs(one), abs(two)) > MOST_24_BITS:
            raise RefusedError(f"line {self.number}: !0 Err: <axis> or time out of range")
        here = self._at()
        if not one and not two:
            self.run.legs.append(Leg(self.number, "wait", here, here, seconds=time_ms / 1e3))
            return
        for steps in filter(None, (one, two)):
            if not SLOWEST <= 1e3 * abs(steps) / time_ms <= FASTEST:
                raise RefusedError(f"line {self.number}: !0 Err: <axis> step rate")
        self.steps = self.steps + np.array([one, two])
        there = self._at()
        self.run.legs.append(Leg(self.number, "feed", here, there, math.dist(here, there) / time_ms * 1e3))

    def _servo(self, value: int = -1, pin: int = -1, rate: int = 0, wait_ms: int = 0, *more: int) -> None:
        if more or not (0 <= value <= 65535 and 0 <= pin <= 24 and 0 <= rate <= 65535 and 0 <= wait_ms <= 65535):
            raise RefusedError(f"line {self.number}: !0 Err: parameter out of range")
        if pin != self.pin or not value or rate:
            self._act("another pin, or a servo that is switched off or slow")
            return
        values = self.table[:, 1]
        if not round(values[0]) <= value <= round(values[-1]):
            self._act(f"value {value} is beyond the servo's")
        here = self._at()
        self.height_mm = float(np.interp(value, values, self.table[:, 0]))
        there = self._at()
        self.run.legs.append(Leg(self.number, "jump", here, there))
        if wait_ms:
            self.run.legs.append(Leg(self.number, "wait", there, there, seconds=wait_ms / 1e3))

    def _power(self, after_ms: int = -1, state: int = 1, *more: int) -> None:
        if more or after_ms or state != 1:
            self._act("the servo is switched off after a while, or now")
        self.run.frame.append("SR")

    def _enable(self, one: int = -1, two: int = -1, *more: int) -> None:
        if more or (one, two) != (1, 1) or any(self.steps):
            self._act("motors are switched off, take other steps, or forget where they are")
        self.run.frame.append("EM")
