"""Draw docs/explanation/ends.png: how strokes begin and end.

The upper rows show beginnings (pointed, round, butt), the lower rows show ends. Grey is painted target, red
is unpainted target, and blue is paint outside of the target. The tool's path on the paper is green. The
script needs only the package.
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from brushsvg import _core, find_brush
from brushsvg.machine.realised.arc_chords import with_chords

PX_PER_MM = 24.0
SIZE_MM = (26.0, 13.0)
AT_MM = (7.5, 6.5)  # place of the shown beginning or end, from the lower left of a cell
COLOURS = {"both": (0xB8, 0xB4, 0xB0), "wanted": (0x3C, 0x46, 0xD0), "painted": (0xD0, 0x80, 0x40)}  # BGR
PATH = (0x50, 0x90, 0x30)
ROWS = (
    ("start", "pointed"),
    ("start", "round"),
    ("start", "butt"),
    ("end", "round"),
    ("end", "butt"),
    ("end", "pointed"),
)


def bar(half_mm: float, slant: float = 0.0) -> np.ndarray:
    """Return a bar that is cut, straight or slanted, half a width before the path."""
    x, y = np.array([-half_mm - slant * half_mm, 40, 40, -half_mm + slant * half_mm]), half_mm
    return np.column_stack([x, [-y, -y, y, y]])


def strokes(ending: bool) -> list:
    """Return strokes with round caps, cut straight, cut slanted, and bent.

    They end at the shown place if ending is True, else they begin there.
    """
    straight = np.array([[0.0, 0, 10, 0, 20, 0, 34, 0]])
    bent = np.array([[0.0, -4, 5, -4, 12, -2, 14, 12]])
    made = [(straight, None), (straight, bar(2.0)), (straight, bar(2.0, 0.5)), (bent, None)]
    out = []
    for middle, outline in made:
        path = np.hstack([middle[:, 2 * k : 2 * k + 2] for k in (3, 2, 1, 0)]) if ending else middle
        stroke = _core.Stroke("s", path, half_width=[(0.0, 2.0)])
        if outline is not None:
            stroke.target_mm = [outline]
        out.append(stroke)
    return out


def cell(stroke, brush, **how: str) -> np.ndarray:
    plan = _core.compensate([stroke], brush, SIZE_MM, **how).plan
    marks = _core.simulate(plan, brush)
    window = (-AT_MM[0], -AT_MM[1], *SIZE_MM)
    paint = _core.coverage(marks, brush, window, PX_PER_MM)[..., None]
    target = _core.target_coverage([stroke], window, PX_PER_MM)[..., None]
    image = np.full((*paint.shape[:2], 3), 255.0)
    for share, name in (
        (np.minimum(paint, target), "both"),
        (np.maximum(target - paint, 0), "wanted"),
        (np.maximum(paint - target, 0), "painted"),
    ):
        image += share * (np.array(COLOURS[name]) - 255.0)
    points = (with_chords(plan.passes[0]).poses_mm[:, :2] - window[:2]) * PX_PER_MM
    points[:, 1] = image.shape[0] - points[:, 1]
    drawn = np.ascontiguousarray(image.round().astype(np.uint8))
    cv2.polylines(drawn, [points.round().astype(np.int32)], False, PATH, 1, cv2.LINE_AA)
    return drawn


def main() -> None:
    brush = find_brush("round-6")
    rows = [np.hstack([cell(each, brush, **{name: how}) for each in strokes(name == "end")]) for name, how in ROWS]
    small = cv2.resize(np.vstack(rows), None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(Path(__file__).parents[1] / "docs" / "explanation" / "ends.png"), small)


if __name__ == "__main__":
    main()
