"""Plans in Python: poses without copies, long-lived views, and arcs.

A view outlives the plan that it shows.
"""

import gc
import re

import numpy as np
import pytest
from diagnostics import refused

import brushsvg
from brushsvg import _core, find_brush


def plan_of(*passes):
    return _core.Plan(brush="round-6", sheet_mm=(100, 100), passes=list(passes))


def test_poses_are_read_only_views_without_a_copy():
    a_pass = plan_of(_core.Pass("a", [[1, 2, 0], [3, 4, -1]])).passes[0]
    poses = a_pass.poses_mm
    assert poses.tolist() == [[1, 2, 0], [3, 4, -1]]
    assert np.shares_memory(poses, a_pass.poses_mm)
    with pytest.raises(ValueError, match="read-only"):
        poses[0, 0] = 5


def test_a_view_stays_valid_after_its_pass_and_plan_are_deleted():
    poses = plan_of(_core.Pass("a", np.full((1000, 3), -2.0))).passes[0].poses_mm
    gc.collect()
    plan_of(*(_core.Pass("b", np.zeros((1000, 3))) for _ in range(20)))
    assert np.all(poses == -2.0)


def test_references_to_replaced_passes_and_poses_stay_unchanged():
    plan = plan_of(_core.Pass("a", np.full((1000, 3), -2.0)), _core.Pass("b", np.full((1000, 3), -3.0)))
    first, poses = plan.passes[0], plan.passes[1].poses_mm
    plan.passes = [plan.passes[1]]
    plan.passes[0].poses_mm = np.zeros((1000, 3))
    assert [p.stroke for p in plan.passes] == ["b"]
    assert plan.passes[0].poses_mm.max() == 0
    assert (first.stroke, first.poses_mm.max(), poses.max()) == ("a", -2.0, -3.0)


def test_changes_to_a_pass_of_a_plan_are_changes_to_the_plan():
    plan = plan_of(_core.Pass("a", [[0, 0, 0], [5, 0, -1]]))
    plan.passes[0].speed_mm_s = 7.0
    assert '"speed_mm_s": 7' in _core.write_plan(plan)


def test_arcs_are_stored_and_written():
    poses = [[0, 0, -1], [10, 0, -1], [20, 10, -1], [10, 20, -1], [0, 20, -1]]
    a_pass = _core.Pass("a", poses, arcs=[_core.Arc(first=1, last=3, centre_mm=(10, 10), direction=1)])
    plan = _core.read_plan(_core.write_plan(plan_of(a_pass)))
    assert "51.42 mm long" in repr(a_pass), "along the circle, not its chords"
    (arc,) = plan.passes[0].arcs
    assert (arc.first, arc.last, arc.centre_mm, arc.direction) == (1, 3, (10.0, 10.0), 1)
    assert repr(arc) == "Arc(1, 3, (10.000000, 10.000000), 1)"
    a_pass.arcs = []
    assert a_pass.arcs == ()
    assert "arcs" not in _core.write_plan(plan_of(a_pass))


def test_the_simulator_refuses_an_invalid_arc():
    a_pass = _core.Pass("V", [[0, 0, -1], [10, 0, -1], [20, 10, -1]], arcs=[_core.Arc(1, 2, (10, 11), 1)])
    with refused("arc-invalid 'arc 0' 2", "V") as caught:
        _core.simulate(plan_of(a_pass), find_brush("round-6"))
    assert re.search(r" -0\.95\d* mm", caught.value.sentence)


def test_appending_to_a_list_of_the_plan_raises():
    """Appending to plan.passes fails instead of changing a copy.

    plan.passes.append(...) once changed a temporary list, and the new pass was lost.
    """
    plan, brush = plan_of(_core.Pass("a", [[0, 0, 0], [5, 0, -1]])), find_brush("round-6")
    marks = _core.simulate(plan, brush)
    stroke = _core.Stroke("s", np.zeros((1, 8)), half_width=[(0, 1)])
    stroke.target_mm = [np.zeros((3, 2))]
    fit = _core.fit_law([1, 2, 3, 4], [1, 2, 3, 5], _core.LawShape((0, 4), 1))
    held = {
        "passes": plan.passes,
        "arcs": plan.passes[0].arcs,
        "sheet": plan.sheet_mm,
        "marks": marks.passes,
        "rings": marks.passes[0].outline_mm,
        "dragged": brush.footprints.dragged,
        "pressed": brush.footprints.pressed,
        "range": brush.depth_range_mm,
        "covariance": brush.covariance,
        "coefficients": brush.lag.coefficients,
        "intervals": brush.lag.half_interval_95,
        "knots": stroke.half_width,
        "wanted": stroke.target_mm,
        "tracking_errors": _core.compensate([], brush, (9, 9)).tracking_errors,
        "fit": fit.covariance[0],
        "residuals": fit.residual_mm,
    }
    assert {name: type(value) for name, value in held.items()} == dict.fromkeys(held, tuple)
    with pytest.raises(AttributeError):
        plan.passes.append(_core.Pass("b"))
    arrays = [stroke.middle_mm, stroke.target_mm[0], brush.footprints.dragged[0].outline_mm]
    arrays += [getattr(marks.passes[0], name) for name in ("depth_mm", "taut", "tcp_mm", "contact_mm", "pose")]
    assert not any(array.flags.writeable for array in arrays)


def test_laws_cannot_be_changed():
    """Laws cannot be changed.

    A law that was copied from a fit and given another floor once changed the fit's own law.
    """
    law = find_brush("round-6").lag
    for name in ("coefficients", "floor", "source", "rmse_mm", "degrees_of_freedom"):
        with pytest.raises(AttributeError):
            setattr(law, name, getattr(law, name))


def test_the_origin_of_a_stroke_is_kept_in_fields():
    stroke = _core.Stroke(_core.StrokeId("icon/1", part=2, repeat=3, lane=4))
    assert stroke.id == "icon/1/2#3~4" and stroke.origin.element == "icon/1"
    (a_pass,) = _core.compensate(
        [_core.Stroke(stroke.origin, np.zeros((1, 8)), half_width=[(0, 1)])], find_brush("round-6"), (9, 9)
    ).plan.passes
    assert (a_pass.stroke, a_pass.origin.part, a_pass.origin.lane) == (stroke.id, 2, 4)
    (again,) = _core.read_plan(_core.write_plan(plan_of(a_pass))).passes
    assert (again.stroke, again.origin.element, again.origin.part) == (
        stroke.id,
        stroke.id,
        0,
    )  # the name is not split into its parts
    stroke.id = "other/2"
    assert (stroke.id, stroke.origin.element, stroke.origin.part) == ("other/2", "other/2", 0)


def test_a_plan_may_be_given_as_bytes():
    plan = _core.Plan("round-6", "", (100, 60), [_core.Pass("a", np.array([(1, 1, 0), (2, 1, -1.0)]), 20)])
    text = brushsvg.write_plan(plan)
    assert brushsvg.write_plan(brushsvg.read_plan(text.encode())) == text
    with pytest.raises(brushsvg.Error) as reported:
        brushsvg.read_plan(b"\xff\xfe")
    assert reported.value.code == "not-json"
