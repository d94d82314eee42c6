"""Scripts next to the package use names that exist.

No test runs all of the scripts, and names move.
"""

import ast
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = [path for folder in ("benchmarks", "examples", "tools") for path in sorted((ROOT / folder).glob("*.py"))]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_names_that_scripts_import_exist(script):
    for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom) or not (node.module or "").startswith("brushsvg"):
            continue
        home = importlib.import_module(node.module)
        for name in node.names:
            if not hasattr(home, name.name):
                importlib.import_module(f"{node.module}.{name.name}")
