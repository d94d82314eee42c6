"""Program + Marks -> where tool and brush are at every time: what an animation shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import Error
from ..machine.motion import Move, Program, Section, Wait, distances, settling_s, times_s

HAND_PAUSE_S = 3.0  # a wait for a person is shown for so long: enough to read the instruction
# Parts of a move in the air at which its time is taken: a straight line between them hides the ramps otherwise.
PARTS = np.array([0.01, 0.04, 0.1, 0.9, 0.96, 0.99, 1.0])


@dataclass(frozen=True)
class Chapter:
    """Rows from first_row on, up to the next chapter's: one stroke, or one visit to the paint (trace None).

    trace: which pass of the plan and the marks it is, from 0.
    """

    title: str
    first_row: int
    trace: int | None


@dataclass(frozen=True)
class Pause:
    """The program waits for a person."""

    start_s: float
    end_s: float
    message: str


@dataclass(frozen=True)
class Timeline:
    """Parallel rows in the order of time, between which everything is straight. mm, rad, s, the paper's frame.

    time_s (n,) ascends, from 0; tcp_mm (n, 3); contact_mm (n, 2), heading_rad, depth_mm and pull (n,) as in Marks,
    nan where the brush is in the air.
    """

    time_s: np.ndarray
    tcp_mm: np.ndarray
    contact_mm: np.ndarray
    heading_rad: np.ndarray
    depth_mm: np.ndarray
    pull: np.ndarray
    chapters: tuple[Chapter, ...]
    pauses: tuple[Pause, ...]


def timeline(program: Program, marks) -> Timeline:
    """The rows of a whole program; marks: one pass for each of its strokes, in order. Times as in duration_s, and
    HAND_PAUSE_S for each wait for a person. Error when nothing moves."""
    traces = iter(enumerate(marks.passes))
    blocks, chapters, pauses = [], [], []
    now_s, here, rows = 0.0, None, 0
    for section in program.sections():
        number, trace = next(traces) if _is_stroke(section) else (None, None)
        chapters.append(Chapter(section.title, rows, number))
        first = 0  # pose that the tool has reached
        for step in section.steps:
            if isinstance(step, Wait):
                block = None if here is None else _standing(step, here)
                if step.seconds is None:
                    pauses.append(Pause(now_s, now_s + HAND_PAUSE_S, step.message))
            elif step.meaning == "paint":
                block = _painting(step, here, trace, first, program)
                first += len(step.points_mm)
            else:
                block = _in_the_air(step, here, program)
                if step.meaning == "land":
                    block = np.vstack([block, _touching(trace, block[-1])])
            if block is None:
                continue
            if not isinstance(step, Wait) and (stands_s := settling_s(step, here, program.cell)):
                block = np.vstack([block, block[-1:]])
                block[-1, 0] += stands_s
            block[:, 0] += now_s
            blocks.append(block)
            rows += len(block)
            now_s, here = block[-1, 0], block[-1, 1:4]
    if not rows:
        raise Error("there is nothing to play", code="nothing-to-show")
    table = np.vstack(blocks)
    return Timeline(
        time_s=table[:, 0],
        tcp_mm=table[:, 1:4],
        contact_mm=table[:, 4:6],
        heading_rad=table[:, 6],
        depth_mm=table[:, 7],
        pull=table[:, 8],
        chapters=tuple(chapters),
        pauses=tuple(pauses),
    )


def _is_stroke(section: Section) -> bool:
    return not section.steps or any(move.meaning == "land" for move in section.moves)


def _rows(time_s, tcp_mm, brush=np.nan) -> np.ndarray:
    """(n, 9) time from the step's start, TCP, contact, heading, depth, pull."""
    table = np.full((len(time_s), 9), np.nan)
    table[:, 0], table[:, 1:4], table[:, 4:] = time_s, tcp_mm, brush
    return table


def _standing(wait: Wait, here: np.ndarray) -> np.ndarray:
    return _rows([HAND_PAUSE_S if wait.seconds is None else wait.seconds], here)


def _in_the_air(move: Move, here: np.ndarray | None, program: Program) -> np.ndarray:
    path = np.vstack([move.points_mm[:1] if here is None else here, move.points_mm])
    along_mm = np.concatenate([[0.0], distances(move, here)])
    at_mm = along_mm if here is None else np.union1d(along_mm, along_mm[-1] * PARTS)
    time_s = times_s(at_mm, along_mm[-1], move.speed_mm_s, program.cell)
    return _rows(time_s, np.column_stack([np.interp(at_mm, along_mm, axis) for axis in path.T]))


def _brush(trace, chosen: np.ndarray) -> np.ndarray:
    """(n, 5) contact, heading, depth, pull of the chosen rows of a trace."""
    columns = (np.asarray(trace.contact_mm), trace.heading_rad, trace.depth_mm, trace.pull)
    table = np.column_stack([np.asarray(column)[chosen] for column in columns])
    table[table[:, 3] < 0] = np.nan  # lifted
    return table


def _touching(trace, landed: np.ndarray) -> np.ndarray:
    """What the brush does at the first pose, once the tool is there."""
    brush = _brush(trace, np.asarray(trace.pose) <= 0)
    return _rows(np.full(len(brush), landed[0]), landed[1:4], brush)


def _painting(move: Move, here: np.ndarray, trace, first: int, program: Program) -> np.ndarray:
    """The rows of the trace on the way from pose first through the move's points."""
    pose = np.asarray(trace.pose)
    chosen = (pose > first) & (pose <= first + len(move.points_mm))
    along_mm = np.concatenate([[0.0], distances(move, here)])
    if not chosen.any():  # a servo that moves on the spot: the trace has no row of its own for it
        time_s = times_s(along_mm[-1:], along_mm[-1], move.speed_mm_s, program.cell)
        return _rows(time_s, move.points_mm[-1], _brush(trace, np.flatnonzero(pose <= first)[-1:]))
    heights_mm = np.concatenate([here[2:], move.points_mm[:, 2]])
    numbers = first + np.arange(len(along_mm))
    at_mm, z_mm = (np.interp(pose[chosen], numbers, column) for column in (along_mm, heights_mm))
    time_s = times_s(at_mm, along_mm[-1], move.speed_mm_s, program.cell)
    # the trace knows the arcs between poses, too
    tcp_mm = np.column_stack([np.asarray(trace.tcp_mm)[chosen], z_mm])
    return _rows(time_s, tcp_mm, _brush(trace, chosen))
