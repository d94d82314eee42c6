"""Figure 12: an angular stroke, the computed line

(5) and (6) with alpha by (7), r = 13.0 mm, and s from 0 to 80. The measured line is not printed. The text
says only that y is off by an RMSE of 0.05 and less than 2 %, which is 0.26 mm of 13. The last row shows how
much the lag matters: it is the distance to the line for 13.7 mm, which (25) gives for this depth.
"""

import numpy as np
from matplotlib.figure import Figure

from brushsvg import laws

s = np.linspace(0, 80, 401)
lines: dict[float, np.ndarray] = {}
for r in (13.0, 13.7):
    alpha = laws.alpha_after(np.pi / 2, s, r)
    lines[r] = np.column_stack([s, 0 * s]) + laws.contact_offset(alpha, r)
figure = Figure(figsize=(8, 2.4), layout="constrained")
axes = figure.subplots()
axes.plot(s, 0 * s, "k", lw=2, label="handle")
axes.plot([0, 0], [-30, -13], color="0.7", lw=2)
axes.plot(*lines[13.0].T, "r--", label="computed, r = 13.0")
axes.plot(*lines[13.7].T, color="#3f8fd9", lw=0.9, label="r = 13.7")
axes.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", ylim=(-20, 2))
axes.legend(frameon=False, fontsize=8)
rows: list[tuple[str, float | None, float]] = [("r, mm", 13.0, laws.Profile([3.1, 0.86, 0.31, -5.0e-2, 2.1e-3])(10.0))]
for at in (10, 20, 40, 80):
    rows.append((f"distance from the second line at s = {at}, mm", None, -lines[13.0][5 * at, 1]))
off = np.interp(lines[13.0][:, 0], lines[13.7][:, 0], lines[13.7][:, 1]) - lines[13.0][:, 1]
rows.append(("greatest difference of r = 13.7 and 13.0 in y, mm", None, np.abs(off[s <= 70]).max()))
