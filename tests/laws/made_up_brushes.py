"""Brushes, plans and strokes that the law tests share."""

import numpy as np
import oracle

LAGS = {  # name: (coefficients, floor, floor_slope)
    "round": ([3.1, 0.86, 0.31, -5.0e-2, 2.1e-3], -np.inf, 0.0),
    "constant": ([3.0], -np.inf, 0.0),
    "small near 0": ([0.0, 0.8], -np.inf, 0.0),
    "not monotonic": ([1.0, 2.4, -0.5, 0.03], -np.inf, 0.0),
    "floor": ([-2.35, 2.75, -0.42, 0.024], 0.5, 0.1),
}


def law(name):
    return oracle.Law(*LAGS[name])


def random_poses(rng, moves, deepest=9.5, lifts=False, steep=True):
    """A pass (n, 3): landing at z = 0 moving or not, corners, reversals, presses in place, a lift."""
    xy, depth, heading = np.zeros(2), 0.0, rng.uniform(-np.pi, np.pi)
    poses = [[*xy, 0.0]]
    for k in range(moves):
        kind = rng.choice(["turn", "corner", "back", "press"], p=[0.45, 0.25, 0.15, 0.15])
        if kind == "press" or (k == 0 and rng.random() < 0.5):
            length = 0.0
        else:
            length = rng.choice([rng.uniform(0.3, 2.0), rng.uniform(2.0, 14.0)])
        heading += {
            "turn": rng.uniform(-0.5, 0.5),
            "corner": rng.uniform(-np.pi, np.pi),
            "back": np.pi,
            "press": 0,
        }[kind]
        if rng.random() < 0.8:
            reach = deepest if steep else min(deepest, 0.3 * length)
            depth = np.clip(depth + rng.uniform(-1, 1) * reach, 0.2, deepest)
        if k == 0:
            depth = max(depth, 1.0)
        xy = xy + length * oracle.unit(heading)
        poses.append([*xy, -depth])
        if lifts and k == moves // 2:  # up through the paper and down again, both inside a move
            for z in (2.0, 1.0, -3.0):
                heading += rng.uniform(-1, 1)
                xy = xy + rng.uniform(3, 6) * oracle.unit(heading)
                poses.append([*xy, z])
            depth = 3.0
    poses.append([*xy, 0.0])
    return np.array(poses)


def profile(coefficients, floor=-np.inf, floor_slope=0.0):
    from brushsvg._core import Profile

    return Profile(coefficients=list(coefficients), floor=floor, floor_slope=floor_slope)


def make_brush(
    lag=LAGS["round"], tip_gap=(0.0, 0.52), footprints=None, pressed=(), half_width=(0.0, 0.42), name="made"
):
    """A brush with the footprints of the article's brush unless others are given, over depths 0 to 10 mm."""
    from brushsvg._core import Brush, Footprint, FootprintTable

    lag = lag if isinstance(lag, tuple) else (lag, -np.inf, 0.0)
    brush = Brush()
    brush.name, brush.kind, brush.depth_range_mm = name, "round", (0.0, 10.0)
    brush.lag, brush.tip_gap = profile(*lag), profile(tip_gap)
    brush.tip_to_widest = profile([-2.35, 2.75, -0.42, 0.024], 0.0, 0.126)
    brush.half_width = profile(half_width)
    brush.footprints = FootprintTable(
        dragged=[Footprint(d, o) for d, o in footprints or section_6_footprints()],
        pressed=[Footprint(d, o) for d, o in pressed],
    )
    return brush


WIDEST = oracle.Law([-2.35, 2.75, -0.42, 0.024], 0.0, 0.126)


def section_6_footprints():
    """[(depth, outline (65, 2))] at depths 1 to 10, the shipped round brush's recipe."""
    return [(float(d), oracle.section_6_outline(float(WIDEST(d)), 0.42 * d)) for d in range(1, 11)]


def make_pass(poses, stroke="s"):
    from brushsvg._core import Pass

    return Pass(stroke=stroke, poses_mm=np.asarray(poses, float), speed_mm_s=20.0)


def make_plan(*all_poses):
    from brushsvg._core import Plan

    return Plan(
        brush="made",
        brush_sha256="",
        sheet_mm=(100.0, 100.0),
        passes=[make_pass(p, f"s{i}") for i, p in enumerate(all_poses)],
    )
