"""tools/docs_lint.py finds each fault that it promises, and none in docs/."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
import docs_lint

FIRST = "This page is for everyone who paints."
LONG = " ".join(["word"] * 31) + "."


def found(tmp_path, text: str) -> list[str]:
    page = tmp_path / "page.md"
    page.write_text(f"# Title\n\n{text}\n", encoding="utf-8")
    return list(docs_lint.findings(page))


def test_the_pages_have_no_findings():
    assert len(docs_lint.pages()) > 30
    assert [finding for page in docs_lint.pages() for finding in docs_lint.findings(page)] == []


@pytest.mark.parametrize(
    "text",
    [
        "brushsvg paints.",  # does not mention the reader
        f"{FIRST} Short. {LONG}",
        f"{FIRST} {' '.join(['word'] * 25)}. {' '.join(['word'] * 26)}.",  # the median is too long
        f"{FIRST} It is put beside the brush.",
        f"{FIRST}\n\n| a | as of today |\n|---|---|",
        f"{FIRST}\n\n* Told once.",
    ],
)
def test_each_rule_finds_its_fault(tmp_path, text):
    assert len(found(tmp_path, text)) == 1


@pytest.mark.parametrize(
    "text",
    [
        FIRST,
        f"{FIRST}\n\n    beside {LONG}\n",
        f"{FIRST}\n\n```text\nbeside {LONG}\n```",
        f'{FIRST} Type `beside`, or write "beside".',
        f"{FIRST}\n\n| {LONG} | a |\n|---|---|",
        f"{FIRST} A bedside lamp is no finding.",
    ],
)
def test_code_quotations_and_long_table_cells_are_ignored(tmp_path, text):
    assert found(tmp_path, text) == []
