"""Includes and imports held against the tables of rooms in ARCHITECTURE.md; one stem everywhere.

A room is a header with its source, a folder of C++, or a folder (with a slash) or single file of the package. Large
folders have a table of their own for the files inside of them.
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CPP = ROOT / "cpp"
PACKAGE = ROOT / "python" / "brushsvg"
HEADERS = CPP / "include" / "brushsvg"

# Headers that need no test of their own stem, and why.
UNTESTED = {
    "error": "two value types; what is said with them is tested where it is said",
    "lag_impl": "the bodies of lag.hpp, tested with it",
    "marks": "value types; simulate, coverage and io fill and carry them",
    "settings": "a value type; io reads and writes it",
    **dict.fromkeys(("interrupt", "wanted", "miss", "verdict", "overlay"), "a name until 0.2"),
}


# The table ------------------------------------------------------------------------------------------


LARGE = ("machine", "calibration", "drawing/svg", "drawing/dxf")  # folders with a table of their own


@cache
def table(folder: str = "") -> tuple[tuple[tuple[str, ...], frozenset[str]], ...]:
    """(Rooms of a row, what they may touch), from top to bottom; of a large folder its files or folders, and what they
    may touch of each other."""
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    lines = iter(text.splitlines())
    title = f"| inside `{folder}` | may touch |" if folder else "| room | may touch |"
    next(line for line in lines if line.startswith(title))
    next(lines)
    rows = []
    for line in lines:
        if not line.startswith("|"):
            break
        rooms, touched = (re.findall("`([^`]+)`", cell) for cell in line.split("|")[1:3])
        rows.append((tuple(rooms), frozenset(touched)))
    return tuple(rows)


def row_of(room: str, folder: str = "") -> int | None:
    return next((number for number, (rooms, _) in enumerate(table(folder)) if room in rooms), None)


# What a file touches --------------------------------------------------------------------------------


def cpp_room(path: Path) -> str:
    """Stem of a header or source of the core, folder of anything else."""
    folder = path.relative_to(CPP).parent.as_posix()
    return path.stem if folder in ("include/brushsvg", "src") else folder


def cpp_touches(path: Path, text: str) -> set[str]:
    touched = set()
    for line in re.findall(r"^[ \t]*#[ \t]*include\b(.*)", text, re.MULTILINE):
        found = re.match(r'\s*(?:"([^"]+)"|<([^>]+)>)', line)
        assert found, f"{path}: #include{line} does not say what it includes"
        quoted, angled = found.groups()
        if angled:
            if not re.fullmatch("[a-z0-9_]+", angled):  # <vector> is the standard library's
                touched.add(angled.split("/")[0])
            continue
        name = Path(quoted).name
        homes = {cpp_room(home) for home in CPP.rglob(name)} or {quoted}
        assert len(homes) == 1, f"there are several {name}: {sorted(homes)}"
        touched |= homes
    for module in re.findall(r'\bimport\(\s*"([^"]+)"', text):  # pybind11's
        touched.add(python_target(module.split(".")))
    return touched - {cpp_room(path)}


def python_room(path: Path, folder: str = "") -> str:
    parts = path.relative_to(PACKAGE / folder).with_suffix("").parts
    return f"{parts[0]}/" if len(parts) > 1 else parts[0]


def python_target(parts: list[str], folder: str = "") -> str | None:
    """Room of a module by its full name; a name that is no module of the package comes from __init__. In a folder: of
    its own files, None for anything outside."""
    if parts[0] != "brushsvg":
        return None if folder else parts[0]
    above = folder.split("/") if folder else []
    if parts[1 : 1 + len(above)] != above:
        return None
    inside = parts[1 + len(above)] if len(parts) > 1 + len(above) else "__init__"
    home = PACKAGE / folder / inside
    if inside == "_core":  # the built module: its folder holds what type checkers are told of it
        return inside
    if home.is_dir():
        return f"{inside}/"
    return inside if home.with_suffix(".py").is_file() else "__init__"


# these import by the names of a table: the package what is public, the commands a file beside them
BY_NAME = (PACKAGE / "__init__.py", PACKAGE / "cli" / "commands" / "__init__.py")


@cache
def imported(path: Path, text: str) -> list[list[str]]:
    """Every import anywhere in the file, those inside functions and for type checkers too, by its full name."""
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


def python_touches(path: Path, text: str, folder: str = "") -> set[str]:
    touched = {python_target(name, folder) for name in imported(path, text)}
    known = {name for name in touched if name and name not in sys.stdlib_module_names}
    return known - {python_room(path, folder)}


def allowed_to(room: str, folder: str = "") -> set[str] | None:
    number = row_of(room, folder)
    if number is None:
        return None
    rooms, may = table(folder)[number]
    allowed = {*may, *rooms}
    if "*" in may:
        allowed.update(*(names for names, _ in table(folder)[:number]))
    return allowed


def complaints(path: Path, text: str) -> list[str]:
    """What a file does that its room may not, in sentences."""
    is_python = path.suffix == ".py"
    where = path.relative_to(ROOT).as_posix()
    touched = python_touches(path, text) if is_python else cpp_touches(path, text)
    both = [("", python_room(path) if is_python else cpp_room(path), touched)]
    both += [
        (folder, python_room(path, folder), python_touches(path, text, folder))
        for folder in LARGE
        if is_python and path.is_relative_to(PACKAGE / folder)
    ]
    found = []
    for folder, room, touches in both:
        inside = f" inside {folder}" if folder else ""
        allowed = allowed_to(room, folder)
        if allowed is None:
            found.append(f"{where} belongs to room {room}{inside}, which has no row in ARCHITECTURE.md")
        else:
            found += [
                f"{where} touches {name}, which room {room}{inside} may not: see the table in ARCHITECTURE.md"
                for name in sorted(touches - allowed)
            ]
    if "ceres" in touched and path.suffix == ".hpp":
        found.append(f"{where} includes Ceres in a header: whoever includes it would have to have it")
    if "boost" in touched and path.suffix == ".hpp":
        found.append(f"{where} includes Boost in a header: whoever includes it would have to have it")
    return found


@cache
def files() -> dict[Path, str]:
    paths = [path for path in CPP.rglob("*") if path.suffix in (".hpp", ".cpp", ".h")]
    paths += PACKAGE.rglob("*.py")
    return {path: path.read_text(encoding="utf-8") for path in sorted(paths)}


# The house ------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_every_file_keeps_to_its_room():
    assert len(files()) > 60
    found = [sentence for path, text in files().items() for sentence in complaints(path, text)]
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize("folder", ["", *LARGE])
def test_the_table_allows_what_is_needed_and_no_more(folder):
    rows = table(folder)
    touched: dict[int, set[str]] = {number: set() for number in range(len(rows))}
    inhabited = set()
    for path, text in files().items():
        is_python = path.suffix == ".py"
        if folder and not (is_python and path.is_relative_to(PACKAGE / folder)):
            continue
        room = python_room(path, folder) if is_python else cpp_room(path)
        inhabited.add(room)
        if (number := row_of(room, folder)) is not None:
            touched[number] |= python_touches(path, text, folder) if is_python else cpp_touches(path, text)
    for number, (rooms, may) in enumerate(rows):
        empty = set(rooms) - inhabited - {"_core"}  # the built module
        assert not empty, f"the table has a row for {sorted(empty)}, where there is no file"
        unused = may - touched[number] - {"*"}
        assert not unused, f"the table lets {rooms[0]} touch {sorted(unused)}, which it does not"


@pytest.mark.parametrize("folder", ["", *LARGE])
def test_nothing_points_left(folder):
    rooms = [name for names, _ in table(folder) for name in names]
    assert len(rooms) == len(set(rooms)), "a room has two rows"
    for number, (names, may) in enumerate(table(folder)):
        for name in may & set(rooms):
            assert row_of(name, folder) < number, f"{names[0]} touches {name}, whose row is not above its own"


def test_a_large_folder_has_a_table_of_its_own():
    assert len(table()) <= 45, "a table that nobody reads tells nothing"


def test_arrows_that_must_not_be():
    def reach(room: str, seen: frozenset[str] = frozenset()) -> set[str]:
        below = set(table()[row_of(room)][1]) - seen if row_of(room) is not None else set()
        return below.union(*(reach(name, seen | below) for name in below))

    for room, others in {
        "simulate": {"compensate", "stroke", "target_mark"},
        "compensate": {"io", "bindings"},
        "drawing/": {"_core", "strokes/", "brush/", "machine/"},
        "machine/": {"drawing/", "strokes/", "brush/", "cv2"},
        "pictures/": {"brush/", "strokes/", "pipeline/"},
    }.items():
        assert not reach(room) & others, f"{room} reaches {sorted(reach(room) & others)}"


def test_the_core_knows_no_vendor_and_no_format():
    foreign = re.compile(r"\b(svg|dxf|g-?code|linuxcnc|rs274|toml|nlohmann|pybind11|python)\b", re.IGNORECASE)
    for path, text in files().items():
        if path.is_relative_to(HEADERS) or path.is_relative_to(CPP / "src"):
            found = foreign.search(text)
            assert not found, f"{path.relative_to(ROOT)} speaks of {found[0]}"


@pytest.mark.parametrize("header", sorted(HEADERS.glob("*.hpp")), ids=lambda path: path.stem)
def test_one_stem_everywhere(header):
    stem = header.stem
    test = ROOT / "tests" / "cpp" / f"{stem}_test.cpp"
    if stem in UNTESTED:
        assert not test.exists(), f"{test.name} exists: take {stem} off the list of headers without a test"
    else:
        assert test.exists(), f"{header.name} has no {test.name}"
    if stem not in ("brushsvg", "lag_impl") and "until 0.2" not in UNTESTED.get(stem, ""):
        assert f'#include "brushsvg/{stem}.hpp"' in files()[HEADERS / "brushsvg.hpp"], (
            f"brushsvg.hpp lacks {stem}.hpp"
        )
    source = CPP / "src" / f"{stem}.cpp"
    if source.exists():
        assert files()[source].startswith(f'#include "brushsvg/{stem}.hpp"\n'), (
            f"{source.name} must include its own header first: that shows the header stands alone"
        )


def test_no_test_and_no_binding_is_forgotten():
    listed = (ROOT / "tests" / "cpp" / "CMakeLists.txt").read_text()
    for test in (ROOT / "tests" / "cpp").glob("*_test.cpp"):
        assert test.name in listed, f"{test.name} is not built: name it in tests/cpp/CMakeLists.txt"
        stem = test.stem.removesuffix("_test")
        homes = [*CPP.rglob(f"{stem}.hpp")]
        assert homes or (CPP / stem).is_dir(), f"{test.name} tests no header"
    called = files()[CPP / "bindings" / "module.cpp"]
    for binding in (CPP / "bindings").glob("bind_*.cpp"):
        stem = binding.stem.removeprefix("bind_")
        assert f"    {binding.stem}(m);" in called, f"module.cpp does not call {binding.stem}"
        homes = [*CPP.rglob(f"{stem}.hpp")]
        assert homes or (CPP / stem).is_dir(), f"{binding.name} binds no header"


# The documents --------------------------------------------------------------------------------------


def listed() -> dict[str, set[str]]:
    """By folder of the package, what the list in the order of the arrow has of it."""
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    found: dict[str, set[str]] = {}
    folder = ""
    for line in text.split("The package, in the order of the arrow:")[1].split("## ")[0].splitlines():
        first, *rest = re.split(r"\s{2,}", line.strip())
        if "/" in first and rest:
            folder, rest = first.rstrip("/"), rest[1:]
        else:
            rest = [first, *rest]
        found.setdefault(folder, set()).update(" ".join(rest).split())
    return found


FOLDERS = sorted(path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists())


@pytest.mark.parametrize("folder", FOLDERS)
def test_the_list_of_the_package_has_every_file(folder):
    here = [path for path in (PACKAGE / folder).iterdir() if not path.name.startswith("_")]
    names = {path.stem if path.suffix == ".py" else f"{path.name}/" for path in here}
    assert listed()[folder] == names


DOCUMENTS = ("ARCHITECTURE.md", "docs/reference/equations.md")


@pytest.mark.parametrize("document", DOCUMENTS)
def test_documents_name_files_that_exist(document):
    quoted = re.findall(r"`([\w.-]+/[\w./-]+)`", (ROOT / document).read_text(encoding="utf-8"))
    assert quoted
    for path in quoted:
        if path.isupper() or "NAME" in path or path.startswith("brushsvg/"):  # a pattern; a format's name
            continue
        assert any(
            (home / name).exists() for home in (ROOT, PACKAGE, CPP) for name in (path, f"{path}.py")
        ), f"{document} names {path}, which is gone"


def test_equations_name_code_and_tests_that_exist():
    """In a cell of a table, names in backquotes stand in a file that the same cell names."""
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


# The watchman is awake ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "text", "named"),
    [
        ("cpp/src/simulate.cpp", '#include "brushsvg/compensate.hpp"', "touches compensate"),
        ("cpp/include/brushsvg/plan.hpp", '  #  include  "brushsvg/simulate.hpp"', "touches simulate"),
        ("cpp/src/brush.cpp", "#include <nlohmann/json.hpp>", "touches nlohmann"),
        ("cpp/src/lag.cpp", "#include <pybind11/eigen.h>", "touches pybind11"),
        ("cpp/src/coverage.cpp", "#include <boost/polygon/polygon.hpp>", "touches boost"),
        (
            "cpp/include/brushsvg/region.hpp",
            "#include <boost/polygon/polygon.hpp>",
            "includes Boost in a header",
        ),
        ("cpp/src/sweep.hpp", '#include "brush_json.hpp"', "touches io"),
        (
            "cpp/bindings/bind_io.cpp",
            'py::module_::import("brushsvg.pipeline.preparation")',
            "touches pipeline/",
        ),
        ("cpp/src/spline.cpp", "", "room spline, which has no row"),
        ("cpp/vision/scan.cpp", "", "room vision, which has no row"),
        ("cpp/src/lag.cpp", "#include <ceres/ceres.h>", "touches ceres"),
        ("cpp/fit/laws/law_fit.hpp", "#include <ceres/ceres.h>", "includes Ceres in a header"),
        (
            "python/brushsvg/machine/posts/gcode.py",
            "def f():\n    from ...drawing.design import Design",
            "drawing/",
        ),
        ("python/brushsvg/machine/posts/abc.py", "from shapely.geometry import Point", "touches shapely"),
        (
            "python/brushsvg/machine/cell.py",
            "from . import program",
            "touches program, which room cell inside",
        ),
        ("python/brushsvg/machine/new.py", "", "room new inside machine, which has no row"),
        ("python/brushsvg/drawing/dxf/__init__.py", "from ... import _core", "touches _core"),
        ("python/brushsvg/drawing/dxf/__init__.py", "import brushsvg.machine.cell as c", "touches machine/"),
        ("python/brushsvg/drawing/svg/colour.py", "from .element import x", "touches element"),
        ("python/brushsvg/machine/program.py", "from brushsvg import find_brush", "touches __init__"),
        (
            "python/brushsvg/machine/program.py",
            "if TYPE_CHECKING:\n    from ..brush import x",
            "touches brush/",
        ),
        (
            "python/brushsvg/evaluation/report.py",
            "import importlib\nimportlib.import_module('cv2')",
            "touches cv2",
        ),
        ("python/brushsvg/spying.py", "", "room spying, which has no row"),
    ],
)
def test_a_planted_fault_is_named(path, text, named):
    found = complaints(ROOT / path, text)
    assert any(named in sentence for sentence in found), found


def test_what_is_allowed_is_not_named():
    assert not complaints(CPP / "src" / "simulate.cpp", '#include <vector>\n#include "brushsvg/lag.hpp"')
    assert not complaints(
        PACKAGE / "machine" / "posts" / "new.py", "import math\nfrom ..motion import Move\n"
    )


def test_an_import_that_cannot_be_followed_is_refused():
    with pytest.raises(AssertionError, match="cannot be followed"):
        complaints(PACKAGE / "evaluation" / "report.py", "import importlib\nimportlib.import_module(name)")


def test_every_package_that_is_asked_for_says_what_it_is_for():
    """pyproject's names in the first column of the table of dependencies, and CMake's."""
    page = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8").split("## Dependencies")[1]
    told = " ".join(re.findall(r"^\| (.*?) \|", page, re.MULTILINE)).lower()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    asked = [*project["build-system"]["requires"], *project["project"]["dependencies"]]
    asked += [each for extra in project["project"]["optional-dependencies"].values() for each in extra]
    named = {re.match(r"[\w-]+", each)[0].lower() for each in asked} | {
        "eigen",
        "ceres",
        "boost",
        "nlohmann_json",
    }
    spelt = {"opencv-python-headless": "opencv", "myst-parser": "myst"}
    assert sorted(name for name in named if spelt.get(name, name) not in told) == []
