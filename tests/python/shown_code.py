"""Collect the code that README, docs and notebooks show."""

import json
import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
DOCS = REPOSITORY / "docs"
GENERATED = {DOCS / "reference" / f"{name}.md" for name in ("commands", "python", "cells")}  # made_pages.py writes them
FOLLOWED = [page for folder in ("start", "howto") for page in sorted((DOCS / folder).glob("*.md"))]
PAGES = [
    REPOSITORY / "README.md",
    *sorted(page for page in DOCS.rglob("*.md") if page not in GENERATED and "_build" not in page.parts),
]
NOTEBOOKS = sorted((REPOSITORY / "examples" / "notebooks").glob("*.ipynb"))
# A block is fenced, or indented after an empty line. The continuation of a list has no empty line above it.
BLOCK = re.compile(
    r"^ *```(?P<fence>\S*)\n(?P<fenced>[\s\S]*?)^ *```$|(?<=\n\n)(?P<plain>(?:    .*\n(?:\n+(?=    ))?)+)",
    re.MULTILINE,
)
# The kind of a block that is only indented: the first match counts.
KINDS = (
    ("commands", r"brushsvg "),
    ("make", r"make "),
    ("shell", r"(cmake|c\+\+|inkscape|xvfb-run|01_first_word) "),
    ("cpp", r"#include "),
    ("cmake", r"(include|find_package)\("),
    ("python", r"(import |from \w|[\w, ]+ = brushsvg\.)"),
    ("csv", r"kind,"),
    ("json", r"[{\"]"),
    ("toml", r"\[\w+\]\n"),
    ("flags", r"--\w"),
)


FOLLOWED_NOT_RUN = {  # Beginnings of lines on followed pages that no test runs, and the reason.
    "git clone ": "the address of the project",
    "make ": "sets up a machine, or takes minutes",
    ". ": "the environment of the one who installs",
    "pipx ": "vpype in an environment of its own: integration/test_vpype.py",
    "vpype ": "vpype in an environment of its own: integration/test_vpype.py",
    "cmake ": "tests/consumer/run.sh",
    "c++ ": "tests/consumer/run.sh",
    "01_first_word ": "tests/consumer/run.sh",
    "brushsvg check wave.ngc ": "tests/consumer/run.sh",
}


@dataclass(frozen=True)
class Block:
    """A code block of a page: its line number there, kind, and text without indent.

    The kind is "" if it is unknown.
    """

    page: str  # README.md, or the path below docs/
    line: int
    kind: str
    code: str


def name_of(page: Path) -> str:
    """Return the path of a page below docs/, or the file name README.md."""
    return page.relative_to(DOCS).as_posix() if page.is_relative_to(DOCS) else page.name


def blocks(page: Path) -> list[Block]:
    """Return the code blocks of a page, from top to bottom."""
    text = page.read_text(encoding="utf-8")
    found = []
    for block in BLOCK.finditer(text):
        code = textwrap.dedent(block["plain"] or block["fenced"])
        kind = "" if block["fence"] == "sh" else block["fence"]
        other = "shell" if block["fence"] == "sh" else ""
        kind = kind or next((name for name, begin in KINDS if re.match(begin, code)), other)
        found.append(Block(name_of(page), text[: block.start()].count("\n") + 1, kind, code))
    return found


def cells(notebook: Path) -> list[str]:
    """Return the code cells of a notebook."""
    book = json.loads(notebook.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]


# Commands that no test runs as they stand: (page, beginning of the line), and the reason.
NOT_RUN = {
    (
        "README.md",
        "brushsvg calibrate photo.jpg --chart",
    ): "as in docs/howto/calibrate-photograph.md, where it runs",
}


def why_not_run(page: str, line: str) -> str:
    """Return the reason why no test runs a command; empty if a test runs it."""
    return next((why for (of, begin), why in NOT_RUN.items() if of == page and line.startswith(begin)), "")
