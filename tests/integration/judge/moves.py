"""A controller's run: legs in the robot's frame, errors and side effects."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np


class Leg(NamedTuple):
    """One action of a machine.

    kind is rapid, feed, process (a robot's move at an even speed), arc, jump (a servo's value, at once), wait
    or stop (until a person starts the machine again). start and end [mm] are in the robot's frame. cut_mm is
    how far from the leg's end the tool may pass. For robots, it is how far before the end the blend begins.
    tilt_rad is the angle between the tool and its target direction at the end. takes_up: the tool stands
    for these seconds while the axes take up their play.
    """

    line: int
    kind: str
    start: tuple
    end: tuple
    speed_mm_s: float = math.inf
    centre: tuple | None = None
    turn: int = 0
    cut_mm: float = 0.0
    seconds: float = 0.0
    tilt_rad: float = 0.0
    acceleration: float = 0.0
    takes_up: bool = False


@dataclass
class Run:
    """The run of a program.

    refused: the controller's error, after which nothing runs.
    acts: actions of the program other than moving a brush.
    titles: (words, number of legs before) of each comment after the header.
    header: the lines of comment at the beginning.
    frame: facts that decide how the program begins and ends, for any state of the machine.
    """

    legs: list[Leg] = field(default_factory=list)
    refused: str = ""
    acts: list[str] = field(default_factory=list)
    titles: list[tuple[str, int]] = field(default_factory=list)
    header: list[str] = field(default_factory=list)
    frame: list[str] = field(default_factory=list)
    blends_by_radius: bool = False


class RefusedError(Exception):
    """The controller stops with an error at this line."""


CHORD_RAD, CHORD_MM = 0.05, 1e-4


def arc_points(leg: Leg) -> np.ndarray:
    """Return places (n, 3) along an arc, without its start.

    If its ends have different radii, the places are on a spiral between them.
    """
    (x, y), (a, b, c), (d, e, f) = leg.centre, leg.start, leg.end
    first, last = math.atan2(b - y, a - x), math.atan2(e - y, d - x)
    sweep = (last - first) * leg.turn % math.tau
    sweep = leg.turn * (sweep if sweep > 1e-9 else math.tau)
    radius_mm = math.hypot(a - x, b - y)
    chord_rad = min(CHORD_RAD, math.sqrt(8 * CHORD_MM / max(radius_mm, 1e-9)))
    count = max(2, math.ceil(abs(sweep) / chord_rad))
    part = np.arange(1, count + 1) / count
    radius = math.hypot(a - x, b - y) * (1 - part) + math.hypot(d - x, e - y) * part
    angle = first + sweep * part
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle), c + (f - c) * part])
