"""Measure the memory that each input format needs, for the table of docs/reference/formats.md.

    input_memory.py [--mb 8]

The table has the peak of a process and the size of the file. --mb is the approximate size of the files, which are
as dense as their format allows.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

MB = 2**20
READ = "import brushsvg; brushsvg.read_drawing({!r})"
PHOTO = "from pathlib import Path; from brushsvg.photo.photo import read_photo; read_photo(Path({!r}).read_bytes())"
CHECK = "from brushsvg.cli import main; main(['check', {!r}, '--cell', 'linuxcnc-3axis', '--paper-z', '6', '--quiet'])"
PLAN = "import brushsvg; brushsvg.read_plan({!r})"
MEASURED = "from brushsvg.cli import main; main(['calibrate', {0!r}, '-o', {0!r} + '.json', '--quiet'])"


def repeated(head: str, one: str, tail: str, size: int) -> bytes:
    return (head + one * max(1, size // len(one)) + tail).encode()


def svg(body: str, size: int) -> bytes:
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="200mm" viewBox="0 0 200 200">'
    return repeated(head, body, "</svg>", size)


def one_path(size: int) -> bytes:
    return svg('<path fill="none" stroke="#000" d="M1 1' + "L9 9 8 1" * max(1, size // 8) + '"/>', 1)


def dxf(size: int) -> bytes:
    line = "0\nLINE\n8\n0\n10\n1\n20\n1\n11\n9\n21\n9\n"
    return repeated("0\nSECTION\n2\nENTITIES\n", line, "0\nENDSEC\n0\nEOF\n", size)


def plan(size: int) -> bytes:
    poses = [[10, 10, 0], [20.5, 30.5, -1.5]] * max(2, size // 26)
    a_pass = {"stroke": "a", "speed_mm_s": 20, "layer": "", "colour": "", "settings": {}, "poses_mm": poses}
    head = {"format": "brushsvg/plan", "version": 1, "brush": "round-6", "title": "", "sheet_mm": [99, 99]}
    return json.dumps({**head, "passes": [a_pass]}).encode()


def photo(size: int) -> bytes:
    import cv2

    side = int((size * 3) ** 0.5)  # a photograph of paint needs about a third of a byte per pixel
    page = np.full((side, side, 3), 240, np.uint8)
    page[::7, ::5] = 60
    return cv2.imencode(".jpg", page)[1].tobytes()


FORMATS = {
    "SVG, many elements": (".svg", lambda size: svg('<path stroke="red" d="M1 1 9 9"/>', size), READ),
    "SVG, one path": (".svg", one_path, READ),
    "DXF": (".dxf", dxf, READ),
    "G-code to paint": (
        ".gcode",
        lambda size: repeated("G21 G90\n", "G0 Z5\nG0 X1 Y1\nG1 Z-1 F9\nG1 X9 Y5\n", "M2\n", size),
        READ,
    ),
    "program to check": (
        ".ngc",
        lambda size: repeated("G21 G90\nG0 X1 Y1 Z9\n", "G1 X1.5 Y9.5 Z5 F90\nG1 X9.5 Y1.5 Z5\n", "M2\n", size),
        CHECK,
    ),
    "plan.json": (".json", plan, PLAN),
    "measurements, CSV": (
        ".csv",
        lambda size: repeated("kind,depth_mm,value_mm\n", "lag,1,2\n", "", size),
        MEASURED,
    ),
    "photograph": (".jpg", photo, PHOTO),
}


def peak_mb(code: str) -> float:
    """Return the peak memory of a process that runs this code."""
    last = "import resource; print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)"
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            f"import sys\ntry:\n  {code}\nexcept ValueError as no: print(str(no)[:100], file=sys.stderr)\n{last}",
        ],
        capture_output=True,
        text=True,
    )
    print(done.stderr[-200:], end="", file=sys.stderr)
    if done.returncode:
        raise SystemExit(done.stderr)
    return float(done.stdout.split()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mb", type=float, default=8.0)
    args = parser.parse_args()
    print(f"{'format':24}{'file, MB':>10}{'small, MB':>11}{'peak, MB':>10}{'per MB':>8}")
    with tempfile.TemporaryDirectory() as folder:
        for name, (suffix, made, code) in FORMATS.items():
            path = Path(folder) / f"input{suffix}"
            path.write_bytes(made(10_000))
            small = peak_mb(code.format(str(path)))
            path.write_bytes(made(int(args.mb * MB)))
            peak, size_mb = peak_mb(code.format(str(path))), path.stat().st_size / MB
            print(
                f"{name:24}{size_mb:10.1f}{small:11.0f}{peak:10.0f}{(peak - small) / size_mb:8.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
