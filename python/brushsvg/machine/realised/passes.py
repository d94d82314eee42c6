"""Passes as an inexact machine runs them: play where an axis turns back, scale, lean, the paper's height."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ... import _core
from ..cells.cell import Machine
from .arc_chords import with_chords
from .distortion import has_lean, true_path_mm
from .retimed import on_way

STEP_MM = 0.4
STRAIGHT = 1e-7  # sine of the turn of two moves that are one
AIR_MM = 100.0  # above any height of the paper


def as_run(passes, machine: Machine, backlash_mm=(0.0, 0.0), deepest_mm: float = np.inf) -> list:
    """Return the part of commanded passes that is on the paper; those that never reach it are left out. deepest_mm:
    below, no depth counts. Error for a tilted brush, which no machine of ours holds."""
    _core.refuse_tilted(passes, "machines are simulated with the brush upright")
    out = []
    for one in with_play(passes, backlash_mm):
        poses = np.asarray(with_chords(one).poses_mm, dtype=float).reshape(-1, 3)
        if has_lean(machine):  # also on its way down to a pose below the true paper
            poses = np.vstack([poses[0] + (0, 0, AIR_MM), poses, poses[-1] + (0, 0, AIR_MM)])
        down = _on_paper(true_path_mm(poses, machine))
        if down is not None:
            down[:, 2] = np.maximum(down[:, 2], -deepest_mm)
            out.append(on_way(one, down, []))
    return out


def with_play(passes, backlash_mm) -> list:
    """Passes as machines run them whose x and y stay behind by half of so many mm, on the side that they come from: one
    after the other, in straight steps, from a place where both axes were in the middle of their play."""
    half = 0.5 * np.asarray(backlash_mm, dtype=float)
    if not half.any():
        return list(passes)
    out, behind, last = [], np.zeros(2), None
    for a_pass in passes:
        poses = in_steps(np.asarray(with_chords(a_pass).poses_mm, dtype=float).reshape(-1, 3))
        moves = np.diff(poses[:, :2], axis=0, prepend=poses[:1, :2] if last is None else last[None])
        last = poses[-1, :2]
        stays = np.column_stack([_behind(moves[:, k], half[k], behind[k]) for k in (0, 1)])
        run = poses - np.column_stack([stays, np.zeros(len(poses))])
        behind = stays[-1]
        out.append(on_way(a_pass, run[_turns(poses, stays)], []))
    return out


def _behind(moves: np.ndarray, half: float, at: float) -> list[float]:
    """By how much one axis stays behind after each move, mm."""
    found = []
    for move in moves.tolist():
        at = min(max(at + move, -half), half)
        found.append(at)
    return found


def _turns(poses: np.ndarray, stays: np.ndarray) -> np.ndarray:
    """Rows that a straight move does not pass anyway."""
    run = np.column_stack([poses[:, :2] - stays, poses[:, 2]])
    step = np.diff(run, axis=0)
    length = np.maximum(np.linalg.norm(step, axis=1), 1e-12)
    way = step / length[:, None]
    straight = np.linalg.norm(np.diff(way, axis=0), axis=1) < STRAIGHT
    return np.concatenate([[True], ~straight, [True]])


def in_steps(poses: np.ndarray) -> np.ndarray:
    """Poses (n, 3) with more of them on long moves."""
    rows = [poses[:1]]
    for a, b in pairwise(poses):
        parts = max(1, int(np.ceil(np.hypot(*(b - a)[:2]) / STEP_MM)))
        rows.append(a + (b - a) * (np.arange(1, parts + 1) / parts)[:, None])
    return np.vstack(rows)


def _on_paper(poses: np.ndarray) -> np.ndarray | None:
    """From where the tool touches the paper to where it leaves it; in between it stays there at least by its tip."""
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
