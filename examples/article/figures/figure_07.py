"""Figure 7: a brush that comes down while it sweeps, seen from the side

The article shows frames of a video. Our own illustration shows ferrule and tip of `round-6`, 2 mm apart for
each frame, and the tip gap by section 2.5 and (18). The noise is the article's: 0.85 mm for b, and 0.58 mm
for the lag. As printed, z_i has x coordinates and another sign. Here it is how far the ferrule came down.
d_0 contains r(0) + b(0), and r(0) = 3.1 mm is added back. Our +- is wider than the printed one, which takes
r as exact.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

brush, rng = brushsvg.find_brush("round-6"), np.random.default_rng(2)
depth = np.linspace(0, 10, 13)  # first touch, and twelve frames
behind = brush.lag(depth) + brush.tip_gap(depth)
ferrule = np.column_stack([2.0 * np.arange(depth.size), 40 - depth])
tip = np.column_stack([ferrule[:, 0] - behind, 0 * depth])
seen = tip + np.column_stack([rng.normal(0, 0.85, depth.size) * (depth > 0), 0 * depth])
z = np.arange(1, 11)
made = brushsvg.calibrate(
    {
        "video": [{"ferrule_mm": ferrule, "tip_mm": seen}],
        "lag": [{"depth_mm": d, "value_mm": brush.lag(d) + rng.normal(0, 0.58)} for d in [*z, *z[1::2]]],
        "width": [{"depth_mm": d, "value_mm": 2 * brush.half_width(d)} for d in z],
    },
    "seen from the side",
)
figure = Figure(figsize=(8, 3.4), layout="constrained")
left, right = figure.subplots(1, 2, width_ratios=(1.3, 1))
for f, t in zip(ferrule, tip, strict=True):
    left.plot(*zip(f, t, strict=True), color="0.8", lw=0.8)
left.plot(*ferrule.T, "ks", ms=4, label="ferrule")
left.plot(*seen.T, "ro", ms=4, label="tip, as read")
left.set(xlabel="x, mm", ylabel="z, mm", ylim=(-2, 48))
gap = made.fit.laws[1]
right.plot([p.depth_mm for p in gap.points], [p.value_mm for p in gap.points], "rs", ms=4, label="d - r")
right.plot(z, made.brush.tip_gap(z), color="#2b3a67", label="b, fitted")
right.plot(z, brush.tip_gap(z), "k--", lw=0.8, label="b of the brush")
right.set(xlabel="z, mm", ylabel="mm")
for axes in (left, right):
    axes.legend(frameon=False, fontsize=8)
assert gap.fit  # None of a law that is assumed
k, half = gap.fit.law.coefficients[1], gap.fit.law.half_interval_95[1]
rows = [("k_b", 0.52, k), ("its +-", 0.09, half), ("R^2", 0.83, gap.fit.r_squared)]
rows += [("RMSE, mm", 0.85, gap.fit.law.rmse_mm)]
