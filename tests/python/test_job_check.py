"""Programs for the checks before the first stroke are correct.

They are the air run round a job, and the strokes that find the paper.
"""

import json
import re

import pytest
from diagnostics import agrees, gives, in_json
from programs import LANGUAGES, RUNNABLE, call

from brushsvg.machine.cells.cell_file import SHIPPED

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">
<title>two</title><g fill="none" stroke="#000" stroke-width="3"><path id="curve" d="M20 50 C40 10 60 10 90 40"/>
<path id="hook" d="M20 60 h30 v-20 h-12"/></g></svg>"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    (tmp_path / "two.svg").write_text(DRAWING)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", LANGUAGES)
def test_an_air_run_is_checked_alone_and_with_its_drawing(desk, capsys, name):
    program = f"border{LANGUAGES[name]}"
    flags = ("--cell", name, "--z-offset", "0.4", "--compensation", "none", "--fit", "90x50")
    if name == "grbl-servo":
        # grbl-servo has no height to spare
        flags = ("--cell", name, "--compensation", "none", "--fit", "90x50")
    assert call(capsys, "setup", "border", "two.svg", "-o", program, *flags)[0] == 0
    status, out, err = call(capsys, "check", program)
    assert (status, err) == (0, [])
    assert re.fullmatch(
        rf"border\.\w+: [a-z ]+(\d+\.\d\d [a-z]+ \d+\.\d\d mm,? ){{2}}.*; .* \d+ s\n.*: {RUNNABLE}; .*\n",
        out,
    )
    status, out, err = call(capsys, "check", program, "two.svg", "--fit", "90x50")
    assert (status, err) == (0, [])
    assert out.endswith(f"{RUNNABLE}\n")
    status, _, reported = in_json(capsys, "check", program, "two.svg")
    assert (status, "border-elsewhere" in {each.code for _, each in reported}) == (1, True), "it was fitted into less"


@pytest.mark.parametrize("name", LANGUAGES)
def test_height_strokes_are_checked(desk, capsys, name):
    program = f"height{LANGUAGES[name]}"
    assert call(capsys, "setup", "height", "-o", program, "--cell", name, "--from", "0.7", "--step", "0.13")[0] == 0
    status, out, err = call(capsys, "check", program)
    assert (status, err) == (0, [])
    assert gives(out, "0.7", "-1 mm", "0.13 mm")
    assert out.endswith(f"{RUNNABLE}\n"), "there is no drawing to compare with"


def edited(old, new, count=1):
    def edit(text):
        assert re.search(old, text), old
        return re.sub(old, new, text, count=count)

    return edit


CHANGED = {
    ("border", ".ngc"): [
        (edited(r"(?m)^(G1 .*) Z10\.0000", r"\1 Z2.0000"), "too-low 2.00 10"),
        (
            edited(r"(?m)^(G1 X\S+ Y\S+) Z10\.0000", r"\1 Z-9.0000"),
            "travel-too-low",
        ),
        (edited(r"(?m)^G1 X\S+", "G1 X500.0000"), "tool-off-sheet 350.00 right"),
        (edited(r"(?m)^G1 X(\S+)", "G1 X90.0000"), "program-changed"),
        (edited(r"G4 P0\.500", "M0"), "program-changed 'G4 P0.500'"),
        (edited(r"(border: )\S+", r"\g<1>10.0"), "program-changed"),
        (edited(r"(border: )\S+", r"\g<1>1.0.0"), "header-damaged"),
        (edited(r"(border: )\S+", r"\g<1>-90"), "tool-off-sheet left"),
        (edited(r"\(border: .*\n", ""), "nothing-to-paint"),
        (edited(r"\(sheet: .*\n", ""), "sheet-unknown"),
    ],
    ("height", ".ngc"): [
        (
            edited(r"Z-0\.5000", "Z-2.5000", 0),
            "too-low -2.50 -1",
        ),
        (edited(r"Z-0\.5000", "Z-0.6000", 0), "program-changed"),
        (edited(r"F900\.0", "F1600.0", 0), "speed-out-of-range 26.7 25.0"),
        (edited(r"(?m)^G1 (.* Z0\.9000)", r"G0 \1"), "rapid-too-low"),
        (
            edited(r"(?m)^(G0 X.*) Z10\.0000\n\n\(stroke 9 ", r"\1 Z3.0000\n\n(stroke 9 "),
            "rapid-too-low 3.00",
        ),
        (edited(r"heights: 1 to -1 mm", "heights: 1 to -30 mm"), "strokes-out-of-range 311 2 100"),
        (edited(r"heights: 1 to", "heights: nan to"), "header-damaged heights nan"),
        (edited(r"--z-offset 0\.50", "--z-offset 0.80"), "program-changed"),
        (edited(r"\(heights: .*\n", ""), "touches-miscounted never"),
        (edited(r"(?s)\(stroke 21 .*?\n\n", ""), "program-changed"),
    ],
    ("height", ".nc"): [
        (edited(r"(?m)^G4 P0\.0\d\d\n", "", 0), "speed-out-of-range"),
    ],
}


@pytest.mark.parametrize("kind", CHANGED)
def test_any_change_of_a_setup_program_is_reported(desk, capsys, kind):
    job, suffix = kind
    cell = ("--cell", "grbl-servo") if suffix == ".nc" else ()
    drawing = ("two.svg",) if job == "border" else ()
    assert call(capsys, "setup", job, *drawing, "-o", f"job{suffix}", *cell)[0] == 0
    text = (desk / f"job{suffix}").read_text()
    assert call(capsys, "check", f"job{suffix}")[0] == 0
    for edit, expected in CHANGED[kind]:
        (desk / f"job{suffix}").write_text(edit(text))
        status, _, reported = in_json(capsys, "check", f"job{suffix}")
        assert (status, any(agrees(each, expected) for _, each in reported)) == (1, True), (expected, reported)


def test_a_job_without_picture_or_drawing_is_reported(desk, capsys):
    assert call(capsys, "setup", "height", "-o", "height.ngc")[0] == 0
    status, _, ((_, reported),) = in_json(capsys, "check", "height.ngc", "two.svg")
    assert (status, reported.code) == (1, "nothing-to-compare")
    status, _, ((_, reported),) = in_json(capsys, "check", "height.ngc", "--picture", "x.png")
    assert (status, reported.code) == (1, "nothing-to-show")
    status, out, _ = call(capsys, "check", "height.ngc", "--json")
    assert status == 0 and json.loads(out)["heights_mm"] == [1, -1, 0.1]


def test_an_air_run_beyond_the_workspace_is_refused(desk, capsys):
    """An air run beyond the workspace is refused.

    The job itself could not be run either.
    """
    (desk / "two.svg").write_text(DRAWING.replace("C40 10 60 10 90 40", "L190 40"))
    status, _, reported = in_json(capsys, "setup", "border", "two.svg", "-o", "border.ngc")
    assert status == 1 and agrees(reported[-1][1], "tool-off-sheet right")
    assert not (desk / "border.ngc").exists()


def test_corners_of_height_strokes_are_not_cut_by_half_a_millimetre(desk, capsys):
    text = (SHIPPED / "linuxcnc-3axis.toml").read_text()
    (desk / "mine.toml").write_text(edited(r"(?m)^tolerance_mm = \S+", "tolerance_mm = 0.5")(text))
    for words in (("setup", "height", "-o", "job.ngc"), ("setup", "border", "two.svg", "-o", "job.ngc")):
        assert call(capsys, *words, "--cell", "mine.toml")[0] == 0
        assert "G64 P0.0100" in (desk / "job.ngc").read_text()
        assert call(capsys, "check", "job.ngc", "--cell", "mine.toml")[0] == 0
