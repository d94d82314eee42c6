"""Measure brushsvg with many drawings and with a very large one.

    scale.py characters [--count N] [--jobs 2] [--keep FOLDER]
    scale.py cluster [--count 200]
    scale.py strokes [--count 100000]

characters: `batch` converts every character of hanzi-writer-data. It writes outlines, closed form, program,
picture and figures of each. The program prints the duration, and the memory of this process and of the
largest worker. cluster: a Dask cluster converts characters with local workers of one thread each. It runs
with one worker, with two, and with two of which one is killed half way. The files are compared with those of
processes, byte by byte. Tasks that are refused at once measure the additional time of a task. strokes: one
`convert` of this many short lines. npm fetches the characters once.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import brushsvg

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "integration"))
from lettering import PACKAGES
from npm import fetched

UNITS = 1024  # the size of a character's box
BASELINE = 900  # y points up from this line
SIZE_MM = 100


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("characters", "cluster", "strokes"))
    parser.add_argument("--count", type=int)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = given.keep or Path(folder)
        out.mkdir(parents=True, exist_ok=True)
        if given.what == "characters":
            characters(out, given.count, given.jobs)
        elif given.what == "cluster":
            cluster(out, given.count or 200)
        else:
            strokes(out, given.count or 100_000)


def drawings(count: int | None) -> list[tuple[str, str]]:
    """Return names and SVG documents of characters, spread evenly over all."""
    folder = Path(tempfile.gettempdir(), "brushsvg-lettering")
    folder.mkdir(exist_ok=True)
    files = sorted((fetched(folder, PACKAGES) / "hanzi-writer-data").glob("?.json"))
    chosen = np.unique(np.linspace(0, len(files) - 1, count or len(files)).astype(int))
    return [(files[k].stem, _svg(json.loads(files[k].read_text(encoding="utf-8"))["strokes"])) for k in chosen]


def _svg(outlines: list[str]) -> str:
    paths = "".join(f'<path id="s{number}" d="{data}"/>' for number, data in enumerate(outlines))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE_MM}mm" height="{SIZE_MM}mm" '
        f'viewBox="0 0 {UNITS} {UNITS}"><g transform="matrix(1 0 0 -1 0 {BASELINE})">{paths}</g></svg>'
    )


def characters(out: Path, count: int | None, jobs: int) -> None:
    items = drawings(count)
    begin, before = time.perf_counter(), _used()
    # New processes, so that their memory counts as memory of this process's children.
    with ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as executor:
        done = brushsvg.batch(items, out / "characters", executor=executor, progress=_report)
    clock, used = time.perf_counter() - begin, _used() - before
    print(file=sys.stderr)
    figures = [row.figures for row in done.rows if row.figures]
    overlap = np.array([one.overlap for one in figures])
    print(f"{len(items)} characters, {sum(one.strokes for one in figures)} strokes, {jobs} processes")
    print(f"  on the clock {clock:.0f} s, processors {used:.0f} s, {1e3 * used / len(items):.0f} ms a character")
    low = np.percentile(overlap, 5)
    print(f"  {len(done.refused)} refused, overlap {overlap.mean():.4f}, 5th percentile {low:.4f}")
    for row in done.refused[:5]:
        print(f"    {row.name}: {row.text}")
    print(
        f"  memory: this process {_peak_mb(resource.RUSAGE_SELF):.0f} MB, the largest worker "
        f"{_peak_mb(resource.RUSAGE_CHILDREN):.0f} MB"
    )


def cluster(out: Path, count: int) -> None:
    items = drawings(count)
    begin = time.perf_counter()
    known = brushsvg.batch(items, out / "processes", jobs=1)
    print(f"{len(items)} characters\n  one process            {time.perf_counter() - begin:7.1f} s")
    for workers in (1, 2):
        with _workers(workers) as (address, _):
            # workers load their modules once
            brushsvg.batch(items[:4], out / f"warm {workers}", cluster=address)
            begin = time.perf_counter()
            done = brushsvg.batch(items, out / f"{workers} workers", cluster=address)
            took = time.perf_counter() - begin
            broken = [(f"broken {k}", "<svg") for k in range(1000)]
            begin = time.perf_counter()
            brushsvg.batch(broken, out / f"broken {workers}", cluster=address)
            cost_ms = time.perf_counter() - begin
        work_ms = 1e3 * took * workers / len(items)
        print(
            f"  {workers} of Dask's workers     {took:7.1f} s, {_same(done, known)}; a task that does nothing "
            f"{cost_ms:.2f} ms: half is lost at {work_ms / cost_ms:.0f} workers"
        )
    with _workers(2) as (address, pids):
        killed: list[int] = []

        def kill(text: str) -> None:
            if not killed and int(text.split()[0]) >= len(items) // 2:
                killed.append(pids[0])
                os.kill(pids[0], signal.SIGKILL)

        begin = time.perf_counter()
        done = brushsvg.batch(items, out / "killed", cluster=address, progress=kill)
        print(f"  2, one killed half way {time.perf_counter() - begin:7.1f} s, {_same(done, known)}")


@contextmanager
def _workers(count: int) -> Iterator[tuple[str, list[int]]]:
    """Yield the address of a scheduler, and the processes of its workers."""
    from dask import distributed

    with distributed.LocalCluster(count, threads_per_worker=1, processes=True, dashboard_address=None) as local:
        with distributed.Client(local) as client:
            pids = list(client.run(os.getpid).values())
        yield local.scheduler_address, pids


def _same(done, known) -> str:
    """Rows hold the sums of all files."""
    return "the same bytes" if done.rows == known.rows else "OTHER FILES"


def strokes(out: Path, count: int) -> None:
    """Convert short lines in rows, more than any drawing of a person has."""
    random = np.random.default_rng(1)
    across = int(np.ceil(np.sqrt(count)))
    lines = []
    for number in range(count):
        x, y = 30 + 8 * (number % across), 30 + 8 * (number // across)
        dx, dy = random.uniform(2, 6, 2)
        lines.append(f'<path d="M{x:.2f} {y:.2f}l{dx:.2f} {dy:.2f}" stroke-width="{random.uniform(1, 3):.2f}"/>')
    size = 60 + 8 * across
    drawing = out / "many.svg"
    drawing.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}mm" height="{size}mm" viewBox="0 0 {size} {size}">'
        f'<g fill="none" stroke="#000">{"".join(lines)}</g></svg>'
    )
    for output in ("many.json", "many.ngc", "many.png"):
        command = "preview" if output.endswith(".png") else "convert"
        words = [sys.executable, "-m", "brushsvg", command, drawing, "-o", out / output]
        begin, before = time.perf_counter(), _used()
        with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as process:
            peak: list[float] = []
            watch = threading.Thread(target=_watch, args=(process, peak))
            watch.start()
            errors = process.communicate()[1]
            watch.join()
        clock = time.perf_counter() - begin
        print(
            f"{count} strokes, {command} to {drawing.with_name(output).suffix}: {clock:.0f} s on the clock, "
            f"{_used() - before:.0f} s of processors, {max(peak, default=0):.0f} MB, exit {process.returncode}"
        )
        if process.returncode:
            print(errors[-500:])


def _watch(process: subprocess.Popen, peak: list[float]) -> None:
    """Watch a process and record its peak memory, as the kernel counts it."""
    while process.poll() is None:
        try:
            text = Path(f"/proc/{process.pid}/status").read_text()
        except OSError:
            return
        peak += [int(line.split()[1]) / 1024 for line in text.splitlines() if line.startswith("VmHWM")]
        time.sleep(0.1)


def _used() -> float:
    times = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in times)


def _peak_mb(who: int) -> float:
    return resource.getrusage(who).ru_maxrss / 1024


def _report(text: str) -> None:
    print(f"\r{text}   ", end="", file=sys.stderr)


if __name__ == "__main__":
    main()
