"""Code that README and docs show works as it stands.

Python code runs page by page from top to bottom, in a folder that has the files of the page. README's
commands run in their order. The package's readers read JSON files and the tables of cells and of
measurements. HELD names the tests of all other code. No test covers a block of another kind, or a block on a
page that had no block of its kind.
"""

import json
import re
import shlex
import shutil
import tomllib
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from shown_code import FOLLOWED, PAGES, REPOSITORY, blocks, name_of, why_not_run

import brushsvg
from brushsvg.calibration.numbers.measurements import read_measurements
from brushsvg.cli import main
from brushsvg.cli.arguments.parser import parse
from brushsvg.machine.cells.cell_file import parse_cell

HELD = {
    "python": "here; types in integration/test_pyright.py",
    "commands": "integration/test_doc_commands.py; of README here, of start/ and howto/ in test_pages_followed.py",
    "make": "not run, because it sets up a machine, or takes minutes and more: its targets are held here",
    "shell": "tests/consumer/run.sh for C++; integration/test_doc_commands.py for Inkscape",
    "cpp": "the example, which tests/consumer/run.sh builds and runs",
    "cmake": "tests/consumer/run.sh, which takes it from the page",
    "json": "here",
    "toml": "here",
    "csv": "here",
    "flags": "here",
    "xml": "integration/test_pages_followed.py",
    "text": "integration/test_pages_followed.py",
    "{toctree}": "integration/test_docs_pages.py: Sphinx builds it",
}
KINDS_OF_PAGES = {
    "README.md": "commands make python",
    "evidence/speed.md": "make",
    "explanation/calibration.md": "commands",
    "explanation/letters.md": "commands",
    "index.md": "{toctree}",
    "machines/abb.md": "commands",
    "machines/arms.md": "commands toml",
    "machines/doosan.md": "commands",
    "machines/dobot.md": "commands",
    "machines/ebb.md": "commands python",
    "machines/fanuc.md": "commands",
    "machines/fluidnc.md": "commands",
    "machines/grbl.md": "commands",
    "machines/hpgl.md": "commands",
    "machines/index.md": "commands {toctree}",
    "machines/jaka.md": "commands",
    "machines/klipper.md": "commands",
    "machines/kuka.md": "commands",
    "machines/linuxcnc.md": "commands",
    "machines/marlin.md": "commands",
    "machines/robodk.md": "toml",
    "machines/ros2.md": "commands",
    "machines/servo-plotters.md": "commands toml",
    "machines/ur.md": "commands python",
    "machines/xarm.md": "commands",
    "reference/brush.md": "json",
    "reference/cell.md": "toml",
    "reference/diagnostics.md": "json",
    "reference/drawings.md": "commands flags",
    "reference/measurements.md": "commands csv json",
    "reference/report.md": "commands",
    "reference/wheels.md": "json",
}
LAWS = {"lag": 1.2, "width": 0.8}  # of a measured brush, per mm of depth
BLOCKS = [block for page in PAGES for block in blocks(page)]
NEEDS_PARTS = {
    "import sys, serial": "a port to a machine",
    "import pathlib, re, socket": "a robot",
}  # beginnings of blocks that are only compiled
OF_PYTHON = {
    page: [block.code for block in BLOCKS if (block.page, block.kind) == (page, "python")]
    for page in map(name_of, PAGES)
}
OF_PYTHON = {name: code for name, code in OF_PYTHON.items() if code}


def of_kind(kind: str, page: str = "") -> list[str]:
    """Return the code blocks of one kind.

    They are from one page, or from all pages that integration/test_pages_followed.py does not follow from top
    to bottom.
    """
    followed = {name_of(each) for each in FOLLOWED}
    return [
        block.code
        for block in BLOCKS
        if block.kind == kind and (block.page == page if page else block.page not in followed)
    ]


def test_every_code_block_has_a_tested_kind():
    assert [block for block in BLOCKS if block.kind not in HELD] == []
    found: dict[str, set[str]] = {}
    for block in BLOCKS:
        found.setdefault(block.page, set()).add(block.kind)
    followed = {name_of(page) for page in FOLLOWED}
    assert {page: " ".join(sorted(kinds)) for page, kinds in found.items() if page not in followed} == KINDS_OF_PAGES


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A user's folder: word.svg, its painted page, letters/, measured.csv, a font."""
    shutil.copy(REPOSITORY / "examples" / "robot.svg", tmp_path / "word.svg")
    main(["simulate-photo", str(tmp_path / "word.svg"), "-o", str(tmp_path / "word.jpg"), "--quiet"])
    (tmp_path / "letters").mkdir()
    shutil.copy(REPOSITORY / "examples" / "robot.svg", tmp_path / "letters" / "one.svg")
    rows = [f"lag,{d},{3 + 0.9 * d:.1f}\nwidth,{d},{0.8 * d:.1f}" for d in range(1, 9)]
    (tmp_path / "measured.csv").write_text("kind,depth_mm,value_mm\n" + "\n".join(rows) + "\n")
    glyphs = "".join(f"<glyph unicode='{letter}' d='M100 0L300 600'/>" for letter in "Robt")
    font = f"<font horiz-adv-x='500'><font-face units-per-em='1000'/>{glyphs}</font>"
    (tmp_path / "EMSAllure.svg").write_text(f"<svg xmlns='http://www.w3.org/2000/svg'><defs>{font}</defs></svg>")
    drawing = ezdxf.new(units=4)  # mm
    drawing.modelspace().add_line((10, 10), (60, 40), dxfattribs={"lineweight": 200})
    drawing.saveas(tmp_path / "word.dxf")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_pages_with_python_are_found():
    assert {"README.md", "howto/python.md"} <= set(OF_PYTHON)


@pytest.mark.slow
@pytest.mark.parametrize("page", OF_PYTHON)
def test_python_code_of_a_page_runs(page, folder, capsys):
    pytest.importorskip("uharfbuzz")
    names = {"np": np, "brushsvg": brushsvg, "font_bytes": Path("EMSAllure.svg").read_bytes()}
    names["svg_text"] = Path("word.svg").read_text()
    for code in OF_PYTHON[page]:
        compiled = compile(code, page, "exec")
        if not any(code.startswith(begin) for begin in NEEDS_PARTS):
            exec(compiled, names)


def test_the_program_on_the_cpp_page_equals_the_example():
    example = (REPOSITORY / "examples" / "01_first_word.cpp").read_text().split("\n", 1)[1].strip()
    assert [code.strip() for code in of_kind("cpp", "howto/cpp.md")] == [example]


@pytest.mark.parametrize("code", of_kind("toml"))
def test_cell_tables_on_pages_can_be_read(code):
    tables = list(tomllib.loads(code))
    language = 'language = "robodk"' if "robodk" in tables else 'language = "urscript"'
    name = "linuxcnc-3axis" if "backlash_mm" in code else "ur5e"  # ur5e has joints, not axes
    name = "grbl-servo" if "servo" in tables else name
    text = re.sub('language = "urscript"', language, brushsvg.write_cell(brushsvg.find_cell(name)))
    kept = [part for part in re.split(r"\n(?=\[)", text) if not re.match(rf"\[+({'|'.join(tables)})\b", part)]
    assert parse_cell("\n".join([*kept, code]))


def test_measurements_on_pages_can_be_read():
    tables = of_kind("csv")
    files = [whole(code) for code in of_kind("json", "reference/measurements.md")]
    assert len(tables) == 1 and len(files) == 3
    assert read_measurements(tables[0].encode(), ".csv").rows
    for file in files:
        known = {"format": "brushsvg/measurements", "version": 1, **file}
        found = read_measurements(json.dumps(known).encode(), ".json")
        assert found.rows or found.marks


def test_files_have_the_keys_that_the_page_shows(tmp_path):
    brush = brushsvg.find_brush("round-6")
    stroke = brushsvg.stroke_from_path("M20 40C40 80 80 80 100 40V20", 4)
    plan = brushsvg.compensate([stroke], brush, sheet_mm=(140, 100)).plan
    marks = brushsvg.simulate(plan, brush)
    brushsvg.trace_outlines(marks, brush)
    rows = {kind: [{"depth_mm": d, "value_mm": k * d + 0.1 * (d % 2)} for d in range(1, 9)] for kind, k in LAWS.items()}
    brushsvg.save_brush(brush, tmp_path / "shipped.json")
    brushsvg.save_brush(brushsvg.calibrate(rows).brush, tmp_path / "fitted.json")
    shipped, fitted = (json.loads((tmp_path / f"{name}.json").read_text()) for name in ("shipped", "fitted"))
    of_brush, of_paint, of_plan, of_tilted, of_marks = map(whole, of_kind("json", "reference/brush.md"))
    assert set(unlike(of_brush, shipped)) & set(unlike(of_brush, fitted)) == set()
    (tmp_path / "painted.json").write_text(json.dumps(shipped | of_paint))
    brushsvg.save_brush(brushsvg.find_brush(tmp_path / "painted.json"), tmp_path / "painted.json")
    assert unlike(of_paint, json.loads((tmp_path / "painted.json").read_text())) == []
    assert unlike(of_plan, json.loads(brushsvg.write_plan(plan))) == []
    for a_pass in plan.passes:
        a_pass.arcs, a_pass.tool_axes = [], [(0.28, 0.0, 0.96)] * len(a_pass.poses_mm)
    assert unlike(of_tilted, json.loads(brushsvg.write_plan(plan))) == []
    assert unlike(of_marks, json.loads(brushsvg.write_marks(marks))) == []


def whole(code: str):
    """Parse the JSON of a page without its dots; 1 replaces names such as x, i or cx."""
    if not code.startswith("{"):
        code = f"{{{code}}}"
    code = re.sub(r"(,\s*)?\.\.\.(?=\s*[\]}])", "", code)
    return json.loads(re.sub(r"(?<=[\[ ])(x|y|z|i|j|cx|cy)(?=[,\]])", "1", code))


def unlike(shown, real, where: str = "") -> list[str]:
    """Return where the shown data differs from a real file.

    A difference is an unknown key or a value of another kind. The first entries of two lists are compared, if
    both exist.
    """
    if isinstance(shown, dict) and isinstance(real, dict):
        lost = [f"{where}.{key}" for key in shown if key not in real]
        return lost + [each for key in shown if key in real for each in unlike(shown[key], real[key], f"{where}.{key}")]
    if isinstance(shown, list) and isinstance(real, list):
        return [each for pair in zip(shown[:1], real[:1], strict=False) for each in unlike(*pair, f"{where}[0]")]
    kinds = [
        (int, float) if isinstance(each, int | float) and not isinstance(each, bool) else type(each)
        for each in (shown, real)
    ]
    return [] if kinds[0] == kinds[1] else [f"{where}: {shown!r} and {real!r}"]


def test_messages_in_json_have_the_documented_keys(folder, capsys):
    (code,) = of_kind("json", "reference/diagnostics.md")
    main(["--messages", "json", "convert", "word.svg", "-o", "word.ngc", "--brush", "none"])
    assert set(json.loads(code)) == set(json.loads(capsys.readouterr().err.splitlines()[0]))


VALUES = {"NAME": "Ink", "CSS": "g", "MM": "3"}


def test_flags_on_pages_exist():
    (code,) = of_kind("flags", "reference/drawings.md")
    listed = re.findall(r"^--(\S+)(?: (\S+))?  ", code, re.M)
    assert len(listed) >= 11
    for flag, value in listed:
        for each in VALUES.get(value, value).split("|"):
            drawing = "a.dxf" if flag == "units" else "a.svg"
            parse(["convert", drawing, "-o", "a.ngc", f"--{flag}", *filter(None, [each])])


def test_make_targets_on_pages_exist():
    targets = re.search(r"^\.PHONY: (.*)$", (REPOSITORY / "Makefile").read_text(), re.M)[1].split()
    typed = [line.split()[1] for code in of_kind("make") for line in code.splitlines()]
    assert len(typed) >= 4 and set(typed) <= set(targets)


README = [
    re.sub(r" +[#>].*", "", line).removeprefix("brushsvg ")
    for code in of_kind("commands", "README.md")
    for line in code.splitlines()
    if not why_not_run("README.md", line)
]


@pytest.mark.slow
def test_commands_of_the_readme_run_in_order(folder, capsys):
    assert len(README) >= 5
    for line in README:
        first, *others = line.split(" | ")
        for command in [first, *(f"{line.split()[0]} {other}" for other in others)]:
            # the page only names these commands
            if command not in ("brush show", "brush plot", "brush check"):
                assert main(shlex.split(command)) in (0, None), (command, capsys.readouterr().err)
