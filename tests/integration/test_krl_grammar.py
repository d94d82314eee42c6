"""A foreign grammar parses our programs in KRL.

BRUSHSVG_KRL_GRAMMAR names a file .g4 or a folder of them, such as kuka/krl.g4 of antlr/grammars-v4. This
grammar is under the LGPL, so it is not part of the project. antlr-ng makes parsers from it.
"""

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command import brushsvg

from brushsvg.machine.cells.cell_file import find_cell, write_cell

NAMED = os.environ.get("BRUSHSVG_KRL_GRAMMAR", "")
pytestmark = pytest.mark.skipif(
    not NAMED, reason="BRUSHSVG_KRL_GRAMMAR names no grammar of KRL, a file .g4 or a folder of them"
)
GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes.src"
DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="40mm" viewBox="0 0 80 40"><g fill="none" '
    'stroke="#000" stroke-width="2"><path id="a" d="M15 20C25 8 35 32 45 20"/><path id="b" d="M55 10V30"/></g></svg>'
)
PAINT = """
[reload]
when = "stroke"

[[stations]]
name = "vessel"
place_mm = [-15.0, 20.0]
depth_mm = 3.0
rim_mm = 2.0
hold_s = 0.5

[[stations]]
name = "hand"
place_mm = [-15.0, 30.0]
by_hand = true
colours = ["#ff0000"]
"""
BROKEN = (  # no grammar of KRL accepts these
    ("DEF BRUSHSVG()", "DEF ()"),
    ("DECL E6POS here", "DECL E6POS"),
    ("BAS(#INITMOV, 0)", "BAS(#INITMOV, 0"),
    ("$TOOL = {", "$TOOL = "),
    ("PTP $AXIS_ACT", "PTP"),
    ("IF here.Z < 20.000 THEN", "IF here.Z < 20.000"),
    ("ENDIF", ""),
    ("X 12.500, Y", "X 12.500 Y"),
    ("X 12.500,", "X 12.5.00,"),
    ("C 180.00000}", "C 180.00000"),
    ("$VEL.CP = 0.025", "$VEL.CP = = 0.025"),
    ("$APO.CDIS = 0.039", "$APO.CDIS 0.039"),
    ("C_DIS", "C_NONE"),
    ("\nEND\n", "\n"),
)


@pytest.fixture(scope="module")
def errors_of(npm, tmp_path_factory):
    """Return a function: the text of a program -> errors of lexer and parser.

    The first rule of the grammar describes a file.
    """
    antlr4 = pytest.importorskip(
        "antlr4",
        reason="antlr4-python3-runtime is missing: pip install -r tests/integration/requirements.txt",
    )
    from antlr4.error.ErrorListener import ErrorListener

    named, folder = Path(NAMED), tmp_path_factory.mktemp("krl")
    files = sorted(named.glob("*.g4")) if named.is_dir() else [named]
    assert files, f"{named} has no .g4"
    made = [npm("antlr", {"antlr-ng": "1.0.10"}) / ".bin" / "antlr-ng", "-Dlanguage=Python3", "-o", folder]
    done = subprocess.run([*made, *files], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    sys.path.insert(0, str(folder))
    lexer, parser = (next(folder.glob(f"*{kind}.py")).stem for kind in ("Lexer", "Parser"))
    lexer, parser = (getattr(importlib.import_module(name), name) for name in (lexer, parser))

    class Reported(ErrorListener):
        def __init__(self):
            self.reported = []

        def syntaxError(self, recognizer, offending, line, column, message, error):  # noqa: N802
            self.reported.append(f"line {line}: {message}")

    def errors(text: str) -> list[str]:
        reported, reads = Reported(), lexer(antlr4.InputStream(text))
        parses = parser(antlr4.CommonTokenStream(reads))
        parses.buildParseTrees = False
        for each in (reads, parses):
            each.removeErrorListeners()
            each.addErrorListener(reported)
        first = parser.ruleNames[0]
        # the name has a _ if it is a word of Python
        getattr(parses, first if hasattr(parses, first) else f"{first}_")()
        return reported.reported

    yield errors
    sys.path.remove(str(folder))


def page(strokes: int) -> dict:
    """Return waves next to each other."""
    t = np.linspace(0, 1, 20)
    passes = []
    for number in range(strokes):
        x, y = 15 + 36 * (number % 10), 10 + 2.4 * (number // 10)
        wave = np.column_stack([x + 30 * t, y + np.sin(6 * t), -np.sin(np.pi * t)])
        passes.append({"stroke": f"s{number}", "poses_mm": np.round(wave, 6).tolist(), "speed_mm_s": 20.0})
    plan = {"format": "brushsvg/plan", "version": 1, "brush": "round-6", "brush_sha256": ""}
    return plan | {"sheet_mm": [400.0, 270.0], "passes": passes}


def test_the_golden_program_is_krl(errors_of):
    assert errors_of(GOLDEN.read_text()) == []


def test_a_program_that_fetches_paint_is_krl(errors_of, tmp_path):
    (tmp_path / "mine.toml").write_text(write_cell(find_cell("kr6-r900")) + PAINT)
    (tmp_path / "red.svg").write_text(DRAWING.replace('id="b"', 'id="b" stroke="#ff0000"'))
    brushsvg("convert", "red.svg", "-o", "red.src", "--cell", "mine.toml", cwd=tmp_path, status=0)
    text = (tmp_path / "red.src").read_text()
    assert "\nWAIT SEC 0.5" in text and "\nHALT" in text
    assert errors_of(text) == []


def test_a_page_of_1000_strokes_is_krl(errors_of, tmp_path):
    (tmp_path / "page.json").write_text(json.dumps(page(1000)))
    brushsvg("convert", "page.json", "-o", "page.src", "--cell", "kr6-r900", cwd=tmp_path, status=0, timeout_s=600)
    assert errors_of((tmp_path / "page.src").read_text()) == []


@pytest.mark.parametrize(("old", "new"), BROKEN, ids=[f"{old.strip()}" for old, _ in BROKEN])
def test_the_grammar_refuses_invalid_krl(errors_of, old, new):
    text = GOLDEN.read_text()
    assert old in text
    assert errors_of(text.replace(old, new, 1))
