"""Time each stage of `convert` for a page of 1,000 strokes, in seconds.

The peer is the time that svgpathtools needs to read the same file. The floor is the time to parse the XML.
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

from brushsvg import _core
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.preflight import check_job
from brushsvg.machine.writer import encode_checked
from brushsvg.model.library import find_brush
from brushsvg.read import read_drawing
from brushsvg.strokes.extraction import strokes as strokes_of

STROKES = 1000


def page() -> str:
    """Return an A1 page of wavy strokes, 30 to 60 mm long and 1 to 5 mm wide."""
    random = np.random.default_rng(1)
    paths = []
    for i in range(STROKES):
        x, y = 45 + (i % 40) * 18.5, 45 + (i // 40) * 20.0
        a = random.uniform(-0.9, 0.9, 6)
        points, heading = [(x, y)], random.uniform(0, 2 * math.pi)
        for turn in a:
            heading += turn * 0.7
            points.append((points[-1][0] + 7 * math.cos(heading), points[-1][1] + 7 * math.sin(heading)))
        d = f"M{x:.3f} {y:.3f}" + "".join(
            " C" + " ".join(f"{px:.3f},{py:.3f}" for px, py in points[k : k + 3]) for k in (1, 4)
        )
        paths.append(f'<path id="s{i}" d="{d}" stroke-width="{random.uniform(1, 5):.2f}"/>')
    body = "\n".join(paths)
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" width="841mm" height="594mm" viewBox="0 0 841 594">'
        f'<g fill="none" stroke="#000">\n{body}\n</g></svg>'
    )


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        drawing, program = Path(folder, "page.svg"), Path(folder, "page.ngc")
        drawing.write_text(page())
        stages: list[tuple[str, float]] = []

        def stage(name, work):
            begin = time.perf_counter()
            result = work()
            stages.append((name, time.perf_counter() - begin))
            return result

        brush = find_brush("round-6")
        design = stage("read the drawing", lambda: read_drawing(drawing))
        strokes, _ = stage("strokes", lambda: strokes_of(design))
        done = stage(
            "compensate (simulated until within 0.05 mm)",
            lambda: _core.compensate(strokes, brush, design.sheet_mm, start="auto", end="auto"),
        )
        marks = stage("simulate", lambda: _core.simulate(done.plan, brush))
        loads = split_into_loads(done.plan, brush, find_cell())
        walk = stage("limits", lambda: check_job(loads, brush, marks, find_cell(), 0.05))
        stage("G-code", lambda: "".join(encode_checked(".ngc", done.plan, walk, brush, "page")))
        begin = time.perf_counter()
        ran = subprocess.run(
            [Path(sys.executable).with_name("brushsvg"), "convert", drawing, "-o", program],
            capture_output=True,
            text=True,
        )
        whole = time.perf_counter() - begin
        assert ran.returncode == 0, ran.stderr
        begin = time.perf_counter()
        ElementTree.parse(drawing)
        floor = time.perf_counter() - begin
        from svgpathtools import svg2paths

        begin = time.perf_counter()
        svg2paths(str(drawing))
        peer = time.perf_counter() - begin

        poses = sum(len(p.poses_mm) for p in done.plan.passes)
        print(f"a page of {STROKES} strokes, {poses} poses, {program.stat().st_size / 1e6:.1f} MB of G-code")
        for name, seconds in stages:
            print(f"  {name:<48} {seconds:7.3f} s")
        print(f"  {'`brushsvg convert`, process start included':<48} {whole:7.3f} s (aim: 2 s)")
        print(f"  {'peer, reading only: svgpathtools.svg2paths':<48} {peer:7.3f} s")
        print(f"  {'floor: parsing the XML':<48} {floor:7.3f} s")


if __name__ == "__main__":
    main()
