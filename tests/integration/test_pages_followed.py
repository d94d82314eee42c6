"""Follow pages of docs/start and docs/howto from top to bottom in one folder.

A shell runs the commands. A block of toml, csv, json, xml or text is a file. The last name in backticks before
it is the name of the file. The block is appended if the file exists, otherwise it is written. Python code runs in
tests/python/test_doc_code.py.
"""

import re
from pathlib import Path

import pytest
from sampling import sample
from shown_code import DOCS, FOLLOWED, FOLLOWED_NOT_RUN, blocks, name_of
from test_doc_commands import Desk

FILES = ("toml", "csv", "json", "xml", "text")
TYPED = ("commands", "shell", "make")
NAME = re.compile(r"`([\w-]+\.(?:toml|csv|json|svg|txt))`")
WRITES = re.compile(r"(?:-o|--picture|--marks-picture|--page|--chart|--report|--corrected-cell) +(\S+\.\w+)")


def file_of(page, block) -> str:
    """Return the file whose text is a block."""
    before = page.read_text(encoding="utf-8").splitlines()[: block.line - 1]
    return NAME.findall("\n".join(before))[-1]


@sample("page", FOLLOWED, keep=4, ids=name_of)
def test_a_page_can_be_followed_from_top_to_bottom(page, tmp_path):
    (tmp_path / "desk").mkdir()
    desk = Desk(tmp_path / "desk")
    for block in blocks(page):
        if block.kind in FILES:
            with (desk.folder / file_of(page, block)).open("a") as file:
                file.write(block.code)
        elif block.kind in TYPED:
            for line in block.code.splitlines():
                follow(desk, line)


def follow(desk: Desk, line: str) -> None:
    if not line or line.startswith(("#", *FOLLOWED_NOT_RUN)):
        return
    desk.make_all(line, replace=False)
    desk.type(line)
    for name in WRITES.findall(line):
        path = Path(name)
        pattern = f"{path.stem}-*{path.suffix}" if f"-o {name}" in line and "--per-colour" in line else name
        written = [*desk.folder.glob(pattern)]
        assert written and all(file.stat().st_size > 0 for file in written), line


@pytest.mark.parametrize("page", FOLLOWED, ids=name_of)
def test_code_blocks_of_a_page_have_executable_kinds(page):
    kinds = {block.kind for block in blocks(page)}
    assert kinds <= {*FILES, *TYPED, "python", "cpp", "cmake"}


def test_pages_to_follow_are_found():
    assert {page.parent.name for page in FOLLOWED} == {"start", "howto"} and len(FOLLOWED) >= 19
    assert all(page.is_relative_to(DOCS) for page in FOLLOWED)
