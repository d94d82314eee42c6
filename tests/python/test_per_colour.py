"""One program for each colour, with strokes where the whole drawing has them."""

import re

import pytest
from diagnostics import in_json, is_reported

import brushsvg

INKS = {"#ffd700": "bd", "#d32f2f": "e", "#1a237e": "ac"}  # the lightest colour first
DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60" fill="none" '
    'stroke-width="2">{}</svg>'
)


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    inks = {name: ink for ink, names in INKS.items() for name in names}
    lines = (f'<path id="{name}" stroke="{inks[name]}" d="M10 {8 + 8 * k}H50"/>' for k, name in enumerate("abcde"))
    (tmp_path / "word.svg").write_text(DRAWING.format("".join(lines)))
    return tmp_path


def names(text):
    return "".join(re.findall(r"(?m)^\(stroke \d+ of \d+: (\w+)\)", text))


def test_each_colour_gets_its_own_program(desk, capsys):
    status, _, reported = in_json(
        capsys, "convert", "word.svg", "-o", "out.ngc", "--per-colour", "--picture", "all.png"
    )
    assert status == 0 and not reported
    files = sorted(path.name for path in desk.glob("out*"))
    assert files == [f"out-{k}-{ink[1:]}.ngc" for k, ink in enumerate(INKS, 1)]
    assert [names((desk / file).read_text()) for file in files] == [*INKS.values()]
    assert (desk / "all.png").stat().st_size > 1000
    for file, ink in zip(files, INKS, strict=True):
        assert in_json(capsys, "check", file, "word.svg", "--colour", ink)[0] == 0
        one = brushsvg.convert("word.svg", colour=ink)
        assert one.text == (desk / file).read_text(), "the same by --colour and from Python"
        assert brushsvg.convert("word.svg", colour=ink[1:]).text == one.text, "as in the name of the file"
        status, _, reported = in_json(capsys, "check", file, "word.svg")
        assert status == 1 and {each.code for _, each in reported} == {"stroke-not-painted"}
        assert all(f"--colour '{ink}'" in each.advice for _, each in reported)


def test_strokes_of_one_colour_keep_their_positions(desk, capsys):
    """Strokes of one colour have the positions that they have in the whole drawing.

    If --fit were applied to each colour alone, each would fill the sheet.
    """
    words = "convert", "word.svg", "-o", "all.json", "--fit", "80x40"
    assert in_json(capsys, *words)[0] == 0
    assert in_json(capsys, "convert", "word.svg", "-o", "part.json", "--fit", "80x40", "--colour", "gold")[0] == 0
    whole, part = (brushsvg.read_plan(desk / f"{name}.json").passes for name in ("all", "part"))
    places = {each.stroke: each.poses_mm.tolist() for each in whole}
    assert len(part) == 2 and all(places[each.stroke] == each.poses_mm.tolist() for each in part)


def test_a_plan_is_split_by_colour_like_its_drawing(desk, capsys):
    assert in_json(capsys, "convert", "word.svg", "-o", "plan.json")[0] == 0
    assert in_json(capsys, "convert", "plan.json", "-o", "out.ngc", "--per-colour")[0] == 0
    assert [names(path.read_text()) for path in sorted(desk.glob("out*"))] == [*INKS.values()]


def test_an_unknown_colour_is_refused(desk, capsys):
    status, _, reported = in_json(capsys, "convert", "word.svg", "-o", "out.ngc", "--colour", "#00ff00")
    assert status == 1 and is_reported(reported, "nothing-to-paint #00ff00 #ffd700 #d32f2f #1a237e", "colour")
    assert in_json(capsys, "convert", "word.svg", "-o", "out.ngc", "--per-colour", "--from-stroke", "2")[0] == 2
    assert not list(desk.glob("out*"))


def test_outdated_programs_of_removed_colours_are_reported(desk, capsys):
    assert in_json(capsys, "convert", "word.svg", "-o", "out.ngc", "--per-colour")[0] == 0
    text = (desk / "word.svg").read_text().replace("#ffd700", "#d32f2f")
    (desk / "word.svg").write_text(text)
    status, _, reported = in_json(capsys, "convert", "word.svg", "-o", "out.ngc", "--per-colour")
    assert status == 0 and is_reported(
        reported, "programs-of-before out-1-ffd700.ngc out-2-d32f2f.ngc out-3-1a237e.ngc"
    ), reported


def test_programs_for_a_kuka_have_names_that_its_controller_knows(desk, capsys):
    """KUKA controllers allow no hyphens: each of these programs once had another name there than its file."""
    words = "convert", "word.svg", "--cell", "kr6-r900", "-o", "out.src"
    status, _, reported = in_json(capsys, *words, "--per-colour")
    files = ["out_1_ffd700.src", "out_2_d32f2f.src", "out_3_1a237e.src"]
    assert status == 0 and not is_reported(reported, "program-renamed")
    assert sorted(path.name for path in desk.glob("out*")) == files
    assert is_reported(in_json(capsys, *words)[2], f"programs-of-before {' '.join(files)}")


def test_programs_for_a_fanuc_have_short_names(desk, capsys):
    """Names of FANUC controllers have 8 characters. Each of these programs once had another name there."""
    words = "convert", "word.svg", "--cell", "lrmate200id"
    status, _, reported = in_json(capsys, *words, "-o", "waves.ls", "--per-colour")
    files = ["waves_c1.ls", "waves_c2.ls", "waves_c3.ls"]
    assert status == 0 and not is_reported(reported, "program-renamed")
    assert sorted(path.name for path in desk.glob("waves*")) == files
    assert is_reported(in_json(capsys, *words, "-o", "waves.ls")[2], f"programs-of-before {' '.join(files)}")
    _, _, reported = in_json(capsys, *words, "-o", "long-name.ls", "--per-colour")
    renamed = [notice for _, notice in reported if notice.code == "program-renamed"]
    assert renamed and all("-o" in notice.advice for notice in renamed)
    programs = [path.read_text() for path in desk.glob("long-name*")]
    assert len({re.search(r"/PROG +(\w{1,8})\n", text)[1] for text in programs}) == len(programs) == 3


def test_a_program_just_written_is_not_outdated(desk, capsys):
    """The program at ./out.ngc was once taken for one of an earlier run, with the advice to delete it."""
    for output in ("./out.ngc", f"{desk}//out.ngc"):
        status, _, reported = in_json(capsys, "convert", "word.svg", "-o", "out.ngc")
        assert status == 0 and not is_reported(reported, "programs-of-before")
        status, _, reported = in_json(capsys, "convert", "word.svg", "-o", output)
        assert status == 0 and not is_reported(reported, "programs-of-before"), output


def test_a_page_has_the_same_sheet_in_each_program(desk, capsys):
    """Every program of a page has the same sheet.

    Margin strokes were once in one program only, and check refused the other programs.
    """
    words = "convert", "word.svg", "-o", "out.ngc", "--per-colour", "--page", "page.svg"
    assert in_json(capsys, *words)[0] == 0
    for file, ink in zip(sorted(desk.glob("out*")), INKS, strict=True):
        assert in_json(capsys, "check", file, "word.svg", "--colour", ink)[0] == 0
    assert in_json(capsys, *words, "--margin-strokes", "on")[0] == 2


def test_one_existing_file_prevents_all_programs(desk, capsys):
    (desk / "out-2-d32f2f.ngc").write_text("mine")
    status, _, reported = in_json(capsys, "convert", "word.svg", "-o", "out.ngc", "--per-colour")
    assert status == 1 and is_reported(reported, "file-exists")
    assert [path.read_text() for path in desk.glob("out*")] == ["mine"]


SHAPES = (
    '<path id="fine" d="M10 10h6v40h-6z" fill="#d32f2f" stroke="#1a237e" stroke-width="0.3"/>'
    '<path id="broad" d="M30 10h6v40h-6z" fill="#d32f2f" stroke="#1a237e"/>'
    '<path id="one" d="M50 10h6v40h-6z" fill="#d32f2f" stroke="#d32f2f" stroke-width="0.3"/>'
    '<path id="line" d="M70 10L71 50" fill="#d32f2f" stroke="#1a237e"/>'
)


def test_a_shape_has_its_fill_colour_and_its_outline_the_stroke_colour(tmp_path, monkeypatch, capsys):
    """A shape has the colour of its fill, and its outline has its own colour.

    All of "fine" and "broad" was once painted in the colour of the outline.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "word.svg").write_text(DRAWING.format(SHAPES))
    status, _, reported = in_json(capsys, "convert", "word.svg", "-o", "out.json")
    assert status == 0 and len(reported) == 1
    assert is_reported(reported, "outline-too-fine #1a237e 0.3 0.84 #d32f2f", "fine")
    found = {each.stroke: each.colour for each in brushsvg.read_plan("out.json").passes}
    inks = {"fine": "#d32f2f", "broad": "#d32f2f", "broad-stroke": "#1a237e", "one": "#d32f2f"}
    assert found == inks | {"line": "#1a237e"}, "nothing of the last one's fill can be seen"
    for paths_as, ink in (("stroke", "#1a237e"), ("outline", "#d32f2f")):
        strokes = brushsvg.convert("word.svg", paths_as=paths_as, lenient=True).plan.passes
        assert {each.colour for each in strokes if each.stroke in ("fine", "broad")} == {ink}


def test_a_frame_around_a_white_page_is_painted(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = '<rect id="page" width="100" height="60" fill="#fff" stroke="#1a237e"/>'
    page += '<path id="l" d="M20 20H50" stroke="red"/>'
    (tmp_path / "word.svg").write_text(DRAWING.format(page))
    design = brushsvg.read_drawing("word.svg")
    assert is_reported(design.notices, "background page")
    assert [(each.id, each.colour, each.fill_rule) for each in design.elements] == [
        ("page-stroke", "#1a237e", ""),
        ("l", "#ff0000", ""),
    ]
