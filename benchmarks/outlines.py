"""Time the search for strokes of filled letters, in ms of processor time per glyph and stage.

The peer is scikit-image's medial axis of the same glyphs, drawn at 20 px/mm. It ends after our second stage, with
pixels of a middle line instead of strokes.

The program needs a font (TrueType, OpenType or WOFF) and, for the peer, `pip install scikit-image`.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import cv2
import numpy as np

from brushsvg import _core
from brushsvg.geometry.rings import with_holes
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.skeleton import filled_rings
from brushsvg.strokes.skeleton.graph import build_skeleton
from brushsvg.strokes.skeleton.reading_order import order_strokes
from brushsvg.strokes.skeleton.shape_to_strokes import (
    MIN_BRANCH_AREA,
    MIN_LIMB_AREA,
    _find_area_strokes,
    outline_strokes,
)
from brushsvg.strokes.skeleton.writing_order import join_pieces

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789&"
PX_PER_MM = 20
SCRIPT = "latin"


def glyphs(font: bytes, count: int, size_mm: float) -> list:
    """Return filled elements, one per letter, in repeated order."""
    document, _ = text_svg(LETTERS, font, size_mm=size_mm)
    elements = read_svg(document.encode()).elements
    return [elements[k % len(elements)] for k in range(count)]


def pixels(rings) -> np.ndarray:
    low, high = np.vstack(rings).min(axis=0), np.vstack(rings).max(axis=0)
    width, height = np.ceil((high - low) * PX_PER_MM).astype(int) + 4
    mask = np.zeros((height, width), np.uint8)
    cv2.fillPoly(mask, [np.round((ring - low) * PX_PER_MM + 2).astype(np.int32) for ring in rings], 1)
    return mask.astype(bool)


def ms_each(things, work) -> tuple[float, list]:
    begin = time.process_time()
    made = [work(thing) for thing in things]
    return 1e3 * (time.process_time() - begin) / len(things), made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("font", type=Path)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--size", type=float, default=50.0, help="mm to the em")
    options = parser.parse_args()
    elements = glyphs(options.font.read_bytes(), options.count, options.size)

    filling, shapes = ms_each(elements, filled_rings)
    areas = [area for shape in shapes for area in with_holes(shape)]
    per_glyph = len(areas) / len(shapes)
    axis, axes = ms_each(areas, lambda area: _core.medial_axis(area, MIN_BRANCH_AREA, MIN_LIMB_AREA))
    joined_up = list(zip(areas, axes, strict=True))
    joining, found = ms_each(joined_up, lambda each: build_skeleton(each[0], *each[1]))
    directing, chains = ms_each(found, lambda each: join_pieces(each.pieces, each, SCRIPT) if each.pieces else [])
    lines = [[np.vstack([piece.line for piece in chain]) for chain in each] for each in chains]
    boxes = [np.array([[*area[0].min(axis=0), *area[0].max(axis=0)]]) for area in areas]
    ordering, _ = ms_each(
        [each for each in zip(boxes, lines, strict=True) if each[1]],
        lambda each: order_strokes(each[0], [each[1]], SCRIPT),
    )
    writing = directing + ordering
    strokes, made = ms_each(joined_up, lambda each: _find_area_strokes(each[0], *each[1], SCRIPT))
    whole, _ = ms_each(shapes, lambda rings: outline_strokes(rings, SCRIPT))
    edges = np.mean([sum(map(len, shape)) for shape in shapes])
    count = sum(len(each) for each in made)
    print(f"{len(shapes)} glyphs of {options.font.name}, {options.size:g} mm to the em: {edges:.0f} edges and")
    print(f"{count / len(shapes):.2f} strokes each")
    print(f"  {'flattening and filling':<46} {filling:7.2f} ms")
    print(f"  {'medial axis':<46} {axis * per_glyph:7.2f} ms")
    print(f"  {'crossings, lines':<46} {joining * per_glyph:7.2f} ms")
    print(f"  {'direction, corners, order':<46} {writing * per_glyph:7.2f} ms")
    print(f"  {'curves, widths, parts of the shape':<46} {(strokes - joining - directing) * per_glyph:7.2f} ms")
    print(f"  {'all (aim: 10 ms)':<46} {filling + whole:7.2f} ms")
    try:
        from skimage.morphology import medial_axis
    except ImportError:
        print("  scikit-image is not here: no peer")
        return
    few = [pixels(shape) for shape in shapes[: min(len(LETTERS), len(shapes))]]
    peer, _ = ms_each(few, lambda mask: medial_axis(mask, return_distance=True))
    print(f"  {'peer: scikit-image, medial_axis at 20 px/mm':<46} {peer:7.2f} ms")


if __name__ == "__main__":
    main()
