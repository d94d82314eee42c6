"""A cell that undoes backlash paints the right lines on a machine with backlash.

This module has its own simulated machine that runs the programs.
"""

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused
from programs import is_refused_when_damaged
from sampling import sample
from shapely import LineString, distance, points

core = pytest.importorskip("brushsvg._core")

from brushsvg.machine.cells.cell import Machine, Paper  # noqa: E402
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell  # noqa: E402
from brushsvg.machine.realised.arc_chords import split_arcs_at_extremes  # noqa: E402
from brushsvg.machine.realised.backlash import commands_ahead, from_air_mm  # noqa: E402

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="110mm" height="70mm" viewBox="0 0 110 70">
<g fill="none" stroke="#000" stroke-linecap="round">
<path id="bow" d="M14 30 C24 6 48 6 56 28" stroke-width="4"/>
<path id="wave" d="M66 56 C74 36 82 70 90 50 S102 46 104 56" stroke-width="2.5"/>
<path id="back" d="M60 60 L16 58" stroke-width="3"/>
<path id="upright" d="M80 40 L80 12" stroke-width="3"/>
<path id="knee" d="M90 40 L104 40 L104 26" stroke-width="3"/>
<path id="ring" d="M30 36 a8 8 0 1 1 -0.01 0" stroke-width="2"/></g></svg>"""
BACKLASH = np.array([0.45, 0.3])
CELLS = {"linuxcnc-3axis": ".ngc", "grbl-3axis": ".gcode", "klipper-3axis": ".gcode"}


@pytest.fixture(params=CELLS)
def desk(tmp_path, request):
    """A folder with a drawing and two cells, and the extension of their programs.

    One cell has no backlash entry, the other one has the machine's backlash. The paper is turned relative to
    the machine's x and y.
    """
    (tmp_path / "a.svg").write_text(DRAWING)
    cell = replace(find_cell(request.param), paper=Paper((30.0, 20.0, 0.0), (0.0, 0.0, 25.0)))
    (tmp_path / "plain.toml").write_text(write_cell(cell))
    knows = replace(cell, machine=Machine(backlash_mm=tuple(BACKLASH.tolist())))
    (tmp_path / "knows.toml").write_text(write_cell(knows))
    return tmp_path, CELLS[request.param]


def convert(capsys, folder, ending, *flags):
    """Return the program texts for both cells."""
    for name in ("plain", "knows"):
        words = (
            "convert",
            folder / "a.svg",
            "-o",
            folder / f"{name}{ending}",
            "--cell",
            folder / f"{name}.toml",
            *flags,
        )
        assert in_json(capsys, *words)[0] == 0
    return [(folder / f"{name}{ending}").read_text() for name in ("plain", "knows")]


def places_of(program):
    """Return [(stroke, line, places (n, 3))] for each move after a stroke's title.

    Circles are split into short chords.
    """
    at, name = np.array([0.0, 0.0, 50.0]), ""
    for line in program.splitlines():
        if title := re.match(r"[(;] ?stroke \d+ of \d+: ([^)]*)", line):
            name = title[1]
        code = re.split(r"[(;]", line)[0]
        words = {key: float(value) for key, value in re.findall(r"([GXYZIJ])(-?[\d.]+)", code)}
        if not {"X", "Y", "Z"} & set(words):
            continue
        end = np.array([words.get(key, old) for key, old in zip("XYZ", at, strict=True)])
        track = end[None]
        if "I" in words:
            centre = at[:2] + np.array([words["I"], words["J"]])
            a, b = ((each[:2] - centre) @ [1, 1j] for each in (at, end))
            turn = np.angle(b / a) % (2 * np.pi) - (0 if words["G"] == 3 else 2 * np.pi)
            on = a * np.exp(1j * turn * np.linspace(0, 1, 400)[1:])
            track = np.column_stack([centre[0] + on.real, centre[1] + on.imag, np.full(len(on), end[2])])
        yield name, line, track
        at = end


def slides(program, backlash, lag=(1, -1)):
    """Yield (stroke, line, place) as a machine with this backlash moves.

    Each screw pushes its slide from one side or the other. `lag` is the side from which it pushed before.
    While a slide is not pushed, the steps are 0.01 mm.
    """
    half = np.append(backlash, 0.0) / 2
    lag, last = half * [*lag, 0], None
    for name, line, track in places_of(program):
        for place in track:
            before = place if last is None else last
            count = max(1, int(np.ceil(np.abs(place - before).max() / 0.01)))
            for k in range(count):
                is_pushed = (np.abs(lag - np.sign(place - before) * half) < 1e-9) | (place == before)
                after = place if is_pushed.all() else before + (place - before) * (k + 1) / count
                lag = np.clip(lag + after - (before if last is None else last), -half, half)
                last = after
                yield name, line, last - lag
                if is_pushed.all():
                    break
            last = place


def painted(program, backlash, **how):
    """Return the tool positions on the paper for each stroke."""
    found = {}
    for name, _, place in slides(program, backlash, **how):
        if place[2] < -0.05:
            found.setdefault(name, []).append(place[:2])
    return {name: np.array(track) for name, track in found.items()}


def apart_mm(some, others):
    """Return the greatest distance between the two tracks of each stroke."""
    assert some.keys() == others.keys()
    pairs = [(some[name], others[name]) for name in some]
    return [max(distance(points(a), LineString(b)).max(), distance(points(b), LineString(a)).max()) for a, b in pairs]


@sample("side", [(1, -1), (-1, 1), (1, 1)], keep=3)
def test_compensated_backlash_gives_the_path_of_a_machine_without_backlash(desk, capsys, side):
    """With compensation, a machine with backlash moves like one without.

    The result does not depend on the side from which the axes came before.
    """
    plain, knows = convert(capsys, *desk)
    exact = painted(plain, np.zeros(2))
    assert min(apart_mm(painted(plain, BACKLASH, lag=side), exact)) > 0.1, "else nothing is to undo"
    assert max(apart_mm(painted(knows, BACKLASH, lag=side), exact)) < 1.8e-3


def test_backlash_is_taken_up_in_the_air_or_at_painting_speed(desk, capsys):
    _, knows = convert(capsys, *desk)
    here, stood = None, []
    for _, line, place in slides(knows, BACKLASH):
        if here is not None and (np.abs(place - here) < 1e-9).all() and place[2] < 0.1:
            stood.append(line)
        here = place
    assert len(set(stood)) > 6 and all(line.startswith("G1 ") for line in stood)


def test_check_simulates_the_same_backlash_path(desk, capsys):
    folder, ending = desk
    convert(capsys, folder, ending)
    for program, cell in itertools.product(("plain", "knows"), repeat=2):
        status = 0 if program == cell else 1
        words = (folder / f"{program}{ending}", folder / "a.svg", "--cell", folder / f"{cell}.toml")
        assert in_json(capsys, "check", *words)[0] == status, (program, cell)


def test_check_finds_damaged_backlash_moves(tmp_path, capsys):
    (tmp_path / "a.svg").write_text(DRAWING)
    cell = replace(find_cell("linuxcnc-3axis"), machine=Machine(backlash_mm=(0.45, 0.3)))
    (tmp_path / "knows.toml").write_text(write_cell(cell))
    path = tmp_path / "a.ngc"
    assert in_json(capsys, "convert", tmp_path / "a.svg", "-o", path, "--cell", tmp_path / "knows.toml")[0] == 0
    text, words = path.read_text(), (tmp_path / "a.svg", "--cell", tmp_path / "knows.toml")
    rows = [line for _, line, _ in places_of(text)]
    first = next(line for name, line, _ in places_of(text) if name)
    here, stands = None, ""
    for _, line, place in slides(text, BACKLASH):
        if here is not None and (np.abs(place - here) < 1e-9).all() and place[2] < -0.5:
            stands = line
            break
        here = place
    again = rows[rows.index(first) + 1]
    assert first.startswith("G0") and again.startswith("G0") and stands.startswith("G1")
    moved = re.sub(r"X([\d.]+)", lambda x: f"X{float(x[1]) + 0.1:.3f}", stands)
    moved = re.sub(r"Y([\d.]+)", lambda y: f"Y{float(y[1]) + 0.1:.3f}", moved)
    for old, new, reported in (
        (f"{stands}\n", f"{stands.replace('G1', 'G0')}\n", "rapid-too-low"),
        (f"{stands}\n", f"F9000\n{stands}\n", "speed-out-of-range"),
        (f"{stands}\n", f"{moved}\n", "path-elsewhere"),
        (f"{first}\n", f"{again}\n", "backlash-not-taken-up"),
    ):
        assert is_refused_when_damaged(capsys, path, old, new, reported, *words), (old, reported)
        path.write_text(text)


def test_a_circle_is_split_only_where_an_axis_reverses():
    """A circle is cut exactly once where an axis reverses, and nowhere else.

    This holds on turned paper, too.
    """
    angles = np.radians([200.0, 260.0, 330.0, 390.0, 450.0, 480.0])
    poses = np.column_stack([40 + 8 * np.cos(angles), 30 + 8 * np.sin(angles), np.full(6, -2.0)])
    arcs = [core.Arc(0, 5, (40.0, 30.0), 1)]
    a_pass = core.Pass(stroke="s", poses_mm=poses, speed_mm_s=20.0, arcs=arcs)
    for turned_deg, target in ((0.0, [270, 360, 450]), (25.0, [245, 335, 425])):
        cut = split_arcs_at_extremes(a_pass, np.radians(turned_deg))
        ends = np.array(cut.poses_mm)[[arc.last for arc in cut.arcs][:-1], :2] - (40, 30)
        assert np.degrees(np.arctan2(*ends.T[::-1])) % 360 == pytest.approx(np.array(target) % 360, abs=1e-6)
        assert np.hypot(*ends.T) == pytest.approx(8.0)
        assert [arc.first for arc in cut.arcs] == [0, *(arc.last for arc in cut.arcs[:-1])]
        assert cut.arcs[-1].last == len(cut.poses_mm) - 1
    back = core.Pass(stroke="s", poses_mm=poses[::-1], speed_mm_s=20.0, arcs=[core.Arc(0, 5, (40.0, 30.0), -1)])
    assert np.array(split_arcs_at_extremes(back, 0.0).poses_mm) == pytest.approx(
        np.array(split_arcs_at_extremes(a_pass, 0.0).poses_mm)[::-1]
    )


def test_axes_are_commanded_half_the_backlash_ahead():
    way = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, -1.0], [3.0, 2.0, -1.0], [1.0, 3.0, -1.0]])
    half = np.array([0.2, 0.1])
    reported, side = commands_ahead(way[1:], way[0], np.array([1.0, -1.0]), half)
    target = [[3.2, -0.1, -1], [3.2, 0.1, -1], [3.2, 2.1, -1], [2.8, 2.1, -1], [0.8, 3.1, -1]]
    assert reported == pytest.approx(np.array(target)) and side.tolist() == [-1, 1]
    in_all = from_air_mm(way, 2 * half)
    assert in_all[:3, :2] == pytest.approx(np.array([[-0.2, -0.1], [0.2, 0.1], [0.2, 0.1]]))
    assert in_all[:2, 2].min() > 1 and in_all[2, 2] == 0
    assert len(from_air_mm(way[:1], 2 * half)) == 3


@pytest.mark.parametrize(
    "name, value, reported",
    [
        ("linuxcnc-3axis", "[0.1]", "wrong-type 2"),
        ("linuxcnc-3axis", "[-0.1, 0.0]", "out-of-range -0.1 0 3"),
        ("linuxcnc-3axis", "[0.1, 4.0]", "out-of-range 4 0 3"),
        ("linuxcnc-3axis", "[0.1, 0.004]", "cell-machine 0.004 0.01 3"),
        ("hpgl-plotter", "[0.1, 0.04]", "cell-machine 0.04 0.05 3"),
        ("ur5e", "[0.1, 0.0]", "cell-machine 0.1 0"),
        ("axidraw-ebb", "[0.1, 0.0]", "cell-machine 0.1 0"),
    ],
)
def test_backlash_that_cannot_be_compensated_is_refused(name, value, reported):
    text = write_cell(find_cell(name))
    with refused(reported, "machine.backlash_mm"):
        parse_cell(f"{text}\n[machine]\nbacklash_mm = {value}\n")


@pytest.mark.parametrize("name, ending", [("grbl-servo", ".nc"), ("hpgl-plotter", ".hpgl"), ("marlin-servo", ".gcode")])
def test_servo_and_pen_cells_compensate_backlash(tmp_path, capsys, name, ending):
    (tmp_path / "a.svg").write_text(DRAWING)
    cell = replace(find_cell(name), machine=Machine(backlash_mm=(0.4, 0.3)))
    (tmp_path / "c.toml").write_text(write_cell(cell))
    brush = () if name == "grbl-servo" else ("--brush", "rigid")
    flags = ("--cell", tmp_path / "c.toml", *brush)
    assert in_json(capsys, "convert", tmp_path / "a.svg", "-o", tmp_path / f"a{ending}", *flags)[0] == 0
    assert in_json(capsys, "check", tmp_path / f"a{ending}", tmp_path / "a.svg", *flags)[0] == 0


def test_commands_ahead_of_their_places_stay_in_the_box(tmp_path, capsys):
    """No command leaves the box, also where the play is added to a place inside of it.

    The limits were once checked before the play was added, and the program commanded places outside of the box. The
    paper is turned by a right angle, so the box's x and the play of the machine's x limit the y of the paper.
    """
    (tmp_path / "a.svg").write_text(DRAWING)
    free = replace(
        find_cell("grbl-3axis"),
        paper=Paper((200.0, 20.0, 0.0), (0.0, 0.0, 90.0)),
        machine=Machine(backlash_mm=(1.0, 0.0)),
    )
    (tmp_path / "free.toml").write_text(write_cell(free))
    program = tmp_path / "a.gcode"
    convert = ("convert", tmp_path / "a.svg", "-o", program, "--cell")
    assert in_json(capsys, *convert, tmp_path / "free.toml")[0] == 0
    commanded = [float(value) for value in re.findall(r"^G[0-3] X(\S+)", program.read_text(), re.MULTILINE)]
    for narrower_mm, status in ((-0.01, 0), (0.01, 1), (0.49, 1)):
        left, right = min(commanded) + narrower_mm, max(commanded) - narrower_mm
        box = ((left, -100.0, -50.0), (right, 300.0, 100.0))
        cell = replace(free, workspace=replace(free.workspace, box_mm=box))
        (tmp_path / "c.toml").write_text(write_cell(cell))
        for words in (convert, ("check", program, "--cell")):
            found, _, reported = in_json(capsys, *words, tmp_path / "c.toml")
            assert found == status, (narrower_mm, reported)
            assert not status or is_reported(reported, "out-of-box x 0.5 machine.backlash_mm"), reported
