"""Runs the fuzz targets of both languages and shows what they found: `make fuzz`.

run.py [--seconds S] [--slowest S] [--build FOLDER] [--kept FOLDER] [TARGET ...]: each target whose name is or begins
with one of these, all without any. Exit status 1 when anything was found: a crash, a broken property, an input that
takes longer than --slowest or more memory than MOST_MB.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import random
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE / "python"), str(HERE.parent)]

SLOWEST_S = 10  # by the clock: a machine that is busy with other work needs more
MOST_MB = {"cpp": 2048, "python": 1024}  # the address sanitizer keeps freed memory
# Inputs are made of so many bytes at most: numbers of a stroke and its brush, or a file.
CPP_BYTES = {"plan_json": 4096, "brush_json": 16384, "marks_json": 4096}
CPP_NUMBERS = 256
RANDOM_SEEDS = 40
STATE = re.compile(r"#(\d+)\s+\w+(?:\s+cov: (\d+) ft: \d+)?\s+(?:corp: (\d+))?")


@dataclass
class Ran:
    name: str
    language: str
    runs: int = 0
    corpus: int = 0
    edges: int = 0
    findings: tuple[str, ...] = ()
    broken: bool = False


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("targets", nargs="*")
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--slowest", type=int, default=SLOWEST_S)
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "fuzz")
    parser.add_argument("--kept", type=Path, default=ROOT / "build" / "fuzz-kept")
    given = parser.parse_args()
    given.kept = given.kept.resolve()  # the environment there names its folders in a file of paths
    chosen = _chosen(_known(given.build), given.targets)
    if not chosen:
        print(f"no fuzz target is called {' or '.join(given.targets)}", file=sys.stderr)
        return 2
    rows = []
    python = _python(given.kept) if any(language == "python" for _, language in chosen) else None
    for name, language in chosen:
        rows.append(_run(name, language, given, python))
        _show(rows[-1:])
    print()
    _show(rows, head=True)
    found = [path for row in rows for path in row.findings]
    for path in found:
        print(f"found: {path}")
    if found:
        print(f"The inputs are in {given.kept / 'findings'}. CONTRIBUTING.md says how to run one again.")
    for row in rows:
        if row.broken:
            print(f"{row.name} ended without a result: see {_log(given, row.name, row.language)}")
    return int(bool(found) or any(row.broken for row in rows))


def _known(build: Path) -> list[tuple[str, str]]:
    from targets import TARGETS

    cpp = sorted(source.stem for source in (HERE / "cpp").glob("*.cpp"))
    return [(name, "cpp") for name in cpp] + [(name, "python") for name in TARGETS]


def _chosen(known: list[tuple[str, str]], target: list[str]) -> list[tuple[str, str]]:
    exact = {name for name, _ in known}
    return [
        (name, language)
        for name, language in known
        if not target or any(name == one or (one not in exact and name.startswith(one)) for one in target)
    ]


def _python(kept: Path) -> Path:
    from copied_package import made_environment

    import brushsvg._core

    return made_environment(kept / "environment", Path(brushsvg._core.__file__))


def _log(given, name: str, language: str) -> Path:
    return given.kept / "logs" / f"{language}_{name}.txt"


def _run(name: str, language: str, given, python: Path | None) -> Ran:
    corpus = given.kept / "corpus" / f"{language}_{name}"
    findings = given.kept / "findings" / f"{language}_{name}"
    for folder in (corpus, findings, given.kept / "logs"):
        folder.mkdir(parents=True, exist_ok=True)
    before = set(os.listdir(findings))
    with tempfile.TemporaryDirectory() as seeds:
        for number, data in enumerate(_seeds(name, language)):
            (Path(seeds) / f"seed{number:03}").write_bytes(data)
        flags = [
            str(corpus),
            seeds,
            f"-max_total_time={given.seconds}",
            f"-timeout={given.slowest}",
            f"-report_slow_units={given.slowest}",
            f"-rss_limit_mb={MOST_MB[language]}",
            f"-artifact_prefix={findings}/",
            "-print_final_stats=1",
        ]
        if language == "cpp":
            command = [str(given.build / "tests" / "fuzz" / "cpp" / f"fuzz_{name}"), *flags]
            command.append(f"-max_len={CPP_BYTES.get(name, CPP_NUMBERS)}")
            if name in CPP_BYTES:
                command.append(f"-dict={HERE / 'cpp' / 'json.dict'}")
        else:
            command = [str(python), str(HERE / "python" / "fuzz_target.py"), name, *flags]
        with open(_log(given, name, language), "w", encoding="utf-8", errors="replace") as log:
            ended = _ended(command, log, 2 * given.seconds + 20 * given.slowest)
    text = _log(given, name, language).read_text(encoding="utf-8", errors="replace")
    ran = Ran(name, language)
    if states := STATE.findall(text):
        ran.runs, ran.edges, ran.corpus = (int(number or 0) for number in states[-1])
    ran.findings = tuple(str(findings / file) for file in sorted(set(os.listdir(findings)) - before))
    is_blind = language == "python" and ran.runs and not ran.edges and importlib.util.find_spec("atheris")
    ran.broken = bool(is_blind) or (ended != 0 and not ran.findings)
    return ran


def _ended(command: list[str], log, most_s: int) -> int:
    """Its exit status. The target stops by itself; what hangs where no signal reaches it is ended."""
    try:
        return subprocess.run(command, stdout=log, stderr=log, timeout=most_s).returncode
    except subprocess.TimeoutExpired:
        return -1


def _seeds(name: str, language: str) -> list[bytes]:
    from targets import seeds_of

    if language == "python":
        return seeds_of(name)
    data = ROOT / "python" / "brushsvg" / "data" / "brushes"
    if name == "brush_json":
        return [path.read_bytes() for path in sorted(data.glob("*.json"))]
    if name in ("plan_json", "marks_json"):
        return _plans() if name == "plan_json" else _marks()
    choose = random.Random(name)
    return [choose.randbytes(choose.randint(16, CPP_NUMBERS)) for _ in range(RANDOM_SEEDS)]


def _plans() -> list[bytes]:
    import brushsvg

    plan = brushsvg.read_plan(ROOT / "tests" / "golden" / "flat_machine.plan.json")
    arcs = brushsvg.Pass("a", [(0, 0, 0), (10, 0, -1), (0, 10, -1)], arcs=[brushsvg.Arc(1, 2, (0, 0), 1)])
    tilted = brushsvg.Pass("t", [(0, 0, 0), (10, 0, -1)], tool_axes=[(0, 0, 1), (0.28, 0, 0.96)])
    small = brushsvg.Plan("round-6", "", (99, 99), [arcs, tilted])
    return [brushsvg.write_plan(each).encode() for each in (plan, small)]


def _marks() -> list[bytes]:
    import brushsvg

    a_pass = brushsvg.Pass("a", [(20, 20, 0), (30, 20, -2), (40, 25, -2)])
    plan = brushsvg.Plan("round-6", "", (99, 99), [a_pass])
    marks = brushsvg.simulate(plan, brushsvg.find_brush("round-6"), tolerance_mm=0.3)
    return [
        brushsvg.write_marks(marks).encode(),
        b'{"format": "brushsvg/marks", "version": 1, "outline_mm": [[[0, 0], [9, 0], [0, 9]]], "passes": [{"stroke": '
        b'"a", "pose": [0, 1], "contact_mm": [[0, 0], [9, 0]], "heading_rad": [0, 0.5], "depth_mm": [0, 1], "taut": '
        b"[false, true]}]}",
    ]


def _show(rows: list[Ran], head: bool = False) -> None:
    if head:
        print(f"{'target':<26}{'language':<10}{'runs':>10}{'corpus':>8}{'edges':>8}{'findings':>10}")
    for row in rows:
        found = "no result" if row.broken else str(len(row.findings))
        print(
            f"{row.name:<26}{row.language:<10}{row.runs:>10}{row.corpus:>8}{row.edges:>8}{found:>10}",
            flush=True,
        )


if __name__ == "__main__":
    sys.exit(main())
