"""Search globally for the best possible painting of a stroke.

The poses of a plan are moved in x, y and depth by cubic B-splines along the tool's way; CMA-ES (the package
`cma`) searches for the mark with the largest overlap. It knows the brush only by its simulation. It starts
from the plan in closed form with wide steps, and from the refined plan with narrower steps. Its result is a
lower bound of the best possible overlap, and better than all other methods here.
"""

from __future__ import annotations

import itertools

import cma
import numpy as np
from scipy.interpolate import BSpline

from brushsvg import _core

CONTROLS = 8
EVERY_MM = 1.5  # distance of poses, since a spline bends between the poses of a plan
STARTS = (("closed", 1.0), ("refined", 0.3))  # the start and its first step [mm]
WINDOW_PX = 6.0  # per mm
ROUND_MM = 2.0  # paper around both marks, for marks that move outwards


def search(stroke, target, brush, tries: int, seed: int) -> dict[str, float]:
    """Return the overlaps of the report: closed, refined and the best one found.

    tries is the number of simulations from each start.
    """
    found, best, most = {}, None, -1.0
    for method, step_mm in STARTS:
        start = _core.compensate([stroke], brush, None, method).plan.passes[0]
        found[method] = reported(start, target, brush)
        moved = searched(start, target, brush, step_mm, tries, seed)
        for each in (start, moved):
            overlap = reported(each, target, brush)
            if overlap > most:
                best, most = each, overlap
    assert best is not None
    return found | {"found": most}


def reported(a_pass, target, brush) -> float:
    (trace,) = _core.simulate(plan_of(a_pass, brush), brush).passes
    return _core.common_area([trace], [target], brush).overlap


def plan_of(a_pass, brush):
    plan = _core.Plan()
    plan.brush, plan.sheet_mm, plan.passes = brush.name, (400.0, 400.0), [a_pass]
    return plan


def searched(start, target, brush, step_mm: float, tries: int, seed: int):
    poses = close_together(np.asarray(start.poses_mm))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(poses, axis=0), axis=1))])
    knots = np.concatenate([[0.0] * 3, np.linspace(0.0, 1.0, CONTROLS - 2), [1.0] * 3])
    splines = BSpline.design_matrix(along / along[-1], knots, 3).toarray()
    painted = _core.painted_bounds(_core.simulate(plan_of(start, brush), brush).passes[0], brush)
    points = np.vstack([*_core.target_outline(target, 0.01), np.reshape(painted, (2, 2))])
    low, size = points.min(axis=0) - ROUND_MM, np.ptp(points, axis=0) + 2 * ROUND_MM
    window = (*low.tolist(), *size.tolist())
    drawn = _core.target_coverage([target], window, WINDOW_PX)

    def moved(x: np.ndarray):
        out = poses + splines @ x.reshape(CONTROLS, 3)
        out[:, 2] = np.clip(out[:, 2], -brush.depth_range_mm[1], 0.0)
        out[[0, -1], 2] = 0.0
        return _core.Pass(start.stroke, out, start.speed_mm_s)

    def worse(x: np.ndarray) -> float:
        marks = _core.simulate(plan_of(moved(x), brush), brush, tolerance_mm=0.05)
        painted = _core.coverage(marks, brush, window, WINDOW_PX)
        return 1.0 - float(np.minimum(painted, drawn).sum() / np.maximum(painted, drawn).sum())

    options = {"maxfevals": tries, "seed": seed, "verbose": -9, "tolfun": 1e-5}
    done, _ = cma.fmin2(worse, np.zeros(3 * CONTROLS), step_mm, options)
    return moved(done)


def close_together(poses: np.ndarray) -> np.ndarray:
    rows = [poses[:1]]
    for a, b in itertools.pairwise(poses):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / EVERY_MM)))
        rows.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.vstack(rows)
