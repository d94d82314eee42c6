"""Describe your own brush by a table that you measure with a ruler, and paint with it.

Run: python examples/05_brush_from_table.py. It writes measured.csv, mine.json (the brush), mine.png (a plot of the
measurements with the fitted curves) and mine.ngc. The plot needs the extra plot.
"""

from pathlib import Path

import brushsvg

# Press the brush to a depth, pull it straight, and measure how far the paint trails behind the handle (lag) and how
# wide the line is (width). These are numbers of a brush of 7 mm.
DEPTHS_MM = (1, 2, 3, 4, 5, 6, 7, 8)
LAGS_MM = (4.3, 5.5, 7.4, 8.9, 10.1, 11.5, 12.1, 12.9)
WIDTHS_MM = (0.9, 1.6, 2.6, 3.3, 4.2, 5.1, 5.8, 6.8)

rows = ["kind,depth_mm,value_mm"]
for kind, values in (("lag", LAGS_MM), ("width", WIDTHS_MM)):
    rows += [f"{kind},{depth},{value}" for depth, value in zip(DEPTHS_MM, values, strict=True)]
Path("measured.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")

made = brushsvg.calibrate("measured.csv", "mine")
for notice in made.notices:
    print(f"warning: {notice.where}: {notice.sentence}")
print(made.text)
brushsvg.save_brush(made.brush, "mine.json")
Path("mine.png").write_bytes(made.plot())

done = brushsvg.convert(Path(__file__).with_name("robot.svg"), "mine.ngc", brush="mine.json", figures=True)
assert done.figures
print(f"overlap with this brush: {done.figures.total.overlap:.3f}")
