"""The timeline of a program: where the tool is, and what the brush does there."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import refused
from programs import whole

from brushsvg._core import Marks, Pass, simulate
from brushsvg.jobs import prediction
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation import preparation
from brushsvg.machine.cells.cell import Reload, Station
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.moves import Wait, distances, duration_s
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.writer import whole_program
from brushsvg.model import library
from brushsvg.show.timeline import HAND_PAUSE_S, timeline

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">
<path id="line" d="M20 40 C40 10 60 10 90 30 L60 50" fill="none" stroke="#203060" stroke-width="3"/>
<path id="dab" d="M97 20h0" stroke="#802010" stroke-width="3"/></svg>"""
POT = Station("pot", (-20.0, 30.0), surface_mm=-2.0, depth_mm=7.0, rim_mm=4.0, hold_s=0.5, drip_s=2.0)
HAND = Station("Mary", (-20.0, 30.0), by_hand=True)
FARTHER_MM = 1e-9  # allows for rounding, on top of the distance at the given speed


def cell_with(*stations, name="linuxcnc-3axis"):
    return replace(find_cell(name), stations=stations, reload=Reload("stroke") if stations else None)


@pytest.fixture(scope="module")
def works(tmp_path_factory):
    """Return a function from compensation and brush to the drawing's work and marks."""
    file = tmp_path_factory.mktemp("timeline") / "a.svg"
    file.write_text(DRAWING)

    def make(how="closed", brush="round-6"):
        work = preparation.prepare(file, Options(brush=library.find_brush(brush), compensation=how))
        return work, prediction.predict(work, outlines=False)

    return make


@pytest.fixture(params=["closed", "none", "constant", "rigid", "ur5e"])
def played(request, works):
    """Return the work, its marks, a program with paint, and its timeline."""
    how = request.param
    work, marks = works("closed", "rigid") if how == "rigid" else works("closed" if how == "ur5e" else how)
    cell = cell_with(POT, name="ur5e" if how == "ur5e" else "linuxcnc-3axis")
    program = whole_program(whole(work.plan), work.brush, cell)
    return work, marks, program, timeline(program, marks)


def test_time_runs_from_0_to_the_end_of_the_program(played):
    _, _, program, rows = played
    assert rows.time_s[0] == 0
    assert (np.diff(rows.time_s) >= 0).all()
    assert rows.time_s[-1] == pytest.approx(duration_s(program), abs=1e-9)
    assert [chapter.first_row for chapter in rows.chapters] == sorted({c.first_row for c in rows.chapters})


def test_every_program_point_is_reached_at_its_time(played):
    _, _, program, rows = played
    now_s, here = 0.0, None
    for step in (step for section in program.sections() for step in section.steps):
        if isinstance(step, Wait):
            now_s += step.seconds
            continue
        along_mm, v = distances(step, here)[-1], step.speed_mm_s
        a = program.cell.speeds.acceleration_mm_s2
        # From rest to rest, a move takes as long as the whole path at full speed plus one ramp. A short move
        # has two ramps only.
        now_s += along_mm / v + v / a if along_mm >= v * v / a else 2 * np.sqrt(along_mm / a)
        here = step.points_mm[-1]
        at = np.abs(rows.time_s - now_s) < 1e-9
        assert at.any(), (step.meaning, now_s)
        assert np.linalg.norm(rows.tcp_mm[at] - here, axis=1).max() < 1e-9


def test_the_tool_is_never_faster_than_its_move(played):
    _, _, program, rows = played
    moves = [move for section in program.sections() for move in section.moves]
    time_s, path_mm = np.diff(rows.time_s), np.linalg.norm(np.diff(rows.tcp_mm, axis=0), axis=1)
    assert (path_mm - max(move.speed_mm_s for move in moves) * time_s).max() < FARTHER_MM
    touching = ~np.isnan(rows.depth_mm)
    painting = touching[:-1] & touching[1:]
    fastest = max(move.speed_mm_s for move in moves if move.meaning == "paint")
    assert (path_mm - fastest * time_s)[painting].max() < FARTHER_MM
    assert (path_mm - 0.5 * fastest * time_s)[painting].max() > FARTHER_MM


def test_the_brush_follows_the_marks_and_is_absent_in_the_air(played):
    work, marks, _, rows = played
    chapters = [chapter for chapter in rows.chapters if chapter.trace is not None]
    assert [chapter.trace for chapter in chapters] == [0, 1]
    ends = [c.first_row for c in rows.chapters[1:]] + [len(rows.time_s)]
    ends = dict(zip([c.first_row for c in rows.chapters], ends, strict=True))
    for chapter, trace, a_pass in zip(chapters, marks.passes, work.plan.passes, strict=True):
        part = slice(chapter.first_row, ends[chapter.first_row])
        touching = ~np.isnan(rows.depth_mm[part])
        on_paper = np.asarray(trace.depth_mm) >= 0
        assert rows.contact_mm[part][touching] == pytest.approx(trace.contact_mm[on_paper])
        assert rows.heading_rad[part][touching] == pytest.approx(trace.heading_rad[on_paper])
        assert rows.tcp_mm[part][touching][:, :2] == pytest.approx(trace.tcp_mm[on_paper], abs=1e-6)
        assert -rows.tcp_mm[part][touching][:, 2] == pytest.approx(rows.depth_mm[part][touching], abs=1e-6)
        assert rows.tcp_mm[part][~touching][:, 2].min() >= 0
        assert np.linalg.norm(rows.tcp_mm[part][touching][-1] - a_pass.poses_mm[-1]) < 1e-9
    visits = [chapter for chapter in rows.chapters if chapter.trace is None]
    assert [visit.title for visit in visits] == ["paint: pot"] * 2
    for visit in visits:
        part = slice(visit.first_row, ends[visit.first_row])
        assert np.isnan(rows.depth_mm[part]).all()
        assert rows.tcp_mm[part][:, 2].min() == -9.0  # in the paint


def test_a_wait_for_a_person_is_a_short_pause_with_its_message(works):
    work, marks = works()
    program = whole_program(whole(work.plan), work.brush, cell_with(HAND))
    rows = timeline(program, marks)
    assert [pause.message.endswith(": Mary") for pause in rows.pauses] == [True] * 2
    assert rows.time_s[-1] == pytest.approx(duration_s(program) + 2 * HAND_PAUSE_S)
    for pause in rows.pauses:
        assert pause.end_s - pause.start_s == pytest.approx(HAND_PAUSE_S)
        inside = (rows.time_s >= pause.start_s) & (rows.time_s <= pause.end_s)
        assert (rows.tcp_mm[inside][:, :2] == HAND.place_mm).all()


@pytest.mark.parametrize("name", ["grbl-servo", "axidraw-ebb"])
def test_the_timeline_waits_for_a_servo(works, name):
    work, _ = works()
    cell = find_cell(name)
    loads = split_into_loads(work.plan, work.brush, cell)
    program = whole_program(loads, work.brush, cell)
    assert timeline(program, simulate(loads.as_plan(), work.brush)).time_s[-1] == pytest.approx(duration_s(program))


def test_a_stroke_may_begin_and_end_pressed(works):
    work, _ = works()
    plan = work.plan
    passes = [Pass("pressed", np.array([(30.0, 30, -2), (60, 30, -2)]), 20.0)]
    passes.append(Pass("spot", np.array([(80.0, 30, -2)]), 20.0))
    plan.passes = passes
    program, marks = whole_program(whole(plan), work.brush, find_cell()), simulate(plan, work.brush)
    rows = timeline(program, marks)
    assert (np.diff(rows.time_s) >= 0).all()
    assert rows.time_s[-1] == pytest.approx(duration_s(program))
    assert np.nanmax(rows.depth_mm) == 2
    assert (~np.isnan(rows.depth_mm)).sum() == sum(len(trace.pose) for trace in marks.passes)


def test_lifted_rows_of_the_marks_are_in_the_air(works):
    work, marks = works()
    (line, _), plan = marks.passes, work.plan
    plan.passes = plan.passes[:1]
    columns = {name: np.array(getattr(line, name)) for name in ("pose", "tcp_mm", "contact_mm", "heading_rad", "pull")}
    depth_mm = np.where(columns["pose"] > 5, -1.0, line.depth_mm)
    lifted = SimpleNamespace(**columns, depth_mm=depth_mm)
    rows = timeline(whole_program(whole(plan), work.brush, find_cell()), SimpleNamespace(passes=[lifted]))
    assert (~np.isnan(rows.depth_mm)).sum() == (columns["pose"] <= 5).sum()
    assert (np.isnan(rows.contact_mm[:, 0]) == np.isnan(rows.depth_mm)).all()


def test_an_empty_plan_is_refused(works):
    work, _ = works()
    plan = work.plan
    plan.passes = []
    with refused("nothing-to-show"):
        timeline(whole_program(whole(plan), work.brush, find_cell()), Marks())
