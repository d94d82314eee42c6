"""RAPID, KRL, TP, DRL, Lua for Dobot and Python for xArm do what the plan says.

An interpreter of the tests' own, written from the manuals, runs our programs, and `check` reads them. The
interpreter shares no code with the posts and readers.
"""

import inspect
import io
import itertools
import re
import subprocess
import sys
import tokenize
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from diagnostics import refused
from judge import places
from judge.dobot import LUA
from judge.moves import Leg, Run
from judge.table import Figures, measure
from judge.verdict import ROBOTS
from judge.works import make
from judge.xarm import XArmAPI, executed
from programs import LANGUAGES, call, program
from sampling import sample
from test_urscript import ARC, BRUSH, STROKES, text_for

from brushsvg import _core, write_plan
from brushsvg.machine.cells.cell import Blending, Contact, Paper, Reload, Station, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.posts import POSTS
from brushsvg.machine.writer import text_of
from brushsvg.verify.readback import Act, read_program
from brushsvg.verify.readback.dobot import _has_setting_in_function

GOLDEN = Path(__file__).parents[1] / "golden"
NAMES = {
    "irb120": "rapid",
    "xarm6": "xarm",
    "kr6-r900": "krl",
    "cr5": "dobot",
    "lrmate200id": "fanuc",
    "m0609": "doosan",
}
CIRCLES = {"irb120", "kr6-r900", "cr5", "lrmate200id", "m0609"}  # their programs contain circles
SQUARE = Paper((-150.0, -450.0, 20.0))
TURNED = Paper((-150.0, -450.0, 20.0), (0.0, 0.0, 25.0))
LEANING = Paper((-150.0, -450.0, 20.0), (2.0, -3.0, 25.0))
# The lower edge of the sheet goes straight up. Its angles about x and z turn about the same axis.
WALL = Paper((500.0, 100.0, 300.0), (0.0, -90.0, 30.0))


def on(name: str, paper: Paper):
    return replace(find_cell(name), paper=paper)


def needs_lua(language: str) -> None:
    if language == "dobot" and not LUA:
        pytest.skip("lua5.4 is not installed")


def run(text: str, cell, height_mm: float = 300.0) -> Run:
    """Return the moves of a program that starts from a place above the robot's table."""
    needs_lua(cell.language)
    spin = places.down_of({"tool": {"spin_deg": cell.tool.spin_deg}})
    tool = places.tool_of({"tool": {"tcp_mm": cell.tool.tcp_mm, "rotation_deg": cell.tool.rotation_deg}})
    return ROBOTS[cell.language](text, (-100.0, -400.0, height_mm), robot_from_paper(cell), spin, tool)


def stub(cell) -> XArmAPI:
    spin = places.down_of({"tool": {"spin_deg": cell.tool.spin_deg}})
    tool = places.tool_of({"tool": {"tcp_mm": cell.tool.tcp_mm, "rotation_deg": cell.tool.rotation_deg}})
    feels = cell.contact.sensitivity if cell.contact else 0
    return XArmAPI((-100.0, -400.0, 300.0), robot_from_paper(cell), spin, tool, feels)


def sound(text: str, cell, **at) -> Run:
    ran = run(text, cell, **at)
    assert not ran.refused and not ran.acts, (ran.refused, ran.acts)
    return ran


def touched(ran: Run, cell) -> list[tuple[Leg, np.ndarray]]:
    """Return the legs that end below the clearance, and their ends.

    The ends are in the paper frame.
    """
    back = np.linalg.inv(robot_from_paper(cell))
    ends = [(leg, places.moved(back, np.array([leg.end]))[0]) for leg in ran.legs if leg.kind in ("feed", "arc")]
    return [(leg, end) for leg, end in ends if end[2] < cell.heights.clearance_mm - 2e-3]


@pytest.mark.parametrize("paper", [SQUARE, TURNED, LEANING], ids=["square", "turned", "leaning"])
@pytest.mark.parametrize("name", NAMES)
def test_the_arm_passes_all_poses_of_the_plan(name, paper):
    cell = on(name, paper)
    rows = touched(sound(text_for(cell), cell), cell)
    writes_circles = name in CIRCLES
    arc = [ARC[0], ARC[8]] if writes_circles else ARC
    target = [*STROKES["n/1"], *STROKES["dot"], STROKES["turn"][0], *arc, *STROKES["turn"][10:]]
    away_mm = np.linalg.norm(np.array([end for _, end in rows]) - np.array(target), axis=1)
    assert away_mm.max() < 1e-3
    assert max(leg.speed_mm_s for leg, _ in rows) == 20.0
    circles = [leg for leg, _ in rows if leg.kind == "arc"]
    assert len(circles) == writes_circles
    for leg in circles:
        assert leg.centre == pytest.approx((20.0, 30.0), abs=2e-3) and leg.turn == -1


@pytest.mark.parametrize("paper", [LEANING, WALL], ids=["leaning", "wall"])
@pytest.mark.parametrize("name", NAMES)
def test_the_brush_is_held_along_the_paper_normal(name, paper):
    cell = on(name, paper)
    spin_deg = 30.0 if paper is LEANING else 180.0
    tool = replace(cell.tool, rotation_deg=(0.0, 10.0, 0.0), spin_deg=spin_deg)
    cell = replace(cell, tool=tool, workspace=replace(cell.workspace, box_mm=(), reach_mm=()))
    assert max(leg.tilt_rad for leg in sound(text_for(cell), cell).legs) < 1e-5


@pytest.mark.parametrize("name", NAMES)
def test_corners_are_blended_within_limits_and_not_at_reversals(name):
    finest = (0.001,) if name == "cr5" else ()
    cell = replace(on(name, SQUARE), blending=Blending(0.05, 2.0, *finest))
    legs = [leg for leg, _ in touched(sound(text_for(cell), cell), cell)]
    for leg, after in itertools.pairwise(legs):
        into, out = np.subtract(leg.end, leg.start), np.subtract(after.end, after.start)
        if into @ out < 0:
            assert leg.cut_mm == 0
        assert leg.cut_mm <= 0.45 * min(np.linalg.norm(into), np.linalg.norm(out)) + 1e-9
        turn = np.arccos(np.clip(into @ out / np.linalg.norm(into) / np.linalg.norm(out), -1, 1))
        assert leg.cut_mm * np.tan(turn / 4) <= 0.05
    assert max(leg.cut_mm for leg in legs) > 0.1
    cell = replace(cell, blending=Blending(0.0, 2.0))
    assert max(leg.cut_mm for leg in sound(text_for(cell), cell).legs) == 0


def gentle(cell, speed_mm_s=12.7) -> str:
    """Return the program of a stroke with bends of one degree."""
    poses = np.array([(10, 10, 0), (14, 10, -2), (18, 10, -2), (22, 10.1, -2), (26, 10.3, -2), (30, 10.3, 0)])
    a_pass = _core.Pass("gentle", poses, speed_mm_s)
    made = program(_core.Plan("b", "", (100.0, 60.0), [a_pass]), BRUSH, cell)
    return "".join(text_of(POSTS[cell.language], made))


def test_dobot_gets_whole_blends_and_whole_speeds():
    """Programs for Dobot have whole blends and whole speeds.

    The manual names no other values. If the cell declares a finer resolution, the program uses it.
    """
    cell = replace(on("cr5", SQUARE), blending=Blending(0.05, 2.0))
    reported = "MovL(on_paper(18.000, 10.000, -2.000), {speed = 12, r = 1})\n"
    reported += "MovL(on_paper(22.000, 10.100, -2.000), {speed = 12, r = 1})\n"
    assert reported in gentle(cell)
    fine = gentle(replace(cell, blending=Blending(0.05, 2.0, 0.5)))
    assert reported.replace("r = 1", "r = 1.500") in fine
    speeds = [step.speed_mm_s for section in read_program(fine, ".lua", cell).sections for step in section.steps]
    assert speeds == [100.0, 25.0, 10.0, *[12.0] * 5, 10.0, 100.0]
    assert [leg.speed_mm_s for leg in sound(fine, cell).legs] == speeds


def test_values_that_dobot_cannot_express_are_refused():
    text = write_cell(find_cell("cr5"))
    with refused("out-of-range [1, 5000]"):
        parse_cell(text.replace("press_mm_s = 10.0", "press_mm_s = 0.9"))
    with refused("speed-out-of-range [1, 25]"):
        gentle(find_cell("cr5"), 0.9)
    fine = write_cell(find_cell("irb120")).replace("radius_mm = 2.0", "radius_mm = 2.0\nstep_mm = 0.5")
    with refused("key-unused blends"):
        parse_cell(fine)


@pytest.mark.parametrize("name", NAMES)
def test_the_brush_is_raised_before_any_other_move(name):
    cell = on(name, SQUARE)
    low, high = (sound(text_for(cell), cell, height_mm=height) for height in (21.0, 300.0))
    assert low.legs[0].end == pytest.approx((-100, -400, 40)) and low.legs[0].speed_mm_s == 50
    assert len(low.legs) == len(high.legs) + 1 and low.legs[1].end[2] == pytest.approx(40)


@pytest.mark.parametrize("name", NAMES)
def test_the_program_waits_for_paint(name):
    stations = (
        Station("red", (120.0, 10.0), ("#ff0000",), depth_mm=5.0, hold_s=0.5),
        Station('ha"n\\d', (120.0, 50.0), by_hand=True),
    )
    cell = replace(on(name, SQUARE), reload=Reload("layer"), stations=stations)
    ran = sound(text_for(cell, colours=("#ff0000", "#ff0000", "#000000")), cell)
    waits = [leg for leg in ran.legs if leg.kind in ("wait", "stop")]
    assert [(leg.kind, leg.seconds) for leg in waits] == [("wait", 0.5), ("stop", 0.0)]
    assert waits[0].end == pytest.approx((-150 + 120, -440, 15), abs=1e-3)
    assert any(re.search("dip the brush: ha['\"]n", words) for words, _ in ran.titles)


@pytest.mark.parametrize("name", NAMES)
def test_programs_equal_the_golden_files(name):
    golden = GOLDEN / f"two_strokes{LANGUAGES[name]}"
    assert text_for(find_cell(name)).encode("ascii") == golden.read_bytes()


@pytest.mark.parametrize("paper", [SQUARE, TURNED, LEANING], ids=["square", "turned", "leaning"])
@pytest.mark.parametrize("name", NAMES)
def test_a_written_program_is_read_back(name, paper):
    cell = on(name, paper)
    text = text_for(cell)
    read = read_program(text, LANGUAGES[name], cell)
    steps = np.array([step[2:5] for section in read.sections for step in section.steps])
    frame = robot_from_paper(cell) if read.in_paper_frame else np.eye(4)
    assert places.moved(frame, steps) == pytest.approx(np.array([leg.end for leg in sound(text, cell).legs]))
    blanks = read_program(text.replace("\r\n", "  \n").replace("\n", " \n"), LANGUAGES[name], cell)
    assert (repr(blanks.acts), repr(blanks.sections)) == (repr(read.acts), repr(read.sections))


REFUSED = [
    ("irb120", "MoveL on_paper(10.000", "MoveJ on_paper(10.000", "line-unread"),
    ("irb120", "on_paper(10.000", "on_paper(10.000, 10.000", "line-unread"),
    ("irb120", "brush\\WObj:=paper", "brush", "line-unread"),
    ("irb120", "mm_s(100.000)", "v100", "line-unread"),
    ("irb120", "mm_s(100.000)", "mm_s(0.000)", "line-incomplete speed"),
    ("irb120", "within(0.039)", "within(-0.039)", "line-unread blend"),
    ("irb120", "AccMax:=0.500", "AccMax:=0.050", "line-incomplete"),
    ("irb120", "ENDMODULE", "", "program-cut-short"),
    ("kr6-r900", "LIN {X", "PTP {X", "line-unread"),
    ("kr6-r900", "LIN {X 10.000", "LIN {X 10.000, X 10.000", "line-unread"),
    ("kr6-r900", "C 180.00000}", "C 179.40000}", "tool-turned 0.6"),
    ("kr6-r900", "DEF BRUSHSVG()", "DEF LOOP()", "line-unread loop"),
    ("kr6-r900", "DEF BRUSHSVG()", "DEF 1WORD()", "line-unread 1word"),
    ("kr6-r900", "PTP $AXIS_ACT\r\n", "PTP $AXIS_ACT\r\n&REL 3\r\n", "line-unread"),
    ("kr6-r900", "$VEL.CP = 0.050000\r\n", "", "line-incomplete speed"),
    ("kr6-r900", "$VEL.CP = 0.020000", "$VEL.CP = 0", "line-incomplete speed"),
    ("kr6-r900", "$APO.CDIS = 0.039", "$APO.CDIS = -0.039", "line-unread blend"),
    ("kr6-r900", "$APO.CDIS = 0.039\r\n", "", "line-incomplete"),
    ("kr6-r900", "\r\nEND\r\n", "\r\n", "program-cut-short"),
    ("cr5", "MovL(on_paper(10.000", "MovJ(on_paper(10.000", "line-unread"),
    ("cr5", "on_paper(10.000", "on_paper(+10.000", "line-unread"),
    ("cr5", "180.00000, 0", "179.40000, 0", "tool-turned 0.6"),
    ("cr5", "{speed = 20}", "{speed = 0}", "line-incomplete speed"),
    ("cr5", "{speed = 20}", "{speed = 20.5}", "line-unread"),
    ("cr5", "{speed = 20}", "{v = 20}", "line-unread"),
    ("cr5", "{speed = 20}", "{speed = 20, r = -1}", "line-unread blend"),
    ("cr5", "{speed = 20}", "{speed = 20, cp = 1}", "line-unread"),
    ("cr5", "User(1)\nTool(1)\n", "Tool(1)\nSetTool(1, {0, 0, 0, 0, 0, 0})\nUser(1)\n", "line-unread"),
    ("cr5", "\nend\n", "\nCP(0)\nend\n", "line-unread"),
    ("cr5", "\n-- end: the brush is held up", "", "program-cut-short"),
    ("lrmate200id", "/ATTR\r\n", "", "line-unread COMMENT"),
    ("lrmate200id", " : L P[4]", " : J P[4]", "line-unread"),
    ("lrmate200id", " : L P[4]", " : L P[400]", "line-incomplete"),
    ("lrmate200id", "P[4]{", "P[5]{", "line-unread point"),
    ("lrmate200id", "X = 12.500", "X = +-12.500", "line-unread point"),
    ("lrmate200id", "W = 180.000", "W = 179.400", "tool-turned 0.6"),
    ("lrmate200id", "UF : 1", "UF : 0", "line-unread"),
    ("lrmate200id", "'N U T", "'F U T", "line-unread"),
    ("lrmate200id", "20mm/sec CNT3", "20mm/sec CNT101", "line-unread CNT101"),
    ("lrmate200id", " 20mm/sec CNT3", " 0mm/sec CNT3", "line-incomplete speed"),
    ("lrmate200id", " : C P[22]\r\n", "", "line-unread circle"),
    ("lrmate200id", " : PR[1,6]=0.00000 ;\r\n", "", "line-incomplete"),
    ("lrmate200id", "DEFAULT_GROUP\t= 1,*,*,*,*;\r\n", "", "line-unread DEFAULT_GROUP"),
    ("lrmate200id", "DEFAULT_GROUP", "TCD: ABORT_REQUEST = 1;\r\nDEFAULT_GROUP", "line-unread ABORT_REQUEST"),
    ("lrmate200id", "/MN", "ENABLE_SINGULARITY_AVOIDANCE : TRUE;\r\n/MN", "line-unread ENABLE_SINGULARITY_AVOIDANCE"),
    ("lrmate200id", " : !end: the brush is held up ;\r\n", "", "program-cut-short"),
    ("lrmate200id", "};\r\n/END\r\n", "};\r\n", "program-cut-short"),
    ("lrmate200id", " : !end", " : CALL B0001 ;\r\n : !end", "line-unread B0001"),
    ("m0609", "movel(on_paper(10.000", "movej(on_paper(10.000", "line-unread"),
    ("m0609", "on_paper(10.000", "on_paper(10.000, 10.000", "line-unread"),
    ("m0609", "    movel(here)", "movel(here)", "line-unread"),
    ("m0609", "    movel(here)", "  movel(here)", "line-unread DRL"),
    ("m0609", "0.00000, 180.00000, 180.00000", "0.00000, 179.40000, 180.00000", "tool-turned 0.6"),
    ("m0609", "set_velx(20.000", "set_velx(0.000", "line-incomplete speed"),
    ("m0609", "set_velx(20.000, 30.000)", "set_velx(20.000, -30.000)", "line-unread"),
    ("m0609", "set_velx(50.000, 30.000)\n", "", "line-incomplete speed"),
    ("m0609", "radius=0.039", "radius=-0.039", "line-unread blend"),
    ("m0609", "radius=0.039", "radius=0.039, ra=1", "line-unread"),
    ("m0609", "radius=0.039", "radius=1.953", "line-unread"),
    ("m0609", "# title", "# coding: utf-7\n# title", "line-unread"),
    ("m0609", "\n# end: the brush is held up", "", "program-cut-short"),
    ("xarm6", "go(-140.000", "go(x=-140.000", "line-unread"),
    ("xarm6", "go(-140.000", " go(-140.000", "line-unread"),
    ("xarm6", "100.000, None", "0.000, None", "line-incomplete speed"),
    ("xarm6", "wait=False", "wait=True", "line-unread"),
    ("xarm6", ", 0.031)", ", radius=0.031)", "line-unread"),
    ("xarm6", "arm.disconnect()\n", "", "program-cut-short"),
    ("xarm6", "# title", "# coding: utf-7\n# title", "line-unread"),
    ("xarm6", "strokes\n", "strokes\n# -*- coding=cp037 -*-\n", "line-unread"),
]


@pytest.mark.parametrize(("name", "old", "new", "expected"), REFUSED)
def test_the_reader_refuses_invalid_programs(name, old, new, expected):
    text = text_for(find_cell(name))
    assert old in text
    with refused(expected):
        read_program(text.replace(old, new, 1), LANGUAGES[name], find_cell(name))


def test_only_remarks_may_be_above_the_name_of_a_routine():
    cell = find_cell("kr6-r900")
    name, *lines = text_for(cell).splitlines(keepends=True)
    first_move = next(number for number, line in enumerate(lines) if line.startswith("LIN "))
    moved = "".join([*lines[: first_move + 1], name, *lines[first_move + 1 :]])
    with refused(f"line-unread {first_move + 2}"):
        read_program(moved, ".src", cell)


LOOKS = "tip = get_current_posx(DR_BASE)[0]\n", "flange = get_current_tool_flange_posx(DR_BASE)\n"
KRL_HEAD = "&ACCESS RVP\r\n&REL 3\r\n&PARAM TEMPLATE = C:\\KRC\\Roboter\\Template\\vorgabe\r\nDEF BRUSHSVG()"
TP_GROUP = "DEFAULT_GROUP\t= 1,*,*,*,*;\r\n"
TP_HEAD = (
    "OWNER\t\t= MNEDITOR;\r\nPROG_SIZE\t= 636;\r\nCREATE\t\t= DATE 26-11-29  TIME 10:00:00;\r\n"
    "MODIFIED\t= DATE 26-11-29  TIME 10:05:00;\r\nFILE_NAME\t= ;\r\nVERSION\t\t= 0;\r\nLINE_COUNT\t= 54;\r\n"
    "MEMORY_SIZE\t= 1108;\r\nTCD:  STACK_SIZE\t= 0,\r\n      TASK_PRIORITY\t= 50,\r\n      TIME_SLICE\t= 0,\r\n"
    "      BUSY_LAMP_OFF\t= 0,\r\n      ABORT_REQUEST\t= 0,\r\n      PAUSE_REQUEST\t= 0;\r\n"
)
TP_TAIL = "CONTROL_CODE\t= 00000000 00000000;\r\n"
TP_R30IB_TAIL = (
    "LOCAL_REGISTERS\t= 0,0,0;\r\n/APPL\r\n\r\nAUTO_SINGULARITY_HEADER;\r\n"
    "  ENABLE_SINGULARITY_AVOIDANCE   : FALSE;\r\n"
)
SAME = [  # equal for the controller
    ("kr6-r900", "DEF BRUSHSVG()", KRL_HEAD),
    ("lrmate200id", TP_GROUP, TP_HEAD + TP_GROUP + TP_TAIL),
    ("lrmate200id", TP_GROUP, TP_HEAD + TP_GROUP + TP_TAIL + TP_R30IB_TAIL),
    ("m0609", "".join(LOOKS), "".join(reversed(LOOKS))),
    ("m0609", LOOKS[0], LOOKS[0].replace("[0]", "[-0]")),
]


@pytest.mark.parametrize(("name", "old", "new"), SAME)
def test_the_reader_accepts_equivalent_text(name, old, new):
    cell = find_cell(name)
    text = text_for(cell)
    assert old in text

    def acts(text):
        return [repr(act._replace(line=0)) for act in read_program(text, LANGUAGES[name], cell).acts]

    assert acts(text.replace(old, new)) == acts(text)


@pytest.mark.parametrize("title", ["coding: rot13", "coding=coding:utf-7 +AAo-x = 1"])
def test_no_title_sets_the_encoding_of_python(title):
    """No title sets the encoding of a Python program.

    Python obeys an encoding remark in the first two lines of a file.
    """
    cell = find_cell("xarm6")
    text = text_for(cell, header=(f"title: {title}", f"brush: {title}, 3 strokes"))
    letters, _ = tokenize.detect_encoding(io.BytesIO(text.encode()).readline)
    assert letters == "utf-8"
    assert read_program(text, ".py", cell).sections


@pytest.mark.slow
@sample("name", NAMES, keep=2)
def test_check_refuses_dangerous_programs(name, tmp_path):
    """No dangerous program passes check, in a sample.

    tests/integration has three hundred of each job.
    """
    needs_lua(NAMES[name])
    figures = Figures()
    for job in ("two lines", "leaning"):
        measure(make(job, NAMES[name], tmp_path / str(len(job))), 60, 5, figures)
    assert figures.crashes == []
    assert [case for case in figures.cases if case.verdict == "dangerous" and not case.refusals] == []
    assert figures.of(NAMES[name], "dangerous") > 40 and figures.of(NAMES[name], "harmless") > 15


BROKEN = [
    ("irb120", "MoveL on_paper(", "MoveL on_papr("),
    ("irb120", "mm_s(20.000), ", "mm_s(20.000) "),
    ("irb120", "  ENDPROC\r\n", ""),
    ("irb120", "[0.0000000, 1.0000000, ", "[0.0000000, 1.1000000, "),
    ("irb120", "[TRUE, ", "["),
    ("irb120", "VAR robtarget", "VAR robtaget"),
    ("kr6-r900", "DECL E6POS here\r\n", ""),
    ("kr6-r900", "ENDIF\r\n", ""),
    ("kr6-r900", "PTP $AXIS_ACT\r\n", ""),
    ("kr6-r900", ", Y 10.000,", ", Y 10.000"),
    ("kr6-r900", "$BASE = {X", "$BASE = {"),
    ("cr5", "function ", "func "),
    ("cr5", "MovL(on_paper(", "Movl(on_paper("),
    ("cr5", "SetUser(1, {", "SetUser(1, {0, "),
    ("cr5", "Tool(1)\n", "Tool(3)\n"),
    ("cr5", "{speed = 20}", "{speed = 0}"),
    ("cr5", "  return {pose", "  return {joint"),
    ("cr5", "on_paper(10.000", "on_paper(+10.000"),
    ("lrmate200id", "/ATTR\r\n", ""),
    ("lrmate200id", " : L P[4] 20mm/sec", " : L P[4] 20.5mm/sec"),
    ("lrmate200id", " : UFRAME[1]=PR[1] ;\r\n", ""),
    ("lrmate200id", " : PR[1]=LPOS ;\r\n", ""),
    ("lrmate200id", "UT : 1,", "UT : 2,"),
    ("lrmate200id", "'N U T", "'F U T"),
    ("lrmate200id", " : ENDIF ;\r\n", ""),
    ("lrmate200id", "P[4]{", "P[5]{"),
    ("lrmate200id", "title: two strokes", "title: a remark that is longer than"),
    ("m0609", "def on_paper", "def in_paper"),
    ("m0609", "set_tcp", "set_tpc"),
    ("m0609", '"brush"', '"pen"'),
    ("m0609", "tip_mm - 150.000", "tip_mm - 148.000"),
    ("m0609", "set_ref_coord(paper)", "set_ref_coord(7)"),
    ("m0609", "radius=", "blend="),
    ("m0609", "radius=0.039", "radius=90.039"),
    ("m0609", "    here[2] =", "here[2] ="),
    ("xarm6", "def done", "def dun"),
    ("xarm6", "set_tcp_offset", "set_tool_offset"),
    ("xarm6", "done(arm.set_state(0))", "done(arm.set_state(4))"),
    ("xarm6", ", 20.000, 0.031)", ", 20.000)"),
    ("xarm6", "    done(code)", "   done(code)"),
    ("xarm6", "TOOL = [", "TOOL = [0, "),
]


@pytest.mark.parametrize(("name", "old", "new"), BROKEN)
def test_the_interpreter_refuses_broken_programs(name, old, new):
    text = text_for(find_cell(name))
    assert old in text
    assert run(text.replace(old, new, 1), find_cell(name)).refused


@pytest.mark.skipif(not find_spec("xarm"), reason="the vendor's SDK is not installed")
@pytest.mark.parametrize("broken", [None, ("MOST, is_radian", "MOST, in_radian"), ("set_mode(0)", "set_mode(0, 0, 0)")])
def test_every_call_exists_in_the_vendors_sdk(broken):
    from xarm.wrapper import XArmAPI

    cell = replace(
        on("xarm6", SQUARE),
        reload=Reload("layer"),
        stations=(Station("hand", (120.0, 50.0), by_hand=True),),
        contact=Contact(sensitivity=3),
    )
    arm = stub(cell)
    text = text_for(cell)
    calls = executed(text.replace(*broken) if broken else text, arm).calls
    try:
        for name, given, named in calls:
            inspect.signature(getattr(XArmAPI, name)).bind(arm, *given, **named)
            known = inspect.signature(getattr(XArmAPI, name)).parameters
            assert set(named) <= set(known), "kwargs take anything"
    except (TypeError, AssertionError):
        assert broken
    else:
        assert not broken and len(calls) > 30


def test_a_robot_slower_than_rapid_can_express_is_refused():
    text = write_cell(find_cell("irb120")).replace("acceleration_mm_s2 = 500.0", "acceleration_mm_s2 = 99.0")
    with refused("out-of-range [100, 50000]"):
        parse_cell(text)


@pytest.mark.skipif(not find_spec("rapidchecker"), reason="rapidchecker is not installed")
@pytest.mark.parametrize("broken", [None, *(pair[1:] for pair in BROKEN[1:3])])
def test_rapidchecker_accepts_the_program(tmp_path, broken):
    cell = replace(
        on("irb120", SQUARE), reload=Reload("layer"), stations=(Station("hand", (120.0, 50.0), by_hand=True),)
    )
    text = text_for(cell).replace(*broken, 1) if broken else text_for(cell)
    (tmp_path / "p.mod").write_text(text, newline="")
    (tmp_path / "rapidchecker.toml").write_text("indentation_check = false\n")
    done = subprocess.run([sys.executable, "-m", "rapidchecker", "p.mod"], cwd=tmp_path, capture_output=True)
    assert (done.returncode == 0) == (broken is None), done.stdout


def test_settings_inside_a_dobot_function_keep_their_order():
    texts = ["(title: a)", "function paint()", "User(1)", "end"]
    acts = [Act(k, "text", text) for k, text in enumerate(texts, 1)]
    assert _has_setting_in_function(acts) and not _has_setting_in_function(acts[:2])
    assert not _has_setting_in_function([acts[0], acts[2], acts[1], acts[3]])


def test_check_accepts_the_shortest_press_onto_tilted_paper(tmp_path, capsys):
    """Check accepts a press of 0.0025 mm, which rounding to 0.001 mm in the robot's frame turns a little sideways.

    Made exactly vertical again, the press was shorter than the shortest move. Check then expected no press, and said
    that the brush stands still in the paint.
    """
    cell = find_cell("jaka-zu3")
    paper = replace(
        cell.paper,
        origin_mm=(-13.564577636533272, -267.45871165538415, -338.2563965127828),
        rotation_deg=(-8.750119790561667, -6.245302228955573, 122.50639338342152),
    )
    tilted = replace(
        cell,
        paper=paper,
        blending=replace(cell.blending, tolerance_mm=0.005),
        workspace=replace(cell.workspace, tilt_limit_deg=20.0, box_mm=()),
        heights=replace(cell.heights, safe_mm=20.0),
        arm=None,
    )
    (tmp_path / "mine.toml").write_text(write_cell(tilted))
    press = (29.923, 41.647, 0), (29.923, 41.647, -0.0024592), (29.893552, 41.5745426, -0.0024592)
    a_pass = _core.Pass("a", np.array([*press, (27.936208, 36.7584574, -0.0842452)]), 20.0)
    plan, program = tmp_path / "p.json", tmp_path / "p.jks"
    plan.write_text(write_plan(_core.Plan("round-6", "", (100, 60), [a_pass])))
    words = "--cell", str(tmp_path / "mine.toml")
    assert call(capsys, "convert", str(plan), "-o", str(program), *words, "--z-offset", "1.25")[0] == 0
    status, _, reported = call(capsys, "check", str(program), str(plan), *words)
    assert status == 0, reported
