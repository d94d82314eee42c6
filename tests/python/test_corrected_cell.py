"""Faults that `compare` finds are added to the corrections of the next cell.

The tests also cover how exactly a brush is known before the comparison.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import agrees, are_reported

core = pytest.importorskip("brushsvg._core")

from brushsvg import find_brush  # noqa: E402
from brushsvg.comparison.attribution.corrected_cell import (  # noqa: E402
    corrected_machine,
    format_machine_table,
    select_certain_numbers,
)
from brushsvg.comparison.attribution.model import BRUSH, MACHINE, PAPER, FaultModel  # noqa: E402
from brushsvg.comparison.next_corrections import next_corrections  # noqa: E402
from brushsvg.comparison.placing import Placed  # noqa: E402
from brushsvg.jobs.comparing import _find_correctable_machine, _report_uncorrectable  # noqa: E402
from brushsvg.machine.cells.cell import Machine, Paper, axes_along_paper  # noqa: E402
from brushsvg.machine.cells.cell_file import cell_names, find_cell, parse_cell, write_cell  # noqa: E402
from brushsvg.machine.realised.distortion import commanded_mm, true_mm  # noqa: E402

MIDDLE = np.array([70.0, 40.0])
TRUE = Machine((0.1, -0.05), (1.01, 0.992), 0.004, -0.3, (0.006, -0.008))
UNDONE = Machine((0.0, 0.0), (1.004, 0.998), -0.002, 0.2, (0.002, 0.003))
LEANING = Machine((0.06, 0.02), (1.004, 0.998), -0.002, TRUE.height_mm, TRUE.tilt_mm_per_mm)


def found(beyond: Machine, half=1e-6):
    """Return faults as `compare` reports them: tilt about the middle of the marks."""
    height = beyond.height_mm + np.dot(beyond.tilt_mm_per_mm, MIDDLE)
    values = {
        (MACHINE, "scale in x"): beyond.scale[0] - 1,
        (MACHINE, "scale in y"): beyond.scale[1] - 1,
        (MACHINE, "skew"): beyond.skew,
        (MACHINE, "lean in x"): beyond.lean_mm_per_mm[0],
        (MACHINE, "lean in y"): beyond.lean_mm_per_mm[1],
        (MACHINE, "backlash in x"): 0.4,
        (MACHINE, "backlash in y"): 0.0,
        (PAPER, "height"): height,
        (PAPER, "tilt in x"): beyond.tilt_mm_per_mm[0],
        (PAPER, "tilt in y"): beyond.tilt_mm_per_mm[1],
        (BRUSH, "lag"): 0.1,
    }
    rows = [
        SimpleNamespace(number=SimpleNamespace(cause=cause, name=name), value=value, half=half)
        for (cause, name), value in values.items()
    ]
    return SimpleNamespace(found=rows)


def places(count=40):
    rng = np.random.default_rng(1)
    return np.column_stack([rng.uniform(0, 150, count), rng.uniform(0, 90, count), rng.uniform(-6, 0, count)])


@pytest.mark.parametrize("undone", [UNDONE, LEANING])
def test_existing_corrections_stay_in_effect(undone):
    """Corrections that the cell already had stay in effect.

    The true machine gives the places of the painted job. Least squares give the faults beyond the cell.
    """
    target = places(400)
    went = true_mm(commanded_mm(target, undone), TRUE)
    depth = np.maximum(-went[:, 2], 0)
    x, y, ones = target[:, 0], target[:, 1], np.ones(len(target))
    to_x = np.linalg.lstsq(np.column_stack([x, y, depth]), went[:, 0], rcond=None)[0]
    to_y = np.linalg.lstsq(np.column_stack([y, depth]), went[:, 1], rcond=None)[0]
    to_z = np.linalg.lstsq(np.column_stack([ones, x, y]), target[:, 2] - went[:, 2], rcond=None)[0]
    beyond = Machine((to_x[2], to_y[1]), (to_x[0], to_y[0]), to_x[1], to_z[0], (to_z[1], to_z[2]))
    now = corrected_machine(found(beyond), MIDDLE, undone)
    off = true_mm(commanded_mm(target, now), TRUE) - target
    assert np.abs(off).max() < 0.01, np.abs(off).max(axis=0)
    before = true_mm(commanded_mm(target, undone), TRUE) - target
    assert np.abs(before).max() > 0.3


def test_a_cell_without_corrections_gets_the_found_values():
    now = corrected_machine(found(TRUE), MIDDLE, None)
    assert (now.scale, now.skew, now.lean_mm_per_mm) == (TRUE.scale, TRUE.skew, TRUE.lean_mm_per_mm)
    assert now.height_mm == pytest.approx(TRUE.height_mm) and now.tilt_mm_per_mm == TRUE.tilt_mm_per_mm


def test_the_map_of_the_paper_stays():
    rows = ((0.0, 0.0, 0.1), (50.0, 0.0, 0.2), (0.0, 50.0, 0.0), (50.0, 50.0, -0.1))
    now = corrected_machine(found(TRUE), MIDDLE, replace(UNDONE, map_mm=rows))
    assert now.map_mm == rows
    cell = write_cell(replace(find_cell("linuxcnc-3axis"), machine=None))
    assert parse_cell("\n".join([cell, *format_machine_table(now)])).machine == now, (
        "the table that is printed has it, too"
    )


@pytest.mark.parametrize("along, target", [((0, 1), (0.5, 0.2)), ((1, 0), (0.1, 0.6)), (None, (0.1, 0.2))])
def test_found_backlash_is_added_to_the_backlash_of_the_cell(along, target):
    """Backlash that was found is added to the backlash that the cell undoes.

    The result depends on which machine axes run along the paper's x and y.
    """
    before = replace(UNDONE, backlash_mm=(0.1, 0.2))
    assert corrected_machine(found(TRUE), MIDDLE, before, along).backlash_mm == pytest.approx(target)
    assert corrected_machine(found(TRUE, half=10.0), MIDDLE, before, along) is None


@pytest.mark.parametrize("name", cell_names())
def test_every_cell_gets_the_faults_it_can_undo_and_the_others_are_reported(name):
    """Every cell takes the faults that it can undo; the others are reported.

    A servo cell once refused lean, and the whole comparison was lost.
    """
    cell = find_cell(name)
    along = axes_along_paper(cell)
    machine, left_out = _find_correctable_machine(found(TRUE), MIDDLE, cell, along)
    assert parse_cell(write_cell(replace(cell, machine=machine))).machine.scale == TRUE.scale
    leans, has_backlash = not (cell.servo or cell.pen), along is not None
    assert machine.lean_mm_per_mm == (TRUE.lean_mm_per_mm if leans else (0.0, 0.0))
    assert bool(any(machine.backlash_mm)) == has_backlash
    if not cell.pen:
        middle_mm = machine.height_mm + np.dot(machine.tilt_mm_per_mm, MIDDLE)
        assert middle_mm == pytest.approx(TRUE.height_mm + np.dot(TRUE.tilt_mm_per_mm, MIDDLE), abs=1e-3)
    notices = _report_uncorrectable(found(TRUE), cell, left_out)
    assert len(notices) == (not (leans and has_backlash))
    for notice in notices:
        assert agrees(notice, "machine-not-undone")
        assert ("lean" in notice.sentence, "backlash" in notice.sentence) == (not leans, not has_backlash)


def test_a_value_outside_the_range_of_a_cell_is_left_out():
    far = replace(TRUE, scale=(1.2, 1.0))
    machine, left_out = _find_correctable_machine(found(far), MIDDLE, find_cell("linuxcnc-3axis"), (0, 1))
    assert machine.scale == (1.0, 1.0) and machine.lean_mm_per_mm == TRUE.lean_mm_per_mm
    assert are_reported(
        _report_uncorrectable(found(far), find_cell("linuxcnc-3axis"), left_out), "machine-not-undone 1.2"
    )


def test_a_page_printed_at_97_percent_does_not_correct_the_machine():
    """A page printed at 97 % does not count as a machine that is 3 % off.

    The scale once went into the cell without a warning. Each program after that was 3 % too small.
    """
    printed, cell = replace(TRUE, scale=(1 / 0.97, 1 / 0.9702)), find_cell("linuxcnc-3axis")
    machine, left_out = _find_correctable_machine(found(printed), MIDDLE, cell, (0, 1))
    assert machine.scale == (1.0, 1.0) and machine.lean_mm_per_mm == TRUE.lean_mm_per_mm
    assert are_reported(_report_uncorrectable(found(printed), cell, left_out), "page-scale 97.0")
    for scale in ((1.031, 1.0), (1.012, 1.012)):  # one axis only; an error that is small enough for a machine
        machine, left_out = _find_correctable_machine(found(replace(TRUE, scale=scale)), MIDDLE, cell, (0, 1))
        assert machine.scale == scale and not left_out


@pytest.mark.parametrize("turned_deg, along", [(2.0, (0, 1)), (90.0, (1, 0)), (183.0, (0, 1)), (30.0, None)])
def test_corrections_follow_the_axes_along_the_paper(turned_deg, along):
    turned = Paper(rotation_deg=(0.0, 0.0, turned_deg))
    assert axes_along_paper(replace(find_cell("linuxcnc-3axis"), paper=turned)) == along
    assert axes_along_paper(replace(find_cell("ur5e"), paper=turned)) is None


def test_uncertain_values_change_nothing():
    assert corrected_machine(found(TRUE, half=10.0), MIDDLE, UNDONE) is None


def test_a_learned_brush_narrows_the_expected_lag_error():
    brush = find_brush("round-6")
    one = core.Pass(stroke="s", poses_mm=np.array([[0, 0, 0], [20, 0, -4.0], [40, 0, 0]]), speed_mm_s=20.0)
    plan = core.Plan("round-6", "", (100.0, 60.0), [one])
    free, held = (
        {n.name: n.sigma for n in FaultModel(plan, brush, ("s",), MIDDLE, learned).numbers} for learned in (False, True)
    )
    share = brush.lag.rmse_mm / core.interval_factor_95() / brush.lag(4.0)
    assert held["lag"] == pytest.approx(share) and held["lag"] < 0.5 * free["lag"] == 0.075
    assert held["tilt in x"] == free["tilt in x"]


@pytest.mark.parametrize(
    ("displaced_mm", "one_mm", "share", "of_one"),
    [
        (0.1, 0.1, 0.3, 0.3),
        (0.15, 0.15, 1 - 0.02 / (0.15**2 * 8 / 5), 1 - 0.02 / (0.15**2 * 8 / 5)),
        (0.2, 0.2, 1 - 0.02 / (0.2**2 * 8 / 5), 1 - 0.02 / (0.2**2 * 8 / 5)),
        (0.1, 0.4, 0.3, 0.75),
        (1.0, 1.0, 0.8, 0.8),
    ],
)
def test_corrections_that_may_be_chance_are_reduced(displaced_mm, one_mm, share, of_one):
    """Corrections that may be due to chance are reduced.

    All strokes are reduced by their spread (8 numbers, of which 3 are the sheet's place). A single stroke is
    reduced by the size of its own displacement.
    """
    asides = [one_mm, -displaced_mm, displaced_mm, -displaced_mm]
    rows = [
        SimpleNamespace(
            stroke=f"s{k}",
            placed=Placed((asides[k], 0.0), 0.0, 0.0, True),
            middle_mm=(20.0 * k, 30.0),
            missing=0.0,
            like=1.0,
        )
        for k in range(4)
    ]
    compared = SimpleNamespace(
        strokes=rows, common=Placed((0.0, 0.0), 0.0, 0.0, True), middle_mm=MIDDLE, spread_mm=displaced_mm
    )
    passes = [SimpleNamespace(stroke=row.stroke, poses_mm=np.array([[0.0, 0.0, 0.0]])) for row in rows]
    made, reported = next_corrections(compared, SimpleNamespace(passes=passes), (), None)
    assert not reported
    for k, row in enumerate(rows):
        share_of = of_one if k == 0 else share
        assert made[row.stroke].shift_mm == pytest.approx((-share_of * asides[k], 0.0))


@pytest.mark.parametrize(("value", "kept"), [(0.0015, 0.0015), (-0.0011, -0.0011), (0.0009, 0.0)])
def test_a_value_is_certain_beyond_half_its_interval(value, kept):
    number = SimpleNamespace(name="skew", cause=MACHINE)
    found = SimpleNamespace(found=[SimpleNamespace(value=value, half=0.001, number=number)])
    assert select_certain_numbers(found) == {"skew": kept}


def test_a_scale_alone_is_written_to_the_table():
    assert format_machine_table(Machine(scale=(1.01, 1.0)))[1:] == ["scale = [1.01000, 1.00000]", "skew = 0.00000"]
    assert format_machine_table(Machine()) == ["[machine]"]
