"""The same drawing gives the same bytes, in any folder and for any user."""

import os
import subprocess
import sys
from functools import partial

import pytest
from command import SOUND, brushsvg


def everything(folder, name="sound.svg", env=None, command=None):
    """Return the bytes of all outputs of a drawing."""
    run = command or partial(brushsvg, cwd=folder, env=env)
    made = {}
    for words in (
        ("convert", name, "-o", "o.ngc"),
        ("convert", name, "-o", "o.json"),
        ("preview", name, "-o", "o.png"),
        ("preview", name, "-o", "o.svg"),
        ("preview", name, "-o", "o-marks.json"),
        ("preview", name, "-o", "o.html"),
        ("convert", name, "-o", "o2.ngc", "--report", "o.txt", "--picture", "o2.svg"),
    ):
        run(*words, status=0)
    for each in sorted(folder.glob("o*")):
        if each.name != "old.ngc":
            made[each.name] = each.read_bytes()
            each.unlink()
    made["report"] = run("preview", name, "--json", status=0).out
    assert len(made) == 10
    return made


@pytest.fixture(scope="module")
def usual(tmp_path_factory):
    """Return the outputs of the valid drawing with an English locale."""
    folder = tmp_path_factory.mktemp("usual")
    (folder / "sound.svg").write_text(SOUND)
    return everything(folder, env={"LC_ALL": "C.UTF-8", "TZ": "UTC", "PYTHONHASHSEED": "1"})


def elsewhere(desk, text):
    other = desk / "another folder"
    other.mkdir()
    (other / "another name.svg").write_text(text)
    os.utime(other / "another name.svg", (0, 0))
    env = {"PYTHONHASHSEED": "2", "TZ": "Asia/Tokyo", "USER": "x", "HOSTNAME": "x", "LC_ALL": "C"}
    return everything(other, "another name.svg", env=env)


def test_the_same_drawing_gives_the_same_bytes(desk, usual):
    assert elsewhere(desk, SOUND) == usual


def test_a_missing_title_is_not_replaced_by_the_file_name(desk):
    text = SOUND.replace("<title>A line</title>", "")
    (desk / "sound.svg").write_text(text)
    assert elsewhere(desk, text) == everything(desk)


@pytest.fixture(scope="session")
def german(tmp_path_factory):
    """Return an environment with a decimal comma."""
    folder = tmp_path_factory.mktemp("locale")
    compiled = subprocess.run(
        ["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")], capture_output=True
    )
    if not (folder / "de_DE.UTF-8").exists():
        pytest.skip(f"de_DE cannot be compiled: {compiled.stderr.decode()}")
    return {"LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8", "LOCPATH": str(folder)}


def test_a_locale_with_decimal_comma_changes_nothing(desk, german, usual):
    assert everything(desk, env=german) == usual


def test_a_locale_set_by_the_calling_program_changes_nothing(desk, german, usual):
    """A window toolkit sets the locale at its start; C and C++ would then use commas."""
    code = (
        "import locale, sys; locale.setlocale(locale.LC_ALL, ''); "
        "assert '%s' % locale.localeconv()['decimal_point'] == ','; "
        "from brushsvg.cli import main; sys.exit(main())"
    )

    def run(*words, status):
        done = subprocess.run(
            [sys.executable, "-c", code, *words],
            cwd=desk,
            env={**os.environ, **german},
            capture_output=True,
            encoding="utf-8",
            timeout=60,
        )
        assert done.returncode == status, done.stderr
        return type("Done", (), {"out": done.stdout})

    assert everything(desk, command=run) == usual
    brushsvg("convert", "sound.svg", "-o", "plan.json", cwd=desk, status=0)
    run("convert", "plan.json", "-o", "p.ngc", status=0)
    brushsvg("convert", "plan.json", "-o", "q.ngc", cwd=desk, status=0)
    assert (desk / "p.ngc").read_bytes() == (desk / "q.ngc").read_bytes()
