"""A page of 1,000 strokes in every language passes all positions of the plan.

The judge of each language runs the program.
"""

import json
import tomllib
from dataclasses import replace

import numpy as np
from judge import places
from judge.verdict import job_of
from judge.works import CELLS, PENS
from sampling import sample
from scipy.spatial import cKDTree

from brushsvg import _core
from brushsvg.machine import writer
from brushsvg.machine.cells.cell import Workspace, unit_mm, value_mm
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.model.library import find_brush

STROKES, POSES = 1000, 6
SHEET = (400.0, 400.0)
EXACT_MM = 1e-3


def page(down_mm):
    """Return short waves next to each other, pressed and lifted at their ends.

    The waves of a pen are all at its height.
    """
    t, passes = np.linspace(0, 1, POSES), []
    for number in range(STROKES):
        x, y = 20 + 18 * (number % 20), 20 + 7 * (number // 20)
        depth = -3 * np.minimum(1, 4 * np.minimum(t, 1 - t)) if down_mm is None else np.full(POSES, down_mm)
        wave = np.column_stack([x + 14 * t, y + np.sin(7 * t + number), depth])
        if down_mm is not None:
            wave = np.vstack([wave[:1] * (1, 1, 0), wave, wave[-1:] * (1, 1, 0)])
        passes.append(_core.Pass(f"s{number}", wave, 20.0))
    return passes


@sample("dialect", CELLS, keep=4)
def test_a_page_of_a_thousand_strokes_passes_all_planned_positions(dialect):
    name, suffix = CELLS[dialect]
    cell = find_cell(name)
    room = Workspace(cell.workspace.margin_mm, cell.workspace.tilt_limit_deg)
    cell = replace(cell, workspace=room, arm=None)
    brush = find_brush("rigid" if dialect in PENS else "round-6")
    plan = _core.Plan(brush.name, "", SHEET, page(cell.pen.down_mm if cell.pen else None))
    text = "".join(writer.encode(suffix, plan, brush, "a page", (), cell))
    assert text.isascii()
    job = job_of(tomllib.loads(write_cell(cell)), _core.write_plan(plan), brush.max_speed_mm_s, 0.0, 1)
    run = job.interpret(text)
    assert not run.refused and not run.acts and len(json.loads(_core.write_plan(plan))["passes"]) == STROKES
    ends = places.moved(job.back, np.array([leg.end for leg in run.legs]))
    target = np.vstack([a_pass.poses_mm for a_pass in plan.passes])
    if cell.servo or cell.pen:  # heights change in steps, positions in units
        within_mm = unit_mm(cell) / 2 * 2**0.5 + 1e-6
        off = cKDTree(ends[:, :2]).query(target[:, :2])[0]
        deepest = ends[:, 2].min()
        assert abs(deepest - target[:, 2].min()) <= (value_mm(cell) / 2 + cell.servo.step_mm if cell.servo else 1e-9)
    else:
        within_mm = EXACT_MM
        off = cKDTree(ends).query(target)[0]
    assert off.max() <= within_mm
    assert len([words for words, _ in run.titles if words.startswith("stroke ")]) == STROKES
    touching = [leg for leg, end in zip(run.legs, ends, strict=True) if end[2] < -0.05 and leg.kind != "jump"]
    assert max(leg.speed_mm_s for leg in touching if np.isfinite(leg.speed_mm_s)) <= 20.0 + 0.01
