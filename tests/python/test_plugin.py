"""The extension for Inkscape can be installed from the source tree and its zip."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from diagnostics import refused

from brushsvg import Error
from brushsvg.cli import main
from brushsvg.cli.install_plugin import extensions_folder, install_inkscape, remove_inkscape

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "plugins" / "inkscape"


@pytest.fixture
def profile(tmp_path, monkeypatch):
    monkeypatch.setenv("INKSCAPE_PROFILE_DIR", str(tmp_path / "profile"))
    return tmp_path / "profile" / "extensions" / "brushsvg"


@pytest.fixture
def zipped(tmp_path):
    out = tmp_path / "brushsvg-inkscape.zip"
    subprocess.run([sys.executable, ROOT / "tools" / "zip_plugin.py", SOURCE, out], check=True)
    return out


def installed(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_the_plugin_is_copied_from_the_source_tree_and_replaces_an_older_one(profile, capsys):
    profile.mkdir(parents=True)
    (profile / "brushsvg_gone.inx").write_text("old")
    assert main(["setup", "inkscape"]) == 0
    assert capsys.readouterr().out.startswith(f"{profile}: ")
    files = installed(profile)
    assert files.pop("brushsvg-executable.txt") is not None
    expected = {path.name: path.read_bytes() for path in SOURCE.iterdir() if path.is_file()}
    assert files == expected and "LICENSE" in files


def test_the_zip_installs_the_same_files(profile, zipped):
    install_inkscape()
    from_tree = installed(profile)
    for path in profile.iterdir():
        path.unlink()
    install_inkscape(str(zipped))
    assert installed(profile) == from_tree


def test_the_zip_has_the_same_bytes_each_time(zipped, tmp_path):
    again = tmp_path / "again.zip"
    subprocess.run([sys.executable, ROOT / "tools" / "zip_plugin.py", SOURCE, again], check=True)
    assert again.read_bytes() == zipped.read_bytes()


def test_removing_the_plugin_keeps_other_files(profile, capsys):
    install_inkscape()
    (profile / "notes.txt").write_text("mine")
    assert main(["setup", "inkscape", "--remove"]) == 0
    assert capsys.readouterr().out.startswith(f"{profile}: ")
    assert installed(profile) == {"notes.txt": b"mine"}
    (profile / "notes.txt").unlink()
    install_inkscape()
    remove_inkscape()
    assert not profile.exists()
    with refused("plugin-missing"):
        remove_inkscape()


def test_removing_needs_no_zip(capsys):
    assert main(["setup", "inkscape", "some.zip", "--remove"]) == 2


def test_a_missing_source_tree_is_reported_with_the_zip_to_use(profile, tmp_path):
    with refused("plugin-missing brushsvg-inkscape.zip"):
        install_inkscape(source=tmp_path / "site-packages")
    assert not profile.exists()


def write_damaged(path):
    """Write a zip whose compressed bytes are no data."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("brushsvg_program.py", "x = 1\n" * 1000)
    data = bytearray(path.read_bytes())
    data[50:58] = b"\xff" * 8
    path.write_bytes(data)


def test_a_file_other_than_the_plugin_zip_is_refused(profile, tmp_path, zipped):
    for name, make in (
        ("missing.zip", lambda path: None),
        ("text.zip", lambda path: path.write_text("no zip")),
        ("other.zip", lambda path: zipfile.ZipFile(path, "w").writestr("a.exe", "x")),
        ("short.zip", lambda path: path.write_bytes(zipped.read_bytes()[:2000])),
        ("damaged.zip", write_damaged),
    ):
        make(tmp_path / name)
        with pytest.raises(Error) as caught:
            install_inkscape(str(tmp_path / name))
        assert caught.value.file == str(tmp_path / name)
    assert not profile.exists()


def test_a_name_in_the_zip_cannot_point_outside_the_folder(profile, tmp_path, zipped):
    with zipfile.ZipFile(zipped, "a") as file:
        file.writestr("../../evil.py", "x")
    install_inkscape(str(zipped))
    assert (profile / "evil.py").exists() and not list(tmp_path.glob("evil.py"))


@pytest.mark.parametrize(
    "script", sorted(path.name for path in SOURCE.glob("*.py") if "import etree" in path.read_text())
)
@pytest.mark.parametrize("module", ["lxml", "cssselect"])
def test_a_module_missing_in_inkscapes_python_is_reported_with_its_package(tmp_path, script, module):
    """A module that Inkscape's Python lacks is reported with its package.

    This happens where Inkscape was installed without its recommended packages.
    """
    (tmp_path / "drawing.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg"/>')
    lacks = f"raise ModuleNotFoundError('No module', name='{module}')\n"
    for name in ("inkex", "lxml"):
        (tmp_path / f"{name}.py").write_text(lacks)
    done = subprocess.run(
        [sys.executable, SOURCE / script, "--executable=true", "drawing.svg"],
        env={"PYTHONPATH": str(tmp_path), "PATH": "/usr/bin:/bin"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(f"{sys.executable}, ") and f"python3-{module} " in done.stderr
    assert done.stderr.endswith(f"  {sys.executable} -m pip install {module}\n")


@pytest.mark.parametrize("name", ["n", "n/2", "n#2", "n~3", "n/2#2~3", "n+2", "n~3+2", "copy/n~3", "a~2"])
def test_a_part_of_a_stroke_belongs_to_its_element(monkeypatch, name):
    """A line that is lifted at a corner is painted as n, n~2 and n~3."""
    monkeypatch.syspath_prepend(SOURCE)
    from brushsvg_program import element_of

    element = {"n": "n", "copy": "copy", "a": "a", "a~2": "a~2"}
    assert element_of(element, name) == {"c": "copy", "a": "a~2"}.get(name[0], "n")
    assert element_of(element, "other~2") is None


def test_the_extensions_folder_follows_the_platform(monkeypatch):
    monkeypatch.delenv("INKSCAPE_PROFILE_DIR", raising=False)
    monkeypatch.delenv("XDG_CONFIG_HOME", raising=False)
    monkeypatch.setenv("HOME", "/home/somebody")
    monkeypatch.setattr(sys, "platform", "linux")
    assert extensions_folder() == Path("/home/somebody/.config/inkscape/extensions")
    monkeypatch.setattr(sys, "platform", "darwin")
    mac = "/home/somebody/Library/Application Support/org.inkscape.Inkscape/config/inkscape/extensions"
    assert extensions_folder() == Path(mac)
