"""Paint a shape that is wider than the brush.

Run: python examples/03_wide_shapes.py. It writes wide_clamp.png and wide_passes.png.
"""

from xml.etree import ElementTree

import brushsvg

SHAPE = ElementTree.fromstring(
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
    "<title>Bar</title>"
    '<path id="bar" d="M 20 24 C 45 10 75 10 100 24 L 100 40 C 75 30 45 30 20 40 Z"/>'
    "</svg>"
)

brush = brushsvg.find_brush("round-6")
print(f"widest line of {brush.name}: {2 * brush.half_width_range_mm()[1]:.1f} mm")

# "clamp" paints one stroke, as wide as the brush allows. "passes" paints several strokes side by side.
for wide in ("clamp", "passes"):
    done = brushsvg.convert(SHAPE, f"wide_{wide}.ngc", picture=f"wide_{wide}.png", brush=brush, wide=wide, figures=True)
    assert done.figures
    print(f"{wide}: {len(done.plan.passes)} strokes, overlap {done.figures.total.overlap:.3f}")
    for notice in done.notices:
        print(f"  {notice.where}: {notice.sentence}")
