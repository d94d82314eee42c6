"""Check the language of the documentation.

Sentences have to be short and words modern. The first sentence of a page has to say who the page is for.

    python tools/docs_lint.py              # all pages: see FOLDERS and SINGLE_PAGES
    python tools/docs_lint.py docs/index.md

Prints one line for each finding and exits with 1 if there are any. `make docs-lint` runs it.
"""

from __future__ import annotations

import re
import statistics
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
BANNED_WORDS = Path(__file__).with_name("banned_words.txt")
FOLDERS = ("start", "howto", "machines", "reference", "explanation", "evidence")
SINGLE_PAGES = ("index.md", "glossary.md", "troubleshooting.md")
# pages that tools write
GENERATED = tuple(f"reference/{name}.md" for name in ("commands", "python", "cells", "wheels"))
MAX_MEDIAN_WORDS = 16
MAX_WORDS = 30
READER = re.compile(r"\bfor\b.*\b(you|who|whose|everyone|people|owners)\b|\b(you|who)\b.*\bfor\b", re.IGNORECASE)


def pages() -> list[Path]:
    """Return the pages that this lint checks."""
    found = [DOCS / name for name in SINGLE_PAGES]
    for folder in FOLDERS:
        found += sorted((DOCS / folder).rglob("*.md"))
    return [page for page in found if page.is_file() and page.relative_to(DOCS).as_posix() not in GENERATED]


def banned_words(file: Path = BANNED_WORDS) -> list[tuple[re.Pattern[str], str]]:
    """Return a pattern for each banned word or phrase, with its replacement."""
    rows = [line.strip() for line in file.read_text(encoding="utf-8").splitlines()]
    pairs = [row.partition("->") for row in rows if row and not row.startswith("#")]
    return [
        (re.compile(rf"(?<![\w-]){re.escape(word.strip())}(?![\w-])", re.IGNORECASE), instead.strip())
        for word, _, instead in pairs
    ]


def without_code(text: str) -> str:
    """Return a page with code and quotations blanked; line numbers stay."""

    def blank(match: re.Match[str]) -> str:
        return "\n" * match[0].count("\n")

    text = re.sub(r"^ *(```|:::)[\s\S]*?^ *\1 *$", blank, text, flags=re.MULTILINE)
    text = re.sub(r"(?<=\n\n)(?:(?: {4}.*)?\n)+", blank, text)
    text = re.sub(r"^>.*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"<!--[\s\S]*?-->", blank, text)
    text = re.sub(r"!\[([^\]]*)\]\([^)]*\)", blank, text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"`[^`\n]+`", "CODE", text)


def sentences(text: str) -> Iterator[tuple[int, str]]:
    """Yield the line and the text of each sentence outside code, tables, headings."""
    block: list[str] = []
    start = 0
    for number, line in enumerate([*text.splitlines(), ""], 1):
        item = re.match(r" *([*-]|\d+\.) +", line)
        is_row = line.lstrip().startswith(("#", "|"))
        ends = not line.strip() or is_row or item
        if ends and block:
            for sentence in re.split(r"(?<=[.!?])[\"*)]* +(?=\S)", " ".join(block)):
                yield start, sentence
            block = []
        if line.strip() and not is_row:
            start = start if block else number
            block.append(line[item.end() :].strip() if item else line.strip())


def count_words(sentence: str) -> int:
    """Count the words of a sentence.

    Numbers and pieces of code count, bare punctuation does not.
    """
    return len([word for word in sentence.split() if re.search(r"\w", word)])


def findings(page: Path) -> Iterator[str]:
    """Yield a message for each place on a page that breaks a rule."""
    text = without_code(page.read_text(encoding="utf-8"))
    name = page.relative_to(ROOT) if page.is_relative_to(ROOT) else page
    said = list(sentences(text))
    lengths = [count_words(sentence) for _, sentence in said]
    if not said or not READER.search(said[0][1]):
        yield f"{name}:1: the first sentence does not say who the page is for"
    if lengths and statistics.median(lengths) > MAX_MEDIAN_WORDS:
        yield f"{name}:1: median sentence of {statistics.median(lengths):g} words (limit {MAX_MEDIAN_WORDS})"
    for (number, sentence), length in zip(said, lengths, strict=True):
        if length > MAX_WORDS:
            yield f"{name}:{number}: sentence of {length} words (limit {MAX_WORDS}): {sentence[:80]}..."
    unquoted = re.sub(r"\"[^\"\n]*\"|\*[^*\n]+\*(?!\*)", "", text)
    for number, line in enumerate(unquoted.splitlines(), 1):
        for word, instead in banned_words():
            if match := word.search(line):
                yield f"{name}:{number}: '{match[0]}'. Write: {instead}"


def main(arguments: list[str]) -> int:
    """Lint the given pages, or all of them."""
    checked = [Path(argument).resolve() for argument in arguments] or pages()
    found = [finding for page in checked for finding in findings(page)]
    print("\n".join(found) if found else f"docs_lint: {len(checked)} pages, no findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
