"""Figure 2: the patch, its centre of friction, the handle and the tip

Our own illustration, with `round-6` at a depth of 5 mm. The lag r is the distance from the centre of
friction p to the handle q. The gap b is the distance from the tip to p. Right: the brush is dragged along
x, shown every 2 mm. The outline of the patch is assumed, because the article prints no shapes.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg
from brushsvg import laws

brush, depth = brushsvg.find_brush("round-6"), 5.0
r, b, w = (float(law(depth)) for law in (brush.lag, brush.tip_gap, brush.tip_to_widest))
outline = next(shape.outline_mm for shape in brush.footprints.dragged if shape.depth_mm == depth)
figure = Figure(figsize=(8, 3.2), layout="constrained")
left, right = figure.subplots(1, 2)
left.fill(*outline.T, color="#c9d3e8")
for x, name in ((0, "tip"), (b, "p"), (w, "widest"), (r + b, "q")):
    left.plot(x, 0, "o", color="#2b3a67")
    left.annotate(name, (x, 0), (0, 8 if name != "p" else -14), textcoords="offset points", ha="center")
left.annotate("", (b, -3), (r + b, -3), arrowprops={"arrowstyle": "<->"})
left.text(b + r / 2, -2.9, "r", ha="center", va="bottom")
left.set_ylim(-4, 3)
for s in np.arange(0, 17, 2.0):
    alpha = laws.alpha_after(np.pi / 2, s, r)
    turn = np.array([[np.cos(alpha), np.sin(alpha)], [-np.sin(alpha), np.cos(alpha)]])
    tip = laws.tip_offset(alpha, r, b) + np.array([s, 0])
    right.fill(*(outline @ turn + tip).T, color="#2b3a67", alpha=0.15)
    right.plot(s, 0, "k.", ms=4)
for axes in (left, right):
    axes.set(aspect="equal", xlabel="mm", ylabel="mm")
rows = [("r at depth 5 mm", None, r), ("b", None, b), ("w", None, w)]
