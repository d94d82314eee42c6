"""The command line selects parts of a drawing, scales it and previews it.

It also applies layers and settings.
"""

import gzip
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from diagnostics import agrees, gives, in_json, is_reported, read, refused

import brushsvg
from brushsvg.cli import main

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
 width="160mm" height="90mm" viewBox="0 0 160 90" fill="none" stroke="#203060" stroke-width="3"><title>Layers</title>
 <g inkscape:groupmode="layer" inkscape:label="Ink"><path id="a" d="M30 40 C50 20 70 20 90 40"/></g>
 <g inkscape:groupmode="layer" inkscape:label="Red" stroke="red"><path id="b" d="M30 60 H90"/>
 <text id="t">x</text></g></svg>"""
DXF = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nINK\n10\n0\n20\n0\n11\n2\n21\n0\n0\nENDSEC\n0\nEOF\n"


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.svg").write_text(DRAWING)
    (tmp_path / "d.dxf").write_text(DXF)
    return tmp_path


def plan(desk, capsys, *words, drawing="d.svg"):
    """Return the plan's passes and the reported notices."""
    capsys.readouterr()
    status, _, reported = in_json(capsys, "convert", drawing, "-o", "plan.json", "--quiet", *words)
    assert status == 0, reported
    return json.loads((desk / "plan.json").read_text())["passes"], [notice for _, notice in reported]


def refusal(capsys, *words):
    status, _, (*_, (_, reported)) = in_json(capsys, *words)
    assert status == 1
    return reported


def test_layers_and_elements_can_be_selected(desk, capsys):
    passes, reported = plan(desk, capsys, "--layer", "Ink")
    assert ([each["stroke"] for each in passes], reported) == (["a"], [])
    passes, (reported,) = plan(desk, capsys, "--select", "#b, text")
    assert [each["stroke"] for each in passes] == ["b"]
    assert agrees(reported, "text-unread --export-text-to-path", "t")
    reported = refusal(capsys, "convert", "d.svg", "-o", "x.json", "--layer", "Blue")
    assert agrees(reported, "layer-unknown Blue Ink Red", "layer")
    reported = refusal(capsys, "convert", "d.svg", "-o", "x.json", "--select", "#c")
    assert agrees(reported, "selector-matches-nothing #c")


def test_of_many_strokes_too_wide_for_a_brush_the_widest_is_reported(desk, capsys):
    """The first one was reported. A drawing that was scaled as advised for it was refused again."""
    shapes = "".join(f'<path id="s{w}" d="M10,{3 * w} h60 v{w} h-60 z"/>' for w in (10, 12, 30, 14, 18))
    lines = "".join(f'<path id="l{w}" d="M10,{w + 9} h60" stroke-width="{w}"/>' for w in (9, 15, 11))
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="140mm" viewBox="0 0 100 140">'
    (desk / "lines.svg").write_text(f'{head}<g fill="none" stroke="#000">{lines}</g></svg>')
    status, _, reported = in_json(capsys, "convert", "lines.svg", "-o", "x.json")
    assert status == 1 and is_reported(reported, "width-out-of-reach l15 15.000")
    (desk / "shapes.svg").write_text(f"{head}{shapes}</svg>")
    status, _, reported = in_json(capsys, "convert", "shapes.svg", "-o", "x.json", "--wide", "clamp")
    assert status == 0 and is_reported(reported, "width-out-of-reach s30 30"), reported


def test_warnings_about_a_drawing_precede_its_refusal(desk, capsys):
    """Warnings about a drawing are reported before its refusal.

    A thick line was in metres by mistake. Its width was refused, but no message mentioned the unit.
    """
    head = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n"
    line = "0\nLWPOLYLINE\n8\nINK\n90\n2\n70\n0\n43\n0.1\n10\n0\n20\n0\n10\n9\n20\n0\n"
    (desk / "thick.dxf").write_text(head + "0\nSECTION\n2\nENTITIES\n" + line + "0\nENDSEC\n0\nEOF\n")
    for command, *out in (("convert", "-o", "x.json"), ("preview", "-o", "x.json"), ("preview",)):
        status, _, reported = in_json(capsys, command, "thick.dxf", *out)
        assert status == 1 and [is_reported([each], "unit-doubtful metres") for each in reported] == [
            True,
            False,
        ], reported
        assert is_reported(reported[1:], "width-out-of-reach 100.000")
    with pytest.raises(brushsvg.Error) as caught:
        brushsvg.convert("thick.dxf")
    assert agrees(caught.value.notices[0], "unit-doubtful metres")
    (row,) = brushsvg.batch(["thick.dxf"], "painted", jobs=1).rows
    assert row.figures is None and agrees(row.notices[0], "unit-doubtful metres")


def test_python_refusal_contains_the_earlier_warnings(desk):
    with pytest.raises(brushsvg.Error) as caught:
        brushsvg.convert("d.svg", origin=(-20, 0))
    assert caught.value.code == "mark-off-sheet" and agrees(caught.value.notices[0], "text-unread", "t")


def test_an_empty_selection_is_wrong_usage(desk, capsys):
    for flag in ("--layer", "--select"):
        assert main(["convert", "d.svg", "-o", "x.json", flag, ""]) == 2


def test_compressed_drawings_are_read(desk, capsys):
    packed = gzip.compress(DRAWING.encode())
    (desk / "d.svgz").write_bytes(packed)
    (desk / "z.svg").write_bytes(packed)
    plain, _ = plan(desk, capsys)
    assert plan(desk, capsys, drawing="d.svgz")[0] == plan(desk, capsys, drawing="z.svg")[0] == plain
    for damaged, expected in (
        (packed[:-40], "svgz-damaged"),
        (b"\x1f\x8b\x08\0", "svgz-damaged"),
        (packed[:20] + b"????" + packed[24:], "svgz-damaged"),
        (gzip.compress(b" " * 70_000_000, mtime=0), "file-too-large 64000000"),
    ):
        (desk / "z.svgz").write_bytes(damaged)
        assert agrees(refusal(capsys, "convert", "z.svgz", "-o", "x.json"), expected), expected


def test_the_exit_status_does_not_depend_on_a_reader_of_stderr(desk):
    command = [sys.executable, "-m", "brushsvg", "convert", "d.svg", "-o", "x.json", "--sheet", "10x10"]
    reading, writing = os.pipe()
    os.close(reading)
    assert subprocess.run(command, stderr=writing).returncode == 1


def test_size_and_position_can_be_set(desk, capsys):
    passes, _ = plan(desk, capsys, "--scale", "150%", "--layer", "Red")
    deepest = min(z for *_, z in passes[0]["poses_mm"])
    plain, _ = plan(desk, capsys, "--layer", "Red", "--width", "4.5")
    assert deepest == pytest.approx(min(z for *_, z in plain[0]["poses_mm"]), abs=1e-6), "widths are scaled"
    main(["preview", "d.svg", "-o", "m.json", "--fit", "100x80", "--width", "2"])
    rings = json.loads((desk / "m.json").read_text())["outline_mm"]
    xs, ys = zip(*(point for ring in rings for point in ring), strict=True)
    assert max(xs) - min(xs) == pytest.approx(100, abs=1.5)
    assert (max(xs) + min(xs)) / 2 == pytest.approx(80, abs=1)
    assert (max(ys) + min(ys)) / 2 == pytest.approx(45, abs=1)


def test_flags_have_no_effect_on_a_plan(desk, capsys):
    plan(desk, capsys)
    status, _, reported = in_json(capsys, "convert", "plan.json", "-o", "p2.json", "--fit", "50x50", "--layer", "Ink")
    assert status == 0
    for flag in ("--fit", "--layer"):
        assert is_reported(reported, f"flag-without-effect {flag}"), reported


@pytest.mark.parametrize(
    ("command", "flags"),
    [
        ("convert lines.gcode -o out.ngc", "--units in --select #a --background keep"),
        ("convert d.svg -o outlines.json --as outline", "--width 3 --join"),
        ("check d.ngc", "--scale 2 --layer Ink --width 3 --colour red --wide clamp --join --speed 5"),
        ("preview d.svg -o seen.png --show strokes", "--colour red --join --detail fine --corners turn --speed 5"),
        ("preview d.svg --all-brushes", "--pen z"),
        ("cell place ur5e", "--scale 2 --layer Ink --wide passes"),
        ("cell place ur5e d.svg", "--units in"),
    ],
)
def test_flags_without_effect_are_reported(desk, capsys, command, flags):
    """These flags were once dropped without a word."""
    (desk / "lines.gcode").write_text("G21\nG0 Z5\nG0 X10 Y10\nG1 Z0 F600\nG1 X60 Y10\nG0 Z5\n")
    assert main(["convert", "d.svg", "-o", "d.ngc"]) == 0
    assert not is_reported(in_json(capsys, *command.split())[2], "flag-without-effect")
    status, _, reported = in_json(capsys, *command.split(), *flags.split())
    assert status == 0
    for flag in (word for word in flags.split() if word.startswith("--")):
        assert is_reported(reported, f"flag-without-effect {flag}"), (flag, reported)


def test_a_flag_without_effect_is_reported_once(desk, capsys):
    assert main(["convert", "d.svg", "-o", "plan.json"]) == 0
    flags = "--as outline --width 3 --join".split()
    _, _, reported = in_json(capsys, "convert", "plan.json", "-o", "again.ngc", *flags)
    assert len([each for _, each in reported if each.code == "flag-without-effect"]) == 3


def test_settings_of_a_project_are_not_reported_as_without_effect(desk, capsys):
    (desk / "brushsvg.toml").write_text(
        'format = "brushsvg/project"\nversion = 1\n[defaults]\nwide = "clamp"\nbackground = "keep"\n'
    )
    for command in ("preview d.svg -o seen.png --show strokes", "convert d.svg -o d.ngc", "check d.ngc"):
        status, _, reported = in_json(capsys, *command.split())
        assert status == 0 and not is_reported(reported, "flag-without-effect"), (command, reported)


def test_cell_place_takes_the_brush_that_the_drawing_names(desk, capsys):
    """It once placed the job of another brush than convert paints with."""
    (desk / "pen.svg").write_text((desk / "d.svg").read_text().replace("<svg", '<svg data-brushsvg-brush="liner-1"', 1))
    for command in ("cell place ur5e pen.svg", "convert pen.svg -o pen.script --cell ur5e"):
        status, _, reported = in_json(capsys, *command.split())
        assert status == 1 and is_reported(reported, "width-out-of-reach liner-1"), (command, reported)


@pytest.mark.parametrize("command", ["convert", "preview"])
def test_flags_for_gcode_have_no_effect_on_an_svg(desk, capsys, command):
    out = ["-o", "d.ngc"] if command == "convert" else ["-o", "seen.png", "--show", "strokes"]
    flags = {"--pen": "servo", "--paper-z": "0", "--skip-region": "0,0,1,1", "--skip-comment": "dip"}
    words = [word for pair in flags.items() for word in pair]
    status, _, reported = in_json(capsys, command, "d.svg", *out, *words)
    assert status == 0
    for flag in flags:
        assert is_reported(reported, f"flag-without-effect {flag}"), reported
    assert not is_reported(in_json(capsys, command, "d.svg", *out)[2], "flag-without-effect")


def test_settings_change_the_plan(desk, capsys):
    text = DRAWING.replace('id="b"', 'id="b" data-brushsvg-order="-1" data-brushsvg-passes="2" data-brushsvg-speed="7"')
    text = text.replace('id="a"', 'id="a" data-brushsvg-brush="rigid"')
    (desk / "d.svg").write_text(text)
    passes, reported = plan(desk, capsys)
    assert [(each["stroke"], each["speed_mm_s"]) for each in passes] == [("b", 7), ("b#2", 7), ("a", 20)]
    assert passes[0]["settings"] == {"order": -1, "passes": 2, "speed_mm_s": 7}
    assert is_reported(reported, "brush-asked-for rigid round-6", "a"), reported
    (desk / "d.svg").write_text(text.replace('speed="7"', 'speed="26"'))
    status, _, reported = in_json(capsys, "convert", "d.svg", "-o", "out.ngc")
    assert status == 1 and is_reported(reported, "speed-out-of-range 26 [0.000001, 25]"), reported


def test_dxf_needs_its_units(desk, capsys):
    assert agrees(refusal(capsys, "convert", "d.dxf", "-o", "x.json"), "unit-unknown '--units mm'")
    passes, _ = plan(desk, capsys, "--units", "in", "--width", "3", drawing="d.dxf")
    assert [each["layer"] for each in passes] == ["INK"]
    assert main(["convert", "d.dxf", "-o", "x.json", "--units", "mm", "--select", "g"]) == 2


@pytest.mark.slow
def test_preview_of_strokes_shows_the_imported_lines(desk, capsys):
    for drawing, words in (("d.svg", []), ("d.dxf", ["--units", "mm"])):
        for suffix, start in ((".svg", b"<svg"), (".png", b"\x89PNG")):
            assert main(["preview", drawing, "-o", f"seen{suffix}", "--show", "strokes", *words]) == 0
            assert (desk / f"seen{suffix}").read_bytes().startswith(start)
    assert main(["preview", "d.svg", "-o", "seen.svg", "--show", "strokes", "--layer", "Ink"]) == 0
    words = re.findall(r"<text[^>]*>([^<]*)<", (desk / "seen.svg").read_text())
    assert "1  a: 3 mm, Ink" in words


def test_preview_of_strokes_shows_damage_that_convert_refuses(desk, capsys):
    (desk / "d.svg").write_text(DRAWING.replace("M30 60 H90", "M30 60 H90 L"))
    status, _, reported = in_json(capsys, "convert", "d.svg", "-o", "x.json", "--layer", "Red")
    assert status == 1 and is_reported(reported, "geometry-damaged 13", "b"), reported
    assert main(["preview", "d.svg", "-o", "seen.png", "--show", "strokes"]) == 0
    assert main(["convert", "d.svg", "-o", "x.json", "--layer", "Ink"]) == 0, "damage elsewhere does not count"


def test_filled_shapes_become_strokes_unless_they_are_empty(desk, capsys):
    (desk / "f.svg").write_text(DRAWING.replace('fill="none" stroke="#203060"', "").replace('stroke="red"', ""))
    reported = refusal(capsys, "convert", "f.svg", "-o", "x.json", "--as", "stroke")
    assert reported.code == "nothing-to-paint"
    assert main(["preview", "f.svg", "-o", "seen.png", "--show", "strokes", "--as", "stroke"]) == 0
    capsys.readouterr()
    bar = '<path id="bar" d="M20 20H70V26H20Z"/><rect id="wide" x="20" y="35" width="60" height="12"/>'
    (desk / "bar.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">{bar}</svg>'
    )
    passes, reported = plan(desk, capsys, "--wide", "clamp", drawing="bar.svg")
    assert [each["stroke"] for each in passes] == ["bar", "wide"]
    assert agrees(reported[0], "width-out-of-reach 12 nearest", "wide"), reported
    for flags in ((), ("--wide", "passes")):
        passes, _ = plan(desk, capsys, *flags, drawing="bar.svg")
        names = [each["stroke"] for each in passes]
        assert names == ["bar", "wide", *(f"wide~{k}" for k in range(2, len(passes)))] and len(names) > 4
    reported = refusal(capsys, "convert", "bar.svg", "-o", "x.json", "--wide", "refuse")
    assert agrees(reported, "width-out-of-reach 12", "wide") and "nearest" not in reported.text


def test_inkscape_fonts_are_found_by_their_names(desk, capsys, monkeypatch):
    (desk / "fonts").mkdir()
    (desk / "fonts" / "Lines.svg").write_text(
        """<svg xmlns="http://www.w3.org/2000/svg"><font horiz-adv-x="600"><font-face units-per-em="1000"/>
        <glyph unicode="T" d="M 0 700 L 500 700"/></font></svg>"""
    )
    monkeypatch.setattr("brushsvg.cli.commands.drawings.text.SINGLE_LINE_FONTS", desk / "fonts")
    for name in ("Lines.svg", "Lines"):
        assert main(["text", "T", "-o", f"by-{name}.svg", "--font", name]) == 0
    assert (desk / "by-Lines.svg").read_bytes() == (desk / "by-Lines.svg.svg").read_bytes()
    capsys.readouterr()
    reported = refusal(capsys, "text", "T", "-o", "t.svg", "--font", "./Lines.svg")
    assert reported.code == "file-unreadable"


def test_text(desk, capsys):
    font = """<svg xmlns="http://www.w3.org/2000/svg"><font horiz-adv-x="600"><font-face units-per-em="1000"/>
      <glyph unicode="T" d="M 0 700 L 500 700 M 250 700 L 250 0"/></font></svg>"""
    (desk / "font.svg").write_text(font)
    assert main(["text", "T\\nTT", "-o", "t.svg", "--font", "font.svg", "--size", "30", "--width", "2.5"]) == 0
    passes, reported = plan(desk, capsys, drawing="t.svg")
    assert (len(passes), reported) == (6, [])
    reported = refusal(capsys, "text", "T", "-o", "u.svg", "--font", "none.svg")
    assert agrees(reported, "file-unreadable Inkscape")
    reported = refusal(capsys, "text", "x", "-o", "u.svg", "--font", "font.svg")
    assert agrees(reported, "nothing-to-paint U+0078")
    for words in (["T", "-o", "t.png"], ["T", "-o", "t.svg", "--size", "0"], ["T"]):
        assert main(["text", *words, "--font", "font.svg"]) == 2


def test_unreachable_widths_are_one_line_with_a_remedy(desk, capsys):
    def drawing(width):
        lines = "".join(f'<path id="p{k}" d="M20 {20 + 5 * k}h40" stroke-width="{width}"/>' for k in range(6))
        size = 'width="80mm" height="60mm" viewBox="0 0 80 60" stroke="#000"'
        (desk / "w.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{lines}</svg>')

    drawing(0.3)
    for command in (("convert", "w.svg", "-o", "x.json"), ("preview", "w.svg", "-o", "x.png")):
        status, _, ((file, reported),) = in_json(capsys, *command, "--quiet")
        assert (status, file) == (0, "w.svg")
        assert agrees(reported, "depth-not-measured p0 5 0.36 [1.0, 10.0]")
        assert reported.advice.startswith("--width MM")
    passes, (reported,) = plan(desk, capsys, "--width", "0.3", drawing="w.svg")
    assert len(passes) == 6 and (reported.code, reported.advice) == ("depth-not-measured", "")
    drawing(30)
    reported = refusal(capsys, "convert", "w.svg", "-o", "x.json")
    assert agrees(reported, "width-out-of-reach 30.000", "p0")
    drawing('2" transform="translate(-30)')
    reported = refusal(capsys, "convert", "w.svg", "-o", "x.json")
    assert agrees(reported, "mark-off-sheet p0 5 left --fit")


def test_a_predicted_picture_states_its_settings_and_tracking_error(desk, capsys):
    (desk / "d.svg").write_text(DRAWING.replace("M30 60 H90", "M30 60 H90 L32 63"))
    assert main(["preview", "d.svg", "-o", "x.svg", "--corners", "turn"]) == 0
    text = (desk / "x.svg").read_text()
    assert 'data-made="round-6, closed"' in text
    missed = re.findall(r'data-stroke="(.)" data-tracking-error-mm="([0-9.]+)"( data-off-line="yes")?', text)
    assert [(name, bool(is_missed)) for name, _, is_missed in missed] == [("a", False), ("b", True)]
    assert float(missed[0][1]) < 0.05 < float(missed[1][1])


@pytest.mark.parametrize(("d", "is_marked"), [("M20 60C80 75 20 75 80 60", False), ("M30 60H60L40 62", True)])
def test_a_stroke_is_marked_only_beyond_the_uncertainty_of_the_brush(desk, capsys, d, is_marked):
    """A stroke is marked only if its error exceeds the brush's uncertainty.

    An error of 0.095 mm (tolerance 0.05 mm) was once red and reported, although the brush's lag is known only
    to 0.58 mm.
    """
    (desk / "d.svg").write_text(DRAWING.replace("M30 60 H90", d))
    assert main(["preview", "d.svg", "-o", "x.svg", "--corners", "turn"]) == 0
    assert ("d.svg: b: " in capsys.readouterr().err) == is_marked
    text = (desk / "x.svg").read_text()
    ((miss, marked),) = re.findall(r'data-stroke="b" data-tracking-error-mm="([0-9.]+)"( data-off-line="yes")?', text)
    assert float(miss) > 0.05
    assert bool(marked) == is_marked


def test_an_exactly_known_brush_gets_warnings_about_smaller_errors(desk, capsys):
    """A brush that is known exactly gets warnings about smaller errors.

    The error is 0.095 mm again, but this brush's lag is known to 0.01 mm.
    """
    (desk / "d.svg").write_text(DRAWING.replace("M30 60 H90", "M20 60C80 75 20 75 80 60"))
    text = (Path(brushsvg.__file__).parent / "data/brushes/round-6.json").read_text()
    (desk / "exact.json").write_text(text.replace('"rmse_mm": 0.58', '"rmse_mm": 0.01'))
    assert main(["preview", "d.svg", "-o", "x.svg", "--brush", "exact.json"]) == 0
    assert "d.svg: b: " in capsys.readouterr().err
    assert 'data-off-line="yes"' in (desk / "x.svg").read_text()


def test_a_width_is_suggested_only_for_lines(desk, capsys):
    """A width is suggested only for lines.

    An outline has no single width. --width was once suggested for outlines, and then reported as without
    effect.
    """
    hair = '<path id="hair" fill="none" stroke="#000" stroke-width="0.3" d="M10 10H80"/>'
    sliver = '<path id="sliver" d="M10 40H80V40.3H10Z"/>'
    spike = '<path id="spike" d="M10 44h14v6.75l20 0.25l-20 0.25v6.75h-14z"/>'  # wider than the brush, and thin
    size = 'width="100mm" height="60mm" viewBox="0 0 100 60"'
    (desk / "thin.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{hair}{sliver}{spike}</svg>')
    _, reported = plan(desk, capsys, drawing="thin.svg")
    thin = {each.where: each.advice for each in reported if each.code == "depth-not-measured"}
    of_shapes = {name: advice for name, advice in thin.items() if name != "hair"}
    assert any(name.startswith("spike~") for name in of_shapes), "the search added a thin stroke"
    assert "sliver" in of_shapes and not any(of_shapes.values())
    (width,) = re.findall(r"--width MM, [a-z]+ ([0-9.]+)", thin["hair"])
    _, reported = plan(desk, capsys, "--width", str(float(width) + 0.05), drawing="thin.svg")
    assert "hair" not in {each.where for each in reported if each.code == "depth-not-measured"}


def test_a_report_names_every_stroke_that_cannot_be_painted(desk, capsys):
    text = DRAWING.replace('id="b"', 'id="b" stroke-width="30"')
    bad = "".join(f'<path id="c{k}" stroke-width="{20 + k}" d="M30 {70 + k} H90"/>' for k in range(5))
    (desk / "d.svg").write_text(text.replace("</svg>", bad + "</svg>"))
    status, out, reported = in_json(capsys, "preview", "d.svg", "--json")
    assert status == 1
    report = json.loads(out)
    assert [each["where"] for each in report["refused"]] == ["b", "c0", "c1", "c2", "c3", "c4"]
    assert agrees(read(report["refused"][3]), "width-out-of-reach 22.000")
    assert [each["stroke"] for each in report["strokes"]] == ["a"]
    assert agrees(reported[-1][1], "width-out-of-reach b 5 30.000")
    assert main(["preview", "d.svg"]) == 1
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "30.000" in line]
    assert gives(line, "6", "b", "5", "0.28")
    assert main(["convert", "d.svg", "-o", "x.ngc"]) == 1
    assert not (desk / "x.ngc").exists()


def test_a_report_names_outlines_that_are_too_wide_and_refused(desk, capsys):
    fat = '<path id="fat" fill="#000" stroke="none" d="M30 60h60v14h-60z"/>'
    too_wide = '<path id="line" stroke-width="30" d="M30 50h60"/>'
    (desk / "d.svg").write_text(DRAWING.replace("</svg>", f"{fat}{too_wide}</svg>"))
    assert main(["preview", "d.svg", "--json", "--wide", "refuse"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert [each["where"] for each in report["refused"]] == ["fat", "line"]
    assert agrees(read(report["refused"][0]), "width-out-of-reach 14")
    assert [each["stroke"] for each in report["strokes"]] == ["a", "b"]
    assert main(["preview", "d.svg", "--select", "#fat", "--wide", "refuse"]) == 1
    assert main(["preview", "d.svg", "--all-brushes", "--wide", "refuse"]) == 0
    assert main(["convert", "d.svg", "-o", "x.ngc", "--wide", "refuse"]) == 1


def test_a_report_lists_the_warnings_that_prevent_a_program(desk, capsys):
    (desk / "d.svg").write_text(DRAWING.replace("M30 60 H90", "M-3 60 H90"))
    assert main(["preview", "d.svg", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert {each["where"] for each in report["forbidden"]} == {"b"}
    assert all(each in report["warnings"] for each in report["forbidden"])
    assert main(["convert", "d.svg", "-o", "d.ngc"]) == 1


def test_ends_below_the_measured_depths_cause_no_warning(desk, capsys):
    """Line ends at less depth than was measured cause no warning.

    In a word of 19 script strokes, 16 once had a warning about 0.09 mm at the point of their foot.
    """
    drop = '<path id="p{}" transform="translate({})" d="M10 10C18 30 16 45 10 50C8 45 8 30 10 10Z"/>'
    drops = "".join(drop.format(k, 12 * k) for k in range(5))
    hair = '<path id="hair" fill="none" stroke="#000" stroke-width="0.3" d="M10 55H80"/>'
    (desk / "drops.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">{drops}{hair}</svg>'
    )
    _, reported = plan(desk, capsys, drawing="drops.svg")
    assert [each.where for each in reported if each.code == "depth-not-measured"] == ["hair"]


def test_a_warning_about_a_dot_uses_the_depth_of_its_turn(desk, capsys):
    """The warning about a dot depends on the depth at which the dot is turned.

    A dot is pressed less than a line of the same width: 0.87 mm, where the line is at 1.0 mm.
    """
    dots = "".join(f'<path d="M{x} 30h0.01" stroke-width="{w}"/>' for x, w in ((20, 1.02), (40, 1.2), (60, 3)))
    (desk / "dots.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
        f'<g stroke="#000" stroke-linecap="round">{dots}</g></svg>'
    )
    for start, count in (("round", 1), ("pointed", 0)):
        passes, reported = plan(desk, capsys, "--start", start, drawing="dots.svg")
        thin = [each for each in reported if each.code == "depth-not-measured"]
        depths = [-min(z for _, _, z in each["poses_mm"]) for each in passes]
        assert [each.where for each in thin] == [
            each["stroke"] for each, d in zip(passes, depths, strict=True) if d < 1.0
        ]
        assert len(thin) == count


def test_a_line_that_is_too_wide_is_refused_before_shapes_are_filled(desk, monkeypatch):
    """A line that is too wide is refused before shapes are filled.

    Twelve letters one metre high were once filled first.
    """
    from brushsvg.jobs.preparation import preparation

    monkeypatch.setattr(preparation, "within_reach", lambda *_: pytest.fail("shapes were filled"))
    (desk / "wide.svg").write_text(DRAWING.replace('id="b"', 'id="b" stroke-width="12"'))
    for compensation in ("none", "constant", "closed", "refined"):
        with refused("width-out-of-reach 12.000", "b"):
            brushsvg.convert("wide.svg", compensation=compensation)
    monkeypatch.undo()
    for compensation in ("none", "constant", "closed"):  # The planner refuses the width, too.
        with refused("width-out-of-reach 12.000", "b"):
            strokes = brushsvg.strokes(brushsvg.read_drawing(desk / "wide.svg"))[0]
            brushsvg.compensate(strokes, brushsvg.find_brush("round-6"), (160, 90), compensation)
