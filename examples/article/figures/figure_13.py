"""Figure 13b: two thin angular strokes at z = 3 mm, simulated

The text gives the depth and says that the strokes are angular. The lengths are ours, and the outline of the
patch is assumed. The paint is black, as in the article. The red line is the handle's.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

brush, d = brushsvg.find_brush("round-6"), 3.0
ways = [
    [[0, 0, 0], [6, 0, -d], [45, 0, -d], [45, 28, -d], [45, 28, 0]],
    [[0, 40, 0], [6, 40, -d], [45, 40, -d], [45, 12 + 40, -d], [80, 12 + 40, -d], [80, 12 + 40, 0]],
]
passes = [brushsvg.Pass(f"s{k}", np.array(way, float), 20.0) for k, way in enumerate(ways)]
marks = brushsvg.simulate(brushsvg.Plan("round-6", "", (200, 200), passes), brush)
brushsvg.trace_outlines(marks, brush)
figure = Figure(figsize=(8, 4), layout="constrained")
axes = figure.subplots()
for way, mark in zip(ways, marks.passes, strict=True):
    for ring in mark.outline_mm:
        axes.fill(*ring.T, color="k")
    axes.plot(*np.array(way)[:, :2].T, color="#d1495b", lw=0.8)
axes.set(aspect="equal", xlabel="mm", ylabel="mm")
corner = marks.passes[0]
k = int(np.argmax(corner.pose >= 3))
rows = [
    ("r at z = 3 mm", None, brush.lag(d)),
    ("distance of p from the second line 28 mm after the turn, mm", None, 45 - corner.contact_mm[k, 0]),
]
