"""The project file is found near a drawing, read strictly, and explained.

The command line and the drawing overrule it.
"""

import copy
import os
import pickle
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
from diagnostics import agrees, gives, in_json, is_reported, refused

import brushsvg
from brushsvg.cli import main
from brushsvg.cli.arguments.parser import command_parser, parse
from brushsvg.jobs.choices.choices import CHOICE_VALUES, CHOICES
from brushsvg.jobs.project import (
    CHOICE_BY_TOP_KEY,
    MAX_BYTES,
    NAME,
    find_project_file,
    list_default_keys,
    write_project,
)

BEGIN = 'format = "brushsvg/project"\nversion = 1\n'
DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="160mm" height="90mm" viewBox="0 0 160 90" fill="none"
 stroke="#203060" stroke-width="3"><path id="a" d="M30 40 C50 20 70 20 90 40"/><path id="b" d="M30 60 H90"/></svg>"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "d.svg").write_text(DRAWING)
    return tmp_path


def project(text: str, folder: str = ".") -> None:
    with open(os.path.join(folder, NAME), "w", encoding="utf-8") as file:
        file.write(BEGIN + text)


def with_settings(**settings) -> str:
    """Return the drawing with settings on its root element."""
    return DRAWING.replace(
        "<svg ",
        "<svg " + " ".join(f'data-brushsvg-{name}="{value}"' for name, value in settings.items()) + " ",
    )


def explained(capsys, *words) -> dict[str, str]:
    """Return the sentence of --explain for each setting."""
    capsys.readouterr()
    status, _, reported = in_json(capsys, *words, "--explain")
    assert status == 0, reported
    return {notice.where: notice.sentence for _, notice in reported if notice.code == "setting-explained"}


def made(*words) -> bytes:
    """Return the program that convert writes for d.svg."""
    assert main(["convert", "d.svg", "-o", "made.script", "--force", "--quiet", *words]) == 0
    with open("made.script", "rb") as file:
        return file.read()


# --- finding the project file


def test_the_nearest_file_above_a_drawing_is_found(desk):
    (desk / "work/letters/old").mkdir(parents=True)
    assert find_project_file("work/letters/a.svg") is None
    for folder in (".", "work", "work/letters"):
        project("", folder)
        assert find_project_file("work/letters/a.svg") == str(desk / folder / NAME).replace("/./", "/")
    assert find_project_file("work/letters/old/a.svg") == str(desk / "work/letters" / NAME)
    assert find_project_file("work") == find_project_file("work/a.svg") == str(desk / "work" / NAME)
    assert brushsvg.find_project("nowhere/a.svg").path == str(desk / NAME)


def test_the_search_stops_at_a_repository_and_at_the_home_folder(desk, monkeypatch):
    (desk / "work/letters").mkdir(parents=True)
    project("")
    (desk / "work/.git").touch()  # .git is a file in a work tree and a folder in a clone
    assert find_project_file("work/letters/a.svg") is None
    project("", "work")
    assert find_project_file("work/letters/a.svg") == str(desk / "work" / NAME)
    (desk / "work" / NAME).unlink()
    (desk / "work/.git").unlink()
    assert find_project_file("work/letters/a.svg") == str(desk / NAME)
    monkeypatch.setenv("HOME", str(desk / "work"))
    assert find_project_file("work/letters/a.svg") is None and brushsvg.find_project("work/letters") is None


def test_a_folder_is_not_a_project_file_and_the_argument_must_be_a_path(desk):
    (desk / NAME).mkdir()
    assert find_project_file("d.svg") is None
    with refused("wrong-type"):
        brushsvg.find_project(3)


# --- reading the project file


def test_paths_are_relative_to_the_project_file_and_names_are_kept(desk):
    (desk / "machines").mkdir()
    (desk / "sub").mkdir()
    assert main(["brush", "new", "-o", "mine.json", "--like", "round-6", "--quiet"]) == 0
    assert main(["cell", "new", "-o", "machines/arm.toml", "--like", "ur5e", "--quiet"]) == 0
    project('brush = "mine.json"\ncell = "machines/arm.toml"')
    found = brushsvg.find_project("sub/d.svg")
    assert found.settings == {"brush": str(desk / "mine.json"), "cell": str(desk / "machines/arm.toml")}
    assert brushsvg.read_project(NAME).settings == {"brush": "mine.json", "cell": "machines/arm.toml"}
    project('brush = "rigid"\ncell = "ur5e"\npaper = "a5"\nlayers = ["Ink", "Red"]')
    assert brushsvg.read_project(NAME).settings == {
        "brush": "rigid",
        "cell": "ur5e",
        "sheet": (148.0, 210.0),
        "layer": ["Ink", "Red"],
    }
    assert brushsvg.read_project(NAME) == pickle.loads(pickle.dumps(copy.copy(brushsvg.read_project(NAME))))


TYPED = {  # option: valid values, and refused values
    "sheet": ("a4 Letter 100x80 8.5x11in", "a9 100 x 0x4"),
    "fit": ("60x40 4x3cm", "a4 60"),
    "origin": ("20,15 2cm,1in -5,0", "20 20,15,3 2e6,0 a,b"),
    "width": ("2 0.1in", "0 2000 wide nan"),
    "lag": ("0 3mm", "-1 1001"),
    "tolerance": ("0.1", "0 11"),
    "z-offset": ("-0.5 1mm", "21"),
    "paper-z": ("-3 10", "1001"),
    "speed": ("15 0.5", "0 5001 fast 15mm"),
    "scale": ("1.5 150% 1e-4", "0 0% 1e5 big%"),
    "colour": ("red #1A237e", "reddish none"),
    "select": ("#ink", ""),
    "skip-region": ("0,0,30,20 30,20,0,0", "0,0,30 a,b,c,d"),
    "skip-comment": ("dip", ""),
    "layer": ("Ink", ""),
}


def test_every_option_is_in_the_project_table():
    flags = {flag for flag, choice in list_default_keys().items() if choice not in CHOICE_VALUES}
    assert flags - {"join"} | {"sheet", "layer"} == set(TYPED)


@pytest.mark.parametrize(
    "flag", [*TYPED, *(flag for flag, choice in list_default_keys().items() if choice in CHOICE_VALUES)]
)
def test_project_values_equal_command_line_values(desk, flag):
    choice = list_default_keys().get(flag, flag)
    good, bad = TYPED.get(flag) or (" ".join(CHOICE_VALUES.get(choice, ())), "nonsense")
    more = ["--compensation", "constant"] if flag == "lag" else []
    key = {"sheet": "paper", "layer": "layers"}.get(flag, flag)

    def in_file(text):
        listed = choice in ("layer", "skip_region", "skip_comment")
        line = f"{key} = ['{text}']" if listed else f"{key} = '{text}'"
        table = "" if key in CHOICE_BY_TOP_KEY else "[defaults]\n" + ("compensation='constant'\n" if more else "")
        project(table + line)
        return brushsvg.read_project(NAME).settings[choice]

    for text in good.split():
        target = getattr(
            parse(["convert", "d.dxf" if flag == "units" else "d.svg", "-o", "o.ngc", f"--{flag}={text}", *more]),
            choice,
        )
        assert in_file(text) == target, text
    for text in bad.split(" "):
        with pytest.raises(SystemExit):
            parse(["convert", "d.svg", "-o", "o.ngc", f"--{flag}={text}", *more])
        with pytest.raises(brushsvg.Error) as reported:
            in_file(text)
        assert reported.value.file == NAME and reported.value.where.endswith(key) and reported.value.code, text


def test_numbers_need_no_quotes(desk):
    project("[defaults]\nspeed = 12\nwidth = 2.5\njoin = true")
    assert brushsvg.read_project(NAME).settings == {"paint_speed": 12.0, "width": 2.5, "join": True}


BAD = {  # text after the format line: code, key, and the values that the sentence names
    'brush = "roun-6"': ("brush-unknown round-6", "brush"),
    'cell = "ur5"': ("cell-unknown ur5e", "cell"),
    'brush = "mine"': ("brush-unknown mine.json", "brush"),
    'brush = "gone.json"': ("file-unreadable gone.json", "brush"),
    'cell = "sub/gone.toml"': ("file-unreadable gone.toml", "cell"),
    "brush = 3": ("brush-unknown 3", "brush"),
    "brush = []": ("wrong-type", "brush"),
    'brush = "a\\u0000.json"': ("file-unreadable", "brush"),
    'bruhs = "rigid"': ("key-unknown brush", "bruhs"),
    'papr = "a4"': ("key-unknown paper", "papr"),
    'sheet = "a4"': ("key-unknown paper", "sheet"),
    "speed = 3": ("key-unknown [defaults]", "speed"),
    'layers = "Ink"': ("wrong-type layers", "layers"),
    "layers = [[]]": ("wrong-type layers", "layers"),
    "defaults = 3": ("wrong-type", "defaults"),
    "[defaults]\nsped = 3": ("key-unknown speed", "defaults.sped"),
    '[defaults]\nbrush = "rigid"': ("key-unknown", "defaults.brush"),
    '[defaults]\nsheet = "a4"': ("key-unknown paper", "defaults.sheet"),
    '[defaults]\ncorrections = "c.json"': ("key-unknown", "defaults.corrections"),
    '[defaults]\npaint_speed = "3"': ("key-unknown", "defaults.paint_speed"),
    "[defaults]\nspeed = 6000": ("out-of-range 6000 5000", "defaults.speed"),
    "[defaults]\nspeed = nan": ("not-a-number", "defaults.speed"),
    "[defaults]\nspeed = true": ("wrong-type", "defaults.speed"),
    "[defaults]\nspeed = 1979-05-27": ("wrong-type", "defaults.speed"),
    "[defaults.speed]\nmm = 3": ("wrong-type", "defaults.speed"),
    '[defaults]\nwidth = "wide"': ("not-a-length", "defaults.width"),
    '[defaults]\nwide = "pases"': ("choice-unknown passes", "defaults.wide"),
    '[defaults]\njoin = "yes"': ("wrong-type", "defaults.join"),
    "[defaults]\nfit = '60x40'\nscale = 2": ("options-contradict", ""),
    "[defaults]\nlag = 3": ("options-contradict", "lag"),
    "[defaults\n": ("not-toml", ""),
    "speed = 3\nspeed = 4": ("not-toml", ""),
    f"{'a.' * 30}b = 1": ("not-toml", ""),
    f"brush = {'[' * 3000}": ("not-toml", ""),
    f"brush = 0x{'f' * 9000}": ("not-toml", ""),
}


@pytest.mark.parametrize("text", BAD, ids=lambda text: repr(text[:30]))
def test_an_invalid_project_file_is_refused_in_one_sentence(desk, capsys, text):
    expected, key = BAD[text]
    (desk / "mine.json").write_text("{}")
    project(text)
    with refused(expected, key) as reported:
        brushsvg.read_project(NAME)
    assert reported.value.file == NAME
    if reported.value.code in ("wrong-type", "out-of-range", "choice-unknown"):
        assert key not in reported.value.sentence  # the message begins with it
    status, _, reported = in_json(capsys, "convert", "d.svg", "-o", "o.ngc")
    ((file, why),) = reported
    assert (status, file) == (1, str(desk / NAME)) and agrees(why, expected, key) and why.refused
    assert "\n" not in why.text and not (desk / "o.ngc").exists()


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"", "format-unknown format"),
        (b'brush = "rigid"', "format-unknown format"),
        (b'format = "brushsvg/cell"\nversion = 1', "format-unknown format"),
        (b'format = "brushsvg/project"', "version-unknown version"),
        (b'format = "brushsvg/project"\nversion = 2', "version-unknown 2"),
        (b'format = "brushsvg/project"\nversion = true', "version-unknown True"),
        (b'format = "brushsvg/project"\nversion = "1\\n2"', "version-unknown '1\\n2'"),
        (b"\xff\xfe", "not-toml"),
        (b"# " + b"x" * MAX_BYTES, f"file-too-large {MAX_BYTES}"),
        (b"x" * MAX_BYTES, "not-toml"),  # refused at once; a search that restarts at each letter takes hours
    ],
)
def test_a_file_that_is_not_a_project_file_is_refused(desk, data, expected):
    (desk / NAME).write_bytes(data)
    with refused(expected):
        brushsvg.read_project(NAME)


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_an_unreadable_project_file_is_refused(desk):
    project("")
    (desk / NAME).chmod(0)
    with refused("file-unreadable"):
        brushsvg.find_project("d.svg")


# --- precedence of settings


def test_settings_come_from_command_line_drawing_project_then_default(desk, capsys):
    project('cell = "ur5e"\n[defaults]\ntolerance = 0.2\ncompensation = "none"')
    of_project = made()
    (desk / NAME).unlink()
    assert made("--cell", "ur5e", "--tolerance", "0.2", "--compensation", "none") == of_project
    project('cell = "ur5e"\n[defaults]\ntolerance = 0.2\ncompensation = "none"')
    (desk / "d.svg").write_text(with_settings(tolerance="0.1mm", compensation="closed"))
    of_drawing, of_line = made(), made("--tolerance", "0.3")
    (desk / NAME).unlink()
    (desk / "d.svg").write_text(DRAWING)
    assert made("--cell", "ur5e", "--tolerance", "0.1") == of_drawing != of_project
    assert made("--cell", "ur5e", "--tolerance", "0.3") == of_line != of_drawing


def test_explain_shows_the_source_of_each_setting(desk, capsys):
    project('cell = "ur5e"\npaper = "a4"\n[defaults]\ntolerance = 0.2\nspeed = 9')
    (desk / "d.svg").write_text(with_settings(tolerance="0.1mm", brush="rigid"))
    lines = explained(capsys, "convert", "d.svg", "-o", "o.script", "--speed", "12", "--detail=fine")
    convert = command_parser()._subparsers._group_actions[0].choices["convert"]
    offered = {action.dest: action for action in convert._actions}
    assert set(lines) == {
        offered[name].option_strings[-1][2:] for name in CHOICES if name in offered and name != "input"
    }
    place = str(desk / NAME)
    expected = {
        "brush": ("rigid", "d.svg"),
        "cell": ("ur5e", place),
        "sheet": ("210x297", place),
        "tolerance": ("0.1", "d.svg"),
        "speed": ("12", "command line"),
        "detail": ("fine", "command line"),
        "compensation": ("closed", "default"),
        "wide": ("auto", "default"),
        "z-offset": ("0", "default"),
        "fit": ("-", "default"),
    }
    assert all(gives(lines[name], *parts) for name, parts in expected.items()), lines
    assert main(["convert", "d.svg", "-o", "o.script", "--force", "--explain"]) == 0
    output, errors = capsys.readouterr()
    assert output == "" and re.search(rf"(?m)^brushsvg: cell +ur5e +{place}$", errors)


def test_explain_works_without_a_project_file(desk, capsys):
    lines = explained(capsys, "convert", "d.svg", "-o", "o.ngc", "--width", "2")
    assert gives(lines["width"], "2", "command line") and gives(lines["cell"], "linuxcnc-3axis", "default")
    project('brush = "rigid"')
    assert main(["convert", "d.svg", "-o", "o.json", "--brush", "round-6", "--quiet"]) == 0
    lines = explained(capsys, "preview", "o.json", "-o", "o.png")
    assert gives(lines["brush"], "default") and not gives(lines["brush"], "rigid")


@pytest.mark.parametrize(
    ("line", "key"),
    [('paper = "xx"', "paper"), ('paper = "0x5"', "paper"), ('[defaults]\nwidth = "x"', "defaults.width")],
)
def test_a_refused_value_is_reported_with_its_key_once(desk, capsys, line, key):
    project(line)
    assert main(["convert", "d.svg", "-o", "o.ngc"]) == 1
    assert capsys.readouterr().err.count(f"{key}: ") == 1


@pytest.mark.parametrize("command", ["setup first-run linuxcnc-3axis -o o.ngc", "setup height -o o.ngc"])
def test_explain_shows_the_default_sheet_of_programs_that_set_up_a_machine(desk, capsys, command):
    assert gives(explained(capsys, *command.split())["sheet"], "200x100", "default")
    project('paper = "a4"')
    assert gives(explained(capsys, *command.split())["sheet"], "210x297", NAME)


def test_a_typed_option_resets_related_project_options(desk, capsys):
    project('[defaults]\nfit = "60x40"\nstart = "pointed"\ncompensation = "constant"\nlag = 3')
    lines = explained(capsys, *"convert d.svg -o o.ngc --scale 0.9 --terminals butt --compensation closed".split())
    assert all(gives(lines[name], "default") for name in ("fit", "start", "lag"))
    assert all(gives(lines[name], "command line") for name in ("scale", "terminals", "compensation"))
    (desk / "d.svg").write_text(with_settings(terminals="round"))
    lines = explained(capsys, "convert", "d.svg", "-o", "p.ngc")
    assert gives(lines["start"], "round", "d.svg") and gives(lines["fit"], "60x40", NAME)
    project('[defaults]\nterminals = "butt"')
    (desk / "d.svg").write_text(with_settings(start="pointed"))
    lines = explained(capsys, "convert", "d.svg", "-o", "r.ngc")
    assert gives(lines["start"], "pointed", "d.svg") and gives(lines["terminals"], "butt", NAME)
    project('[defaults]\ncompensation = "constant"\nlag = 3')
    assert gives(explained(capsys, "convert", "d.svg", "-o", "s.ngc")["lag"], "3", NAME)
    (desk / "d.svg").write_text(with_settings(compensation="closed"))
    assert gives(explained(capsys, "convert", "d.svg", "-o", "q.ngc")["lag"], "default")


def test_a_typed_default_value_counts_as_typed(desk, capsys):
    project("[defaults]\nz-offset = 0.5")
    assert gives(explained(capsys, "convert", "d.svg", "-o", "o.ngc")["z-offset"], "0.5", NAME)
    assert gives(
        explained(capsys, "convert", "d.svg", "-o", "p.ngc", "--z-offset", "0")["z-offset"],
        "0",
        "command line",
    )
    assert gives(explained(capsys, "convert", "d.svg", "-o", "q.ngc", "--z-offset=0")["z-offset"], "0", "command line")
    assert gives(explained(capsys, "convert", "d.svg", "-o", "o.json")["z-offset"], "0", "default")


@pytest.mark.slow
def test_project_settings_that_do_not_apply_to_a_drawing_are_ignored(desk, capsys):
    project('[defaults]\nunits = "in"\npen = "z"\npaper-z = 0\nskip-comment = ["dip"]')
    for command in ("convert d.svg -o o.ngc", "preview d.svg -o o.png --show strokes"):
        status, _, reported = in_json(capsys, *command.split())
        assert status == 0 and not is_reported(reported, "flag-without-effect")
    project('layers = ["Ink"]\n[defaults]\nwidth = 2\nwide = "passes"\ncolour = "red"')
    assert main(["convert", "d.svg", "-o", "o.json", "--colour", "#203060", "--layer", "a", "--quiet"]) == 1
    (desk / NAME).unlink()
    assert main(["convert", "d.svg", "-o", "o.json", "--quiet"]) == 0
    project('layers = ["Ink"]\n[defaults]\nwidth = 2\nwide = "passes"')
    status, _, reported = in_json(capsys, "convert", "o.json", "-o", "again.ngc")
    assert status == 0 and not is_reported(reported, "flag-without-effect")
    project('[defaults]\ncolour = "#203060"\nmargin-strokes = "on"')
    (desk / "d.svg").write_text(DRAWING.replace('id="b"', 'id="b" stroke="#c00000"'))
    assert main(["convert", "d.svg", "-o", "c.ngc", "--per-colour"]) == 0
    assert {path.name for path in desk.glob("c-*")} == {"c-1-c00000.ngc", "c-2-203060.ngc"}


@pytest.mark.slow
def test_a_command_names_only_project_settings_that_it_uses(desk, capsys):
    (desk / "own.svg").write_text(with_settings(cell="linuxcnc-3axis", tolerance="0.2"))
    project('cell = "grbl-3axis"\nbrush = "round-6"\n[defaults]\nfit = "90x60"\nunits = "mm"\nstart = "round"')
    for command, used in (
        ("convert d.svg -o d.ngc", "cell, brush, fit, start"),
        ("convert d.svg -o e.ngc --scale 0.9 --terminals pointed", "cell, brush"),
        ("convert own.svg -o own.ngc", "brush, fit, start"),
        ("convert d.svg -o d.json", "cell, brush, fit, start"),
        ("convert d.json -o plan.ngc", "cell, brush"),
        ("check plan.ngc d.json", "cell, brush unless the program names another"),
        ("check d.ngc d.svg", "fit; cell, brush unless the program names another"),
        ("batch d.svg own.svg -o out", "cell, brush, fit, units, start"),
        ("preview d.svg --all-brushes", "cell, brush, fit, start"),
    ):
        capsys.readouterr()
        assert main(command.split()) == 0, command
        assert f": settings used: {used}; --explain" in capsys.readouterr().err, command
    project('[defaults]\nunits = "mm"')
    assert main("convert d.svg -o d.ngc".split()) == 0
    assert "settings used" not in capsys.readouterr().err


@pytest.mark.slow
def test_a_damaged_brush_of_a_project_is_named(desk, capsys):
    assert main("convert d.svg -o d.json --quiet".split()) == 0
    (desk / "bad.json").write_text("{}")
    project('brush = "bad.json"')
    for extra in ([], ["--explain"]):
        status, _, reported = in_json(capsys, "convert", "d.json", "-o", "d.ngc", *extra)
        assert status == 1 and [(file.split("/")[-1], each.code) for file, each in reported] == [
            ("bad.json", "key-missing")
        ]


@pytest.mark.slow
def test_a_typed_lag_counts_with_the_compensation_of_the_project_or_drawing(desk, capsys):
    command = "convert d.svg -o o.ngc --lag 4"
    assert main([*command.split(), "--compensation", "constant"]) == 0
    program = (desk / "o.ngc").read_bytes()
    status, _, reported = in_json(capsys, *command.split())
    assert status == 1 and is_reported(reported, "options-contradict")
    (desk / "own.svg").write_text(with_settings(compensation="constant"))
    assert main("convert own.svg -o o.ngc --lag 4".split()) == 0
    assert (desk / "o.ngc").read_bytes() == program
    brushsvg.convert("own.svg", "o.ngc", lag=4)
    assert (desk / "o.ngc").read_bytes() == program
    project('[defaults]\ncompensation = "constant"\nlag = 3')
    assert main(["convert", "d.svg", "-o", "p.ngc", "--lag", "4"]) == 0
    assert (desk / "p.ngc").read_bytes() == program
    assert main("batch d.svg -o out --lag 4".split()) == 0
    assert (desk / "out" / "programs" / "d.ngc").read_bytes() == program
    assert main("convert d.svg -o p.ngc --lag 4 --compensation closed".split()) == 2


@pytest.mark.slow
def test_a_batch_in_python_uses_a_project_as_the_command_does(desk):
    project('cell = "grbl-3axis"\npaper = "a4"\n[defaults]\nmargin-strokes = "on"\nspeed = 12\nz-offset = 0.4')
    assert main("batch d.svg -o out --jobs 1".split()) == 0
    program = (desk / "out" / "programs" / "d.ngc").read_bytes()
    with ThreadPoolExecutor(1) as executor:
        brushsvg.batch(["d.svg"], "own", executor=executor, **brushsvg.find_project("d.svg").choices)
    assert (desk / "own" / "programs" / "d.ngc").read_bytes() == program
    assert main("check out/programs/d.ngc d.svg".split()) == 0


def test_a_project_and_a_cell_may_begin_with_a_byte_order_mark(desk):
    assert main("cell new -o machine.toml --like grbl-3axis --quiet".split()) == 0
    project('cell = "machine.toml"')
    for name in (NAME, "machine.toml"):
        (desk / name).write_bytes(b"\xef\xbb\xbf" + (desk / name).read_bytes().replace(b"\n", b"\r\n"))
    assert brushsvg.find_project("d.svg").settings["cell"] == str(desk / "machine.toml")
    assert brushsvg.find_cell("machine.toml").language == "grbl"


def test_a_broken_link_to_a_project_is_refused(desk, capsys):
    (desk / NAME).symlink_to("nowhere.toml")
    status, _, ((file, notice),) = in_json(capsys, "convert", "d.svg", "-o", "o.ngc")
    assert (status, file, notice.code) == (1, str(desk / NAME), "file-unreadable")


@pytest.mark.slow
def test_compare_knows_the_page_of_a_project_with_a_speed(desk, capsys):
    project('brush = "round-6"\n[defaults]\nspeed = 12\ntolerance = 0.1')
    for command in (
        "convert d.svg -o d.json --page page.pdf --quiet",
        "simulate-photo d.json -o sheet.jpg --quiet",
        "compare sheet.jpg d.svg --quiet",
        "compare sheet.jpg d.json --quiet",
    ):
        assert main(command.split()) == 0, command


@pytest.mark.slow
def test_layers_of_a_project_concern_only_drawings_with_layers(desk):
    project('layers = ["Ink"]')
    for command in ("convert d.svg -o d.ngc", "check d.ngc d.svg", "preview d.svg", "batch d.svg -o out"):
        assert main(command.split()) == 0, command
    assert len(brushsvg.convert("d.svg", **brushsvg.find_project("d.svg").choices).plan.passes) == 2
    assert main("convert d.svg -o d.ngc --layer Ink".split()) == 1  # typed
    (desk / "d.svg").write_text(DRAWING.replace("<path", '<g id="Red"><path').replace("/>", "/></g>"))
    assert main("convert d.svg -o d.ngc".split()) == 1  # it has layers, but not this one


@pytest.mark.slow
def test_the_brush_of_a_drawing_or_plan_overrides_the_project(desk, capsys):
    assert main(["brush", "new", "-o", "mine.json", "--like", "round-6", "--quiet"]) == 0
    project('brush = "mine.json"')
    (desk / "d.svg").write_text(with_settings(brush="mine"))  # the name of a brush for which the project has a file
    assert gives(explained(capsys, "convert", "d.svg", "-o", "o.json")["brush"], "mine.json", NAME)
    assert gives(explained(capsys, "preview", "o.json", "-o", "o.png")["brush"], "mine.json", NAME)
    (desk / "d.svg").write_text(with_settings(brush="minne"))
    status, _, reported = in_json(capsys, "convert", "d.svg", "-o", "p.json")
    assert status == 1 and is_reported(reported, "brush-unknown minne")
    (desk / "d.svg").write_text(with_settings(brush="rigid"))
    assert gives(explained(capsys, "convert", "d.svg", "-o", "r.json")["brush"], "rigid", "d.svg")
    status, _, reported = in_json(capsys, "preview", "r.json", "-o", "r.png")
    assert status == 0 and not is_reported(reported, "plan-of-other-brush")


# --- commands with a project file


@pytest.mark.slow
def test_check_uses_the_project_file_of_the_program(desk, capsys, monkeypatch):
    (desk / "job").mkdir()
    (desk / "job/d.svg").write_text(DRAWING)
    assert main(["brush", "new", "-o", "mine.json", "--like", "round-6", "--quiet"]) == 0
    assert main(["cell", "new", "-o", "arm.toml", "--like", "ur5e", "--quiet"]) == 0
    project(
        'brush = "mine.json"\ncell = "arm.toml"\npaper = "a4"\n'
        '[defaults]\nspeed = 9\nterminals = "butt"\nz-offset = 0.3\nwidth = 2.5\ncompensation = "constant"\nlag = "4mm"'
    )
    assert main(["convert", "job/d.svg", "-o", "job/o.script", "--quiet"]) == 0
    assert main(["check", "job/o.script", "job/d.svg"]) == 0
    # The .git folder keeps the search from finding the project file from here.
    (desk / "elsewhere/.git").mkdir(parents=True)
    monkeypatch.chdir(desk / "elsewhere")
    assert main(["check", "../job/o.script"]) == 0
    monkeypatch.chdir(desk)
    choices = brushsvg.find_project("job").choices
    assert brushsvg.check("job/o.script", "job/d.svg", **choices).problems == ()
    made_in_python = brushsvg.convert("job/d.svg", **choices).text
    assert made_in_python == (desk / "job/o.script").read_text()
    assert main(["setup", "border", "job/d.svg", "-o", "job/b.script", "--quiet"]) == 0
    assert main(["check", "job/b.script", "job/d.svg"]) == 0
    (desk / NAME).unlink()
    status, _, reported = in_json(capsys, "check", "job/o.script", "job/d.svg")
    assert status == 1 and is_reported(reported, "cell-unknown arm")


def test_the_program_header_overrides_the_project_in_check(desk, capsys):
    assert main(["convert", "d.svg", "-o", "o.ngc", "--quiet", "--brush", "rigid"]) == 0
    project('brush = "round-6"\ncell = "ur5e"\n[defaults]\nz-offset = 0.5')
    assert main(["check", "o.ngc", "d.svg"]) == 0
    assert main(["check", "o.ngc"]) == 0
    lines = explained(capsys, "check", "o.ngc", "d.svg", "--cell", "linuxcnc-3axis")
    assert gives(lines["brush"], "round-6", NAME, "program") and gives(lines["cell"], "command line")
    (desk / "foreign.gcode").write_text("G21\nG90\nG0 Z5\nG0 X30 Y40\nG1 Z-3 F600\nG1 X80 Y60 F1200\nG0 Z5\nM2\n")
    project('paper = "a4"\n[defaults]\nspeed = 9\nwide = "passes"')
    assert main(["check", "foreign.gcode"]) == 0


@pytest.mark.slow
def test_a_batch_uses_the_project_of_its_first_drawing_and_drawings_override_it(desk, capsys):
    for folder in ("one", "two"):
        (desk / folder).mkdir()
    (desk / "one/a.svg").write_text(DRAWING)
    (desk / "two/b.svg").write_text(with_settings(tolerance="0.1mm"))
    project('cell = "ur5e"\n[defaults]\ntolerance = 0.2', "one")
    project('cell = "grbl-3axis"', "two")
    assert main(["batch", "one/a.svg", "two/b.svg", "-o", "many", "--jobs", "1", "--quiet"]) == 0
    assert {path.name for path in (desk / "many/programs").iterdir()} == {"a.script", "b.script"}
    (desk / "one" / NAME).unlink()
    (desk / "two" / NAME).unlink()
    for name, tolerance in (("one/a", "0.2"), ("two/b", "0.1")):
        assert main(["convert", f"{name}.svg", "-o", f"{name}.script", "--cell", "ur5e", "--tolerance", tolerance]) == 0
        made_by_batch = desk / "many/programs" / f"{name[4:]}.script"
        assert made_by_batch.read_bytes() == (desk / f"{name}.script").read_bytes()
    project('cell = "ur5e"', "one")
    lines = explained(capsys, "batch", "one", "-o", "more", "--jobs", "1")
    assert gives(lines["cell"], "ur5e", str(desk / "one" / NAME))


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "chart -o c.script",
        "setup height -o h.script",
        "setup first-run ur5e -o f.script",
        "chart -o c.script --drawing sub/d.svg",
    ],
)
def test_commands_without_a_drawing_use_the_project_of_the_current_folder(desk, capsys, words):
    (desk / "sub").mkdir()
    (desk / "sub/d.svg").write_text(DRAWING)
    place = "sub" if "sub" in words else "."
    project('brush = "round-6-angles"\ncell = "ur5e"\npaper = "a5"\n[defaults]\nspeed = 9', place)
    lines = explained(capsys, *words.split())
    assert gives(lines["sheet"], "148x210", NAME) and gives(lines["brush"], "round-6-angles", NAME)
    assert gives(lines.get("cell", f"ur5e {NAME}"), "ur5e", NAME)
    program = next(desk.glob("*.script")).read_text()
    assert "round-6-angles" in program and "148" in program


def test_cell_place_uses_the_project_and_names_only_settings_that_it_uses(desk, capsys):
    """`cell place` once ignored the project file, and so it placed another job than `convert` paints."""
    project('brush = "round-6-angles"\ncell = "xarm6"\npaper = "a5"\n[defaults]\nfit = "90x60"\nspeed = 9')
    for words, used, fit in (("", "brush, sheet", "-"), (" d.svg", "brush, sheet, fit", f"90x60 {NAME}")):
        capsys.readouterr()
        assert main(f"cell place ur5e{words}".split()) == 0
        assert f": settings used: {used}; --explain" in capsys.readouterr().err
        lines = explained(capsys, *f"cell place ur5e{words}".split())
        assert gives(lines["sheet"], "148x210", NAME) and gives(lines["brush"], "round-6-angles", NAME)
        assert gives(lines["fit"], *fit.split()) and "cell" not in lines


def test_a_comparison_of_brushes_includes_the_project_brush(desk, capsys):
    assert main(["brush", "new", "-o", "mine.json", "--like", "round-6", "--quiet"]) == 0
    project('brush = "mine.json"')
    (desk / "d.svg").write_text(with_settings(brush="rigid"))
    capsys.readouterr()
    assert main(["preview", "d.svg", "--all-brushes"]) == 0
    assert re.search(r"(?m)^mine ", capsys.readouterr().out)
    assert main(["preview", "d.svg"]) == 0
    assert "mine" not in capsys.readouterr().out
    # --all-brushes lists all brushes, not the drawing's brush only.
    (desk / "d.svg").write_text(with_settings(brush="unknown"))
    assert main(["preview", "d.svg", "--all-brushes"]) == 0


def test_every_command_with_a_drawing_supports_explain():
    commands = dict(command_parser()._subparsers._group_actions[0].choices)
    for group in ("setup", "cell"):
        choices = commands[group]._subparsers._group_actions[0].choices
        commands |= {f"{group} {name}": command for name, command in choices.items()}
    offers = {name for name, command in commands.items() if "--explain" in command._option_string_actions}
    assert offers >= {
        "convert",
        "preview",
        "setup border",
        "batch",
        "compare",
        "check",
    }
    assert offers >= {"simulate-photo", "chart", "setup height", "setup first-run", "cell place"}


def test_project_settings_are_reported_unless_quiet(desk, capsys):
    project('cell = "ur5e"\n[defaults]\nz-offset = 0.5')
    capsys.readouterr()
    assert main(["convert", "d.svg", "-o", "o.script"]) == 0
    (line,) = [line for line in capsys.readouterr().err.splitlines() if NAME in line]
    assert str(desk / NAME) in line and gives(line, "cell", "z-offset")
    assert main(["convert", "d.svg", "-o", "o.script", "--cell", "ur5e", "--z-offset", "0.5"]) == 0
    assert NAME not in capsys.readouterr().err
    assert main(["convert", "d.svg", "-o", "o.script", "--quiet"]) == 0
    assert NAME not in capsys.readouterr().err


# --- the init command


def test_init_without_a_terminal_uses_flags_as_answers(desk, capsys):
    status, _, _ = in_json(capsys, "init")
    assert status == 2 and not (desk / NAME).exists()
    (desk / "w").mkdir()
    assert main(["brush", "new", "-o", "mine.json", "--like", "round-6", "--quiet"]) == 0
    words = "init -o w/brushsvg.toml --cell grbl-3axis --brush mine.json --sheet 300x200 --speed 12"
    assert main(words.split()) == 0
    found = brushsvg.read_project(desk / "w" / NAME)
    assert found.settings["cell"] == "grbl-3axis" and found.settings["sheet"] == (300.0, 200.0)
    assert found.settings["paint_speed"] == 12.0
    assert os.path.samefile(found.settings["brush"], "mine.json")
    status, _, reported = in_json(capsys, *words.split())
    assert status == 1 and is_reported(reported, "file-exists --force")
    assert main([*words.split(), "--force", "--brush", "none"]) == 0
    assert "brush" not in brushsvg.read_project(desk / "w" / NAME).settings
    for more, code in (
        ("--cell ur5", "cell-unknown ur5e"),
        ("--cell=", "cell-unknown"),  # as with "$CELL" of a shell; it was once the default cell
        ("--cell ur5e --brush=", "brush-unknown"),
        ("--cell ur5e --brush roun-6", "brush-unknown round-6"),
        ("--cell ur5e --brush mine.json --speed 300", "speed-out-of-range 300 mine 25"),
    ):
        status, _, reported = in_json(capsys, "init", *more.split())
        assert status == 1 and is_reported(reported, code)
    assert main("init --cell ur5e -o other.toml".split()) == 2
    assert main("init --cell ur5e --sheet a9".split()) == 2
    assert {path.name for path in desk.iterdir() if path.is_file()} == {"d.svg", "mine.json"}
    assert main("init --cell ur5e".split()) == 0
    assert brushsvg.read_project(desk / NAME).settings == {"cell": "ur5e"}, "each drawing keeps its page"


def at_terminal(folder, *words, answers: str) -> tuple[int, str]:
    """Return the exit status and everything that a terminal shows."""
    pty = pytest.importorskip("pty")
    terminal, its_end = pty.openpty()
    os.write(terminal, answers.encode())
    done = subprocess.Popen(
        [sys.executable, "-m", "brushsvg", *words], cwd=folder, stdin=its_end, stdout=its_end, stderr=its_end
    )
    os.close(its_end)
    shown = b""
    try:
        while part := os.read(terminal, 65536):
            shown += part
    except OSError:
        pass
    os.close(terminal)
    return done.wait(), shown.decode()


@pytest.mark.slow
def test_init_asks_four_questions_each_with_a_default(desk):
    status, shown = at_terminal(desk, "init", answers="\n\n\n\n")
    assert status == 0 and len(re.findall(r"\[[^\[\]]+\]: ", shown)) == 4
    assert brushsvg.read_project(desk / NAME).settings == {"cell": "linuxcnc-3axis"}
    status, shown = at_terminal(desk, "init", answers="\n\n\n\n")
    # The file exists already, so init asks no questions.
    assert status == 1 and not re.search(r"\[[^\[\]]+\]: ", shown)
    status, shown = at_terminal(desk, "init", "--force", answers="ur5\nur5e\nroun-6\nrigid\na9\na5\nfast\n900\n12,5\n")
    assert status == 0 and len(re.findall(r"\[[^\[\]]+\]: ", shown)) == 9
    assert gives(shown, "ur5e", "round-6")
    assert brushsvg.read_project(desk / NAME).settings == {
        "brush": "rigid",
        "cell": "ur5e",
        "sheet": (148.0, 210.0),
        "paint_speed": 12.5,
    }
    status, shown = at_terminal(desk, "init", "--force", *"--cell ur5e --brush none --sheet a4".split(), answers="7\n")
    assert status == 0 and brushsvg.read_project(desk / NAME).settings["paint_speed"] == 7.0
    before = (desk / NAME).read_bytes()
    status, shown = at_terminal(desk, "init", "--force", answers="ur5e\n\x04")
    assert status == 1 and (desk / NAME).read_bytes() == before


def test_the_file_written_by_init_can_be_completed(desk):
    (desk / "mine.json").write_text("{}")
    (desk / "machine.toml").write_text("")
    text = write_project()
    (desk / NAME).write_text(re.sub(r"(?m)^# (?=[a-z]+ = )", "", text))
    assert set(brushsvg.read_project(NAME).settings) == {*CHOICE_BY_TOP_KEY.values(), "paint_speed", "detail"}


# --- setting names


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("conver d.svg o.ngc", "convert"),
        ("convert d.svg -o o.ngc --bursh rigid", "--brush"),
        ("convert d.svg -o o.ngc --explane", "--explain"),
        ("convert d.svg -o o.ngc --brush roun-6", "round-6"),
        ("convert d.svg -o o.ngc --cell ur5", "ur5e"),
        ("convert d.svg -o o.ngc --wide pases", "passes"),
        ("convert said.svg -o o.ngc", "rigid"),
    ],
)
def test_a_misspelled_name_suggests_the_nearest_name(desk, capsys, words, expected):
    (desk / "said.svg").write_text(with_settings(brush="rigd"))
    assert main(words.split()) in (1, 2)
    assert gives(capsys.readouterr().err, "did you mean", f"{expected}?")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('brushh = "rigid"', "brush"),
        ('papr = "a4"', "paper"),
        ("sped = 3", "speed"),
        ("[defaults]\nsped = 3", "speed"),
        ('[defaults]\nwide = "pases"', "passes"),
        ('brush = "roun-6"', "round-6"),
        ('cell = "grbl-3axs"', "grbl-3axis"),
    ],
)
def test_a_misspelled_name_in_the_file_suggests_the_nearest_name(desk, text, expected):
    project(text)
    with pytest.raises(brushsvg.Error) as reported:
        brushsvg.read_project(NAME)
    assert gives(reported.value.sentence, "did you mean", f"{expected}?")


def completions(line: str) -> list[str]:
    """Return the completions that a shell gets for a line."""
    pytest.importorskip("argcomplete")
    env = os.environ | {
        "_ARGCOMPLETE": "1",
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "COMP_TYPE": "9",
    }
    env |= {"_ARGCOMPLETE_IFS": "\n", "_ARGCOMPLETE_STDOUT_FILENAME": os.path.abspath("completed.txt")}
    code = "import sys; from brushsvg.cli import main; sys.argv[0] = 'brushsvg'; sys.exit(main())"
    subprocess.run([sys.executable, "-c", code], env=env, check=True, capture_output=True)
    with open("completed.txt", encoding="utf-8") as file:
        return [word.strip() for word in file.read().split("\n")]


@pytest.mark.slow
def test_a_shell_completes_commands_options_brushes_and_cells(desk):
    (desk / "rigid-mine.json").touch()
    (desk / "rigid.txt").touch()
    assert completions("brushsvg con") == ["convert"]
    assert completions("brushsvg convert d.svg --bru") == ["--brush"]
    assert completions("brushsvg convert d.svg -o o.ngc --brush ri") == ["rigid", "rigid-mine.json"]
    assert completions("brushsvg check o.ngc --cell ur") == ["ur10e", "ur3e", "ur5e"]
    assert completions("brushsvg cell show grbl-s") == ["grbl-servo"]
    assert completions("brushsvg convert d.svg -o o.ngc --wide pa") == ["passes"]


def test_completion_is_loaded_only_when_a_shell_asks(desk):
    code = "import sys; from brushsvg.cli import main; main(['convert', '--help']); print('argcomplete' in sys.modules)"
    env = {name: value for name, value in os.environ.items() if name != "_ARGCOMPLETE"}
    done = subprocess.run([sys.executable, "-c", code], env=env, check=True, capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "False"
