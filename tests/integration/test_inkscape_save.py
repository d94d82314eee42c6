"""Saving a robot program from Inkscape gives the bytes of the command line or a sentence."""

import subprocess
from xml.etree import ElementTree

import pytest
from command import SOUND, brushsvg, path
from diagnostics import gives
from plugin import SOURCE, sentence

from brushsvg import brush_names, cell_names, find_cell
from brushsvg.machine.posts import POSTS
from brushsvg.strokes.wide_shapes import WIDE

SCHEMA = "/usr/share/inkscape/extensions/inkscape.extension.rng"
GROUPS = """<svg xmlns="http://www.w3.org/2000/svg" width="6in" height="90mm" viewBox="10 5 300 200"
 xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape">
 <g inkscape:groupmode="layer" inkscape:label="Ink" id="layer1" transform="translate(40,30)">
  <g id="turned" transform="rotate(-10) scale(1.2)">
   <path id="wave" d="M 10,40 C 20,0 40,0 50,20 S 80,40 90,20" style="fill:none;stroke:#102030;stroke-width:5"/></g>
  <path id="bar" d="M 20,90 H 160" style="fill:none;stroke:#a00000;stroke-width:4"/></g>
</svg>"""
DRAWINGS = {
    "sound": SOUND,
    "groups": GROUPS,
    "settings": SOUND.replace("<svg ", '<svg data-brushsvg-brush="rigid" data-brushsvg-tolerance="0.1mm" '),
}


ENTRIES = {  # entry of the menu: extension, and the equivalent command line
    "gcode": ("ngc", ("convert",)),
    "plan": ("json", ("convert",)),
    "urscript": ("script", ("convert", "--cell", "ur5e")),
    "marks": ("json", ("preview",)),
    "animation": ("html", ("preview",)),
}


@pytest.mark.parametrize("name", DRAWINGS)
@pytest.mark.parametrize("entry", ENTRIES)
def test_saving_gives_the_bytes_of_the_command_line(plugin, tmp_path, name, entry):
    extension, (command, *flags) = ENTRIES[entry]
    drawing, saved = tmp_path / "drawing.svg", tmp_path / f"saved.{extension}"
    drawing.write_text(DRAWINGS[name])
    plugin.save(drawing, saved, entry)
    brushsvg(command, "drawing.svg", "-o", f"typed.{extension}", *flags, cwd=tmp_path, status=0)
    assert saved.read_bytes() == (tmp_path / f"typed.{extension}").read_bytes()


# an xArm 7 needs half a minute to prepare its angles in each home folder; its language is that of xArm 6
@pytest.mark.parametrize("cell", [name for name in cell_names() if name != "xarm7"])
def test_every_machine_gets_its_own_language(plugin, tmp_path, cell):
    extension = POSTS[find_cell(cell).language].extensions[0]
    extension = ".plt" if extension == ".hpgl" else extension  # Inkscape's own exporter has .hpgl
    drawing, saved = tmp_path / "drawing.svg", tmp_path / f"saved{extension}"
    drawing.write_text(SOUND)
    entry = {
        ".script": "urscript",
        ".jks": "jaka",
        ".mod": "rapid",
        ".py": "xarm",
        ".src": "krl",
        ".lua": "dobot",
        ".ls": "fanuc",
        ".drl": "doosan",
        ".csv": "ros2",
        ".ebb": "ebb",
        ".plt": "hpgl",
    }.get(extension, "gcode")
    pen = {f"save.{entry}__brush": "rigid"} if find_cell(cell).pen else {}  # this machine has one depth
    plugin.set(**{f"save.{entry}__cell": cell}, **pen)
    try:
        plugin.save(drawing, saved)
    finally:
        plugin.set()
    (tmp_path / "typed").mkdir()
    typed = tmp_path / "typed" / f"drawing{extension}"  # some languages name the program after its file
    brushsvg(
        "convert",
        "drawing.svg",
        "-o",
        typed,
        "--cell",
        cell,
        *(["--brush", "rigid"] if pen else []),
        cwd=tmp_path,
        status=0,
    )
    assert saved.read_bytes() == typed.read_bytes()


def test_file_types_of_inkscape_keep_their_extensions(plugin, tmp_path):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(SOUND)
    for extension, begin in (
        ("json", b'{\n  "format": "brushsvg/plan"'),
        ("html", b"\n<!DOCTYPE html>\n<html>\n"),
    ):
        plugin.save(drawing, tmp_path / f"saved.{extension}")
        assert (tmp_path / f"saved.{extension}").read_bytes().startswith(begin)


def test_dialog_settings_override_document_settings(plugin, tmp_path):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(DRAWINGS["settings"])
    for words, brush in (
        ((), b"rigid"),
        (("--brush=document",), b"rigid"),
        (("--brush=round-6",), b"round-6"),
    ):
        program = plugin.script("save", drawing, *words).stdout
        assert b"brush: " + brush in program


def test_warnings_are_shown_next_to_the_program(plugin, tmp_path):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(SOUND.replace("</svg>", '<text id="word" x="10" y="10">a</text></svg>'))
    done = plugin.script("save", drawing)
    assert done.returncode == 0 and done.stdout
    assert b"Saved. brushsvg warns:\nword: text is not read" in done.stderr


def test_a_refusal_is_shown_and_nothing_written(plugin, tmp_path):
    drawing, saved = tmp_path / "drawing.svg", tmp_path / "saved.ngc"
    drawing.write_text(path("M20 30 H90", width="30"))
    plugin.save(drawing, saved)
    assert not saved.exists()
    reported = sentence(plugin.script("save", drawing))
    assert reported.splitlines()[1].startswith("p: ") and gives(reported, "30.000 mm")


CHECK = """
import sys
from lxml import etree
schema = etree.RelaxNG(etree.parse(sys.argv[1]))
for file in sys.argv[2:]:
    schema.assertValid(etree.parse(file))
"""


def test_a_job_of_several_programs_is_refused(plugin, tmp_path):
    lines = "".join(
        f'<path d="M20 {y}Q40 {y - 9} 60 {y}T100 {y}T140 {y}T180 {y}" fill="none" stroke="#000" stroke-width="3"/>'
        for y in range(15, 290, 3)
    )
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="300mm" viewBox="0 0 200 300">'
    (tmp_path / "drawing.svg").write_text(f"{head}{lines}</svg>")
    wide = brushsvg("cell", "new", "-o", "wide.toml", "--like", "ur5e", cwd=tmp_path, status=0)
    assert wide is not None
    words = ["--format=script", f"--cell_file={tmp_path / 'wide.toml'}"]
    reported = sentence(plugin.script("save", tmp_path / "drawing.svg", *words))
    assert gives(reported, "several", "OUT.script")


def test_extension_descriptions_are_valid_in_inkscapes_schema(tmp_path):
    files = sorted(map(str, SOURCE.glob("*.inx")))
    assert len(files) >= 9
    subprocess.run(["/usr/bin/python3", "-c", CHECK, SCHEMA, *files], check=True)


def options(file, parameter):
    root = ElementTree.parse(file).getroot()
    own = "{http://www.inkscape.org/namespace/inkscape/extension}"
    found = [each for each in root.iter(f"{own}param") if each.get("name") == parameter]
    return {option.get("value") for each in found for option in each} - {"document", "keep", "default"}


def test_dialogs_offer_shipped_brushes_and_cells():
    for file in SOURCE.glob("*.inx"):
        assert options(file, "brush") in (set(), set(brush_names())), file
        assert options(file, "cell") <= set(cell_names()), file
        assert options(file, "wide") in (set(), set(WIDE)), file


def test_every_language_can_be_saved():
    saved = {file.read_text().split("<extension>")[1].split("<")[0] for file in SOURCE.glob("*save*.inx")}
    posts = [post for name, post in POSTS.items() if name != "robodk"]  # this entry needs a file of the user
    endings = {post.extensions[0] for post in posts}
    endings = endings - {".hpgl"} | {".plt"}  # Inkscape's own exporter has .hpgl
    assert saved == endings | {".json", ".html"}
