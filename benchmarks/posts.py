"""Time programs of a page of 1,000 strokes in every language.

    python benchmarks/posts.py

The program also measures the memory that 10 million poses need.
"""

import json
import resource
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np

from brushsvg import _core
from brushsvg.machine import writer
from brushsvg.machine.cells.cell import Workspace
from brushsvg.machine.cells.cell_file import cell_names, find_cell
from brushsvg.machine.posts import POSTS
from brushsvg.model.library import find_brush

STROKES = 1000
POSES = 150


def plan_of(strokes: int, poses: int, sheet_mm=(400.0, 400.0), down_mm: float | None = None):
    """Return waves next to each other, pressed and lifted at their ends.

    The waves of a pen are all at its lower height.
    """
    t = np.linspace(0, 1, poses)
    passes = []
    for number in range(strokes):
        x, y = 20 + 36 * (number % 10), 20 + 360 * (number // 10) / (strokes / 10)
        depth = -3 * np.minimum(1, 10 * np.minimum(t, 1 - t))
        wave = np.column_stack([x + 30 * t, y + np.sin(20 * t), depth])
        if down_mm is not None:
            wave[:, 2] = down_mm
        passes.append(_core.Pass(f"s{number}", wave, 20.0))
    return _core.Plan("round-6", "", sheet_mm, passes)


def tried_with(name: str) -> tuple:
    """Return the brush of a cell, and the additional options of its plan."""
    pen = find_cell(name).pen
    return find_brush("rigid" if pen else "round-6"), {"down_mm": pen.down_mm} if pen else {}


def roomy(name: str):
    """Return the cell with space for the page at its example paper, without its arm."""
    cell = find_cell(name)
    return replace(cell, workspace=Workspace(cell.workspace.margin_mm, cell.workspace.tilt_limit_deg), arm=None)


def write(name: str, plan, brush) -> int:
    """Return the number of bytes of the program, without keeping it."""
    suffix = POSTS[find_cell(name).language].extensions[0]
    return sum(len(piece) for piece in writer.encode(suffix, plan, brush, "page", (), roomy(name)))


def peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def child(name: str, strokes: int) -> None:
    """Return the memory in addition to the plan's arrays, in a separate process."""
    brush, own = tried_with(name)
    write(name, plan_of(10, POSES, **own), brush)  # modules that every program needs
    plan = plan_of(10 * strokes, 990, **own)  # a TP program has no more points
    before = peak_mb()
    begin = time.perf_counter()
    size = write(name, plan, brush)
    print(json.dumps([peak_mb() - before, time.perf_counter() - begin, size / 1e6]))


def main() -> None:
    plan = plan_of(STROKES, POSES)
    names = [name for name in cell_names() if find_cell(name).language in POSTS]
    print(f"a page of {STROKES} strokes, {STROKES * POSES} poses")
    begin = time.perf_counter()
    points = np.vstack([a_pass.poses_mm for a_pass in plan.passes])
    text = "\n".join(["X%.4f Y%.4f Z%.4f"] * len(points)) % tuple(points.ravel().tolist())
    print(
        f"  {'floor: three numbers a pose as text':<48} {time.perf_counter() - begin:7.3f} s {len(text) / 1e6:7.1f} MB"
    )
    for name in names:
        brush, own = tried_with(name)
        written_plan = plan_of(STROKES, POSES, **own) if own else plan
        begin = time.perf_counter()
        size = write(name, written_plan, brush)
        print(f"  {name:<48} {time.perf_counter() - begin:7.3f} s {size / 1e6:7.1f} MB")
    print("10 million poses: memory beyond the plan's arrays (aim: 50 MB)")
    for name in names:
        ran = subprocess.run([sys.executable, __file__, name, "1010"], capture_output=True, text=True, check=True)
        memory, seconds, size = json.loads(ran.stdout)
        print(f"  {name:<48} {memory:7.1f} MB {seconds:7.1f} s {size:7.0f} MB")


if __name__ == "__main__":
    if len(sys.argv) == 3:
        child(sys.argv[1], int(sys.argv[2]))
    else:
        main()
