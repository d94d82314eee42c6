"""Each extra works if it is installed; if not, one sentence names the command.

The command installs the extra. `make wheel-test` runs this without extras and with each of them.
"""

import importlib.util
import os

import pytest
from diagnostics import agrees, in_json

from brushsvg.cli import main
from brushsvg.errors import command_to_add

FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
    '<path d="M20 30H90" fill="none" stroke="#203060" stroke-width="3"/></svg>'
)
TYPED = {  # packages of the extra: (a command that needs them, the file that the command writes)
    ("fonttools", "uharfbuzz"): ("text word -o out.svg --font font.ttf", "out.svg"),
    ("matplotlib",): ("brush plot round-6 -o out.svg", "out.svg"),
    ("ssik",): ("cell place ur5e in/a.svg -o out.png", "out.png"),
    ("pyarrow",): ("batch in -o out --jobs 1 --parquet", "out/table.parquet"),
    ("distributed",): ("batch in -o out --cluster tcp://127.0.0.1:9", None),
}
MODULES = {"fonttools": "fontTools"}


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.svg").write_text(DRAWING)
    (tmp_path / "font.ttf").write_bytes(b"\0\1\0\0")  # a font's first bytes: enough to need the packages
    if os.path.exists(FONT):
        (tmp_path / "font.ttf").unlink()
        (tmp_path / "font.ttf").symlink_to(FONT)
    return tmp_path


def lacks(packages) -> bool:
    return any(importlib.util.find_spec(MODULES.get(name, name)) is None for name in packages)


@pytest.mark.parametrize("packages", TYPED)
def test_a_missing_extra_is_refused_with_the_install_command(desk, capsys, packages):
    if not lacks(packages):
        pytest.skip("it is installed")
    status, _, reported = in_json(capsys, *TYPED[packages][0].split())
    ((_, why),) = reported
    assert (status, why.code) == (1, "package-missing")
    assert why.sentence.endswith(command_to_add(*packages))


@pytest.mark.arm
@pytest.mark.parametrize("packages", TYPED)
def test_an_extra_that_is_installed_works(desk, capsys, packages):
    words, out = TYPED[packages]
    if lacks(packages):
        pytest.skip("it is missing")
    if "fonttools" in packages and not os.path.exists(FONT):
        pytest.skip(f"there is no {FONT}")
    if out is None:  # No host answers there, and only a user who has the extra gets that far.
        status, _, reported = in_json(capsys, *words.split())
        assert status == 1 and any(agrees(why, "cluster-unreachable") for _, why in reported)
        return
    assert main(words.split()) == 0
    assert (desk / out).stat().st_size > 500
