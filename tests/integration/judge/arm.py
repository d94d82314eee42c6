"""The robot arm that all interpreters use.

It computes where the real brush's tip is when the controller moves its tool to a pose. It records the legs,
and finds circles through three points.
"""

from __future__ import annotations

import numpy as np

from .moves import Leg, RefusedError, Run
from .places import angle_rad, frame


class Arm:
    """A robot's arm with its place and the legs so far.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    by_radius: blends begin at a radius before a corner, and circles are level in the paper's frame. tcp (4,
    4) is the tool that the program has set, or the flange.
    """

    def __init__(self, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray, by_radius: bool):
        self.run = Run(blends_by_radius=by_radius)
        self.at = np.array(start, dtype=float)
        self.paper, self.down, self.true_tool = paper, down, tool
        self.tcp = np.eye(4)

    def believed(self) -> np.ndarray:
        """Return the pose (4, 4) that the controller believes, in the robot's frame."""
        true = self.paper @ frame((0, 0, 0), self.down)
        true[:3, 3] = self.at
        return true @ np.linalg.inv(self.true_tool) @ self.tcp

    def tip(self, target: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the place of the real brush's tip, and the angle by which it leans."""
        tip = target @ np.linalg.inv(self.tcp) @ self.true_tool
        return tip[:3, 3], angle_rad(tip[:3, :3], self.paper[:3, :3] @ self.down)

    def leg(self, leg: Leg) -> None:
        self.run.legs.append(leg)
        self.at = np.array(leg.end)

    def rest(self, number: int, kind: str, seconds: float = 0.0) -> None:
        if seconds < 0:
            raise RefusedError(f"line {number}: waits less than nothing")
        self.leg(Leg(number, kind, tuple(self.at), tuple(self.at), seconds=seconds))

    def line(self, number: int, target: np.ndarray, speed: float, acceleration: float, cut_mm: float) -> None:
        """Move straight to a pose (4, 4) in the robot's frame."""
        self._checked(number, speed, acceleration, cut_mm)
        tip, tilt = self.tip(target)
        at = tuple(self.at)
        self.leg(
            Leg(
                number,
                "feed",
                at,
                tuple(tip),
                speed,
                cut_mm=cut_mm,
                tilt_rad=tilt,
                acceleration=acceleration,
            )
        )

    def circle(
        self,
        number: int,
        via: np.ndarray,
        target: np.ndarray,
        speed: float,
        acceleration: float,
        cut_mm: float,
    ) -> None:
        """Move on a circle through a pose to a pose, both (4, 4) in the robot's frame."""
        self._checked(number, speed, acceleration, cut_mm)
        (via, _), (end, tilt) = self.tip(via), self.tip(target)
        back = np.linalg.inv(self.paper) if self.run.blends_by_radius else np.eye(4)
        a, b, c = (back[:3, :3] @ np.asarray(point) + back[:3, 3] for point in (self.at, via, end))
        if max(abs(a[2] - b[2]), abs(a[2] - c[2])) > 0.05:
            self.run.acts.append(f"line {number}: a circle that is not level")
        (x, y), (u, v) = (b - a)[:2], (c - a)[:2]
        cross = x * v - y * u
        if abs(cross) < 1e-6:
            raise RefusedError(f"line {number}: three points of a circle on one line")
        one, other = x * x + y * y, u * u + v * v
        centre = a[:2] + np.array([v * one - y * other, x * other - u * one]) / (2 * cross)
        self.leg(
            Leg(
                number,
                "arc",
                tuple(self.at),
                tuple(end),
                speed,
                tuple(centre),
                1 if cross > 0 else -1,
                cut_mm,
                tilt_rad=tilt,
                acceleration=acceleration,
            )
        )

    def _checked(self, number: int, speed: float, acceleration: float, cut_mm: float) -> None:
        if not (speed > 0 and acceleration > 0 and cut_mm >= 0):
            raise RefusedError(f"line {number}: no speed, no acceleration or a blend below 0")
