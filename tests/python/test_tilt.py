"""The tilt of a brush is read, written, kept, and refused where it would be lost."""

import copy
import json
import pickle

import numpy as np
import pytest
from diagnostics import agrees, are_reported, in_json, refused

import brushsvg
from brushsvg import _core
from brushsvg.calibration.chart.file import read_chart, write_chart
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.marks.from_marks import expected_marks
from brushsvg.calibration.marks.mark_input import read_painted
from brushsvg.comparison.corrections import Correction, apply_corrections
from brushsvg.comparison.job_page import job_page
from brushsvg.machine.cells.cell import Machine
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.realised.pass_on_path import move_pass_to_path
from brushsvg.machine.realised.passes import as_run
from brushsvg.show.evaluation.uncertainty import estimate_confidence

BRUSH = brushsvg.find_brush("round-6")
POSES = [[20, 20, 0], [30, 20, -2], [60, 20, -2], [70, 30, 0]]


def axes(*tilts_deg, towards_deg=0.0):
    """Return unit vectors that lean towards a direction of the paper."""
    tilts, towards = np.radians(tilts_deg), np.radians(towards_deg)
    return np.column_stack([np.sin(tilts) * np.cos(towards), np.sin(tilts) * np.sin(towards), np.cos(tilts)])


TILTED = axes(0, 5, 5, 12)


def plan(tool_axes=TILTED):
    tilted = _core.Pass("tilted", POSES, tool_axes=tool_axes)
    return _core.Plan("round-6", "", (100, 100), [_core.Pass("upright", POSES), tilted])


def reported(change):
    """Return the text of a plan.json after a change to its second pass."""
    document = json.loads(_core.write_plan(plan()))
    change(document, document["passes"][1])
    return json.dumps(document)


# Written and read -------------------------------------------------------------------------------------------


def test_a_tilt_is_read_back_as_written():
    text = _core.write_plan(plan())
    assert json.loads(text)["version"] == 2
    back = _core.read_plan(text)
    assert len(back.passes[0].tool_axes) == 0
    assert back.passes[1].tool_axes == pytest.approx(plan().passes[1].tool_axes, abs=1e-7)
    assert _core.write_plan(back) == text


def test_a_plan_without_tilt_is_written_as_before():
    text = _core.write_plan(plan(tool_axes=np.zeros((0, 3))))
    assert json.loads(text)["version"] == 1
    assert "tool_axes" not in text


def test_a_file_of_version_2_may_have_no_tilt():
    def upright(document, one):
        del one["tool_axes"]

    back = _core.read_plan(reported(upright))
    assert json.loads(_core.write_plan(back))["version"] == 1


def axis(row, *value):
    def change(document, one):
        one["tool_axes"][row] = list(value)

    return change


@pytest.mark.parametrize(
    ("change", "expected", "where"),
    [
        (lambda document, one: document.update(version=1), "version-unknown tilted 1 2", "tool_axes"),
        (lambda document, one: document.update(version=3), "version-unknown 3 2", "version"),
        (lambda document, one: document.update(version=1.5), "version-unknown 1.5", "version"),
        (lambda document, one: one["tool_axes"].pop(), "sizes-differ tilted 3 4", "tool_axes"),
        (lambda document, one: one.update(tool_axes={}), "wrong-type", "tool_axes"),
        (axis(2, 0, 0, 1.0011), "tool-axis-invalid tilted 2 1.0011 0.999 1.001", "tool_axes"),
        (axis(2, 0, 0, 0), "tool-axis-invalid tilted 2 0 0.999", "tool_axes"),
        (axis(1, *axes(31)[0]), "tool-axis-invalid tilted 1 31 30", "tool_axes"),
        (axis(3, 0, 0, -1), "tool-axis-invalid tilted 3 180 30", "tool_axes"),
        (axis(1, 0, 1), "wrong-type", "tool_axes[1]"),
        (axis(1, 0, 0, "up"), "wrong-type", "tool_axes[1][2]"),
        (lambda document, one: one.update(arcs=[[1, 2, 45, 40, 1]]), "arc-invalid tilted", "tool_axes"),
    ],
)
def test_an_invalid_tilt_is_refused(change, expected, where):
    if where.startswith("tool_axes"):
        where = f"passes[1].{where}"
    with refused(expected, where):
        _core.read_plan(reported(change))


def test_three_decimals_are_enough():
    for tilt in np.linspace(0, 29, 30):
        for towards in np.linspace(0, 360, 37):
            rounded = np.round(axes(tilt, towards_deg=towards)[0], 3)
            _core.read_plan(reported(axis(1, *rounded)))


def test_an_invalid_tilt_is_not_written():
    with refused("tool-axis-invalid tilted 40 30"):
        _core.write_plan(plan(axes(0, 5, 40, 5)))


# A value ----------------------------------------------------------------------------------------------------


def test_a_tilt_is_part_of_the_value_of_a_pass():
    one = plan().passes[1]
    other = copy.copy(one)
    assert pickle.loads(pickle.dumps(one)) == one == other
    other.tool_axes = axes(0, 5, 5, 12.1)
    assert other != one
    assert "tilted" in repr(one).split(":", 1)[1]
    assert "tilted" not in repr(plan().passes[0])


# Refused where it would be lost -----------------------------------------------------------------------------


def read_chart_of(of):
    document = json.loads(write_chart(chart(BRUSH, (210, 297))))
    read_chart(json.dumps(document | {"plan": json.loads(_core.write_plan(of))}).encode())


CORRECTION = Correction("tilted", (20.0, 20.0), (40.0, 20.0), (1.0, 0.0), 0.0)

READERS = {
    "simplify_pass": lambda of: _core.simplify_pass(of.passes[1], BRUSH, 0.5),
    "interrupted": lambda of: _core.split_into_loads(of.passes[1], BRUSH, 20, 20),
    "in_loads": lambda of: split_into_loads(of, BRUSH, brushsvg.find_cell("linuxcnc-3axis")),
    "move_pass_to_path": lambda of: move_pass_to_path(of.passes[1], POSES, ()),
    "as_run": lambda of: as_run(of.passes, Machine()),
    "expected_marks": lambda of: expected_marks(of, BRUSH),
    "read_painted": lambda of: read_painted(json.loads(_core.write_plan(of)), [], None),
    "read_chart": read_chart_of,
    "job_page": lambda of: job_page(of),
    "corrected": lambda of: apply_corrections(of, (CORRECTION,), BRUSH),
    "uncertainty": lambda of: estimate_confidence(of, BRUSH, brushsvg.simulate(plan(np.zeros((0, 3))), BRUSH)),
}


@pytest.mark.parametrize("name", READERS)
def test_functions_without_tilt_support_refuse_tilted_plans(name):
    with refused("tilt-unsupported 12", "tilted"):
        READERS[name](plan())


@pytest.mark.parametrize("name", [name for name in READERS if not name.startswith("read_")])
def test_functions_without_tilt_support_accept_upright_axes(name):
    made = READERS[name](plan(axes(0, 0, 0, 0)))
    passes = {"simplify_pass": [made], "move_pass_to_path": [made], "interrupted": made, "as_run": made}.get(name, [])
    for one in passes:
        assert len(one.tool_axes) in (0, len(one.poses_mm))


def test_cells_that_cannot_tilt_the_brush_write_no_program(tmp_path):
    """Cells that cannot tilt the brush write no program.

    This test has the cells with three axes; test_tilted_programs.py has the others.
    """
    for name in brushsvg.cell_names():
        cell = brushsvg.find_cell(name)
        if cell.tool:
            continue
        with refused(f"tilt-unsupported {name} 12", "tilted"):
            split_into_loads(plan(), BRUSH, cell)
    with refused("tilt-unsupported", "tilted"):
        brushsvg.write_program(tmp_path / "a.ngc", plan(), BRUSH)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "words",
    [
        ["convert", "a.json", "-o", "a.ngc"],
        ["convert", "a.json", "-o", "b.json"],
        ["preview", "a.json", "-o", "a.html"],
        ["preview", "a.json", "-o", "a.html", "--cell", "ur5e"],
        ["convert", "a.json", "-o", "a.script", "--page", "a.pdf", "--cell", "ur5e"],
        ["preview", "a.json", "-o", "a.svg", "--band", "--cell", "ur5e"],
        ["preview", "a.json"],
        ["setup", "border", "a.json", "-o", "a.ngc"],
        ["preview", "a.json", "-o", "a.svg", "--band"],
    ],
)
def test_commands_without_tilt_support_refuse_tilted_plans(words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.json").write_text(_core.write_plan(plan()))
    status, _, heard = in_json(capsys, *words)
    assert status == 1
    assert all(agrees(each, "tilt-unsupported 12", "tilted") for _, each in heard)
    assert [each.name for each in tmp_path.iterdir()] == ["a.json"]


# Predicted --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".json", ".svg", ".png"])
def test_preview_shows_a_tilted_mark_and_reports_unsupported_cells(suffix, tmp_path, capsys):
    given, made = tmp_path / "a.json", tmp_path / f"b{suffix}"
    pictures = []
    for tool_axes in (axes(0, 0, 0, 0), axes(0, 20, 20, 20)):
        given.write_text(_core.write_plan(plan(tool_axes)))
        status, _, heard = in_json(capsys, "preview", given, "-o", made)
        assert status == 0
        is_tilted = tool_axes[:, 0].any()
        assert are_reported([each for _, each in heard], *(["tilt-unsupported 20"] if is_tilted else []))
        pictures.append(made.read_bytes())
    assert pictures[0] != pictures[1]


def test_marks_contain_the_tilt_of_the_brush():
    marks = brushsvg.simulate(plan(axes(0, 10, 10, 10)), BRUSH)
    brushsvg.trace_outlines(marks, BRUSH)
    upright, tilted = marks.passes
    assert len(upright.lean_mm_per_mm) == 0
    assert tilted.lean_mm_per_mm[-1] == pytest.approx([np.tan(np.radians(10)), 0])
    assert pickle.loads(pickle.dumps(marks)) == marks
    text = _core.write_marks(marks)
    assert json.loads(text)["version"] == 2
    back = _core.read_marks(text)
    assert back.passes[1].lean_mm_per_mm == pytest.approx(tilted.lean_mm_per_mm, abs=1e-7)
    assert _core.write_marks(back) == text
    marks.passes = marks.passes[:1]
    assert json.loads(_core.write_marks(marks))["version"] == 1


@pytest.mark.parametrize(
    ("change", "expected", "where"),
    [
        (lambda document, one: document.update(version=1), "version-unknown 1 2", "lean_mm_per_mm"),
        (lambda document, one: one["lean_mm_per_mm"].pop(), "sizes-differ", "lean_mm_per_mm"),
        (lambda document, one: one["lean_mm_per_mm"].insert(0, [0.6, 0]), "sizes-differ", "lean_mm_per_mm"),
        (
            lambda document, one: one["lean_mm_per_mm"][3].__setitem__(0, 0.6),
            "out-of-range 0.6",
            "lean_mm_per_mm[3]",
        ),
    ],
)
def test_marks_with_an_impossible_tilt_are_refused(change, expected, where):
    document = json.loads(_core.write_marks(brushsvg.simulate(plan(), BRUSH)))
    change(document, document["passes"][1])
    with refused(expected, f"passes[1].{where}"):
        _core.read_marks(json.dumps(document))


def test_a_pass_with_invalid_axes_is_not_simulated():
    with refused("tool-axis-invalid tilted 2 45 30", "tilted"):
        brushsvg.simulate(plan(axes(0, 5, 45, 12)), BRUSH)
    with refused("sizes-differ 3 4", "tilted"):
        brushsvg.simulate(plan(axes(0, 5, 12)), BRUSH)
