"""Measure how completely brushsvg paints letters.

The program paints each of the 62 letters and digits of a font, or of --glyphs, alone. It compares each mark
with the shape of its glyph.

  lost      connected pieces of the shape without a stroke, such as limbs. Neither paint nor a disc of any stroke's
            width reaches them. They are larger than 3 % of the shape and wide enough for the brush.
  bare      pieces like these that paint alone does not reach. These include blunt ends where a mark begins pointed.
  glyphs    the number of glyphs that lose a piece, and at the end their names
  silent    the number of these glyphs without a notice that names the place
  overlap   common area over joint area of mark and shape, the mean over the glyphs and the smallest
  notices   the number of all notices
  thorns    corners of the mark above 20 degrees that stick out of the shape by more than 0.3 mm
  notches   unpainted parts of the shape, deeper in it than 0.15 mm, in mm2 per glyph: wedges at crotches, waves
            next to stems, blunt corners
  bulges    paint that is more than 0.15 mm outside of the shape
  turning   how much more the mark's outline turns than the shape's, in full turns per glyph. Rings below 0.01 mm2 are
            pinholes and do not count.
  torn      glyphs whose mark has more pieces than their shape
  closed    painted counters that are wider than the brush's finest line
  outside   places where a mark is more than 0.3 mm outside of its shape
  strokes   the mean per glyph, and the largest number of one glyph

Each font is so large that the stem of its l is nearly as wide as the brush paints, at most 100 mm to the em.
FONT is a file, TrueType, OpenType or WOFF. --pictures writes a page of all glyphs per font. --against also
runs the Python of another environment, for example with an earlier brushsvg, and prints its row first.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import shapely

from brushsvg import find_brush
from brushsvg.geometry.rings import signed_area
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.skeleton import filled_rings
from brushsvg.strokes.swept_areas import region, unpainted_area
from brushsvg.strokes.wide_shapes import within_reach

GLYPHS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
LARGEST_MM = 100.0
STEM = 0.95  # width of an l's stem as a share of the brush's widest mark
LOST_SHARE = 0.03
SEEN_MM = 0.15  # nobody sees a smaller distance between the edges of mark and shape
EDGE_MM = 0.3  # edges of mark and shape up to this far apart count as one
THORN_RAD = np.radians(20)
EVEN_MM = 0.5  # a turn within a shorter length is an angle of the polygon
PINHOLE_MM2 = 0.01  # nobody sees a smaller ring, which would count as a whole turn
PX_PER_MM, COLUMNS = 6, 11


@dataclass
class Painted:
    text: str
    shape: list[np.ndarray]
    mark: list[np.ndarray]
    lost: list[tuple[float, float]]
    bare: list[tuple[float, float]]
    named: bool
    overlap: float
    notices: int
    thorns: int
    turns: float
    notches_mm2: float
    bulges_mm2: float
    is_torn: bool
    closed: int
    outside: int
    strokes: int


def fitting_mm(font: bytes, brush, stem_of: str = "l") -> float:
    stem = region(filled_rings(_drawn(stem_of, font, LARGEST_MM)))
    wide = 2 * shapely.maximum_inscribed_circle(stem, 0.01).length
    return float(min(np.floor(LARGEST_MM * STEM * 2 * brush.half_width_range_mm()[1] / wide), LARGEST_MM))


def _drawn(text: str, font: bytes, size_mm: float):
    document, _ = text_svg(text, font, size_mm=size_mm)
    return read_svg(document.encode()).elements[0]


def painted(text: str, font: bytes, size_mm: float, brush_name: str, compensation: str) -> Painted:
    brush = find_brush(brush_name)  # a brush cannot be sent between processes, so each process finds it
    document, _ = text_svg(text, font, size_mm=size_mm)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "glyph.svg")
        file.write_text(document, encoding="utf-8")
        work = prepare(file, Options(brush=brush, compensation=compensation))
    rings = [ring for element in read_svg(document.encode()).elements for ring in filled_rings(element)]  # dots as well
    mark_rings = predict(work).outline_mm
    shape, mark = region(rings), region(mark_rings)
    finest = brush.half_width(brush.lag.calibrated_mm[0])
    strokes, _, _ = within_reach(list(work.drawn), brush)
    bare = shape.difference(mark)
    return Painted(
        text,
        rings,
        mark_rings,
        _pieces(unpainted_area(bare, strokes), shape, finest),
        _pieces(bare, shape, finest),
        any(notice.code in ("unreached", "mark-misses") for notice in work.notices),
        shape.intersection(mark).area / shape.union(mark).area,
        len(work.notices),
        _thorns(mark_rings, shape),
        (_turned(mark_rings) - _turned(rings)) / (2 * np.pi),
        shape.buffer(-SEEN_MM).difference(mark).area,
        mark.difference(shape.buffer(SEEN_MM)).area,
        len(_large(mark)) > len(_large(shape)),
        sum(_is_closed(hole, mark, finest) for hole in _holes(shape)),
        len(_large(mark.difference(shape.buffer(EDGE_MM)))),
        len(work.strokes),
    )


def _large(shape) -> list:
    return [piece for piece in shapely.get_parts(shape) if piece.area > PINHOLE_MM2]


def _holes(shape) -> list:
    return [shapely.Polygon(ring) for piece in shapely.get_parts(shape) for ring in piece.interiors]


def _is_closed(hole, mark, finest: float) -> bool:
    """Return whether the mark covers a counter that a finest line would fit into."""
    wide = shapely.maximum_inscribed_circle(hole, 0.01).length > finest
    return bool(wide and not _large(hole.difference(mark)))


def _pieces(left, shape, finest: float) -> list[tuple[float, float]]:
    """Return the places of the large connected pieces of the rest of a shape."""
    return [
        piece.representative_point().coords[0]
        for piece in shapely.get_parts(left.buffer(-EDGE_MM).buffer(EDGE_MM))
        if piece.area > LOST_SHARE * shape.area and shapely.maximum_inscribed_circle(piece, 0.01).length >= finest
    ]


def _turns(ring: np.ndarray) -> np.ndarray:
    """Return the turn to the left at each vertex."""
    edges = np.roll(ring, -1, axis=0) - ring
    before = np.roll(edges, 1, axis=0)
    cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
    return np.arctan2(cross, (before * edges).sum(axis=1))


def _simpler(ring: np.ndarray, tolerance_mm: float = 0.05) -> np.ndarray:
    made = np.array(shapely.LinearRing(ring).simplify(tolerance_mm).coords)[:-1]
    return made if len(made) >= 3 else ring


def _thorns(rings, shape) -> int:
    count = 0
    for ring in map(_simpler, rings):
        corners = ring[_turns(ring) > THORN_RAD]
        count += int((shapely.distance(shape, shapely.points(corners)) > EDGE_MM).sum())
    return count


def _turned(rings) -> float:
    """Return how much outlines turn in total, sampled every half millimetre."""
    total = 0.0
    for ring in map(_simpler, (ring for ring in rings if abs(signed_area(ring)) >= PINHOLE_MM2)):
        line = shapely.LinearRing(ring)
        at = np.linspace(0, line.length, max(int(line.length / EVEN_MM), 3), endpoint=False)
        places = shapely.get_coordinates(shapely.line_interpolate_point(line, at))
        total += float(np.abs(_turns(places)).sum())
    return total


def page(all_painted: list[Painted], cell_mm: float) -> np.ndarray:
    """Draw a page of all glyphs.

    Paint is blue and shapes are outlined. Orange rings mark bare places, and red rings mark lost pieces.
    """
    rows = -(-len(all_painted) // COLUMNS)
    side = int(cell_mm * PX_PER_MM)
    image = np.full((rows * side, COLUMNS * side, 3), 255, np.uint8)
    for k, each in enumerate(all_painted):
        corner = np.array([k % COLUMNS, k // COLUMNS]) * side
        points = np.vstack(each.shape)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2

        def pixels(mm, corner=corner, middle=middle):
            return np.round((np.asarray(mm) - middle) * (PX_PER_MM, -PX_PER_MM) + corner + side / 2).astype(np.int32)

        cv2.fillPoly(image, [pixels(ring) for ring in each.mark], (150, 120, 90), cv2.LINE_AA)
        cv2.polylines(image, [pixels(ring) for ring in each.shape], True, (0, 0, 0), 1, cv2.LINE_AA)
        for places, colour in ((each.bare, (0, 160, 255)), (each.lost, (0, 0, 255))):
            for place in places:
                cv2.circle(image, pixels(place).tolist(), side // 12, colour, 2, cv2.LINE_AA)
    return image


def row(name: str, size_mm: float, compensation: str, done: list[Painted]) -> str:
    losing = [each for each in done if each.lost]
    overlaps = [each.overlap for each in done]
    return (
        f"{name[:23]:<24}{size_mm:>4.0f}  {compensation:<8}{sum(len(each.lost) for each in done):>5}"
        f"{sum(len(each.bare) for each in done):>6}{len(losing):>8}"
        f"{sum(not each.named for each in losing):>8}{np.mean(overlaps):>9.4f}{min(overlaps):>7.3f}"
        f"{sum(each.notices for each in done):>9}{sum(each.thorns for each in done):>8}"
        f"{np.mean([each.turns for each in done]):>9.2f}{np.mean([each.notches_mm2 for each in done]):>9.2f}"
        f"{np.mean([each.bulges_mm2 for each in done]):>8.2f}{sum(each.is_torn for each in done):>6}"
        f"{sum(each.closed for each in done):>8}{sum(each.outside for each in done):>9}"
        f"{np.mean([each.strokes for each in done]):>9.1f}{max(each.strokes for each in done):>6}"
        f"  {''.join(each.text for each in losing)}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("font", type=Path, nargs="+")
    parser.add_argument("--brush", default="round-6")
    parser.add_argument("--compensation", nargs="+", default=["closed", "refined"])
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--pictures", type=Path, metavar="FOLDER")
    parser.add_argument("--glyphs", default=GLYPHS)
    parser.add_argument("--stem", default="l", help="the glyph whose stem gives the size")
    parser.add_argument("--against", type=Path, metavar="PYTHON")
    options = parser.parse_args()
    brush = find_brush(options.brush)
    print(
        f"{'font':<24}{'em':>4}  {'':<8}{'lost':>5}{'bare':>6}{'glyphs':>8}{'silent':>8}{'overlap':>9}{'least':>7}"
        f"{'notices':>9}{'thorns':>8}{'turning':>9}{'notches':>9}{'bulges':>8}"
        f"{'torn':>6}{'closed':>8}{'outside':>9}{'strokes':>9}{'most':>6}  which glyphs"
    )
    with ProcessPoolExecutor(options.processes) as pool:
        for file in options.font:
            font = file.read_bytes()
            size_mm = fitting_mm(font, brush, options.stem)
            if options.against:
                _print_rows_of(options.against, file, options)
            for compensation in options.compensation:
                work = partial(
                    painted,
                    font=font,
                    size_mm=size_mm,
                    brush_name=options.brush,
                    compensation=compensation,
                )
                done = list(pool.map(work, options.glyphs))
                print(row(file.stem, size_mm, compensation, done), flush=True)
                if options.pictures:
                    options.pictures.mkdir(parents=True, exist_ok=True)
                    picture = options.pictures / f"{file.stem}-{compensation}.png"
                    cv2.imwrite(str(picture), page(done, 1.05 * size_mm))


def _print_rows_of(python: Path, file: Path, options) -> None:
    """Print the rows of a font with another environment's brushsvg."""
    same = ["--brush", options.brush, "--compensation", *options.compensation, "--glyphs", options.glyphs]
    command = [python, __file__, file, *same, "--stem", options.stem, "--processes", str(options.processes)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    print("\n".join(printed.splitlines()[1:]), flush=True)


if __name__ == "__main__":
    sys.exit(main())
