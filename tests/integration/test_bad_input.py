"""Invalid drawings, brushes and plans give one sentence and exit status 1, and no files."""

import json
import re
import resource

import pytest
from command import LINE, OPEN, SOUND, brush_file, brushsvg, path, refusal, refused
from diagnostics import agrees, is_reported
from sampling import sample

ROOM = 3 << 30  # bytes of address space, so that an entity bomb cannot fill the memory of the machine


def bomb(levels=12):
    entities = ['<!ENTITY a0 "lol">']
    entities += [f'<!ENTITY a{k} "{10 * f"&a{k - 1};"}">' for k in range(1, levels)]
    return f"<!DOCTYPE svg [{''.join(entities)}]>{OPEN}<desc>&a{levels - 1};</desc>{LINE}</svg>"


def flat_bomb():
    return f'<!DOCTYPE svg [<!ENTITY a "{"x" * 100_000}">]>{OPEN}<desc>{"&a;" * 100_000}</desc>{LINE}</svg>'


def bounded(**more):
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (ROOM, ROOM))

    return {"preexec_fn": limit, "timeout_s": 20, **more}


DRAWINGS = {
    "no file": (None, "file-unreadable"),
    "nothing in it": ("", "file-empty"),
    "not XML": ("M 10 10 L 20 20\n", "not-xml 1 1"),
    "a picture": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(100), "not-xml"),
    "cut off": (SOUND[:-40], "not-xml 1"),
    "not SVG": ("<html><body/></html>", "not-svg <html> <svg>"),
    "entity bomb": (bomb(), "xml-entity a1"),
    "flat entity bomb": (flat_bomb(), "xml-entity"),
    "external entity": (
        f'<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///etc/passwd">]>{OPEN}<title>&a;</title>{LINE}</svg>',
        "xml-entity",
    ),
    "external parameter entity": (
        f'<!DOCTYPE svg [<!ENTITY % a SYSTEM "file:///etc/passwd"> %a;]>{OPEN}{LINE}</svg>',
        "xml-entity",
    ),
    "empty drawing": (f"{OPEN}</svg>", "nothing-to-paint"),
    "only text": (
        f'{OPEN}<text id="word" x="9" y="20">Vincent</text></svg>',
        "nothing-to-paint 'word: text' --export-text-to-path",
    ),
    "NaN": (path("M20 40 L60 40 L NaN 20 L90 30"), "geometry-damaged p 17 NaN"),
    "1e30": (path("M20 40 L60 40 L1e30 20 L90 30"), "geometry-out-of-range p 1e6 15"),
    "beyond all numbers": (path("M20 40 L60 40 L1e999 20"), "geometry-out-of-range p 1e6 15"),
    "damaged from the start": (path("M NaN 40 L60 40"), "nothing-to-paint 'p: d' 3"),
    "stroke too wide": (path("M30 30h40", 30), "width-out-of-reach p 30.000 '[0.000, 8.400] mm'"),
    "stroke-width beyond all": (
        path("M30 30h40", "1e30"),
        "nothing-to-paint 'p: its stroke-width' 1e+30 1e6",
    ),
    "off the sheet": (path("M2 30h40", 6), "mark-off-sheet p left"),
    "no size": (SOUND.replace("120mm", "0"), "out-of-range width 0"),
}


@sample("case", DRAWINGS, keep=6)
def test_a_bad_drawing_is_refused_by_every_command(desk, case):
    content, expected = DRAWINGS[case]
    if content is not None:
        (desk / "x.svg").write_bytes(content if isinstance(content, bytes) else content.encode())
    words = ["--picture", "out.png", "--report", "out.txt"]
    file, reported = refusal(desk, "convert", "x.svg", "-o", "out.ngc", *words, **bounded())
    assert file == "x.svg" and agrees(reported, expected), reported
    line = ": ".join(part for part in (file, reported.where, reported.text) if part)
    assert refused(desk, "convert", "x.svg", "-o", "old.ngc", "--force", **bounded()) == line
    if case not in ("NaN", "1e30", "beyond all numbers", "off the sheet"):  # previews show the rest of the drawing
        assert refused(desk, "preview", "x.svg", "-o", "out.svg", **bounded()) == line
        assert refused(desk, "preview", "x.svg", **bounded()) == line


@pytest.mark.parametrize("case", ["NaN", "1e30", "beyond all numbers"])
def test_damaged_geometry_is_drawn_up_to_the_damage_on_request(desk, case):
    (desk / "x.svg").write_text(DRAWINGS[case][0])
    (desk / "whole.svg").write_text(path("M20 40 L60 40"))
    brushsvg("convert", "whole.svg", "-o", "whole.json", cwd=desk, status=0)
    json_reported = ("--messages", "json")
    words = ("convert", "x.svg", "-o", "x.json", "--lenient", "--quiet")
    ((file, reported),) = brushsvg(*json_reported, *words, cwd=desk, status=0, **bounded()).reported
    assert file == "x.svg" and agrees(reported, DRAWINGS[case][1])
    plans = [json.loads((desk / name).read_text()) for name in ("x.json", "whole.json")]
    assert plans[0]["passes"] == plans[1]["passes"]
    brushsvg("convert", "x.svg", "-o", "x.ngc", "--lenient", "--quiet", cwd=desk, status=0)
    assert re.search(r"^\(warnings: 1, 1 ", (desk / "x.ngc").read_text(), re.MULTILINE)
    for words in (("preview", "x.svg", "-o", "x.png", "--quiet"), ("preview", "x.svg")):
        assert brushsvg(*json_reported, *words, cwd=desk, status=0, **bounded()).reported == [(file, reported)]


def test_marks_off_the_sheet_can_be_previewed(desk):
    (desk / "x.svg").write_text(DRAWINGS["off the sheet"][0])
    for words in (("preview", "x.svg", "-o", "x.svg.png", "--quiet"), ("preview", "x.svg", "--json")):
        done = brushsvg("--messages", "json", *words, cwd=desk, status=0)
        assert len(done.err) == 1 and is_reported(done.reported, "mark-off-sheet left", "p")


def test_a_directory_is_refused_as_a_drawing(desk):
    (desk / "x.svg").mkdir()
    (desk / "x.json").mkdir()
    for words in (
        ("convert", "x.svg", "-o", "out.ngc"),
        ("convert", "x.json", "-o", "out.ngc"),
        ("brush", "check", "x.json"),
    ):
        file, reported = refusal(desk, *words)
        assert file.startswith("x.") and file in words and agrees(reported, "file-unreadable"), words


def changed_brush(desk, **changes):
    (desk / "mine.json").write_text(json.dumps({**brush_file("round-6"), **changes}))


BRUSHES = {
    # the article prints p1 = 2.1e-4: the brush would be ahead of its handle at depth 10 mm
    "negative lag": (
        {"lag": {**brush_file("round-6")["lag"], "coefficients": [3.1, 0.86, 0.31, -0.05, 2.1e-4]}},
        "lag",
        "law-negative -5.200 10.00",
    ),
    "unknown version": ({"version": 2}, "version", "version-unknown 2 1"),
    "another format": ({"format": "brushsvg/plan"}, "format", "format-unknown brushsvg/plan"),
    "a law missing": ({"half_width": None}, "half_width", "wrong-type"),
}


@pytest.mark.parametrize("case", BRUSHES)
def test_a_bad_brush_is_refused_by_every_command(desk, case):
    changes, where, expected = BRUSHES[case]
    changed_brush(desk, **changes)
    file, reported = refusal(desk, "brush", "check", "mine.json")
    assert file == "mine.json" and agrees(reported, expected, where), reported
    flags = ["--brush", "mine.json"]
    assert refusal(desk, "convert", "sound.svg", "-o", "out.ngc", *flags) == (file, reported)
    assert refusal(desk, "preview", "sound.svg", "-o", "out.png", *flags) == (file, reported)
    assert refusal(desk, "preview", "sound.svg", *flags) == (file, reported)
    assert refusal(desk, "brush", "show", "mine.json") == (file, reported)


def test_an_unknown_brush_is_refused_with_the_known_brushes(desk):
    file, reported = refusal(desk, "convert", "sound.svg", "-o", "out.ngc", "--brush", "round-7")
    assert file == "round-7" and agrees(reported, "brush-unknown round-7 rigid round-6")
    assert refusal(desk, "brush", "show", "round-7") == (file, reported)
    file, reported = refusal(desk, "convert", "sound.svg", "-o", "out.ngc", "--brush", "gone.json")
    assert (file, reported.code) == ("gone.json", "file-unreadable")


FAR = "geometry-out-of-range 1 line '[-1e6, 1e6] mm'"
PLANS = {  # a change, and the key or stroke that is reported with its code
    "unknown version": (lambda plan: plan.update(version=3), "version", "version-unknown 3 2"),
    "another format": (
        lambda plan: plan.update(format="brushsvg/marks"),
        "format",
        "format-unknown brushsvg/marks",
    ),
    "a brush that is not there": (lambda plan: plan.update(brush="broom"), "brush", "brush-unknown broom"),
    "no passes": (lambda plan: plan.update(passes=[]), "", "nothing-to-paint"),
    "above the paper": (
        lambda plan: plan["passes"][0]["poses_mm"][2].__setitem__(2, 1.0),
        "passes[0].poses_mm[2]",
        "above-paper",
    ),
    "a pose of 1e7 mm": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(0, 1e7),
        "passes[0].poses_mm[1]",
        f"{FAR} 10000000",
    ),
    "a pose of 1e300 mm": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(0, 1e300),
        "passes[0].poses_mm[1]",
        f"{FAR} 1e+300",
    ),
    "a depth of 1e300 mm": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(2, -1e300),
        "passes[0].poses_mm[1]",
        f"{FAR} 1e+300",
    ),
    "too deep for the brush": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(2, -11.0),
        "line",
        "depth-out-of-range 11.000 1 '[0.0, 10.0] mm' round-6",
    ),
    "too fast": (
        lambda plan: plan["passes"][0].update(speed_mm_s=30),
        "line",
        "speed-out-of-range 30 '[0.000001, 25] mm/s' round-6",
    ),
}


@sample("case", PLANS, keep=4)
def test_a_bad_plan_is_refused(desk, case):
    brushsvg("convert", "sound.svg", "-o", "plan.json", cwd=desk, status=0)
    plan = json.loads((desk / "plan.json").read_text())
    change, where, expected = PLANS[case]
    change(plan)
    (desk / "x.json").write_text(json.dumps(plan))
    file, reported = refusal(desk, "convert", "x.json", "-o", "out.ngc", **bounded())
    assert file == "x.json" and agrees(reported, expected, where), reported


@pytest.mark.parametrize("content", ["", "moo", '{"format": "brushsvg/plan", "ver', "[" * 100_000, "\xff\0"])
def test_a_file_that_is_not_a_plan_is_refused(desk, content):
    (desk / "x.json").write_text(content, encoding="latin-1")
    reported = refused(desk, "convert", "x.json", "-o", "out.ngc", **bounded())
    assert reported.startswith("x.json: ")
    refused(desk, "brush", "check", "x.json", **bounded())
