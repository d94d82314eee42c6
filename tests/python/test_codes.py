"""docs/diagnostics.md lists the codes of all that a person is told, and nothing else."""

import ast
import re
from fnmatch import fnmatch
from pathlib import Path

import pytest

from brushsvg import Error, _core
from brushsvg.brush.library import find_brush

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "brushsvg"
LIBRARY = ROOT / "cpp"
CODE = re.compile("[a-z]+(-[a-z]+)*")


def codes_in(node: ast.AST):
    """Texts of an expression; what an f-string leaves open is a *."""
    if isinstance(node, ast.JoinedStr):
        yield "".join(part.value if isinstance(part, ast.Constant) else "*" for part in node.values)
    elif isinstance(node, ast.Constant) and node.value:
        yield node.value
    elif not isinstance(node, ast.Compare):
        for child in ast.iter_child_nodes(node):
            yield from codes_in(child)


def in_sources() -> tuple[set[str], list[str]]:
    """The codes, and the places of notices and refusals that have none."""
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
    """The codes in C++, and the places of warnings and refusals without: a code is the first that they are given."""
    found, without = set(), []
    for file in sorted([*LIBRARY.rglob("*.cpp"), *LIBRARY.rglob("*.hpp")]):
        text = re.sub("//.*", "", file.read_text())
        for given in re.finditer(
            r"(?:throw (?:brushsvg::)?Error\(|\bWarning\{|(?:\.|->)refuse\()\s*(\w+,|\"[^\"]*\")?", text
        ):
            first = (given[1] or "").strip('"')
            if CODE.fullmatch(first):
                found.add(first)
            elif first != "code,":  # handed on
                without.append(f"{file.relative_to(LIBRARY)}:{text[: given.start()].count(chr(10)) + 1}")
    return found, without


def in_docs() -> list[str]:
    rows = re.findall(r"^\| (`.*?) \|", (ROOT / "docs" / "diagnostics.md").read_text(), re.MULTILINE)
    return re.findall("`([^`]+)`", " ".join(rows))


def test_every_notice_and_refusal_has_a_code():
    assert in_sources()[1] == []
    assert in_library()[1] == []


def test_the_table_lists_the_codes_that_there_are():
    listed, found = in_docs(), in_sources()[0] | in_library()[0]
    assert len(listed) == len(set(listed)), "one stands twice"
    assert all(CODE.fullmatch(code) for code in listed)
    assert sorted(code for code in found if not any(fnmatch(each, code) for each in listed)) == []
    assert sorted(each for each in listed if not any(fnmatch(each, code) for code in found)) == []


def test_python_is_told_the_codes_of_the_library():
    with pytest.raises(Error) as refused:
        _core.read_plan('{"format": "brushsvg/plan", "version": 2}')
    assert (refused.value.code, refused.value.value) == ("version-unknown", 2)
    brush = find_brush("round-6")
    odd = _core.remarks(brush)
    assert {notice.code for notice in odd} <= in_library()[0] and len(odd) > 0
    line = _core.Stroke("a", [[0, 0, 1, 0, 2, 0, 9, 0]], half_width=[(0, 0.05), (1, 0.05)])
    (warned,) = _core.compensate([line], brush, (50, 50)).warnings
    assert (warned.where, warned.code) == ("a", "depth-not-measured")
