"""Test properties of programs for random drawings, brushes, cells and options.

    properties.py [--first 0] [--count 100000] [--hours 1] [--jobs 2] [--dialect NAME ...] [--results FILE]

The tests' own interpreters of each robot language and their own stepping simulator judge the programs. No
pose may be deeper than the brush allows. No mark may be off the sheet, no move outside of the workspace, and
no touching move too fast. Reported tracking errors must be true. Equal input must give equal bytes, also from
two processes. check must accept the programs that convert writes. A refusal is not a fault, but an exception
is.

The program appends results to a file, a line for each case. A later run continues after the last case. At the
end, or with --count 0, it prints a table by kind of drawing and brush.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import shutil
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # each process has one processor
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "integration"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "journeys"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))

from judge.checked import quick_check
from judge.properties import batches_differ, one

ROOT = Path(__file__).parents[1]
PART = 50  # cases per task of a process
BATCH_EVERY = 8  # of so many parts, the drawings of one also form a batch


def part(first: int, shelf: Path, dialects: list[str]) -> list[dict]:
    """Run the cases from `first` on."""
    found = []
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
        work = Path(folder)
        with quick_check() as check:
            found += [
                asdict(one(number, work / str(number), shelf, check, dialects)) for number in range(first, first + PART)
            ]
        if first // PART % BATCH_EVERY == 0:
            drawings = sorted(work.glob("*/drawing.svg"), key=lambda path: int(path.parent.name))[:6]
            sources = [Path(shutil.copy(path, work / f"d{path.parent.name}.svg")) for path in drawings]
            found[-1]["wrong"] = [*found[-1]["wrong"], *(batches_differ(sources, work / "batch") if sources else [])]
    return found


def made_shelf(folder: Path, k: int) -> Path:
    """Make the folder of brush files of one process."""
    shelf = folder / str(k)
    shelf.mkdir(exist_ok=True)
    return shelf


def table(cases: list[dict]) -> str:
    lines = [f"{'':24}{'cases':>8}{'refused':>9}{'wrong':>7}"]
    for key in ("drawing", "brush", "dialect"):
        for name in sorted({case[key] for case in cases}):
            some = [case for case in cases if case[key] == name]
            count = Counter("wrong" if case["wrong"] else "refused" if case["refused"] else "" for case in some)
            lines.append(f"{key + ' ' + name:24}{len(some):8}{count['refused']:9}{count['wrong']:7}")
    total = sum(bool(case["wrong"]) for case in cases)
    return "\n".join([*lines, f"{'all':24}{len(cases):8}{sum(bool(c['refused']) for c in cases):9}{total:7}"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--hours", type=float, default=1.0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--dialect", nargs="*", default=[], help="only these; their results need a file of their own")
    parser.add_argument("--results", type=Path, default=ROOT / "build" / "properties.jsonl")
    args = parser.parse_args()
    args.results.parent.mkdir(parents=True, exist_ok=True)
    known = [json.loads(line) for line in args.results.read_text().splitlines()] if args.results.exists() else []
    done = {case["number"] for case in known}
    firsts = [first for first in range(args.first, args.first + args.count, PART) if first + PART - 1 not in done]
    until = time.monotonic() + 3600 * args.hours
    with (
        tempfile.TemporaryDirectory() as shelf,
        ProcessPoolExecutor(args.jobs) as pool,
        args.results.open("a", encoding="utf-8") as out,
    ):
        for some in (firsts[k : k + args.jobs] for k in range(0, len(firsts), args.jobs)):
            if time.monotonic() > until:
                break
            shelves = [made_shelf(Path(shelf), k) for k in range(len(some))]
            for cases in pool.map(part, some, shelves, [args.dialect] * len(some)):
                for case in cases:
                    out.write(json.dumps(case) + "\n")
                    if case["wrong"]:
                        print(
                            case["number"],
                            case["drawing"],
                            case["brush"],
                            case["dialect"],
                            *case["wrong"],
                            sep="\n  ",
                        )
                known += cases
                out.flush()
            print(f"{len(known)} cases, {sum(bool(c['wrong']) for c in known)} wrong", flush=True)
    print(table(known))


if __name__ == "__main__":
    main()
