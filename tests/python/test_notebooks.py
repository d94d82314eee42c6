"""The notebooks of examples/ run from top to bottom and show what they promise."""

import json
import re
import shutil
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples" / "notebooks").glob("*.ipynb"))
MOST_CELLS = 16  # so that a notebook can be read in ten minutes


@pytest.fixture
def reported(tmp_path):
    """Return a function for the printed text and the kinds of pictures of a notebook."""
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")

    def run(path: Path) -> tuple[str, set[str]]:
        shutil.copy(path, tmp_path)
        book = nbformat.read(tmp_path / path.name, as_version=4)
        nbformat.validate(book)
        nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
        outputs = [out for cell in book.cells if cell.cell_type == "code" for out in cell.outputs]
        shown = {kind for out in outputs if "data" in out for kind in out["data"]}
        return "".join(out["text"] for out in outputs if out["output_type"] == "stream"), shown

    return run


def test_notebooks_are_small_and_contain_no_output():
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text())["cells"]
        assert len(cells) <= MOST_CELLS
        assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


@pytest.mark.slow
def test_first_word_notebook_runs(reported):
    text, shown = reported(NOTEBOOKS[0])
    compensated, plain = (float(each) for each in re.findall(r"overlap [a-z ]*(\d\.\d+)", text))
    assert compensated > 0.93 > 0.7 > plain
    assert "G21" in text and "image/svg+xml" in shown


@pytest.mark.thorough
@pytest.mark.slow
def test_brush_notebook_runs(reported):
    text, shown = reported(NOTEBOOKS[1])
    off = {name: float(mm) for name, mm in re.findall(r"^(.+): lag off by (.+) mm at most", text, re.M)}
    assert set(off) == {"table", "section 4", "marks"}
    assert off["section 4"] < 0.4 and off["marks"] < 0.3
    assert "to these values: tip_to_widest (10" in text
    assert {"image/svg+xml", "image/png"} <= shown


@pytest.mark.slow
def test_model_comparison_notebook_runs(reported):
    text, shown = reported(NOTEBOOKS[2])
    own, angles, ruler = (float(each) for each in re.findall(r"overlap (\d\.\d+)", text))
    assert own > 0.95 and own > angles and own > ruler
    assert "image/png" in shown
