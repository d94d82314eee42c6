"""Every pair of brush, drawing, cell and command works through the command line.

Each row ends in the file that the command promises, or in a refusal with a physical reason. The rows are a
covering array (allpairspy). At the end a table shows how many rows were refused, and why.
"""

from __future__ import annotations

import itertools
import json
import shutil

import pytest
from allpairspy import AllPairs
from desk import BRUSHES, DRAWINGS, SLOW_BRUSHES, STUDIO, brush_file, drawing_file
from diagnostics import in_json, is_reported
from sampling import sample

from brushsvg.machine.cells.cell_file import cell_names, find_cell
from brushsvg.machine.posts import POSTS

CELLS = cell_names()

# Codes of refusals, each with its physical reason. Anything else fails the test.
PHYSICAL = {
    "nothing-to-paint": "the drawing is smaller than the brush's smallest mark",
    "depth-out-of-range": "the plan presses deeper than this brush allows",
    "photo-without-paint": "the mark is too small to be seen in the photograph",
}

# A plan holds no target outlines, so there is nothing to report on. A pen that is only up or down has no depths.
NO_DRAWING = {"report", "batch"}
PENS = [name for name in CELLS if find_cell(name).pen]
FOR_PENS = ["rigid"]


def program(cell: str) -> str:
    """Return the file name of a program for a cell."""
    return f"out{POSTS[find_cell(cell).language].extensions[0]}"


def convert(drawing, options, folder):
    out = folder / program(options[3])
    yield ("convert", drawing, "-o", out, *options), [out]


def check(drawing, options, folder):
    out = folder / program(options[3])
    yield ("convert", drawing, "-o", out, *options), [out]
    yield ("check", out, drawing, *options), []


def batch(drawing, options, folder):
    inputs = folder / "in"
    inputs.mkdir()
    shutil.copy(drawing, inputs)
    inputs = (
        inputs if drawing.suffix in (".svg", ".dxf") else inputs / drawing.name
    )  # G-code is read if the command line names it
    yield ("batch", inputs, "-o", folder / "out", "--jobs", 1, *options), [folder / "out"]


def report(drawing, options, folder):
    picture = folder / "paint.svg"
    yield ("preview", drawing, "--show", "errors", "-o", picture, *options), [picture]


def predict(drawing, options, folder):
    yield ("preview", drawing, "-o", folder / "paint.png", *options), [folder / "paint.png"]


def animate(drawing, options, folder):
    yield ("preview", drawing, "-o", folder / "paint.html", *options), [folder / "paint.html"]


def border(drawing, options, folder):
    out = folder / program(options[3])
    yield ("setup", "border", drawing, "-o", out, *options), [out]


def compare(drawing, options, folder):
    photo, corrections, studio = folder / "photo.jpg", folder / "corrections.json", folder / "studio.toml"
    studio.write_text(STUDIO)
    yield ("simulate-photo", drawing, "-o", photo, *options, "--studio", studio), [photo]
    yield ("compare", photo, drawing, *options, "-o", corrections), [corrections]
    if any(stroke["correction"] for stroke in json.loads(corrections.read_text())["strokes"]):
        out = folder / program(options[3])
        yield ("convert", drawing, "-o", out, *options, "--corrections", corrections), [out]


COMMANDS = (convert, check, batch, report, predict, animate, border, compare)


def as_offered(brush: str, drawing: str, cell: str, command) -> list[tuple[str, str, str, str]]:
    """Return the row, or two rows that try its pairs.

    Two rows are needed if the command cannot use a plan.
    """
    if drawing == "plan" and command.__name__ in NO_DRAWING:
        return [(brush, drawing, cell, "convert"), (brush, "line", cell, command.__name__)]
    return [(brush, drawing, cell, command.__name__)]


# brushes, drawings (the plan presses a brush), cells
MACHINES = [
    ([*BRUSHES, *SLOW_BRUSHES], [*DRAWINGS], [cell for cell in CELLS if cell not in PENS]),
    (FOR_PENS, [each for each in DRAWINGS if each != "plan"], PENS),
]
ROWS = [
    row
    for brushes, drawings, cells in MACHINES
    for each in AllPairs([brushes, drawings, cells, COMMANDS])
    for row in as_offered(*each)
]
IN_CI = 60  # rows in each CI run


def tried(desk, folder, capsys, record_property, brush, drawing, cell, command) -> None:
    """Try one row.

    It ends in the promised file, or in a refusal with a physical reason and no file.
    """
    options = ("--brush", brush_file(desk, brush), "--cell", cell)
    [steps] = [each for each in COMMANDS if each.__name__ == command]
    for words, promised in steps(drawing_file(desk, drawing), options, folder):
        status, _, reported = in_json(capsys, *words)
        codes = [notice.code for _, notice in reported]
        if status == 0:
            assert all(file.exists() for file in promised)
            continue
        assert status == 1 and codes and codes[-1] in PHYSICAL, (words, reported)
        record_property("refused", codes[-1])
        assert not any(file.is_file() for file in promised)
        return


@sample("brush, drawing, cell, command", ROWS, keep=IN_CI)
def test_each_pair_of_brush_drawing_cell_and_command_works(
    desk, tmp_path, capsys, record_property, brush, drawing, cell, command
):
    tried(desk, tmp_path, capsys, record_property, brush, drawing, cell, command)


# Every brush with every drawing and command, with the machines in turn. Rows above are left out.
TRIPLES = sorted(
    {
        (row[0], row[1], row[3])
        for brushes, drawings, cells in MACHINES
        for brush, drawing, command in itertools.product(brushes, drawings, COMMANDS)
        for row in as_offered(brush, drawing, cells[0], command)
    }
    - {(brush, drawing, command) for brush, drawing, _, command in ROWS}
)
BRUSH_CELLS = MACHINES[0][2]


@sample("number", range(len(TRIPLES)), keep=10)
def test_each_triple_of_brush_drawing_and_command_works(desk, tmp_path, capsys, record_property, number):
    brush, drawing, command = TRIPLES[number]
    cell = BRUSH_CELLS[number % len(BRUSH_CELLS)]
    tried(desk, tmp_path, capsys, record_property, brush, drawing, cell, command)


@pytest.mark.parametrize(("brushes", "drawings", "cells"), MACHINES)
def test_the_test_rows_cover_each_pair(brushes, drawings, cells):
    factors = [brushes, drawings, cells, [each.__name__ for each in COMMANDS]]
    rows = [row for row in ROWS if row[2] in cells]
    for a, b in itertools.combinations(range(4), 2):
        left_out = len(NO_DRAWING) if (a, b) == (1, 3) and "plan" in drawings else 0
        pairs = {(row[a], row[b]) for row in rows}
        assert len(pairs) == len(factors[a]) * len(factors[b]) - left_out


@pytest.mark.parametrize("cell", PENS)
def test_a_brush_on_a_machine_with_a_pen_is_refused(desk, tmp_path, capsys, cell):
    words = (
        "convert",
        drawing_file(desk, "line"),
        "-o",
        tmp_path / program(cell),
        "--cell",
        cell,
        "--brush",
        "round-6",
    )
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, "pen-depth"), reported
