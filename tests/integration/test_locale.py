"""A decimal comma of the user's language never appears in a program."""

import subprocess

import pytest
from command import SOUND, brushsvg


@pytest.fixture(scope="module")
def german(tmp_path_factory):
    """Return the environment of a German desktop."""
    folder = tmp_path_factory.mktemp("locale")
    words = ["localedef", "-i", "de_DE", "-f", "UTF-8", folder / "de_DE.UTF-8"]
    subprocess.run(words, check=True, capture_output=True)
    environment = {"LOCPATH": str(folder), "LC_ALL": "de_DE.UTF-8"}
    done = subprocess.run(
        ["/usr/bin/printf", "%.1f", "0,5"], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout == "0,5", "the locale is not in force"
    return environment


@pytest.mark.parametrize("out", ["x.ngc", "x.script", "x.json", "x.txt.json"])
def test_programs_are_the_same_in_any_language(tmp_path, german, out):
    (tmp_path / "a.svg").write_text(SOUND)
    cell = ("--cell", "ur5e") if out.endswith(".script") else ()
    texts = []
    for environment in ({"LC_ALL": "C.UTF-8"}, german):
        brushsvg("convert", "a.svg", "-o", out, *cell, cwd=tmp_path, status=0, env=environment)
        texts.append((tmp_path / out).read_bytes())
    assert texts[0] == texts[1]
