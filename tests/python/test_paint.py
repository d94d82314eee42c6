"""Fetching paint: when, where, in which order, and never lower than is safe."""

import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import agrees, are_reported, gives, in_json, is_reported, refused
from judge.gcode import run_gcode
from programs import RUNNABLE, call, forbidden, whole

from brushsvg import _core
from brushsvg.cli import main
from brushsvg.jobs.prediction import predict_plan_marks
from brushsvg.machine import writer
from brushsvg.machine.cells.cell import Reload, Station
from brushsvg.machine.cells.cell_check import report_unusual_values
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.dry_brush import report_dry_brush, report_long_strokes, report_missing_paint
from brushsvg.machine.job_program import make_checked_program
from brushsvg.machine.moves import Wait
from brushsvg.machine.paint_reload import dips_mm, list_station_visits, load_length_mm, painted_mm, split_into_loads
from brushsvg.machine.preflight import check_job
from brushsvg.machine.station_moves import make_visit
from brushsvg.model.library import find_brush
from brushsvg.show.evaluation.figures import PaintedPlan, measure_figures
from brushsvg.verify.readback import read_program
from brushsvg.verify.simulate_program import simulate_program

BLACK = Station("black", (-20.0, 10.0), ("#000000",), surface_mm=-2.0, depth_mm=7.0, rim_mm=4.0, hold_s=0.5, drip_s=2.0)
ANY = Station("any", (-20.0, 40.0), depth_mm=5.0, wipe_mm=((-14.0, 40.0, 3.0), (-10.0, 40.0, 3.0)))
WATER = Station("water", (-20.0, 70.0), depth_mm=12.0)
STRIPE = [(20, 0, 0), (25, 0, -3), (60, 0, -3), (58, 0, 0)]
BRUSH = SimpleNamespace(name="b", max_speed_mm_s=25.0)


REQUESTED, REFUSED = (_core.Settings(reload=requested) for requested in (True, False))


def cell_with(reload, *stations):
    return replace(find_cell(), reload=reload, stations=stations or (BLACK, ANY, WATER))


def plan_of(*strokes):
    """Return a plan of strokes: (length [mm], colour, layer, optional settings)."""
    passes = [
        _core.Pass(f"s{k}", np.array([(0, 0, 0), (length, 0, -1.0)]), 20.0, layer, colour, *settings)
        for k, (length, colour, layer, *settings) in enumerate(strokes, 1)
    ]
    return _core.Plan("round-6", "", (400.0, 100.0), passes)


def names(found):
    return [[station.name for station in stations] for stations in found]


def test_a_cell_without_reload_has_no_paint_visits():
    assert list_station_visits(whole(plan_of((10, "#000000", ""))), find_cell()) == ()


def test_paint_is_fetched_after_the_length_of_a_load():
    plan = plan_of(*[(40, "#000000", "")] * 6)
    assert names(list_station_visits(whole(plan), cell_with(Reload("length", 100.0)))) == [
        ["black"],
        [],
        ["black"],
        [],
        ["black"],
        [],
    ]
    assert names(list_station_visits(whole(plan), cell_with(Reload("length", 1000.0)))) == [
        ["black"],
        [],
        [],
        [],
        [],
        [],
    ]


def test_paint_can_be_fetched_for_every_stroke_or_layer():
    plan = plan_of((9, "#000000", "a"), (9, "#000000", "a"), (9, "#000000", "b"))
    assert names(list_station_visits(whole(plan), cell_with(Reload("stroke")))) == [["black"]] * 3
    assert names(list_station_visits(whole(plan), cell_with(Reload("layer")))) == [["black"], [], ["black"]]


def test_the_brush_is_washed_before_another_colour():
    plan = plan_of((9, "#000000", ""), (9, "#FF0000", ""), (9, "#00ff00", ""), (9, "#000000", ""))
    found = names(list_station_visits(whole(plan), cell_with(Reload("length", wash="water"))))
    assert found == [["black"], ["water", "any"], [], ["water", "black"]], "red and green come from one vessel"


def test_a_resumed_job_starts_with_a_paint_visit():
    plan = plan_of(*[(40, "#000000", "")] * 4)
    assert names(list_station_visits(whole(plan), cell_with(Reload("length", 1000.0)), first_stroke=3)) == [
        [],
        [],
        ["black"],
        [],
    ]


def test_strokes_skipped_on_resume_need_no_paint():
    plan = plan_of((40, "#00ff00", ""), (40, "#000000", ""))
    cell = cell_with(Reload("stroke"), BLACK)
    assert names(list_station_visits(whole(plan), cell, first_stroke=2)) == [[], ["black"]]


def test_a_colour_without_a_station_is_refused():
    cell = cell_with(Reload("stroke"), BLACK)
    with refused("colour-not-served #ff0000 #000000", "s2"):
        list_station_visits(whole(plan_of((9, "#000000", ""), (9, "#ff0000", ""))), cell)


def test_a_visit_dips_the_brush_and_lets_it_drip():
    section = make_visit(BLACK, BRUSH, find_cell())
    assert section.title == "paint: black"
    reported = [
        ("wait", step.seconds) if isinstance(step, Wait) else (step.meaning, *step.points_mm[-1])
        for step in section.steps
    ]
    assert reported == [
        ("travel", -20, 10, 10),
        ("approach", -20, 10, 5),
        ("dip", -20, 10, -9),
        ("wait", 0.5),
        ("dip", -20, 10, 5),
        ("wait", 2.0),
        ("retract", -20, 10, 10),
    ]
    assert all(step.speed_mm_s <= 25 for step in section.moves if step.meaning not in ("travel", "retract"))
    wiped = make_visit(ANY, BRUSH, find_cell()).moves
    assert wiped[-2].points_mm.tolist() == [[-14, 40, 3], [-10, 40, 3]]
    assert wiped[-1].points_mm.tolist() == [[-10, 40, 10]]


def test_paint_is_stirred_once_then_dipped_and_the_brush_washed_or_rinsed(tmp_path, capsys):
    """Paint is stirred first, then only dipped into; the brush is washed or rinsed.

    The tests' own interpreter runs the program. The visits are: full, short, hard wash and full, rinse and
    short.
    """
    stirred = (
        replace(BLACK, stir_mm=4.0, stir_turns=3),
        replace(ANY, stir_mm=3.0),
        replace(WATER, stir_mm=5.0),
    )
    cell = replace(cell_with(Reload("stroke", wash="water"), *stirred), name="stirred")
    (tmp_path / "plan.json").write_text(
        _core.write_plan(
            _core.Plan(
                "round-6",
                "",
                (100.0, 60.0),
                [
                    _core.Pass(f"s{k}", np.array(STRIPE) + np.array([0, 10 * k, 0]), 20.0, "", colour)
                    for k, colour in enumerate(("#000000", "#000000", "#ff0000", "#ff0000"), 1)
                ],
            )
        )
    )
    program = str(tmp_path / "plan.ngc")
    full = {(-20.0, 10.0): 3, (-20.0, 40.0): 2, (-20.0, 70.0): 2}
    for rinse in (False, True):
        cell = replace(cell, reload=replace(cell.reload, rinse=rinse))
        (tmp_path / "cell.toml").write_text(write_cell(cell))
        words = str(tmp_path / "plan.json"), "--cell", str(tmp_path / "cell.toml")
        assert call(capsys, "convert", words[0], "-o", program, *words[1:], "--force")[0] == 0
        for given in (words, words[1:]):
            status, out, reported = call(capsys, "check", program, *given)
            assert status == 0 and RUNNABLE in out, reported
        text = (tmp_path / "plan.ngc").read_text()
        ran = run_gcode(text, "linuxcnc", (0.0, 0.0, 20.0), None, 50.0)
        assert not ran.refused and not ran.acts
        found = []
        starts = [at for words_, at in ran.titles if words_.startswith("paint: ")]
        for first in starts:
            last = min([at for _, at in ran.titles if at > first], default=len(ran.legs))
            legs = [leg for leg in ran.legs[first:last] if leg.end[2] < -4.0]
            place = tuple(np.round(legs[0].end[:2], 6).tolist())
            way = np.array([leg.end[:2] for leg in legs]) - place
            radius = np.hypot(*way.T)
            turned = np.unwrap(np.arctan2(*way[radius > 1].T[::-1]))
            found.append((place, round(np.ptp(turned) / 2 / np.pi) if len(turned) else 0))
            assert max(leg.speed_mm_s for leg in legs if leg.kind != "wait") <= cell.speeds.press_mm_s
        black, red, water = full
        rinsed = [(water, 0)] if rinse else []
        assert found == [
            (black, full[black]),
            *rinsed,
            (black, 0),
            (water, full[water]),
            (red, full[red]),
            *rinsed,
            (red, 0),
        ]
    with refused("cell-reload", "reload.rinse"):
        parse_cell(write_cell(replace(cell, reload=Reload("stroke", rinse=True))))
    for place_mm, stir_mm in (((-3.0, 10.0), 4.0), ((-5.0, -5.0), 12.0)):  # the second circle holds only the corner
        near = replace(stirred[0], place_mm=place_mm, stir_mm=stir_mm)
        broken = forbidden(plan_of((9, "#000000", "")), BRUSH, cell_with(Reload("stroke"), near))
        assert is_reported(broken, "station-on-sheet", "black")


def test_a_stroke_that_sweeps_through_a_vessel_is_refused():
    poses = np.array([(80, 30, 0), (60, 30, -3), (-2, 30, -3), (-2, 30, 0)])
    plan = _core.Plan("round-6", "", (400.0, 100.0), [_core.Pass("wide", poses, 20.0)])
    pot = Station("Pöt", (-6.0, 30.0), depth_mm=5.0, rim_mm=3.0)

    def reported(**changes):
        return forbidden(plan, BRUSH, cell_with(Reload("stroke"), replace(pot, **changes)))

    (notice,) = reported()
    assert agrees(notice, "vessel-entered Pöt 10 3", "wide")
    assert is_reported(reported(radius_mm=0.0, stir_mm=5.0), "vessel-entered", "wide")
    assert not reported(radius_mm=3.0)
    assert not reported(place_mm=(-13.0, 30.0))
    assert not reported(place_mm=(-13.0, 30.0), stir_mm=4.0)
    assert not reported(by_hand=True, depth_mm=0.0)
    assert not reported(rim_mm=-3.5, surface_mm=-3.5)


def test_check_refuses_a_program_that_sweeps_through_a_vessel(tmp_path, capsys):
    """The program was written for a smaller vessel."""
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
        '<path id="line" d="M80 30 H4" stroke="#000" stroke-width="6"/></svg>'
    )
    pot = Station("pot", (-6.0, 30.0), depth_mm=5.0, rim_mm=3.0, radius_mm=0.0)
    (tmp_path / "c.toml").write_text(write_cell(replace(cell_with(Reload("stroke"), pot), name="c")))
    words = str(tmp_path / "a.ngc"), "--cell", str(tmp_path / "c.toml")
    assert call(capsys, "convert", str(tmp_path / "a.svg"), "-o", *words)[0] == 0
    assert in_json(capsys, "check", *words)[0] == 0
    wide = cell_with(Reload("stroke"), replace(pot, radius_mm=10.0))
    (tmp_path / "c.toml").write_text(write_cell(replace(wide, name="c")))
    for drawing in ((), (str(tmp_path / "a.svg"),)):
        status, _, reported = in_json(capsys, "check", words[0], *drawing, *words[1:])
        assert status == 1 and is_reported(reported, "vessel-entered pot", "line"), reported


def test_a_visit_inside_another_vessel_is_refused():
    def parsed(**changes):
        return parse_cell(write_cell(cell_with(Reload("stroke"), BLACK, replace(WATER, **changes))))

    near = {"place_mm": (-8.0, 10.0), "radius_mm": 20.0, "rim_mm": 5.0}
    with refused("cell-station place_mm 12 water radius_mm 20 5", "station 1"):
        parsed(**near)
    with refused("cell-station place_mm 9 black radius_mm 10 4", "station 2"):
        parsed(place_mm=(-11.0, 10.0), radius_mm=5.0)
    wipe = {"radius_mm": 5.0, "rim_mm": 1.0, "wipe_mm": ((-30.0, 60.0, 2.0), (-20.0, 16.0, 3.0))}
    with refused("cell-station wipe_mm 6 black radius_mm 10 4", "station 2"):
        parsed(**wipe)
    low = {"radius_mm": 5.0, "rim_mm": 1.0}
    for wiped in (((-20.0, 30.0, 3.0), (-16.0, -10.0, 3.0)), ((-20.0, -10.0, 1.0),)):  # across the vessel
        with refused("cell-station wipe_mm black radius_mm 10 4", "station 2"):
            parsed(**low, wipe_mm=wiped)
    with refused("cell-station stir_mm 9 black radius_mm 10 4", "station 2"):
        parsed(**low, place_mm=(-20.0, 24.0), stir_mm=5.0)
    for changes in (
        {**low, "place_mm": (-20.0, 24.0), "stir_mm": 4.0},
        {**low, "wipe_mm": ((-30.5, 30.0, 3.0), (-30.5, -10.0, 3.0))},
        {**low, "wipe_mm": ((-20.0, 30.0, 5.0), (-20.0, -10.0, 4.0))},
        {**near, "radius_mm": 11.0},
        {**near, "place_mm": BLACK.place_mm, "surface_mm": BLACK.surface_mm},  # one vessel
        {
            **near,
            "rim_mm": -10.0,
            "surface_mm": -10.0,
            "depth_mm": 5.0,
        },  # the paint of station 1 is above this rim, as on a tray
        {**wipe, "wipe_mm": ((-30.0, 60.0, 4.0), (-20.0, 16.0, 4.0))},
    ):
        assert parsed(**changes).stations[1].radius_mm == changes["radius_mm"]


def test_circles_wider_than_the_vessel_are_remarked_on():
    def reported(**changes):
        return report_unusual_values(cell_with(Reload("stroke"), replace(WATER, **changes)))

    assert is_reported(reported(stir_mm=13.0, radius_mm=12.0), "unusual-value stir_mm 13 radius_mm 12", "station 1")
    assert not reported(stir_mm=12.0, radius_mm=12.0)


def test_lower_paper_does_not_lower_the_vessels_on_the_table(tmp_path, capsys):
    """With lower paper, the tool still clears the vessels, which stay on the table.

    The safe height moves down with the paper, and the tool once passed over a rim without the clearance.
    """
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
        '<path id="line" d="M80 30 H40" stroke="#000" stroke-width="4"/></svg>'
    )
    pot = Station("pot", (-20.0, 20.0), depth_mm=5.0, rim_mm=4.0)
    for name, station in (
        ("low", pot),
        ("high", replace(pot, rim_mm=4.5)),
        ("hand", replace(pot, rim_mm=4.5, depth_mm=0.0, by_hand=True)),
    ):
        # the safe height is 10 mm, the clearance 1 mm
        cell = replace(cell_with(Reload("stroke"), station), name="painter")
        (tmp_path / f"{name}.toml").write_text(write_cell(cell))

    def run(command, name, z_offset):
        program = ("a.svg", "-o", "a.ngc") if command == "convert" else ("a.ngc",)
        words = (tmp_path / word if "." in word else word for word in program)
        return in_json(capsys, command, *words, "--cell", tmp_path / f"{name}.toml", "--z-offset", z_offset)

    for name, z_offset in (("high", 20), ("high", 0), ("hand", -5), ("low", -5)):
        for command in ("convert", "check"):
            status, _, reported = run(command, name, z_offset)
            assert status == 0, (name, z_offset, reported)
    for command in ("convert", "check"):
        status, _, reported = run(command, "high", -5)
        assert status == 1 and is_reported(reported, "cell-station 4.5 4 --z-offset -5", "pot"), reported


def test_a_person_dips_the_brush_at_safe_height():
    section = make_visit(Station("hand", (5.0, 6.0), by_hand=True), BRUSH, find_cell())
    assert section.moves[0].points_mm.tolist() == [[5, 6, 10]]
    assert section.steps[-1].seconds is None and section.steps[-1].message.endswith(": hand")


def test_a_station_outside_the_workspace_is_refused():
    cell = cell_with(Reload("stroke"))
    boxed = replace(cell, workspace=replace(cell.workspace, box_mm=((-15.0, -50.0, -30.0), (500.0, 200.0, 60.0))))
    broken = forbidden(SimpleNamespace(passes=[], sheet_mm=(1, 1)), BRUSH, boxed)
    assert is_reported(broken, "out-of-box 'x -20.0 mm' '[-15, 500] mm' linuxcnc-3axis", "black")


@pytest.mark.parametrize(("stir_mm", "can_be_used"), [(1.0, True), (4.0, False)])
def test_cell_check_and_convert_refuse_the_same_stations(capsys, tmp_path, stir_mm, can_be_used):
    cell = cell_with(Reload("stroke"), replace(BLACK, stir_mm=stir_mm))
    boxed = replace(
        cell,
        name="boxed",
        workspace=replace(cell.workspace, box_mm=((-22.0, -50.0, -30.0), (500.0, 200.0, 60.0))),
    )
    path = tmp_path / "boxed.toml"
    path.write_text(write_cell(boxed))
    status, _, notices = in_json(capsys, "cell", "check", path)
    assert is_reported(notices, "out-of-box 'x -24.0 mm' '[-22, 500] mm' boxed", "black") is not can_be_used
    assert (status == 0) is can_be_used


def test_a_stroke_may_request_or_refuse_paint():
    plan = plan_of((9, "#000000", ""), (9, "#000000", "", REQUESTED), (999, "#000000", "", REFUSED))
    assert names(list_station_visits(whole(plan), cell_with(Reload("length", 100.0)))) == [
        ["black"],
        ["black"],
        [],
    ]
    loads = split_into_loads(plan, find_brush("round-6"), cell_with(Reload("length", 100.0))).loads
    assert [(a_pass.stroke, a_pass.load) for a_pass in loads] == [(each.stroke, 0) for each in plan.passes]


def test_a_stroke_named_like_a_load_is_not_mistaken_for_one():
    """A stroke named like a load of another stroke is not mistaken for one.

    Loads are named s+2, and a drawing may use names of this form for its own strokes.
    """
    brush, every = find_brush("round-6"), 100.0
    line = np.array([(20, 0, 0), (25, 0, -3), (60, 0, -3), (58, 0, 0)], float)
    names = ["a", "a+2", "a+3", "b~2", "b+x", "+2", "2+"]
    passes = [
        _core.Pass(name, line + np.array([0, 10 + 10 * k, 0]), 20.0, "", "#000000") for k, name in enumerate(names)
    ]
    plan = _core.Plan(brush.name, "", (400.0, 100.0), passes)
    cell = cell_with(Reload("length", every, 5.0))
    loads = split_into_loads(plan, brush, cell)
    assert [a_pass.stroke for a_pass in loads.loads] == names
    assert [bool(stations) for stations in list_station_visits(loads, cell)] == [
        True,
        False,
        True,
        False,
        True,
        False,
        True,
    ]
    assert list_station_visits(whole(plan), cell) == list_station_visits(loads, cell)


def test_a_stroke_without_a_possible_stop_causes_a_warning():
    brush = find_brush("round-6")
    cell = cell_with(Reload("length", 40.0, 5.0))
    step = np.array([(0, 0), (4, 0)] * 20, float)  # to and fro on the spot: the bristles are never pulled
    hairline = np.column_stack([np.linspace(0, 150, 40), np.zeros(40), np.full(40, -0.04)])
    for poses in (np.column_stack([step, np.full(40, -5.0)]), hairline):
        passes = [_core.Pass("rub", poses + np.array([30, 30, 0]), 20.0, "", "#000000")]
        plan = split_into_loads(_core.Plan(brush.name, "", (400.0, 100.0), passes), brush, cell)
        assert [(a_pass.stroke, a_pass.load) for a_pass in plan.loads] == [("rub", 0)]
        (reported,) = report_long_strokes(plan, brush, cell)
        assert agrees(reported, f"load-too-long {painted_mm(plan.loads[0]):.0f}", "rub")
        passes[0].settings = REFUSED
        assert report_long_strokes(whole(_core.Plan(brush.name, "", (400.0, 100.0), passes)), brush, cell) == []
    for every in (40.0, 90.0):  # a line can be cut between its two poses
        long = [_core.Pass("line", np.array([(20, 50, 0), (30, 50, -4), (380, 50, -4), (370, 50, 0)], float), 20.0)]
        cell = cell_with(Reload("length", every, 5.0))
        loads = split_into_loads(_core.Plan(brush.name, "", (400.0, 100.0), long), brush, cell)
        assert len(loads.loads) >= 350 / every and report_long_strokes(loads, brush, cell) == []


def long_plan(brush):
    t = np.linspace(0, 1, 200)
    depth = np.minimum(1.0, 20 * np.minimum(t, 1 - t)) * (3 + np.sin(9 * t))
    wave = np.column_stack([30 + 300 * t, 50 + 12 * np.sin(14 * t), -depth])
    short = np.array([(30, 80, 0), (40, 80, -2), (60, 80, -2), (58, 80, 0)], float)
    passes = [_core.Pass("short", short, 20.0, "", "#000000"), _core.Pass("long", wave, 20.0, "", "#000000")]
    return _core.Plan(
        brush.name,
        "",
        (400.0, 100.0),
        [*passes, _core.Pass("last", short + np.array([0, -60, 0]), 20.0, "", "#000000")],
    )


def test_a_long_stroke_is_split_into_loads_with_the_same_mark():
    brush = find_brush("round-6")
    cell = cell_with(Reload("length", 120.0, 6.0))
    plan = long_plan(brush)
    loads = split_into_loads(plan, brush, cell)
    assert [a_pass.stroke for a_pass in loads.loads] == [
        "short",
        "long",
        "long+2",
        "long+3",
        "last",
    ]
    names_of_loads = [("short", 1), ("long", 1), ("long", 2), ("long", 3), ("last", 1)]
    assert [(a_pass.origin.element, a_pass.origin.load) for a_pass in loads.loads] == names_of_loads
    assert [a_pass.load for a_pass in loads.loads] == [0, 1, 2, 3, 0]
    assert {a_pass.settings for a_pass in loads.loads} == {_core.Settings()}
    assert names(list_station_visits(loads, cell)) == [["black"], ["black"], ["black"], ["black"], ["black"]]
    assert max(map(painted_mm, loads.loads)) < 120 + 8
    rings = []
    for each in (plan, loads.as_plan()):
        marks = _core.simulate(each, brush)
        _core.trace_outlines(marks, brush)
        rings.append(marks.outline_mm)
    assert len(rings[0]) == len(rings[1]), "no gap, no island"
    assert _core.overlap(*rings) > 0.99
    assert split_into_loads(plan, brush, cell_with(Reload("length", 1000.0))) == whole(plan)


def test_a_load_lasts_until_its_marks_are_narrower_than_allowed():
    """A load lasts until its marks are narrower than the cell allows.

    By hand: at 0.4 per metre, marks are 5 % narrower after 128.2 mm.
    """
    brush, plan = find_brush("round-6"), plan_of(*[(40, "#000000", "")] * 6)
    reload = Reload("length", 200.0, narrower_percent=5.0)

    def fetched(brush, reload):
        cell = cell_with(reload)
        return [bool(each) for each in list_station_visits(split_into_loads(plan, brush, cell), cell)]

    assert fetched(brush, reload) == [True, False, False, False, True, False], "nobody knows how it narrows"
    brush.paint = _core.Paint(0.4)
    assert load_length_mm(brush, cell_with(reload)) == pytest.approx(-1000 * np.log(0.95) / 0.4)
    assert fetched(brush, reload) == [True, False, False, True, False, False]
    assert fetched(brush, replace(reload, every_mm=90.0)) == [True, False, True, False, True, False]
    assert fetched(brush, replace(reload, narrower_percent=0.0)) == [True, False, False, False, True, False]
    brush.paint = _core.Paint(0.4, lasts_mm=50.0)
    assert fetched(brush, reload) == [True] * 6, "hairs would run dry"
    assert fetched(brush, Reload("layer", narrower_percent=5.0)) == [True] + [False] * 5, "no way is counted"


def test_a_long_stroke_is_split_by_the_paint_length_of_the_brush():
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 1000.0, 6.0, narrower_percent=6.0))
    plan = long_plan(brush)
    assert split_into_loads(plan, brush, cell).strokes() == ["short", "long", "last"]
    brush.paint = _core.Paint(0.5)
    loads = split_into_loads(plan, brush, cell)
    lasts = -1000 * np.log(0.94) / 0.5
    assert loads.strokes().count("long") == 3
    assert max(map(painted_mm, loads.loads)) < lasts + 8
    shortest = min(brush.paint.width_share(painted_mm(each) - 8) for each in loads.loads)
    assert shortest >= 0.94


def test_the_predicted_width_of_a_stroke_is_the_width_of_its_loads():
    """The predicted width of a whole stroke is the width that its loads give.

    One stroke needs three loads, and one goes on with the paint of the stroke before it. The test compares
    the outlines of the whole strokes with the outlines of the loads, each with its own dips. Without dips in
    between, the outlines differ.
    """
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 150.0, 6.0))
    brush.paint = _core.Paint(3.0)
    plan = long_plan(brush)
    loads = split_into_loads(plan, brush, cell)
    fetched = [bool(each) for each in list_station_visits(loads, cell)]
    assert loads.strokes() == ["short", "long", "long", "long", "last"] and fetched[-1] is False
    parts = _core.simulate(loads.as_plan(), brush)
    _core.narrow(parts, brush.paint, [[0.0] if each else [] for each in fetched])
    _core.trace_outlines(parts, brush)
    whole = predict_plan_marks(plan, brush, cell=cell)
    assert _core.overlap(whole.outline_mm, parts.outline_mm) > 0.98
    assert np.allclose(
        predict_plan_marks(loads.as_plan(), brush, cell=cell).passes[2].width_share,
        parts.passes[2].width_share,
    )
    alone = predict_plan_marks(plan, brush)
    assert [each.width_share[0] for each in alone.passes] == [1.0, 1.0, 1.0], "each freshly dipped"
    assert _core.overlap(alone.outline_mm, parts.outline_mm) < 0.9
    brush.paint = None
    assert all(each.width_share.size == 0 for each in predict_plan_marks(plan, brush, cell=cell).passes)


def test_loads_start_where_their_stroke_was_cut():
    """Loads begin where their stroke was cut.

    The test compares the dips along whole strokes with the paths of the loads. From one load to the next, the
    stroke advances by the painted length of the load, minus its landing, its lift and the overlap.
    """
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 150.0, 6.0))
    plan = long_plan(brush)
    loads = split_into_loads(plan, brush, cell)
    _, dips, _ = dips_mm(plan.passes, loads, cell)
    line = np.asarray(plan.passes[1].poses_mm)[:, :2]
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    last = np.asarray(loads.loads[3].poses_mm)[:, :2]
    assert dips[2] == pytest.approx(along[-1] - np.hypot(*np.diff(last, axis=0).T).sum(), abs=0.05)
    assert dips[0] == 0.0 and 120 < dips[1] < 150


def test_paint_that_lasts_too_short_is_refused():
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 1000.0, 6.0, narrower_percent=1.0))
    brush.paint = _core.Paint(1.0)
    with refused("load-too-short round-6 10.1 6"):
        split_into_loads(plan_of((40, "#000000", "")), brush, cell)


def test_a_brush_without_paint_data_is_reported():
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 200.0, narrower_percent=5.0))
    assert are_reported(report_missing_paint(brush, cell), "paint-unknown round-6 narrower_percent")
    assert not report_missing_paint(brush, cell_with(Reload("length", 200.0)))
    brush.paint = _core.Paint(0.4)
    assert not report_missing_paint(brush, cell)


def test_a_brush_that_runs_dry_before_paint_is_fetched_is_reported():
    """Plans and pictures assume paint to the end of a load."""
    brush, loads = find_brush("round-6"), whole(plan_of((30, "#000000", ""), (60, "#000000", ""), (30, "#ff0000", "")))
    brush.paint = _core.Paint(0.4, lasts_mm=50)
    assert are_reported(report_dry_brush(loads, brush, find_cell()), "paint-runs-out '90 mm' '[0, 50] mm' round-6")
    by_stroke, by_length = cell_with(Reload("stroke")), cell_with(Reload("length", 500.0))
    assert are_reported(report_dry_brush(loads, brush, by_stroke), "paint-runs-out '60 mm' '[0, 50] mm' round-6")
    assert not report_dry_brush(loads, brush, by_stroke, first_stroke=3)
    assert not report_dry_brush(loads, brush, by_length), "a load ends before the brush runs dry"
    for paint in (None, _core.Paint(0.4), _core.Paint(0.4, lasts_mm=91)):
        brush.paint = paint
        assert not report_dry_brush(loads, brush, find_cell())


@pytest.mark.parametrize(("suffix", "is_reported_dry"), [(".ngc", True), (".json", False)])
def test_convert_warns_that_the_brush_of_a_program_runs_dry(suffix, is_reported_dry, tmp_path, capsys):
    """A plan has no cell that could fetch paint."""
    brush = find_brush("round-6")
    brush.paint = _core.Paint(0.4, lasts_mm=50)
    (tmp_path / "own.json").write_text(_core.write_brush(brush))
    (tmp_path / "d.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
        '<path d="M20 30 h80" stroke="#000" stroke-width="3"/></svg>'
    )
    out = str(tmp_path / f"d{suffix}")
    assert main(["convert", str(tmp_path / "d.svg"), "-o", out, "--brush", str(tmp_path / "own.json")]) == 0
    assert ("runs dry" in capsys.readouterr().err) == is_reported_dry


def test_loads_are_not_split_or_reported_as_strokes():
    """Loads are not cut again, nor reported as if each load were a stroke."""
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 120.0, 6.0))
    loads = split_into_loads(long_plan(brush), brush, cell)
    for taken in (
        lambda: split_into_loads(loads, brush, cell),
        lambda: measure_figures(PaintedPlan(loads, None, brush)),
    ):
        with pytest.raises(AttributeError, match="passes"):
            taken()
    with pytest.raises(AttributeError, match="loads"):
        list_station_visits(long_plan(brush), cell)


def test_loads_written_as_a_plan_are_not_split_again():
    """Loads that were written as a plan are not cut again.

    Each part is longer than a load, because the brush comes back a little before it goes on. If the parts
    were read as strokes, they would be cut once more.
    """
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 120.0, 6.0))
    loads = split_into_loads(long_plan(brush), brush, cell)
    text = _core.write_plan(loads.as_plan())
    assert [a_pass.get("load") for a_pass in json.loads(text)["passes"]] == [None, 1, 2, 3, None]
    back = _core.read_plan(text)
    again = split_into_loads(back, brush, cell)
    assert [a_pass.stroke for a_pass in again.loads] == [a_pass.stroke for a_pass in loads.loads]
    assert again.strokes() == loads.strokes() == ["short", "long", "long", "long", "last"]
    assert list_station_visits(again, cell) == list_station_visits(loads, cell)
    for before, after in zip(loads.loads, again.loads, strict=True):
        assert np.abs(before.poses_mm - after.poses_mm).max() <= 1e-7
    shorter = split_into_loads(back, brush, cell_with(Reload("length", 30.0))).strokes()
    assert shorter.count("long") == 3 and shorter.count("short") > 1
    for passes in ([2, 1, 3], [2], [1, 0, 2], [1, 3]):
        lost = _core.Plan(back.brush, "", back.sheet_mm, [back.passes[k] for k in passes])
        with refused("load-out-of-order"):
            split_into_loads(lost, brush, cell)
    for written, code in (('"2"', "wrong-type"), ("-2", "out-of-range")):
        with refused(code, "passes[2].load"):
            _core.read_plan(text.replace('"load": 2', f'"load": {written}'))


def test_a_problem_of_every_load_is_reported_once_for_its_stroke():
    brush, cell = find_brush("round-6"), cell_with(Reload("length", 120.0, 6.0))
    plan = long_plan(brush)
    for a_pass in plan.passes:
        a_pass.speed_mm_s = 99.0
    reported = make_checked_program(split_into_loads(plan, brush, cell), brush, cell).problems
    assert [where for where, _ in reported] == ["short", "long", "last"]


def test_all_reports_of_a_job_count_its_loads(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    brush = find_brush("round-6")
    (tmp_path / "long.json").write_text(_core.write_plan(long_plan(brush)))
    cell = replace(cell_with(Reload("length", 120.0, 6.0), ANY), name="paint")
    (tmp_path / "paint.toml").write_text(write_cell(cell))
    reported = {}
    for words in (
        "convert long.json -o x.ngc",
        "preview long.json -o x.html",
        "convert long.json -o last.ngc --from-stroke 4",
    ):
        status, _, (line,) = call(capsys, *words.split(), "--cell", "paint.toml")
        assert status == 0
        reported[words.split()[3]] = line.partition(": written; ")[2]
    assert reported["x.ngc"] == reported["x.html"] and gives(reported["x.ngc"], "5")
    assert gives(reported["last.ngc"], "2")
    header = (tmp_path / "x.ngc").read_text()
    time = re.search(r"\(time: about (.*)\)", header)[1]
    assert "round-6, 5 strokes" in header and gives(reported["x.ngc"], time)


def test_the_path_to_the_paint_is_checked_before_anything_is_written():
    """The path to the paint is checked before anything is written.

    Both ends of the path can be allowed although the path between them is not.
    """
    brush = find_brush("round-6")
    cell = cell_with(Reload("stroke"), ANY)
    wall = ((-12.0, -50.0, -50.0), (-8.0, 150.0, 50.0))
    cell = replace(cell, workspace=replace(cell.workspace, keep_out_mm=(wall,)))
    cell = replace(cell, stations=(replace(ANY, wipe_mm=()),))
    plan = long_plan(brush)
    reported = check_job(split_into_loads(plan, brush, cell), brush, _core.simulate(plan, brush), cell, 0.05).problems
    assert {each.code for each in reported} == {"in-kept-out-box"}


def test_the_program_fetches_paint_in_the_middle_of_a_stroke():
    brush = find_brush("round-6")
    text = "".join(writer.encode(".ngc", long_plan(brush), brush, "t", (), cell_with(Reload("length", 120.0, 6.0))))
    titles = [line.strip("()") for line in text.splitlines() if line.startswith(("(stroke", "(paint"))]
    assert titles[:5] == [
        "paint: black",
        "stroke 1 of 5: short",
        "paint: black",
        "stroke 2 of 5: long",
        "paint: black",
    ]
    assert titles[5] == "stroke 3 of 5: long+2"


def test_a_station_on_the_sheet_or_too_far_away_is_refused():
    for place, expected in (
        ((40.0, 30.0), "station-on-sheet '400 x 100 mm'"),
        ((-90.0, 10.0), "tool-off-sheet 60.00 left"),
    ):
        cell = cell_with(Reload("stroke"), Station("ink", place, depth_mm=5.0))
        reported = [each for each in forbidden(plan_of((9, "", "")), BRUSH, cell) if each.where == "ink"]
        assert are_reported(reported, expected)


def test_check_simulates_freshly_dipped_strokes_in_cells_without_reload():
    """A fault that narrows the marks over all strokes of a program is caught."""
    brush, cell = find_brush("round-6"), find_cell("linuxcnc-3axis")
    brush.paint = _core.Paint(2.0, lasts_mm=5000.0)
    strokes = [
        _core.Pass(name, [(20, y, 0), (30, y, -3), (90, y, -3), (100, y, 0)], 20.0)
        for name, y in (("a", 20.0), ("b", 50.0))
    ]
    text = "".join(writer.encode(".ngc", _core.Plan("b", "", (120.0, 80.0), strokes), brush, "t", (), cell))
    found = simulate_program(read_program(text, ".ngc", cell), brush, cell, (120.0, 80.0))
    heights_mm = [
        top - bottom for _, bottom, _, top in (_core.painted_bounds(one, brush) for one in found.marks.passes)
    ]
    assert heights_mm[0] == pytest.approx(heights_mm[1], abs=1e-9)
