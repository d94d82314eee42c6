"""Names of programs on controllers: KUKA and FANUC find a program by its name, which is that of its file."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command import brushsvg
from diagnostics import is_reported

import brushsvg as package

NAMES = {".src": (r"DEF (\w+)\(\)", "kr6-r900"), ".ls": (r"/PROG  (\w+)", "lrmate200id")}
WORD = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
    '<path d="M 10 20 H 40" fill="none" stroke="black" stroke-width="3"/></svg>'
)


@pytest.fixture
def drawn(tmp_path):
    for name in ("word", "another_word", "another_work", "loop"):
        (tmp_path / f"{name}.svg").write_text(WORD, encoding="utf-8")
    return tmp_path


def name_in(path) -> str:
    return re.match(NAMES[path.suffix][0], path.read_text(encoding="ascii"))[1]


@pytest.mark.parametrize("suffix", NAMES)
def test_a_program_has_the_name_of_its_file(drawn, suffix):
    cell = NAMES[suffix][1]
    brushsvg("convert", "word.svg", "-o", f"word{suffix}", "--cell", cell, cwd=drawn, status=0)
    brushsvg("check", f"word{suffix}", "word.svg", "--cell", cell, cwd=drawn, status=0)
    brushsvg("setup", "border", "word.svg", "-o", f"edge{suffix}", "--cell", cell, cwd=drawn, status=0)
    brushsvg("setup", "first-run", cell, "-o", f"first{suffix}", cwd=drawn, status=0)
    brushsvg("setup", "height", "-o", f"height{suffix}", "--cell", cell, cwd=drawn, status=0)
    brushsvg("chart", "-o", f"chart{suffix}", "--cell", cell, cwd=drawn, status=0)
    for name in ("word", "edge", "first", "height", "chart"):
        assert name_in(drawn / f"{name}{suffix}") == name.upper()
    done = package.convert(drawn / "word.svg", drawn / f"again{suffix}", cell=cell)
    assert name_in(drawn / f"again{suffix}") == "AGAIN"
    assert not [each for each in done.notices if each.code == "program-renamed"]


@pytest.mark.parametrize("suffix", NAMES)
def test_the_programs_of_a_batch_have_different_names(drawn, suffix):
    brushsvg("batch", ".", "-o", "out", "--cell", NAMES[suffix][1], "--jobs", "1", cwd=drawn, status=0)
    programs = sorted((drawn / "out").rglob(f"*{suffix}"))
    assert len(programs) == 4 and len({name_in(path) for path in programs}) == 4


def test_a_name_that_a_controller_does_not_take_is_changed_with_a_warning(drawn):
    for name, suffix in (("loop", ".src"), ("another_word", ".ls"), ("gr\u00fc\u00dfe-1", ".src"), ("1", ".ls")):
        path = drawn / f"{name}{suffix}"
        done = package.convert(drawn / "word.svg", path, cell=NAMES[suffix][1])
        warned = [each for each in done.notices if each.code == "program-renamed"]
        known = name_in(path)
        assert len(warned) == 1 and f"name the file {known}{suffix}" in warned[0].text, (name, done.notices)
        assert known != name.upper() and re.fullmatch("[A-Z][A-Z0-9_]{0,23}", known)
        assert package.check(path, drawn / "word.svg", cell=NAMES[suffix][1]).problems == ()


def test_every_command_reports_a_changed_name(drawn):
    made = (
        ("setup", "first-run", "kr6-r900"),
        ("setup", "height", "--cell", "kr6-r900"),
        ("setup", "border", "word.svg", "--cell", "kr6-r900"),
        ("chart", "--cell", "kr6-r900"),
    )
    for number, words in enumerate(made):
        file = f"no-{number}.src"
        reported = brushsvg("--messages", "json", *words, "-o", file, cwd=drawn, status=0).reported
        assert is_reported(reported, f"program-renamed {name_in(drawn / file)}"), (words, reported)
    plan = package.convert(drawn / "word.svg", formats=(".json",)).plan
    cell = package.find_cell("kr6-r900")
    notices = package.write_program(drawn / "no-4.src", plan, package.find_brush("round-6"), cell=cell)
    assert is_reported(notices, f"program-renamed no-4 {name_in(drawn / 'no-4.src')}"), notices


@pytest.mark.parametrize("suffix", NAMES)
def test_check_reports_a_file_that_was_renamed(drawn, suffix):
    cell = NAMES[suffix][1]
    package.convert(drawn / "word.svg", drawn / f"word{suffix}", cell=cell)
    (drawn / f"word{suffix}").rename(drawn / f"other{suffix}")
    for file in (f"other{suffix}", f"OTHER{suffix.upper()}"):
        (drawn / f"other{suffix}").rename(drawn / file)
        checked = package.check(drawn / file, drawn / "word.svg", cell=cell)
        assert is_reported(checked.notices, f"program-renamed WORD {Path(file).stem} WORD{suffix}"), checked.notices
        (drawn / file).rename(drawn / f"other{suffix}")
    (drawn / f"other{suffix}").rename(drawn / f"Word{suffix}")
    assert not is_reported(package.check(drawn / f"Word{suffix}", cell=cell).notices, "program-renamed")


def test_a_program_next_to_a_plan_has_its_warnings(drawn):
    done = package.convert(drawn / "word.svg", drawn / "no-1.json", formats=(".src",), cell="kr6-r900")
    known = re.match(r"DEF (\w+)", done.texts[".src"])[1]
    assert is_reported(done.notices, f"program-renamed no-1 {known}"), done.notices
    assert is_reported(done.notices, "paper-example")


def test_a_drawing_without_a_file_has_a_name_too():
    done = package.convert(ElementTree.fromstring(WORD), formats=(".src",), cell="kr6-r900")
    assert done.texts[".src"].startswith("DEF BRUSHSVG()")
