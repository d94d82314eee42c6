"""Brushes x drawings x cells x commands, so that each pair of them is tried, through the public command line.

Each row ends in the file that the command promises, or in a refusal whose reason is physical. The rows are a covering
array (allpairspy). At the end a table shows how many rows were refused, and why.
"""

from __future__ import annotations

import json
import shutil

from allpairspy import AllPairs
from desk import BRUSHES, DRAWINGS, SLOW_BRUSHES, brush_file, drawing_file
from diagnostics import in_json
from sampling import sample

from brushsvg.machine.cell_file import cell_names, find_cell
from brushsvg.machine.posts import POSTS

CELLS = cell_names()

# Codes of refusals that have a physical reason. Anything else fails the test.
PHYSICAL = {
    "nothing-to-paint": "the drawing is smaller than the brush's smallest mark",
    "depth-out-of-range": "the plan presses deeper than this brush allows",
    "pen-depth": "the pen of this machine is only up or down, the brush needs more depths",
}


def program(cell: str) -> str:
    """The file name of a program for a cell."""
    return f"out{POSTS[find_cell(cell).language].extensions[0]}"


def convert(drawing, options, folder):
    out = folder / program(options[3])
    yield ("convert", drawing, out, *options), [out]


def check(drawing, options, folder):
    out = folder / program(options[3])
    yield ("convert", drawing, out, *options), [out]
    yield ("check", out, drawing, *options), []


def batch(drawing, options, folder):
    inputs = folder / "in"
    inputs.mkdir()
    shutil.copy(drawing, inputs)
    yield ("batch", inputs, "--out", folder / "out", "--jobs", 1, *options), [folder / "out"]


def report(drawing, options, folder):
    picture = folder / "paint.svg"
    yield ("report", drawing, "--preview", picture, *options), [picture]


def predict(drawing, options, folder):
    yield ("predict", drawing, folder / "paint.png", *options), [folder / "paint.png"]


def animate(drawing, options, folder):
    yield ("animate", drawing, folder / "paint.html", *options), [folder / "paint.html"]


def border(drawing, options, folder):
    out = folder / program(options[3])
    yield ("border", drawing, out, *options), [out]


def compare(drawing, options, folder):
    photo, corrections = folder / "photo.jpg", folder / "corrections.json"
    yield ("simulate-photo", drawing, photo, *options), [photo]
    yield ("compare", photo, drawing, *options, "-o", corrections), [corrections]
    if any(stroke["correction"] for stroke in json.loads(corrections.read_text())["strokes"]):
        out = folder / program(options[3])
        yield ("convert", drawing, out, *options, "--corrections", corrections), [out]


COMMANDS = (convert, check, batch, report, predict, animate, border, compare)
FACTORS = [[*BRUSHES, *SLOW_BRUSHES], [*DRAWINGS], CELLS, [each.__name__ for each in COMMANDS]]
NO_DRAWING = {"report"}  # these commands compare with a drawing, which a plan does not hold


def is_offered(row: list) -> bool:
    return not (len(row) == 4 and row[1] == "plan" and row[3] in NO_DRAWING)


ROWS = [tuple(row) for row in AllPairs(FACTORS, filter_func=is_offered)]
IN_CI = 60  # rows on each landing


@sample("brush, drawing, cell, command", ROWS, keep=IN_CI)
def test_each_pair_of_brush_drawing_cell_and_command_works(
    desk, tmp_path, capsys, record_property, brush, drawing, cell, command
):
    options = ("--brush", brush_file(desk, brush), "--cell", cell)
    [steps] = [each for each in COMMANDS if each.__name__ == command]
    for words, promised in steps(drawing_file(desk, drawing), options, tmp_path):
        status, _, told = in_json(capsys, *words)
        codes = [notice.code for _, notice in told]
        if status == 0:
            assert all(file.exists() for file in promised)
            continue
        assert status == 1 and codes and codes[-1] in PHYSICAL, (words, told)
        record_property("refused", codes[-1])
        assert not any(file.is_file() for file in promised)
        return


def test_the_rows_cover_each_pair():
    for a in range(4):
        for b in range(a):
            pairs = {(row[a], row[b]) for row in ROWS}
            left_out = len(NO_DRAWING) if (a, b) == (3, 1) else 0
            assert len(pairs) == len(FACTORS[a]) * len(FACTORS[b]) - left_out
