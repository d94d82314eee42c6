"""Figure 6: strokes to calibrate a brush from, and what a ruler reads from them

Our own illustration: both strokes are simulated with `round-6` at a depth of 6 mm, and read as section 2.4
says. "Printed" is the value that the article's reading gives, and "ours" is the brush's own value. The
middle of the mark follows the widest section, so the corner shows r - e, with e = w - b. (17) as printed
lacks the lag: it gives r + b.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

brush, d = brushsvg.find_brush("round-6"), 6.0
r, b, w = (float(law(d)) for law in (brush.lag, brush.tip_gap, brush.tip_to_widest))
ways = {
    "straight": [[-90, 40, 0], [-30, 40, -d], [30, 40, -d], [30, 40, 0]],  # 0.1 mm deeper per mm
    "angular": [[-90, 0, 0], [-80, 0, -d], [0, 0, -d], [0, 30, -d], [0, 30, 0]],
}
passes = [brushsvg.Pass(name, np.array(way, float), 20.0) for name, way in ways.items()]
marks = brushsvg.simulate(brushsvg.Plan("round-6", "", (300, 300), passes), brush)
brushsvg.trace_outlines(marks, brush)
figure = Figure(figsize=(8, 3.6), layout="constrained")
axes = figure.subplots()
for (name, way), mark in zip(ways.items(), marks.passes, strict=True):
    for ring in mark.outline_mm:
        axes.fill(*ring.T, color="#2b3a67", alpha=0.8)
    axes.plot(*np.array(way)[:, :2].T, color="#d1495b", label="handle" if name == "straight" else None)
axes.set(aspect="equal", xlabel="mm", ylabel="mm")
axes.legend(frameon=False)
straight, angular = marks.passes
turning = int(np.argmax(angular.pose >= 2))  # where the handle turns
e = w - b
seen = -(angular.contact_mm[turning, 0] + e * np.cos(angular.heading_rad[turning]))
ring = max(straight.outline_mm, key=len)
upper = ring[ring[:, 1] > 40]
widest = upper[upper[:, 1] >= upper[:, 1].max() - 1e-3, 0].min()
by_17 = 60 - (widest - ring[:, 0].min()) + w
rows = [("r from the angular stroke, mm", seen, r), ("b from the straight stroke by (17), mm", by_17, b)]
rows += [("the same minus r, mm", by_17 - r, b)]
