"""The scripts of examples/article write docs/explanation/article.md.

They are short and use only public names.
"""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import brushsvg

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs" / "explanation"
ARTICLE = ROOT / "examples" / "article"
SCRIPTS = sorted((ARTICLE / "figures").glob("*.py"))
MAX_LINES = 40
TOLERANCE = 0.01  # Fits to noisy data differ by this much between compilers.


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


@pytest.mark.thorough
@pytest.mark.slow
def test_the_article_page_is_up_to_date(tmp_path):
    pytest.importorskip("matplotlib")
    subprocess.run([sys.executable, ARTICLE, tmp_path / "new"], check=True)
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
                assert float(a) == pytest.approx(value, rel=TOLERANCE, abs=TOLERANCE)
    assert numbers > 100
    shown = set(re.findall(r"\]\((article/.*?\.png)\)", "\n".join(kept)))
    assert shown == {f"article/{path.stem}.png" for path in SCRIPTS}
    for name in shown:
        assert (tmp_path / "new" / name).stat().st_size > 5000
        assert 5000 < (DOCS / name).stat().st_size < 120_000


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_can_be_copied(script):
    text = script.read_text()
    code = "\n".join(text.splitlines()[ast.parse(text).body[0].end_lineno :]).strip()
    assert len(code.splitlines()) <= MAX_LINES
    assert f"`examples/article/figures/{script.name}`" in (DOCS / "article.md").read_text()
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
