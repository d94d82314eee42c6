"""Turn a text in a font into strokes and a robot program.

Run: python examples/04_text.py [FONT]. It writes text.svg, text.ngc and text.png.
Without FONT it uses DejaVu Sans, which comes with matplotlib. It needs the extras text and plot.
"""

import sys
from pathlib import Path

import matplotlib

import brushsvg

shipped = Path(matplotlib.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")
font = Path(sys.argv[1]) if len(sys.argv) > 1 else shipped

# The letters become filled outlines on a sheet of their own, with 20 mm of paper around them.
document, notices = brushsvg.text_svg("Hello", font.read_bytes(), size_mm=50)
Path("text.svg").write_text(document, encoding="utf-8")

# convert finds the strokes in the outlines, in writing order.
done = brushsvg.convert("text.svg", "text.ngc", picture="text.png", figures=True)
for notice in (*notices, *done.notices):
    print(f"warning: {notice.where}: {notice.sentence}")
assert done.figures
print("strokes in writing order:", ", ".join(each.stroke for each in done.plan.passes))
print(f"overlap of paint and letters: {done.figures.total.overlap:.3f}")
