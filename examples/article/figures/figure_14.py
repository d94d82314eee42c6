"""Figure 14: a word that is written, and where the handle goes for it

With our own drawing, because the trajectory of the article's signature is not printed. (a) The path of the
handle, thin where it is in the air between strokes. (b) The simulated paint over the drawn lines.
"""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

import brushsvg

drawn = {
    "V": ("M8 62 C16 70 22 66 24 54 C26 38 28 26 30 12 C40 32 48 56 64 68", 3.6),
    "i": ("M58 42 C57 34 54 26 54 18 C54 10 62 10 70 22", 3.2),
    "n": ("M74 42 C73 32 71 22 70 12 C74 26 82 42 90 42 C98 42 92 24 93 16 C94 8 102 12 106 20", 3.2),
    "c": ("M124 36 C120 46 106 40 108 24 C110 8 120 10 128 18", 3.4),
    "e": ("M128 18 C140 24 146 32 140 40 C132 44 126 22 136 12 C144 8 152 18 160 34", 3.0),
}
strokes = [brushsvg.stroke_from_path(d, width, name) for name, (d, width) in drawn.items()]
brush = brushsvg.find_brush("round-6")
plan = brushsvg.compensate(strokes, brush, sheet_mm=(170, 80), few_poses=False).plan
marks = brushsvg.simulate(plan, brush)
brushsvg.trace_outlines(marks, brush)
figure = Figure(figsize=(8, 5.4), layout="constrained")
above, below = figure.subplots(2, 1, sharex=True, sharey=True)
whole = np.vstack([one.poses_mm for one in plan.passes])
above.plot(*whole[:, :2].T, "k", lw=0.5)
for one in plan.passes:
    above.plot(*one.poses_mm[:, :2].T, lw=2.5)
rings = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in marks.outline_mm]
below.add_patch(PathPatch(Path.make_compound_path(*rings), color="k", lw=0))
for stroke in strokes:
    below.plot(*brushsvg.flatten(stroke, 0.05)[:, :2].T, color="#d1495b", lw=0.8)
for axes, title in ((above, "(a) the handle"), (below, "(b) the paint, and what was drawn")):
    axes.set(aspect="equal", title=title, ylabel="mm", xlim=(0, 175), ylim=(0, 78))
below.set_xlabel("mm")
target = brushsvg.unite([ring for stroke in strokes for ring in brushsvg.target_outline(stroke, 0.02)])
rows = [("overlap of paint and drawing", None, brushsvg.overlap(marks.outline_mm, target))]
