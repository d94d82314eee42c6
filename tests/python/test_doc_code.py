"""What README and docs show as code runs as it stands: Python page by page from top to bottom, in a folder that holds
what the page speaks of; README's commands in their order; tables of cells; article.md's scripts run in test_article."""

import re
import shlex
import shutil
import tomllib
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import brushsvg
from brushsvg.cli import main

HOUSE = Path(__file__).parents[2]
PAGES = [HOUSE / "README.md", *sorted((HOUSE / "docs").glob("*.md"))]
MADE = "article.md"
BLOCK = re.compile(
    r"^```(?P<name>\w*)\n(?P<fenced>[\s\S]*?)^```|(?P<plain>(?:^    .*\n(?:\n(?=    ))?)+)", re.MULTILINE
)
PYTHON = re.compile(r"^(import |from \w|[\w, ]+ = brushsvg\.|stroke = )", re.M)
NEEDS_PARTS = {"import sys, serial": "a port to a machine"}  # begins of blocks that are compiled alone


def blocks(page: Path) -> list[tuple[str, str]]:
    """(language, code) of each block of code, without its indent."""
    found = []
    for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
        if block["fenced"] is not None:
            found.append((block["name"], block["fenced"]))
        else:
            code = re.sub("^    ", "", block["plain"], flags=re.M)
            found.append(("python" if PYTHON.search(code) else "toml" if code.startswith("[") else "", code))
    return found


OF_PYTHON = {
    page.name: [code for language, code in blocks(page) if language == "python"]
    for page in PAGES
    if page.name != MADE
}
OF_PYTHON = {name: code for name, code in OF_PYTHON.items() if code}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of somebody who draws: word.svg, letters/, measured.csv, a font."""
    shutil.copy(HOUSE / "examples" / "robot.svg", tmp_path / "word.svg")
    (tmp_path / "letters").mkdir()
    shutil.copy(HOUSE / "examples" / "robot.svg", tmp_path / "letters" / "one.svg")
    rows = [f"lag,{d},{3 + 0.9 * d:.1f}\nwidth,{d},{0.8 * d:.1f}" for d in range(1, 9)]
    (tmp_path / "measured.csv").write_text("kind,depth_mm,value_mm\n" + "\n".join(rows) + "\n")
    glyphs = "".join(f"<glyph unicode='{letter}' d='M100 0L300 600'/>" for letter in "Robt")
    font = f"<font horiz-adv-x='500'><font-face units-per-em='1000'/>{glyphs}</font>"
    (tmp_path / "EMSAllure.svg").write_text(
        f"<svg xmlns='http://www.w3.org/2000/svg'><defs>{font}</defs></svg>"
    )
    drawing = ezdxf.new(units=4)  # mm
    drawing.modelspace().add_line((10, 10), (60, 40), dxfattribs={"lineweight": 200})
    drawing.saveas(tmp_path / "word.dxf")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_pages_with_python_are_found():
    assert {"README.md", "python.md", "batch.md"} <= set(OF_PYTHON)


@pytest.mark.slow
@pytest.mark.parametrize("page", OF_PYTHON)
def test_python_of_a_page_runs(page, folder, capsys):
    pytest.importorskip("uharfbuzz")
    names = {"np": np, "brushsvg": brushsvg, "font_bytes": Path("EMSAllure.svg").read_bytes()}
    names["svg_text"] = Path("word.svg").read_text()
    for code in OF_PYTHON[page]:
        compiled = compile(code, page, "exec")
        if not any(code.startswith(begin) for begin in NEEDS_PARTS):
            exec(compiled, names)


def test_the_program_of_the_page_for_cpp_is_the_example():
    example = (HOUSE / "examples" / "02_brush_file_to_gcode.cpp").read_text().split("\n", 1)[1].strip()
    assert example in [code.strip() for _, code in blocks(HOUSE / "docs" / "cpp.md")]


def test_tables_of_cells_are_tables():
    tables = [code for page in PAGES for language, code in blocks(page) if language == "toml"]
    assert len(tables) >= 3
    for code in tables:
        assert tomllib.loads(code)


# Photographs of paint are taken in tests/laws and tests/integration, figures drawn in test_article
ELSEWHERE = ("photo.jpg", "article ", "install-plugin")
README = [
    re.sub(r" +[#>].*", "", line).removeprefix("brushsvg ")
    for _, code in blocks(PAGES[0])
    for line in code.splitlines()
    if line.startswith("brushsvg ")
]


@pytest.mark.slow
def test_commands_of_the_readme_run_in_their_order(folder, capsys):
    typed = [line for line in README if not any(word in line for word in ELSEWHERE)]
    assert len(typed) >= 15
    for line in typed:
        first, *others = line.split(" | ")
        for command in [first, *(f"{line.split()[0]} {other}" for other in others)]:
            if command not in ("brush show", "brush plot", "brush check"):  # named there, not typed
                assert main(shlex.split(command)) in (0, None), (command, capsys.readouterr().err)
