"""Passes as an inexact machine runs them.

The machine has backlash, scale and lean, and the paper has its true height.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ... import _core
from ..cells.cell import Machine
from .arc_chords import with_chords
from .distortion import has_lean, true_path_mm
from .pass_on_path import move_pass_to_path

MAX_STEP_MM = 0.4  # largest sideways length of a step with backlash
MAX_STRAIGHT_SINE = 1e-7  # sine of the largest turn between two moves that count as one
AIR_HEIGHT_MM = 100.0  # above the paper at any height


def as_run(passes, machine: Machine, backlash_mm=(0.0, 0.0), deepest_mm: float = np.inf) -> list:
    """Return the true paths of commanded passes, as far as they are on the paper.

    Passes that never reach the paper are left out.

    deepest_mm: larger depths are limited to this depth.

    Raises Error for a tilted brush, because inexact machines are modelled with the brush upright.
    """
    _core.refuse_tilted(passes, "a machine's errors are simulated only with the brush upright")
    runs = []
    for a_pass in passes_with_backlash(passes, backlash_mm):
        poses = np.asarray(with_chords(a_pass).poses_mm, dtype=float).reshape(-1, 3)
        if has_lean(machine):  # the tool also leans on its way down to a pose below the true paper
            poses = np.vstack([poses[0] + (0, 0, AIR_HEIGHT_MM), poses, poses[-1] + (0, 0, AIR_HEIGHT_MM)])
        path_on_paper = _clip_to_paper(true_path_mm(poses, machine))
        if path_on_paper is not None:
            path_on_paper[:, 2] = np.maximum(path_on_paper[:, 2], -deepest_mm)
            runs.append(move_pass_to_path(a_pass, path_on_paper, []))
    return runs


def passes_with_backlash(passes, backlash_mm) -> list:
    """Return passes as a machine with backlash runs them.

    The passes are run one after the other, in straight steps. Each axis stays behind by half of its backlash, on the
    side from which it comes. At the start, both axes are in the middle of their play.

    backlash_mm: backlash of x and y [mm].
    """
    half = 0.5 * np.asarray(backlash_mm, dtype=float)
    if not half.any():
        return list(passes)
    runs, lag, last = [], np.zeros(2), None
    for a_pass in passes:
        poses = split_long_moves(np.asarray(with_chords(a_pass).poses_mm, dtype=float).reshape(-1, 3))
        moves = np.diff(poses[:, :2], axis=0, prepend=poses[:1, :2] if last is None else last[None])
        last = poses[-1, :2]
        lags = np.column_stack([_axis_lags_mm(moves[:, k], half[k], lag[k]) for k in (0, 1)])
        run = poses - np.column_stack([lags, np.zeros(len(poses))])
        lag = lags[-1]
        runs.append(move_pass_to_path(a_pass, run[_bent_rows(poses, lags)], []))
    return runs


def _axis_lags_mm(moves: np.ndarray, half: float, lag: float) -> list[float]:
    """Return how far [mm] one axis stays behind after each move."""
    lags = []
    for move in moves.tolist():
        lag = min(max(lag + move, -half), half)
        lags.append(lag)
    return lags


def _bent_rows(poses: np.ndarray, lags: np.ndarray) -> np.ndarray:
    """Return which rows are needed because the path bends there."""
    run = np.column_stack([poses[:, :2] - lags, poses[:, 2]])
    step = np.diff(run, axis=0)
    length = np.maximum(np.linalg.norm(step, axis=1), 1e-12)
    way = step / length[:, None]
    is_straight = np.linalg.norm(np.diff(way, axis=0), axis=1) < MAX_STRAIGHT_SINE
    return np.concatenate([[True], ~is_straight, [True]])[: len(poses)]


def split_long_moves(poses: np.ndarray) -> np.ndarray:
    """Return poses (n, 3) with more poses on long moves."""
    rows = [poses[:1]]
    for a, b in pairwise(poses):
        parts = max(1, int(np.ceil(np.hypot(*(b - a)[:2]) / MAX_STEP_MM)))
        rows.append(a + (b - a) * (np.arange(1, parts + 1) / parts)[:, None])
    return np.vstack(rows)


def _clip_to_paper(poses: np.ndarray) -> np.ndarray | None:
    """Return a path from its first to its last touch, with the tip on the paper or below, or None."""
    down = np.flatnonzero(poses[:, 2] < 0)
    if not len(down):
        return None
    poses = poses[max(down[0] - 1, 0) : down[-1] + 2].copy()
    for end, inner in ((0, 1), (-1, -2)):
        if poses[end, 2] > 0:
            share = poses[inner, 2] / (poses[inner, 2] - poses[end, 2])
            poses[end] = poses[inner] + share * (poses[end] - poses[inner])
    poses[:, 2] = np.minimum(poses[:, 2], 0.0)
    return poses
