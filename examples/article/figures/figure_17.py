"""Figure 17: "Robot", with the round brush of 6 mm

With our own drawing, and the upper row only, because no law of the liner is printed. (a) The path of the
handle in red, the skeleton of the mark, and in green the path of the centre of friction by (4). (b) The
paint alone.
"""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

import brushsvg

drawn = {
    "R-stem": "M19 48V14",
    "R-bowl": "M19 48H31C42 48 42 31 31 31H19",
    "R-leg": "M29 31L40 14",
    "o": "M58 36C43 36 43 14 58 14S73 36 58 36",
    "b-stem": "M79 48V14",
    "b-bowl": "M79 33C87 38 99 36 99 25S87 12 79 17",
    "o2": "M116 36C101 36 101 14 116 14S131 36 116 36",
    "t-stem": "M139 46V20C139 14 143 13 147 15",
    "t-bar": "M132 36H147",
}
strokes = [brushsvg.stroke_from_path(d, 2.5, name) for name, d in drawn.items()]
brush = brushsvg.find_brush("round-6")
strokes = brushsvg.lifted_at_corners(strokes, brush)
plan = brushsvg.compensate(strokes, brush, sheet_mm=(160, 60)).plan
marks = brushsvg.simulate(plan, brush)
brushsvg.trace_outlines(marks, brush)
figure = Figure(figsize=(8, 5.6), layout="constrained")
rings = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in marks.outline_mm]
for axes, shade, title in zip(figure.subplots(2, 1), ("0.75", "k"), ("(a)", "(b)"), strict=True):
    axes.add_patch(PathPatch(Path.make_compound_path(*rings), color=shade, lw=0))
    axes.set(aspect="equal", title=title, xlabel="mm", ylabel="mm", xlim=(8, 158), ylim=(4, 56))
for way, mark in zip(plan.passes, marks.passes, strict=True):
    figure.axes[0].plot(*way.poses_mm[:, :2].T, color="#d1495b", lw=0.9)
    figure.axes[0].plot(*mark.contact_mm.T, color="#2f8f4e", lw=1.2)
target = brushsvg.unite([ring for stroke in strokes for ring in brushsvg.target_outline(stroke, 0.02)])
poses = [len(one.poses_mm) for one in plan.passes]
rows = [
    ("overlap of paint and drawing", None, brushsvg.overlap(marks.outline_mm, target)),
    ("poses of a stroke, at most; the article's had 6 to 14", 14, max(poses)),
]
