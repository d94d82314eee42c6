"""Brush settings in Inkscape store changed fields, keep the others, and report all."""

from xml.etree import ElementTree

import pytest
from command import SOUND, brushsvg
from diagnostics import gives
from plugin import SOURCE, sentence

from brushsvg import __version__
from brushsvg.jobs.options import DEFAULT_BRUSH, Options

MACHINES = "the usual machine of the format that you save"
STORED = {"brush": "mine", "cell": "grbl-servo", "tolerance": "0.1mm", "speed": "7"}


@pytest.fixture
def drawing(tmp_path):
    file = tmp_path / "drawing.svg"
    attributes = " ".join(f'data-brushsvg-{name}="{value}"' for name, value in STORED.items())
    file.write_text(SOUND.replace("<svg ", f"<svg {attributes} "))
    return file


def stored(text) -> dict:
    attributes = ElementTree.fromstring(text).attrib
    prefix = "data-brushsvg-"
    return {key.removeprefix(prefix): value for key, value in attributes.items() if key.startswith(prefix)}


def test_unchanged_settings_stay_and_are_reported(plugin, drawing):
    done = plugin.script("settings", drawing)
    assert stored(done.stdout) == STORED
    _, *settings, used = done.stderr.decode().splitlines()
    assert used.endswith(f"(brushsvg {__version__})")
    values = [line.split()[-1] for line in settings]
    assert values == ["mine", "closed", "auto", "auto", "grbl-servo", "auto", "0.1mm", "7"]


@pytest.mark.parametrize(
    ("word", "changed", "reported"),
    [
        ("--brush=rigid", {"brush": "rigid"}, ("rigid", "mine")),
        ("--brush=default", {"brush": None}, ("round-6", "mine")),
        ("--compensation=none", {"compensation": "none"}, ("none",)),
        ("--start=round", {"start": "round"}, ("round",)),
        ("--start=butt", {"start": "butt"}, ("butt",)),
        ("--end=butt", {"end": "butt"}, ("butt",)),
        (
            "--cell=default",
            {"cell": None},
            (MACHINES, "grbl-servo"),
        ),
        ("--wide=passes", {"wide": "passes"}, ("passes",)),
        ("--tolerance=0.2", {"tolerance": "0.2mm"}, ("0.2mm", "0.1mm")),
        ("--tolerance= 0,2 mm", {"tolerance": "0.2mm"}, ("0.2mm", "0.1mm")),
        ("--tolerance=default", {"tolerance": None}, ("0.05mm", "0.1mm")),
    ],
)
def test_one_field_changes_one_setting(plugin, drawing, word, changed, reported):
    done = plugin.script("settings", drawing, word)
    expected = {name: value for name, value in {**STORED, **changed}.items() if value is not None}
    assert stored(done.stdout) == expected
    _, *settings, used = done.stderr.decode().splitlines()
    assert used.endswith(f"(brushsvg {__version__})")
    (line,) = [line for line in settings if line.endswith(")")]
    assert gives(line, *reported)


@pytest.mark.parametrize(
    ("typed", "reported"),
    [
        ("fine", ("'fine'", "default")),
        ("0", ("0 mm", "[1e-05, 10] mm")),
        ("1e9", ("1e+09 mm", "[1e-05, 10] mm")),
        ("nan", ("nan mm", "[1e-05, 10] mm")),
    ],
)
def test_an_invalid_tolerance_is_reported(plugin, drawing, typed, reported):
    assert gives(sentence(plugin.script("settings", drawing, f"--tolerance={typed}")), *reported)


def test_the_dialog_shows_the_defaults_of_brushsvg(monkeypatch):
    monkeypatch.syspath_prepend(SOURCE)
    from brushsvg_settings import OWN

    options = Options()
    assert {
        "brush": DEFAULT_BRUSH,
        "compensation": options.compensation,
        "start": options.start,
        "end": options.end,
        "cell": MACHINES,
        "wide": options.wide,
        "tolerance": f"{options.tolerance_mm}mm",
    } == OWN
    dialog = (SOURCE / "brushsvg_settings.inx").read_text()
    for name in ("brush", "compensation", "start", "end", "cell", "wide"):
        assert f"brushsvg's default: {OWN[name]}<" in dialog
    assert gives(dialog, "0.05 mm")


def test_the_command_line_uses_settings_stored_by_inkscape(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(SOUND)
    chosen = {"brush": "rigid", "compensation": "none", "cell": "ur5e", "wide": "refuse", "tolerance": "0.2"}
    plugin.set(**{f"settings__{name}": value for name, value in chosen.items()})
    try:
        saved = plugin.effect("settings", source, tmp_path / "said.svg")
    finally:
        plugin.set()
    brushsvg("convert", "said.svg", "-o", "said.script", cwd=tmp_path, status=0)
    flags = [word for name, value in chosen.items() for word in (f"--{name}", value)]
    brushsvg("convert", "drawing.svg", "-o", "typed.script", *flags, cwd=tmp_path, status=0)
    assert (tmp_path / "said.script").read_bytes() == (tmp_path / "typed.script").read_bytes()
    again = plugin.effect("settings", saved, tmp_path / "again.svg")
    assert stored(again.read_text()) == stored(saved.read_text()) == {**chosen, "tolerance": "0.2mm"}
