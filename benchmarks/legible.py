"""Measure whether painted letters are legible.

Tesseract reads words, and single letters and digits, both as the font draws them and as the brush paints
them.

The words are every 1,000th of the words in Debian's wamerican with 4 to 8 letters and without apostrophes.
For single glyphs, capitals and small letters of one shape count as equal, and so do O and 0, and l, I and 1.
A letter that is read twice, such as Vv, counts as that letter. Each font is painted as large as in
benchmarks/letters.py.

FONT is a file, TrueType, OpenType or WOFF; tesseract-ocr and wamerican are Debian's packages. --pictures
keeps the texts that were read wrong as painted and right as drawn.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from letters import GLYPHS, fitting_mm

from brushsvg import find_brush
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.skeleton import filled_rings

WORDS = Path("/usr/share/dict/american-english")
NTH = 1000
EM_PX, MARGIN_PX, FINE = 72, 24, 4  # Tesseract was trained with letters of about this height
WORD, GLYPH = 8, 10  # Tesseract's modes: the content of a picture
ONE_SHAPE = str.maketrans("CKOPSUVWXZ0lI|i", "ckopsuvwxzo1111")


def words() -> list[str]:
    lines = WORDS.read_text(encoding="utf-8").split("\n")
    return [line for line in lines if 4 <= len(_letters(line)) <= 8][::NTH]


def _letters(text: str) -> str:
    return re.sub(r"[\W_]", "", text)


@dataclass(frozen=True)
class Case:
    """A text, with its pictures as drawn by the font and as painted."""

    text: str
    drawn: np.ndarray
    painted: np.ndarray

    @property
    def mode(self) -> int:
        return GLYPH if len(self.text) == 1 else WORD

    def is_right(self, read: str) -> bool:
        if self.mode == WORD:
            return _letters(read) == _letters(self.text)
        one_shape = re.sub(r"\s", "", read).translate(ONE_SHAPE)
        return re.sub(r"(.)\1+", r"\1", one_shape) == self.text.translate(ONE_SHAPE)


def case(text: str, font: bytes, size_mm: float, brush_name: str, compensation: str) -> Case:
    brush = find_brush(brush_name)  # a brush cannot be sent between processes, so each process finds it
    document, _ = text_svg(text, font, size_mm=size_mm)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "text.svg")
        file.write_text(document, encoding="utf-8")
        work = prepare(file, Options(brush=brush, compensation=compensation))
    rings = [ring for element in read_svg(document.encode()).elements for ring in filled_rings(element)]
    mark = predict(work).outline_mm
    px_per_mm = EM_PX / size_mm
    return Case(text, _picture(rings, px_per_mm), _picture(mark, px_per_mm))


def _picture(rings: list[np.ndarray], px_per_mm: float) -> np.ndarray:
    """Return a picture of rings, black on white."""
    points = np.vstack(rings)
    low, high = points.min(axis=0), points.max(axis=0)
    width, height = np.ceil((high - low) * px_per_mm).astype(int) + 2 * MARGIN_PX
    image = np.full((height * FINE, width * FINE), 255, np.uint8)
    upper_left = np.array([low[0], high[1]])
    pixels = [
        np.round((((ring - upper_left) * (1, -1)) * px_per_mm + MARGIN_PX) * FINE).astype(np.int32) for ring in rings
    ]
    cv2.fillPoly(image, pixels, 0)
    return cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)


def read(pictures: Sequence[np.ndarray], mode: int) -> list[str]:
    """Return the text that Tesseract reads on each picture."""
    if not pictures:
        return []
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder, f"{k}.png") for k in range(len(pictures))]
        for file, picture in zip(files, pictures, strict=True):
            cv2.imwrite(str(file), picture)
        listed = Path(folder, "files.txt")
        listed.write_text("\n".join(map(str, files)), encoding="utf-8")
        done = subprocess.run(
            ["tesseract", str(listed), "-", "--psm", str(mode), "--dpi", "300", "-l", "eng"],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "OMP_THREAD_LIMIT": "1"},
        )
    pages = done.stdout.removesuffix("\f").split("\f")
    if len(pages) != len(pictures):
        raise RuntimeError(f"{len(pictures)} pictures, and {len(pages)} were read: {done.stderr[-200:]}")
    return [page.strip() for page in pages]


@dataclass(frozen=True)
class Readings:
    """The readings of some texts in one font, as drawn and as painted."""

    cases: list[Case]
    drawn: list[str]
    painted: list[str]

    def right(self) -> tuple[int, int]:
        """Return the number of right readings as drawn, and as painted."""
        sums = (sum(map(Case.is_right, self.cases, texts)) for texts in (self.drawn, self.painted))
        return next(sums), next(sums)

    def spoilt(self) -> list[tuple[Case, str]]:
        """Return the cases read right as drawn and wrong as painted."""
        rows = zip(self.cases, self.drawn, self.painted, strict=True)
        return [(each, painted) for each, drawn, painted in rows if each.is_right(drawn) > each.is_right(painted)]


def readings(
    texts: Sequence[str],
    font: bytes,
    pool: Executor,
    brush_name: str = "round-6",
    compensation: str = "closed",
) -> Readings:
    """Read texts, which are only words or only glyphs."""
    size_mm = fitting_mm(font, find_brush(brush_name))
    one = partial(case, font=font, size_mm=size_mm, brush_name=brush_name, compensation=compensation)
    cases = list(pool.map(one, texts))
    mode = cases[0].mode
    return Readings(cases, read([each.drawn for each in cases], mode), read([each.painted for each in cases], mode))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("font", type=Path, nargs="+")
    parser.add_argument("--brush", default="round-6")
    parser.add_argument("--compensation", default="closed")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--pictures", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    print(f"{'font':<26}{'':<8}{'texts':>5}{'drawn':>7}{'painted':>9}  read wrong as painted alone")
    with ProcessPoolExecutor(options.processes) as pool:
        for file in options.font:
            for kind, texts in (("words", words()), ("glyphs", list(GLYPHS))):
                done = readings(texts, file.read_bytes(), pool, options.brush, options.compensation)
                drawn, painted = done.right()
                wrong = ", ".join(f"{each.text}: {reading or '-'}" for each, reading in done.spoilt())
                print(f"{file.stem[:25]:<26}{kind:<8}{len(texts):>5}{drawn:>7}{painted:>9}  {wrong}", flush=True)
                if options.pictures:
                    _keep(options.pictures / f"{file.stem}-{kind}.png", done.spoilt())


def _keep(file: Path, spoilt: list[tuple[Case, str]]) -> None:
    if not spoilt:
        return
    both = [picture for each, _ in spoilt for picture in (each.drawn, each.painted)]
    width = max(picture.shape[1] for picture in both)
    rows = [np.pad(one, ((0, 0), (0, width - one.shape[1])), constant_values=255) for one in both]
    file.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(file), np.vstack(rows))


if __name__ == "__main__":
    sys.exit(main())
