"""pyright, strict, finds no error in shown Python code and in public names.

The code is in README, docs, examples, notebooks and the article's figures. Every public name is checked with
its members. pyright also finds mistakes that a user could make in this code.

Some parts are not checked. matplotlib's functions have keywords without types, so partly unknown members pass
in files that draw. every_name.py checks all members of brushsvg. svgpathtools has no types. A cell of a
notebook may end in an expression, which is shown.
"""

import inspect
import json
import os
import shutil
import subprocess
import sys
from operator import attrgetter
from pathlib import Path

import pytest
from shown_code import NOTEBOOKS, PAGES, REPOSITORY, blocks, cells, name_of

import brushsvg

PACKAGES = {"pyright": "1.1.414"}
PACKAGE = REPOSITORY / "python" / "brushsvg"
FIGURES = REPOSITORY / "examples" / "article" / "figures"
OTHERS = "machines/ebb.md", "machines/ur.md"  # these pages show programs that do not import brushsvg
# Names that a page uses without showing their origin.
GIVEN = {}
NOT_REQUESTED = {
    "matplotlib": "reportUnknownMemberType=false",
    "svgpathtools": "reportMissingTypeStubs=false",
    "notebook": "reportUnusedExpression=false",
}
PROGRAM = """import brushsvg
from brushsvg import laws

drawing = brushsvg.read_drawing("a.svg")
strokes, notices = brushsvg.strokes(drawing)
brush = brushsvg.find_brush("round-6")
done = brushsvg.compensate(strokes, brush, drawing.sheet_mm)
print(done.plan.passes[0].poses_mm[:, 2].min(), brush.lag(5.0) + 1.0, notices[0].sentence)
made = brushsvg.convert("a.svg", "a.ngc", brush=brush, width=3.0, figures=True)
overlap = made.figures.total.overlap if made.figures else None
measured = brushsvg.calibrate({"lag": [], "width": [], "name": "mine"})
fits = [law.fit.r_squared for law in measured.fit.laws if law.fit]
alpha_rad = laws.alpha_after(0.5, [1.0, 2.0], 3.0)
"""
# (original text, replacement, pyright's rule)
PLANTED = (
    ('read_drawing("a.svg")', "read_drawing(3)", "reportArgumentType"),
    ("drawing.sheet_mm)", "drawing.sheet)", "reportAttributeAccessIssue"),
    ('find_brush("round-6")', "find_brush(6)", "reportArgumentType"),
    ("strokes, brush, drawing", "brush, strokes, drawing", "reportArgumentType"),
    (", brush, drawing.sheet_mm)", ", brush)", "reportCallIssue"),
    ("brush.lag(5.0) + 1.0", 'brush.lag(5.0) + "1"', "reportOperatorIssue"),
    (" if made.figures else None", "", "reportOptionalMemberAccess"),
    ("width=3.0", "widht=3.0", "reportCallIssue"),
    ("width=3.0", 'width="3"', "reportArgumentType"),
    (" if law.fit", "", "reportOptionalMemberAccess"),
    ('"name": "mine"', '"name": 3', "reportAttributeAccessIssue"),
    ("[1.0, 2.0], 3.0)", "[1.0, 2.0])", "reportCallIssue"),
    ("0.5, [1.0", "object(), [1.0", "reportArgumentType"),
    ("strokes, notices =", "strokes, notices, more =", "reportAssignmentType"),
)


def shown() -> dict[str, str]:
    """Return {name of a file: its code as shown}."""
    found = {f"figure {path.stem}": path.read_text() for path in FIGURES.glob("*.py")}
    found |= {f"example {path.stem}": path.read_text() for path in (REPOSITORY / "examples").glob("*.py")}
    found |= {f"notebook {path.stem}": "\n".join(cells(path)) for path in NOTEBOOKS}
    for page in PAGES:
        code = [block.code for block in blocks(page) if block.kind == "python"]
        if code and name_of(page) not in OTHERS:
            stem = name_of(page).removesuffix(".md").replace("/", " ")
            found[f"page {stem}"] = "\n".join([GIVEN.get(name_of(page), ""), *code])
    return found


def requested(name: str, code: str) -> str:
    """Return the code below a line that names its unchecked rules."""
    spared = [rule for reason, rule in NOT_REQUESTED.items() if f"import {reason}" in code or reason == name.split()[0]]
    spared += [NOT_REQUESTED["matplotlib"]] if "from matplotlib" in code else []
    return f"# pyright: {', '.join(spared)}\n{code}" if spared else code


def every_name() -> str:
    """Return a program with every public name and every member of public classes."""
    names = {name for name in brushsvg.__all__ if name not in ("__version__", "laws")}
    lines = ["import brushsvg", ""]
    for number, name in enumerate(sorted(names | {f"laws.{each}" for each in brushsvg.laws.__all__})):
        thing = attrgetter(name)(brushsvg)
        lines.append(f"print(brushsvg.{name})")
        if inspect.isclass(thing):
            parents = set(dir(Exception if issubclass(thing, Exception) else tuple))
            members = {each for each in [*dir(thing), *inspect.get_annotations(thing)] if each[0] != "_"}
            looks = [f"    print(it.{each})" for each in sorted(members - parents)]
            of = "[object]" if getattr(thing, "__parameters__", ()) else ""  # the class is generic
            lines += [f"def look_{number}(it: brushsvg.{name}{of}) -> None:", *(looks or ["    print(it)"])]
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def reported(tmp_path_factory, npm):
    """Return pyright's reports: name -> [(rule, line and sentence)].

    pyright finds the package next to other installed packages, so it counts as a package with its own types.
    """
    pyright = npm("pyright", PACKAGES) / "pyright" / "index.js"
    folder = tmp_path_factory.mktemp("pyright")
    shutil.copytree(PACKAGE, folder / "site" / "brushsvg", ignore=shutil.ignore_patterns("data", "__pycache__"))
    programs = folder / "programs"
    programs.mkdir()
    files = {name: requested(name, code) for name, code in shown().items()} | {"every_name": every_name()}
    files |= {f"planted {number}": PROGRAM.replace(*pair) for number, (*pair, _) in enumerate(PLANTED)}
    for name, code in (files | {"sound": PROGRAM}).items():
        (programs / f"{name}.py").write_text(code, encoding="utf-8")
    (programs / "pyrightconfig.json").write_text('{"typeCheckingMode": "strict"}')
    done = subprocess.run(
        ["node", pyright, "-p", programs, "--pythonpath", sys.executable, "--outputjson"],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(folder / "site")},
    )
    output = json.loads(done.stdout)
    assert output["summary"]["filesAnalyzed"] == len(files) + 1
    found: dict[str, list[tuple[str, str]]] = {name: [] for name in [*files, "sound"]}
    for each in output["generalDiagnostics"]:
        line = f"{each['range']['start']['line'] + 1}: {each['message']}"
        found[Path(each["file"]).stem].append((each.get("rule", ""), line))
    return found


def test_all_shown_code_is_checked():
    kinds = [name.split()[0] for name in shown()]
    assert {"README", "python"} <= {name.split()[-1] for name in shown()}
    assert [kinds.count(kind) for kind in ("figure", "example", "notebook")] == [18, 13, 3]


def test_shown_code_has_no_type_errors(reported):
    assert {name: errors for name, errors in reported.items() if errors and not name.startswith("planted")} == {}


@pytest.mark.parametrize("number", range(len(PLANTED)), ids=lambda number: PLANTED[number][1])
def test_planted_errors_are_found(reported, number):
    right, wrong, rule = PLANTED[number]
    assert PROGRAM.count(right) == 1
    assert rule in [found_rule for found_rule, _ in reported[f"planted {number}"]], (
        wrong,
        reported[f"planted {number}"],
    )
