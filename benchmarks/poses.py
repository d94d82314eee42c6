"""Count the poses per stroke for a mark whose middle is within 0.05 mm of the line.

Three methods are compared: sampling every 0.5 mm, simplification of the tool's path, and ours. The simplification is
that of Douglas and Peucker in x, y and z. It has the largest tolerance whose mark is as exact as ours, in its middle
and its edges.

The program prints seed and counts. `--count N` sets the number of curves, and of strokes of characters. Characters
need `--lettering FOLDER`, the folder into which npm fetches them.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import brushsvg
from brushsvg import _core
from brushsvg.strokes.wide_shapes import within_reach

TOLERANCE_MM = 0.05
EVERY_MM = 0.5
LOOK_MM = 0.05
SHEET_MM = (400.0, 400.0)


def simplified(poses: np.ndarray, tolerance_mm: float) -> np.ndarray:
    """Simplify by Douglas and Peucker: keep the farthest pose beyond the tolerance."""
    stays = np.zeros(len(poses), bool)
    stays[[0, -1]] = True
    todo = [(0, len(poses) - 1)]
    while todo:
        first, last = todo.pop()
        if last - first < 2:
            continue
        chord = poses[last] - poses[first]
        between = poses[first + 1 : last] - poses[first]
        squared = float(chord @ chord)
        t = np.clip(between @ chord / squared, 0, 1) if squared > 0 else np.zeros(len(between))
        off = np.linalg.norm(between - t[:, None] * chord, axis=1)
        k = int(off.argmax())
        if off[k] > tolerance_mm:
            stays[first + 1 + k] = True
            todo += [(first, first + 1 + k), (first + 1 + k, last)]
    return poses[stays]


def errors_mm(a_pass, stroke, brush) -> tuple[float, float]:
    """Return the largest errors of a mark's middle, and of its half width while taut."""
    line = _core.flatten(stroke, 0.002)
    at = np.linspace(0.0, line[-1, 2], max(2, int(line[-1, 2] / LOOK_MM)))
    line = np.column_stack([np.interp(at, line[:, 2], line[:, k]) for k in (0, 1, 3)])
    (marks,) = _core.simulate(plan_of(a_pass, brush), brush, for_outlines=False).passes
    rows = np.flatnonzero(marks.taut)
    middle_mm = _core.tracking_error_of(a_pass, stroke, brush, TOLERANCE_MM).largest_mm
    if not len(rows):
        return middle_mm, 0.0
    taut = slice(rows[0], rows[-1] + 1)
    each = np.column_stack([_core.widest_points(marks, brush), marks.depth_mm])[taut]
    parts = np.linspace(0.0, 1.0, 8, endpoint=False)[:, None, None]
    each = np.concatenate([((1 - parts) * each[:-1] + parts * each[1:]).reshape(-1, 3), each[-1:]])
    near = cKDTree(line[:, :2]).query(each[:, :2])[1]
    painted = np.array([brush.half_width(depth) for depth in each[:, 2]])
    return middle_mm, float(np.abs(painted - line[near, 2]).max())


def plan_of(a_pass, brush):
    plan = _core.Plan()
    plan.brush, plan.sheet_mm, plan.passes = brush.name, SHEET_MM, [a_pass]
    return plan


def by_simplifying(stroke, brush, ours) -> int:
    """Return the number of poses of Douglas and Peucker for a mark as exact as ours."""
    plan = _core.compensate([stroke], brush, SHEET_MM, "closed", 0.005, few_poses=False).plan
    fine = np.asarray(plan.passes[0].poses_mm)
    (marks,) = _core.simulate(plan, brush, for_outlines=False).passes
    taut = np.array(marks.pose)[np.array(marks.taut, bool)]
    if not len(taut):
        return len(fine)
    first, last = int(np.ceil(taut[0])), int(taut[-1])  # landing and lift are equal in both
    limits = np.maximum(errors_mm(ours, stroke, brush), errors_mm(plan.passes[0], stroke, brush))
    low, high, fewest = 0.0, 1.0, len(fine)
    for _ in range(14):
        tolerance = 0.5 * (low + high)
        poses = np.vstack([fine[:first], simplified(fine[first : last + 1], tolerance), fine[last + 1 :]])
        found = errors_mm(_core.Pass(stroke.id, poses, 20.0), stroke, brush)
        if np.all(found <= limits + 1e-9):
            low, fewest = tolerance, min(fewest, len(poses))
        else:
            high = tolerance
    return fewest


def length_mm(poses) -> float:
    return float(np.linalg.norm(np.diff(np.asarray(poses), axis=0), axis=1).sum())


def curves(count: int, random) -> list:
    """Return chains of cubics like strokes of letters, with changing widths."""
    strokes = []
    for k in range(count):
        at, heading, cubics = np.array([200.0, 200.0]), random.uniform(-np.pi, np.pi), []
        for _ in range(int(random.integers(1, 5))):
            heading += random.choice([0.0, 0.0, random.uniform(-1.4, 1.4)])
            turn, length = random.uniform(-1.2, 1.2), random.uniform(8, 40)
            unit = [np.array([math.cos(heading + f * turn), math.sin(heading + f * turn)]) for f in range(3)]
            to = at + length * unit[1]
            cubics.append([at, at + 0.35 * length * unit[0], to - 0.35 * length * unit[2], to])
            at, heading = to, heading + 2 * turn
        half = random.uniform(0.5, 3.5, 3)
        knots = [(0.0, float(half[0])), (0.5, float(half[1])), (1.0, float(half[2]))]
        strokes.append(_core.Stroke(f"curve{k}", np.reshape(cubics, (-1, 8)), half_width=knots))
    return strokes


def characters(folder: Path, count: int, seed: int, brush) -> list:
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "integration"))
    from lettering import PACKAGES, Lettering
    from npm import fetched

    drawings = Lettering(fetched(folder, PACKAGES)).drawings(max(1, count // 10), seed)
    return [each for drawing in drawings for each in within_reach(brushsvg.strokes(drawing)[0], brush)[0]][:count]


def compared(title: str, strokes, brush) -> None:
    begin = time.process_time()
    ours = _core.compensate(strokes, brush, SHEET_MM, "closed", TOLERANCE_MM)
    seconds = time.process_time() - begin
    begin = time.process_time()
    _core.compensate(strokes, brush, SHEET_MM, "closed", TOLERANCE_MM, few_poses=False)
    without = time.process_time() - begin
    few = np.array([len(each.poses_mm) for each in ours.plan.passes])
    sampled = np.array([math.ceil(length_mm(each.poses_mm) / EVERY_MM) + 1 for each in ours.plan.passes])
    pairs = zip(strokes, ours.plan.passes, strict=True)
    thinned = np.array([by_simplifying(stroke, brush, a_pass) for stroke, a_pass in pairs])
    within = np.array([miss.within_tolerance for miss in ours.tracking_errors])
    print(f"{title}: {len(strokes)} strokes, of them {within.sum()} within {TOLERANCE_MM} mm, which are compared")
    few, sampled, thinned = few[within], sampled[within], thinned[within]
    for name, counts in (("every 0.5 mm", sampled), ("Douglas-Peucker", thinned), ("ours", few)):
        print(f"  {name:16} mean {counts.mean():6.1f}  median {np.median(counts):6.1f}")
    print(f"  ours / sampling {few.sum() / sampled.sum():.3f}, ours / Douglas-Peucker {few.sum() / thinned.sum():.3f}")
    print(f"  {1e3 * seconds / len(strokes):.2f} ms a stroke, {1e3 * without / len(strokes):.2f} without thinning out")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lettering", type=Path, metavar="FOLDER")
    args = parser.parse_args()
    brush = brushsvg.find_brush("round-6")
    print(f"seed {args.seed}")
    drawing = Path(__file__).parents[1] / "examples" / "vincent.svg"
    strokes, _ = brushsvg.strokes(brushsvg.read_drawing(drawing))
    compared("examples/vincent.svg", strokes, brush)
    compared("random curves", curves(args.count, np.random.default_rng(args.seed)), brush)
    if args.lettering:
        compared("Chinese characters", characters(args.lettering, args.count, args.seed, brush), brush)


if __name__ == "__main__":
    main()
