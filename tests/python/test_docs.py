"""README and docs show only commands that exist."""

import re
import shlex

import pytest
from shown_code import DOCS, FOLLOWED, PAGES, blocks, name_of

from brushsvg.cli.arguments.parser import parse
from brushsvg.read.svg.settings import _STROKE_SETTINGS

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


@pytest.mark.parametrize("page", ["reference/drawings.md", "howto/order-and-ends.md"])
def test_pages_have_every_attribute_of_a_stroke(page):
    text = (
        (DOCS / page).read_text(encoding="utf-8").replace("`-start`, `-end`", "data-brushsvg-start data-brushsvg-end")
    )
    names = set(re.findall(r"data-brushsvg-([a-z]+)", text))
    assert {*_STROKE_SETTINGS} <= names


def test_the_page_on_batches_names_the_options_of_convert_that_batch_lacks():
    page = (DOCS / "howto/batches.md").read_text(encoding="utf-8")
    (sentence,) = re.findall(r"These do not:\s+([^.]*)\.", page)
    convert, batch = (
        {flag for action in parse([*words.split()]).parser._actions for flag in action.option_strings}
        for words in ("convert a.svg -o a.ngc", "batch a.svg -o out")
    )
    assert set(re.findall("`(--[a-z-]+)`", sentence)) == convert - batch
