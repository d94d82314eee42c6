"""`check` reports three rare kinds of accidental changes.

They are the rotation of the tool within a circle, each step of a servo's lift, and stops within a stroke.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused

import brushsvg
from brushsvg import _core
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.machine.posts import POSTS

CURVES = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60"><g fill="none" '
    'stroke="#000" stroke-width="4"><path id="s" d="M15,45 C 20,35 30,55 40,40 S 50,50 52,45"/>'
    '<path id="a" d="M70,15 A 10 10 0 1 1 90 20"/></g></svg>'
)


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.svg").write_text(CURVES)
    return tmp_path


def written(cell):
    """Return the path of a program in the cell's language, and its text."""
    path = Path(f"a{POSTS[find_cell(cell).language].extensions[0]}")
    brushsvg.convert("a.svg", path, cell=cell)
    assert brushsvg.check(path, "a.svg", cell=cell).problems == ()
    return path, path.read_bytes().decode()


def problems(path, text, cell):
    path.write_bytes(text.encode())
    return brushsvg.check(path, "a.svg", cell=cell).problems


def test_a_changed_circle_middle_that_tilts_the_brush_is_refused(desk):
    path, text = written("lrmate200id")
    number = re.search(r"C P\[(\d+)\]", text)[1]
    point = re.search(rf"P\[{number}\]\{{[^}}]*\}}", text)[0]
    path.write_bytes(text.replace(point, point.replace("W = 180.000", "W = 0.000")).encode())
    with refused("tool-turned 180"):
        brushsvg.check(path, "a.svg", cell="lrmate200id")
    path, text = written("kr6-r900")
    turned = re.sub(r"(CIRC \{[^}]*), A 0.00000", r"\1, A 90.00000", text, count=1)
    assert turned != text
    path.write_bytes(turned.encode())
    with refused("tool-turned 90"):
        brushsvg.check(path, "a.svg", cell="kr6-r900")


RAMPS = {  # patterns for a lift in small steps without its last step, and for one step
    "axidraw-ebb": (r"(?:S2,\d+,4,0,[1-9]\d*\n)+(?=(S2,\d+,4,0,)[1-9]\d*\n)", r"(S2,\d+,4,0,)(\d+)\n"),
    "grbl-servo": (r"(?:M3 S\d+\nG4 P[\d.]+\n)+(?=M3 S\d+\nG4 P[\d.]+\n)", r"(M3 S\d+\nG4 P)([\d.]+)\n"),
}


@pytest.mark.parametrize("number", [0, 1])  # down to the paper, and up
@pytest.mark.parametrize("cell", RAMPS)
def test_a_servo_lift_in_one_step_is_refused(desk, cell, number):
    """Check refuses a lift in one step.

    The changed lift waits as long as all its steps did.
    """
    path, text = written(cell)
    lifts, step = RAMPS[cell]
    ramp = [each for each in re.finditer(lifts, text) if len(re.findall(step, each[0])) > 5][number]
    last = re.compile(step).match(text, ramp.end())
    waits = [float(each[1]) for each in re.findall(step, ramp[0] + last[0])]
    total = f"{sum(waits):.3f}" if cell == "grbl-servo" else f"{sum(waits):.0f}"
    slam = text[: ramp.start()] + f"{last[1]}{total}\n" + text[last.end() :]
    assert is_reported(problems(path, slam, cell), "speed-out-of-range servo")
    # Each step is equally small, but the steps come all at once: only the last one waits.
    rush = re.sub(step, lambda each: f"{each[1]}{'0.001' if cell == 'grbl-servo' else 1}\n", ramp[0])
    rush = text[: ramp.start()] + rush + f"{last[1]}{total}\n" + text[last.end() :]
    assert is_reported(problems(path, rush, cell), "speed-out-of-range servo")


STOPS = [
    ("kr6-r900", r"( C_DIS)(?=\r)", ""),
    ("irb120", r"within\([\d.]+\)", "fine"),
    ("lrmate200id", r"CNT[2-9]\b", "FINE"),
    ("ur5e", r", r=0\.[\d]+\)", ")"),
    ("m0609", r", radius=[\d.]+", ""),
    ("grbl-servo", r"(\nG1 X.*\n)(?=G1 X)", r"\1G4 P0.15\n"),
    ("axidraw-ebb", r"(\nSM,\d+,-?[1-9]\d*,-?[1-9]\d*\n)(?=SM)", r"\1SM,150,0,0\n"),
]


@pytest.mark.parametrize(("cell", "old", "new"), STOPS)
def test_a_stop_within_a_stroke_is_refused(desk, cell, old, new):
    path, text = written(cell)
    found = [*re.finditer(old, text)]
    amid = found[len(found) // 2]
    stopped = text[: amid.start()] + amid.expand(new) + text[amid.end() :]
    assert is_reported(problems(path, stopped, cell), "program-changed")


def later(text, from_row, more_s):
    """Return a table of times with all rows after one row delayed."""
    rows, count = [], 0
    for line in text.splitlines():
        if re.match(r"\d", line):
            count += 1
            seconds, _, rest = line.partition(",")
            line = f"{float(seconds) + more_s:.7f},{rest}" if count > from_row else line
        rows.append(line)
    return "\n".join(rows) + "\n"


def test_a_slow_part_of_a_stroke_is_reported_as_a_stop(desk, capsys):
    path, text = written("axidraw-ebb")
    slices = [*re.finditer(r"SM,(\d+)(?=,-?[1-9]\d?,-?[1-9]\d?\n)", text)]
    amid = slices[len(slices) // 2]
    slow = text[: amid.start()] + f"SM,{int(amid[1]) + 50}" + text[amid.end() :]
    assert is_reported(problems(path, slow, "axidraw-ebb"), "stands-in-paint 0.050")
    hardly = text[: amid.start()] + f"SM,{int(amid[1]) + 15}" + text[amid.end() :]
    assert is_reported(problems(path, hardly, "axidraw-ebb"), "stands-in-paint 0.015")
    status, _, reported = in_json(capsys, "check", path, "a.svg", "--cell", "axidraw-ebb")
    assert status == 1 and is_reported(reported, "stands-in-paint")
    path, text = written("fr3")
    paints = [k for k, line in enumerate(re.findall(r"^\d.*", text, re.MULTILINE)) if line.endswith(",pose")]
    slow = later(text, paints[len(paints) // 2], 0.05)
    assert is_reported(problems(path, slow, "fr3"), "stands-in-paint")


def test_a_uniformly_slower_stroke_is_not_a_stop(desk):
    path, text = written("axidraw-ebb")
    slow = re.sub(r"SM,(\d+)(?=,-?\d+,-?\d+\n)", lambda each: f"SM,{int(each[1]) * 5 // 4}", text)
    assert not is_reported(problems(path, slow, "axidraw-ebb"), "stands-in-paint")


def test_a_short_rise_at_the_end_of_a_stroke_is_not_a_stop(desk):
    """A part that rises at the end of a stroke is slower than its length and the servo's values say."""
    cell = find_cell("axidraw-ebb")
    speeds = replace(cell.speeds, paint_mm_s=7.5, press_mm_s=7.5, approach_mm_s=7.5)
    Path("mine.toml").write_text(write_cell(replace(cell, servo=replace(cell.servo, step_mm=0.25), speeds=speeds)))
    poses = np.array([(10, 10, 0), (10, 10, -0.3), (14, 13, -2.4), (14.08, 13.06, -2.2), (14.08, 13.06, 0)])
    plan = _core.Plan("round-6", "", (100, 60), [_core.Pass("a", poses, 7.5)])
    Path("a.json").write_text(brushsvg.write_plan(plan))
    brushsvg.convert("a.json", "a.ebb", cell="mine.toml")
    assert brushsvg.check("a.ebb", "a.json", cell="mine.toml").problems == ()


def test_the_start_of_a_lift_within_a_part_of_the_servo_is_not_a_stop(desk):
    """A lift begins from rest, and the servo's values do not show within which part."""
    cell = find_cell("axidraw-ebb")
    cell = replace(cell, servo=replace(cell.servo, step_mm=0.25), speeds=replace(cell.speeds, press_mm_s=26.3))
    Path("mine.toml").write_text(write_cell(cell))
    down = [(54.672, 41.556, 0), (59.029, 37.431, -1.582), (61.3, 35.28, -0.966), (61.433, 35.154, -1.017)]
    up = [(61.63, 34.967, -1.668), (61.814, 34.793, -1.471), (62.28, 34.352, -0.424), (62.243, 34.386, 0)]
    plan = _core.Plan("round-6", "", (100, 60), [_core.Pass("a", np.array(down + up), 20)])
    Path("a.json").write_text(brushsvg.write_plan(plan))
    brushsvg.convert("a.json", "a.ebb", cell="mine.toml")
    assert brushsvg.check("a.ebb", "a.json", cell="mine.toml").problems == ()
    text = Path("a.ebb").read_text()
    Path("a.ebb").write_text(text.replace("SM,33,29,1", "SM,53,29,1"))  # the first part of the lift, 20 ms longer
    assert is_reported(brushsvg.check("a.ebb", "a.json", cell="mine.toml").problems, "stands-in-paint")
