"""Figure 10: w, r and b against depth, from canvas and video, without their points

The laws (24), (25) and (26) as printed, with a band of their RMSE. The points are not printed. p1 of (25)
is printed as 2.1e-4, and r would then be negative from a depth of 9.2 mm on (dotted). 2.1e-3 gives 13.7 mm
at a depth of 10, where section 3.4 works with 13.0. The printed digits are rounded, which alone allows 1.6
mm there.
"""

import numpy as np
from matplotlib.figure import Figure

from brushsvg import laws

z = np.linspace(0, 10, 201)
w = laws.Profile([-2.35, 2.75, -0.42, 0.024], floor=0)
r = laws.Profile([3.1, 0.86, 0.31, -5.0e-2, 2.1e-3])
r_printed = [3.1, 0.86, 0.31, -5.0e-2, 2.1e-4]
b_video, b_canvas = laws.Profile([0, 0.52]), laws.Profile([0, 0.46])
figure = Figure(figsize=(8, 3), layout="constrained")
panels = figure.subplots(1, 3)
for axes, law, rmse, name in zip(panels, (w, r, b_video), (0.51, 0.58, 0.85), "wrb", strict=True):
    axes.fill_between(z, law(z) - rmse, law(z) + rmse, color="#3f8fd9", alpha=0.25, lw=0)
    axes.plot(z, law(z), color="#2b3a67")
    axes.set(title=name, xlabel="z, mm", ylabel="mm")
panels[1].plot(z, np.polynomial.polynomial.polyval(z, r_printed), ":", color="#d1495b", label="as printed")
panels[2].plot(z, b_canvas(z), color="#4c9f70", label="from the canvas")
for axes in panels[1:]:
    axes.legend(frameon=False, fontsize=8)
halves = np.array([0.05, 0.005, 0.005, 0.0005, 0.00005])  # of the last printed digit
rows = [
    ("r(10), p1 read as 2.1e-3, mm", 13.0, r(10.0)),
    ("r(10), p1 as printed, mm", 13.0, np.polynomial.polynomial.polyval(10, r_printed)),
    ("what rounding of the digits leaves open at r(10), mm", None, halves @ 10.0 ** np.arange(5)),
    ("w(10), mm; the paint reached 7 mm up", 7.0, w(10.0)),
]
