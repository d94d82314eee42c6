"""A stranger reads what is painted: Tesseract, of words and glyphs in eight fonts. benchmarks/legible.py has all of
them; this is a sample."""

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from lettering import PACKAGES, Lettering

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from legible import GLYPHS, readings, words

SEED = 20261
WORDS, GLYPHS_EACH = 9, 10  # of each font
LESS = 0.02
LESS_WORDS = 2  # of one font: one word tells nothing; 3 where an a was painted as an o
TRUETYPE = Path("/usr/share/fonts/truetype/dejavu")
OPENTYPE = Path("/usr/share/fonts/opentype")
FONTS = (
    TRUETYPE / "DejaVuSans.ttf",
    TRUETYPE / "DejaVuSans-Bold.ttf",
    TRUETYPE / "DejaVuSerif.ttf",
    TRUETYPE / "DejaVuSerif-Bold.ttf",
    OPENTYPE / "ebgaramond/EBGaramond12-Bold.otf",
    OPENTYPE / "lobster/lobster.otf",
    OPENTYPE / "kaushanscript/KaushanScript-Regular.otf",
)


@pytest.fixture(scope="module")
def fonts(npm):
    files = [file.read_bytes() for file in FONTS]
    return [*files, Lettering(npm("lettering", PACKAGES)).font("brush")]


def test_what_is_painted_is_read_as_what_was_drawn(fonts):
    print(f"seed {SEED}")
    choice = np.random.default_rng(SEED)
    totals = np.zeros(2, int)
    count = 0
    with ProcessPoolExecutor(2) as pool:
        for font in fonts:
            for texts, size in ((words(), WORDS), (list(GLYPHS), GLYPHS_EACH)):
                done = readings(choice.choice(texts, size, replace=False).tolist(), font, pool)
                drawn, painted = done.right()
                totals += drawn, painted
                assert painted >= drawn - LESS_WORDS or texts[0] in GLYPHS, f"{done.spoilt()}"
                count += size
                print(drawn, painted, [(each.text, said) for each, said in done.spoilt()])
    drawn, painted = totals
    print(f"of {count}, {drawn} read as drawn, {painted} as painted")
    assert drawn > 0.8 * count, "it reads what is drawn"
    assert painted >= drawn - LESS * count
