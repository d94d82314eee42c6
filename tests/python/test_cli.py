"""The command line: exit status, one line per problem, all files or none."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from shutil import copytree

import pytest
from diagnostics import agrees, gives, heard, in_json, is_reported
from sampling import sample

from brushsvg.cli import commands, main
from brushsvg.cli.console import say
from brushsvg.model.library import SHIPPED
from brushsvg.reporting.report_text import format_overlap

LINE = '<path id="line" d="M20 40 C40 10 60 10 90 30" fill="none" stroke="#203060" stroke-width="3"/>'
DAB = '<path id="dab" d="M97 20h0" stroke="#802010" stroke-width="3"/>'


def drawing(*elements, size='width="120mm" height="60mm" viewBox="0 0 120 60"'):
    body = "".join(elements)
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}><title>A line</title>{body}</svg>'


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A folder with one valid drawing and its plan."""
    folder = tmp_path_factory.mktemp("sound")
    (folder / "a.svg").write_text(drawing(LINE, DAB))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(["convert", "a.svg", "-o", "plan.json"]) == 0
    return folder


@pytest.fixture
def desk(sound, tmp_path, monkeypatch):
    """A copy of this folder, to which tests add invalid files."""
    monkeypatch.chdir(tmp_path)
    copytree(sound, tmp_path, dirs_exist_ok=True)
    return tmp_path


def run(capsys, *argv):
    status = main([str(word) for word in argv])
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    assert all(line.startswith("brushsvg: ") for line in err.splitlines())
    return status, out, err.splitlines()


def listing(directory):
    return {path.name: path.read_bytes() for path in directory.iterdir() if path.is_file()}


def test_convert_writes_program_preview_and_report(desk, capsys):
    words = ["--picture", "p.png", "--report", "r.json"]
    status, out, err = run(capsys, "convert", "a.svg", "-o", "a.ngc", *words)
    code = (desk / "a.ngc").read_text(encoding="ascii")
    assert code.startswith(
        "(title: A line)\n(brush: round-6, 2 strokes)\n(sheet: 120 x 60 mm)\n(compensation: closed, "
    )
    assert "(warnings: 0)" in code
    assert code.index("(stroke 1 of 2: line)") < code.index("(stroke 2 of 2: dab)")
    assert (desk / "p.png").read_bytes().startswith(b"\x89PNG")
    report = json.loads((desk / "r.json").read_text())
    assert [row["stroke"] for row in report["strokes"]] == ["line", "dab"]
    assert report["total"]["overlap"] > 0.9
    time, overlap = re.search(r"\(time: (.*)\)", code)[1], report["total"]["overlap"]
    (line,) = err
    assert (status, out) == (0, f"{report['verdict']}\n")
    assert line.startswith("brushsvg: a.ngc, p.png, r.json: ")
    assert gives(line.partition(";")[2], "2", time.removeprefix("about "), format_overlap(overlap))


WRITERS = {  # Command with its output file: pattern of the text that it prints about the file.
    "convert a.svg -o out.ngc": "2 [a-z]+, [a-z ]+ [0-9]+ s, [a-z ]+",
    "convert a.svg -o out.json": "2 [a-z]+, [a-z ]+ [0-9]+ s",
    "convert plan.json -o out.ngc --from-stroke 2": "1 [a-z]+, [a-z ]+ [0-9]+ s",
    "preview a.svg -o out.png": "2 [a-z]+, [a-z ]+ [0-9]+ s",
    "preview plan.json -o out.svg --cell nowhere.toml": "2 [a-z]+",
    "preview a.svg -o out.html": "2 [a-z]+, [a-z ]+ [0-9]+ s",
    "preview a.svg --show errors -o out.png": r"2 [a-z]+, [a-z ]+ [0-9]+ s, [a-z]+ 0\.[0-9]{3}",
    "check own.ngc a.svg --picture out.png": r"2 [a-z]+, [a-z ]+ [0-9]+ s, [a-z]+ 0\.[0-9]{3}",
    "preview a.svg -o out.png --show strokes": "2 [a-z]+",
    "preview one.svg -o out.svg --show strokes --editable": "1 [a-z]+",
    "text T -o out.svg --font font.svg": "",
    "simulate-photo a.svg -o out.jpg": "5 [a-z]+, [a-z]+",
    "setup border a.svg -o out.ngc": "[a-z ]+ [0-9]+ s",
    "setup height -o out.ngc": "21 [a-z]+, [a-z ]+ [0-9]+ s",
    "chart -o out.ngc --page out.svg --chart out.json --strokes few": "[0-9]+ [a-z]+, [a-z ]+ [0-9] min [0-9]{2} s",
    "brush new -o out.json --lag 5 --width-at 3=2": "",
    "brush plot rigid -o out.svg": "",
    "calibrate m.csv -o out.json": "",
    "cell new -o out.toml": "",
}


@sample("words", WRITERS, keep=6)
@pytest.mark.slow
def test_success_is_one_line_on_stderr_unless_quiet(desk, capsys, words):
    (desk / "one.svg").write_text(drawing(LINE))
    (desk / "font.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><font horiz-adv-x="600"><font-face units-per-em="1000"/>'
        '<glyph unicode="T" d="M 0 700 L 500 700 M 250 700 L 250 0"/></font></svg>'
    )
    rows = [f"{kind},{depth},{slope * depth}" for depth in range(1, 6) for kind, slope in (("lag", 2), ("width", 0.8))]
    (desk / "m.csv").write_text("\n".join(["kind,depth_mm,value_mm", *rows]))
    cell = (Path(commands.__file__).parents[2] / "data" / "cells" / "ur5e.toml").read_text()
    paint = '[reload]\nwhen = "stroke"\n[[stations]]\nname = "red"\nplace_mm = [-50, 50]\ndepth_mm = 5\n'
    (desk / "nowhere.toml").write_text(f'{cell}\n{paint}colours = ["#ff0000"]\n')
    assert run(capsys, "convert", "a.svg", "-o", "own.ngc")[0] == 0
    before = listing(desk)
    status, _, err = run(capsys, *words.split())
    made = {name: data for name, data in listing(desk).items() if name not in before}
    assert status == 0 and made
    *warnings, line = err
    assert not any(": written" in warning for warning in warnings)
    named = ", ".join(dict.fromkeys(word for word in (*words.split(), "out.json") if word in made))
    known = WRITERS[words]
    assert re.fullmatch(re.escape(f"brushsvg: {named}: ") + "[a-z]+" + (f"; {known}" if known else ""), line), line
    for name in made:
        (desk / name).unlink()
    assert run(capsys, *words.split(), "--quiet") == (0, "", warnings)
    assert {name: data for name, data in listing(desk).items() if name not in before} == made


def test_a_plan_gives_the_same_program_as_its_drawing(desk, capsys):
    assert run(capsys, "convert", "a.svg", "-o", "direct.ngc")[0] == 0
    assert run(capsys, "convert", "plan.json", "-o", "by_plan.ngc", "--quiet") == (0, "", [])
    words, numbers = [], []
    for name in ("direct.ngc", "by_plan.ngc"):
        code = re.sub(r"\(.*\)\n", "", (desk / name).read_text())
        words.append(re.findall("[A-Z]", code))
        numbers.append([float(number) for number in re.findall(r"-?\d+\.?\d*", code)])
    assert words[0] == words[1]
    # A plan is rounded, and ties may round either way.
    assert numbers[0] == pytest.approx(numbers[1], abs=1.01e-4)
    plan = json.loads((desk / "plan.json").read_text())
    assert plan["passes"][0]["poses_mm"][0][2] == 0
    assert plan["passes"][0]["poses_mm"][-1][2] == 0


@pytest.mark.parametrize("source", ["a.svg", "plan.json"])
def test_animate_writes_one_page(desk, capsys, source):
    before = set(listing(desk))
    assert run(capsys, "preview", source, "-o", "out.html", "--playback", "5", "--quiet") == (0, "", [])
    assert set(listing(desk)) == before | {"out.html"}
    page = (desk / "out.html").read_text()
    assert page.startswith("<!DOCTYPE html>")
    assert "stroke 2 of 2: dab" in page
    assert '"speed":5.0' in page


@pytest.mark.slow
@pytest.mark.parametrize("source", ["a.svg", "plan.json"])
def test_predict_draws_and_report_prints(desk, capsys, source):
    for suffix, start in ((".png", b"\x89PNG"), (".svg", b"<svg"), (".json", b"{")):
        assert run(capsys, "preview", source, "-o", f"out{suffix}", "--quiet") == (0, "", [])
        assert (desk / f"out{suffix}").read_bytes().startswith(start)
    assert json.loads((desk / "out.json").read_text())["format"] == "brushsvg/marks"
    status, out, err = run(capsys, "preview", source)
    assert (status, err) == (0, [])
    assert len(out.splitlines()) <= 10
    status, out, err = run(capsys, "preview", source, "--json")
    assert [row["stroke"] for row in json.loads(out)["strokes"]] == ["line", "dab"]
    assert json.loads(out)["verdict"]
    assert run(capsys, "preview", source, "--json", "--quiet") == (status, out, err)
    assert run(capsys, "preview", source, "--quiet") == (0, "", [])
    assert (json.loads(out)["total"]["overlap"] is None) == (source == "plan.json")


def test_same_input_gives_the_same_bytes_in_any_folder(desk, capsys):
    (desk / "elsewhere").mkdir()
    (desk / "elsewhere" / "b.svg").write_bytes((desk / "a.svg").read_bytes())
    for name in ("x.ngc", "x.json"):
        assert run(capsys, "convert", "a.svg", "-o", name)[0] == 0
        assert run(capsys, "convert", "elsewhere/b.svg", "-o", f"elsewhere/{name}")[0] == 0
        assert (desk / name).read_bytes() == (desk / "elsewhere" / name).read_bytes()


def test_flags_reach_the_plan(desk, capsys):
    def plan(*flags):
        assert run(capsys, "convert", "a.svg", "-o", "out.json", *flags)[0] == 0
        return json.loads((desk / "out.json").read_text())

    default = plan()
    assert default == plan("--brush", "round-6", "--compensation", "closed", "--tolerance", "0.05")
    assert plan("--brush", str(SHIPPED / "round-6.json")) == default
    assert plan("--sheet", "200x100mm")["sheet_mm"] == [200, 100]
    assert plan("--sheet", "a4")["sheet_mm"] == [210, 297]
    none, constant = plan("--compensation", "none"), plan("--compensation", "constant", "--lag", "5")
    assert none["passes"][0]["poses_mm"][0][:2] == pytest.approx([20, 20])
    assert constant != plan("--compensation", "constant", "--lag", "6") != default
    finer = plan("--tolerance", "0.0005")
    assert len(finer["passes"][0]["poses_mm"]) > len(default["passes"][0]["poses_mm"])


REFUSED = {  # name: (file, its content, flags, reported code, reported file, reported element)
    "no file": ("missing.svg", None, [], "file-unreadable", "missing.svg", ""),
    "no plan file": ("missing.json", None, [], "file-unreadable", "missing.json", ""),
    "not XML": ("x.svg", "moo", [], "not-xml", "x.svg", ""),
    "empty drawing": ("x.svg", drawing(), [], "nothing-to-paint", "x.svg", ""),
    "width out of reach": (
        "x.svg",
        drawing(LINE.replace('"3"', '"30"')),
        [],
        "width-out-of-reach 30.000 [0.000, 8.400]",
        "x.svg",
        "line",
    ),
    "off the sheet": (
        "x.svg",
        drawing(LINE.replace("M20 40", "M-3 40")),
        [],
        "mark-off-sheet left",
        "x.svg",
        "line",
    ),
    "damaged": (
        "x.svg",
        drawing(LINE, '<path id="bad" d="M1 nan" stroke="#000"/>'),
        [],
        "geometry-damaged",
        "x.svg",
        "bad",
    ),
    "unknown brush": ("a.svg", None, ["--brush", "broom"], "brush-unknown broom", "broom", ""),
    "not a plan": (
        "x.json",
        '{"format": "brushsvg/brush", "version": 1}',
        [],
        "format-unknown",
        "x.json",
        "format",
    ),
    "not text": ("x.json", b"\xff\xfe\x00", [], "not-json", "x.json", ""),
    "plan of an unknown version": (
        "x.json",
        '{"format": "brushsvg/plan", "version": 99, "brush": "round-6", "sheet_mm": [9, 9], "passes": []}',
        [],
        "version-unknown 99",
        "x.json",
        "version",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_refusal_is_one_sentence_and_writes_nothing(desk, capsys, case):
    name, content, flags, expected, file, where = REFUSED[case]
    if content is not None:
        (desk / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    before = listing(desk)
    words = ("convert", name, "-o", "out.ngc", "--report", "out.txt", *flags)
    status, out, err = run(capsys, *words)
    assert (status, out, len(err)) == (1, "", 1), err
    status, out, ((about, reported),) = in_json(capsys, *words)
    assert (status, out, about) == (1, "", file) and agrees(reported, expected, where), (about, reported)
    assert err == [": ".join(part for part in ("brushsvg", file, where, reported.text) if part)]
    assert listing(desk) == before


def edited_plan(desk, **changes):
    plan = json.loads((desk / "plan.json").read_text())
    for key, value in changes.items():
        if key in plan:
            plan[key] = value
        else:
            plan["passes"][0][key] = value
    (desk / "x.json").write_text(json.dumps(plan))


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"speed_mm_s": 30}, "speed-out-of-range 30 [0.000001, 25] round-6"),
        ({"poses_mm": [[30, 30, 0], [200, 30, 0]], "arcs": []}, "tool-off-sheet 50.00 right"),
        ({"sheet_mm": [120, 20]}, "mark-off-sheet upper"),
        (
            {"poses_mm": [[30, 30, 0], [50, 30, -12], [60, 30, 0]], "arcs": []},
            "depth-out-of-range 12.000 10.0]",
        ),
    ],
)
def test_a_plan_beyond_limits_is_refused(desk, capsys, changes, expected):
    edited_plan(desk, **changes)
    status, _, reported = in_json(capsys, "convert", "x.json", "-o", "out.ngc")
    assert (status, {file for file, _ in reported}) == (1, {"x.json"})
    assert is_reported(reported, expected, "line"), reported
    assert not (desk / "out.ngc").exists()


def test_a_preview_reports_damage_as_warnings(desk, capsys):
    edited_plan(desk, speed_mm_s=30, sheet_mm=[120, 20])
    status, _, reported = in_json(capsys, "preview", "x.json", "-o", "out.svg")
    assert status == 0
    assert is_reported(reported, "speed-out-of-range 30") and is_reported(reported, "mark-off-sheet upper"), reported
    status, out, _ = run(capsys, "preview", "x.json")
    assert status == 0
    assert gives(out, "line", "30 mm/s")


BAD = '<path id="bad" d="M30 40 L60 45 L nan 4" fill="none" stroke="#000" stroke-width="2"/>'


def test_a_refusal_of_a_damaged_drawing_says_how_to_draw_the_rest(desk, capsys):
    """A refusal of a damaged drawing says how to draw its undamaged parts.

    It is reported once, at the end. No message claims that anything was painted.
    """
    worse = BAD.replace('"bad"', '"worse" transform="turn(3)" stroke-dasharray="2" opacity=".5"')
    off = BAD.replace('"bad" d="M30 40 L60 45 L nan 4"', '"off" d="M-3 30h20"')
    (desk / "x.svg").write_text(drawing(LINE, worse, off))
    status, _, err = run(capsys, "convert", "x.svg", "-o", "out.ngc")
    assert status == 1
    assert [line.split(": ")[2] for line in err] == ["worse", "worse", "worse", "off", "worse", "worse"]
    hint = "; --lenient paints the undamaged part"
    assert err[-1].endswith(hint) and not any(hint in line for line in err[:-1])
    _, reported = in_json(capsys, "convert", "x.svg", "-o", "out.ngc")[2][-1]
    assert agrees(reported, "geometry-damaged 17 'nan 4'", "worse") and reported.damaged
    assert not any(word in line for line in err for word in ("drawn", "painted", "ignored"))
    (desk / "x.svg").write_text(drawing(off))
    assert not any("--lenient" in line for line in run(capsys, "convert", "x.svg", "-o", "out.ngc")[2])


@pytest.mark.slow
def test_damaged_geometry_is_accepted_with_lenient_and_in_previews(desk, capsys):
    (desk / "x.svg").write_text(drawing(LINE, BAD))
    assert run(capsys, "convert", "x.svg", "-o", "out.ngc")[0] == 1
    for words in (("convert", "x.svg", "-o", "out.ngc", "--lenient"), ("preview", "x.svg", "-o", "out.png")):
        status, _, err = run(capsys, *words)
        assert (status, len(err)) == (0, 2)
        assert err[0].startswith("brushsvg: x.svg: bad: ")
        assert err[1].startswith(f"brushsvg: {words[3]}: ")
        assert "--lenient" not in err[0]
    assert re.search(r"^\(warnings: 1, 1 ", (desk / "out.ngc").read_text(), re.MULTILINE)


def test_a_plan_keeps_its_brush(desk, capsys):
    edited_plan(desk, brush_sha256="0" * 64)
    status, _, ((file, reported),) = in_json(capsys, "convert", "x.json", "-o", "out.ngc", "--quiet")
    assert (status, file) == (0, "x.json") and agrees(reported, "plan-of-other-brush round-6", "brush_sha256")
    words = ("preview", "plan.json", "-o", "out.png", "--brush", "rigid", "--compensation", "none")
    (file, reported), *_ = in_json(capsys, *words)[2]
    assert file == "plan.json" and agrees(reported, "flag-without-effect --compensation")
    (desk / "mine.json").write_text("{}")
    edited_plan(desk, brush="mine.json")
    status, _, ((file, reported),) = in_json(capsys, "convert", "x.json", "-o", "out.ngc")
    assert (status, file) == (1, "mine.json") and agrees(reported, "key-missing format")
    edited_plan(desk, brush="my-brush")
    status, _, ((_, reported),) = in_json(capsys, "convert", "x.json", "-o", "out.ngc")
    assert status == 1 and agrees(reported, "brush-unknown my-brush '--brush FILE'", "brush")
    status, _, ((_, reported),) = in_json(capsys, "convert", "x.json", "-o", "out.ngc", "--brush", "round-6", "--quiet")
    assert status == 0 and agrees(reported, "plan-of-other-brush my-brush round-6", "brush")
    edited_plan(desk, brush="Round-6")
    status, _, ((_, reported),) = in_json(capsys, "convert", "x.json", "-o", "out.ngc")
    assert status == 1 and agrees(reported, "brush-unknown Round-6 'did you mean round-6?' '--brush FILE'", "brush")
    edited_plan(desk, brush="7/8 inch")  # the name of a brush is no path
    status, _, ((file, reported),) = in_json(capsys, "convert", "x.json", "-o", "out.ngc")
    assert (status, file) == (1, "x.json") and agrees(reported, "brush-unknown '7/8 inch'", "brush")


@pytest.mark.parametrize(
    "words",
    [
        "",
        "paint a.svg",
        "convert a.svg",
        "convert a.svg -o out.dxf",
        "convert a.pdf -o out.ngc",
        "convert a.svg -o out",
        "convert a.svg -o out.ngc --picture p.gif",
        "convert a.svg -o out.ngc --report r.html",
        "convert plan.json -o plan.json",
        "convert a.svg -o out.ngc --picture a.svg",
        "convert a.svg -o out.json --report ./out.json",
        "convert a.svg -o out.ngc --compensation best",
        "convert a.svg -o out.ngc --comp none",
        "convert a.svg -o out.ngc --lag 5 --compensation closed",
        "convert a.svg -o out.ngc --compensation none --terminals round",
        "preview a.svg --compensation constant --start pointed",
        "batch a.svg -o out --compensation none --end butt",
        "convert a.svg -o out.ngc --compensation constant --lag -1",
        "convert a.svg -o out.ngc --compensation constant --lag nan",
        "convert a.svg -o out.ngc --tolerance 0",
        "convert a.svg -o out.ngc --tolerance -0.1",
        "convert a.svg -o out.ngc --tolerance inf",
        "convert a.svg -o out.ngc --tolerance 1e-300",
        "convert a.svg -o out.ngc --tolerance thick",
        "convert a.svg -o out.ngc --sheet A9",
        "convert a.svg -o out.ngc --sheet 0x10",
        "convert a.svg -o out.ngc --width 0",
        "convert a.svg -o out.ngc --fit 5x5 --scale 2",
        "convert a.svg -o out.ngc --scale 0",
        "convert a.svg -o out.ngc --scale big",
        "convert a.svg -o out.ngc --scale \u0662",  # an Arabic digit two
        "convert a.svg -o out.ngc --origin 5",
        "convert a.svg -o out.ngc --origin 5,1e9",
        "convert a.svg -o out.ngc --units mm",
        "text Hi -o font.svg --font font.svg",
        "preview a.svg -o out.ngc --show strokes",
        "preview a.json -o out.svg --show strokes",
        "convert a.svg -o out.ngc --json",
        "preview a.svg -o out.ngc",
        "preview a.svg -o out.png --all-brushes",
        "preview a.svg -o out.html --playback 0",
        "preview a.svg -o out.html --playback fast",
        "preview a.svg extra",
        "preview a.txt",
        "brush",
        "brush plot round-6 -o out.pdf",
        "calibrate m.csv",
        "calibrate m.csv -o out.svg",
        "calibrate m.svg -o out.json",
        "calibrate m.json -o m.json",
        "calibrate p.jpg --plan w.json -o out.json",
        "calibrate p.jpg --prior round-6 -o out.json",
        "calibrate p.jpg --plan w.json --prior round-6 --chart c.json -o out.json",
        "calibrate m.json --plan w.json --prior round-6 -o out.json",
        "calibrate p.jpg --plan w.json --prior out.json -o out.json",
        "brush show",
        "convert a.svg -o out.json --from-stroke 2",
        "convert a.svg -o out.json --z-offset 0.3",
        "chart -o out.json --z-offset 0.3",
        "convert a.svg -o out.ngc --width=--",
        "convert a.svg -o out.ngc --select=--",
        "setup height -o out.ngc --from=--",
        "chart -o out.ngc --noise=--",
        "calibrate m.csv -o out.json --machine=--",
        "preview a.svg -o out.html --speed=\u0661",
        "preview a.svg -o out.html --speed=1_0",
        "calibrate p.jpg --chart c.json -o out.json --dpi=6_00",
        "calibrate p.jpg --chart c.json -o out.json --height 0",
        "calibrate p.jpg --plan w.json --prior round-6 -o out.json --height 0.05",
        "calibrate m.csv -o out.json --height 0.05",
    ],
)
def test_wrong_usage_is_refused(desk, capsys, words):
    before = listing(desk)
    status, out, err = run(capsys, *words.split())
    assert (status, out, len(err)) == (2, "", 1)
    assert listing(desk) == before


def test_scan_takes_one_picture(desk, capsys):
    assert run(capsys, *"calibrate p.jpg --scan q.jpg --chart c.json -o out.json".split())[0] == 2


@pytest.mark.parametrize(
    ("flag", "expected"),
    [
        ("--origin -5,20", "left"),
        ("--origin -.5cm,20", "left"),
        ("--width -3mm", "-3 mm"),
        ("--z-offset -3e3", "-3000 mm"),
    ],
)
def test_negative_values_are_not_read_as_flags(desk, capsys, flag, expected):
    (desk / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">'
        '<path d="M20 20H60" stroke="#000" stroke-width="4"/></svg>'
    )
    status, _, reported = run(capsys, "convert", "a.svg", "-o", "a.ngc", *flag.split())
    assert status and expected in " ".join(reported)


def test_compare_with_swapped_arguments_reports_their_order(desk, capsys):
    status, _, (reported,) = run(capsys, *"compare drawing.svg photo.jpg".split())
    assert status == 2 and gives(reported, "photo.jpg")


@pytest.mark.parametrize("command", ["convert a.svg", "setup border a.svg", "setup height", "chart"])
@pytest.mark.parametrize(
    ("out", "flags", "cells"),
    [
        ("x.script", "", "ur5e"),
        (
            "x.nc",
            "--cell ur5e",
            "fluidnc-3axis or grbl-3axis or grbl-servo or klipper-3axis or linuxcnc-3axis or marlin-3axis",
        ),
        ("X.SCRIPT", "--cell grbl-servo", "ur5e"),
    ],
)
def test_an_unsupported_program_format_suggests_cells_that_support_it(desk, capsys, command, out, flags, cells):
    status, _, ((file, reported),) = in_json(capsys, *command.split(), "-o", out, *flags.split())
    assert (status, file, reported.advice) == (1, out, "give --cell"), "of this file, not of the drawing"
    assert agrees(reported, f"program-format {Path(out).suffix.lower()} {cells}"), reported
    for cell in cells.split(" or "):  # each of the suggested cells works
        assert run(capsys, "setup", "height", "-o", out, "--cell", cell)[0] == 0


def test_messages_for_programs_are_lines_of_json_with_codes(desk, capsys):
    (desk / "thin.svg").write_text(
        drawing(*(LINE.replace('"3"', f'"0.{k}"').replace("line", f"p{k}") for k in range(1, 6)))
    )
    words = ("convert", "thin.svg", "-o", "x.ngc", "--quiet")
    assert main(["--messages", "json", *words]) == 0
    (reported,) = map(json.loads, capsys.readouterr().err.splitlines())
    assert (reported["file"], reported["code"]) == ("thin.svg", "depth-not-measured")
    assert gives(reported["where"], "p1", "4")
    assert reported["sentence"].endswith(f"; {reported['advice']}") and not reported["damaged"]
    assert run(capsys, *words) == (
        0,
        "",
        [f"brushsvg: thin.svg: {reported['where']}: {reported['sentence']}"],
    )
    (desk / "odd.svg").write_text(drawing(LINE, '<image id="i"/>'))
    (warned,) = json.loads(run(capsys, "preview", "odd.svg", "--json")[1])["warnings"]
    assert (warned["where"], warned["code"]) == ("i", "element-unread")


def test_unwritable_outputs_leave_no_files(desk, capsys):
    (desk / "folder.png").mkdir()
    for words, name in (
        (["convert", "a.svg", "-o", "no/where/out.ngc"], "no/where/out.ngc"),
        (["convert", "a.svg", "-o", "out.ngc", "--picture", "folder.png"], "folder.png"),
        (["convert", "a.svg", "-o", "out.ngc", "--report", "no/where/out.txt"], "no/where/out.txt"),
        (["preview", "a.svg", "-o", "folder.png"], "folder.png"),
        (["preview", "a.svg", "-o", "no/where/out.html"], "no/where/out.html"),
    ):
        before = listing(desk)
        status, _, ((file, reported),) = in_json(capsys, *words)
        assert (status, file, reported.code) == (1, name, "file-unwritable"), reported
        assert listing(desk) == before


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("full", ["out.ngc", "p.png", "r.txt"])
def test_several_outputs_are_written_all_or_none(desk, capsys, full):
    outputs = ["out.ngc", "p.png", "r.txt"]
    for name in outputs:
        if name == full:
            (desk / name).symlink_to("/dev/full")
        else:
            (desk / name).write_text("old")
    before = sorted(os.listdir(desk))
    status, _, ((file, reported),) = in_json(
        capsys,
        "convert",
        "a.svg",
        "-o",
        outputs[0],
        "--picture",
        outputs[1],
        "--report",
        outputs[2],
        "--force",
    )
    assert (status, file) == (1, full) and agrees(reported, "file-unwritable"), reported
    assert all((desk / name).read_text() == "old" for name in outputs if name != full)
    assert sorted(os.listdir(desk)) == before


def test_a_name_cannot_break_the_line_or_the_terminal(capsys):
    say("a.svg", "id\nbrushsvg: done\x1b[2K\x9b31m\u202e", "")
    assert capsys.readouterr().err == "brushsvg: a.svg: id brushsvg: done [2K 31m \n"


def test_a_turn_too_sharp_for_the_brush_causes_a_warning(desk, capsys):
    hairpin = LINE.replace("M20 40 C40 10 60 10 90 30", "M20 30 L90 30 L20 33")
    (desk / "x.svg").write_text(drawing(hairpin))
    status, _, ((_, reported),) = in_json(capsys, "convert", "x.svg", "-o", "out.ngc", "--quiet", "--corners", "turn")
    assert status == 0 and agrees(reported, "off-middle-line 0.05", "line"), reported
    assert re.search(r" \d\.\d+ mm [a-z]+ x \d+\.\d, y \d+\.\d mm", reported.sentence)
    flags = ("--compensation", "none", "--quiet")
    assert run(capsys, "convert", "x.svg", "-o", "out.ngc", *flags) == (0, "", [])


def test_brush_commands(desk, capsys):
    status, out, err = run(capsys, "brush", "list")
    assert (status, err) == (0, [])
    assert [line.split()[0] for line in out.splitlines()] == ["liner-1", "rigid", "round-6", "round-6-angles"]
    status, out, _ = run(capsys, "brush", "show", "round-6")
    assert status == 0
    for words in ("3.1 + 0.86 d + 0.31 d^2 - 0.05 d^3 + 0.0021 d^4", "max(0.126 d, ", "RMSE 0.58", "assumed"):
        assert words in out
    assert run(capsys, "brush", "new", "-o", "own.json", "--lag", "5", "--width-at", "3=2")[0] == 0
    assert run(capsys, "brush", "show", "own.json")[1].count("lines 0.0 to") == 1, "the same line was printed twice"
    for name in ("liner-1", "rigid", "round-6", "round-6-angles"):
        assert run(capsys, "brush", "check", str(SHIPPED / f"{name}.json"))[0] == 0


@pytest.mark.parametrize(
    ("key", "value", "code"),
    [
        ("version", 2, "version-unknown"),
        ("format", "brushsvg/plan", "format-unknown"),
        (
            "lag",
            {"coefficients": [3.1, 0.86, 0.31, -0.05, 0.00021]},
            "law-negative",
        ),  # coefficients as printed in the article
        ("depth_range_mm", [5, 1], "not-ascending"),
    ],
)
def test_every_command_refuses_an_invalid_brush(desk, capsys, key, value, code):
    brush = json.loads((SHIPPED / "round-6.json").read_text())
    brush[key] = value
    (desk / "mine.json").write_text(json.dumps(brush))
    for words in (
        ["brush", "check", "mine.json"],
        ["convert", "a.svg", "-o", "out.ngc", "--brush", "mine.json"],
    ):
        status, out, ((file, reported),) = in_json(capsys, *words)
        assert (status, out, file, reported.code) == (1, "", "mine.json", code)
    assert not (desk / "out.ngc").exists()


def test_ctrl_c_and_internal_errors_show_no_traceback(desk, capsys, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    def fail(*_):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(commands, "preview_report", stop)
    assert run(capsys, "preview", "a.svg") == (130, "", ["brushsvg: interrupted"])
    monkeypatch.setattr(commands, "preview_report", fail)
    status, _, err = run(capsys, "preview", "a.svg")
    assert (status, len(err)) == (1, 1)
    assert err[0].startswith("brushsvg: a.svg: ")


def spawn(*words, **settings):
    """Run the command in a separate process, with its output buffered as for users."""
    env = {key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"}
    return subprocess.run([sys.executable, "-m", "brushsvg", *words], check=False, env=env, **settings)


def test_the_package_runs_as_a_module(desk):
    done = spawn("convert", "a.svg", "-o", "b.svg", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert (done.returncode, done.stdout) == (2, b"")
    assert (
        done.stderr
        == b"brushsvg: b.svg does not end in .json or .ngc or .gcode or .nc or .script or .jks or .mod or .py or .src "
        b"or .lua or .ls or .drl or .csv or .traj or .cdr or .ebb or .hpgl or .plt or .robodk "
        b"(see brushsvg convert --help)\n"
    )
    done = spawn("--version", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (0, b"")
    assert re.fullmatch(rb"brushsvg \d+\.\d+\.\d+\n", done.stdout)


@pytest.mark.slow
@pytest.mark.parametrize(
    "words", ["preview a.svg", "brush list", "brush show rigid", "--version", "--help", "convert --help"]
)
def test_a_closed_stdout_is_reported(desk, words):
    done = spawn(*words.split(), preexec_fn=lambda: os.close(1), stderr=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (1, b"brushsvg: standard output: it is closed\n")


def test_a_command_without_output_needs_no_stdout(desk):
    done = spawn("convert", "a.svg", "-o", "out.ngc", preexec_fn=lambda: os.close(1), stderr=subprocess.PIPE)
    assert done.returncode == 0
    assert re.fullmatch(
        rb"brushsvg: out\.ngc: written; 2 strokes, takes about \d+ s, stops once for another pen\n",
        done.stderr,
    )
    assert (desk / "out.ngc").read_text().endswith("M2\n")


# Ctrl-C comes while the module of the given name is being imported.
STOPPED_AT = """
import os, signal, sys
from importlib.abc import MetaPathFinder
class Stop(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == {name!r}:
            sys.meta_path.remove(self)
            {how}
sys.meta_path.insert(0, Stop())
signal.signal(signal.SIGINT, signal.default_int_handler)
from brushsvg.cli import main
sys.exit(main())
"""
STOP = "os.kill(os.getpid(), signal.SIGINT)"
HIDDEN_STOP = f"""
            try:
                {STOP}
            except KeyboardInterrupt:
                raise ImportError("as a module in C would have it")
"""


@pytest.mark.parametrize("how", [STOP, HIDDEN_STOP], ids=["plain", "hidden"])
@pytest.mark.parametrize(
    "name",
    [
        "brushsvg.cli.console",
        "argparse",
        "brushsvg.cli.arguments",
        "brushsvg.cli.commands",
        "numpy",
        "brushsvg._core",
        "cv2",
    ],
)
@pytest.mark.slow
def test_ctrl_c_during_start_up_shows_no_traceback(desk, name, how):
    code = STOPPED_AT.format(name=name, how=how)
    words = ["convert", "a.svg", "-o", "out.ngc", "--picture", "out.png"]
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "brushsvg: interrupted\n")
    assert not (desk / "out.ngc").exists()


def test_the_previous_ctrl_c_handler_is_restored(capsys):
    def mine(*_):
        pass

    before = signal.getsignal(signal.SIGINT)
    try:
        for handler in (signal.default_int_handler, mine):
            signal.signal(signal.SIGINT, handler)
            assert main(["brush", "list"]) == 0
            assert signal.getsignal(signal.SIGINT) is handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_closed_output_pipe_is_not_an_error(desk):
    read_end, write_end = os.pipe()
    os.close(read_end)
    with os.fdopen(write_end, "wb") as closed:
        done = spawn("preview", "a.svg", stdout=closed, stderr=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_under_stdout_is_reported(desk):
    with open("/dev/full", "wb") as full:
        done = spawn("preview", "a.svg", stdout=full, stderr=subprocess.PIPE)
        as_json = spawn("--messages", "json", "preview", "a.svg", stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == as_json.returncode == 1
    assert done.stderr == b"brushsvg: standard output: no space left on device\n"
    ((file, reported),) = heard(as_json.stderr.decode().splitlines())
    assert file == "standard output" and agrees(reported, "file-unwritable")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize(
    ("words", "status"),
    [("convert a.svg -o out.ngc", 0), ("convert a.svg -o out.svg", 2), ("convert b.svg -o out.ngc", 1)],
)
def test_a_full_disk_under_stderr_changes_nothing(desk, words, status):
    with open("/dev/full", "wb") as full:
        done = spawn(*words.split(), stdout=subprocess.PIPE, stderr=full)
    assert (done.returncode, done.stdout) == (status, b"")
    assert (desk / "out.ngc").exists() == (status == 0)


def test_help_is_fast_and_lists_only_existing_commands(capsys):
    status, out, _ = run(capsys, "convert", "--help-all")
    assert status == 0
    flags = set(re.findall(r"--[a-z-]+", out))
    choices = {
        "--brush",
        "--cell",
        "--compensation",
        "--lag",
        "--tolerance",
        "--terminals",
        "--start",
        "--end",
        "--lenient",
    }
    choices |= {
        "--sheet",
        "--units",
        "--layer",
        "--select",
        "--background",
        "--colour",
        "--pen",
        "--paper-z",
        "--skip-region",
        "--skip-comment",
        "--width",
        "--fit",
        "--scale",
        "--origin",
        "--as",
        "--wide",
        "--corners",
        "--detail",
        "--script",
        "--join",
        "--speed",
    }
    job = {"--z-offset", "--from-stroke", "--order", "--per-colour"}
    assert flags == choices | job | {
        "--corrections",
        "--explain",
        "--help",
        "--help-all",
        "--margin-strokes",
        "--page",
        "--output",
        "--picture",
        "--report",
        "--quiet",
    } | {"--force"}
    code = "import sys; from brushsvg.cli import main; main(['--help']); print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "cv2", "brushsvg._core", "brushsvg.jobs.preparation.preparation"} & set(done.stderr.split())


def test_a_plain_convert_imports_no_large_library(desk):
    """A plain `convert` imports no large library.

    These imports take as long as everything else.
    """
    code = "import sys; from brushsvg.cli import main; main(['convert', 'a.svg', '-o', 'a.ngc']); print(*sys.modules)"
    (desk / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60">'
        '<path d="M20 30h40" stroke="#000" stroke-width="2"/></svg>'
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (desk / "a.ngc").exists()
    assert not {"cv2", "scipy", "shapely", "ezdxf", "svgpathtools", "matplotlib"} & set(done.stdout.split())


def test_cells_are_listed_shown_checked_and_chosen(desk, capsys):
    status, out, err = run(capsys, "cell", "list")
    assert (status, err) == (0, [])
    names = [line.split()[0] for line in out.splitlines()]
    assert {"linuxcnc-3axis", "grbl-3axis"} <= set(names)
    for name in names:
        assert run(capsys, "cell", "show", name)[0] == 0
        status, out, err = run(capsys, "cell", "check", name)
        assert status == 0 and out.startswith(f"{name}: ")
        assert bool(err) == (not name.endswith(("-3axis", "-servo", "-ebb", "-plotter"))), (
            "a robot's paper is an example"
        )
    assert run(capsys, "convert", "a.svg", "-o", "grbl.ngc", "--cell", "grbl-3axis", "--quiet") == (0, "", [])
    lines = (desk / "grbl.ngc").read_text(encoding="ascii").splitlines()
    assert not any(line.startswith("G64") for line in lines)
    assert max(map(len, lines)) <= 70
    text = (Path(commands.__file__).parents[2] / "data" / "cells" / "grbl-3axis.toml").read_text()
    for old, new, where, expected in (
        ("press_mm_s = 6.0", "press_mm_s = 0", "speeds.press_mm_s", "out-of-range 0 '[0.01, 5000]'"),
        ("name =", "nom =", "nom", "key-unknown nom decimals"),
    ):
        (desk / "my.toml").write_text(text.replace(old, new))
        status, out, ((file, reported),) = in_json(capsys, "cell", "check", "my.toml")
        assert (status, out, file) == (1, "", "my.toml") and agrees(reported, expected, where), reported
    (desk / "my.toml").write_text(text.replace("paint_mm_s = 40.0", "paint_mm_s = 9"))
    assert run(capsys, "convert", "a.svg", "-o", "slow.ngc", "--cell", "my.toml", "--quiet") == (0, "", [])
    assert "F540.0" in (desk / "slow.ngc").read_text(), "a slow machine paints slowly"
    (desk / "my.toml").write_text(text.replace("margin_mm = 30.0", "margin_mm = 0.0"))
    status, _, reported = in_json(capsys, "convert", "a.svg", "-o", "x.ngc", "--cell", "my.toml", "--sheet", "96x60")
    assert status == 1 and is_reported(reported, "tool-off-sheet right"), reported
    for cell, expected in (("mine", "cell-unknown mine grbl-3axis"), ("no.toml", "file-unreadable")):
        status, _, ((_, reported),) = in_json(capsys, "convert", "a.svg", "-o", "x.ngc", "--cell", cell)
        assert status == 1 and agrees(reported, expected), reported
    assert not (desk / "x.ngc").exists()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("convrt a.svg b.ngc", "convert"),
        ("brush shw round-6", "show"),
        ("convert a.svg -o b.ngc --brsh round-6", "--brush"),
        ("convert a.svg -o b.ngc --compensation closd", "closed"),
        ("brush show roun-6", "round-6"),
        ("cell show grbl-3axs", "grbl-3axis"),
    ],
)
def test_a_mistyped_name_suggests_the_nearest_name(capsys, words, expected):
    try:
        status = main(words.split())
    except SystemExit as ended:
        status = ended.code
    assert status == (1 if "show" in words else 2)
    assert f" {expected}?" in capsys.readouterr().err


def test_nothing_is_suggested_if_no_name_is_similar(capsys):
    assert main(["brush", "show", "xyz"]) == 1
    assert "?" not in capsys.readouterr().err
