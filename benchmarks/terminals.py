"""Test whether similarly drawn ends of letters are painted similarly.

The program paints each of the 62 letters and digits of a font alone. Rays along the stroke examine an end,
from half a width inside of it. They find how far ahead the outline of the letter is, and how far ahead the
paint ends. Two ends of one letter are drawn alike if their widths differ by at most 5 %, and the outlines on
their rays by 0.05 half widths on average. One of the ends may be mirrored. They are painted alike if missing
or additional paint on their rays differs by at most 0.1 half widths. A round end differs from a straight cut
by 0.2.

  pairs    the number of pairs of ends drawn alike, and how many of them are painted alike
  letters  the number of letters with pairs, and how many of them have all pairs painted alike
  which    the other letters

FONT is a file, TrueType, OpenType or WOFF. Each font is painted as large as by letters.py.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from pathlib import Path

import numpy as np
import shapely
from letters import GLYPHS, fitting_mm

from brushsvg import _core, find_brush
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.skeleton import filled_rings
from brushsvg.strokes.swept_areas import region

ACROSS = np.linspace(-0.9, 0.9, 19)  # places of the rays, in half widths
AHEAD = 2.5  # an outline up to this far ahead of the path's end belongs to it
FREE = 1.3  # on both sides of a free stroke the outline is nearer than this
ALIKE_WIDTH, ALIKE_OUTLINE, ALIKE_PAINT = 0.05, 0.05, 0.1


@dataclass
class End:
    half_mm: float
    drawn: np.ndarray
    painted: np.ndarray

    def is_drawn_as(self, other: End) -> list[int]:
        """Return 1 if the ends are drawn alike, and -1 if they are mirrored."""
        if abs(self.half_mm - other.half_mm) > ALIKE_WIDTH * max(self.half_mm, other.half_mm):
            return []
        return [way for way in (1, -1) if np.abs(self.drawn - other.drawn[::way]).mean() <= ALIKE_OUTLINE]

    def is_painted_as(self, other: End, ways: list[int]) -> bool:
        """Return whether the paint of both ends differs only invisibly."""
        return any(
            np.abs((self.painted - self.drawn) - (other.painted - other.drawn)[::way]).mean() <= ALIKE_PAINT
            for way in ways
        )


def left_at(shape, at: np.ndarray, along: np.ndarray, half_mm: float) -> float:
    """Return where a ray from inside of a shape leaves it, in half widths.

    The result is 0 if the ray begins outside.
    """
    ray = shapely.LineString([at, at + (AHEAD + 1) * half_mm * along])
    inside = [part for part in shapely.get_parts(ray.intersection(shape)) if part.length > 0]
    first = min(inside, key=lambda part: part.distance(shapely.Point(at)), default=None)
    if first is None or first.distance(shapely.Point(at)) > 0.05:
        return 0.0
    return max(shapely.Point(at).distance(shapely.Point(end)) for end in first.coords) / half_mm


def ends_of(strokes, shape, mark) -> list[End]:
    found = []
    for stroke in strokes:
        if stroke.closed:
            continue
        line = _core.flatten(stroke, 0.02)
        for rows in (line, line[::-1]):
            half_mm = float(rows[0, 3])
            if line[-1, 2] < 2 * half_mm:
                continue
            behind = rows[np.argmax(np.abs(rows[:, 2] - rows[0, 2]) >= 0.5 * half_mm)]
            along = (rows[0, :2] - behind[:2]) / np.linalg.norm(rows[0, :2] - behind[:2])
            left = np.array([-along[1], along[0]])
            inside = rows[0, :2] - 0.5 * half_mm * along
            sides = [left_at(shape, inside, way * left, half_mm) for way in (1, -1)]
            if not all(0.5 < side < FREE for side in sides):
                continue  # this end is in another stroke
            starts = inside + np.outer(ACROSS * half_mm, left)
            drawn, painted = (np.array([left_at(of, at, along, half_mm) for at in starts]) for of in (shape, mark))
            if 0.5 < drawn[len(drawn) // 2] < AHEAD:
                found.append(End(half_mm, drawn, painted))
    return found


def pairs(text: str, font: bytes, size_mm: float, brush_name: str) -> tuple[str, int, int]:
    """Return the text, the pairs drawn alike, and how many are painted alike."""
    document, _ = text_svg(text, font, size_mm=size_mm)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "glyph.svg")
        file.write_text(document, encoding="utf-8")
        work = prepare(file, Options(brush=find_brush(brush_name)))
    shape = region(filled_rings(read_svg(document.encode()).elements[0]))
    mark = region(predict(work).outline_mm)
    drawn = [stroke for stroke in work.drawn if stroke.origin.lane == 1]
    found = [
        (a.is_painted_as(b, ways))
        for a, b in combinations(ends_of(drawn, shape, mark), 2)
        if (ways := a.is_drawn_as(b))
    ]
    return text, len(found), sum(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("font", type=Path, nargs="+")
    parser.add_argument("--brush", default="round-6")
    parser.add_argument("--processes", type=int, default=2)
    options = parser.parse_args()
    brush = find_brush(options.brush)
    print(f"{'font':<26}{'pairs':>7}{'alike':>7}{'letters':>9}{'alike':>7}  which")
    rows = np.zeros(4, int)
    with ProcessPoolExecutor(options.processes) as pool:
        for file in options.font:
            font = file.read_bytes()
            work = partial(pairs, font=font, size_mm=fitting_mm(font, brush), brush_name=options.brush)
            done = [each for each in pool.map(work, GLYPHS) if each[1]]
            row = [
                sum(each[1] for each in done),
                sum(each[2] for each in done),
                len(done),
                sum(each[1] == each[2] for each in done),
            ]
            rows += row
            which = "".join(text for text, every, alike in done if alike < every)
            print(f"{file.stem[:25]:<26}{row[0]:>7}{row[1]:>7}{row[2]:>9}{row[3]:>7}  {which}", flush=True)
    print(f"{'all':<26}{rows[0]:>7}{rows[1]:>7}{rows[2]:>9}{rows[3]:>7}")
    print(f"letters with all pairs alike: {100 * rows[3] / max(1, rows[2]):.1f} of 100")


if __name__ == "__main__":
    sys.exit(main())
