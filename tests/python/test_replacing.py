"""A command replaces only unchanged files that brushsvg wrote.

Any other file is replaced only with --force.
"""

import os
from pathlib import Path

import pytest
from diagnostics import in_json, is_reported

from brushsvg.cli.steps import replacing
from brushsvg.machine.cells.language_limits import MAX_PROGRAM_POINTS

DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60"><g fill="none" '
    'stroke="#000"><path d="M20 30c10-20 30 20 50 0" stroke-width="{}"/></g></svg>'
)
FONT = (
    '<svg xmlns="http://www.w3.org/2000/svg"><font horiz-adv-x="600"><font-face units-per-em="1000"/>'
    '<glyph unicode="T" d="M 0 700 L 500 700 M 250 700 L 250 0"/></font></svg>'
)
CONVERT = ("convert", "a.svg", "-o", "a.ngc", "--picture", "a.png")


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    Path("a.svg").write_text(DRAWING.format(2))
    return tmp_path


def is_kept(capsys, path, *words):
    """Return whether the command refuses to replace this file without --force.

    The refused command must leave the file unchanged, and --force must replace it.
    """
    before = Path(path).read_bytes()
    status, _, reported = in_json(capsys, *words)
    kept = status == 1 and is_reported(reported, "file-exists") and reported[-1][0] == path
    kept &= Path(path).read_bytes() == before
    return kept and in_json(capsys, *words, "--force")[0] == 0


def test_unchanged_programs_and_pictures_are_replaced(desk, capsys):
    assert in_json(capsys, *CONVERT)[0] == 0
    first = Path("a.ngc").read_bytes()
    Path("a.svg").write_text(DRAWING.format(3))
    assert in_json(capsys, *CONVERT)[0] == 0
    assert Path("a.ngc").read_bytes() != first


@pytest.mark.parametrize("name", ["a.ngc", "a.png"])
def test_edited_files_are_kept(desk, capsys, name):
    assert in_json(capsys, *CONVERT)[0] == 0
    with open(name, "ab") as file:
        file.write(b"\n(mine)\n")
    other = {"a.ngc": "a.png", "a.png": "a.ngc"}[name]
    Path(other).unlink()
    assert is_kept(capsys, name, *CONVERT)
    assert in_json(capsys, *CONVERT)[0] == 0, "as it was written now"


def test_files_not_written_by_brushsvg_are_kept(desk, capsys):
    Path("a.ngc").write_text("(mine)\n")
    assert is_kept(capsys, "a.ngc", *CONVERT)
    Path("b.json").write_text("{}")
    assert is_kept(capsys, "b.json", "convert", "a.svg", "-o", "b.json")


def test_a_program_in_several_files_replaces_no_other_files(desk, capsys, monkeypatch):
    monkeypatch.setitem(MAX_PROGRAM_POINTS, "fanuc", 60)
    two = DRAWING.format(2).replace("</g>", '<path d="M20 50c10-20 30 20 50 0" stroke-width="2"/></g>')
    Path("a.svg").write_text(two)
    words = ("convert", "a.svg", "-o", "a.ls", "--cell", "lrmate200id")
    assert in_json(capsys, *words)[0] == 0
    part = next(path.name for path in Path().glob("B*.ls"))
    assert in_json(capsys, *words)[0] == 0
    Path(part).write_text("mine")
    assert is_kept(capsys, part, *words)


SOURCES = {
    "a brush": ("own.json", ("brush", "new", "-o", "own.json", "--lag", "4", "--width-at", "3=2")),
    "a cell": ("own.toml", ("cell", "new", "-o", "own.toml")),
    "a drawing": ("t.svg", ("text", "T", "-o", "t.svg", "--font", "font.svg")),
}


@pytest.mark.parametrize("kind", SOURCES)
def test_brushes_cells_and_drawings_are_never_replaced_automatically(desk, capsys, kind):
    path, words = SOURCES[kind]
    Path("font.svg").write_text(FONT)
    assert in_json(capsys, *words)[0] == 0, words
    assert is_kept(capsys, path, *words)


def test_no_program_replaces_a_brush(desk, capsys):
    assert in_json(capsys, *SOURCES["a brush"][1])[0] == 0
    assert is_kept(capsys, "own.json", "convert", "a.svg", "-o", "own.json")


def test_the_brush_of_a_project_is_never_replaced_by_a_command_that_reads_it(desk, capsys):
    assert in_json(capsys, "brush", "new", "-o", "mine.json", "--like", "round-6")[0] == 0
    assert in_json(capsys, *"init --cell grbl-3axis --brush mine.json --sheet 100x60".split())[0] == 0
    brush = Path("mine.json").read_bytes()
    for words in ("convert a.svg -o mine.json", "preview a.svg -o mine.json", "chart -o c.gcode --chart mine.json"):
        status, _, reported = in_json(capsys, *words.split(), "--force")
        assert status == 1 and is_reported(reported, "options-contradict") and reported[-1][0] == "mine.json", words
        assert Path("mine.json").read_bytes() == brush
    assert in_json(capsys, *"convert a.svg -o mine.json --brush round-6 --force".split())[0] == 0


def test_files_are_kept_if_the_record_cannot_be_written(desk, capsys, monkeypatch):
    Path("state").write_text("no folder")
    assert in_json(capsys, *CONVERT)[0] == 0
    assert is_kept(capsys, "a.ngc", *CONVERT)


def test_a_refusal_because_of_an_unwritable_home_names_its_path(desk, capsys, monkeypatch):
    """A refusal because of an unwritable home names the path.

    Root may write anywhere, so the test uses a stand-in for os.access.
    """
    place = desk / "state" / "brushsvg" / "written.txt"
    place.mkdir(parents=True)
    monkeypatch.setattr(replacing.os, "access", lambda path, mode: not str(path).startswith(str(desk / "state")))
    assert in_json(capsys, *CONVERT)[0] == 0
    status, _, reported = in_json(capsys, *CONVERT)
    assert status == 1 and is_reported(reported, f"file-exists {place}"), reported


def test_a_device_is_written_through(desk, capsys):
    Path("out.ngc").symlink_to(os.devnull)
    assert [in_json(capsys, "convert", "a.svg", "-o", "out.ngc")[0] for _ in range(2)] == [0, 0]


def test_the_record_of_written_files_stays_small(desk, monkeypatch):
    Path("x").write_text("x")
    monkeypatch.setattr(replacing, "MAX_RECORD_BYTES", 1000)
    for _ in range(20):
        replacing.record_written(["x"])
    replacing.refuse_replacing(["x"])
    (written,) = Path("state").rglob("*.txt")
    assert written.stat().st_size <= 1000
