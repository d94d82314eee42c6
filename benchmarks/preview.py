"""Seconds until Inkscape's live preview has its marks: the extension's process from start to end, by stage.

Cold: the first run after the files of Python and brushsvg have left the page cache, where this machine lets us drop
them (root); warm: the median of seven. Aims: a word of ten strokes in 0.5 s warm and 1.0 s cold, a page of 200 in 2 s.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import page

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / "plugins" / "inkscape" / "brushsvg_preview.py"
COMMAND = Path(sys.executable).with_name("brushsvg")
SYSTEM_PYTHON = "/usr/bin/python3"  # has lxml, as Inkscape's own has
RUNS = 7
STAGES = """
import time
begin = time.perf_counter()
from brushsvg import cli, usage, commands, convert, machine, render
from brushsvg.cell_file import find_cell
from brushsvg.importers import read_drawing, svg
told = []
def stage(name):
    told.append((name, time.perf_counter()))
stage("imports")
cell = find_cell()
work = convert.prepare({drawing!r})
stage("read and compensated")
marks = convert.predict(work, whole=False)
stage("simulated and outlined")
machine.problems(work.plan, work.brush, marks, cell, 0.05)
stage("limits")
convert.picture(".svg", work, marks)
stage("written")
for name, end in told:
    print(name, f"{{end - begin:.3f}}")
    begin = end
"""


def drawing(strokes: int) -> str:
    """Wavy strokes of a page, 30 to 60 mm each."""
    lines = page.page().splitlines()
    return "\n".join([*lines[:1], *lines[1:strokes], "</g></svg>"])


def seconds(file: Path) -> float:
    begin = time.perf_counter()
    words = [SYSTEM_PYTHON, SCRIPT, f"--executable={COMMAND}", file]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def dropped() -> bool:
    try:
        os.sync()
        Path("/proc/sys/vm/drop_caches").write_text("3")
    except OSError:
        return False
    return True


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for strokes in (10, 200):
            file = Path(folder, f"{strokes}.svg")
            file.write_text(drawing(strokes))
            cold = f"{seconds(file):.2f} s" if dropped() else "not known here"
            seconds(file)
            warm = statistics.median(seconds(file) for _ in range(RUNS))
            print(f"{strokes} strokes: warm {warm:.2f} s, cold {cold}")
            code = STAGES.format(drawing=str(file))
            done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
            for line in done.stdout.splitlines():
                name, _, took = line.rpartition(" ")
                print(f"  {name:24} {float(took):.2f} s")


if __name__ == "__main__":
    main()
