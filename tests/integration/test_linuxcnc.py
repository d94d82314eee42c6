"""LinuxCNC runs our programs pose by pose as planned, never too fast or too low."""

import json
import math
import re
import subprocess
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from command import brush_file, brushsvg
from drawings import SOURCES
from judge.backlash import with_play
from judge.moves import Leg, Run

from brushsvg import _core
from brushsvg.machine.cells.cell import Machine
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.model.library import find_brush

INTERPRET = Path(__file__).with_name("interpret.py")
NEAR_MM = 1e-3
WAYS = {
    **{source: (source, ()) for source in SOURCES},
    "uncompensated": ("robot", ("--compensation", "none")),
    "constant lag": ("robot", ("--compensation", "constant", "--lag", "9")),
    "fine": ("robot", ("--tolerance", "0.0005")),
    "rigid pen": ("vincent", ("--brush", "rigid")),
}
BRUSHES = {"rigid pen": "rigid"}


@dataclass
class Section:
    """A stroke's section: rapids and feeds in order, as LinuxCNC reads them."""

    stroke: str
    events: list = field(default_factory=list)


def interpreted(program, tmp_path):
    """Return (events before the first stroke, sections).

    If LinuxCNC refuses the program, raise AssertionError with its message.
    """
    parameters = tmp_path / "linuxcnc.var"
    parameters.touch()
    done = subprocess.run(
        ["/usr/bin/python3", INTERPRET, program, parameters], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return in_sections(json.loads(done.stdout))


def in_sections(events):
    before, sections = [], []
    for event in events:
        if event[0] == "comment":
            if found := re.match(r"stroke \d+ of \d+: (.*)", event[1]):
                sections.append(Section(found[1]))
        else:
            (sections[-1].events if sections else before).append(event)
    return before, sections


def canonical(program, tmp_path):
    """Return events and sections from the canonical commands of rs274, to 1e-4 mm.

    rs274 is LinuxCNC's stand-alone interpreter.
    """
    done = subprocess.run(["rs274", "-g", program], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    events, feed = [], 0.0
    for line in done.stdout.splitlines():
        if not (found := re.fullmatch(r" *\d+ N\.* +(\w+)\((.*)\)", line)):
            continue
        name, words = found.groups()
        if name == "COMMENT":
            events.append(["comment", words.strip('"')])
        elif name == "SET_FEED_RATE":
            feed = float(words)
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            x, y, z, *turned = map(float, words.split(","))
            assert not any(turned), line
            events.append(["rapid", x, y, z] if name == "STRAIGHT_TRAVERSE" else ["feed", x, y, z, feed])
        elif name == "ARC_FEED":
            x, y, centre_x, centre_y, turns, z, *turned = map(float, words.split(","))
            assert not any(turned), line
            events.append(["arc", x, y, z, feed, centre_x, centre_y, turns])
        else:
            assert not re.search("NURBS|PROBE|TAP|DWELL|START_SPINDLE|TOOL", name), line
    return in_sections(events)


def check_points(before, sections, passes):
    """Check the order of each stroke's moves.

    The tool goes over the stroke's start, down, through the plan's poses, and up at its end. It does nothing
    else.
    """
    (first,) = before
    safe = first[3]
    assert first[0] == "rapid"
    assert safe >= 5
    assert len(sections) == len(passes)
    for section, target in zip(sections, passes, strict=True):
        assert section.stroke == target["stroke"]
        poses = target["poses_mm"]
        (x0, y0, _), (x1, y1, _) = poses[0], poses[-1]
        clearance = section.events[1][3]
        assert 0 < clearance < safe
        arcs = {last: (first, *circle) for first, last, *circle in target.get("arcs", ())}
        on_an_arc = {k for last, (first, *_) in arcs.items() for k in range(first + 1, last)}
        painted = [("arc" if k in arcs else "feed", pose) for k, pose in enumerate(poses) if k not in on_an_arc]
        expected = [
            *(("rapid", (x0, y0, safe)), ("feed", (x0, y0, clearance))),
            *painted,
            *(("feed", (x1, y1, clearance)), ("rapid", (x1, y1, safe))),
        ]
        assert [event[0] for event in section.events] == [kind for kind, _ in expected]
        for event, (_, point) in zip(section.events, expected, strict=True):
            assert event[1:4] == pytest.approx(point, abs=NEAR_MM, rel=0)
        circles = [event for event in section.events if event[0] == "arc"]
        for event, (last, (first, x, y, turn)) in zip(circles, sorted(arcs.items()), strict=True):
            check_circle(event, np.array(poses[first : last + 1]), (x, y), turn)


def check_circle(event, poses, centre, turn):
    """Check that a circle passes through all poses of its arc.

    It has the arc's direction and makes at most one turn.
    """
    *_, x, y, turns = event
    assert (x, y) == pytest.approx(centre, abs=NEAR_MM)
    assert turns == turn, "less than a whole turn, in the arc's direction"
    radius = math.hypot(event[1] - x, event[2] - y)
    assert np.hypot(poses[:, 0] - x, poses[:, 1] - y) == pytest.approx(radius, abs=3 * NEAR_MM)
    angles = np.unwrap(np.arctan2(poses[:, 1] - y, poses[:, 0] - x)) * turn
    assert (np.diff(angles) > 0).all() and angles[-1] - angles[0] < 2 * np.pi


def check_rapids(before, sections):
    """Check that rapids are safe.

    A rapid ends at safe height, and moves sideways only if it starts there. None begins in the paper.
    """
    here = [0.0, 0.0, before[0][3]]
    safe = before[0][3]
    for event in (event for section in sections for event in section.events):
        assert event[0] in ("rapid", "feed", "arc"), event
        there = event[1:4]
        if event[0] == "rapid":
            assert there[2] == pytest.approx(safe)
            assert here[2] > 0
            assert here[2] == pytest.approx(safe) or here[:2] == pytest.approx(there[:2])
        here = there


def check_feeds(sections, passes, limit_mm_s):
    """Check that no feed is faster than the brush allows.

    Each stroke is painted at its own speed.
    """
    for section, target in zip(sections, passes, strict=True):
        feeds = [event[4] for event in section.events if event[0] != "rapid"]
        assert min(feeds) > 0
        assert max(feeds) <= 60 * limit_mm_s + 1e-6
        speed = 60 * target["speed_mm_s"]
        at = [event[1:4] for event in section.events if event[0] != "rapid"]
        steps = list(zip(feeds[2:-1], at[1:], at[2:], strict=False))
        moving = [feed for feed, here, there in steps if here[:2] != there[:2]]
        pressing = [feed for feed, here, there in steps if here[:2] == there[:2] and here[2] != there[2]]
        assert moving == pytest.approx([speed] * len(moving), abs=0.051)
        assert pressing == pytest.approx([feeds[1]] * len(pressing), abs=0.051), "as slowly as it lands"
        assert feeds[1] <= speed + 0.051
        assert feeds[-1] <= speed + 0.051


def passes_in(folder):
    return json.loads((folder / "plan.json").read_text(encoding="utf-8"))["passes"]


@pytest.fixture(params=WAYS)
def way(request):
    return request.param


@pytest.fixture
def made(way, converted):
    source, flags = WAYS[way]
    return converted(source, *flags)


def test_program_points_equal_the_plan(made, tmp_path):
    check_points(*interpreted(made / "program.ngc", tmp_path), passes_in(made))


def test_the_stand_alone_interpreter_agrees_with_the_plan(made, tmp_path):
    before, sections = canonical(made / "program.ngc", tmp_path)
    check_points(before, sections, passes_in(made))
    check_rapids(before, sections)


@pytest.mark.parametrize("way", ["robot", "constant lag"])
def test_axes_with_backlash_follow_the_same_path(way, drawing, tmp_path):
    """Axes with backlash paint where other axes paint.

    The places come from the stand-alone interpreter, and the judge's axes run them.
    """
    source, flags = WAYS[way]
    cell = find_cell("linuxcnc-3axis")
    backlash_mm = (0.44, 0.28)
    painted = []
    for name, machine in (("exact", None), ("worn", Machine(backlash_mm=backlash_mm))):
        (tmp_path / f"{name}.toml").write_text(write_cell(replace(cell, machine=machine)))
        words = (drawing(source), "-o", f"{name}.ngc", "--cell", f"{name}.toml", *flags)
        brushsvg("convert", *words, cwd=tmp_path, status=0)
        before, sections = canonical(tmp_path / f"{name}.ngc", tmp_path)
        run = Run(legs_of([*before, *(event for section in sections for event in section.events)]))
        run = with_play(run, backlash_mm if machine else (0.0, 0.0))
        painted.append(np.array([leg.end for leg in run.legs if max(leg.start[2], leg.end[2]) < -1e-3]))
    one, other = painted
    assert len(one) > 100
    for points, path in ((one, other), (other, one)):
        away = shapely.distance(shapely.points(points[:, :2]), shapely.LineString(path[:, :2]))
        assert away.max() < 1e-3


def legs_of(events):
    """Return the judge's legs of the events, starting over the sheet's corner."""
    here, legs = (0.0, 0.0, 50.0), []
    for number, (kind, x, y, z, *more) in enumerate(events):
        centre, turn = (tuple(more[1:3]), int(np.sign(more[3]))) if kind == "arc" else (None, 0)
        legs.append(Leg(number, kind, here, (x, y, z), 1.0, centre, turn))
        here = x, y, z
    return legs


def test_rapid_moves_stay_above_the_paper(made, tmp_path):
    check_rapids(*interpreted(made / "program.ngc", tmp_path))


def test_feeds_stay_under_the_brushs_limit(way, made, tmp_path):
    _, sections = interpreted(made / "program.ngc", tmp_path)
    limit_mm_s = brush_file(BRUSHES.get(way, "round-6"))["max_speed_mm_s"]
    check_feeds(sections, passes_in(made), limit_mm_s)


def test_a_plan_gives_the_same_moves_as_its_drawing(source, converted, tmp_path):
    folder = converted(source)
    brushsvg("convert", folder / "plan.json", "-o", tmp_path / "by_plan.ngc", cwd=tmp_path, status=0)
    check_points(*interpreted(tmp_path / "by_plan.ngc", tmp_path), passes_in(folder))


def simulated(passes, brush):
    marks = _core.simulate(_core.Plan(brush.name, "", (1000.0, 1000.0), passes), brush, 0.005)
    _core.trace_outlines(marks, brush)
    return marks.outline_mm


def run_poses(section):
    """Return the machine's places on the paper, with circles in small steps."""
    poses = []
    for kind, x, y, z, *rest in section.events:
        if kind == "arc":
            _, centre_x, centre_y, turns = rest
            poses += round_to(poses[-1], (x, y, z), (centre_x, centre_y), turns)
        poses.append([x, y, z])
    return np.array([pose for pose in poses if pose[2] <= 1e-6])


def round_to(start, end, centre, turns):
    """Return poses in small steps between two poses on a circle."""
    first, last = (math.atan2(each[1] - centre[1], each[0] - centre[0]) for each in (start, end))
    sweep = (last - first) * turns % (2 * math.pi) * turns
    angle = first + sweep * np.linspace(0, 1, 500)[1:-1]
    radius = math.dist(end[:2], centre)
    x, y = centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)
    return np.column_stack([x, y, np.full(len(angle), end[2])]).tolist()


def test_simulated_marks_equal_the_planned_marks(way, made, tmp_path):
    brush = find_brush(BRUSHES.get(way, "round-6"))
    _, sections = interpreted(made / "program.ngc", tmp_path)
    planned = simulated([planned_pass(each) for each in passes_in(made)], brush)
    run = simulated([_core.Pass("s", run_poses(section), 20.0) for section in sections], brush)
    assert _core.overlap(run, planned) > 0.999


def planned_pass(each):
    """Return a planned pass in small steps.

    The edges of thin marks are checked more exactly than the simulator's tolerance, so both passes need equal
    steps.
    """
    poses, rows = each["poses_mm"], []
    circle = {k: arc for arc in each.get("arcs", ()) for k in range(arc[0] + 1, arc[1] + 1)}
    for k, pose in enumerate(poses):
        if k in circle:
            _, _, x, y, turns = circle[k]
            rows += round_to(poses[k - 1], pose, (x, y), turns)
        rows.append(list(pose))
    return _core.Pass("s", np.array(rows), 20.0)


def test_program_text_is_plain_ascii(made):
    data = (made / "program.ngc").read_bytes()
    assert data.isascii()
    for line in data.decode("ascii").splitlines():
        assert len(line) < 250  # LinuxCNC reads at most 255 characters
        code = re.sub(r"\(.*\)", "", line)
        assert re.fullmatch(r"([A-Z]-?\d+(\.\d+)? ?)*", code), line
        assert not re.search(r"-0\.0*(?!\d)", code), line


def test_names_in_a_drawing_cannot_become_commands(tmp_path):
    """Names in a drawing cannot become commands.

    LinuxCNC acts on some comments. A bracket or line end could end the comment of a name.
    """
    title = "%;M2) G0 Z-50 (MSG, hi) (PRINT,#1)&#10;G0 Z-5 " + "\u00e9\u66f8x" * 100
    name = "(o100 call) M30&#10;% (debug,#5)"
    (tmp_path / "x.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
        f'<title>{title}</title><path id="{name}" d="M20 40 C40 10 60 10 90 30" fill="none" stroke="#000" '
        'stroke-width="3"/><path id="MSG,hello" d="M20 50h20" stroke="#000" stroke-width="3"/></svg>',
        encoding="utf-8",
    )
    for out in ("plan.json", "program.ngc"):
        brushsvg("convert", "x.svg", "-o", out, cwd=tmp_path, status=0)
    passes = passes_in(tmp_path)
    assert passes[1]["stroke"] == "MSG,hello"
    before, sections = interpreted(tmp_path / "program.ngc", tmp_path)
    check_rapids(before, sections)
    for section, each in zip(sections, passes, strict=True):
        each["stroke"] = section.stroke
    check_points(before, sections, passes)
    assert all(line.isprintable() for line in (tmp_path / "program.ngc").read_text().splitlines())


FAULTS = {
    "no feed rate": lambda text: re.sub(r"(?m)^F[\d.]+$", "", text),
    "feed rate zero": lambda text: re.sub(r"(?m)^F[\d.]+$", "F0", text),
    "a word that is none": lambda text: text.replace("G1 ", "J1 ", 1),
    "a word twice": lambda text: re.sub(r"(G1 X[\d.]+)", r"\1 X1", text, count=1),
    "an exponent": lambda text: re.sub(r"Z-(\d)", r"Z-2.77e-17 Z-\1", text, count=1),
    "a comma as decimal mark": lambda text: re.sub(r"X(\d+)\.(\d+)", r"X\1,\2", text, count=1),
    "an open comment": lambda text: text.replace(")", "", 1),
    "no end": lambda text: text.replace("M2", ""),
    "a circle about another centre": lambda text: re.sub(r"(G3 .* I)(-?)(\d)", r"\1\g<2>1\3", text, count=1),
}


def program_for(change, converted):
    source, flags = WAYS["constant lag"] if "circle" in change else ("robot", ())
    return converted(source, *flags)


@pytest.mark.parametrize("fault", FAULTS)
def test_linuxcnc_refuses_a_broken_program(fault, converted, tmp_path):
    """LinuxCNC refuses a broken program.

    So an accepted program in the test above means something.
    """
    text = (program_for(fault, converted) / "program.ngc").read_text(encoding="ascii")
    broken = FAULTS[fault](text)
    assert broken != text
    (tmp_path / "broken.ngc").write_text(broken)
    done = subprocess.run(["rs274", "-g", "broken.ngc"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1


def painting_line(lines):
    """Return the line number of a pose in the middle of the program."""
    poses = [k for k, line in enumerate(lines) if re.search(r"X.* Z-\d", line)]
    return poses[len(poses) // 2]


def moved(text):
    lines = text.splitlines()
    k = painting_line(lines)
    lines[k] = re.sub(r"X(-?[\d.]+)", lambda found: f"X{float(found[1]) + 0.002:.4f}", lines[k])
    return "\n".join(lines)


def without_a_line(text):
    lines = text.splitlines()
    del lines[painting_line(lines)]
    return "\n".join(lines)


def strokes_swapped(text):
    head, first, second, *rest = re.split(r"(?m)^(?=\(stroke )", text)
    return "".join([head, second, first, *rest])


def without_circles(text):
    """Return the program with lines instead of circles.

    LinuxCNC itself would refuse circles whose ends have different radii.
    """
    return re.sub(r"(?m)^G[23] (.*) I\S+ J\S+$", r"G1 \1", text)


TAMPERED = {
    "a pose 0.002 mm off": (moved, "points"),
    "a pose left out": (without_a_line, "points"),
    "two strokes in the other order": (strokes_swapped, "points"),
    "inches": (lambda text: text.replace("G21", "G20"), "points"),
    "relative moves": (lambda text: without_circles(text).replace("G90", "G91"), "points"),
    "a rapid down to the paper": (lambda text: re.sub(r"(?m)^G1 (.*Z0\.0000)", r"G0 \1", text), "rapids"),
    "low travel": (lambda text: re.sub(r"(?m)^(G0 X.* Z)10\.0", r"\g<1>2.0", text), "rapids"),
    "painting too fast": (lambda text: text.replace("F1200", "F1600"), "feeds"),
    "a circle the other way round": (lambda text: re.sub("(?m)^G3 ", "G2 ", text, count=1), "points"),
    "pressing too fast": (lambda text: text.replace("F480", "F1400"), "feeds"),
}


@pytest.mark.parametrize("change", TAMPERED)
def test_the_checks_detect_a_wrong_program(change, converted, tmp_path):
    """The checks find a wrong program that LinuxCNC accepts."""
    folder = program_for(change, converted)
    edit, check = TAMPERED[change]
    text = (folder / "program.ngc").read_text(encoding="ascii")
    assert edit(text) != text
    (tmp_path / "wrong.ngc").write_text(edit(text))
    before, sections = interpreted(tmp_path / "wrong.ngc", tmp_path)
    with pytest.raises(AssertionError):
        if check == "points":
            check_points(before, sections, passes_in(folder))
        elif check == "rapids":
            check_rapids(before, sections)
        else:
            check_feeds(sections, passes_in(folder), 25)
