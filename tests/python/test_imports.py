"""Every include and import is allowed by tests/imports.toml."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CPP = ROOT / "cpp"
PACKAGE = ROOT / "python" / "brushsvg"
HEADERS = CPP / "include" / "brushsvg"
RULES = tomllib.loads((ROOT / "tests" / "imports.toml").read_text(encoding="utf-8"))
MAX_FILES = 15  # in a source folder

# Headers without a test that has their name, and the reason.
UNTESTED = {
    "error": "two value types; the tests of their users check them",
    "taut_and_loose": "the bodies of lag.hpp, tested with it",
    "marks": "value types, filled and used by simulate, coverage and io",
    "settings": "a value type, read and written by io",
}
# These files import modules of their own folder, by the names of their table.
BY_NAME = [PACKAGE / folder / "__init__.py" for folder in ("", "cli/commands", "machine/posts", "verify/readback")]


@cache
def files() -> dict[Path, str]:
    paths = [path for path in CPP.rglob("*") if path.suffix in (".hpp", ".cpp", ".h")]
    paths += PACKAGE.rglob("*.py")
    return {path: path.read_text(encoding="utf-8") for path in sorted(paths)}


def language(path: Path) -> str:
    return "python" if path.suffix == ".py" else "cpp"


def unit(path: Path) -> str:
    """Return the top folder of a file, or the stem of a top-level Python module.

    For a public C++ header, return the folder of its source.
    """
    if path.suffix == ".py":
        return path.relative_to(PACKAGE).with_suffix("").parts[0]
    if path.parent != HEADERS:
        return path.relative_to(CPP).parts[0]
    sources = {source.relative_to(CPP).parts[0] for source in CPP.glob(f"*/**/{path.stem}.cpp")}
    return RULES["headers"].get(path.stem) or (sources.pop() if len(sources) == 1 else path.stem)


def included(path: Path, text: str) -> set[str]:
    """Return the folders and libraries that a C++ file includes."""
    found = set()
    for quoted, angled in re.findall(r'^[ \t]*#[ \t]*include\s*(?:"([^"]+)"|<([^>]+)>)', text, re.MULTILINE):
        if angled:
            if not re.fullmatch("[a-z0-9_]+", angled):  # <vector> is part of the standard library
                found.add(angled.split("/")[0])
            continue
        homes = {unit(home) for home in CPP.rglob(Path(quoted).name)} or {quoted}
        assert len(homes) == 1, f"there are several {quoted}: {sorted(homes)}"
        found |= homes
    found |= {python_unit(name.split(".")) for name in re.findall(r'\bimport\(\s*"([^"]+)"', text)}  # pybind11
    return found - {unit(path)}


@cache
def imported(path: Path, text: str) -> list[list[str]]:
    """Return the full names of all imports in a Python file.

    Imports in functions and for type checkers count, too.
    """
    folder = ["brushsvg", *path.relative_to(PACKAGE).parts[:-1]]
    names: list[list[str]] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [alias.name.split(".") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = folder[: len(folder) - node.level + 1] if node.level else []
            base = [*base, *(node.module.split(".") if node.module else [])]
            names += [[*base, alias.name] for alias in node.names]
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__")):
            constant = node.args and isinstance(node.args[0], ast.Constant)
            assert constant or path in BY_NAME, f"{path}: an import that cannot be followed"
            names += [node.args[0].value.split(".")] if constant else []
    return names


def python_unit(name: list[str]) -> str:
    """Return the unit of a module by its full name.

    A name that is not a module comes from __init__.
    """
    if name[0] != "brushsvg":
        return name[0]
    inside = name[1] if len(name) > 1 else "__init__"
    is_module = (PACKAGE / inside).is_dir() or (PACKAGE / f"{inside}.py").is_file()
    return inside if is_module else "__init__"


def uses(path: Path, text: str) -> set[str]:
    if language(path) == "cpp":
        return included(path, text)
    found = {python_unit(name) for name in imported(path, text)} - set(sys.stdlib_module_names)
    return found - {unit(path)}


def complaints(path: Path, text: str) -> list[str]:
    """Return sentences about the forbidden imports of a file."""
    where, own = path.relative_to(ROOT).as_posix(), unit(path)
    rules = RULES[language(path)]
    if own not in rules:
        return [f"{where}: {own} has no row in tests/imports.toml"]
    used = uses(path, text)
    refused = set() if rules[own] == ["*"] else used - set(rules[own])
    found = [f"{where} uses {name}, which {own} may not" for name in sorted(refused)]
    found += [
        f"{where} includes {library} in a header: every user of the header would need it"
        for library in sorted({"ceres", "boost"} & used)
        if path.suffix == ".hpp"
    ]
    return found


@pytest.mark.slow
def test_every_file_follows_the_import_rules():
    assert len(files()) > 60
    found = [sentence for path, text in files().items() for sentence in complaints(path, text)]
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize("kind", ["cpp", "python"])
def test_the_rules_are_minimal_and_point_upward(kind):
    rules = RULES[kind]
    used: dict[str, set[str]] = {name: set() for name in rules}
    for path, text in files().items():
        if language(path) == kind and unit(path) in used:
            used[unit(path)] |= uses(path, text)
    order = list(rules)
    for name, allowed in rules.items():
        if allowed == ["*"]:
            continue
        assert set(allowed) <= used[name], f"{name} does not use {sorted(set(allowed) - used[name])}"
        later = [each for each in allowed if each in rules and order.index(each) >= order.index(name)]
        assert not later, f"{name} uses {later}, which stand below it"


def test_modules_import_each_other_in_one_direction():
    modules = {path.relative_to(PACKAGE.parent).with_suffix("").parts: path for path in PACKAGE.rglob("*.py")}
    graph = {}
    for name, path in modules.items():
        if path.name == "__init__.py":  # These are tables of a folder's names, imported on use.
            continue
        targets = set()
        for full in imported(path, files()[path]):
            for length in (len(full), len(full) - 1):
                target = tuple(full[:length])
                if target in modules:
                    targets.add(target)
                    break
        graph[name] = targets - {name}
    TopologicalSorter(graph).prepare()  # a CycleError names the cycle


def test_folders_stay_small():
    """Source folders stay small.

    Data, public headers, tests, and folders with one file per robot language are exempt.
    """
    exempt = {"posts", "readback", "bindings", "include", "brushsvg"}
    for root in (PACKAGE, CPP):
        for folder in {path.parent for path in files() if path.is_relative_to(root)} - {root}:
            count = len({path.stem for path in files() if path.parent == folder} - {"__init__"})
            assert count <= MAX_FILES or folder.name in exempt, f"{folder.relative_to(ROOT)} has {count} files"


def test_the_core_knows_no_vendor_and_no_format():
    foreign = re.compile(r"\b(svg|dxf|g-?code|linuxcnc|rs274|toml|nlohmann|pybind11|python)\b", re.IGNORECASE)
    core = {"base", "regions", "model", "values", "marks", "inverse", "strokes"}
    for path, text in files().items():
        if path.is_relative_to(CPP) and (path.parent == HEADERS or unit(path) in core):
            found = foreign.search(text)
            assert not found, f"{path.relative_to(ROOT)} mentions {found[0]}"


@pytest.mark.parametrize("header", sorted(HEADERS.glob("*.hpp")), ids=lambda path: path.stem)
def test_each_header_has_a_test_and_a_source_of_its_name(header):
    stem = header.stem
    test = ROOT / "tests" / "cpp" / f"{stem}_test.cpp"
    if stem in UNTESTED:
        assert not test.exists(), f"{test.name} exists: take {stem} off the list of headers without a test"
    else:
        assert test.exists(), f"{header.name} has no {test.name}"
    if stem not in ("brushsvg", "taut_and_loose"):
        assert f'#include "brushsvg/{stem}.hpp"' in files()[HEADERS / "brushsvg.hpp"], f"brushsvg.hpp lacks {stem}.hpp"
    for source in CPP.glob(f"*/**/{stem}.cpp"):
        assert files()[source].startswith(f'#include "brushsvg/{stem}.hpp"\n'), (
            f"{source.name} must include its own header first, which shows that the header stands alone"
        )


def test_every_test_and_binding_is_built():
    built = (ROOT / "tests" / "cpp" / "CMakeLists.txt").read_text()
    for test in (ROOT / "tests" / "cpp").glob("*_test.cpp"):
        assert test.name in built, f"{test.name} is not built: name it in tests/cpp/CMakeLists.txt"
        stem = test.stem.removesuffix("_test")
        assert [*CPP.rglob(f"{stem}.hpp")] or (CPP / stem).is_dir(), f"{test.name} tests no header"
    called = files()[CPP / "bindings" / "module.cpp"]
    for binding in (CPP / "bindings").glob("bind_*.cpp"):
        stem = binding.stem.removeprefix("bind_")
        assert f"    {binding.stem}(m);" in called, f"module.cpp does not call {binding.stem}"
        assert [*CPP.rglob(f"{stem}.hpp")] or (CPP / stem).is_dir(), f"{binding.name} binds no header"


@pytest.mark.parametrize(
    ("path", "text", "named"),
    [
        ("cpp/marks/simulate.cpp", '#include "brushsvg/compensate.hpp"', "uses inverse"),
        ("cpp/include/brushsvg/plan.hpp", '  #  include  "brushsvg/simulate.hpp"', "uses marks"),
        ("cpp/model/brush.cpp", "#include <nlohmann/json.hpp>", "uses nlohmann"),
        ("cpp/model/lag.cpp", "#include <pybind11/eigen.h>", "uses pybind11"),
        ("cpp/include/brushsvg/region.hpp", "#include <boost/polygon/polygon.hpp>", "Boost in a header"),
        ("cpp/marks/sweep.hpp", '#include "brush_json.hpp"', "uses io"),
        ("cpp/vision/scan.cpp", "", "vision has no row"),
        ("cpp/model/lag.cpp", "#include <ceres/ceres.h>", "uses ceres"),
        ("cpp/fit/laws/law_fit.hpp", "#include <ceres/ceres.h>", "Ceres in a header"),
        ("python/brushsvg/machine/posts/gcode.py", "def f():\n    from ...read.design import Design", "read"),
        ("python/brushsvg/machine/posts/abc.py", "from shapely.geometry import Point", "uses shapely"),
        ("python/brushsvg/read/dxf/__init__.py", "from ... import _core", "uses _core"),
        ("python/brushsvg/read/dxf/__init__.py", "import brushsvg.machine.cells.cell as c", "uses machine"),
        ("python/brushsvg/machine/job_program.py", "from brushsvg import find_brush", "uses __init__"),
        ("python/brushsvg/machine/job_program.py", "if TYPE_CHECKING:\n    from ..model import x", "uses model"),
        ("python/brushsvg/machine/writer.py", "import importlib\nimportlib.import_module('cv2')", "uses cv2"),
        ("python/brushsvg/spying.py", "", "spying has no row"),
    ],
)
def test_a_planted_fault_is_named(path, text, named):
    found = complaints(ROOT / path, text)
    assert any(named.lower() in sentence.lower() for sentence in found), found


def test_allowed_imports_are_not_named():
    assert not complaints(CPP / "marks" / "simulate.cpp", '#include <vector>\n#include "brushsvg/lag.hpp"')
    assert not complaints(PACKAGE / "machine" / "posts" / "new.py", "import math\nfrom ..moves import Move\n")


def test_an_import_that_cannot_be_followed_is_refused():
    with pytest.raises(AssertionError, match="cannot be followed"):
        complaints(PACKAGE / "machine" / "writer.py", "import importlib\nimportlib.import_module(name)")


DOCUMENTS = ("ARCHITECTURE.md", "docs/reference/equations.md")


@pytest.mark.parametrize("document", DOCUMENTS)
def test_documents_name_files_that_exist(document):
    quoted = re.findall(r"`([\w.-]+/[\w./-]+)`", (ROOT / document).read_text(encoding="utf-8"))
    assert quoted
    for path in quoted:
        # a pattern, or the name of a format
        if path.isupper() or "NAME" in path or path.startswith("brushsvg/"):
            continue
        assert any((home / name).exists() for home in (ROOT, PACKAGE, CPP) for name in (path, f"{path}.py")), (
            f"{document} names {path}, which is gone"
        )


def test_equations_name_code_and_tests_that_exist():
    """The equations page names only code and tests that exist.

    If a table cell names a file, the file contains the other names in backquotes.
    """
    rows = 0
    for line in (ROOT / "docs" / "reference" / "equations.md").read_text(encoding="utf-8").splitlines():
        for cell in line.split("|") if line.startswith("|") else ():
            words = re.findall("`([^`]+)`", cell)
            paths = [word for word in words if re.fullmatch(r"[\w./-]+\.(hpp|cpp|py|json)", word)]
            if not paths:
                continue
            text = "".join((ROOT / path).read_text(encoding="utf-8") for path in paths)
            for name in set(words) - set(paths):
                assert name in text, f"docs/reference/equations.md: {name} is not in {' or '.join(paths)}"
                rows += 1
    assert rows > 20


def test_the_code_walks_name_functions_that_exist():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    steps = re.findall(
        r"`((?:cpp/)?[\w/]+\.(?:py|cpp))(?:: (\w+))?`",
        text.split("## One drawing")[1].split("## Conventions")[0],
    )
    assert len(steps) > 10
    for path, name in steps:
        file = ROOT / path if path.startswith("cpp/") else PACKAGE / path
        assert not name or f" {name}(" in file.read_text(encoding="utf-8"), f"{path} has no {name}"
