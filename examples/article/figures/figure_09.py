"""Figure 9: footprints

Our own illustration: the article prints photographs of footprints, without outlines and widths. These are
the assumed outlines of `round-6`, with straight flanks from the tip to the widest section, and half an
ellipse in front. Only the place of the widest section is the article's, (24). The paint reached 7 mm up the
bristles, so the footprints should not be longer.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

brush = brushsvg.find_brush("round-6")
figure = Figure(figsize=(8, 1.5), layout="constrained")
axes = figure.subplots()
for k, shape in enumerate(brush.footprints.dragged):
    x, y = shape.outline_mm.T
    axes.fill(y + 9 * k, x, color="#2b3a67")
    axes.text(9 * k, -1.2, f"{shape.depth_mm:g}", ha="center", va="top")
axes.set(aspect="equal", ylabel="mm", xticks=[], ylim=(-3, None), xlabel="depth, mm")
longest = max(np.ptp(shape.outline_mm[:, 0]) for shape in brush.footprints.dragged)
rows = [("longest footprint, mm", 7.0, longest)]
