"""Measure the peak memory of `--compensation refined` over many short strokes.

The first part makes one call per hundred strokes and drops the plans, so memory must stay constant. The second part
makes one call for all strokes, which grows by the returned plan.
"""

from __future__ import annotations

import argparse
import resource
import time

import numpy as np

from brushsvg import _core, find_brush

SHEET_MM = (120.0, 120.0)
AT_ONCE = 100
LOOKS = 10


def strokes(count: int, seed: int) -> list:
    """Return bent lines of 5 to 20 mm."""
    random = np.random.default_rng(seed)
    made = []
    for k in range(count):
        at, heading, turn = random.uniform(40, 80, 2), random.uniform(0, 2 * np.pi), random.uniform(-0.5, 0.5)
        ways = [[np.cos(heading + f * turn), np.sin(heading + f * turn)] for f in range(3)]
        points = np.cumsum([at, *(random.uniform(2, 7) * np.array(way) for way in ways)], axis=0)
        made.append(_core.Stroke(f"s{k}", points.reshape(1, 8), half_width=[(0.0, random.uniform(0.8, 2.5))]))
    return made


def peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--method", default="refined")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    brush, begin, seen = find_brush("round-6"), time.monotonic(), []
    print(f"seed {options.seed}, {options.method}")
    for done in range(AT_ONCE, options.count + 1, AT_ONCE):
        _core.compensate(strokes(AT_ONCE, options.seed + done), brush, SHEET_MM, options.method)
        seen.append((done, peak_mb()))
        if done == AT_ONCE or done % max(1, options.count // LOOKS) == 0:
            print(
                f"  {done:7} strokes, peak {seen[-1][1]:7.1f} MB, {time.monotonic() - begin:6.0f} s",
                flush=True,
            )
    half = [mb for done, mb in seen if 2 * done <= options.count]
    growth = (seen[-1][1] - (half or [seen[0][1]])[-1]) / (0.5 * options.count)
    print(f"  grows by {1e3 * growth:.3f} kB a stroke over the second half")
    count = min(options.count, 1000)
    kept = _core.compensate(strokes(count, options.seed), brush, SHEET_MM, options.method).plan
    poses = sum(len(each.poses_mm) for each in kept.passes)
    print(f"  {count} in one call: peak {peak_mb():.1f} MB, {poses} poses")


if __name__ == "__main__":
    main()
