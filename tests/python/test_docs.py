"""Commands that README and docs tell one to type are commands that there are."""

import re
import shlex

import pytest
from shown_code import PAGES, name_of

from brushsvg.cli.arguments.parser import parse

TYPED = re.compile(r"^ +brushsvg +(.*?)(?: +[#>].*)?$", re.MULTILINE)
COMMANDS = [
    pytest.param(command, id=f"{name_of(page)}: {command}")
    for page in PAGES
    for command in TYPED.findall(page.read_text(encoding="utf-8"))
]


def test_pages_have_commands():
    assert len(COMMANDS) > 40


@pytest.mark.parametrize("command", COMMANDS)
def test_what_pages_tell_one_to_type_is_understood(command):
    parse(shlex.split(command.split(" | ")[0]))
