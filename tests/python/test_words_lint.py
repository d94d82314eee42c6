"""tools/words_lint.py finds listed words in code.

It finds none in the folders that must be free of them.
"""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
import words_lint

BANNED = words_lint.banned_words() + words_lint.banned_words(words_lint.BANNED_IN_CODE)


def found(folder: Path, name: str, text: str) -> list[tuple[int, str, str]]:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return list(words_lint.findings(path, BANNED))


def test_the_code_has_no_findings():
    checked = words_lint.checked_sources()
    assert len(checked) > 500
    assert [(path, *each) for path in checked for each in words_lint.findings(path, BANNED)] == []


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.py", "x = 1\n# the user is told\n"),
        ("a.py", 'def run():\n    """Run.\n\n    Wherever it lies."""\n'),
        ("a.py", "raise ValueError('nobody is told')\n"),
        ("a.py", "def test_it_is_told():\n    pass\n"),
        ("a.cpp", "int x;  // beside y\n"),
        ("a.hpp", "/* what\n   is led */\n"),
        ("a.cpp", 'TEST_CASE("a point lies there") {}\n'),
    ],
)
def test_a_word_is_found(tmp_path, name, text):
    assert found(tmp_path, name, text)


def test_a_word_in_a_raw_string_is_found(tmp_path):
    rows = words_lint.BANNED_WORDS.read_text(encoding="utf-8").splitlines()
    word = next(row.split(" ->")[0] for row in rows if not row.startswith("#"))
    assert found(tmp_path, "a.cpp", f'm.def("f", &f, R"(Where\nit "is", the user is {word}.)");\n')


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.py", "# the key \"told\", and `beside`\nx = {'told': 1}\n"),
        ("a.py", "stroke.target_mm = []\n"),
        ("a.cpp", '// a "told" and `beside`\nconst char* key = "told";\n'),
    ],
)
def test_quotations_and_keys_do_not_count(tmp_path, name, text):
    assert found(tmp_path, name, text) == []
