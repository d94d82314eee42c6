"""Paint sharp corners: compare lifting the brush at a corner with turning it there.

Run: python examples/02_corners.py. It writes corners_turn.png and corners_auto.png.
"""

from xml.etree import ElementTree

import brushsvg

ZIGZAG = ElementTree.fromstring(
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">'
    "<title>Zigzag</title>"
    '<path id="zigzag" fill="none" stroke="black" stroke-width="4" d="M 20 50 L 45 15 L 60 50 L 85 15 L 100 50"/>'
    "</svg>"
)

for corners in ("turn", "auto"):
    done = brushsvg.convert(
        ZIGZAG, f"corners_{corners}.ngc", picture=f"corners_{corners}.png", corners=corners, figures=True
    )
    assert done.figures
    # With "auto", brushsvg ends a stroke at each corner that is too sharp for the brush, and starts a new one there.
    names = ", ".join(each.stroke for each in done.plan.passes)
    print(f"{corners}: overlap {done.figures.total.overlap:.3f}, {done.time_s:.0f} s, strokes: {names}")
