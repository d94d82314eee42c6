"""Show which tests, fixtures and builds take longest.

    python tools/test_times.py run python long integration    # run these suites, record and show the costs
    python tools/test_times.py show build/test-times/python   # show the costs of an earlier run

Processor times include subprocesses; they hardly change when the machine is busy, unlike times on the clock.
"""

from __future__ import annotations

import argparse
import collections
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
RECORDS = ROOT / "build" / "test-times"
SUITES = {  # name: arguments of pytest
    "python": ["-m", "not long and not thorough", "tests/python", "tests/laws", "tests/journeys"],
    "long": ["-m", "long and not thorough", "tests/laws"],
    "integration": ["-m", "not long and not thorough", "tests/integration"],
    "python-thorough": ["-m", "not long and thorough", "tests/python", "tests/laws", "tests/journeys"],
    "long-thorough": ["-m", "long and thorough", "tests/laws"],
    "integration-thorough": ["-m", "not long and thorough", "tests/integration"],
}


def run(suite: str) -> int:
    folder = RECORDS / suite
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-p",
        "times",
        "-n",
        "auto",
        "--dist",
        "worksteal",
        *SUITES[suite],
    ]
    path = os.pathsep.join([str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)
    environment = {**os.environ, "BRUSHSVG_TEST_TIMES": str(folder), "PYTHONPATH": path}
    return subprocess.run(command, cwd=ROOT, env=environment).returncode


def read(folder: Path) -> list[dict]:
    return [json.loads(line) for file in sorted(folder.glob("*.jsonl")) for line in file.read_text().splitlines()]


def show(title: str, costs: dict[str, float], rows: int) -> None:
    print(f"\n{title}")
    for name, cost in sorted(costs.items(), key=lambda item: -item[1])[:rows]:
        print(f"{cost:9.1f} s  {name}")


def show_suite(folder: Path, rows: int) -> None:
    records = read(folder)
    tests, functions, files, fixtures = (collections.defaultdict(float) for _ in range(4))
    for record in records:
        if record["when"] == "fixture":
            fixtures[record["id"]] += record["cpu_s"]
            continue
        name = record["id"]
        tests[name] += record["cpu_s"]
        functions[name.split("[")[0]] += record["cpu_s"]
        files[name.split("::")[0]] += record["cpu_s"]
    print(f"\n== {folder.name}: {len(tests)} tests, {sum(tests.values()):.0f} s of the processor")
    show("files", files, rows)
    show("test functions, all their parameters together", functions, rows)
    show("single tests", tests, rows)
    show("fixtures, with the fixtures that they use", fixtures, rows)


def show_builds(rows: int) -> None:
    """Show the build steps by their time on the clock, from ninja's own log."""
    for log in sorted(ROOT.glob("build/*/.ninja_log")):
        costs = {}
        for line in log.read_text().splitlines()[1:]:
            start, end, _, output, _ = line.split("\t")
            costs[output] = (int(end) - int(start)) / 1000
        print(f"\n== {log.parent.relative_to(ROOT)}: {len(costs)} build steps, {sum(costs.values()):.0f} s")
        show("build steps", costs, rows)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=25, help="rows of each table (default: %(default)s)")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("run", help="run suites").add_argument("suites", nargs="+", choices=SUITES)
    commands.add_parser("show", help="show earlier records").add_argument("folders", nargs="+", type=Path)
    given = parser.parse_args()
    if given.command == "show":
        for folder in given.folders:
            show_suite(folder, given.rows)
        return 0
    status = [run(suite) for suite in given.suites]
    for suite in given.suites:
        show_suite(RECORDS / suite, given.rows)
    show_builds(given.rows)
    return max(status)


if __name__ == "__main__":
    sys.exit(main())
