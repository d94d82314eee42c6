"""Check docstrings, comments, messages and names in code for the words of banned_words.txt.

    python tools/words_lint.py                # all of FOLDERS but NOT_YET
    python tools/words_lint.py tests/laws     # any folders or files
    python tools/words_lint.py --count python cpp

Prints file:line: 'word' for each finding and exits with 1 if there are any. `make docs-lint` runs it.
Quotations and pieces of code in backticks do not count, nor strings without a space: they are keys.
"""

from __future__ import annotations

import argparse
import io
import re
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from docs_lint import BANNED_WORDS, ROOT, banned_words

FOLDERS = ("python", "cpp", "tests", "examples", "benchmarks", "tools", "plugins")
NOT_YET: tuple[str, ...] = ()  # files and folders that still contain banned words
BANNED_IN_CODE = BANNED_WORDS.with_name("banned_words_in_code.txt")
PYTHON = (".py", ".pyi")
CPP = (".cpp", ".hpp", ".h", ".cc")
QUOTATION = re.compile(r"(?<![\w\\])\"[^\"\n]*\"(?!\w)|`[^`\n]*`")
CPP_TEXT = re.compile(
    r"//(?P<line>.*)|/\*(?P<block>[\s\S]*?)\*/|\bR\"(?P<mark>\w*)\((?P<raw>[\s\S]*?)\)(?P=mark)\"|\"(?P<string>(?:\\.|[^\"\\\n])*)\"|'(?:\\.|[^'\\\n])+'"
)
KEPT_NAMES = ("tell",)  # `tell` of file objects
QUOTING = (
    "tests/python/test_docs_lint.py",
    "tests/python/test_words_lint.py",
    "tools/words_lint.py",
)  # these quote the words
PREFIX = re.compile(r"^[rbfuRBFU]*(\"\"\"|'''|\"|')")


def python_text(source: str) -> Iterator[tuple[int, str]]:
    """Yield the first line and the text of each docstring, comment, message and name."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], QUOTATION.sub("", token.string)
        elif token.type == tokenize.NAME and token.string not in KEPT_NAMES:
            yield token.start[0], token.string.replace("_", "  ")  # two spaces match no phrase
        elif token.type == tokenize.STRING and " " in token.string:
            delimiter = PREFIX.match(token.string)
            inside = token.string[delimiter.end() : -len(delimiter[1])] if delimiter else token.string
            yield token.start[0], QUOTATION.sub("", inside)


def cpp_text(source: str) -> Iterator[tuple[int, str]]:
    """Yield the first line and the text of each comment and each string with a space."""
    for match in CPP_TEXT.finditer(source):
        text = match["line"] or match["block"] or match["raw"] or match["string"] or ""
        if " " in text:
            yield source.count("\n", 0, match.start()) + 1, QUOTATION.sub("", text)


def findings(path: Path, banned: list[tuple[re.Pattern[str], str]]) -> Iterator[tuple[int, str, str]]:
    """Yield the line, the banned word and what to write instead."""
    source = path.read_text(encoding="utf-8")
    texts = python_text(source) if path.suffix in PYTHON else cpp_text(source)
    for start, text in texts:
        for offset, line in enumerate(text.splitlines()):
            for pattern, instead in banned:
                for match in pattern.finditer(line):
                    yield start + offset, match[0], instead


def sources(folders: list[Path]) -> list[Path]:
    """Return the source files of these paths, without files that quote the words."""
    found = [path for folder in folders for path in ([folder] if folder.is_file() else sorted(folder.rglob("*")))]
    kept = [path for path in found if path.suffix in PYTHON + CPP and path.is_file()]
    return [path for path in kept if path.relative_to(ROOT).as_posix() not in QUOTING]


def checked_sources() -> list[Path]:
    """Return the source files that have to be free of the words."""
    waiting = {path for pattern in NOT_YET for found in ROOT.glob(pattern) for path in sources([found])}
    return [path for path in sources([ROOT / folder for folder in FOLDERS]) if path not in waiting]


def main(arguments: list[str]) -> int:
    """Check the given folders, or all that have to be clean."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument(
        "--count", action="store_true", help="print how many there are in each folder, and of each word"
    )
    given = parser.parse_args(arguments)
    banned = banned_words() + banned_words(BANNED_IN_CODE)
    checked = sources([path.resolve() for path in given.folders]) if given.folders else checked_sources()
    found = [(path.relative_to(ROOT), *finding) for path in checked for finding in findings(path, banned)]
    if given.count:
        for title, counts in (
            ("folder", Counter(path.parent.as_posix() for path, *_ in found)),
            ("word", Counter(word.lower() for _, _, word, _ in found)),
        ):
            print(title, *(f"  {count:5d} {key}" for key, count in counts.most_common()), sep="\n")
    else:
        print(
            *(f"{path}:{line}: '{word}'. Write: {instead}" for path, line, word, instead in found),
            sep="\n",
            end="",
        )
    print(f"words_lint: {len(checked)} files, {len(found)} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
