"""The types for editors and type checkers match the package and reveal a mistake."""

import ast
import importlib.util
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import brushsvg
from brushsvg import _core

ROOT = Path(__file__).parents[2]
STUBS = Path(brushsvg.__file__).parent / "_core"
CLASSES = [name for name, _ in inspect.getmembers(_core, inspect.isclass)]
# A stub cannot express these: classes have pybind11's own metaclass, classes without a constructor accept any
# arguments in order to refuse them, and only the stub has __all__.
BEYOND_STUBS = [rf"brushsvg\._core\.({'|'.join(CLASSES)})(\.__init__)?", r"brushsvg\._core(\.lag)?\.__all__"]
PROGRAM = """from pathlib import Path

import brushsvg

drawing = brushsvg.read_drawing("a.svg")
strokes, notices = brushsvg.strokes(drawing)
brush = brushsvg.find_brush("round-6")
done = brushsvg.compensate(strokes, brush, drawing.sheet_mm)
first = done.plan.passes[0]
made = brushsvg.calibrate(
    ["a.jpg"], chart=Path("c.json"), brush=Path("b.json"), machine=["axes", "lean"], cell=Path("c.toml")
)
made = brushsvg.calibrate(Path("b.jpg"), plan=Path("p.json"), prior=Path("b.json"))
print(first.poses_mm[:, 2].min(), brush.lag.coefficients[0] + 1.0, done.warnings[0].sentence)
"""


def mypy(*paths: Path, cache: Path):
    words = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--cache-dir", cache, *paths]
    return subprocess.run(words, capture_output=True, text=True)


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("make_stubs", ROOT / "tools" / "make_stubs.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_the_stubs_equal_the_output_of_the_tool(tool):
    made = tool.stub_files()
    assert set(made) == {path.name for path in STUBS.iterdir()}
    for name, text in made.items():
        read = (STUBS / name).read_text()
        assert ast.dump(ast.parse(read)) == ast.dump(ast.parse(text)), f"{name}: run tools/make_stubs.py"


@pytest.mark.thorough
@pytest.mark.slow
def test_stubtest_finds_no_errors(tmp_path):
    (tmp_path / "allowed").write_text("\n".join(BEYOND_STUBS))
    words = ["-m", "mypy.stubtest", "brushsvg._core", "--allowlist", tmp_path / "allowed", "--concise"]
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    stub = (STUBS / "__init__.pyi").read_text()
    assert set(re.findall(r"^class (\w+)", stub, re.M)) == set(CLASSES)


PLANTED = (
    ("drawing.sheet_mm)", "drawing.sheet)", "attr-defined"),
    ("first.poses_mm", "first.poses", "attr-defined"),
    ("coefficients[0] + 1.0", 'coefficients[0] + "1"', "operator"),
    ('find_brush("round-6")', "find_brush(6)", "arg-type"),
    ("(strokes, brush, drawing.sheet_mm)", "(brush, strokes, drawing.sheet_mm)", "arg-type"),
    ("brush, drawing.sheet_mm)", "brush)", "call-arg"),
    ("done.plan.passes[0]", "done.passes[0]", "attr-defined"),
    ("warnings[0].sentence", "warnings[0].words", "attr-defined"),
    ("strokes, notices = brushsvg.strokes(drawing)", "strokes = [1]", "arg-type"),
)


@pytest.mark.slow
def test_examples_have_no_type_errors_and_planted_ones_are_found(tmp_path):
    examples = sorted((ROOT / "examples").glob("*.py"))
    sound = tmp_path / "sound.py"
    sound.write_text(PROGRAM)
    done = mypy(*examples, sound, cache=tmp_path)
    assert (done.returncode, done.stdout) == (0, "")
    programs = [tmp_path / f"planted{number}.py" for number in range(len(PLANTED))]
    for path, (right, wrong, _) in zip(programs, PLANTED, strict=True):
        path.write_text(PROGRAM.replace(right, wrong))
    reported = mypy(*programs, cache=tmp_path).stdout
    for path, (_, wrong, expected) in zip(programs, PLANTED, strict=True):
        lines = [line for line in reported.splitlines() if f"{path.name}:" in line]
        assert any(line.endswith(f"[{expected}]") for line in lines), (wrong, lines)


def test_the_package_is_marked_as_typed():
    assert (STUBS.parent / "py.typed").is_file()
    source = Path(brushsvg.__file__).read_text()
    reported = source.split("if TYPE_CHECKING:")[1].split("__version__: str")[0]
    names = {node.id for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Name)}
    assert "TYPE_CHECKING" in names
    for name in brushsvg.__all__:
        assert name == "__version__" or re.search(rf"\b{name}\b", reported), f"{name} has no type"
