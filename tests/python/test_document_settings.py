"""What a drawing says on its outermost svg of the whole job, and commands that go by it."""

import gzip

import pytest
from diagnostics import agrees, in_json, is_told

from brushsvg import Settings, read_plan
from brushsvg.cli import commands, main
from brushsvg.cli.arguments.parser import parse
from brushsvg.machine.cell_file import cell_names

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="160mm" height="90mm" viewBox="0 0 160 90" fill="none"
 stroke="#203060" stroke-width="3"><path id="a" d="M30 40 C50 20 70 20 90 40"/><path id="b" d="M30 60 H90"/></svg>"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.svg").write_text(DRAWING)
    return tmp_path


def refusal_of(capsys, *words):
    """All that is told of the drawing."""
    capsys.readouterr()
    status, _, told = in_json(capsys, *words)
    assert status == 1 and {file for file, _ in told} == {next(each for each in words if ".svg" in each)}
    return [notice for _, notice in told]


def on_root(*settings):
    return DRAWING.replace("<svg ", "<svg " + " ".join(f"data-brushsvg-{each}" for each in settings) + " ", 1)


def test_the_document_chooses_for_the_whole_job(desk, capsys):
    (desk / "said.svg").write_text(
        on_root('brush="rigid"', 'cell="ur5e"', 'compensation="none"', 'tolerance=".2mm"')
    )
    flags = ["--brush", "rigid", "--cell", "ur5e", "--compensation", "none", "--tolerance", "0.2"]
    assert main(["convert", "said.svg", "said.script"]) == 0
    assert main(["convert", "d.svg", "typed.script", *flags]) == 0
    assert (desk / "said.script").read_bytes() == (desk / "typed.script").read_bytes()
    (desk / "said.svgz").write_bytes(gzip.compress((desk / "said.svg").read_bytes()))
    assert main(["convert", "said.svgz", "packed.script"]) == 0
    assert (desk / "packed.script").read_bytes() == (desk / "typed.script").read_bytes()


def test_what_is_typed_wins_over_the_document(desk, capsys):
    (desk / "said.svg").write_text(on_root('cell="ur5e"', 'compensation="none"', 'tolerance="0.2mm"'))
    flags = ["--cell", "linuxcnc-3axis", "--compensation", "closed", "--tolerance", "0.05"]
    assert main(["convert", "said.svg", "said.ngc", *flags]) == 0
    assert main(["convert", "d.svg", "plain.ngc"]) == 0
    assert (desk / "said.ngc").read_bytes() == (desk / "plain.ngc").read_bytes()


def test_beginnings_are_said_of_the_job_and_of_strokes(desk, capsys):
    def poses(text, *flags):
        (desk / "s.svg").write_text(text)
        assert main(["convert", "s.svg", "s.json", *flags]) == 0
        return {each.stroke: each.poses_mm.tolist() for each in read_plan("s.json").passes}

    exposed, hidden = poses(DRAWING, "--start", "exposed"), poses(DRAWING, "--start", "hidden")
    assert all(len(hidden[name]) > len(exposed[name]) for name in "ab")
    assert poses(DRAWING) == hidden  # what suits round ends
    assert poses(on_root('start="exposed"')) == exposed
    assert poses(on_root('start="exposed"'), "--start", "hidden") == hidden
    of_one = DRAWING.replace('id="a"', 'id="a" data-brushsvg-start="exposed"')
    assert poses(of_one, "--start", "hidden") == {"a": exposed["a"], "b": hidden["b"]}


BAR = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
    '<path id="a" d="M10 10h30v4h-30z"/><path id="b" d="M10 24h30v4h-30z"/></svg>'
)


def test_a_cut_beginning_is_squared_where_it_is_chosen_and_where_it_is_said(desk, capsys):
    def poses(*flags):
        assert main(["convert", "s.svg", "s.json", *flags]) == 0
        return {each.stroke[:1]: each.poses_mm.tolist() for each in read_plan("s.json").passes}

    (desk / "s.svg").write_text(BAR)
    hidden, squared = poses("--start", "hidden"), poses("--start", "squared")
    assert all(len(squared[name]) > len(hidden[name]) for name in "ab")
    assert poses() == squared  # what suits a straight cut
    (desk / "s.svg").write_text(BAR.replace('id="a"', 'id="a" data-brushsvg-start="squared"'))
    assert poses("--start", "hidden") == {"a": squared["a"], "b": hidden["b"]}
    assert main(["convert", "s.svg", "s.ngc", "--start", "squared"]) == 0
    assert ", start squared)" in (desk / "s.ngc").read_text()
    assert main(["check", "s.ngc", "s.svg"]) == 0


def test_ends_are_said_of_the_job_and_of_strokes(desk, capsys):
    def poses(text, *flags):
        (desk / "s.svg").write_text(text)
        assert main(["convert", "s.svg", "s.json", *flags]) == 0
        return {each.stroke[:1]: each.poses_mm.tolist() for each in read_plan("s.json").passes}

    lifted, squared = poses(BAR, "--end", "lifted"), poses(BAR, "--end", "squared")
    assert all(len(squared[name]) > len(lifted[name]) for name in "ab")
    assert poses(BAR) == squared  # what suits a straight cut
    said = BAR.replace("<svg ", '<svg data-brushsvg-end="lifted" ')
    assert poses(said) == lifted
    assert poses(said, "--end", "squared") == squared
    of_one = BAR.replace('id="a"', 'id="a" data-brushsvg-end="lifted"')
    assert poses(of_one) == {"a": lifted["a"], "b": squared["b"]}


def test_a_program_tells_how_its_strokes_end_and_is_checked_by_it(desk, capsys):
    (desk / "d.svg").write_text(BAR)
    assert main(["convert", "d.svg", "d.ngc", "--end", "lifted", "--start", "exposed"]) == 0
    text = (desk / "d.ngc").read_text()
    assert "(compensation: closed, tolerance 0.05 mm, start exposed, end lifted)" in text
    assert main(["check", "d.ngc", "d.svg"]) == 0
    (desk / "d.ngc").write_text(text.replace(", end lifted)", ")"))
    assert main(["check", "d.ngc", "d.svg"]) == 1


def test_a_program_tells_how_its_strokes_begin_and_is_checked_by_it(desk, capsys):
    assert main(["convert", "d.svg", "d.ngc", "--start", "exposed"]) == 0
    text = (desk / "d.ngc").read_text()
    assert "(compensation: closed, tolerance 0.05 mm, start exposed)" in text
    assert main(["check", "d.ngc", "d.svg"]) == 0
    (desk / "d.ngc").write_text(text.replace(", start exposed)", ")"))
    assert main(["check", "d.ngc", "d.svg"]) == 1
    (desk / "d.ngc").write_text(text.replace(", start exposed)", ", start soft)"))
    capsys.readouterr()
    status, _, told = in_json(capsys, "check", "d.ngc", "d.svg")
    assert status == 1 and [notice.code for _, notice in told] == ["header-damaged"]


@pytest.mark.parametrize("file", ["/etc/hostname", "mine.toml", "../mine.toml", "no-such-cell"])
def test_the_document_names_no_files(desk, capsys, file):
    (desk / "mine.toml").write_text("")
    (desk / "d.svg").write_text(on_root(f'cell="{file}"'))
    (told,) = refusal_of(capsys, "convert", "d.svg", "x.ngc")
    said = f"cell-unknown data-brushsvg-cell {file} {' '.join(cell_names())}"
    assert agrees(told, said, "svg") and told.advice == "give --cell"


@pytest.mark.parametrize("file", ["/etc/hostname", "mine.json", "no-such-brush"])
def test_a_brush_of_the_document_that_is_not_known_is_refused_by_every_command(desk, capsys, file):
    (desk / "mine.json").write_text("")
    (desk / "d.svg").write_text(on_root(f'brush="{file}"'))
    for words in (
        ("convert", "d.svg", "x.ngc"),
        ("predict", "d.svg", "x.svg"),
        ("animate", "d.svg", "x.html"),
        ("report", "d.svg"),
        ("border", "d.svg", "x.ngc"),
        ("chart", "x.json", "--drawing", "d.svg"),
    ):
        (told,) = refusal_of(capsys, *words)
        assert agrees(told, f"brush-unknown data-brushsvg-brush {file} rigid round-6", "svg"), words
        assert told.advice == "give --brush"
    assert not (desk / "x.json").exists()
    status, _, told = in_json(capsys, "convert", "d.svg", "x.ngc", "--brush", "round-6")
    assert status == 0 and is_told(told, f"brush-asked-for {file} round-6"), told
    assert main(["report", "d.svg", "--all-brushes"]) == 0


def test_what_was_typed_is_never_written_over(desk, capsys):
    (desk / "d.svg").write_text(on_root('brush="round-6"', 'cell="grbl-3axis"', 'tolerance="0.2mm"'))
    for words in ("convert d.svg d.ngc", "report d.svg", "check d.ngc d.svg"):
        args = parse(words.split())
        before = dict(vars(args))
        getattr(commands, args.run)(args)
        assert vars(args) == before


@pytest.mark.slow
def test_a_chart_is_for_the_brush_and_machine_of_a_drawing(desk, capsys):
    few = ("--strokes", "few")
    (desk / "d.svg").write_text(on_root('brush="round-6"', 'cell="grbl-3axis"', 'tolerance="0.2mm"'))
    assert main(["chart", "said.ngc", "--drawing", "d.svg", *few]) == 0
    assert main(["chart", "typed.ngc", "--brush", "round-6", "--cell", "grbl-3axis", *few]) == 0
    assert (desk / "said.ngc").read_bytes() == (desk / "typed.ngc").read_bytes()
    assert main(["chart", "said.ngc", "--drawing", "d.svg", "--cell", "linuxcnc-3axis", *few]) == 0
    assert (desk / "said.ngc").read_bytes() != (desk / "typed.ngc").read_bytes()


FAT = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60" {}>'
    '<path id="bar" d="M20 20h60v14h-60z"/></svg>'
)


def test_the_document_says_how_wide_outlines_are_painted(desk, capsys):
    for name, setting in (("said.svg", 'data-brushsvg-wide="clamp"'), ("d.svg", "")):
        (desk / name).write_text(FAT.format(setting))
    assert main(["convert", "said.svg", "said.ngc"]) == 0
    assert main(["convert", "d.svg", "typed.ngc", "--wide", "clamp"]) == 0
    assert main(["convert", "d.svg", "filled.ngc"]) == 0
    said = (desk / "said.ngc").read_bytes()
    assert said == (desk / "typed.ngc").read_bytes() != (desk / "filled.ngc").read_bytes()
    assert main(["check", "said.ngc", "said.svg"]) == 0
    (desk / "no.svg").write_text(FAT.format('data-brushsvg-wide="refuse"'))
    assert is_told(refusal_of(capsys, "convert", "no.svg", "x.ngc"), "width-out-of-reach 14", "bar")


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ('compensation="most"', "data-brushsvg-compensation most none, constant, closed"),
        ('tolerance="11mm"', "data-brushsvg-tolerance 11 '[1e-05, 10] mm'"),
        ('wide="very"', "data-brushsvg-wide very auto, clamp, passes, refuse"),
        ('cell=""', "data-brushsvg-cell empty"),
        ('machine="x"', "data-brushsvg-machine width speed"),
    ],
)
def test_settings_of_the_document_that_make_no_sense_stop_convert(desk, capsys, setting, said):
    (desk / "d.svg").write_text(on_root(setting))
    (told,) = refusal_of(capsys, "convert", "d.svg", "x.ngc")
    assert agrees(told, f"setting-invalid {said}"), told
    assert main(["convert", "d.svg", "x.ngc", "--lenient"]) == 0


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("x.svg", b"", "file-empty"),
        ("x.svg", bytes(range(256)), "not-xml"),
        ("x.svg", b"<html/>", "not-svg <html>"),
        ("x.svgz", b"\x1f\x8b moo", "svgz-damaged"),
        ("x.dxf", None, "file-unreadable"),
    ],
)
def test_a_chart_for_what_is_no_drawing_is_refused(desk, capsys, name, data, said):
    if data is not None:
        (desk / name).write_bytes(data)
    status, _, ((file, told),) = in_json(capsys, "chart", "x.json", "--drawing", name)
    assert (status, file) == (1, name) and agrees(told, said), told
    assert not (desk / "x.json").exists()


def test_settings_of_the_document_are_none_of_an_element(desk, capsys):
    (desk / "d.svg").write_text(DRAWING.replace('id="a"', 'id="a" data-brushsvg-cell="ur5e"'))
    assert is_told(
        refusal_of(capsys, "convert", "d.svg", "x.ngc"), "setting-invalid data-brushsvg-cell whole svg", "a"
    )
    (desk / "d.svg").write_text(on_root('cell="ur5e"'))
    assert main(["convert", "d.svg", "x.json"]) == 0
    assert [each.settings for each in read_plan(desk / "x.json").passes] == [Settings(), Settings()]
