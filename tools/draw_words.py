"""Draw docs/evidence/words.png: words in fonts, and as round-6 paints them.

    draw_words.py FONT WORD [FONT WORD ...]

Each row first shows the word in its font. Next is the paint of round-6 when strokes simply begin, end and
turn (--start pointed --end round --corners turn), and last the paint by default. Words have the size that
benchmarks/letters.py gives them.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

from brushsvg import find_brush
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.skeleton import filled_rings

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
from letters import fitting_mm

WAYS = ({"start": "pointed", "end": "round", "corners": "turn"}, {})
EM_PX, FINE, MARGIN_PX = 84, 4, 12
PAPER, INK, PAINT = 255, (40, 40, 40), (150, 70, 30)  # BGR


def row(font: bytes, word: str) -> list[np.ndarray]:
    brush = find_brush("round-6")
    size_mm = fitting_mm(font, brush)
    document, _ = text_svg(word, font, size_mm=size_mm)
    drawn = [ring for element in read_svg(document.encode()).elements for ring in filled_rings(element)]
    marks = []
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "word.svg")
        file.write_text(document, encoding="utf-8")
        for way in WAYS:
            marks.append(predict(prepare(file, Options(brush=brush, **way))).outline_mm)
    points = np.vstack([*drawn, *(ring for rings in marks for ring in rings)])
    box = points.min(axis=0), points.max(axis=0)
    return [
        picture(rings, box, EM_PX / size_mm, colour)
        for rings, colour in ((drawn, INK), *((rings, PAINT) for rings in marks))
    ]


def picture(rings: list[np.ndarray], box, px_per_mm: float, colour) -> np.ndarray:
    low, high = box
    width, height = np.ceil((high - low) * px_per_mm).astype(int) + 2 * MARGIN_PX
    image = np.full((height * FINE, width * FINE, 3), PAPER, np.uint8)
    places = [(ring - (low[0], high[1])) * (px_per_mm, -px_per_mm) + MARGIN_PX for ring in rings]
    cv2.fillPoly(image, [np.round(each * FINE).astype(np.int32) for each in places], colour)
    return cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)


def main() -> None:
    pairs = zip(sys.argv[1::2], sys.argv[2::2], strict=True)
    rows = [row(Path(file).read_bytes(), word) for file, word in pairs]
    width = max(image.shape[1] for cells in rows for image in cells)
    lines = [
        np.hstack([np.pad(each, ((0, 0), (0, width - each.shape[1]), (0, 0)), constant_values=PAPER) for each in cells])
        for cells in rows
    ]
    cv2.imwrite(str(Path(__file__).parents[1] / "docs" / "evidence" / "words.png"), np.vstack(lines) // 16 * 16 + 15)


if __name__ == "__main__":
    main()
