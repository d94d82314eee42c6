"""The code that README, docs and notebooks show: blocks of pages with what they are, cells of notebooks."""

import json
import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
DOCS = REPOSITORY / "docs"
GENERATED = {
    DOCS / "reference" / f"{name}.md" for name in ("commands", "python", "cells")
}  # by made_pages.py
FOLLOWED = [page for folder in ("start", "howto") for page in sorted((DOCS / folder).glob("*.md"))]
PAGES = [
    REPOSITORY / "README.md",
    *sorted(page for page in DOCS.rglob("*.md") if page not in GENERATED and "_build" not in page.parts),
]
NOTEBOOKS = sorted((REPOSITORY / "examples" / "notebooks").glob("*.ipynb"))
# fenced, or indented behind an empty line: what goes on with a list has a line of it right above
BLOCK = re.compile(
    r"^ *```(?P<fence>\S*)\n(?P<fenced>[\s\S]*?)^ *```$|(?<=\n\n)(?P<plain>(?:    .*\n(?:\n+(?=    ))?)+)",
    re.MULTILINE,
)
# what a block that is only indented is: the first that fits
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


FOLLOWED_NOT_RUN = {  # beginnings of lines of followed pages that no test types, and why
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
    """A block of code of a page: its line there, what it is ("" if nobody knows), and its text without indent."""

    page: str  # README.md, or the path below docs/
    line: int
    kind: str
    code: str


def name_of(page: Path) -> str:
    """The name of a page below docs/, with its folder; of README.md its own."""
    return page.relative_to(DOCS).as_posix() if page.is_relative_to(DOCS) else page.name


def blocks(page: Path) -> list[Block]:
    """The blocks of code of a page, from top to bottom."""
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
    """The cells of code of a notebook."""
    book = json.loads(notebook.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]


# Commands that no test types as they stand: (page, what the line begins with), and why.
NOT_RUN = {
    (
        "README.md",
        "brushsvg calibrate photo.jpg --chart",
    ): "as in docs/howto/calibrate-photograph.md, where it runs",
}


def why_not_run(page: str, line: str) -> str:
    """Empty for a command that is run."""
    return next((why for (of, begin), why in NOT_RUN.items() if of == page and line.startswith(begin)), "")
