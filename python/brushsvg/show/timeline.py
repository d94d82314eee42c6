"""Compute where tool and brush are at every time, from a program and its marks, for an animation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import Error
from ..machine.moves import Move, Program, Section, Wait, distances, settling_s, times_s

HAND_PAUSE_S = 3.0  # shown for a wait for a person: enough to read the instruction
# Shares of a move in the air at which its time is computed. With fewer, straight lines between them hide the ramps.
AIR_SAMPLE_SHARES = np.array([0.01, 0.04, 0.1, 0.9, 0.96, 0.99, 1.0])


@dataclass(frozen=True)
class Chapter:
    """The rows of one stroke, or of one visit to the paint.

    first_row: first row of the chapter, which ends where the next one begins; trace: number of the stroke's pass in the
    plan and the marks, from 0; None for a visit to the paint.
    """

    title: str
    first_row: int
    trace: int | None


@dataclass(frozen=True)
class Pause:
    """A time in which the program waits for a person."""

    start_s: float
    end_s: float
    message: str


@dataclass(frozen=True)
class Timeline:
    """Parallel rows in the order of time, with linear motion between them.

    Units are mm, rad and s, in the paper's frame. time_s: (n,), ascends from 0; tcp_mm: (n, 3); contact_mm (n, 2),
    heading_rad, depth_mm and pull (n,): as in Marks, nan where the brush is in the air.
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
    """Compute the timeline of a whole program.

    marks: one pass for each of the program's strokes, in order. Times are those of duration_s, plus HAND_PAUSE_S for
    each wait for a person. Raises Error when nothing moves.
    """
    traces = iter(enumerate(marks.passes))
    blocks, chapters, pauses = [], [], []
    now_s, last_tcp_mm, rows = 0.0, None, 0
    for section in program.sections():
        number, trace = next(traces) if _is_stroke(section) else (None, None)
        chapters.append(Chapter(section.title, rows, number))
        first_pose = 0  # number of the pose that the tool has reached
        for step in section.steps:
            if isinstance(step, Wait):
                block = None if last_tcp_mm is None else _waiting_rows(step, last_tcp_mm)
                if step.seconds is None:
                    pauses.append(Pause(now_s, now_s + HAND_PAUSE_S, step.message))
            elif step.meaning == "paint":
                block = _painting_rows(step, last_tcp_mm, trace, first_pose, program)
                first_pose += len(step.points_mm)
            else:
                block = _air_rows(step, last_tcp_mm, program)
                if step.meaning == "land":
                    block = np.vstack([block, _landing_rows(trace, block[-1])])
            if block is None:
                continue
            if not isinstance(step, Wait) and (settling_time_s := settling_s(step, last_tcp_mm, program.cell)):
                block = np.vstack([block, block[-1:]])
                block[-1, 0] += settling_time_s
            block[:, 0] += now_s
            blocks.append(block)
            rows += len(block)
            now_s, last_tcp_mm = block[-1, 0], block[-1, 1:4]
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


def _timeline_rows(time_s, tcp_mm, brush=np.nan) -> np.ndarray:
    """Return rows (n, 9): time from the step's start, TCP, contact, heading, depth, pull."""
    table = np.full((len(time_s), 9), np.nan)
    table[:, 0], table[:, 1:4], table[:, 4:] = time_s, tcp_mm, brush
    return table


def _waiting_rows(wait: Wait, start_mm: np.ndarray) -> np.ndarray:
    return _timeline_rows([HAND_PAUSE_S if wait.seconds is None else wait.seconds], start_mm)


def _air_rows(move: Move, start_mm: np.ndarray | None, program: Program) -> np.ndarray:
    path = np.vstack([move.points_mm[:1] if start_mm is None else start_mm, move.points_mm])
    along_mm = np.concatenate([[0.0], distances(move, start_mm)])
    at_mm = along_mm if start_mm is None else np.union1d(along_mm, along_mm[-1] * AIR_SAMPLE_SHARES)
    time_s = times_s(at_mm, along_mm[-1], move.speed_mm_s, program.cell)
    return _timeline_rows(time_s, np.column_stack([np.interp(at_mm, along_mm, axis) for axis in path.T]))


def _brush_columns(trace, chosen: np.ndarray) -> np.ndarray:
    """Return contact, heading, depth and pull (n, 5) in the chosen rows of a trace."""
    columns = (np.asarray(trace.contact_mm), trace.heading_rad, trace.depth_mm, trace.pull)
    table = np.column_stack([np.asarray(column)[chosen] for column in columns])
    table[table[:, 3] < 0] = np.nan  # lifted
    return table


def _landing_rows(trace, landed: np.ndarray) -> np.ndarray:
    """Return the rows in which the brush touches the paper. In these rows the tool is at the first pose."""
    brush = _brush_columns(trace, np.asarray(trace.pose) <= 0)
    return _timeline_rows(np.full(len(brush), landed[0]), landed[1:4], brush)


def _painting_rows(move: Move, start_mm: np.ndarray, trace, first_pose: int, program: Program) -> np.ndarray:
    """Return the rows of the trace from pose first_pose through the move's points."""
    pose = np.asarray(trace.pose)
    chosen = (pose > first_pose) & (pose <= first_pose + len(move.points_mm))
    along_mm = np.concatenate([[0.0], distances(move, start_mm)])
    if not chosen.any():  # for a servo that moves on the spot, the trace has no row
        time_s = times_s(along_mm[-1:], along_mm[-1], move.speed_mm_s, program.cell)
        return _timeline_rows(
            time_s, move.points_mm[-1], _brush_columns(trace, np.flatnonzero(pose <= first_pose)[-1:])
        )
    heights_mm = np.concatenate([start_mm[2:], move.points_mm[:, 2]])
    numbers = first_pose + np.arange(len(along_mm))
    at_mm, z_mm = (np.interp(pose[chosen], numbers, column) for column in (along_mm, heights_mm))
    time_s = times_s(at_mm, along_mm[-1], move.speed_mm_s, program.cell)
    # The trace also follows the arcs between poses.
    tcp_mm = np.column_stack([np.asarray(trace.tcp_mm)[chosen], z_mm])
    return _timeline_rows(time_s, tcp_mm, _brush_columns(trace, chosen))
