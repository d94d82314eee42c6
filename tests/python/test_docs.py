"""README and docs show only commands that exist."""

import re
import shlex

import pytest
from shown_code import DOCS, FOLLOWED, PAGES, blocks, name_of

from brushsvg.cli.arguments.parser import parse

TYPED = re.compile(r"^ +brushsvg +(.*?)(?: +[#>].*)?$", re.MULTILINE)
COMMANDS = [
    pytest.param(command, id=f"{name_of(page)}: {command}")
    for page in PAGES
    if page not in FOLLOWED
    for command in TYPED.findall(page.read_text(encoding="utf-8"))
]
COMMANDS += [
    pytest.param(line.removeprefix("brushsvg "), id=f"{name_of(page)}: {line}")
    for page in FOLLOWED
    for block in blocks(page)
    for line in block.code.splitlines()
    if block.kind == "commands" and line.startswith("brushsvg ")
]
LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")
LINKS = [
    pytest.param(page, link, id=f"{name_of(page)}: {link}")
    for page in FOLLOWED
    for link in LINK.findall(page.read_text(encoding="utf-8"))
]
GENERATED = ("reference/commands.md",)  # `make docs` writes it


def test_pages_with_commands_are_found():
    assert len(COMMANDS) > 40


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_on_pages_can_be_parsed(command):
    first = re.split(r" [|>] ", command)[0]
    parse(shlex.split(first, comments=True))


@pytest.mark.parametrize(("page", "link"), LINKS)
def test_links_of_followed_pages_have_targets(page, link):
    docs = DOCS
    target = (page.parent / link).resolve()
    folder = docs / target.relative_to(docs).parts[0]
    is_planned = not folder.exists()  # the pages do not exist yet
    assert target.exists() or is_planned or target.relative_to(docs).as_posix() in GENERATED
