"""The code that README, docs and notebooks show: blocks of pages with what they are, cells of notebooks."""

import json
import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

HOUSE = Path(__file__).parents[2]
PAGES = [HOUSE / "README.md", *sorted((HOUSE / "docs").glob("*.md"))]
NOTEBOOKS = sorted((HOUSE / "examples" / "notebooks").glob("*.ipynb"))
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


@dataclass(frozen=True)
class Block:
    """A block of code of a page: its line there, what it is ("" if nobody knows), and its text without indent."""

    page: str
    line: int
    kind: str
    code: str


def blocks(page: Path) -> list[Block]:
    """The blocks of code of a page, from top to bottom."""
    text = page.read_text(encoding="utf-8")
    found = []
    for block in BLOCK.finditer(text):
        code = textwrap.dedent(block["plain"] or block["fenced"])
        kind = block["fence"] or next((name for name, begin in KINDS if re.match(begin, code)), "")
        found.append(Block(page.name, text[: block.start()].count("\n") + 1, kind, code))
    return found


def cells(notebook: Path) -> list[str]:
    """The cells of code of a notebook."""
    book = json.loads(notebook.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]


# Commands that no test types as they stand: (page, what the line begins with), and why.
NOT_RUN = {
    ("README.md", "brushsvg calibrate photo.jpg --chart"): "as in docs/photograph.md, where it runs",
    (
        "batch.md",
        "brushsvg batch letters/ --out painted --cluster",
    ): "needs a scheduler at that address: test_batch.py",
}


def why_not_run(page: str, line: str) -> str:
    """Empty for a command that is run."""
    return next((why for (of, begin), why in NOT_RUN.items() if of == page and line.startswith(begin)), "")
