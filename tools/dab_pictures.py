"""Make the picture of dabs in docs/explanation/calibration.md.

    dab_pictures.py [FOLDER]    keeps the files of the commands in FOLDER

The picture shows a photograph of dabs of a lopsided brush, next to the readings from the photograph. The slow
simulator of tests/laws makes the paint and the photograph, because no real dabs were available.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))
from test_dabs import assumed, lopsided, painted, photo_of, printed

from brushsvg.calibration.chart.file import write_chart
from brushsvg.model.library import save_brush

ROOT = Path(__file__).parents[1]
TALL_PX = 900
DETAIL_MM = (70.0, 45.0)  # size of the upper left part of read.png that is shown


def side_by_side(names: list[Path], tall: int) -> np.ndarray:
    pictures = [cv2.imread(str(name)) for name in names]
    scaled = [
        cv2.resize(each, (round(each.shape[1] * tall / each.shape[0]), tall), interpolation=cv2.INTER_AREA)
        for each in pictures
    ]
    gap = np.full((tall, 12, 3), 255, np.uint8)
    return np.hstack([part for each in scaled for part in (each, gap)][:-1])


def main(folder: Path) -> None:
    (folder / "dabs.jpg").write_bytes(photo_of(painted(lopsided)))
    (folder / "dabs.json").write_text(write_chart(printed()))
    save_brush(assumed(), folder / "mine.json")
    words = "calibrate dabs.jpg --chart dabs.json --brush mine.json -o own.json --picture read.png --plot own.png"
    subprocess.run([Path(sys.executable).with_name("brushsvg"), *words.split()], cwd=folder, check=True)
    read = cv2.imread(str(folder / "read.png"))
    size = read.shape[1] / printed().plan.sheet_mm[0]
    tall, wide = (round(side * size) for side in DETAIL_MM[::-1])
    cv2.imwrite(str(folder / "detail.png"), read[:tall, :wide])
    both = side_by_side([folder / "dabs.jpg", folder / "detail.png"], TALL_PX)
    cv2.imwrite(str(ROOT / "docs" / "explanation" / "dabs_read.jpg"), both, [cv2.IMWRITE_JPEG_QUALITY, 80])


if __name__ == "__main__":
    if len(sys.argv) > 1:
        Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as name:
            main(Path(name))
