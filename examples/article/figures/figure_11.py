"""Figure 11: r and b against depth, from angles, without their points

The laws of section 3.3 as printed. Their b = 0.21 z contradicts the 0.52 z of the video: the intervals,
0.07 to 0.35 and 0.43 to 0.61, do not overlap. Noise does not explain it. Simulated series with b = 0.52 z
and angles that are 7 degrees off give the last two rows by Theorems 3 and 4.
"""

import numpy as np
from matplotlib.figure import Figure

from brushsvg import laws

z = np.arange(1, 11.0)
canvas, angles = ([3.1, 0.86, 0.31, -5.0e-2, 2.1e-3], [3.4, 1.39, 0.047, -4.56e-3, -4.56e-4])
figure = Figure(figsize=(8, 3), layout="constrained")
left, right = figure.subplots(1, 2)
fine = np.linspace(0, 10, 101)
for words, lag, k, half in (
    ("angles, (27)", angles, 0.21, 0.14),
    ("canvas and video, (26)", canvas, 0.52, 0.09),
):
    left.plot(fine, laws.Profile(lag)(fine), label=words)
    right.plot(fine, k * fine, label=words)
    right.fill_between(fine, (k - half) * fine, (k + half) * fine, alpha=0.2, lw=0)
for axes, title in ((left, "(a) r"), (right, "(b) b, with 95 %")):
    axes.set(title=title, xlabel="z, mm", ylabel="mm")
    axes.legend(frameon=False, fontsize=8)
rng, repeats = np.random.default_rng(1), 200
r, b = laws.Profile(canvas)(z)[:, None], 0.52 * z[:, None]
s = np.linspace(0.2, 1.0, 5) * r
alpha = laws.alpha_after(np.pi / 2, s, r)
beta = laws.tip_direction(np.pi / 2, alpha, s, r, b)
seen = [angle + rng.normal(0, np.radians(7), (repeats, 10, 5)) for angle in (alpha, beta)]
first = np.minimum(np.pi / 2 + rng.normal(0, np.radians(7), (repeats, 10)), np.radians(95))
found = laws.from_angles(first, s, seen[0], np.clip(seen[1], 0.02, np.pi - 0.02))
k = [laws.fit_law(z, one, 1, through_zero=True, absolute=True).law.coefficients[1] for one in found.tip_gap_mm]
rmse = np.array([laws.fit_law(z, one, 4, absolute=True).law.rmse_mm for one in found.lag_mm], float)
rows = [
    ("r(10), mm; 12.9 is (25)'s 13.0 by other means", None, laws.Profile(angles)(10.0)),
    ("RMSE of r, angles off by 7 degrees, median, mm", 1.98, np.median(rmse)),
    ("k_b then, median", 0.21, np.median(k)),
    ("share of k_b at or below 0.21", None, np.mean(np.array(k) <= 0.21)),
]
