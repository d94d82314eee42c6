"""Measure the edges of 47 wide shapes that are filled in passes (`--wide passes`).

Each mark is compared with its shape. The columns are:

  passes    number of lines that fill the shape
  poses     number of poses of the plan
  overlap   common area over joint area of mark and shape
  notch     largest gap between the shape's edge and the paint, at least 3 mm from its corners [mm]
  inner     the same, within 3 mm of corners that point inwards
  outer     the same, within 3 mm of corners that point outwards
  bulge     largest distance of paint outside the shape [mm]
  gap       width of the widest blank piece within the paint [mm]
  thorns    corners of the mark beyond 20 degrees that stick out of the shape by more than 0.3 mm
  s         seconds to read, fill and plan

Letters are drawn with fonts of Debian's packages fonts-dejavu-core, fonts-dejavu-extra, fonts-ebgaramond, fonts-lobster
and fonts-kaushanscript. They are so large that the stem of an l is --times as wide as the brush paints. NAME selects
shapes by their printed names. --pictures draws each shape: paint is blue, bare parts are red, overspill is black.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import shapely
from letters import _drawn, _thorns, _turns

from brushsvg import _core, find_brush
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.skeleton import filled_rings
from brushsvg.strokes.swept_areas import region

FONTS = Path("/usr/share/fonts")
FACES = {
    "sans": "truetype/dejavu/DejaVuSans-Bold.ttf",
    "serif": "truetype/dejavu/DejaVuSerif-Bold.ttf",
    "garamond": "opentype/ebgaramond/EBGaramond12-Bold.otf",
    "lobster": "opentype/lobster/lobster.otf",
    "kaushan": "opentype/kaushanscript/KaushanScript-Regular.otf",
}
LETTERS = {"sans": "BSgRae2", "serif": "3tRga", "garamond": "fagRS", "lobster": "aRgB", "kaushan": "aR"}
CORNER_RAD, CORNER_MM = np.radians(30), 3.0
EVEN_MM, PX_PER_MM = 0.05, 14


def _polygon(points) -> str:
    return "M" + "L".join(f"{x:.4f} {y:.4f}" for x, y in points) + "Z"


def _star(tips: int, far: float, near: float) -> str:
    turns = np.pi * np.arange(2 * tips) / tips
    reach = np.tile([far, near], tips)
    return _polygon(50 + reach[:, None] * np.column_stack([np.sin(turns), -np.cos(turns)]))


def _disc(wide: float) -> str:
    r = wide / 2
    return f"M{50 - r} 50A{r} {r} 0 1 1 {50 + r} 50A{r} {r} 0 1 1 {50 - r} 50Z"


DRAWN = {
    "square": "M5 0H50V45H5Z",
    "triangle": "M5 48H55L30 4.7Z",
    "heart": "M40 49C12 26 10 17 10 15A15 13 0 0 1 40 11A15 13 0 0 1 70 15C70 17 68 26 40 49Z",
    "bow-tie": "M10 5L70 45V5L10 45Z",
    "bow-tie on its side": "M5 4L95 45V4L5 45Z",
    "plate with a hole": "M5 0H50V45H5ZM17 25a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z",
    "star": "M40 0L46.2 17.9L65 18.2L50 29.7L55.5 47.7L40 37L24.5 47.7L30 29.7L15 18.2L33.8 17.9Z",
    "star of five": _star(5, 45, 18),
    "star of six": _star(6, 38, 20),
    "ring": "M40 1A24 24 0 1 1 39.99 1ZM40 15A10 10 0 1 0 40.01 15Z",
    "disc": _disc(48),
    "bar": "M5 20H85V36H5Z",
    "short bar": "M30 20H54V36H30Z",
    "round short bar": "M35 10H55A8 8 0 0 1 55 26H35A8 8 0 0 1 35 10Z",
    "slanted bar": "M5 40L20 12H90L75 40Z",
    "ell": "M10 0H26V32H60V48H10Z",
    "cross": "M30 5H46V30H71V46H46V71H30V46H5V30H30Z",
    "arrow": "M5 17H45V3L75 25L45 47V33H5Z",
    "comb": "M5 5H85V45H70V20H62V45H50V20H40V45H25V20H20V45H5Z",
    "pentagon": "M40 1L68.5 21.7L57.6 55.3H22.4L11.5 21.7Z",
    "diamond": "M40 1L60 36L40 71L20 36Z",
    "crescent": "M50 5A30 30 0 1 0 70 62A34 34 0 0 1 50 5Z",
    "leaf": "M5 30Q45 -5 85 30Q45 65 5 30Z",
    "drop": "M40 2C50 22 62 32 62 46A22 22 0 0 1 18 46C18 32 30 22 40 2Z",
}
ROUND = {f"disc {times} wide": times for times in (1.1, 1.25, 1.5, 1.75, 2.0)}


@dataclass
class Filled:
    name: str
    passes: int
    poses: int
    overlap: float
    notch_mm: float
    inner_mm: float
    outer_mm: float
    bulge_mm: float
    gap_mm: float
    thorns: int
    seconds: float

    def row(self) -> str:
        return (
            f"{self.name:<22}{self.passes:>7.4g}{self.poses:>7.4g}{self.overlap:>9.4f}{self.notch_mm:>7.2f}"
            f"{self.inner_mm:>7.2f}{self.outer_mm:>7.2f}{self.bulge_mm:>7.2f}{self.gap_mm:>6.2f}{self.thorns:>8.3g}{self.seconds:>7.2f}"
        )


def names() -> list[str]:
    return [*DRAWN, *(f"{face} {letter}" for face, some in LETTERS.items() for letter in some)]


def document(name: str, brush, times: float) -> str:
    wide_mm = 2 * brush.half_width_range_mm()[1]
    d = DRAWN.get(name) or (_disc(ROUND[name] * wide_mm) if name in ROUND else None)
    if d:
        return (
            '<svg xmlns="http://www.w3.org/2000/svg" width="110mm" height="110mm" viewBox="-5 -5 110 110">'
            f'<path id="p" d="{d}" fill="#000"/></svg>'
        )
    face, letter = name.split()
    font = (FONTS / FACES[face]).read_bytes()
    stem = region(filled_rings(_drawn("l", font, 100.0)))
    size_mm = 100 * times * wide_mm / (2 * shapely.maximum_inscribed_circle(stem, 0.01).length)
    return text_svg(letter, font, size_mm=float(size_mm))[0]


def fill(name: str, brush_name: str, times: float, pictures: Path | None) -> Filled:
    brush = find_brush(brush_name)
    drawing = document(name, brush, times)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "shape.svg")
        file.write_text(drawing, encoding="utf-8")
        begun = time.process_time()
        work = prepare(file, Options(brush=brush, wide="passes"))
        seconds = time.process_time() - begun
    rings = [ring for element in read_svg(drawing.encode()).elements for ring in filled_rings(element)]
    mark_rings = predict(work).outline_mm
    shape, mark = region(rings), region(mark_rings)
    if pictures:
        pictures.mkdir(parents=True, exist_ok=True)
        cv2.imwrite(str(pictures / f"{re.sub(' ', '-', name)}.png"), picture(shape, mark, work.strokes))
    edge = shapely.segmentize(shape.boundary, EVEN_MM)
    places = shapely.get_coordinates(edge)
    off = shapely.distance(mark, shapely.points(places))
    inner, outer = (
        shapely.dwithin(shapely.multipoints(some), shapely.points(places), CORNER_MM)
        if some
        else np.zeros(len(places), bool)
        for some in _corners(shape)
    )
    amid = [
        2 * shapely.maximum_inscribed_circle(piece, 0.01).length
        for piece in shapely.get_parts(shapely.difference(shape, mark))
        if shapely.distance(piece, shape.boundary) > EVEN_MM
    ]
    return Filled(
        name,
        len(work.strokes),
        sum(len(each.poses_mm) for each in work.plan.passes),
        shape.intersection(mark).area / shape.union(mark).area,
        *(float(off[some].max(initial=0.0)) for some in (~inner & ~outer, inner & ~outer, outer)),
        float(shapely.distance(shape, shapely.points(shapely.get_coordinates(mark))).max()),
        max(amid, default=0.0),
        _thorns(mark_rings, shape),
        seconds,
    )


def _corners(shape) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return corners that point inwards, and corners that point outwards."""
    found: tuple[list, list] = [], []
    for ring in _all_rings(shapely.orient_polygons(shape)):
        points = np.array(ring.simplify(0.02).coords)[:-1]
        turns = _turns(points)
        for some, beyond in zip(found, (-turns, turns), strict=True):
            some += list(points[beyond > CORNER_RAD])
    return found


def _all_rings(shape) -> list:
    return [ring for part in shapely.get_parts(shape) for ring in (part.exterior, *part.interiors)]


def picture(shape, mark, strokes) -> np.ndarray:
    low, high = np.array(shape.bounds).reshape(2, 2) + np.array([[-2], [2]])
    width, height = np.ceil((high - low) * PX_PER_MM).astype(int)
    image = np.full((height, width, 3), 255, np.uint8)

    def pixels(points):
        return [np.round((np.asarray(points)[:, :2] - (low[0], high[1])) * (PX_PER_MM, -PX_PER_MM)).astype(np.int32)]

    def fill(area, colour):
        for part in shapely.get_parts(area):
            if part.geom_type == "Polygon" and not part.is_empty:
                cv2.fillPoly(
                    image,
                    [p for r in (part.exterior, *part.interiors) for p in pixels(r.coords)],
                    colour,
                    cv2.LINE_AA,
                )

    fill(mark, (225, 200, 170))
    fill(shapely.difference(shape, mark), (0, 0, 255))
    fill(shapely.difference(mark, shape), (0, 0, 0))
    for stroke in strokes:
        way = _core.flatten(stroke, 0.02)
        cv2.polylines(image, pixels(way), False, (60, 140, 60), 1, cv2.LINE_AA)
        cv2.circle(image, pixels(way[:1])[0][0].tolist(), 4, (60, 140, 60), -1, cv2.LINE_AA)
    return image


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="*", help="as printed; without any all 47")
    parser.add_argument("--brush", default="round-6")
    parser.add_argument("--times", type=float, default=3.0, help="the brush's width a letter's stem is wide")
    parser.add_argument("--discs", action="store_true", help="discs 1.1 to 2 times as wide as the brush")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--pictures", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    some = list(ROUND) if options.discs else options.name or names()
    print(
        f"{'':<22}{'passes':>7}{'poses':>7}{'overlap':>9}{'notch':>7}{'inner':>7}{'outer':>7}{'bulge':>7}{'gap':>6}{'thorns':>8}{'s':>7}"
    )
    work = partial(fill, brush_name=options.brush, times=options.times, pictures=options.pictures)
    done = []
    with ProcessPoolExecutor(options.processes) as pool:
        for each in pool.map(work, some):
            done.append(each)
            print(each.row(), flush=True)
    values = np.array([[v for v in vars(each).values() if not isinstance(v, str)] for each in done], float)
    mean = values.mean(axis=0)
    print(Filled(f"mean of {len(done)}", *mean).row())


if __name__ == "__main__":
    sys.exit(main())
