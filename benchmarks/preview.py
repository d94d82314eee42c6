"""Measure the time until Inkscape's live preview shows its marks, by stage.

The program runs the extension's process as Inkscape runs it, from start to end. The system's Python starts
brushsvg, writes the document with the marks and ends. Cold is the first run after Python's and brushsvg's
files have left the page cache, if this machine allows this (root). Warm is the median of seven runs. The aims
are 0.5 s warm and 1.0 s cold for a word of ten strokes, and 2 s for a page of 200 strokes. If Inkscape is
installed, its own time is measured as well: Inkscape writes the document for us and reads it back. Its time
is the difference in processor time between six previews in one document and one preview.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import page

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "plugins" / "inkscape"
SCRIPT = SOURCE / "brushsvg_preview.py"
COMMAND = Path(sys.executable).with_name("brushsvg")
SYSTEM_PYTHON = "/usr/bin/python3"  # this Python has lxml, like Inkscape's own
RUNS = 7
IN_INKSCAPE = 5
PREFERENCES = (
    '<inkscape version="1"><group id="extensions" python-interpreter="/usr/bin/python3" '
    f'org.brushsvg.preview.executable="{COMMAND}"/></inkscape>'
)
STAGES = """
import time
begin = time.perf_counter()
from brushsvg.cli import commands
from brushsvg.machine import paint_reload, preflight
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.jobs import outputs, prediction, preparation
reported = []
def stage(name):
    reported.append((name, time.perf_counter()))
stage("imports")
cell = find_cell()
work = preparation.prepare({drawing!r})
stage("read and compensated")
marks = prediction.predict(work, whole=False)
stage("simulated and outlined")
loads = paint_reload.in_loads(work.plan, work.brush, cell)
preflight.look(loads, work.brush, marks, cell, 0.05)
stage("limits")
outputs.picture(".svg", work, marks)
stage("written")
for name, end in reported:
    print(name, f"{{end - begin:.3f}}")
    begin = end
"""
EXTENSION = """
import sys, time
begin = time.perf_counter()
sys.path.insert(0, {folder!r})
from brushsvg_preview import LAYER_ID, _layer, remove_layer
from lxml import etree
from xml.etree import ElementTree
print("extension: imports", f"{{time.perf_counter() - begin:.3f}}")
begin = time.perf_counter()
document = etree.parse({drawing!r}, etree.XMLParser(huge_tree=True))
marks = ElementTree.parse({marks!r}).getroot()
document.getroot().append(_layer(etree, marks, document.getroot(), []))
document.write({out!r})
print("extension: marks put in", f"{{time.perf_counter() - begin:.3f}}")
"""


def drawing(strokes: int) -> str:
    """Return a page of wavy strokes, 30 to 60 mm each."""
    lines = page.page().splitlines()
    return "\n".join([*lines[:1], *lines[1:strokes], "</g></svg>"])


def timed(words, **settings) -> tuple[float, float]:
    """Return seconds on the clock, and processor seconds of our processes.

    Processes that these have started are included.
    """
    begin, used = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **settings)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.perf_counter() - begin, after.ru_utime + after.ru_stime - used.ru_utime - used.ru_stime


def preview(file: Path) -> tuple[float, float]:
    return timed([SYSTEM_PYTHON, SCRIPT, f"--executable={COMMAND}", file])


def dropped() -> bool:
    try:
        os.sync()
        Path("/proc/sys/vm/drop_caches").write_text("3")
    except OSError:
        return False
    return True


def median(runs) -> tuple[float, float]:
    return tuple(statistics.median(each) for each in zip(*runs, strict=True))


def in_inkscape(file: Path) -> float:
    """Return Inkscape's processor seconds for a preview.

    The time of its child processes is not included.
    """
    profile = file.with_suffix(".profile")
    shutil.copytree(SOURCE, profile / "extensions" / "brushsvg")
    (profile / "preferences.xml").write_text(PREFERENCES)
    env = {**os.environ, "INKSCAPE_PROFILE_DIR": str(profile)}

    def previews(count: int) -> float:
        actions = ";".join(["org.brushsvg.preview.noprefs"] * count)
        words = ["xvfb-run", "-a", "inkscape", "--batch-process", f"--actions={actions}", file]
        return timed(words, env=env)[1]

    previews(1)
    once, often = (statistics.median(previews(count) for _ in range(3)) for count in (1, 1 + IN_INKSCAPE))
    return (often - once) / IN_INKSCAPE


def stages(file: Path) -> list[str]:
    marks, out = file.with_suffix(".marks.svg"), file.with_suffix(".out.svg")
    subprocess.run([COMMAND, "preview", file, "-o", marks], check=True, stderr=subprocess.DEVNULL)
    parts = (
        (sys.executable, STAGES.format(drawing=str(file))),
        (
            SYSTEM_PYTHON,
            EXTENSION.format(folder=str(SOURCE), drawing=str(file), marks=str(marks), out=str(out)),
        ),
    )
    report = []
    for python, code in parts:
        begin = time.perf_counter()
        done = subprocess.run([python, "-c", code], check=True, capture_output=True, text=True)
        lines = done.stdout.splitlines()
        start = time.perf_counter() - begin - sum(float(line.rpartition(" ")[2]) for line in lines)
        report += [
            f"{'brushsvg' if python == sys.executable else 'extension'}: Python itself {start:.3f}",
            *lines,
        ]
    return report


def main() -> None:
    print(f"load of this machine: {os.getloadavg()[0]:.1f}; seconds on the clock (of the processors)")
    with tempfile.TemporaryDirectory() as folder:
        for strokes in (10, 200):
            file = Path(folder, f"{strokes}.svg")
            file.write_text(drawing(strokes))
            cold = "{:.2f} ({:.2f}) s".format(*preview(file)) if dropped() else "not known here"
            preview(file)
            warm = "{:.2f} ({:.2f}) s".format(*median([preview(file) for _ in range(RUNS)]))
            print(f"{strokes} strokes: warm {warm}, cold {cold}")
            if shutil.which("inkscape") and shutil.which("xvfb-run"):
                print(f"  {'Inkscape itself':26} {in_inkscape(file):.2f} s")
            for line in stages(file):
                name, _, took = line.rpartition(" ")
                print(f"  {name:26} {float(took):.2f} s")


if __name__ == "__main__":
    main()
