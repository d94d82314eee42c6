"""Wrong usage is refused, and help lists only existing features."""

import re

import pytest
from command import brushsvg, refused

USAGE = [
    "",
    "paint sound.svg out.ngc",
    "convert",
    "convert sound.svg",
    "convert sound.svg -o out.ngc more",
    "convert sound.svg -o out",
    "convert sound.svg -o out.txt",
    "convert sound.svg -o out.png",
    "convert sound -o out.ngc",
    "convert sound.pdf -o out.ngc",
    "preview sound.svg -o out.ngc",
    "preview sound.svg -o out.pdf",
    "preview sound.svg -o out.html --playback 0",
    "preview sound.svg -o out.html --playback nan",
    "preview sound.svg -o out.png --playback 2",
    "preview sound.svg --show strokes",
    "preview sound.svg --show errors",
    "preview sound.svg -o out.json --show errors",
    "preview sound.svg -o out.png --editable",
    "preview sound.svg -o out.png --json",
    "preview sound.svg --band",
    "preview sound.svg -o out.png --all-brushes",
    "preview",
    "preview sound.svg --yaml",
    "convert sound.svg -o out.ngc --quick",
    "convert sound.svg -o out.ngc --brush",
    "convert sound.svg -o out.ngc --sheet large",
    "convert sound.svg -o out.ngc --sheet -1x5",
    "convert sound.svg -o out.ngc --tolerance nan",
    "convert sound.svg -o out.ngc --tolerance 0",
    "convert sound.svg -o out.ngc --compensation best",
    "convert sound.svg -o out.ngc --compensation constant --lag 1e9",
    "convert sound.svg -o out.ngc --report out.ngc",
    "convert sound.svg -o ./sound.svg",
    "brush",
    "batch",
    "batch in -o x --words w.txt",
    "batch in -o x --jobs 0",
    "batch in -o x --format .txt",
    "brush wash round-6",
]
# features of the package rules that do not exist yet: neither accepted nor in the help
LATER = {
    "flags": ["--caps"],
    "commands": ["learn"],
    "formats": [".pdf", ".krl"],
}
OUTPUT = r"(?ms)--output OUT  .*?(?=^  -|^$)"  # the lines of -o in a help page
PAGES = [
    [],
    ["convert"],
    ["preview"],
    ["text"],
    ["batch"],
    ["brush"],
    ["cell"],
    ["cell", "list"],
    ["cell", "show"],
    ["cell", "check"],
    ["cell", "new"],
    ["setup", "border"],
    ["check"],
    ["setup", "height"],
    ["setup", "first-run"],
    ["brush", "list"],
    ["brush", "show"],
    ["brush", "check"],
    ["brush", "new"],
    ["brush", "plot"],
    ["calibrate"],
    ["chart"],
    ["demo"],
    ["doctor"],
    ["setup", "inkscape"],
]


@pytest.mark.parametrize("words", USAGE)
def test_wrong_usage_is_refused(desk, words):
    assert "--help" in refused(desk, *words.split(), status=2)


def test_planned_features_are_refused_as_wrong_usage(desk):
    for flag in LATER["flags"]:
        refused(desk, "convert", "sound.svg", "-o", "out.ngc", flag, "5", status=2)
    for command in LATER["commands"]:
        refused(desk, command, "sound.svg", "out.svg", status=2)
    for suffix in LATER["formats"]:
        refused(desk, "convert", "sound.svg", "-o", f"out{suffix}", status=2)


def test_help_lists_only_existing_features(desk):
    pages = {tuple(page): brushsvg(*page, "--help", cwd=desk, status=0).out for page in PAGES}
    with_pages = (("chart",), ("convert",))  # these outputs may be PDFs
    text = "\n".join(page for words, page in pages.items() if words not in with_pages)
    for absent in (*LATER["flags"], *LATER["formats"]):
        assert not re.search(rf"{re.escape(absent)}\b", text), absent
    commands = set(re.findall(r"(?m)^  ([a-z]+)(?: |$)", pages[()]))
    assert commands == {
        *("demo", "init", "doctor", "text", "preview", "convert", "check", "batch", "cell", "setup"),
        *("brush", "chart", "calibrate", "compare"),
    }
    assert set(re.findall(r"(?m)^    ([a-z]+) ", pages[("brush",)])) == {
        "list",
        "show",
        "check",
        "new",
        "plot",
    }
    for page, text in pages.items():
        for flag in set(re.findall(r"--[a-z-]+", text)) - {"--help", "--help-all"}:
            done = brushsvg(
                *page, flag, cwd=desk
            )  # operands are missing, and the flag must not be reported as the error
            assert "unrecognized arguments" not in " ".join(done.err), (page, flag)
    # the command accepts every extension in its help
    values = {"IN": "sound.svg", "--brush": "round-6"}
    for suffix in re.findall(r"\.\w+\b", re.search(OUTPUT, pages[("convert",)])[0]):
        if suffix == ".robodk":
            continue  # needs a post processor of the user
        cell = {
            ".script": ("--cell", "ur5e"),
            ".jks": ("--cell", "jaka-zu3"),
            ".mod": ("--cell", "irb120"),
            ".py": ("--cell", "xarm6"),
            ".src": ("--cell", "kr6-r900"),
            ".lua": ("--cell", "cr5"),
            ".ls": ("--cell", "lrmate200id"),
            ".drl": ("--cell", "m0609"),
            ".csv": ("--cell", "fr3"),
            ".traj": ("--cell", "fr3"),
            ".cdr": ("--cell", "fr3"),
            ".ebb": ("--cell", "axidraw-ebb"),
            ".hpgl": ("--cell", "hpgl-plotter", "--brush", "rigid"),
            ".plt": ("--cell", "hpgl-plotter", "--brush", "rigid"),
        }.get(suffix, ())
        brushsvg("convert", values["IN"], "-o", f"made{suffix}", *cell, cwd=desk, status=0)
    for suffix in re.findall(r"\.\w+\b", re.search(OUTPUT, pages[("preview",)])[0]):
        brushsvg("preview", values["IN"], "-o", f"seen{suffix}", cwd=desk, status=0)
    for flag in ("picture", "report", "page"):
        says = re.search(rf"(?s)--{flag} FILE .*?\((.*?)\)", pages[("convert",)])[1]
        for suffix in says.split():
            brushsvg("convert", values["IN"], "-o", "made.ngc", f"--{flag}", f"{flag}{suffix}", cwd=desk, status=0)
    made = {each.name for each in desk.iterdir()} - {"sound.svg", "old.ngc", "brushsvg-demo.png"}
    assert made == {
        *(
            "made.json",
            "made.ngc",
            "made.gcode",
            "made.nc",
            "made.script",
            "made.jks",
            "made.mod",
            "made.py",
            "made.src",
            "made.lua",
            "made.ls",
            "made.drl",
            "made.csv",
            "made.traj",
            "made.cdr",
            "made.ebb",
            "made.hpgl",
            "made.plt",
            "page.pdf",
            "page.svg",
            "seen.png",
            "seen.svg",
            "seen.json",
        ),
        *("picture.png", "picture.svg", "seen.html", "report.txt", "report.json", "report.csv"),
    }


def test_the_version_is_reported(desk):
    assert re.fullmatch(r"brushsvg \d+\.\d+\.\d+\n", brushsvg("--version", cwd=desk, status=0).out)
