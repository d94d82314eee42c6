"""The guide's commands as they stand in it, in an empty folder, a rendered photograph where a phone's would be."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from command import brushsvg
from diagnostics import gives

sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
from walkthrough_pictures import GUIDE, PHOTO, TRUTH, commands, photo_of

from brushsvg import find_brush

MOST_COMMANDS = 8


@pytest.fixture(scope="module")
def followed(tmp_path_factory):
    """The folder after the last command, and by command what was told."""
    folder = tmp_path_factory.mktemp("walk")
    told = {}
    for words in commands():
        if PHOTO in words:
            (folder / PHOTO).write_bytes(photo_of((folder / "chart.json").read_bytes()))
        told[words[0]] = brushsvg(*words, cwd=folder, status=0, timeout_s=900)
    return folder, told


def test_it_is_no_longer_than_it_says():
    assert 0 < len(commands()) <= MOST_COMMANDS
    assert re.search(r"\bEight commands\b", GUIDE.read_text()) and len(commands()) == 8
    names = set(re.findall(r"walkthrough_\w+\.jpg", GUIDE.read_text()))
    assert names == {path.name for path in GUIDE.parent.glob("walkthrough_*.jpg")}


def test_the_brush_is_the_one_that_painted(followed):
    folder, told = followed
    depths = np.linspace(1, 10, 10)
    found = find_brush(folder / "mine.json")
    for law in ("lag", "half_width"):
        off = [abs(getattr(found, law)(depth) / TRUTH.law(law)(depth) - 1) for depth in depths]
        assert max(off) < 0.03, (law, off)
    assert gives(" ".join(told["calibrate"].err), "49", "8")


def test_the_program_is_checked_and_all_files_are_there(followed):
    folder, told = followed
    overlap = float(re.search(r"^all +(\d\.\d+)", told["check"].out, re.MULTILINE)[1])
    assert overlap > 0.95
    files = {
        word for words in commands() for word in words if re.search(r"\.(toml|ngc|pdf|json|png|svg)$", word)
    }
    assert files - {"EMSTech.svg"} <= {path.name for path in folder.iterdir()}
