"""Table: r, w and b with R^2, RMSE and 95 % intervals

The article prints no points, so these are fits to simulated ones: the printed law at the named depths, with
normal noise of the printed RMSE, the median of 300. The number of values is not printed either. The printed
intervals fit best with 17 values of r, 12 of b from the video, and 10 of all others. R^2 is then a check of
its own; +- shows how much it varies from sheet to sheet. One thing does not agree. For r from angles, the
intervals of z^0 and z^1 are narrower than the RMSE and the other intervals allow.
"""

import numpy as np
from matplotlib.figure import Figure

from brushsvg import laws

ten, both = np.arange(1, 11.0), np.array([*range(11), *range(0, 11, 2)], float)
video = np.linspace(1, 10, 12)
angular = (10, 16.13, 6.457, 0.8754, 0.0396)  # intervals of r
printed = [  # law, its intervals, R^2, RMSE, depths
    ("r, canvas", [3.1, 0.86, 0.31, -5e-2, 2.1e-3], (0.9, 1.57, 0.68, 0.103, 0.0051), 0.98, 0.58, both),
    ("w", [-2.35, 2.75, -0.42, 0.024], (), 0.98, 0.51, ten),
    ("b, video", [0, 0.52], (0, 0.09), 0.83, 0.85, video),
    ("b, canvas", [0, 0.46], (0, 0.11), 0.78, 0.95, ten),
    ("r, angles", [3.4, 1.39, 0.047, -4.56e-3, -4.56e-4], angular, 0.82, 1.98, ten),
    ("b, angles", [0, 0.21], (0, 0.14), 0.39, 1.21, ten),
]
rng = np.random.default_rng(1)
rows: list[tuple[str, float, float]] = []
figure = Figure(figsize=(8, 4.6), layout="constrained")
panels = figure.subplots(2, 3).flat
for axes, (name, law, halves, r2, rmse, z) in zip(panels, printed, strict=True):
    floor = 0.0 if name == "w" else None  # (24); laws that begin with 0 go through it
    exact = np.maximum(np.polynomial.polynomial.polyval(z, law), -np.inf if floor is None else floor)
    sheets = exact + rng.normal(0, rmse, (300, z.size))
    fits = [laws.fit_law(z, sheet, len(law) - 1, through_zero=law[0] == 0, floor_mm=floor) for sheet in sheets]
    found = np.array([fit.r_squared for fit in fits])
    rows.append((f"{name}: R^2, +-{found.std():.2f}", r2, np.median(found)))
    rows.append((f"{name}: RMSE, mm", rmse, np.median(np.array([fit.law.rmse_mm for fit in fits], float))))
    of_fits = np.median([fit.law.half_interval_95 for fit in fits], axis=0)
    for power, half in enumerate(halves):
        if half:
            rows.append((f"{name}: +- of z^{power}", half, of_fits[power]))
    for fit in fits[::30]:
        axes.plot(np.sort(z), fit.law(np.sort(z)), color="#3f8fd9", alpha=0.3)
    axes.plot(np.sort(z), exact[np.argsort(z)], "k")
    axes.set(title=name, xlabel="z, mm", ylabel="mm")
