"""The report on painted marks says how well the model predicts them."""

import re
import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

from brushsvg import _core
from brushsvg.calibration.marks import machine_found
from brushsvg.calibration.marks.from_marks import brush_of
from brushsvg.calibration.marks.mark_input import Painted
from brushsvg.calibration.marks.mark_report import _unexpected, measure_mean_overlaps
from brushsvg.machine.cells.cell import list_uncorrectable_keys, reason_for_no_backlash
from brushsvg.machine.cells.cell_file import cell_names, find_cell


def test_overlaps_are_given_with_and_without_displacement():
    brush = brush_of(_core.MarkLaws([4.0], [0.0, 0.5], [0.0, 0.5]), "b", (0.0, 6.0))
    ways = [np.array([[20, 20 + y, 0], [30, 20 + y, -4], [60, 25 + y, -4.0]]) for y in (0.0, 40.0)]
    marks = _core.simulate(_core.Plan("b", "", (1.0, 1.0), [_core.Pass("", way) for way in ways]), brush)
    _core.trace_outlines(marks, brush)
    # The sheet is displaced, and the second mark is another 1.5 mm off.
    moved = [np.array([3.0, -2.0]), np.array([3.0, -0.5])]
    painted = [
        _core.PaintedMark(str(k), way, [np.array(ring) + by for ring in one.outline_mm])
        for k, (way, one, by) in enumerate(zip(ways, marks.passes, moved, strict=True))
    ]
    fit = SimpleNamespace(
        turn_rad=0.0,
        centre_mm=[0.0, 0.0],
        shift_mm=[3.0, -2.0],
        height_mm=0.0,
        marks=[
            SimpleNamespace(displacement_mm=d, way_mm=way)
            for d, way in zip(([0.0, 0.0], [0.0, 1.5]), ways, strict=True)
        ],
    )
    placed, without = measure_mean_overlaps(SimpleNamespace(brush=brush, fit=fit, painted=Painted(painted, 4.0, 2)))
    assert without == pytest.approx(1.0, abs=1e-3)
    rings = marks.passes[1].outline_mm
    second = _core.overlap([np.add(ring, [0.0, 1.5]) for ring in rings], rings)
    assert second < 0.7
    assert placed == pytest.approx((1.0 + second) / 2, abs=1e-3)


def test_each_law_gets_its_own_covariance_rows_if_another_law_lacks_a_term():
    """Each law gets its own rows of the covariance, even if another law has no term.

    A ratio may depend on depth in principle although it is constant here. With the rows of other laws, the
    uncertainty of half widths was once +- 470 mm.
    """
    ratio = [1.9, 0.0, 0.0, 0.0]
    laws = _core.MarkLaws([3.0, 1.0], [0.0, 0.4], [0.0, 0.5, -0.01], 1.9, 1.0, False, ratio)
    variances = np.array([1, 2, 3, 4, 5, *[6] * len(ratio), 7, 8, 9, 10, 11]) * 1e-4
    brush = brush_of(laws, "b", (0.0, 8.0), np.diag(variances))
    target = _core.interval_factor_95() * np.sqrt([0.0, 4e-4, 5e-4])
    assert brush.half_width.half_interval_95 == pytest.approx(target)
    assert len(brush.tip_to_widest.coefficients) == len(brush.tip_to_widest.half_interval_95) == 6


@pytest.mark.parametrize("name", sorted(cell_names()))
def test_the_table_for_a_cell_marks_lines_without_effect_on_some_machines(name):
    """The table for a cell marks the lines that have no use on a kind of machine.

    Without --cell, the kind of machine is unknown. Backlash was once printed for arms as well, whose cells
    refuse it.
    """
    cell = find_cell(name)
    machine = SimpleNamespace(lean_mm_per_mm=(0.1, 0.0), scale=(1.01, 1.0), skew=0.0, tilt_mm_per_mm=(0.001, 0.0))
    fit = SimpleNamespace(machine=machine, height_mm=0.2, centre_mm=(0.0, 0.0))
    found = [
        machine_found.Number("lean", "lean in x", 0.1, 0.01, "mm per mm of depth"),
        machine_found.Number("axes", "scale in x", 1.01, 0.001, ""),
        machine_found.Number("tilt", "tilt in x", 0.001, 0.0001, "mm higher per mm"),
        *(machine_found.Number("backlash", f"backlash in {axis}", 0.3, 0.1, "mm") for axis in "xy"),
    ]
    head, *lines = machine_found.format_cell_table(fit, found)
    remarks = {line.partition(" = ")[0]: line.partition("  # ")[2] for line in lines}
    assert head == "[machine]" and {"backlash_mm", "scale"} <= tomllib.loads("\n".join(lines)).keys()
    kinds = {
        "arm": reason_for_no_backlash(cell) != "",
        "servo": bool(cell.servo or cell.pen),
        "pen": bool(cell.pen),
    }
    of_no_use = {
        key
        for key, remark in remarks.items()
        if any(of and re.search(rf"\b{kind}\b", remark) for kind, of in kinds.items())
    }
    assert of_no_use == list_uncorrectable_keys(cell).keys() & remarks.keys()


@pytest.mark.parametrize(("sigma_mm", "advised", "kept"), [(0.3, ["2", "0.05"], None), (0.05, ["0.05", "2"], "0.05")])
def test_a_measured_height_is_to_be_kept(sigma_mm, advised, kept):
    """A liner's lines look like high paper. With a larger --height, its measured height would be given up."""
    expected = _core.MarkOptions()
    expected.height_mm = _core.Prior(0.0, sigma_mm)
    fit = SimpleNamespace(
        height_mm=1.42, shift_mm=(0.0, 0.0), turn_rad=0.0, marks=[SimpleNamespace(displacement_mm=(0.0, 0.0))]
    )
    painted = SimpleNamespace(marks=[SimpleNamespace(stroke="arc-1")])
    calibration = SimpleNamespace(fit=fit, expected=expected, painted=painted, strays=())
    (sentence,) = _unexpected(calibration, of_photo=True)
    assert re.findall(r"--height ([\d.]*\d)", sentence) == advised
    assert (re.findall(r"keep --height ([\d.]*\d)", sentence) or [None]) == [kept]
