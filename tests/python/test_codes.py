"""docs/reference/diagnostics.md lists exactly the codes of all notices."""

import ast
import re
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest

from brushsvg import Error, _core
from brushsvg.model.library import find_brush

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "brushsvg"
LIBRARY = ROOT / "cpp"
TESTS = ROOT / "tests"
CODE = re.compile("[a-z]+(-[a-z]+)*")
FOUR_WORDS = re.compile(r"(?<![\w-])[A-Za-z][a-z]+(?: [a-z]+(?:'[a-z]+)?){3}(?![\w-])")
QUOTED = {  # file: number of its expected texts with four or more plain words, which no code can replace
    "integration/command.py": 1,  # the beginning of an internal error's message
    "python/test_readback.py": 3,  # lines from the header and the end of a program
    "python/test_jaka.py": 1,
    "python/test_ros2.py": 1,  # the end of a table
    "python/test_docs_lint.py": 2,  # sentences that the linter must find
    "python/test_words_lint.py": 1,
    "python/test_examples.py": 4,  # output of the examples
    "python/test_imports.py": 4,  # messages for developers
}


def codes_in(node: ast.AST):
    """Yield the texts of an expression, with * for the variable parts of f-strings."""
    if isinstance(node, ast.JoinedStr):
        yield "".join(part.value if isinstance(part, ast.Constant) else "*" for part in node.values)
    elif isinstance(node, ast.Constant) and node.value:
        yield node.value
    elif not isinstance(node, ast.Compare):
        for child in ast.iter_child_nodes(node):
            yield from codes_in(child)


@cache
def in_sources() -> tuple[set[str], list[str]]:
    """Return the codes in Python, and the places of notices and errors without one."""
    found, without = set(), []
    for file in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            if not isinstance(node, ast.Call):
                continue
            given = {word.arg: word.value for word in node.keywords}
            found.update(codes_in(given["code"]) if "code" in given else ())
            name = node.func.id if isinstance(node.func, ast.Name) else ""
            whole = any(isinstance(arg, ast.Starred) for arg in node.args) or len(node.args) > 4
            if name in ("Error", "Notice") and "code" not in given and not whole:
                without.append(f"{file.relative_to(PACKAGE)}:{node.lineno}")
    return found, without


def in_library() -> tuple[set[str], list[str]]:
    """Return the codes in C++, and the places of warnings and errors without one.

    The code is the first argument.
    """
    found, without = set(), []
    for file in sorted([*LIBRARY.rglob("*.cpp"), *LIBRARY.rglob("*.hpp")]):
        text = re.sub("//.*", "", file.read_text())
        for given in re.finditer(
            r"(?:throw (?:brushsvg::)?Error\(|\bWarning\{|(?:\.|->)refuse\()\s*(\w+,|\"[^\"]*\")?", text
        ):
            first = (given[1] or "").strip('"')
            if CODE.fullmatch(first):
                found.add(first)
            elif first != "code,":  # a code that is passed on
                without.append(f"{file.relative_to(LIBRARY)}:{text[: given.start()].count(chr(10)) + 1}")
    return found, without


def in_docs() -> list[str]:
    rows = re.findall(r"^\| (`.*?) \|", (ROOT / "docs" / "reference" / "diagnostics.md").read_text(), re.MULTILINE)
    return re.findall("`([^`]+)`", " ".join(rows))


def test_every_notice_and_refusal_has_a_code():
    assert in_sources()[1] == []
    assert in_library()[1] == []


def test_the_table_lists_exactly_the_existing_codes():
    listed, found = in_docs(), in_sources()[0] | in_library()[0]
    assert len(listed) == len(set(listed)), "one stands twice"
    assert all(CODE.fullmatch(code) for code in listed)
    assert sorted(code for code in found if not any(fnmatch(each, code) for each in listed)) == []
    assert sorted(each for each in listed if not any(fnmatch(each, code) for code in found)) == []


def test_python_has_the_codes_of_the_cpp_library():
    with pytest.raises(Error) as refused:
        _core.read_plan('{"format": "brushsvg/plan", "version": 3}')
    assert (refused.value.code, refused.value.value) == ("version-unknown", 3)
    brush = find_brush("round-6")
    odd = _core.remarks(brush)
    assert {notice.code for notice in odd} <= in_library()[0] and len(odd) > 0
    line = _core.Stroke("a", [[0, 0, 1, 0, 2, 0, 9, 0]], half_width=[(0, 0.05), (1, 0.05)])
    (warned,) = _core.compensate([line], brush, (50, 50)).warnings
    assert (warned.where, warned.code) == ("a", "depth-not-measured")


def expected_by(tree: ast.AST):
    """Yield assertions, match= values and the cases of parametrize."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Assert):
            yield node.test
        elif isinstance(node, ast.keyword) and node.arg == "match":
            yield node.value
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(".parametrize"):
            yield from node.args


def texts_in(node: ast.AST):
    """Yield the texts of an expression without dictionary keys.

    The keys are the names of cases.
    """
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    for child in node.values if isinstance(node, ast.Dict) else ast.iter_child_nodes(node):
        yield from texts_in(child)


@pytest.mark.slow
def test_tests_expect_codes_and_numbers_and_quote_no_sentences():
    """Tests expect codes and numbers and quote no sentences.

    Sentences may be reworded. diagnostics.py has the functions for this comparison.
    """
    found = {}
    for file in sorted(TESTS.rglob("*.py")):
        trees = expected_by(ast.parse(file.read_text(encoding="utf-8")))
        if quoted := [text for tree in trees for text in texts_in(tree) if FOUR_WORDS.search(text)]:
            found[file.relative_to(TESTS).as_posix()] = quoted
    assert {file: len(quoted) for file, quoted in found.items()} == QUOTED, found


def test_cpp_tests_check_refusals_by_codes_and_numbers():
    """The C++ tests check refusals by code and numbers.

    Only refusal.hpp searches sentences for numbers and names. fit_nonsense.cpp only checks that there is a
    sentence.
    """
    requested = {file.name for file in (TESTS / "cpp").iterdir() if "what()" in file.read_text(encoding="utf-8")}
    assert requested <= {"refusal.hpp", "brushsvg_test.cpp", "fit_nonsense.cpp", "mark_fit_test.cpp"}
    words = {file.name for file in (TESTS / "cpp").iterdir() if "THROWS_WITH" in file.read_text(encoding="utf-8")}
    assert not words
