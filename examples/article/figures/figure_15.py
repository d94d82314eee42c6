"""Figure 15: strokes along Bezier curves

Our own curves, with widths in mm as numbers: the article prints no coordinates. (a) The handle in grey with
all poses, and the middle of the mark in colour. (b) The simulated paint in blue, and the target outline in
orange. All strokes go from bottom to top, as in the article.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

shapes = {
    2.0: "M15 10 C15 30 15 50 15 70",
    2.5: "M35 10 C55 30 15 50 35 70",
    3.0: "M60 10 C90 30 90 50 60 70",
    4.0: "M90 10 C120 20 90 60 120 70",
    5.0: "M135 10 C125 40 160 40 150 70",
}
brush = brushsvg.find_brush("round-6")
strokes = [brushsvg.stroke_from_path(path, width, f"w{width:g}") for width, path in shapes.items()]
done = brushsvg.compensate(strokes, brush, sheet_mm=(170, 80), few_poses=False)
marks = brushsvg.simulate(done.plan, brush)
brushsvg.trace_outlines(marks, brush)
figure = Figure(figsize=(8, 3), layout="constrained")
left, right = figure.subplots(1, 2, sharey=True)
for stroke, way, mark in zip(strokes, done.plan.passes, marks.passes, strict=True):
    d = np.asarray(mark.depth_mm)
    e = brush.tip_to_widest(d) - brush.tip_gap(d)
    along = np.column_stack([np.cos(mark.heading_rad), np.sin(mark.heading_rad)])
    left.plot(*way.poses_mm[:, :2].T, color="0.7", lw=1.5)
    left.plot(*(mark.contact_mm + e[:, None] * along)[d > 0.5].T, lw=1.5)
    left.text(*way.poses_mm[0, :2] - [0, 3], stroke.id[1:], ha="center", va="top")
    for ring in mark.outline_mm:
        right.fill(*ring.T, color="#3f8fd9", alpha=0.6)
    for ring in brushsvg.target_outline(stroke, 0.02):
        right.plot(*np.vstack([ring, ring[:1]]).T, color="#e07a2f", lw=0.9)
for axes, title in ((left, "(a)"), (right, "(b)")):
    axes.set(aspect="equal", title=title, xlabel="mm", ylim=(-3, 85))
left.set_ylabel("mm")
target = brushsvg.unite([ring for stroke in strokes for ring in brushsvg.target_outline(stroke, 0.02)])
rows = [("overlap of paint and drawing", None, brushsvg.overlap(marks.outline_mm, target))]
