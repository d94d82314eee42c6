"""Jobs with too many lines for one program become several programs.

URScript's programs run one after the other; KRL's programs are called. The tests' own interpreters compare
their effect with that of a single program.
"""

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import in_json, is_reported
from judge.ebb import run_ebb
from programs import LANGUAGES, RUNNABLE, call
from test_fanuc import waves
from test_robot_scripts import sound
from urscript_stub import run as run_stub

from brushsvg import _core, convert
from brushsvg.machine.cells import language_limits
from brushsvg.machine.cells.cell import Workspace
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.machine.posts import ebb
from brushsvg.machine.posts.urscript import NEXT
from brushsvg.model.library import find_brush

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
MOST = {"ur5e": 1000, "kr6-r900": 2500}  # Lines; docs/machines/ur.md and kuka.md name the sources.
NO_LIMIT = 10**9


def files_of(path: Path) -> list[Path]:
    """Return a job's files in the order in which they run, starting with `path`."""
    others = [other for other in path.parent.glob(f"*{path.suffix}") if other != path]
    return [path, *sorted(others, key=lambda other: int(re.search(r"\d+$", other.stem)[0][-3:]))]


def text_of(files: list[Path]) -> str:
    return "".join(each.read_bytes().decode("ascii") for each in files)


def way(ran) -> list:
    """Return the legs of a run without their line numbers."""
    return [leg._replace(line=0) for leg in ran.legs]


@pytest.fixture(params=MOST)
def job(request, tmp_path, capsys, monkeypatch):
    """Return a cell's name, a job's first file, and the job's text in one program.

    The plan is in the parent folder.
    """
    name = request.param
    plan = waves(30, 90)
    (tmp_path / "waves.json").write_text(_core.write_plan(plan))
    paths = [tmp_path / folder / f"waves{LANGUAGES[name]}" for folder in ("whole", "parts")]
    for path in paths:
        path.parent.mkdir()
        with monkeypatch.context() as patch:
            if path.parent.name == "whole":
                patch.setitem(language_limits.MAX_PROGRAM_LINES, find_cell(name).language, NO_LIMIT)
            status, _, reported = call(capsys, "convert", str(tmp_path / "waves.json"), "-o", str(path), "--cell", name)
            assert status == 0, reported
    assert files_of(paths[0]) == paths[:1]
    return name, paths[1], text_of(paths[:1])


def test_a_long_job_is_split_into_equivalent_programs(job, capsys):
    name, first, whole = job
    files = files_of(first)
    assert len(files) == (4 if name == "kr6-r900" else 3)
    assert all(path.read_bytes().count(b"\n") <= MOST[name] for path in files)
    parts, one = (sound(text, find_cell(name)) for text in (text_of(files), whole))
    assert way(parts) == way(one) and parts.titles == one.titles and parts.header == one.header
    if name == "ur5e":
        events, again = (run_stub(text).events for text in (text_of(files), whole))
        assert [event for event in events if event[0] != "textmsg"] == again
        assert [event[1] for event in events if event[0] == "textmsg"] == [f"{NEXT} {count}" for count in (2, 3)]
    for plan in ([], [str(first.parents[1] / "waves.json")]):
        status, out, reported = call(capsys, "check", str(first), *plan)
        assert status == 0 and RUNNABLE in out, reported


def test_python_returns_the_same_program_parts_with_the_same_names(job):
    name, first, _ = job
    texts = convert(first.parents[1] / "waves.json", cell=name).texts
    files = {
        (each.name.removeprefix(first.stem) if name == "ur5e" or each == first else each.name): each
        for each in files_of(first)
    }
    assert {key: text.encode("ascii") for key, text in texts.items()} == {
        key: path.read_bytes() for key, path in files.items()
    }
    assert next(iter(texts)) == first.suffix


def test_a_missing_or_foreign_part_is_refused(job, capsys):
    name, first, _ = job
    files = files_of(first)
    before = [path.read_bytes() for path in files]

    def refused_with(*codes: str) -> bool:
        status, _, reported = in_json(capsys, "check", first, first.parents[1] / "waves.json")
        for path, data in zip(files, before, strict=True):
            path.write_bytes(data)
        return status == 1 and any(is_reported(reported, code) for code in codes)

    assert not refused_with("")
    files[1].unlink()
    assert refused_with("file-missing", "file-unreadable")
    files[1].write_bytes(before[2])
    assert refused_with("program-cut-short", "line-unread")
    files[2].write_bytes(before[2].replace(b"v=0.02000", b"v=0.09000").replace(b"= 0.020000", b"= 0.090000"))
    assert refused_with("speed-out-of-range")
    middle = before[1].splitlines(keepends=True)
    files[1].write_bytes(b"".join(middle[:-2]))
    assert refused_with("program-cut-short", "line-unread")
    if name == "ur5e":
        changed = before[1].replace(b"set_tcp(p[0.", b"set_tcp(p[0.1")
        assert changed != before[1]
        files[1].write_bytes(changed)
        assert refused_with("program-cut-short")
        files[1].write_bytes(before[1].replace(b"go on with part 3", b"go on with part 2"))
        assert refused_with("line-unread")
        for part in files[1:]:
            status, _, reported = in_json(capsys, "check", part)
            assert status == 1 and is_reported(reported, "program-cut-short")
        status, _, reported = in_json(capsys, "check", files[1])
        assert is_reported(reported, f"program-cut-short {first.name}")
    else:
        calls = [f"{path.stem}()\r\n".encode() for path in files[1:]]
        first.write_bytes(before[0].replace(calls[0] + calls[1], calls[1] + calls[0]))
        assert refused_with("stroke-order", "program-changed", "line-incomplete", "line-unread")
        first.write_bytes(before[0].replace(calls[1], calls[0]))
        assert refused_with("line-unread")


def test_a_problem_in_a_later_file_names_that_file_and_its_line(job, capsys):
    name, first, _ = job
    later = files_of(first)[2]
    lines = later.read_text().splitlines(keepends=True)
    moved = next(row for row, line in enumerate(lines) if "-0.00" in line or "Z -" in line)
    begun = "".join(lines[: moved + 1])
    faster = begun.replace("v=0.02000", "v=0.09000").replace("= 0.020000", "= 0.090000")
    for changed in ("".join([*lines[:moved], "hello\n"]), faster):
        assert changed != begun
        later.write_text("".join([changed, *lines[moved + 1 :]]))
        status, printed, reported = call(capsys, "check", str(first), str(first.parents[1] / "waves.json"))
        assert status == 1 and f"line {moved + 1} of {later.name}" in f"{printed}{reported}", (name, reported)


def test_files_without_the_end_of_their_last_line_are_sound(job, capsys):
    _, first, _ = job
    for path in files_of(first):
        path.write_bytes(path.read_bytes().rstrip(b"\r\n"))
    status, _, reported = call(capsys, "check", str(first), str(first.parents[1] / "waves.json"))
    assert status == 0, reported


def test_a_called_file_checked_alone_names_the_program_that_calls_it(job, capsys):
    name, first, _ = job
    if name == "kr6-r900":
        for called in files_of(first)[1:]:
            status, _, reported = in_json(capsys, "check", called)
            assert status == 1 and is_reported(reported, f"program-cut-short {first.name}"), reported


def test_a_stroke_with_too_many_lines_is_one_program_with_a_warning(tmp_path, capsys):
    (tmp_path / "a.json").write_text(_core.write_plan(waves(3, 1200)))
    words = "convert", tmp_path / "a.json", "-o", tmp_path / "a.script", "--cell", "ur5e"
    status, _, reported = in_json(capsys, *words)
    assert status == 0 and is_reported(reported, "poses-too-many 1204 1000")
    assert len(files_of(tmp_path / "a.script")) == 3
    assert RUNNABLE in call(capsys, "check", str(tmp_path / "a.script"), str(tmp_path / "a.json"))[1]


@pytest.mark.parametrize(("name", "parts"), [("ur5e", "a-part2.script a-part3.script"), ("kr6-r900", "B.*.src")])
def test_parts_of_an_earlier_job_are_reported(tmp_path, capsys, name, parts):
    output = tmp_path / f"a{LANGUAGES[name]}"
    for strokes in (3, 1):
        (tmp_path / "a.json").write_text(_core.write_plan(waves(strokes, 1200 if name == "ur5e" else 700)))
        status, _, reported = in_json(capsys, "convert", tmp_path / "a.json", "-o", output, "--cell", name)
        assert status == 0
        named = [each for _, each in reported if each.code == "programs-of-before"]
        assert len(named) == (strokes == 1) and all(
            re.search(parts.replace(" ", ", "), each.sentence) for each in named
        )


def test_parts_of_an_earlier_program_for_a_colour_are_reported(tmp_path, capsys):
    output, of_colour = tmp_path / "a.src", tmp_path / "a_1_ff0000.src"
    (tmp_path / "a.json").write_text(_core.write_plan(waves(3, 700)))
    words = "convert", tmp_path / "a.json", "-o", output, "--cell", "kr6-r900"
    assert in_json(capsys, *words)[0] == 0
    output.rename(of_colour)
    (tmp_path / "a.json").write_text(_core.write_plan(waves(1, 100)))
    left_over = sorted(path.name for path in tmp_path.glob("*.src"))
    assert len(left_over) > 1
    status, _, reported = in_json(capsys, *words)
    assert status == 0 and is_reported(reported, f"programs-of-before {' '.join(left_over)}"), reported


@pytest.mark.parametrize(
    "words",
    [["setup", "height"], ["setup", "border", "small.json"], ["setup", "first-run", "ur5e"], ["chart"]],
    ids=["height", "border", "first-run", "chart"],
)
def test_parts_of_an_earlier_job_are_reported_by_all_commands_that_write_programs(words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("small.json").write_text(_core.write_plan(waves(1, 100)))
    Path("long.json").write_text(_core.write_plan(waves(3, 1200)))
    assert call(capsys, "convert", "long.json", "-o", "a.script", "--cell", "ur5e")[0] == 0
    cell = [] if "first-run" in words else ["--cell", "ur5e"]
    status, _, reported = in_json(capsys, *words, "-o", "a.script", *cell)
    assert status == 0 and is_reported(reported, "programs-of-before a-part2.script a-part3.script"), reported


@pytest.mark.thorough
@pytest.mark.parametrize("name", [*MOST, "axidraw-ebb"])
def test_a_page_of_a_thousand_strokes_is_split(name, tmp_path, capsys, monkeypatch):
    from page import STROKES, page

    from brushsvg.read import read_drawing
    from brushsvg.strokes.extraction import strokes

    (tmp_path / "page.svg").write_text(page())
    design = read_drawing(tmp_path / "page.svg")
    plan = _core.compensate(strokes(design)[0], find_brush("round-6"), design.sheet_mm).plan
    assert len(plan.passes) >= STROKES
    (tmp_path / "page.json").write_text(_core.write_plan(plan))
    wide = replace(find_cell(name), name="wide", arm=None)
    wide = replace(wide, workspace=Workspace(wide.workspace.margin_mm, wide.workspace.tilt_limit_deg))
    (tmp_path / "wide.toml").write_text(write_cell(wide))
    words = str(tmp_path / "page.json"), "--cell", str(tmp_path / "wide.toml")
    texts = []
    for folder in ("parts", "whole"):
        path = tmp_path / folder / f"page{LANGUAGES[name]}"
        path.parent.mkdir()
        with monkeypatch.context() as patch:
            if folder == "whole":
                patch.setattr(ebb, "MIN_SLICE_MS", 1)
                for language in language_limits.MAX_PROGRAM_LINES:
                    patch.setitem(language_limits.MAX_PROGRAM_LINES, language, NO_LIMIT)
            status, _, reported = call(capsys, "convert", words[0], "-o", str(path), *words[1:])
            assert status == 0, reported
        texts.append(text_of(files_of(path)))
        if folder == "parts":
            lines = [each.read_bytes().count(b"\n") for each in files_of(path)]
            assert RUNNABLE in call(capsys, "check", str(path), *words)[1]
    if name in MOST:
        assert len(lines) > 10 and max(lines) <= MOST[name]
        parts, whole = (sound(text, wide) for text in texts)
        assert way(parts) == way(whole) and parts.titles == whole.titles
        return
    motors = {"steps_per_mm": wide.motors.steps_per_mm, "servo_pin": wide.motors.servo_pin}
    runs = [run_ebb(text, (0.0, 0.0, 1.0), motors, wide.servo.table) for text in texts]
    assert not any(ran.refused or ran.acts for ran in runs)
    assert min(int(each) for each in re.findall(r"(?m)^SM,(\d+),(?!0,0$)", texts[0])) >= 16
    ends = [{tuple(np.round(leg.end, 6)) for leg in ran.legs} for ran in runs]
    jumps = [[leg._replace(line=0) for leg in ran.legs if leg.kind == "jump"] for ran in runs]
    assert ends[0] <= ends[1] and jumps[0] == jumps[1]
