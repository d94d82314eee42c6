"""Settings on a drawing's outermost svg apply to the whole job.

All commands follow these settings.
"""

import gzip

import pytest
from diagnostics import agrees, in_json, is_reported

from brushsvg import Settings, read_plan
from brushsvg.cli import commands, main
from brushsvg.cli.arguments.parser import parse
from brushsvg.machine.cells.cell_file import cell_names

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="160mm" height="90mm" viewBox="0 0 160 90" fill="none"
 stroke="#203060" stroke-width="3"><path id="a" d="M30 40 C50 20 70 20 90 40"/><path id="b" d="M30 60 H90"/></svg>"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.svg").write_text(DRAWING)
    return tmp_path


def refusal_of(capsys, *words):
    """Return all notices about the drawing of a refused command."""
    capsys.readouterr()
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and {file for file, _ in reported} == {next(each for each in words if ".svg" in each)}
    return [notice for _, notice in reported]


def on_root(*settings):
    return DRAWING.replace("<svg ", "<svg " + " ".join(f"data-brushsvg-{each}" for each in settings) + " ", 1)


def test_document_settings_apply_to_the_whole_job(desk, capsys):
    (desk / "said.svg").write_text(on_root('brush="rigid"', 'cell="ur5e"', 'compensation="none"', 'tolerance=".2mm"'))
    flags = ["--brush", "rigid", "--cell", "ur5e", "--compensation", "none", "--tolerance", "0.2"]
    assert main(["convert", "said.svg", "-o", "said.script"]) == 0
    assert main(["convert", "d.svg", "-o", "typed.script", *flags]) == 0
    assert (desk / "said.script").read_bytes() == (desk / "typed.script").read_bytes()
    (desk / "said.svgz").write_bytes(gzip.compress((desk / "said.svg").read_bytes()))
    assert main(["convert", "said.svgz", "-o", "packed.script"]) == 0
    assert (desk / "packed.script").read_bytes() == (desk / "typed.script").read_bytes()


def test_flags_override_document_settings(desk, capsys):
    (desk / "said.svg").write_text(on_root('cell="ur5e"', 'compensation="none"', 'tolerance="0.2mm"'))
    flags = ["--cell", "linuxcnc-3axis", "--compensation", "closed", "--tolerance", "0.05"]
    assert main(["convert", "said.svg", "-o", "said.ngc", *flags]) == 0
    assert main(["convert", "d.svg", "-o", "plain.ngc"]) == 0
    assert (desk / "said.ngc").read_bytes() == (desk / "plain.ngc").read_bytes()


def test_start_styles_can_be_set_for_the_job_and_for_strokes(desk, capsys):
    def poses(text, *flags):
        (desk / "s.svg").write_text(text)
        assert main(["convert", "s.svg", "-o", "s.json", *flags]) == 0
        return {each.stroke: each.poses_mm.tolist() for each in read_plan("s.json").passes}

    pointed, rounded = poses(DRAWING, "--start", "pointed"), poses(DRAWING, "--start", "round")
    assert all(len(rounded[name]) > len(pointed[name]) for name in "ab")
    assert poses(DRAWING) == rounded  # the default suits round ends
    assert poses(on_root('start="pointed"')) == pointed
    assert poses(on_root('start="pointed"'), "--start", "round") == rounded
    of_one = DRAWING.replace('id="a"', 'id="a" data-brushsvg-start="pointed"')
    assert poses(of_one, "--start", "round") == {"a": pointed["a"], "b": rounded["b"]}


BAR = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
    '<path id="a" d="M10 10h30v4h-30z"/><path id="b" d="M10 24h30v4h-30z"/></svg>'
)


def test_a_butt_start_is_used_by_default_and_on_request(desk, capsys):
    def poses(*flags):
        assert main(["convert", "s.svg", "-o", "s.json", *flags]) == 0
        return {each.stroke[:1]: each.poses_mm.tolist() for each in read_plan("s.json").passes}

    (desk / "s.svg").write_text(BAR)
    rounded, butt = poses("--start", "round"), poses("--start", "butt")
    assert all(len(butt[name]) > len(rounded[name]) for name in "ab")
    assert poses() == butt  # the default suits a straight cut
    (desk / "s.svg").write_text(BAR.replace('id="a"', 'id="a" data-brushsvg-start="butt"'))
    assert poses("--start", "round") == {"a": butt["a"], "b": rounded["b"]}
    assert main(["convert", "s.svg", "-o", "s.ngc", "--start", "butt"]) == 0
    assert ", start butt)" in (desk / "s.ngc").read_text()
    assert main(["check", "s.ngc", "s.svg"]) == 0


def test_end_styles_can_be_set_for_the_job_and_for_strokes(desk, capsys):
    def poses(text, *flags):
        (desk / "s.svg").write_text(text)
        assert main(["convert", "s.svg", "-o", "s.json", *flags]) == 0
        return {each.stroke[:1]: each.poses_mm.tolist() for each in read_plan("s.json").passes}

    rounded, butt = poses(BAR, "--end", "round"), poses(BAR, "--end", "butt")
    assert all(len(butt[name]) > len(rounded[name]) for name in "ab")
    assert poses(BAR) == butt  # the default suits a straight cut
    with_setting = BAR.replace("<svg ", '<svg data-brushsvg-end="round" ')
    assert poses(with_setting) == rounded
    assert poses(with_setting, "--end", "butt") == butt
    of_one = BAR.replace('id="a"', 'id="a" data-brushsvg-end="round"')
    assert poses(of_one) == {"a": rounded["a"], "b": butt["b"]}


def test_terminals_set_both_ends_and_one_end_may_differ(desk, capsys):
    def poses(text, *flags):
        (desk / "s.svg").write_text(text)
        assert main(["convert", "s.svg", "-o", "s.json", *flags]) == 0
        return {each.stroke[:1]: each.poses_mm.tolist() for each in read_plan("s.json").passes}

    def both(start, end):
        return poses(BAR, "--start", start, "--end", end)

    for one, other in (("round", "butt"), ("butt", "pointed"), ("pointed", "round")):
        assert poses(BAR, "--terminals", one) == both(one, one)
        assert poses(BAR, "--terminals", one, "--end", other) == both(one, other)
        on_svg = BAR.replace("<svg ", f'<svg data-brushsvg-terminals="{one}" ')
        assert poses(on_svg) == both(one, one)
        assert poses(on_svg, "--terminals", other) == both(other, other), "a flag counts more"
        assert poses(on_svg, "--start", other) == both(other, one)
        start = on_svg.replace("<svg ", f'<svg data-brushsvg-start="{other}" ')
        assert poses(start) == both(other, one)
        assert poses(start, "--terminals", one) == both(one, one), "a flag counts more"
        of_one = BAR.replace('id="a"', f'id="a" data-brushsvg-terminals="{one}"')
        assert poses(of_one, "--terminals", other) == {"a": both(one, one)["a"], "b": both(other, other)["b"]}
        of_group = BAR.replace('<path id="a"', f'<g data-brushsvg-terminals="{one}"><path id="a"')
        of_group = of_group.replace("</svg>", "</g></svg>")
        assert poses(of_group, "--start", other) == both(one, one)
        inside = of_group.replace('id="a"', f'id="a" data-brushsvg-end="{other}"')
        assert poses(inside) == {"a": both(one, other)["a"], "b": both(one, one)["b"]}


def test_a_program_header_states_its_end_style_and_check_uses_it(desk, capsys):
    (desk / "d.svg").write_text(BAR)
    assert main(["convert", "d.svg", "-o", "d.ngc", "--end", "round", "--start", "pointed"]) == 0
    text = (desk / "d.ngc").read_text()
    assert "(compensation: closed, tolerance 0.05 mm, start pointed, end round)" in text
    assert main(["check", "d.ngc", "d.svg"]) == 0
    (desk / "d.ngc").write_text(text.replace(", end round)", ")"))
    assert main(["check", "d.ngc", "d.svg"]) == 1


def test_a_program_header_states_its_start_style_and_check_uses_it(desk, capsys):
    assert main(["convert", "d.svg", "-o", "d.ngc", "--start", "pointed"]) == 0
    text = (desk / "d.ngc").read_text()
    assert "(compensation: closed, tolerance 0.05 mm, start pointed)" in text
    assert main(["check", "d.ngc", "d.svg"]) == 0
    (desk / "d.ngc").write_text(text.replace(", start pointed)", ")"))
    assert main(["check", "d.ngc", "d.svg"]) == 1
    (desk / "d.ngc").write_text(text.replace(", start pointed)", ", start soft)"))
    capsys.readouterr()
    status, _, reported = in_json(capsys, "check", "d.ngc", "d.svg")
    assert status == 1 and [notice.code for _, notice in reported] == ["header-damaged"]


@pytest.mark.parametrize("file", ["/etc/hostname", "mine.toml", "../mine.toml", "no-such-cell"])
def test_document_settings_cannot_name_files(desk, capsys, file):
    (desk / "mine.toml").write_text("")
    (desk / "d.svg").write_text(on_root(f'cell="{file}"'))
    (reported,) = refusal_of(capsys, "convert", "d.svg", "-o", "x.ngc")
    expected = f"cell-unknown data-brushsvg-cell {file} {' '.join(cell_names())}"
    assert agrees(reported, expected, "svg") and reported.advice == "give --cell"


@pytest.mark.parametrize("file", ["/etc/hostname", "mine.json", "no-such-brush"])
def test_every_command_refuses_an_unknown_brush_of_the_document(desk, capsys, file):
    (desk / "mine.json").write_text("")
    (desk / "d.svg").write_text(on_root(f'brush="{file}"'))
    for words in (
        ("convert", "d.svg", "-o", "x.ngc"),
        ("preview", "d.svg", "-o", "x.svg"),
        ("preview", "d.svg", "-o", "x.html"),
        ("preview", "d.svg"),
        ("setup", "border", "d.svg", "-o", "x.ngc"),
        ("chart", "-o", "x.json", "--drawing", "d.svg"),
    ):
        (reported,) = refusal_of(capsys, *words)
        assert agrees(reported, f"brush-unknown data-brushsvg-brush {file} rigid round-6", "svg"), words
        assert reported.advice == "give --brush"
    assert not (desk / "x.json").exists()
    status, _, reported = in_json(capsys, "convert", "d.svg", "-o", "x.ngc", "--brush", "round-6")
    assert status == 0 and is_reported(reported, f"brush-asked-for {file} round-6"), reported
    assert main(["preview", "d.svg", "--all-brushes"]) == 0


def test_typed_arguments_are_never_changed(desk, capsys):
    (desk / "d.svg").write_text(on_root('brush="round-6"', 'cell="grbl-3axis"', 'tolerance="0.2mm"'))
    for words in ("convert d.svg -o d.ngc", "preview d.svg", "check d.ngc d.svg"):
        args = parse(words.split())
        before = dict(vars(args))
        getattr(commands, args.run)(args)
        assert vars(args) == before


@pytest.mark.slow
def test_a_chart_is_for_the_brush_and_machine_of_a_drawing(desk, capsys):
    few = ("--strokes", "few")
    (desk / "d.svg").write_text(on_root('brush="round-6"', 'cell="grbl-3axis"', 'tolerance="0.2mm"'))
    assert main(["chart", "-o", "said.ngc", "--drawing", "d.svg", *few]) == 0
    assert main(["chart", "-o", "typed.ngc", "--brush", "round-6", "--cell", "grbl-3axis", *few]) == 0
    assert (desk / "said.ngc").read_bytes() == (desk / "typed.ngc").read_bytes()
    assert main(["chart", "-o", "said.ngc", "--drawing", "d.svg", "--cell", "linuxcnc-3axis", *few]) == 0
    assert (desk / "said.ngc").read_bytes() != (desk / "typed.ngc").read_bytes()


FAT = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60" {}>'
    '<path id="bar" d="M20 20h60v14h-60z"/></svg>'
)


def test_the_document_can_set_how_wide_outlines_are_painted(desk, capsys):
    for name, setting in (("said.svg", 'data-brushsvg-wide="clamp"'), ("d.svg", "")):
        (desk / name).write_text(FAT.format(setting))
    assert main(["convert", "said.svg", "-o", "said.ngc"]) == 0
    assert main(["convert", "d.svg", "-o", "typed.ngc", "--wide", "clamp"]) == 0
    assert main(["convert", "d.svg", "-o", "filled.ngc"]) == 0
    by_setting = (desk / "said.ngc").read_bytes()
    assert by_setting == (desk / "typed.ngc").read_bytes() != (desk / "filled.ngc").read_bytes()
    assert main(["check", "said.ngc", "said.svg"]) == 0
    (desk / "no.svg").write_text(FAT.format('data-brushsvg-wide="refuse"'))
    assert is_reported(refusal_of(capsys, "convert", "no.svg", "-o", "x.ngc"), "width-out-of-reach 14", "bar")


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ('compensation="most"', "data-brushsvg-compensation most none, constant, closed"),
        ('tolerance="11mm"', "data-brushsvg-tolerance 11 '[1e-05, 10] mm'"),
        ('wide="very"', "data-brushsvg-wide very auto, clamp, passes, refuse"),
        ('cell=""', "data-brushsvg-cell empty"),
        ('machine="x"', "data-brushsvg-machine width speed"),
    ],
)
def test_invalid_document_settings_stop_convert(desk, capsys, setting, expected):
    (desk / "d.svg").write_text(on_root(setting))
    (reported,) = refusal_of(capsys, "convert", "d.svg", "-o", "x.ngc")
    assert agrees(reported, f"setting-invalid {expected}"), reported
    assert main(["convert", "d.svg", "-o", "x.ngc", "--lenient"]) == 0


@pytest.mark.parametrize(
    ("name", "data", "expected"),
    [
        ("x.svg", b"", "file-empty"),
        ("x.svg", bytes(range(256)), "not-xml"),
        ("x.svg", b"<html/>", "not-svg <html>"),
        ("x.svgz", b"\x1f\x8b moo", "svgz-damaged"),
        ("x.dxf", None, "file-unreadable"),
    ],
)
def test_a_chart_for_a_file_that_is_not_a_drawing_is_refused(desk, capsys, name, data, expected):
    if data is not None:
        (desk / name).write_bytes(data)
    status, _, ((file, reported),) = in_json(capsys, "chart", "-o", "x.json", "--drawing", name)
    assert (status, file) == (1, name) and agrees(reported, expected), reported
    assert not (desk / "x.json").exists()


def test_document_settings_on_an_element_are_refused(desk, capsys):
    (desk / "d.svg").write_text(DRAWING.replace('id="a"', 'id="a" data-brushsvg-cell="ur5e"'))
    assert is_reported(
        refusal_of(capsys, "convert", "d.svg", "-o", "x.ngc"),
        "setting-invalid data-brushsvg-cell whole svg",
        "a",
    )
    (desk / "d.svg").write_text(on_root('cell="ur5e"'))
    assert main(["convert", "d.svg", "-o", "x.json"]) == 0
    assert [each.settings for each in read_plan(desk / "x.json").passes] == [Settings(), Settings()]
