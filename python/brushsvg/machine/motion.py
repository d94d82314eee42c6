"""What a robot does, step by step with its meaning: the words that posts put into a robot's language."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..geometry import polylines
from .cells.cell import LEAST_SPEED_MM_S, Cell, servo_stands
from .frames import moved
from .realised.distortion import commanded_high_mm

SAFE_MEANINGS = ("travel", "retract")  # at or above safe height: as fast as the machine likes


@dataclass(frozen=True)
class Arc:
    """A circle in the x-y plane; turn is 1 counter-clockwise, -1 clockwise."""

    centre_mm: tuple[float, float]
    turn: int


@dataclass(frozen=True)
class Move:
    """Straight lines through points_mm (n, 3), at one speed; or, with arc, the circle through them.

    meaning: travel (at safe height), approach (down to the clearance), land (down to the first pose), paint (along the
    poses), lift (up to the clearance), retract (up to safe height), dip (into the paint and out), wipe, look (slowly,
    at safe height).
    blends_mm: (n,) how far before each point the robot may begin to turn to the next; None: not at all.
    axes: (n, 3) unit vectors from the tip up along the brush at each point, in the frame of the points, the tool turned
    there the shortest way from upright; None: upright.
    """

    meaning: str
    points_mm: np.ndarray
    speed_mm_s: float
    arc: Arc | None = None
    blends_mm: np.ndarray | None = None
    axes: np.ndarray | None = None


@dataclass(frozen=True)
class Wait:
    """Stand still for so long; seconds None: until a person, who is shown the message, lets the program go on."""

    seconds: float | None
    message: str = ""


@dataclass(frozen=True)
class Section:
    """Steps that belong together, under a title: one stroke, one visit to the paint."""

    title: str
    steps: tuple[Move | Wait, ...]

    @property
    def name(self) -> str:
        """Of the stroke or the station."""
        return self.title.partition(": ")[2] or self.title

    @property
    def moves(self) -> tuple[Move, ...]:
        return tuple(step for step in self.steps if isinstance(step, Move))

    @property
    def drawn_mm_s(self) -> float:
        """How fast a stroke is drawn at most; of a dab, its landing."""
        speeds = [
            [move.speed_mm_s for move in self.moves if move.meaning == kind] for kind in ("paint", "land")
        ]
        return max(speeds[0] or speeds[1])


@dataclass(frozen=True)
class Program:
    """header: lines for the reader, each beginning with a word of ours. sections() yields them one by one: a page of
    strokes is never held twice. robot_from_frame: (4, 4), the frame of all points, in the robot's. rise_mm: how high
    the tool is over everything, where it goes first; rise_in_robot_mm: the same in the robot's frame; touching_mm_s:
    the most that the brush's tip may have where it touches; tilts: whether the brush is tilted anywhere."""

    header: tuple[str, ...]
    cell: Cell
    robot_from_frame: np.ndarray
    sections: Callable[[], Iterator[Section]]
    rise_mm: float
    rise_in_robot_mm: float
    touching_mm_s: float
    tilts: bool = False

    @cached_property
    def duration_s(self) -> float:
        return _duration_s(self)


def rise_over(cell: Cell, sheet_mm, frame: np.ndarray) -> float:
    """The height, in the frame that the paper's frame is given in, of the safe height's highest place [mm]."""
    margin = cell.workspace.margin_mm
    x, y = (-margin, sheet_mm[0] + margin), (-margin, sheet_mm[1] + margin)
    corners = np.array([(a, b) for a in x for b in y])
    heights = commanded_high_mm(corners, cell.heights.safe_mm, cell.machine)
    return float(moved(frame, np.column_stack([corners, heights]))[:, 2].max())


def in_robot_frame(program: Program) -> Program:
    """The same program with points in the robot's own frame; there are no arcs on paper that leans."""
    frame = program.robot_from_frame
    if np.array_equal(frame, np.eye(4)):
        return program

    def sections() -> Iterator[Section]:
        for section in program.sections():
            yield Section(section.title, tuple(_turned(step, frame) for step in section.steps))

    return replace(program, robot_from_frame=np.eye(4), sections=sections, rise_mm=program.rise_in_robot_mm)


def _turned(step: Move | Wait, frame: np.ndarray) -> Move | Wait:
    if isinstance(step, Wait):
        return step
    arc = step.arc
    if arc is not None:
        centre = moved(frame, np.array([[*arc.centre_mm, 0.0]]))[0]
        arc = Arc((float(centre[0]), float(centre[1])), arc.turn)
    axes = step.axes if step.axes is None else step.axes @ frame[:3, :3].T
    return replace(step, points_mm=moved(frame, step.points_mm), arc=arc, axes=axes)


def set_programmed_speeds(section: Section, cell: Cell) -> Section:
    """Round speeds down for a language of whole speeds, but no lower than its least one."""
    unit = LEAST_SPEED_MM_S.get(cell.language)
    if unit is None:
        return section

    def with_speed(step: Move | Wait) -> Move | Wait:
        if isinstance(step, Wait):
            return step
        return replace(step, speed_mm_s=unit * max(math.floor(step.speed_mm_s / unit + 1e-6), 1))

    return Section(section.title, tuple(map(with_speed, section.steps)))


def via(points_mm: np.ndarray) -> np.ndarray:
    """Of the points of a circle after its first one, the one that determines it."""
    return points_mm[(len(points_mm) - 1) // 2]


def duration_s(program: Program) -> float:
    """Time for the whole program: each move starts and ends at rest, with the cell's acceleration."""
    return program.duration_s


def _duration_s(program: Program) -> float:
    total_s, here = 0.0, None
    for step in (step for section in program.sections() for step in section.steps):
        if isinstance(step, Wait):
            total_s += step.seconds or 0.0
            continue
        total_s += time_of_way_s(length_mm(step, here), step.speed_mm_s, program.cell)
        total_s += settling_s(step, here, program.cell)
        here = step.points_mm[-1]
    return total_s


def settling_s(move: Move, here: np.ndarray | None, cell: Cell) -> float:
    """How long a move stands still until its servo or pen has settled: after each way of the lift alone."""
    if cell.pen and cell.language == "marlin-servo":
        return cell.pen.settle_s if move.meaning in ("land", "lift") else 0.0
    if not cell.servo or not cell.servo.settle_s:
        return 0.0
    if here is None:  # it is raised before it goes anywhere
        return cell.servo.settle_s
    ways = np.diff(np.vstack([here, move.points_mm]), axis=0)
    return cell.servo.settle_s * int(np.count_nonzero(servo_stands(ways, cell) & (ways[:, 2] != 0)))


def painting_mm(program: Program) -> float:
    """Length of the tool's path on the paper, circles as they are run."""
    total_mm, here = 0.0, None
    for move in (move for section in program.sections() for move in section.moves):
        total_mm += length_mm(move, here) if move.meaning == "paint" else 0.0
        here = move.points_mm[-1]
    return total_mm


def time_of_way_s(length_mm: float, speed_mm_s: float, cell: Cell) -> float:
    """From rest to rest: v rises at the acceleration, stays, falls; a short way never reaches the speed."""
    a = cell.speeds.acceleration_mm_s2
    return (
        length_mm / speed_mm_s + speed_mm_s / a
        if length_mm > speed_mm_s**2 / a
        else 2 * (length_mm / a) ** 0.5
    )


def length_mm(move: Move, here: np.ndarray | None) -> float:
    """Of the path from where the tool is to the last point of the move, as distances() has it; moves have few points,
    for which arrays take ten times as long."""
    path = move.points_mm.tolist()
    path.insert(0, path[0] if here is None else list(here))
    steps = map(math.dist, path, path[1:])
    if move.arc is None:
        return sum(steps)
    across = 2 * sum(math.dist(point[:2], move.arc.centre_mm) for point in path) / len(path)
    return sum(across * math.asin(min(step / across, 1.0)) for step in steps) if across else 0.0


def distances(move: Move, here: np.ndarray | None) -> np.ndarray:
    """(n,) path [mm] from where the tool is (the first point, where that is not known) to each point of the move."""
    if (
        len(move.points_mm) == 1 and here is not None and move.arc is None
    ):  # most moves by far: no arrays for them
        return np.array([math.dist(here, move.points_mm[0])])
    path = np.vstack([move.points_mm[:1] if here is None else here[None], move.points_mm])
    steps = polylines.steps(path)
    if move.arc is not None:
        radius = np.linalg.norm(path[:, :2] - move.arc.centre_mm, axis=1).mean()
        steps = 2 * radius * np.arcsin(np.clip(steps / (2 * radius), 0, 1))
    return np.cumsum(steps)


def times_s(along_mm: np.ndarray, length_mm: float, speed_mm_s: float, cell: Cell) -> np.ndarray:
    """When a move of a length, from rest to rest, has come so far: v rises at the acceleration, stays, falls."""
    a, v = cell.speeds.acceleration_mm_s2, speed_mm_s
    ramp_mm = min(v * v / (2 * a), length_mm / 2)
    peak = np.sqrt(2 * a * ramp_mm)
    if peak == 0:
        return np.zeros_like(along_mm)
    rising = np.sqrt(2 * np.clip(along_mm, 0, ramp_mm) / a)
    steady = np.clip(along_mm - ramp_mm, 0, length_mm - 2 * ramp_mm) / peak
    left_mm = np.clip(length_mm - along_mm, 0, ramp_mm)
    falling = peak / a - np.sqrt(2 * left_mm / a)
    return rising + steady + falling
