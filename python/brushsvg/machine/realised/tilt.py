"""Limits and poses of a tilted brush on a cell."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...errors import Notice
from ..cells.cell import MOST_TILT_DEG, Cell
from ..tool_axes import axes_of, between_deg, normalize, tilts_deg
from .pass_on_path import move_pass_to_path

# Largest turn between two poses. A robot turns the tool evenly about one line in space. Within this step, the tool
# stays within 0.03 degrees of the prediction.
MAX_TURN_STEP_DEG = 2.0
# Largest distance of a move from its path. A move that goes d deeper and leans by s more is d s / 4 off in its middle.
MAX_TURN_OFFSET_MM = 0.005
MAX_VERTICAL_SIDEWAYS_MM = 1e-6  # the limit that simulate uses, too


def refuse_tilt_without_tool(passes, cell: Cell) -> None:
    """Raise Error for a tilted brush if the cell cannot tilt it."""
    if cell.tool is None:
        _core.refuse_tilted(passes, f"cell {cell.name} has no axes to tilt the brush with")


def split_turning_moves(a_pass):
    """Return a pass with more poses where the brush turns.

    A robot that moves and turns evenly between these poses follows the prediction. The point where the brush's axis
    meets the paper moves straight, and the lean changes evenly. In a turn on the spot, the tip stays in place.
    """
    axes = axes_of(a_pass)
    if axes is None or not _can_be_simulated(a_pass.poses_mm, axes):
        return a_pass
    poses, leans = np.asarray(a_pass.poses_mm, dtype=float), axes[:, :2] / axes[:, 2:]
    turns_deg = between_deg(axes[1:], axes[:-1])
    bends_mm = np.abs(np.diff(poses[:, 2])) * np.linalg.norm(np.diff(leans, axis=0), axis=1) / 4
    counts = np.maximum(np.ceil(turns_deg / MAX_TURN_STEP_DEG), np.ceil(np.sqrt(bends_mm / MAX_TURN_OFFSET_MM)))
    if (counts <= 1).all():
        return a_pass
    new_poses, new_leans = [poses[:1]], [leans[:1]]
    for k, count in enumerate(np.maximum(counts, 1).astype(int).tolist()):
        fractions = (np.arange(1, count + 1) / count)[:, None]
        lean = leans[k] + fractions * (leans[k + 1] - leans[k])
        points = poses[k] + fractions * (poses[k + 1] - poses[k])
        if np.hypot(*(poses[k + 1] - poses[k])[:2]) > MAX_VERTICAL_SIDEWAYS_MM:
            on_paper = poses[k : k + 2, :2] - leans[k : k + 2] * poses[k : k + 2, 2:]
            points[:, :2] = on_paper[0] + fractions * (on_paper[1] - on_paper[0]) + lean * points[:, 2:]
        points[-1], lean[-1] = poses[k + 1], leans[k + 1]
        new_poses.append(points)
        new_leans.append(lean)
    lean = np.vstack(new_leans)
    return move_pass_to_path(a_pass, np.vstack(new_poses), (), normalize(np.column_stack([lean, np.ones(len(lean))])))


def _can_be_simulated(poses: np.ndarray, axes: np.ndarray) -> bool:
    """Return whether simulate accepts the poses and axes."""
    finite = np.isfinite(poses).all() and np.isfinite(axes).all()
    return bool(finite and len(poses) == len(axes) and tilts_deg(axes).max() <= MOST_TILT_DEG + 1)


def limit_turning_speed(speed_mm_s: float, length_mm: float, turn_deg: float, cell: Cell) -> float:
    """Return the speed [mm/s], reduced if the tool would turn too fast.

    length_mm: length of the path on which the tool turns by turn_deg.
    """
    return min(speed_mm_s, length_mm * cell.tool.turn_deg_s / turn_deg) if turn_deg > 0 else speed_mm_s


def check_tilt_limits(a_pass, cell: Cell) -> list[Notice]:
    """Report a tilt, or a speed of turning, that is more than the cell allows.

    The poses must be finite.
    """
    axes = axes_of(a_pass)
    if axes is None or cell.tool is None:
        return []
    notices, name = [], a_pass.stroke
    most_deg, limit_deg = float(tilts_deg(axes).max()), cell.tool.tilt_limit_deg
    if most_deg > limit_deg + DIRECTION_ROUNDING_DEG:
        sentence = (
            f"the brush is tilted by {most_deg:.4g} degrees, outside the range [0, {limit_deg:g}] degrees of cell "
            f"{cell.name}"
        )
        notices.append(Notice(name, sentence, code="tilt-out-of-range"))
    poses = np.asarray(a_pass.poses_mm, dtype=float)
    lengths = np.linalg.norm(np.diff(poses, axis=0), axis=1)
    turns = np.maximum(between_deg(axes[1:], axes[:-1]) - DIRECTION_ROUNDING_DEG, 0.0)
    allowed = lengths * cell.tool.turn_deg_s / a_pass.speed_mm_s
    excess_deg = turns - allowed
    if len(excess_deg) and excess_deg[worst := int(excess_deg.argmax())] > 0:
        x, y, _ = poses[worst]
        turn, limit = turns[worst], cell.tool.turn_deg_s
        speed_text = (
            f"at {turn * a_pass.speed_mm_s / lengths[worst]:.4g} degrees/s, outside the range [0, {limit:g}] degrees/s "
            f"of cell {cell.name}"
            if lengths[worst] > MIN_TURN_LENGTH_MM
            else "on the spot, where a robot's speed does not limit how fast it turns"
        )
        sentence = f"near x {x:.1f}, y {y:.1f} mm the tool would turn {speed_text}"
        notices.append(
            Notice(
                name, sentence, code="tool-turns-too-fast", advice="paint more slowly, or turn it over a longer path"
            )
        )
    return notices


DIRECTION_ROUNDING_DEG = 1e-3  # effect of rounding on a direction
MIN_TURN_LENGTH_MM = 1e-3  # on a shorter path, the tool counts as standing still
