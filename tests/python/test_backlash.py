"""A cell that undoes backlash, on a machine that has it: programs are run by a machine of this test's own."""

import re

import numpy as np
import pytest
from diagnostics import in_json, is_told

pytest.importorskip("brushsvg._core")

from brushsvg.machine.arc_chords import with_chords
from brushsvg.machine.backlash import turning_rows
from brushsvg.machine.cell import Machine
from brushsvg.machine.cell_file import find_cell, write_cell
from brushsvg.machine.distortion import told_way_mm, true_way_mm, with_turns_mm
from brushsvg.pipeline.json_files import read_plan

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="110mm" height="70mm" viewBox="0 0 110 70">
<g fill="none" stroke="#000" stroke-linecap="round">
<path id="bow" d="M14 30 C24 6 48 6 56 28" stroke-width="4"/>
<path id="wave" d="M66 56 C74 36 82 70 90 50 S102 46 104 56" stroke-width="2.5"/>
<path id="back" d="M60 60 L16 58" stroke-width="3"/>
<path id="upright" d="M80 40 L80 12" stroke-width="3"/>
<path id="ring" d="M30 36 a8 8 0 1 1 -0.01 0" stroke-width="2"/></g></svg>"""
BACKLASH = np.array([0.45, 0.3])


@pytest.fixture
def desk(tmp_path):
    """A folder with a drawing and two cells: one that knows nothing, one that knows the backlash."""
    (tmp_path / "a.svg").write_text(DRAWING)
    from dataclasses import replace

    cell = find_cell("linuxcnc-3axis")
    (tmp_path / "plain.toml").write_text(write_cell(cell))
    (tmp_path / "knows.toml").write_text(
        write_cell(replace(cell, machine=Machine(backlash_mm=tuple(BACKLASH.tolist()))))
    )
    return tmp_path


def moves_of(program):
    """[(stroke, poses (n, 3))]: all places that a program names, section by section, circles in short chords."""
    at, found = np.array([0.0, 0.0, 50.0]), []
    for line in program.splitlines():
        if title := re.match(r"\(stroke \d+ of \d+: (.*)\)", line):
            found.append((title[1], []))
        words = {key: float(value) for key, value in re.findall(r"([GXYZIJ])(-?[\d.]+)", line.split("(")[0])}
        if not {"X", "Y", "Z"} & set(words):
            continue
        end = np.array([words.get(key, old) for key, old in zip("XYZ", at, strict=True)])
        places = [end]
        if "I" in words:
            centre = at[:2] + np.array([words["I"], words["J"]])
            a, b = ((each[:2] - centre) @ [1, 1j] for each in (at, end))
            turn = np.angle(b / a) % (2 * np.pi) - (0 if words["G"] == 3 else 2 * np.pi)
            share = np.linspace(0, 1, 60)[1:]
            on = a * np.exp(1j * turn * share)
            places = np.column_stack([centre[0] + on.real, centre[1] + on.imag, np.full(len(share), end[2])])
        if found:
            found[-1][1].extend(places)
        at = end
    return [(name, np.array(places)) for name, places in found]


def slides(program, backlash):
    """The same as a machine with this backlash goes: each screw pushes its slide from one side or the other, in steps
    of 0.02 mm; from wherever it was, which is the worst place."""
    lag, last, out = 0.5 * backlash * (1, -1), None, []
    for name, places in moves_of(program):
        track = []
        for place in places:
            last = place if last is None else last
            count = max(1, int(np.ceil(np.abs(place - last).max() / 0.02)))
            for share in np.arange(1, count + 1) / count:
                now = last + share * (place - last)
                lag = np.clip(
                    lag + (now - (track[-1][1] if track else last))[:2], -backlash / 2, backlash / 2
                )
                track.append((now - [*lag, 0.0], now))
            last = place
        out.append((name, np.array([each for each, _ in track])))
    return out


def astray_mm(program, plan, backlash):
    """By stroke how far from the plan's way the tool is at most while it is on the paper."""
    import shapely

    found = {}
    for (name, track), a_pass in zip(slides(program, backlash), plan.passes, strict=True):
        down = track[track[:, 2] < -0.05]
        way = shapely.LineString(np.asarray(with_chords(a_pass).poses_mm)[:, :2])
        found[name] = float(shapely.distance(shapely.points(down[:, :2]), way).max())
    return found


def test_a_machine_with_backlash_goes_where_it_should(desk, capsys):
    assert in_json(capsys, "convert", desk / "a.svg", desk / "plan.json", "--tolerance", "0.01")[0] == 0
    plan = read_plan(desk / "plan.json")
    for name in ("plain", "knows"):
        words = ("convert", desk / "plan.json", desk / f"{name}.ngc", "--cell", desk / f"{name}.toml")
        assert in_json(capsys, *words)[0] == 0
    text = {name: (desk / f"{name}.ngc").read_text() for name in ("plain", "knows")}
    exact = astray_mm(text["plain"], plan, np.zeros(2))
    before, now = (astray_mm(text[name], plan, BACKLASH) for name in ("plain", "knows"))
    assert max(exact.values()) < 0.02, exact
    assert min(before.values()) > 0.1 and max(before.values()) > 0.22, before
    assert max(now.values()) < 0.03, now


def test_check_undoes_it_the_same_way(desk, capsys):
    for name in ("plain", "knows"):
        words = ("convert", desk / "a.svg", desk / f"{name}.ngc", "--cell", desk / f"{name}.toml")
        assert in_json(capsys, *words)[0] == 0
        words = ("check", desk / f"{name}.ngc", desk / "a.svg", "--cell", desk / f"{name}.toml")
        assert in_json(capsys, *words)[0] == 0
    status, _, told = in_json(
        capsys, "check", desk / "plain.ngc", desk / "a.svg", "--cell", desk / "knows.toml"
    )
    assert status == 1, told


@pytest.mark.parametrize("noise_mm", [0.0, 0.001])
def test_play_is_taken_up_where_an_axis_turns(noise_mm):
    """Whatever the rounding of text: a line along y is no turn of x."""
    y = np.linspace(0.0, 20.0, 40)
    line = np.column_stack([np.full(40, 5.0), y, np.full(40, -1.0)])
    bend = np.column_stack([5 + y / 2, np.full(40, 20.0), np.full(40, -1.0)])
    back = bend[::-1] + np.array([0.0, 0.5, 0.0])
    way = np.vstack([line, bend, back])
    way[:, :2] += np.random.default_rng(1).choice([-noise_mm, noise_mm], (len(way), 2))
    machine = Machine(backlash_mm=(0.4, 0.2))
    assert turning_rows(way[:, :2], machine.backlash_mm).tolist() == [80]
    twice = with_turns_mm(way, machine)
    assert len(twice) == len(way) + 1
    told = told_way_mm(twice, machine)
    assert np.abs(true_way_mm(told, machine) - twice).max() < 0.01
    assert told[0, 0] - way[0, 0] == pytest.approx(0.2) and told[-1, 0] - way[-1, 0] == pytest.approx(-0.2)


@pytest.mark.parametrize("value", ["[0.1]", "[-0.1, 0.0]", "[0.1, 4.0]", '"much"'])
def test_no_backlash_is_refused(desk, capsys, value):
    text = (desk / "knows.toml").read_text()
    (desk / "bad.toml").write_text(re.sub(r"backlash_mm = .*", f"backlash_mm = {value}", text))
    status, _, told = in_json(capsys, "cell", "check", desk / "bad.toml")
    assert status == 1 and len(told) == 1 and not is_told(told, "cell-unchanged"), told
