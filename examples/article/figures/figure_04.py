"""Figure 4b: a turn beyond 90 degrees, and the brush becomes loose

The handle comes from below and turns back by 135 degrees (r = 3). Bristles do not push, so the patch rests
while the handle passes it (dashed levers). It is dragged on (solid) once the handle is r away again, after
s* = -2 r cos(alpha0). The article prints no numbers here. It compares r' with r - 0.01 at every step, so
steps finer than 0.01 mm would never become loose. Here the moments are exact roots.
"""

import numpy as np
from matplotlib.figure import Figure

from brushsvg import laws

r, turn = 3.0, np.radians(135)
back = np.array([np.sin(turn), np.cos(turn)])
s = np.linspace(0, 14, 57)
handle = np.vstack([[[0, -60], [0, -59.0]], s[:, None] * back])
way = laws.follow(handle, [0, *[2.0] * (len(handle) - 1)], r)
figure = Figure(figsize=(8, 3.6), layout="constrained")
left, right = figure.subplots(1, 2, width_ratios=(1, 1.2))
for q, p, taut in list(zip(handle, way.contact_mm, way.taut, strict=True))[2::4]:
    left.plot(*zip(p, q, strict=True), "-" if taut else "--", color="#3f8fd9", lw=0.9)
left.plot(*handle[1:].T, "k", lw=2, label="handle")
left.plot(*way.contact_mm[1:].T, "r", lw=2, label="centre of friction")
left.set(aspect="equal", ylim=(-12, 2), xlabel="x, mm", ylabel="y, mm")
left.legend(frameon=False, fontsize=8)
for degrees in (60, 90, 120, 135, 150):
    right.plot(s, np.degrees(laws.alpha_after_turn(np.radians(degrees), s, r)), label=f"{degrees} degrees")
right.set(xlabel="s, mm", ylabel="alpha, degrees")
right.legend(title="alpha0", frameon=False, fontsize=8)
first = s[np.argmax(way.taut[3:]) + 1]
rows = [
    ("s* for 135 degrees, mm", None, -2 * r * np.cos(turn)),
    ("alpha at s*, degrees", None, np.degrees(laws.alpha_after_turn(turn, -2 * r * np.cos(turn), r))),
    ("first step of 0.25 mm with a taut brush, mm", None, first),
]
