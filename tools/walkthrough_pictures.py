"""The pictures of docs/walkthrough.md: its commands in an empty folder, a rendered photograph where a phone's would be.

    walkthrough_pictures.py [FOLDER]    keeps in FOLDER what the commands wrote

Paint is that of the slow simulator of tests/laws, and so is the camera: no real chart was at hand.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))
import painter
import photograph

from brushsvg.calibration.chart.file import read_chart

ROOT = Path(__file__).parents[1]
GUIDE = ROOT / "docs" / "walkthrough.md"
TRUTH = painter.TrueBrush(
    10.0, np.array([2.6, 1.3, 0.1, -0.009]), np.array([0.0, 0.45]), np.array([0.0, 0.5, -0.005]), 1.6, 0.9
)
FAULTS = painter.Faults(noise=0.05, noise_length=0.5, displacement=0.2, placement=0.8, turn=0.008, height=0.1)
CAMERA = photograph.Camera(size_px=(1800, 2500), tilt_deg=(5.0, -4.0), turn_deg=3.0, fill=0.9, shadow=0.3)
INDENT = "    brushsvg "
PHOTO = "photo.jpg"


def commands() -> list[list[str]]:
    """The words after brushsvg of the guide's indented lines."""
    return [
        shlex.split(line.removeprefix(INDENT), comments=True)
        for line in GUIDE.read_text(encoding="utf-8").splitlines()
        if line.startswith(INDENT)
    ]


def photo_of(chart_json: bytes) -> bytes:
    """A JPEG of the chart, painted by TRUTH."""
    made = read_chart(chart_json)
    ways = [(one.stroke, np.array(one.poses_mm)) for one in made.plan.passes]
    sheet = photograph.page(made)
    for _, _, rings in painter.paint(np.random.default_rng(11), TRUTH, ways, FAULTS).marks:
        sheet.paint(rings, photograph.BLUE)
    return photograph.photograph(sheet, CAMERA)


def side_by_side(names: list[Path], tall: int) -> np.ndarray:
    pictures = [cv2.imread(str(name)) for name in names]
    scaled = [
        cv2.resize(each, (round(each.shape[1] * tall / each.shape[0]), tall), interpolation=cv2.INTER_AREA)
        for each in pictures
    ]
    gap = np.full((tall, 12, 3), 255, np.uint8)
    return np.hstack([part for each in scaled for part in (each, gap)][:-1])


def main(folder: Path) -> None:
    for words in commands():
        if PHOTO in words:
            (folder / PHOTO).write_bytes(photo_of((folder / "chart.json").read_bytes()))
        print("brushsvg", *words, flush=True)
        subprocess.run([Path(sys.executable).with_name("brushsvg"), *words], cwd=folder, check=True)
    read = side_by_side([folder / PHOTO, folder / "read.png"], 900)
    cv2.imwrite(str(ROOT / "docs" / "walkthrough_read.jpg"), read, [cv2.IMWRITE_JPEG_QUALITY, 80])
    word = cv2.imread(str(folder / "word.png"))
    size = min(1.0, 900 / word.shape[1])
    word = cv2.resize(word, None, fx=size, fy=size, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(ROOT / "docs" / "walkthrough_word.jpg"), word, [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    if len(sys.argv) > 1:
        Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as name:
            main(Path(name))
