"""TP splits jobs with too many points and remarks with too many characters.

A job becomes several programs, and a remark becomes several lines.
"""

from dataclasses import replace

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused
from programs import RUNNABLE, call
from test_robot_scripts import SQUARE, on, sound
from test_urscript import text_for

from brushsvg import _core
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.posts import POSTS
from brushsvg.machine.posts.fanuc import REMARK_LETTERS, programs
from brushsvg.verify.readback import read_program
from brushsvg.verify.readback.header import read_header


def waves(strokes: int, poses: int):
    t = np.linspace(0, 1, poses)
    depth = -2 * np.minimum(1, 10 * np.minimum(t, 1 - t))
    return _core.Plan(
        *("round-6", "", (60.0, 60.0)),
        [
            _core.Pass(f"s{k}", np.column_stack([15 + 30 * t, 12 + k + 0.2 * np.sin(20 * t), depth]), 20.0)
            for k in range(strokes)
        ],
    )


@pytest.fixture
def job(tmp_path, capsys):
    """A folder with a program in three files."""
    (tmp_path / "waves.json").write_text(_core.write_plan(waves(30, 90)))
    words = str(tmp_path / "waves.json"), "-o", str(tmp_path / "waves.ls"), "--cell", "lrmate200id"
    status, _, reported = call(capsys, "convert", *words)
    assert status == 0, reported
    return tmp_path


def check(job, capsys) -> str:
    status, out, reported = call(capsys, "check", str(job / "waves.ls"), str(job / "waves.json"))
    return out if status == 0 else " ".join(reported)


def test_a_long_job_is_a_main_program_that_calls_its_parts(job, capsys):
    parts = sorted(path for path in job.glob("*.ls") if path.name != "waves.ls")
    assert len(parts) == 3
    names = [path.stem for path in parts]
    main = (job / "waves.ls").read_bytes().decode("ascii")
    assert "".join(f" : CALL {name} ;\r\n" for name in names) in main
    assert main.replace("\r\n", "").count("\n") == 0 and "mm/sec" not in main
    texts = [path.read_bytes().decode("ascii") for path in parts]
    assert all(text.count("P[") <= 2 * 1000 and len(path.stem) == 8 for text, path in zip(texts, parts, strict=True))
    assert RUNNABLE in check(job, capsys)
    ran = sound("".join([main, *texts]), find_cell("lrmate200id"))
    assert [words for words, _ in ran.titles][:2] == ["stroke 1 of 30: s0", "stroke 2 of 30: s1"]
    assert len({name for name, _ in ran.titles}) == 31 and len(ran.legs) == 30 * 94


def test_jobs_with_equal_title_and_length_have_different_part_names():
    """Moved by 5 mm, a job has the same text in its main program."""
    here = {each.stroke: each.poses_mm for each in waves(30, 90).passes}
    there = {name: np.add(poses, (5.0, 0.0, 0.0)) for name, poses in here.items()}
    for cell in (find_cell("lrmate200id"), find_cell("kr6-r900")):
        of_language = POSTS[cell.language].programs
        names = [of_language(text_for(cell, strokes)).keys() for strokes in (here, here, there)]
        assert names[0] == names[1] and len(names[0]) > 2 and names[0] & names[2] == {""}


def test_jobs_of_other_speeds_have_different_part_names():
    """The main program has no speed, and its time is rounded."""
    strokes, fast = {each.stroke: each.poses_mm for each in waves(30, 90).passes}, find_cell("lrmate200id")
    slow = replace(fast, speeds=replace(fast.speeds, press_mm_s=fast.speeds.press_mm_s - 1.0))
    names = [programs(text_for(cell, strokes)).keys() for cell in (fast, slow)]
    assert names[0] & names[1] == {""}


def test_a_missing_or_foreign_part_is_refused(job, capsys):
    names = sorted(path.stem for path in job.glob("B*.ls") if path.name != "waves.ls")
    whole = (job / "waves.ls").read_bytes()
    first, second = (f" : CALL {name} ;\r\n".encode() for name in names[:2])
    for changed, expected in (
        (whole.replace(first + second, second + first), "11"),
        (whole.replace(second, b""), "21"),
        (whole.replace(second, second + second), names[1]),
        (whole.replace(names[0].encode(), b"BOTHER01"), "BOTHER01"),
    ):
        (job / "waves.ls").write_bytes(changed)
        assert expected in check(job, capsys)
    (job / "waves.ls").write_bytes(whole)
    part = job / f"{names[1]}.ls"
    part.write_bytes(part.read_bytes().replace(b"20mm/sec", b"90mm/sec", 5))
    reported = in_json(capsys, "check", job / "waves.ls", job / "waves.json")[2]
    assert is_reported(reported, "speed-out-of-range 90.0")


@pytest.fixture
def small(tmp_path, capsys):
    """Return a function that changes the text of a small program and checks it."""
    (tmp_path / "small.json").write_text(_core.write_plan(waves(2, 10)))
    program = tmp_path / "small.ls"
    cell = ("--cell", "lrmate200id")
    assert in_json(capsys, "convert", tmp_path / "small.json", "-o", program, *cell)[0] == 0
    text = program.read_bytes().decode("ascii")

    def ends(change=lambda text: text):
        program.write_text(change(text), newline="")
        status, _, reported = in_json(capsys, "check", program, tmp_path / "small.json", *cell)
        return status, reported

    assert ends()[0] == 0
    return ends


def test_a_frame_is_set_before_it_is_chosen(small):
    def before(text):
        chosen, first = " : UFRAME_NUM=1 ;\r\n", " : PR[1]=LPOS ;\r\n"
        assert chosen in text and first in text
        return text.replace(chosen, "").replace(first, chosen + first, 1)

    status, reported = small(before)
    assert status == 1 and is_reported(reported, "line-incomplete")


def test_a_name_that_no_controller_takes_is_refused(small):
    status, reported = small(lambda text: text.replace("/PROG  ", "/PROG  1", 1))
    assert status == 1 and is_reported(reported, "line-unread"), reported


def test_a_speed_in_another_unit_is_read_in_that_unit(small):
    """A speed in another unit is read in this unit.

    20 cm/min are 3.3 mm/s, which is slower than requested and allowed. 200 cm/min are 33 mm/s.
    """
    for speed, status in (("20cm/min", 0), ("200cm/min", 1)):
        assert small(lambda text, new=speed: text.replace(" P[5] 20mm/sec", f" P[5] {new}"))[0] == status
    cell = find_cell("lrmate200id")
    ran = read_program(text_for(cell).replace(" P[5] 20mm/sec", " P[5] 20cm/min"), ".ls", cell)
    speeds = {step.speed_mm_s for section in ran.sections for step in section.steps}
    assert any(abs(speed - 20 / 6) < 1e-6 for speed in speeds)


def test_a_stroke_of_too_many_poses_is_refused(tmp_path, capsys):
    (tmp_path / "a.json").write_text(_core.write_plan(waves(1, 997)))
    words = "convert", str(tmp_path / "a.json"), "-o", str(tmp_path / "a.ls"), "--cell", "lrmate200id"
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, "poses-too-many 1001 1000")
    assert not (tmp_path / "a.ls").exists()


def test_remarks_fit_the_pendant_and_are_read_back():
    title = "one; two  " + "a long name of a drawing" * 3
    header = (f"title: {title}", "brush: b, 3 strokes", "cell: lrmate200id, x")
    text = text_for(on("lrmate200id", SQUARE), header=header).replace("\r\n", "\n")
    remarks = [line for line in text.split("\n") if line.startswith(" : !")]
    assert len(remarks) == 9 and max(map(len, remarks)) == len(" : !") + REMARK_LETTERS + len(" ;")
    expected = f"title: {title}".replace(";", ",")
    assert read_header(text).title == expected.removeprefix("title: ")
    assert sound(text, find_cell("lrmate200id")).header[0] == expected
    acts = read_program(text, ".ls", on("lrmate200id", SQUARE)).acts
    assert f"({expected})" in [act.text for act in acts]


def test_a_single_program_has_an_empty_part_name():
    text = text_for(find_cell("lrmate200id"))
    assert list(programs(text)) == [""] and programs(text)[""] == text


def test_the_cut_of_a_corner_depends_on_the_time_to_full_speed():
    """The cut of a corner depends on the time to full speed.

    A ramp that is twice as long halves the percentages.
    """
    cell = on("lrmate200id", SQUARE)
    cell = replace(cell, blending=replace(cell.blending, tolerance_mm=0.04))
    slow = replace(cell, blending=replace(cell.blending, ramp_s=1.0))
    percents = [[int(word[3:]) for word in text_for(each).split() if word.startswith("CNT")] for each in (cell, slow)]
    assert percents[0] and all(abs(a - 2 * b) <= 1 for a, b in zip(*percents, strict=True))


def test_values_that_no_pendant_shows_are_refused():
    cell = find_cell("lrmate200id")
    with refused("out-of-range 'N U'"):
        parse_cell(write_cell(replace(cell, tool=replace(cell.tool, configuration="N U"))))
    with refused("key-unused"):
        parse_cell(write_cell(find_cell("cr5")).replace("radius_mm = 2.0", "radius_mm = 2.0\nramp_s = 0.4"))
