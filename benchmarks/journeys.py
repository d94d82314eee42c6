"""Show which journeys work: a line for each group of tests, from cases to whole stories.

    journeys.py [--only WORDS] [--processes 2]

A case is a small file or command that once failed. A line shows how many tests ran, how many failed, and which
refusals were accepted for their physical reason. The exit status is 1 if a test failed. Three longer measurements have
separate commands: the calibration of brushes from sheet to sheet (sheets.py), the coverage of intervals
(intervals.py), and letters painted with a photographed brush (letters.py).
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ALL = ("-m", "thorough or not thorough")
# the title of a line, and the tests that pytest runs for it
GROUPS = {
    "brushes that begin with no width paint filled letters": ["tests/python/test_uncovered_areas.py"],
    "thin lines and slivers of a liner": ["tests/python/test_reach.py"],
    "servo plotters: offsets, heights, steep strokes": ["tests/python/test_servo.py"],
    "arms: the highest elbow, joints above the table": ["tests/python/test_arm_reach.py"],
    "calibrate and compare write what a machine can undo": [
        "tests/python/test_corrected_cell.py",
        "tests/python/test_calibrate.py",
        "-k",
        "undo or every_cell or left_out or parts_of_a_machine",
    ],
    "batch: colliding names, stale rows, foreign manifests": ["tests/python/test_batch.py"],
    "files: umask, nothing replaced without --force": [
        "tests/python/test_files.py",
        "tests/python/test_replacing.py",
    ],
    "check: middles of circles, servo ramps, stops; first run": [
        "tests/python/test_accidental_stops.py",
        "tests/python/test_first_run.py",
    ],
    "Python: intervals, sign of e, one type of fits, kinds, depths": [
        "tests/laws/test_calibration.py",
        "tests/laws/test_forward.py",
        "tests/python/test_brushes.py",
    ],
    "programs of others: G-code that crashed": ["tests/python/test_foreign_gcode.py"],
    "every brush paints every drawing": ["tests/journeys/test_brush_and_drawing.py"],
    "every pair of brush, drawing, cell and command": ["tests/journeys/test_every_combination.py"],
    "each shipped cell: calibrate, convert, check, compare, convert": ["tests/journeys/test_shipped_cells.py"],
    "sheet after sheet: brush, corrections and cell learned together": ["tests/journeys/test_sheet_after_sheet.py"],
    "five stories": ["tests/journeys/test_stories.py"],
    "drawings of tablets, design tools and other programs": ["tests/python/test_drawings_in_the_wild.py"],
    "forty clip paths and ten masks against Chromium": ["tests/integration/test_clips_shown.py"],
    "single-line fonts": ["tests/python/test_text_fonts_of_lines.py"],
    "sixty plotter programs in fifteen styles": ["tests/python/test_plotter_programs.py"],
    "a program for each colour": ["tests/python/test_per_colour.py"],
    "long programs of UR, KUKA and EBB within their limits": ["tests/python/test_long_programs.py"],
    "paint stations: stir, wash, rinse, full and short reload": ["tests/python/test_paint.py"],
    "vpype writes the programs of convert": ["tests/integration/test_vpype.py", "-k", "byte"],
    "no option is shown in Inkscape": ["tests/integration/test_inkscape_messages.py"],
    "no dialog in Inkscape is wider than 1,000 pixels": ["tests/integration/test_inkscape_dialogs.py"],
    "the preview says when saving will be refused": ["tests/integration/test_inkscape_preview.py"],
}


def run(words: list[str], processes: int) -> tuple[int, int, Counter]:
    """Return how many tests ran and failed, and the codes of accepted refusals."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder, "junit.xml")
        pytest = [sys.executable, "-m", "pytest", "-q", "-n", str(processes), f"--junit-xml={report}"]
        subprocess.run([*pytest, *ALL, *words], cwd=ROOT, stdout=subprocess.DEVNULL)
        cases = list(ElementTree.parse(report).iter("testcase")) if report.exists() else []
    failed = sum(case.find("failure") is not None or case.find("error") is not None for case in cases)
    properties = (each for case in cases for each in case.iter("property"))
    refused = Counter(each.get("value") for each in properties if each.get("name") == "refused")
    return len(cases), failed, refused


def main() -> int:
    formatter = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=formatter)
    parser.add_argument("--only", default="", metavar="WORDS", help="lines that hold these words")
    parser.add_argument("--processes", type=int, default=2)
    args = parser.parse_args()
    print(f"{'journey':64s} {'tests':>6s} {'failed':>7s} {'s':>5s}  refused")
    bad = 0
    for name, words in GROUPS.items():
        if args.only not in name:
            continue
        begin = time.perf_counter()
        count, failed, refused = run(words, args.processes)
        bad += failed + (count == 0)
        reasons = ", ".join(f"{n} {code}" for code, n in sorted(refused.items()))
        print(f"{name:64s} {count:6d} {failed:7d} {time.perf_counter() - begin:5.0f}  {reasons}", flush=True)
    return int(bad > 0)


if __name__ == "__main__":
    raise SystemExit(main())
