"""Draw the four alphabets of docs/explanation/letters.md.

    draw_alphabets.py FOLDER

`brushsvg preview --show strokes` draws them. FOLDER is the folder into which npm has put the fonts:
npm install --prefix FOLDER --no-save @fontsource/open-sans @fontsource/lora @fontsource/kaushan-script
@fontsource/caveat-brush
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

FONTS = {"sans": "open-sans", "serif": "lora", "script": "kaushan-script", "brush": "caveat-brush"}
TEXT = r"ABCDEFGHI\nJKLMNOPQR\nSTUVWXYZ\nabcdefghi\njklmnopqr\nstuvwxyz"


def without_list(image: np.ndarray) -> np.ndarray:
    """Return the sheet alone, in few colours.

    The list of a hundred strokes below the sheet is longer than the alphabet.
    """
    on_sheet = (image == 255).all(axis=2).mean(axis=1) > 0.3
    low, high = np.flatnonzero(on_sheet)[[0, -1]]
    return (image[low:high] // 8 * 8 + 7).astype(np.uint8)


def main() -> None:
    modules, docs = (
        Path(sys.argv[1]) / "node_modules" / "@fontsource",
        Path(__file__).parents[1] / "docs" / "explanation",
    )
    command = Path(sys.executable).with_name("brushsvg")
    with tempfile.TemporaryDirectory() as folder:
        for kind, name in FONTS.items():
            font = modules / name / "files" / f"{name}-latin-400-normal.woff"
            drawing = Path(folder, f"{kind}.svg")
            subprocess.run([command, "text", TEXT, "-o", drawing, "--font", font, "--size", "30"], check=True)
            picture = Path(folder, f"{kind}.png")
            subprocess.run([command, "preview", drawing, "-o", picture, "--show", "strokes"], check=True)
            cv2.imwrite(str(docs / f"letters-{kind}.png"), without_list(cv2.imread(str(picture))))


if __name__ == "__main__":
    main()
