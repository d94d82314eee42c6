"""Print a table of times of this tree, of floors, of peers and of another tree.

    table.py [--against TREE] [--rounds 3] [--only WORD]

Each row runs a command of brushsvg, or another program, as a separate process. Compiled modules are kept, as
in an installed brushsvg. The table shows processor seconds, user and system, of the process and all its
children, and the seconds on the clock. Each number is the minimum of the rounds, since other users of a
machine can only add time. With --against, both trees (built, each with its .venv and build/release) take
turns. Their ratio also holds on a busy machine. `make bench-compare REV=...` builds the tree of a revision
and runs this comparison.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import page
import truth_recovery

from brushsvg.read.text import text_svg

ROOT = Path(__file__).parents[1]
SYSTEM_PYTHON = "/usr/bin/python3"  # this Python has lxml, like Inkscape's own
PREVIEW = ROOT / "plugins" / "inkscape" / "brushsvg_preview.py"
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789&"
LINE = "The quick brown fox jumps over the lazy"
REFINED = 60  # number of refined strokes of the page
SLOWER = 1.1  # a row is called slower beyond this ratio
STROKES_OF = """
import sys, time, brushsvg
drawing = brushsvg.read_drawing(sys.argv[1])
brushsvg.strokes(drawing)
begin, on_clock = time.process_time(), time.perf_counter()
brushsvg.strokes(drawing)
print(time.process_time() - begin, time.perf_counter() - on_clock)
"""


@dataclass(frozen=True)
class Spent:
    """The seconds of the processors, and on the clock."""

    used: float
    clock: float

    def least(self, other: Spent) -> Spent:
        return Spent(min(self.used, other.used), min(self.clock, other.clock))

    def over(self, count: float, without: Spent | None = None) -> Spent:
        used, clock = (without.used, without.clock) if without else (0.0, 0.0)
        return Spent((self.used - used) / count, (self.clock - clock) / count)


@dataclass(frozen=True)
class Row:
    name: str
    unit: str
    aim: str
    measure: Callable[[Path], Spent]  # measures a tree
    reference: str = ""  # the floor or peer of the row
    measure_reference: Callable[[], Spent] | None = None


def run(words: list) -> tuple[Spent, str]:
    env = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    begin, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, env=env)
    clock, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr}")
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Spent(used, clock), done.stdout


def command(tree: Path) -> Path:
    return tree / ".venv" / "bin" / "brushsvg"


def python(tree: Path) -> Path:
    return tree / ".venv" / "bin" / "python"


def brushsvg(*words) -> Callable[[Path], Spent]:
    return lambda tree: run([command(tree), *words])[0]


def code(*words) -> Callable[[Path], Spent]:
    return lambda tree: run([python(tree), "-c", *words])[0]


def here(work: Callable[[Path], Spent]) -> Callable[[], Spent]:
    return lambda: work(ROOT)


def painted_chart(file: Path) -> int:
    """Write the chart of a random brush on A4 as a measurement file.

    The stepping simulator of tests/laws paints it.
    """
    rng = np.random.default_rng(1)
    brush, faults = truth_recovery.painter.random_brush(rng), truth_recovery.painter.Faults()
    strokes = truth_recovery.strokes_of(rng, brush, (210.0, 297.0))
    marks = truth_recovery.painter.paint(rng, brush, strokes, faults).marks
    measured = {
        "format": "brushsvg/measurements",
        "version": 1,
        "name": "painted",
        "depth_range_mm": [0, brush.deepest],
        "plan": {"passes": [{"stroke": name, "poses_mm": poses.tolist(), "speed_mm_s": 20} for name, poses in strokes]},
        "marks": [{"stroke": name, "outline_mm": [ring.tolist() for ring in rings]} for name, _, rings in marks],
    }
    file.write_text(json.dumps(measured), encoding="utf-8")
    return len(marks)


def letters(file: Path, text: str, font_name: str, size_mm: float) -> None:
    font = Path(matplotlib.get_data_path(), "fonts", "ttf", font_name)
    document, _ = text_svg(text, font.read_bytes(), size_mm=size_mm)
    file.write_text(document, encoding="utf-8")


def refined(drawing: Path, out: Path, strokes: int) -> Callable[[Path], Spent]:
    """Measure the refinement of one stroke: the time in addition to the closed form."""

    def measure(tree: Path) -> Spent:
        closed = brushsvg("convert", drawing, "-o", out)(tree)
        return brushsvg("convert", drawing, "-o", out, "--compensation", "refined")(tree).over(strokes, closed)

    return measure


def outlines(drawing: Path) -> Callable[[Path], Spent]:
    def measure(tree: Path) -> Spent:
        _, output = run([python(tree), "-c", STROKES_OF, drawing])
        return Spent(*map(float, output.split())).over(len(LETTERS))

    return measure


def advance(row: str) -> Callable[[Path], Spent]:
    """Measure the time per move of a row of advance_bench."""

    def measure(tree: Path) -> Spent:
        bench = tree / "build" / "release" / "benchmarks" / "advance_bench"
        if not bench.exists():
            sys.exit(f"{bench} is not there: make bench builds it")
        _, output = run([bench])
        ns = float(re.search(rf"{re.escape(row)}.*? ([\d.]+) ns", output)[1])
        return Spent(ns / 1e9, ns / 1e9)

    return measure


def preview(drawing: Path) -> Callable[[Path], Spent]:
    return lambda tree: run([SYSTEM_PYTHON, PREVIEW, f"--executable={command(tree)}", drawing])[0]


def rows(folder: Path, only: str = "") -> list[Row]:
    """Return the rows whose names have a word.

    A chart is painted only if a row fits it.
    """
    word, large, part = ROOT / "examples" / "vincent.svg", folder / "page.svg", folder / "part.svg"
    lines = page.page().splitlines()
    large.write_text("\n".join(lines), encoding="utf-8")
    part.write_text("\n".join([*lines[: 1 + REFINED], "</g></svg>"]), encoding="utf-8")
    program, page_svg, word_program = folder / "p.ngc", folder / "p.svg", folder / "word.ngc"
    alphabet, text, chart = folder / "abc.svg", folder / "text.svg", folder / "chart.json"
    letters(alphabet, LETTERS, "DejaVuSans.ttf", 50.0)
    letters(text, "\n".join([LINE] * 8), "DejaVuSerif-Bold.ttf", 10.0)
    fit = "fit of a chart's marks"
    marks = painted_chart(chart) if only in fit else 0
    subprocess.run([command(ROOT), "convert", word, "-o", word_program, "--quiet"], check=True)
    start = here(code("import numpy"))
    xml = here(code(f"from xml.etree import ElementTree; ElementTree.parse({str(large)!r})"))
    arithmetic = here(advance("floor"))
    read = f"import brushsvg; brushsvg.read_drawing({str(word)!r})"
    peer = here(code(f"from svgpathtools import svg2paths; svg2paths({str(large)!r})"))
    of_page, of_word = f"page of {page.STROKES} strokes, ", "word of 13 strokes, "
    numpy_starts = "floor: Python and numpy start"
    refine = ("--compensation", "refined")
    peer_reads = "peer: svgpathtools reads"

    def to_program(drawing: Path):
        return brushsvg("convert", drawing, "-o", program)

    found = [
        Row(f"{fit}, {marks} of them", "s", "5", brushsvg("calibrate", chart, "-o", folder / "b.json")),
        Row(of_page + "convert", "s", "1.0", to_program(large), "floor: Python reads the XML", xml),
        Row(of_page + "report", "s", "1.0", brushsvg("preview", large), numpy_starts, start),
        Row(of_page + "predict .svg", "s", "2", brushsvg("preview", large, "-o", page_svg), peer_reads, peer),
        Row(of_page + "predict .png", "s", "1", brushsvg("preview", large, "-o", folder / "p.png")),
        Row(f"refined, each of {REFINED} strokes", "ms", "10", refined(part, program, REFINED)),
        Row(of_word + "convert (first word)", "s", "0.35", to_program(word), numpy_starts, start),
        Row(of_word + "convert, refined", "s", "0.7", brushsvg("convert", word, "-o", program, *refine)),
        Row(of_word + "report", "s", "0.5", brushsvg("preview", word)),
        Row(of_word + "check", "s", "0.6", brushsvg("check", word_program, word)),
        Row("first `read_drawing` in Python", "s", "0.3", code(read), numpy_starts, start),
        Row("outlines of letters, a glyph", "ms", "4", outlines(alphabet)),
        Row(f"text of {8 * len(LINE)} letters, convert", "s", "5", to_program(text)),
        Row("advance, a move", "ns", "30", advance("closed form"), "floor: exp + sqrt + division", arithmetic),
    ]  # fmt: skip
    if shutil.which(SYSTEM_PYTHON) and not subprocess.run([SYSTEM_PYTHON, "-c", "import lxml"]).returncode:
        found.append(Row("Inkscape's preview of the word, its process", "s", "0.5", preview(word)))
    return [row for row in found if only in row.name]


def least(works: list[Callable[[], Spent]], rounds: int) -> list[Spent]:
    """Return the least time of each work; all works run in turn."""
    best = [work() for work in works]
    for _ in range(rounds - 1):
        best = [one.least(work()) for one, work in zip(best, works, strict=True)]
    return best


def shown(seconds: float, unit: str) -> str:
    return f"{seconds * {'s': 1, 'ms': 1e3, 'ns': 1e9}[unit]:.{2 if unit == 's' else 1}f}"


def machine() -> str:
    model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text()) if sys.platform == "linux" else None
    name = model[1].strip() if model else platform.processor()
    return f"{name}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--against", type=Path, help="another tree, built")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="", help="rows with this in their name")
    options = parser.parse_args()
    print(f"{machine()}; the least of {options.rounds} rounds\n")
    other = ["that tree, used", "ratio"] if options.against else []
    titles = ["", "unit", "used", "clock", *other, "aim", "beside"]
    print("|" + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|")
    slower = []
    with tempfile.TemporaryDirectory() as folder:
        for row in rows(Path(folder), options.only):
            works = [lambda row=row: row.measure(ROOT)]
            if options.against:
                works.append(lambda row=row: row.measure(options.against.resolve()))
            ours, *theirs = least(works, options.rounds)
            cells = [row.name, row.unit, shown(ours.used, row.unit), shown(ours.clock, row.unit)]
            for that in theirs:
                ratio = ours.used / that.used
                cells += [shown(that.used, row.unit), f"{ratio:.2f}"]
                if ratio > SLOWER:
                    slower.append(f"{row.name} ({ratio:.2f})")
            reference = ""
            if row.measure_reference:
                spent = least([row.measure_reference], options.rounds)[0]
                reference = f"{row.reference} {shown(spent.used, row.unit)}"
            print("| " + " | ".join([*cells, row.aim, reference]) + " |", flush=True)
    if options.against:
        print(f"\nslower than that tree: {', '.join(slower) or 'nothing'}")


if __name__ == "__main__":
    main()
