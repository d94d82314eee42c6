"""Every pair of option values works through the command line (allpairspy).

Each row ends in all promised files, and the next command can use them.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from allpairspy import AllPairs
from desk import SHEET, STUDIO, photograph
from diagnostics import in_json
from sampling import sample

DRAWING = f"""<svg {SHEET} xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape">
<g inkscape:groupmode="layer" inkscape:label="Ink" id="ink">
<path id="line" fill="none" stroke="#000000" stroke-width="2.4" d="M20 20C40 10 60 30 80 20"/>
<path id="more" fill="none" stroke="#000000" stroke-width="2.4" d="M80 20L84 30"/></g>
<g inkscape:groupmode="layer" inkscape:label="Red" id="red">
<path id="shape" fill="#c00000" d="M20 35H26V60H20Z"/></g></svg>"""

# For each option: not given (""), then its values.
OPTIONS = {
    "--brush": ["", "round-6-angles"],
    "--cell": ["", "ur5e", "grbl-servo"],
    "--sheet": ["", "120x90"],
    "--layer": ["", "Ink"],
    "--select": ["", "#line"],
    "--background": ["", "keep"],
    "--width": ["", "2.2"],
    "--as": ["", "outline"],
    "--placed": ["", "--fit 60x40", "--scale 120%", "--origin 15,12"],
    "--colour": ["", "#000000"],
    "--wide": ["", "clamp", "passes", "refuse"],
    "--corners": ["", "turn"],
    "--detail": ["", "draft", "fine"],
    "--script": ["", "latin", "arabic", "devanagari", "cjk"],
    "--join": ["", True],
    "--compensation": ["", "none", "constant", "closed", "refined"],
    "--tolerance": ["", "0.1"],
    "--terminals": ["", "round", "butt", "pointed"],
    "--start": ["", "pointed", "round", "butt"],
    "--end": ["", "round", "butt", "pointed"],
    "--lenient": ["", True],
    "--speed": ["", "8"],
    "--z-offset": ["", "-0.2"],
    "--order": ["", "nearest"],
}
OF_CONVERT = {
    "--margin-strokes": ["", "on", "off"],
    "--from-stroke": ["", "2"],
    "--per-colour": ["", True],
    "--picture": ["", "seen.png", "seen.svg"],
    "--page": ["", "page.svg"],
    "--report": ["", "report.txt", "report.json"],
}
FILES = ("--picture", "--page", "--report")


def words_of(options: dict) -> list[str]:
    words: list[str] = []
    for flag, value in options.items():
        if value is True:
            words.append(flag)
        elif value:
            words += [flag] * (flag != "--placed") + str(value).split()
    return words


# Pairs of values that contradict each other, as `--help` says. Both together are wrong usage.
APART = [
    ("--per-colour", "--from-stroke"),
    ("--per-colour", "--colour"),
    ("--per-colour", "--margin-strokes"),
    ("--colour", "--margin-strokes"),
]
ENDS = ("--terminals", "--start", "--end")
# these options leave one stroke, so there is no second
SINGLE = [("--from-stroke", "--select"), ("--from-stroke", "--layer"), ("--from-stroke", "--colour")]


def rows(options: dict) -> list[dict]:
    names = [*options]

    def is_offered(row: list) -> bool:
        values = dict(zip(names, row, strict=False))
        given = {name for name, value in values.items() if value and value != "off"}
        has_ends = values.get("--compensation") not in ("none", "constant")  # these follow the line up to its ends
        return not any({a, b} <= given for a, b in APART + SINGLE) and (has_ends or given.isdisjoint(ENDS))

    return [dict(zip(names, row, strict=True)) for row in AllPairs([*options.values()], filter_func=is_offered)]


@pytest.fixture
def desk(tmp_path, monkeypatch):
    (tmp_path / "d.svg").write_text(DRAWING)
    (tmp_path / "studio.toml").write_text(STUDIO)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys, *words) -> None:
    status, _, reported = in_json(capsys, *words)
    assert status == 0, (words, reported)


def some_of(options: dict, *names: str) -> list[str]:
    return [word for name in names for word in words_of({name: options.get(name, "")})]


def title(options: dict) -> str:
    return " ".join(words_of(options))


@sample("options", rows(OPTIONS | OF_CONVERT), keep=10, ids=title)
def test_each_pair_of_options_of_convert_works(desk, capsys, options):
    suffix = {"ur5e": ".script", "grbl-servo": ".nc"}.get(options["--cell"], ".ngc")
    run(capsys, "convert", "d.svg", "-o", f"out{suffix}", *words_of(options))
    made = {each.name for each in desk.iterdir()}
    programs = {name for name in made if name.endswith(suffix)}
    assert programs and {options[flag] for flag in FILES if options[flag]} <= made
    for program in programs:
        colour = ["--colour", f"#{Path(program).stem[-6:]}"] if options["--per-colour"] else []
        run(capsys, "check", program, "d.svg", *some_of(options, *CHECKED), *colour)


CHECKED = (
    *("--brush", "--cell", "--sheet", "--layer", "--select", "--background", "--width", "--as", "--placed"),
    *("--colour", "--wide", "--corners", "--detail", "--script", "--join", "--speed", "--lenient"),
)


@sample("options", rows(OPTIONS), keep=4, ids=title)
def test_batch_and_convert_agree_for_each_pair_of_options(desk, capsys, options):
    suffix = {"ur5e": ".script", "grbl-servo": ".nc"}.get(options["--cell"], ".ngc")
    run(capsys, "convert", "d.svg", "-o", f"one{suffix}", *words_of(options))
    run(capsys, "batch", "d.svg", "-o", "many", "--jobs", 1, *words_of(options))
    (made,) = (desk / "many/programs").iterdir()
    assert made.suffix == suffix or options["--cell"] == "grbl-servo"  # grbl-servo has several endings
    assert made.read_bytes() == (desk / f"one{suffix}").read_bytes()


MORE = "".join(
    f'<path id="more-{y}" fill="none" stroke="#000000" stroke-width="2.4" d="M38 {y}C50 {y - 6} 70 {y + 6} 88 {y}"/>'
    for y in (40, 50, 60)
)
OF_COMPARE = {
    "-o": ["", "fit.json", "fit.txt"],
    "--picture": ["", "seen.png"],
    "--corrected-cell": ["", "corrected.toml"],
    "--at-least": ["", "0.2"],
    "--json": ["", True],
    "--margin-strokes": ["", "on"],
}
OF_PAINTED = {  # options for planning and comparing a photograph; one line is not enough to compare
    name: OPTIONS[name]
    for name in (
        *(
            "--brush",
            "--cell",
            "--width",
            "--placed",
            "--corners",
            "--detail",
            "--script",
            "--join",
            "--compensation",
            "--terminals",
            "--start",
        ),
        *("--end", "--tolerance", "--lenient"),
    )
}


@sample("options", rows(OF_PAINTED | OF_COMPARE), keep=4, ids=title)
def test_each_pair_of_options_of_compare_works(desk, capsys, options):
    (desk / "d.svg").write_text(DRAWING.replace("</svg>", f"{MORE}</svg>"))
    planned = some_of(options, *OF_PAINTED, "--margin-strokes")
    run(capsys, "simulate-photo", "d.svg", "-o", "photo.jpg", "--studio", "studio.toml", *planned)
    run(capsys, "compare", "photo.jpg", "d.svg", *words_of(options))
    made = {each.name for each in desk.iterdir()}
    assert {options[flag] for flag in ("-o", "--picture", "--corrected-cell") if options[flag]} <= made
    if options["-o"] == "fit.json":
        suffix = {"ur5e": ".script", "grbl-servo": ".nc"}.get(options["--cell"], ".ngc")
        words = "convert", "d.svg", "-o", f"next{suffix}", *planned
        before, _, _ = in_json(capsys, *words)  # a long round end may leave the sheet
        status, _, reported = in_json(capsys, *words, "--corrections", "fit.json", "--force")
        # A corrected stroke may need a larger depth than this servo has.
        is_deep = options["--cell"] == "grbl-servo" and reported and reported[-1][1].code == "too-low"
        assert status == before or is_deep, reported


OF_CALIBRATE = {
    "--marks-picture": ["", "read.png"],
    "--picture": ["", "laws.png", "laws.svg"],
    "--aim": [
        "",
        "edges",
        "overlap",
    ],
    "--machine": ["", "lean", "axes,tilt --cell linuxcnc-3axis", "lean,axes --cell ur5e"],
    "--height": ["", "0.05"],
    "--bar": ["", "110"],
    "--norm": ["", "squares"],
}


@pytest.fixture(scope="module")
def chart(tmp_path_factory):
    """Return a painted and photographed chart."""
    folder = tmp_path_factory.mktemp("chart")
    photograph(folder / "chart", "--sheet", "a5")
    return folder


@sample("options", rows(OF_CALIBRATE), keep=3, ids=title)
def test_each_pair_of_options_of_calibrate_works(chart, tmp_path, capsys, monkeypatch, options):
    monkeypatch.chdir(tmp_path)
    photo, file = chart / "chart.jpg", chart / "chart.chart.json"
    run(capsys, "calibrate", photo, "--chart", file, "-o", "mine.json", *words_of(options))
    made = {each.name for each in tmp_path.iterdir()}
    assert {
        "mine.json",
        *(options[flag] for flag in ("--picture", "--marks-picture") if options[flag]),
    } <= made
    (tmp_path / "d.svg").write_text(DRAWING)
    run(capsys, "convert", "d.svg", "-o", "out.ngc", "--brush", "mine.json")
