"""Convert a drawing to a robot program and look at the paint before you use any.

Run: python examples/01_first_word.py. It writes first_word.ngc (G-code) and first_word.png (the predicted paint).
"""

from pathlib import Path

import brushsvg

drawing = Path(__file__).with_name("robot.svg")

# Without a brush and a cell, brushsvg uses the brush round-6 and the machine linuxcnc-3axis.
done = brushsvg.convert(drawing, "first_word.ngc", picture="first_word.png", figures=True)

for notice in done.notices:
    print(f"warning: {notice.where}: {notice.sentence}")

assert done.figures  # because of figures=True
print(f"{done.title}: {len(done.plan.passes)} strokes, {done.time_s:.0f} s on the machine")
print(f"overlap of paint and drawing: {done.figures.total.overlap:.3f}")

# The same drawing without compensation: the tool follows the line, and the brush trails behind it.
plain = brushsvg.convert(drawing, compensation="none", figures=True)
assert plain.figures
print(f"overlap without compensation: {plain.figures.total.overlap:.3f}")
