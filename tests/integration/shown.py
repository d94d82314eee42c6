"""Drawings as Chromium shows them and as we would paint them, in equal pixels."""

import base64
import subprocess

import cv2
import numpy as np
import shapely

from brushsvg import Error
from brushsvg.read import ReadOptions
from brushsvg.read.svg import read_svg

SIDE = 200  # size of each drawing in px
SCALE = 2
PER_ROW, PER_COLUMN = 20, 15
MM = 25.4 / 96


def shown(drawings: list[str], folder) -> list[np.ndarray]:
    """Return the darkness (h, w) of each drawing, 0 to 1."""
    step = PER_ROW * PER_COLUMN
    found = []
    for first in range(0, len(drawings), step):
        found += _shown(drawings[first : first + step], folder)
    return found


def _shown(drawings: list[str], folder) -> list[np.ndarray]:
    images = "".join(
        f'<img style="position:absolute;left:{k % PER_ROW * SIDE}px;top:{k // PER_ROW * SIDE}px;width:{SIDE}px;'
        f'height:{SIDE}px" src="data:image/svg+xml;base64,{base64.b64encode(text.encode()).decode()}">'
        for k, text in enumerate(drawings)
    )
    html, picture = folder / "page.html", folder / "page.png"
    html.write_text(f'<!doctype html><body style="margin:0;background:#fff">{images}', encoding="utf-8")
    words = [
        *("chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--lang=en"),
        *(f"--force-device-scale-factor={SCALE}", "--virtual-time-budget=2000"),
        *("--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={folder / 'profile'}"),
        *(f"--window-size={SIDE * PER_ROW},{SIDE * PER_COLUMN}", f"--screenshot={picture}", html.as_uri()),
    ]
    subprocess.run(words, capture_output=True, timeout=300, check=True)
    dark = 1 - cv2.imread(str(picture), cv2.IMREAD_GRAYSCALE) / 255
    px = SIDE * SCALE
    return [
        dark[k // PER_ROW * px : (k // PER_ROW + 1) * px, k % PER_ROW * px : (k % PER_ROW + 1) * px]
        for k in range(len(drawings))
    ]


def painted(text: str, cap: str = "round"):
    """Return the darkness (h, w) of our reading of a drawing, and all its notices."""
    try:
        design = read_svg(text.encode(), ReadOptions(lenient=True))
    except Error as refusal:
        return np.zeros((SIDE * SCALE, SIDE * SCALE)), [str(refusal)]
    sheet = (0.0, 0.0, SIDE * MM, SIDE * MM)
    mark = shapely.union_all([_mark(element, cap) for element in design.elements]).intersection(shapely.box(*sheet))
    reported = [f"{n.where}: {n.sentence}" for n in design.notices if n.code != "dashed"]
    return _pixels(mark, design.sheet_mm[1]), reported


def _mark(element, cap: str):
    rings = [_line(subpath.cubics) for subpath in element.subpaths]
    mark = shapely.Polygon()
    if element.fill_rule:
        join = shapely.union if element.fill_rule == "nonzero" else shapely.symmetric_difference
        for ring in rings:
            if len(ring) > 3:
                mark = join(mark, shapely.Polygon(ring).buffer(0))
    if element.stroke_width_mm:
        mark = mark.union(
            shapely.union_all([shapely.LineString(r).buffer(element.stroke_width_mm / 2, cap_style=cap) for r in rings])
        )
    return mark


def _line(cubics: np.ndarray) -> np.ndarray:
    t = np.linspace(0, 1, 17)[:, None, None]
    p = cubics.transpose(1, 0, 2)
    points = (1 - t) ** 3 * p[0] + 3 * t * (1 - t) ** 2 * p[1] + 3 * t**2 * (1 - t) * p[2] + t**3 * p[3]
    points = np.concatenate([p[0, :1], *points[1:].transpose(1, 0, 2)])
    return points


def _pixels(mark, height_mm: float) -> np.ndarray:
    fine = 4 * SCALE
    image = np.zeros((SIDE * fine, SIDE * fine), np.uint8)
    polygons = [g for g in getattr(mark, "geoms", [mark]) if g.geom_type == "Polygon" and not g.is_empty]

    def pixels(ring):
        points = (np.array(ring.coords)[:, :2] * [1, -1] + [0, height_mm]) / MM * fine
        return np.round((points - 0.5) * 256).astype(np.int32)

    for polygon in polygons:
        cv2.fillPoly(image, [pixels(polygon.exterior)], 255, shift=8)
        for hole in polygon.interiors:
            cv2.fillPoly(image, [pixels(hole)], 0, shift=8)
    return cv2.resize(image, (SIDE * SCALE, SIDE * SCALE), interpolation=cv2.INTER_AREA) / 255.0


def difference(theirs: np.ndarray, ours: np.ndarray) -> float:
    """Return the share of the area that only one of them shows.

    Differences below 3 px come from another smoothing of an edge.
    """
    off = np.abs(theirs - ours)
    off[off < 0.1] = 0
    kept = cv2.morphologyEx((off > 0).astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    return float((off * kept).sum() / max(np.maximum(theirs, ours).sum(), 1.0))
