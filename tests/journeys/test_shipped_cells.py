"""Every shipped cell completes the workflow.

The steps are a brush from a chart, a program, a painted page and a corrected second program. The machine moves
0.4 % too far, so that there is an error to find and to correct.
"""

from __future__ import annotations

import json

import pytest
from sampling import sample
from user import STUDIO

from brushsvg.machine.cells.cell_file import cell_names, find_cell
from brushsvg.machine.posts import POSTS

WORD = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">
<g fill="none" stroke="#000"><path id="arch" d="M15 50C20 15 45 15 50 50" stroke-width="3"/>
<path id="line" d="M60 50L105 45" stroke-width="2.5"/>
<path id="wave" d="M62 30C70 15 80 40 88 25S100 20 105 28" stroke-width="2"/>
<path id="slash" d="M15 60L40 57" stroke-width="2.5"/></g></svg>"""
TOO_FAR = 1.004
FAMILIES = {
    "three axes": [name for name in cell_names() if name.endswith("-3axis")],
    "servo": [name for name in cell_names() if name in ("axidraw-ebb", "grbl-servo")],
    "pen": ["hpgl-plotter", "marlin-servo"],
}
FAMILIES["arm"] = [name for name in cell_names() if not any(name in family for family in FAMILIES.values())]


def goes_the_whole_way(user, name: str) -> None:
    program = f"word{POSTS[find_cell(name).language].extensions[0]}"
    user.saves("word.svg", WORD)
    user.saves("studio.toml", f"{STUDIO}[machine]\nscale = [{TOO_FAR}, {TOO_FAR}]\n")
    brush, width = "brush.json", ""
    if name in FAMILIES["pen"]:  # this machine draws at one depth only
        brush, width = "rigid", "--width 1"
    else:
        user.types(f"calibrate chart.jpg --chart chart.json --machine lean,axes,tilt,backlash --cell {name} -o {brush}")
    job = f"--brush {brush} {width}"
    user.types(f"convert word.svg -o {program} {job} --cell {name} --page page.svg")
    user.types(f"check {program} word.svg {job} --cell {name}")
    user.types(f"simulate-photo word.svg -o photo.jpg {job} --cell {name} --studio studio.toml")
    user.types(f"compare photo.jpg word.svg {job} --cell {name} -o corrections.json --corrected-cell corrected.toml")
    assert find_cell(str(user.folder / "corrected.toml")).machine.scale == pytest.approx((TOO_FAR, TOO_FAR), abs=0.002)
    second = f"{job} --cell corrected.toml --corrections corrections.json"
    user.types(f"convert word.svg -o second-{program} {second}")
    user.types(f"check second-{program} word.svg {second}")
    assert user.reads(f"second-{program}") != user.reads(program)
    before = json.loads(user.reads("corrections.json"))
    user.types(f"simulate-photo word.svg -o second.jpg {second} --studio studio.toml")
    user.types(f"compare second.jpg word.svg {second} -o after.json")
    after = json.loads(user.reads("after.json"))
    assert after["overlap_wanted"] > before["overlap_wanted"]


@sample("name", FAMILIES["three axes"], keep=1)
def test_three_axis_cells_complete_the_workflow(user_with_chart, name):
    goes_the_whole_way(user_with_chart, name)


@sample("name", FAMILIES["servo"], keep=1)
def test_servo_cells_complete_the_workflow(user_with_chart, name):
    goes_the_whole_way(user_with_chart, name)


@sample("name", FAMILIES["arm"], keep=1)
def test_arm_cells_complete_the_workflow(user_with_chart, name):
    goes_the_whole_way(user_with_chart, name)


@sample("name", FAMILIES["pen"], keep=1)
def test_pen_cells_complete_the_workflow(user_with_chart, name):
    goes_the_whole_way(user_with_chart, name)
