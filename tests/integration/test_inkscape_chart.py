"""The calibration sheet in the real Inkscape has the marks of `brushsvg chart`."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from command import SOUND, brushsvg

from brushsvg import read_drawing
from brushsvg.machine.cells.cell import Reload, Station
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.read import ReadOptions

INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
GAP_MM = 10


def markers_mm(path, select=None):
    text = path.read_text().replace('data-brushsvg-skip="yes"', "")
    shown = path.with_name(f"{path.stem}-shown.svg")
    shown.write_text(text)
    elements = read_drawing(shown, ReadOptions(select=select)).elements
    return [np.vstack([part.cubics[:, 0] for part in each.subpaths]) for each in elements]


@pytest.mark.parametrize("view_box", ["0 0 120 60", "0 0 480 240"])
def test_the_chart_page_is_next_to_the_document_page(plugin, tmp_path, view_box):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(SOUND.replace('viewBox="0 0 120 60"', f'viewBox="{view_box}"'))
    once = plugin.effect("chart", drawing, tmp_path / "once.svg")
    twice = plugin.effect("chart", once, tmp_path / "twice.svg")
    brushsvg("chart", "-o", "chart.json", "--page", "page.svg", cwd=tmp_path, status=0)
    expected = markers_mm(tmp_path / "page.svg", "path")
    for file in (once, twice):
        scale = float(view_box.split()[2]) / 120
        pages = [
            [float(each.get(name)) / scale for name in ("x", "y", "width", "height")]
            for each in ET.parse(file).getroot().iter(f"{INKSCAPE}page")
        ]
        assert np.array(pages) == pytest.approx(np.array([[0, 0, 120, 60], [120 + GAP_MM, 0, 210, 297]]), abs=1e-3)
        found = markers_mm(file, "#brushsvg-chart path")
        assert len(found) == len(expected) == 9  # eight markers and the bar
        for ours, theirs in zip(found, expected, strict=True):
            moved = theirs + np.array(
                [120 + GAP_MM, 60 - 297]
            )  # both pages share their upper edge; the paper's y points up
            assert np.abs(ours - moved).max() < 0.01
    for name in ("drawing", "twice"):
        brushsvg("convert", f"{name}.svg", "-o", f"{name}.ngc", cwd=tmp_path, status=0)
    assert (tmp_path / "twice.ngc").read_bytes() == (tmp_path / "drawing.ngc").read_bytes()


def test_program_and_chart_file_equal_the_command_line_output(plugin, tmp_path):
    drawing, saved = tmp_path / "drawing.svg", tmp_path / "my sheet \u00fc.ngc"
    drawing.write_text(SOUND.replace("<svg ", '<svg data-brushsvg-cell="grbl-3axis" '))
    done = plugin.script("chart", drawing, f"--output={saved}", "--strokes=few")
    assert done.returncode == 0 and done.stderr.decode().startswith(f"Saved: {saved} and ")
    flags = ("--chart", "typed.json", "--cell", "grbl-3axis", "--strokes", "few")
    brushsvg("chart", "-o", "typed.ngc", *flags, cwd=tmp_path, status=0)
    assert saved.read_bytes() == (tmp_path / "typed.ngc").read_bytes()
    assert (tmp_path / "my sheet \u00fc.chart.json").read_bytes() == (tmp_path / "typed.json").read_bytes()


@pytest.mark.parametrize(
    ("name", "reported"),
    [
        ("sheet.txt", ".ngc .script .jks .mod .py .src .lua .ls .drl .csv .ebb .json"),
        ("nowhere/sheet.ngc", "cannot be written"),
    ],
)
def test_an_unwritable_chart_file_is_reported(plugin, tmp_path, name, reported):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(SOUND)
    done = plugin.script("chart", drawing, f"--output={tmp_path / name}")
    assert done.returncode == 1 and reported in done.stderr.decode() and "Traceback" not in done.stderr.decode()


def test_warnings_are_shown_if_only_the_page_is_made(plugin, tmp_path):
    """They appeared only if somebody also chose a file for the program."""
    drawing, cell = tmp_path / "drawing.svg", tmp_path / "mine.toml"
    drawing.write_text(SOUND)
    station = Station("red", (-20.0, 50.0), depth_mm=7.0)
    reload = Reload("length", 500.0, narrower_percent=10.0)
    cell.write_text(write_cell(replace(find_cell(), name="mine", reload=reload, stations=(station,))))
    shown = plugin.script("chart", drawing, f"--cell_file={cell}").stderr.decode()
    assert "narrower_percent" in shown
    assert not plugin.script("chart", drawing).stderr
