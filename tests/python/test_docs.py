"""Commands that README and docs tell one to type are commands that there are."""

import re
import shlex
from pathlib import Path

import pytest

from brushsvg.cli.arguments.parser import parse

HOUSE = Path(__file__).parents[2]
PAGES = [HOUSE / "README.md", *sorted((HOUSE / "docs").glob("*.md"))]
TYPED = re.compile(r"^ +brushsvg +(.*?)(?: +[#>].*)?$", re.MULTILINE)
COMMANDS = [
    pytest.param(command, id=f"{page.name}: {command}")
    for page in PAGES
    for command in TYPED.findall(page.read_text(encoding="utf-8"))
]


def test_pages_have_commands():
    assert len(COMMANDS) > 40


@pytest.mark.parametrize("command", COMMANDS)
def test_what_pages_tell_one_to_type_is_understood(command):
    parse(shlex.split(command.split(" | ")[0]))
