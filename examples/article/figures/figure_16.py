"""Figure 16: width and lag of a liner brush

Our own illustration. Of the liner only its size is printed: marks 1 to 2 mm wide, and bristles of 20 mm.
`liner-1` is a liner of that size, and all of it is assumed: a lag of half the bristles at touch, and 1 mm
more for each mm of depth. `round-6` is drawn for comparison. At the same width the liner lags more than
twice as far, so its curves must be wider.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

liner, round_6 = (brushsvg.find_brush(name) for name in ("liner-1", "round-6"))
figure = Figure(figsize=(8, 3), layout="constrained")
left, right = figure.subplots(1, 2)
for brush, colour in ((liner, "#2b3a67"), (round_6, "#3f8fd9")):
    z = np.linspace(*brush.depth_range_mm, 100)
    left.plot(z, 2 * brush.half_width(z), color=colour, label=brush.name)
    right.plot(z, brush.lag(z), color=colour)
left.set(title="(a) width", xlabel="z, mm", ylabel="mm")
right.set(title="(b) r", xlabel="z, mm", ylabel="mm")
left.legend(frameon=False)
least, most = liner.depth_range_mm
at = np.linspace(*round_6.depth_range_mm, 1001)
same = float(at[np.argmin(np.abs(round_6.half_width(at) - liner.half_width(most)))])
rows = [
    ("width of the liner at least, mm", 1.0, 2 * liner.half_width(least)),
    ("width of the liner at most, mm", 2.0, 2 * liner.half_width(most)),
    ("r of the liner, 2 mm wide, over r of round-6, as wide", None, liner.lag(most) / round_6.lag(same)),
]
