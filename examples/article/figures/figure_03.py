"""Figure 3: a brush turned by 90 degrees, r = 3, b = 1

(a) The centre of friction and the tip while the handle moves along x, by (5), (6), (15) and (16). (b) alpha
by (7) and beta by (11). The text determines everything. Of the curves it prints only where beta begins, one
step of 0.3 mm from the start.
"""

import numpy as np
from matplotlib.figure import Figure

from brushsvg import laws

r, b = 3.0, 1.0
s = np.arange(0, 12.01, 0.3)
alpha = laws.alpha_after(np.pi / 2, s, r)
handle = np.column_stack([s, 0 * s])
p, tip = handle + laws.contact_offset(alpha, r), handle + laws.tip_offset(alpha, r, b)
beta = laws.tip_direction(np.pi / 2, alpha[1:], s[1:], r, b)

figure = Figure(figsize=(8, 3.2), layout="constrained")
left, right = figure.subplots(1, 2)
left.plot(*handle.T, "k", lw=3, label="handle")
left.plot(*p.T, "r", label="centre of friction")
left.plot(*tip.T, "b", label="tip")
left.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title="(a)")
right.plot(s, alpha, label="alpha")
right.plot(s[1:], beta, label="beta")
right.axvline(0.3, color="0.5", ls="--", lw=0.8)
right.set(xlabel="s, mm", ylabel="rad", title="(b)")
for axes in (left, right):
    axes.legend(frameon=False, fontsize=8)
rows = [("s where beta begins, mm", 0.3, s[1])]
for at in (0.3, 3.0, 12.0):
    k = round(at / 0.3)
    rows += [(f"alpha at s = {at:g}, rad", None, alpha[k]), (f"beta at s = {at:g}, rad", None, beta[k - 1])]
