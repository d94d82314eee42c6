"""What a cell makes of a plan that tilts the brush: whether it can, how far, how fast, and with how many poses."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...errors import Notice
from ..cells.cell import MOST_TILT_DEG, Cell
from ..tool_axes import axes_of, between_deg, normalize, tilts_deg
from .retimed import on_way

# What a move is cut into, so that a robot between two poses keeps to what is predicted. Between two axes at most so far
# apart a robot, which turns the tool evenly about one line in space, holds it within 0.03 degrees as predicted.
STEP_DEG = 2.0
# A move that goes d deeper and leans by s more would go straight: off its way by d s / 4 in its middle.
OFF_MM = 0.005
ON_THE_SPOT_MM = 1e-6  # as simulate has it


def refuse_where_upright(passes, cell: Cell) -> None:
    """Error for a tilted brush where the cell cannot tilt it."""
    if cell.tool is None:
        _core.refuse_tilted(passes, f"cell {cell.name} has no axes to tilt the brush with")


def in_steps(a_pass):
    """The pass with poses so close where the brush turns that a robot that goes and turns evenly from each to the next
    keeps to what is predicted: the place where the brush's axis meets the paper goes straight, and its lean changes
    evenly. On the spot the tip stays where it is."""
    axes = axes_of(a_pass)
    if axes is None or not _are_sound(a_pass.poses_mm, axes):
        return a_pass
    poses, leans = np.asarray(a_pass.poses_mm, dtype=float), axes[:, :2] / axes[:, 2:]
    turns_deg = between_deg(axes[1:], axes[:-1])
    bends_mm = np.abs(np.diff(poses[:, 2])) * np.linalg.norm(np.diff(leans, axis=0), axis=1) / 4
    counts = np.maximum(np.ceil(turns_deg / STEP_DEG), np.ceil(np.sqrt(bends_mm / OFF_MM)))
    if (counts <= 1).all():
        return a_pass
    rows, leaning = [poses[:1]], [leans[:1]]
    for k, count in enumerate(np.maximum(counts, 1).astype(int).tolist()):
        at = (np.arange(1, count + 1) / count)[:, None]
        lean = leans[k] + at * (leans[k + 1] - leans[k])
        way = poses[k] + at * (poses[k + 1] - poses[k])
        if np.hypot(*(poses[k + 1] - poses[k])[:2]) > ON_THE_SPOT_MM:
            on_paper = poses[k : k + 2, :2] - leans[k : k + 2] * poses[k : k + 2, 2:]
            way[:, :2] = on_paper[0] + at * (on_paper[1] - on_paper[0]) + lean * way[:, 2:]
        way[-1], lean[-1] = poses[k + 1], leans[k + 1]
        rows.append(way)
        leaning.append(lean)
    lean = np.vstack(leaning)
    return on_way(a_pass, np.vstack(rows), (), normalize(np.column_stack([lean, np.ones(len(lean))])))


def _are_sound(poses: np.ndarray, axes: np.ndarray) -> bool:
    """Whether poses and axes are none that simulate refuses."""
    finite = np.isfinite(poses).all() and np.isfinite(axes).all()
    return bool(finite and len(poses) == len(axes) and tilts_deg(axes).max() <= MOST_TILT_DEG + 1)


def slow_enough(speed_mm_s: float, length_mm: float, turn_deg: float, cell: Cell) -> float:
    """The speed [mm/s], or so much less that the tool turns no faster on a way than it may."""
    return min(speed_mm_s, length_mm * cell.tool.turn_deg_s / turn_deg) if turn_deg > 0 else speed_mm_s


def broken_limits(a_pass, cell: Cell) -> list[Notice]:
    """A notice for a tilt, or a turn on the way, that is more than the cell allows. Poses are finite."""
    axes = axes_of(a_pass)
    if axes is None or cell.tool is None:
        return []
    found, name = [], a_pass.stroke
    most_deg, limit_deg = float(tilts_deg(axes).max()), cell.tool.tilt_limit_deg
    if most_deg > limit_deg + SLACK_DEG:
        sentence = (
            f"the brush is tilted by {most_deg:.4g} degrees, outside the range [0, {limit_deg:g}] degrees of cell "
            f"{cell.name}"
        )
        found.append(Notice(name, sentence, code="tilt-out-of-range"))
    poses = np.asarray(a_pass.poses_mm, dtype=float)
    lengths = np.linalg.norm(np.diff(poses, axis=0), axis=1)
    turns = np.maximum(between_deg(axes[1:], axes[:-1]) - SLACK_DEG, 0.0)
    allowed = lengths * cell.tool.turn_deg_s / a_pass.speed_mm_s
    over = turns - allowed
    if len(over) and over[worst := int(over.argmax())] > 0:
        x, y, _ = poses[worst]
        turn, limit = turns[worst], cell.tool.turn_deg_s
        how = (
            f"at {turn * a_pass.speed_mm_s / lengths[worst]:.4g} degrees/s, outside the range [0, {limit:g}] degrees/s "
            f"of cell {cell.name}"
            if lengths[worst] > TURNS_MM
            else "on the spot, where a robot's speed says nothing of how fast it turns"
        )
        sentence = f"near x {x:.1f}, y {y:.1f} mm the tool would turn {how}"
        found.append(
            Notice(
                name, sentence, code="tool-turns-too-fast", advice="paint slower, or turn it on a longer way"
            )
        )
    return found


SLACK_DEG = 1e-3  # what rounding makes of a direction
TURNS_MM = 1e-3  # on a shorter way it stands
