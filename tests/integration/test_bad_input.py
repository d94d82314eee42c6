"""Drawings, brushes and plans with something wrong: one sentence, exit status 1, nothing written."""

import json
import re
import resource

import pytest
from command import LINE, OPEN, SOUND, brush_file, brushsvg, path, refused

ROOM = 3 << 30  # bytes of address space: a bomb that goes off must not take the machine with it


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
    "no file": (None, r"there is no such file"),
    "nothing in it": ("", r"the file is empty"),
    "not XML": ("M 10 10 L 20 20\n", r"this is not XML: .* line 1, column 1"),
    "a picture": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(100), r"this is not XML"),
    "cut off": (SOUND[:-40], r"this is not XML: .* line 1, column \d+"),
    "not SVG": ("<html><body/></html>", r"the root element is <html>, not <svg>"),
    "entity bomb": (bomb(), r"entity 'a1' is built from other entities"),
    "flat entity bomb": (flat_bomb(), r"could grow to \d+ characters, beyond the limit of \d+"),
    "external entity": (
        f'<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///etc/passwd">]>{OPEN}<title>&a;</title>{LINE}</svg>',
        r"entity 'a' lies in another file",
    ),
    "external parameter entity": (
        f'<!DOCTYPE svg [<!ENTITY % a SYSTEM "file:///etc/passwd"> %a;]>{OPEN}{LINE}</svg>',
        r"entity 'a' lies in another file",
    ),
    "empty drawing": (f"{OPEN}</svg>", r"the drawing holds nothing to paint"),
    "only text": (
        f'{OPEN}<text id="word" x="9" y="20">Vincent</text></svg>',
        r"nothing to paint.*word: text is not read.*--export-text-to-path",
    ),
    "NaN": (path("M20 40 L60 40 L NaN 20 L90 30"), r"p: d is damaged at character 17: found 'NaN 20"),
    "1e30": (path("M20 40 L60 40 L1e30 20 L90 30"), r"p: d leads beyond 1e6 mm at character 15"),
    "beyond all numbers": (path("M20 40 L60 40 L1e999 20"), r"p: d leads beyond 1e6 mm at character 15"),
    "damaged from the start": (path("M NaN 40 L60 40"), r"nothing to paint.*p: d is damaged at character 3"),
    "stroke too wide": (
        path("M30 30h40", 30),
        r"p: width 30\.0+ mm is outside the range \[0\.0+, 8\.40+\] mm",
    ),
    "stroke-width beyond all": (path("M30 30h40", "1e30"), r"p: its stroke-width 1e\+30 mm is beyond 1e6 mm"),
    "off the sheet": (
        path("M2 30h40", 6),
        r"p: the mark reaches 1\.\d\d mm beyond the left edge of the sheet",
    ),
    "no size": (SOUND.replace("120mm", "0"), r"width"),
}


@pytest.mark.parametrize("case", DRAWINGS)
def test_a_bad_drawing_is_refused_by_every_command(desk, case):
    content, sentence = DRAWINGS[case]
    if content is not None:
        (desk / "x.svg").write_bytes(content if isinstance(content, bytes) else content.encode())
    words = ["--preview", "out.png", "--report", "out.txt"]
    told = refused(desk, "convert", "x.svg", "out.ngc", *words, **bounded())
    assert re.match(r"x\.svg: .*" + sentence, told), told
    assert refused(desk, "convert", "x.svg", "old.ngc", **bounded()) == told
    if case not in ("NaN", "1e30", "beyond all numbers", "off the sheet"):  # there one may look at the rest
        assert refused(desk, "predict", "x.svg", "out.svg", **bounded()) == told
        assert refused(desk, "report", "x.svg", **bounded()) == told


@pytest.mark.parametrize("case", ["NaN", "1e30", "beyond all numbers"])
def test_damaged_geometry_is_drawn_up_to_there_on_request(desk, case):
    (desk / "x.svg").write_text(DRAWINGS[case][0])
    (desk / "whole.svg").write_text(path("M20 40 L60 40"))
    brushsvg("convert", "whole.svg", "whole.json", cwd=desk, status=0)
    done = brushsvg("convert", "x.svg", "x.json", "--lenient", "--quiet", cwd=desk, status=0, **bounded())
    assert len(done.err) == 1
    assert re.match(r"brushsvg: x\.svg: " + DRAWINGS[case][1], done.err[0])
    plans = [json.loads((desk / name).read_text()) for name in ("x.json", "whole.json")]
    assert plans[0]["passes"] == plans[1]["passes"]
    done = brushsvg("convert", "x.svg", "x.ngc", "--lenient", "--quiet", cwd=desk, status=0)
    assert "(warnings: 1, 1 of them damaged geometry)" in (desk / "x.ngc").read_text()
    for words in (("predict", "x.svg", "x.png", "--quiet"), ("report", "x.svg")):
        again = brushsvg(*words, cwd=desk, status=0, **bounded())
        assert again.err == done.err


def test_what_lies_off_the_sheet_may_be_looked_at(desk):
    (desk / "x.svg").write_text(DRAWINGS["off the sheet"][0])
    for words in (("predict", "x.svg", "x.svg.png", "--quiet"), ("report", "x.svg", "--json")):
        done = brushsvg(*words, cwd=desk, status=0)
        assert len(done.err) == 1
        assert "beyond the left edge of the sheet" in done.err[0]


def test_a_directory_is_no_drawing(desk):
    (desk / "x.svg").mkdir()
    (desk / "x.json").mkdir()
    assert refused(desk, "convert", "x.svg", "out.ngc").startswith("x.svg: this is a directory")
    assert re.match(r"x\.json: .*directory", refused(desk, "convert", "x.json", "out.ngc"))
    assert re.match(r"x\.json: .*directory", refused(desk, "brush", "check", "x.json"))


def changed_brush(desk, **changes):
    (desk / "mine.json").write_text(json.dumps({**brush_file("round-6"), **changes}))


BRUSHES = {
    # the article prints p1 = 2.1e-4: the brush would be ahead of its handle at depth 10 mm
    "negative lag": (
        {"lag": {**brush_file("round-6")["lag"], "coefficients": [3.1, 0.86, 0.31, -0.05, 2.1e-4]}},
        r"mine\.json: lag: the lag is -5\.20* mm at depth 10\.0* mm",
    ),
    "unknown version": ({"version": 2}, r"mine\.json: version: version 2 .*reads version 1"),
    "another format": ({"format": "brushsvg/plan"}, r"mine\.json: format: .*brushsvg/plan"),
    "a law missing": ({"half_width": None}, r"mine\.json: half_width"),
}


@pytest.mark.parametrize("case", BRUSHES)
def test_a_bad_brush_is_refused_by_every_command(desk, case):
    changes, sentence = BRUSHES[case]
    changed_brush(desk, **changes)
    told = refused(desk, "brush", "check", "mine.json")
    assert re.match(sentence, told), told
    flags = ["--brush", "mine.json"]
    assert refused(desk, "convert", "sound.svg", "out.ngc", *flags) == told
    assert refused(desk, "predict", "sound.svg", "out.png", *flags) == told
    assert refused(desk, "report", "sound.svg", *flags) == told
    assert refused(desk, "brush", "show", "mine.json") == told


def test_an_unknown_brush_is_refused_with_those_there_are(desk):
    told = refused(desk, "convert", "sound.svg", "out.ngc", "--brush", "round-7")
    assert re.match(r"round-7: brush 'round-7' is not known; known are .*rigid.*round-6", told)
    assert refused(desk, "brush", "show", "round-7") == told
    told = refused(desk, "convert", "sound.svg", "out.ngc", "--brush", "gone.json")
    assert re.match(r"gone\.json: .*no such file", told)


PLANS = {
    "unknown version": (lambda plan: plan.update(version=2), r"version: version 2 .*reads version 1"),
    "another format": (lambda plan: plan.update(format="brushsvg/marks"), r"format: .*brushsvg/marks"),
    "a brush that is not there": (lambda plan: plan.update(brush="broom"), r".*'broom' is not known"),
    "no passes": (lambda plan: plan.update(passes=[]), r"there is nothing to paint"),
    "above the paper": (
        lambda plan: plan["passes"][0]["poses_mm"][2].__setitem__(2, 1.0),
        r".*poses_mm\[2\]",
    ),
    "a pose of 1e7 mm": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(0, 1e7),
        r"passes\[0\]\.poses_mm\[1\]: pose 1 of stroke line has a coordinate of 10000000 mm, outside \[-1e6, 1e6\] mm",
    ),
    "a pose of 1e300 mm": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(0, 1e300),
        r"passes\[0\]\.poses_mm\[1\]: pose 1 of stroke line has a coordinate of 1e\+300 mm, outside \[-1e6, 1e6\] mm",
    ),
    "a depth of 1e300 mm": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(2, -1e300),
        r"passes\[0\]\.poses_mm\[1\]: pose 1 of stroke line has a coordinate of 1e\+300 mm, outside \[-1e6, 1e6\] mm",
    ),
    "too deep for the brush": (
        lambda plan: plan["passes"][0]["poses_mm"][1].__setitem__(2, -11.0),
        r"line: depth 11\.0+ mm of pose 1 is outside the range \[0\.0+, 10\.0+\] mm of brush round-6",
    ),
    "too fast": (
        lambda plan: plan["passes"][0].update(speed_mm_s=30),
        r"line: speed 30 mm/s is outside the range \[0\.000001, 25\.0\] mm/s of brush round-6",
    ),
}


@pytest.mark.parametrize("case", PLANS)
def test_a_bad_plan_is_refused(desk, case):
    brushsvg("convert", "sound.svg", "plan.json", cwd=desk, status=0)
    plan = json.loads((desk / "plan.json").read_text())
    change, sentence = PLANS[case]
    change(plan)
    (desk / "x.json").write_text(json.dumps(plan))
    told = refused(desk, "convert", "x.json", "out.ngc", **bounded())
    assert re.match(r"x\.json: " + sentence, told), told


@pytest.mark.parametrize("content", ["", "moo", '{"format": "brushsvg/plan", "ver', "[" * 100_000, "\xff\0"])
def test_what_is_no_plan_at_all_is_refused(desk, content):
    (desk / "x.json").write_text(content, encoding="latin-1")
    told = refused(desk, "convert", "x.json", "out.ngc", **bounded())
    assert told.startswith("x.json: ")
    refused(desk, "brush", "check", "x.json", **bounded())
