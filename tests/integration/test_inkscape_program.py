"""The extension finds brushsvg, and reports a missing or wrong program."""

import os
import stat
import subprocess
import sys

import pytest
from command import COMMAND, SOUND
from plugin import Plugin, sentence

INSTALL = "make demo && .venv/bin/brushsvg setup inkscape"
SCRIPTS = ["save", "preview", "check", "strokes", "chart"]


@pytest.fixture
def drawing(tmp_path):
    file = tmp_path / "drawing.svg"
    file.write_text(SOUND)
    return file


@pytest.mark.parametrize("script", SCRIPTS)
def test_a_missing_program_is_reported_with_the_install_command(tmp_path, drawing, script):
    reported = sentence(Plugin(tmp_path, command=None).script(script, drawing))
    assert reported.splitlines()[0].endswith(f":  {INSTALL}")


def programs(tmp_path, text):
    file = tmp_path / "other"
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(file.stat().st_mode | stat.S_IXUSR)
    return file


@pytest.mark.parametrize(
    ("does", "reported"),
    [
        ('test "$1" = --version && echo brushsvg 0.0.9 && exit; exit 2', "brushsvg 0.0.9"),
        ("echo ModuleNotFoundError: gone >&2; exit 1", ": ModuleNotFoundError: gone\n"),
        ("exit 1", " (1)\n"),
        ("exit 0", ""),
        ("kill -9 $$", ""),
        ("echo something else; exit 3", ""),
    ],
)
@pytest.mark.parametrize("script", SCRIPTS)
def test_a_program_other_than_brushsvg_is_reported(plugin, tmp_path, drawing, script, does, reported):
    other = programs(tmp_path, does)
    message = sentence(plugin.script(script, drawing, f"--executable={other}"))
    assert reported in message if reported else message.startswith(f"{other} ") and message.count("\n") == 1


def test_a_chosen_program_that_does_not_exist_is_reported(plugin, tmp_path, drawing):
    reported = sentence(plugin.script("save", drawing, f"--executable={tmp_path / 'nothing'}"))
    assert reported.startswith(f"{tmp_path / 'nothing'} ")


def test_the_path_recorded_at_installation_is_used(tmp_path, drawing):
    alone = Plugin(tmp_path, command=None)
    (alone.installed / "brushsvg-executable.txt").write_text(f"{COMMAND}\n")
    assert alone.script("save", drawing).stdout.endswith(b"M2\n")


@pytest.mark.parametrize("path", ["", None])
def test_the_program_is_found_in_usual_folders_without_path_variable(tmp_path, drawing, path):
    """A desktop starts Inkscape without the PATH of a shell."""
    alone = Plugin(tmp_path, command=None)
    alone.env.pop("PATH")
    alone.env |= {} if path is None else {"PATH": path}
    assert INSTALL in sentence(alone.script("save", drawing))
    (tmp_path / ".local" / "bin").mkdir(parents=True)
    (tmp_path / ".local" / "bin" / "brushsvg").symlink_to(COMMAND)
    assert alone.script("save", drawing).stdout.endswith(b"M2\n")


@pytest.mark.parametrize(
    ("variable", "folder"),
    [
        (None, ".local/share/pipx/venvs/brushsvg/bin"),
        (None, ".local/pipx/venvs/brushsvg/bin"),
        (None, ".local/share/uv/tools/brushsvg/bin"),
        ("PIPX_BIN_DIR", ""),
        ("PIPX_HOME", "venvs/brushsvg/bin"),
        ("UV_TOOL_BIN_DIR", ""),
        ("UV_TOOL_DIR", "brushsvg/bin"),
    ],
)
def test_the_program_is_found_in_pipx_and_uv_folders(tmp_path, drawing, variable, folder):
    alone = Plugin(tmp_path, command=None)
    alone.env |= {variable: str(tmp_path / "own")} if variable else {}
    place = tmp_path / ("own" if variable else "") / folder
    place.mkdir(parents=True)
    (place / "brushsvg").symlink_to(COMMAND)
    assert alone.script("save", drawing).stdout.endswith(b"M2\n")


@pytest.mark.parametrize(("variable", "name"), [("FLATPAK_ID", "a Flatpak"), ("SNAP", "a Snap")])
def test_a_sandbox_is_reported_with_a_workaround(tmp_path, drawing, variable, name):
    alone = Plugin(tmp_path, command=None)
    alone.env[variable] = "org.inkscape.Inkscape"
    reported = sentence(alone.script("save", drawing))
    assert name in reported and "brushsvg convert" in reported and INSTALL not in reported


def test_the_settings_show_which_program_is_used(plugin, tmp_path, drawing):
    reported = plugin.script("settings", drawing).stderr.decode()
    assert str(plugin.folder / "programs" / "brushsvg") in reported and "brushsvg 0." in reported
    (tmp_path / "none").mkdir()
    reported = Plugin(tmp_path / "none", command=None).script("settings", drawing).stderr.decode()
    assert INSTALL in reported


@pytest.mark.parametrize("typed", [[COMMAND], [sys.executable, "-m", "brushsvg"]])
def test_inkscape_without_path_variable_uses_the_installing_program(tmp_path, drawing, typed):
    alone = Plugin(tmp_path, command=None)
    environment = {"HOME": str(tmp_path), "INKSCAPE_PROFILE_DIR": str(alone.profile), "PATH": ""}
    words = [*typed, "setup", "inkscape"]
    subprocess.run(words, env=environment, cwd=os.sep, check=True, capture_output=True)
    alone.env["PATH"] = ""
    alone.save(drawing, tmp_path / "saved.ngc")
    assert (tmp_path / "saved.ngc").read_bytes().endswith(b"M2\n")


def test_a_path_that_is_not_unicode_is_recorded(tmp_path, drawing):
    odd = tmp_path / os.fsdecode(b"p\xff") / "brushsvg"
    odd.parent.mkdir()
    odd.symlink_to(COMMAND)
    alone = Plugin(tmp_path, command=None)
    environment = {"HOME": str(tmp_path), "INKSCAPE_PROFILE_DIR": str(alone.profile), "PATH": ""}
    subprocess.run([odd, "setup", "inkscape"], env=environment, check=True, capture_output=True)
    assert alone.script("save", drawing).stdout.endswith(b"M2\n")


def test_a_recorded_path_that_no_longer_exists_is_ignored(plugin, drawing):
    note = plugin.installed / "brushsvg-executable.txt"
    note.write_text("/nowhere/brushsvg\n")
    try:
        assert plugin.script("save", drawing).stdout.endswith(b"M2\n")
    finally:
        note.unlink()


@pytest.mark.parametrize("script", ["save", "preview", "strokes"])
def test_a_full_disk_is_reported(plugin, drawing, script):
    # 4 bytes are enough for the probe with which Python searches a temporary folder
    reported = sentence(plugin.script(script, drawing, before=("/usr/bin/prlimit", "--fsize=4")))
    assert reported.endswith(": File too large.\n"), "the system's words, and no mistake of ours"
