"""`demo` and `doctor` work on a first start and when something is missing."""

import os
import re
import sys
import types
from importlib import metadata
from pathlib import Path

import cv2
import numpy as np
import pytest
from diagnostics import in_json, refused

from brushsvg.cli import main
from brushsvg.cli.commands.installation import demo, doctor
from brushsvg.cli.install_plugin import install_inkscape
from brushsvg.errors import command_to_add, missing_packages_error

ROOT = Path(__file__).parents[2]


@pytest.fixture
def opened(monkeypatch):
    """Return the list of pictures for which a viewer is started."""
    shown = []
    monkeypatch.setattr(demo, "_start_viewer", lambda program, path: shown.append(path))
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.delenv("DISPLAY", raising=False)
    return shown


def test_demo_paints_the_word_and_prints_the_path_of_the_picture(tmp_path, monkeypatch, capsys, opened):
    monkeypatch.chdir(tmp_path)
    assert main(["demo"]) == 0
    out, err = capsys.readouterr()
    assert out == f"{tmp_path / 'brushsvg-demo.png'}\n"
    # The overlap is 0.9895. Whether it rounds up or down depends on how the processor adds.
    assert float(re.search(r"overlap (\d\.\d+)", err)[1]) >= 0.985
    picture = cv2.imdecode(np.frombuffer(Path(out.strip()).read_bytes(), np.uint8), cv2.IMREAD_GRAYSCALE)
    assert (picture < 100).mean() > 0.02  # paint
    assert opened == []  # there is no display


@pytest.mark.parametrize("flags, expected", [([], ["a.png"]), (["--no-open"], [])])
def test_demo_opens_the_picture_if_there_is_a_display(tmp_path, monkeypatch, opened, flags, expected):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DISPLAY", ":7")
    monkeypatch.setattr("brushsvg.jobs.comparison_picture.comparison_png", lambda *_: b"a picture")
    assert main(["demo", "-o", "a.png", "--quiet", *flags]) == 0
    assert opened == expected


def test_demo_refuses_other_pictures_and_folders(tmp_path, capsys, opened):
    assert main(["demo", "-o", str(tmp_path / "a.jpg")]) == 2
    status, _, ((_, reported),) = in_json(capsys, "demo", "-o", tmp_path / "none" / "a.png")
    assert (status, reported.code) == (1, "file-unwritable")


def test_the_demo_drawing_equals_the_example():
    assert demo.DEMO_DRAWING.read_bytes() == (ROOT / "examples" / "vincent.svg").read_bytes()


def rows(text: str) -> dict[str, str]:
    """Return the lines of doctor by their names."""
    split = (line.strip().partition("  ") for line in text.splitlines() if line.startswith("  "))
    return {name: what.strip() for name, _, what in split}


@pytest.fixture
def without(monkeypatch):
    """Pretend that packages are missing, or have another version."""

    def change(**versions):
        real = metadata.version

        def version(name):
            found = versions.get(name.replace("-", "_"), "")
            if found is None:
                raise metadata.PackageNotFoundError(name)
            return found or real(name)

        monkeypatch.setattr(metadata, "version", version)

    return change


def test_doctor_lists_installed_packages(capsys):
    assert main(["doctor"]) == 0
    found = rows(capsys.readouterr().out)
    assert found["numpy"] == metadata.version("numpy")
    assert found["brushsvg"].startswith(metadata.version("brushsvg"))
    assert set(doctor.PURPOSE) < set(found)


def test_doctor_names_the_command_for_a_missing_extra(capsys, without):
    without(matplotlib=None, uharfbuzz=None)
    assert main(["doctor"]) == 0
    found = rows(capsys.readouterr().out)
    assert found["plot"].endswith(command_to_add("matplotlib"))
    assert found["text"].endswith(command_to_add("uharfbuzz"))  # fonttools is installed


@pytest.mark.parametrize("version", [None, "0.9"])
def test_doctor_fails_without_a_required_package(capsys, without, version):
    without(shapely=version)
    status, _, ((_, reported),) = in_json(capsys, "doctor")
    assert (status, reported.code) == (1, "package-missing")
    assert reported.sentence.endswith(command_to_add("shapely"))


def test_extras_for_users_have_a_stated_purpose():
    text = (ROOT / "pyproject.toml").read_text()
    names = set(metadata.metadata("brushsvg").get_all("Provides-Extra"))
    assert names - {"analysis", "bench", "docs", "dev", "fuzz"} == set(
        doctor.PURPOSE
    )  # without the extras of developers
    assert all(f"\n{name} = [" in text for name in doctor.PURPOSE)


def test_doctor_recognizes_snap_and_flatpak(tmp_path):
    (tmp_path / "snap").write_text("")
    (tmp_path / "inkscape").symlink_to(tmp_path / "snap")
    assert doctor.find_sandbox(str(tmp_path / "inkscape")) == "a Snap's"
    assert doctor.find_sandbox("/var/lib/flatpak/exports/bin/org.inkscape.Inkscape") == "a Flatpak's"
    assert doctor.find_sandbox("/usr/bin/inkscape") == ""


def test_doctor_names_the_zip_if_there_is_no_source_tree(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("INKSCAPE_PROFILE_DIR", str(tmp_path))
    monkeypatch.setattr(doctor, "SOURCE", tmp_path / "none")
    assert main(["doctor"]) == 0
    assert rows(capsys.readouterr().out)["extension"].endswith(" inkscape brushsvg-inkscape.zip")


def test_doctor_reports_whether_the_extension_finds_its_program(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("INKSCAPE_PROFILE_DIR", str(tmp_path))
    assert main(["doctor"]) == 0
    assert "brushsvg setup inkscape" in rows(capsys.readouterr().out)["extension"]
    # An installed package does not contain this folder.
    install_inkscape(source=ROOT / "plugins" / "inkscape")
    note = tmp_path / "extensions" / "brushsvg" / "brushsvg-executable.txt"
    for program, problem in ((sys.executable, False), (str(tmp_path / "gone"), True)):
        note.write_text(f"{program}\n")
        capsys.readouterr()
        assert main(["doctor"]) == 0
        row = rows(capsys.readouterr().out)["extension"]
        assert program in row
        assert ("no longer" in row) == problem


@pytest.mark.parametrize(
    "file, command",
    [
        ("pipx_metadata.json", ("pipx", "inject", "brushsvg", "a", "b")),
        ("uv-receipt.toml", ("uv", "tool", "install", "brushsvg", "--with", "a", "--with", "b")),
        ("pyvenv.cfg", (sys.executable, "-m", "pip", "install", "a", "b")),
    ],
)
def test_packages_are_added_with_the_tool_that_installed_brushsvg(tmp_path, monkeypatch, file, command):
    (tmp_path / file).write_text("")
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert command_to_add("a", "b").split() == list(command)
    with refused("package-missing"):
        raise missing_packages_error("this needs", "a", "b")


def test_packages_are_added_with_uv_if_pip_is_missing(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert command_to_add("a") == f"uv pip install --python {sys.executable} a"


def test_a_missing_viewer_is_not_an_error(monkeypatch):
    def fails(*_, **__):
        raise FileNotFoundError("xdg-open")

    monkeypatch.setattr(demo, "subprocess", types.SimpleNamespace(Popen=fails, DEVNULL=os.devnull))
    demo._start_viewer("xdg-open", "a.png")
