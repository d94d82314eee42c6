"""`make docs` builds all pages offline and without warnings, with every name of the code."""

import argparse
import subprocess
import sys
from pathlib import Path

import pytest

import brushsvg
from brushsvg.cli.arguments.parser import command_parser

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("docs")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-q",
        "-W",
        "-b",
        "html",
        str(REPOSITORY / "docs"),
        str(folder),
    ]
    subprocess.run(command, check=True, capture_output=True, text=True)
    return folder


def test_every_page_is_built_and_can_be_searched(site):
    for page in (REPOSITORY / "docs").rglob("*.md"):
        if "_build" not in page.parts:
            assert (site / page.relative_to(REPOSITORY / "docs").with_suffix(".html")).is_file()
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    words = ("bristl", "footprint", "backlash", "compensate", "urscript")
    assert [word for word in words if f'"{word}"' not in index] == []
    assert '<script src="http' not in (site / "index.html").read_text(encoding="utf-8")


def test_every_public_name_is_on_a_page(site):
    page = (site / "reference" / "python.html").read_text(encoding="utf-8")
    names = [f"brushsvg.{name}" for name in brushsvg.__all__ if name[0] != "_"]
    assert [name for name in names if f'id="{name}"' not in page and f'id="module-{name}"' not in page] == []


def test_every_command_and_cell_is_on_a_page(site):
    commands = (site / "reference" / "commands.html").read_text(encoding="utf-8")
    (below,) = (a for a in command_parser()._actions if isinstance(a, argparse._SubParsersAction))
    assert [name for name in below.choices if f"usage: brushsvg {name} " not in commands] == []
    cells = (site / "reference" / "cells.html").read_text(encoding="utf-8")
    assert [name for name in brushsvg.cell_names() if f'id="{name}"' not in cells] == []
