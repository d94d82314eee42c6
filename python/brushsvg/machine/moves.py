"""Moves, waits, sections and programs, which posts write as robot languages."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..geometry import polylines
from .cells.cell import Cell, servo_stands
from .cells.language_limits import LEAST_SPEED_MM_S
from .frames import transform_points
from .realised.distortion import commanded_heights_mm

MEANINGS_AT_SAFE_HEIGHT = ("travel", "retract")  # at or above the safe height, where speed is not limited


@dataclass(frozen=True)
class Arc:
    """A circle in the x-y plane.

    turn: 1 for counter-clockwise, -1 for clockwise.
    """

    centre_mm: tuple[float, float]
    turn: int


@dataclass(frozen=True)
class Move:
    """Straight lines at one speed, or a circle.

    meaning: travel (at the safe height), approach (down to the clearance), land (down to the first pose), paint (along
        the poses), lift (up to the clearance), retract (up to the safe height), dip (into the paint and out), wipe, or
        look (slowly, at the safe height).
    points_mm: (n, 3) points [mm].
    speed_mm_s: speed of the tip [mm/s].
    arc: the circle; None for straight lines.
    blends_mm: (n,) how far before each point the robot may begin to turn to the next point; None for not at all.
    axes: (n, 3) unit vectors from the tip up along the brush at each point, in the frame of the points. The tool is
        turned there the shortest way from upright. None for an upright brush.
    """

    meaning: str
    points_mm: np.ndarray
    speed_mm_s: float
    arc: Arc | None = None
    blends_mm: np.ndarray | None = None
    axes: np.ndarray | None = None


@dataclass(frozen=True)
class Wait:
    """A wait of some seconds.

    If seconds is None, the program shows the message and waits for a person to continue it.
    """

    seconds: float | None
    message: str = ""


@dataclass(frozen=True)
class Section:
    """Steps with a common title: one stroke, or one visit to the paint."""

    title: str
    steps: tuple[Move | Wait, ...]

    @property
    def name(self) -> str:
        """Name of the stroke or the station."""
        return self.title.partition(": ")[2] or self.title

    @property
    def moves(self) -> tuple[Move, ...]:
        return tuple(step for step in self.steps if isinstance(step, Move))

    @property
    def drawn_mm_s(self) -> float:
        """Highest speed [mm/s] at which a stroke is drawn. For a dab, it is the speed of the landing."""
        speeds = [[move.speed_mm_s for move in self.moves if move.meaning == kind] for kind in ("paint", "land")]
        return max(speeds[0] or speeds[1])


@dataclass(frozen=True)
class Program:
    """Everything that a machine does for a job.

    header: lines for the reader. Each line begins with a fixed word, such as "title".
    cell: the cell that the program is for.
    robot_from_frame: (4, 4) pose of the frame of all points in the robot's frame.
    sections: yields the sections one by one, so that a page of strokes is never held twice.
    rise_mm: height to which the tool rises first, clear of everything.
    rise_in_robot_mm: this height in the robot's frame.
    touching_mm_s: highest speed of the brush's tip on the paper [mm/s].
    tilts: whether the brush is tilted anywhere.
    name: what the program is called, for languages in which programs have names. A post changes it if its language does
        not take it.
    """

    header: tuple[str, ...]
    cell: Cell
    robot_from_frame: np.ndarray
    sections: Callable[[], Iterator[Section]]
    rise_mm: float
    rise_in_robot_mm: float
    touching_mm_s: float
    tilts: bool = False
    name: str = "brushsvg"

    @cached_property
    def duration_s(self) -> float:
        return _duration_s(self)


def rise_height_mm(cell: Cell, sheet_mm, frame: np.ndarray) -> float:
    """Return the height [mm] of the highest place at the safe height.

    frame: (4, 4) pose of the paper's frame in the frame in which the height is returned.
    """
    margin = cell.workspace.margin_mm
    x, y = (-margin, sheet_mm[0] + margin), (-margin, sheet_mm[1] + margin)
    corners = np.array([(a, b) for a in x for b in y])
    heights = commanded_heights_mm(corners, cell.heights.safe_mm, cell.machine)
    return float(transform_points(frame, np.column_stack([corners, heights]))[:, 2].max())


def program_in_robot_frame(program: Program) -> Program:
    """Return a program with its points in the robot's own frame. Programs for leaning paper have no arcs."""
    frame = program.robot_from_frame
    if np.array_equal(frame, np.eye(4)):
        return program

    def sections() -> Iterator[Section]:
        for section in program.sections():
            yield Section(section.title, tuple(_move_step_to_frame(step, frame) for step in section.steps))

    return replace(program, robot_from_frame=np.eye(4), sections=sections, rise_mm=program.rise_in_robot_mm)


def _move_step_to_frame(step: Move | Wait, frame: np.ndarray) -> Move | Wait:
    if isinstance(step, Wait):
        return step
    arc = step.arc
    if arc is not None:
        centre = transform_points(frame, np.array([[*arc.centre_mm, 0.0]]))[0]
        arc = Arc((float(centre[0]), float(centre[1])), arc.turn)
    axes = step.axes if step.axes is None else step.axes @ frame[:3, :3].T
    return replace(step, points_mm=transform_points(frame, step.points_mm), arc=arc, axes=axes)


def set_programmed_speeds(section: Section, cell: Cell) -> Section:
    """Round speeds down for a language of whole speeds. No speed becomes lower than the language's lowest speed."""
    unit = LEAST_SPEED_MM_S.get(cell.language)
    if unit is None:
        return section

    def with_speed(step: Move | Wait) -> Move | Wait:
        if isinstance(step, Wait):
            return step
        return replace(step, speed_mm_s=unit * max(math.floor(step.speed_mm_s / unit + 1e-6), 1))

    return Section(section.title, tuple(map(with_speed, section.steps)))


def via_point(points_mm: np.ndarray) -> np.ndarray:
    """Return the intermediate point that defines a circle together with its two ends.

    points_mm: points of the circle without its first point.
    """
    return points_mm[(len(points_mm) - 1) // 2]


def duration_s(program: Program) -> float:
    """Return the duration [s] of a program. Each move starts and ends at rest, with the cell's acceleration."""
    return program.duration_s


def _duration_s(program: Program) -> float:
    total_s, last_point = 0.0, None
    for step in (step for section in program.sections() for step in section.steps):
        if isinstance(step, Wait):
            total_s += step.seconds or 0.0
            continue
        total_s += duration_of_path_s(length_mm(step, last_point), step.speed_mm_s, program.cell)
        total_s += settling_s(step, last_point, program.cell)
        last_point = step.points_mm[-1]
    return total_s


def settling_s(move: Move, here_mm: np.ndarray | None, cell: Cell) -> float:
    """Return how long [s] a move waits for its servo or pen to settle. It waits after each move of the lift alone."""
    if cell.pen and cell.language == "marlin-servo":
        return cell.pen.settle_s if move.meaning in ("land", "lift") else 0.0
    if not cell.servo or not cell.servo.settle_s:
        return 0.0
    if here_mm is None:  # the servo is raised before the first move
        return cell.servo.settle_s
    steps_mm = np.diff(np.vstack([here_mm, move.points_mm]), axis=0)
    return cell.servo.settle_s * int(np.count_nonzero(servo_stands(steps_mm, cell) & (steps_mm[:, 2] != 0)))


def painting_mm(program: Program) -> float:
    """Return the length [mm] of the tool's path on the paper.

    Arcs count with their own length, not with that of their chords.
    """
    total_mm, last_point = 0.0, None
    for move in (move for section in program.sections() for move in section.moves):
        total_mm += length_mm(move, last_point) if move.meaning == "paint" else 0.0
        last_point = move.points_mm[-1]
    return total_mm


def duration_of_path_s(length_mm: float, speed_mm_s: float, cell: Cell) -> float:
    """Return the duration [s] of a path from rest to rest.

    The speed rises with the cell's acceleration, stays constant, and falls. A short path never reaches the speed.
    """
    a = cell.speeds.acceleration_mm_s2
    return length_mm / speed_mm_s + speed_mm_s / a if length_mm > speed_mm_s**2 / a else 2 * (length_mm / a) ** 0.5


def length_mm(move: Move, start_mm: np.ndarray | None) -> float:
    """Return the length [mm] of a move from the tool's place.

    It equals the last value of distances(). Most moves have few points, for which arrays are ten times slower.
    """
    path = move.points_mm.tolist()
    path.insert(0, path[0] if start_mm is None else list(start_mm))
    steps = map(math.dist, path, path[1:])
    if move.arc is None:
        return sum(steps)
    diameter_mm = 2 * sum(math.dist(point[:2], move.arc.centre_mm) for point in path) / len(path)
    return sum(diameter_mm * math.asin(min(step / diameter_mm, 1.0)) for step in steps) if diameter_mm else 0.0


def distances(move: Move, here: np.ndarray | None) -> np.ndarray:
    """Return the path lengths [mm] to each point of a move, (n,).

    here: (3,) the tool's place. If it is None, the path begins at the first point.
    """
    # Nearly all moves have one point, for which arrays are slow.
    if len(move.points_mm) == 1 and here is not None and move.arc is None:
        return np.array([math.dist(here, move.points_mm[0])])
    path = np.vstack([move.points_mm[:1] if here is None else here[None], move.points_mm])
    steps = polylines.steps(path)
    if move.arc is not None:
        radius = np.linalg.norm(path[:, :2] - move.arc.centre_mm, axis=1).mean()
        steps = 2 * radius * np.arcsin(np.clip(steps / (2 * radius), 0, 1))
    return np.cumsum(steps)


def times_s(along_mm: np.ndarray, length_mm: float, speed_mm_s: float, cell: Cell) -> np.ndarray:
    """Return the times [s] at which a move reaches path lengths.

    The move is from rest to rest. The speed rises with the cell's acceleration, stays constant, and falls.

    along_mm: path lengths [mm].
    length_mm: length of the move [mm].
    """
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
