"""docs/explanation/article.md is what `brushsvg article` makes; its scripts are short, and use public names only."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import brushsvg
from brushsvg.article import page
from brushsvg.cli import main

DOCS = Path(__file__).parents[2] / "docs" / "explanation"
SCRIPTS = sorted(page.SCRIPTS.glob("*.py"))
MOST_LINES = 40
ONE_IN = 0.01  # as near as fits to noise agree from one compiler to the next


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


@pytest.mark.thorough
@pytest.mark.slow
def test_the_page_is_that_of_the_command(tmp_path):
    pytest.importorskip("matplotlib")
    assert main(["article", str(tmp_path / "new"), "--quiet"]) == 0
    made = (tmp_path / "new" / "article.md").read_text().splitlines()
    kept = (DOCS / "article.md").read_text().splitlines()
    assert len(made) == len(kept)
    numbers = 0
    for new, old in zip(made, kept, strict=True):
        if not new.startswith("| "):
            assert new == old
            continue
        for a, b in zip(cells(new), cells(old), strict=True):
            try:
                value = float(b)
            except ValueError:
                assert a == b
            else:
                numbers += 1
                assert float(a) == pytest.approx(value, rel=ONE_IN, abs=ONE_IN)
    assert numbers > 100
    shown = set(re.findall(r"\]\((article/.*?\.png)\)", "\n".join(kept)))
    assert shown == {f"article/{path.stem}.png" for path in SCRIPTS}
    for name in shown:
        assert (tmp_path / "new" / name).stat().st_size > 5000
        assert 5000 < (DOCS / name).stat().st_size < 120_000


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_can_be_copied(script):
    text = script.read_text()
    docstring = ast.parse(text).body[0]
    assert len("\n".join(text.splitlines()[docstring.end_lineno :]).strip().splitlines()) <= MOST_LINES
    assert f"`python/brushsvg/article/figures/{script.name}`" in (DOCS / "article.md").read_text()
    public = {*brushsvg.__all__, *(f"laws.{name}" for name in brushsvg.laws.__all__)}
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            assert {alias.name for alias in node.names} <= {"brushsvg", "numpy"}
        elif isinstance(node, ast.ImportFrom):
            assert node.module.split(".")[0] in ("brushsvg", "matplotlib")
            if node.module == "brushsvg":
                assert {alias.name for alias in node.names} == {"laws"}
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id == "brushsvg":
                assert node.attr in public
            elif node.value.id == "laws":
                assert f"laws.{node.attr}" in public


def test_without_matplotlib_it_says_what_to_install(tmp_path):
    code = "import sys; sys.modules['matplotlib'] = None; from brushsvg.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "--messages", "json", "article", str(tmp_path / "new")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1
    assert '"code": "package-missing"' in done.stderr and "matplotlib" in done.stderr
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("place", ["a file", "a file/below", "\0"])
def test_a_place_that_is_no_folder_is_refused(tmp_path, capsys, monkeypatch, place):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(page, "SCRIPTS", tmp_path)  # nothing to draw
    Path("a file").write_text("mine")
    assert main(["--messages", "json", "article", place]) == 1
    assert '"code": "file-unwritable"' in capsys.readouterr().err
    assert Path("a file").read_text() == "mine"
