"""Calibrate a brush from a photograph of a painted chart.

Run: python examples/06_brush_from_photo.py. It writes the chart, a simulated photograph of it (photo.jpg), the brush
(mine.json) and what brushsvg read in the photograph (read.png). The run takes half a minute. For a real machine, print
page.pdf, paint chart.ngc on it, and take the photograph yourself.
"""

from pathlib import Path

import brushsvg

# The lag of the simulated brush is 15 % longer than that of round-6. The chart does not know this.
LAG_FACTOR = 1.15
Path("studio.toml").write_text(f'format = "brushsvg/studio"\nversion = 1\n[brush]\nlag = {LAG_FACTOR}\n')
before = brushsvg.find_brush("round-6")
chart = brushsvg.chart(before, (250, 180), "few")
brushsvg.write_program("chart.ngc", chart.plan, before, "calibration chart")
Path("page.pdf").write_bytes(brushsvg.chart_page(chart, ".pdf"))
brushsvg.simulate_photo(chart, "photo.jpg", studio="studio.toml")

made = brushsvg.calibrate("photo.jpg", "mine", chart=chart, progress=print)
for notice in made.notices:
    print(f"warning: {notice.where}: {notice.sentence}")
brushsvg.save_brush(made.brush, "mine.json")
Path("read.png").write_bytes(made.picture())

for depth_mm in (2.0, 4.0, 6.0):
    true_mm = LAG_FACTOR * before.lag(depth_mm)
    print(f"lag at {depth_mm:g} mm depth: true {true_mm:.2f} mm, found {made.brush.lag(depth_mm):.2f} mm")
