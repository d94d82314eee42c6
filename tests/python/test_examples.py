"""The numbered examples run from a checkout, write their files, and stay short.

ctest runs the C++ examples.
"""

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

import brushsvg

EXAMPLES = Path(__file__).parents[2] / "examples"
PYTHON = sorted(EXAMPLES.glob("[0-9][0-9]_*.py"))
CPP = sorted(EXAMPLES.glob("[0-9][0-9]_*.cpp"))
MAX_LINES = 40


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Return a function that runs an example in an empty folder.

    The function returns the example's printed text.
    """
    monkeypatch.chdir(tmp_path)

    def run(name: str) -> str:
        done = subprocess.run([sys.executable, EXAMPLES / name], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def picture_has_paint(path: str) -> bool:
    """Return whether a picture has dark paint on light paper."""
    grey = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    return grey.min() < 100 and 0.005 < (grey < 128).mean() < 0.5


def numbers(pattern: str, text: str) -> list[float]:
    return [float(each) for each in re.findall(pattern, text)]


def code_lines(path: Path) -> int:
    """Count lines of a file without the docstring or comment that it starts with."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        return len(text.splitlines()) - (ast.parse(text).body[0].end_lineno or 0)
    lines = text.splitlines()
    return len(lines) - next(number for number, line in enumerate(lines) if not line.startswith("//"))


def test_there_are_twelve_topics():
    assert [path.name[:2] for path in PYTHON] == [f"{number:02}" for number in range(1, 13)]
    topics = {path.stem for path in PYTHON}
    assert {path.stem for path in CPP} < topics


@pytest.mark.parametrize("path", [*PYTHON, *CPP], ids=lambda path: path.name)
def test_an_example_is_short_and_has_a_description(path):
    assert code_lines(path) <= MAX_LINES
    assert re.match(r'"""|// ', path.read_text(encoding="utf-8"))


def test_the_list_names_every_example():
    listed = set(re.findall(r"\d\d_\w+\.(?:py|cpp)", (EXAMPLES / "README.md").read_text(encoding="utf-8")))
    assert listed == {path.name for path in (*PYTHON, *CPP)}
    built = re.findall(r"add_example\((\d\d_\w+) ", (EXAMPLES / "CMakeLists.txt").read_text(encoding="utf-8"))
    assert built == [path.stem for path in CPP]


@pytest.mark.slow
def test_first_word(run):
    compensated, plain = numbers(r"overlap .*: (\d\.\d+)", run("01_first_word.py"))
    assert compensated > 0.97 and plain < 0.5
    program = Path("first_word.ngc").read_text()
    assert "(title: Robot)" in program and program.rstrip().endswith("M2")
    assert picture_has_paint("first_word.png")


@pytest.mark.slow
def test_corners(run):
    printed = run("02_corners.py").splitlines()
    turn, lifted = numbers(r"overlap (\d\.\d+)", "\n".join(printed))
    assert 0.95 < turn < lifted
    assert [line.count("zigzag") for line in printed] == [1, 4]
    assert picture_has_paint("corners_turn.png") and picture_has_paint("corners_auto.png")


@pytest.mark.slow
def test_wide_shapes(run):
    clamp, passes = numbers(r"strokes, overlap (\d\.\d+)", run("03_wide_shapes.py"))
    assert clamp < 0.7 and passes > 0.95
    paint = [(cv2.imread(f"wide_{wide}.png", 0) < 128).mean() for wide in ("clamp", "passes")]
    assert paint[1] > 1.5 * paint[0] > 0


@pytest.mark.slow
def test_text(run):
    pytest.importorskip("uharfbuzz")
    pytest.importorskip("matplotlib")
    printed = run("04_text.py")
    assert numbers(r"overlap .*: (\d\.\d+)", printed)[0] > 0.95
    letters = re.findall(r"glyph-(\d)-(\w)", printed)
    assert letters == sorted(letters) and {letter for _, letter in letters} == set("Helo")
    assert brushsvg.read_drawing("text.svg").elements
    assert picture_has_paint("text.png")


@pytest.mark.slow
def test_brush_from_table(run):
    pytest.importorskip("matplotlib")
    assert numbers(r"overlap .*: (\d\.\d+)", run("05_brush_from_table.py"))[0] > 0.95
    brush = brushsvg.find_brush("mine.json")
    assert brush.lag(4.0) == pytest.approx(8.9, abs=0.3) and 2 * brush.half_width(4.0) == pytest.approx(3.3, abs=0.2)
    assert "(brush: mine" in Path("mine.ngc").read_text()
    assert cv2.imread("mine.png") is not None


@pytest.mark.slow
def test_brush_from_photo(run):
    printed = run("06_brush_from_photo.py")
    true, found = numbers(r"true (\d+\.\d+)", printed), numbers(r"found (\d+\.\d+)", printed)
    assert len(true) == 3
    assert found == pytest.approx(true, abs=0.35)  # the chart of few strokes promises about 0.2 mm
    assert brushsvg.find_brush("mine.json").lag(4.0) == pytest.approx(found[1], abs=0.01)
    assert cv2.imread("read.png") is not None and Path("page.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_arm(run):
    pytest.importorskip("ssik")
    printed = run("07_arm.py")
    assert "refused: " in printed and "mm of the reach of cell my-ur5e" in printed
    assert brushsvg.read_cell("my_ur5e.toml").paper.origin_mm == (-120.0, -600.0, 20.0)
    assert Path("arm.script").read_text().count("movel(") + Path("arm.script").read_text().count("movep(") > 0
    assert not brushsvg.check("arm.script", EXAMPLES / "vincent.svg", cell="my_ur5e.toml").problems


@pytest.mark.slow
def test_check(run):
    printed = run("08_check.py")
    assert "word.ngc: 0 problems" in printed
    assert "a rapid move at 0.10 mm" in printed
    assert Path("word.ngc").read_text() != Path("edited.ngc").read_text()


@pytest.mark.slow
def test_compare(run):
    printed = run("09_compare.py")
    first, second = numbers(r"sheet (\d\.\d+)", printed)
    assert 0.3 < first < 0.75 < second
    assert printed.count("from the predicted place") == 9
    assert json.loads(Path("corrections.json").read_text())["format"] == "brushsvg/comparison"
    assert cv2.imread("seen.png") is not None


@pytest.mark.slow
def test_batch(run):
    printed = run("10_batch.py")
    assert "5 drawings, 1 refused, 0 done by an earlier run" in printed
    assert min(numbers(r"overlap (\d\.\d+)", printed)) > 0.95
    assert {path.stem for path in Path("painted/programs").iterdir()} == {
        "robot",
        "vincent",
        "wave-2",
        "wave-4",
    }
    assert len(Path("painted/table.csv").read_text().splitlines()) == 6
    assert cv2.imread("painted/contact-1.png") is not None
    assert "4 done by an earlier run" in run("10_batch.py")


@pytest.mark.slow
def test_custom_post(run):
    lines = run("11_custom_post.py").splitlines()
    assert lines[0] == "NAME brushsvg" and "SPEED 100.000" in lines
    program = Path("word.robodk").read_text().splitlines()
    assert {line.split()[0] for line in program if line[0] != "#"} == {
        "NAME",
        "PAPER",
        "SPEED",
        "LINE",
        "CIRCLE",
    }
    heights = [float(line.split()[3]) for line in program if line.startswith("LINE")]
    assert max(heights) > 5 and min(heights) < -3


@pytest.mark.slow
def test_embedding(run):
    line, wide, stopped = re.findall(r"^\w[\w ]*: (.*)", run("12_embedding.py"), re.MULTILINE)
    assert re.match(r"a program of \d{3,} characters, \d+ s", line)
    assert line and wide.startswith("refused (width-out-of-reach): wave: width 40")
    assert stopped == "cancelled"
    assert not list(Path().iterdir())  # no files are written
