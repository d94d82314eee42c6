"""Run the tests of the planted tree, first without faults, then with each fault.

The runs without faults find which tests reach which faults.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from pathlib import Path

from fault import BUILD, EXAMPLES, Fault

# The suites of `make thorough`, one call of pytest each: markers and folders. .ci/run leaves out tests marked thorough.
SUITES = (
    ("not long", "tests/python", "tests/laws", "tests/journeys"),
    ("long", "tests/laws"),
    ("not long", "tests/integration"),
)
CPP = "cpp::"  # the prefix of the names of C++ tests
FIRST_TESTS, FIRST_S, MORE = (
    30,
    20.0,
    4,
)  # starting pytest costs seconds, so the first process has few tests and each later one has more
SLOWER, LATE_S = 5.0, 30.0  # a test may take this many times its duration, plus this many seconds
MEMORY = 8 << 30  # limit for a process in bytes, because an endless loop can fill the memory


@dataclass
class Test:
    name: str
    outcome: str
    seconds: float
    shared: list[str]
    tier: str = ""

    @property
    def file(self) -> str:
        return self.name.split("::")[0]


@dataclass
class Outcome:
    """The outcome of trying a fault."""

    number: int
    tier: str = ""  # ci or thorough, if a test caught the fault
    test: str = ""
    why: str = ""
    tried: int = 0  # number of tests that ran with the fault
    left: int = 0  # number of tests that did not run because the budget was used up
    seconds: float = 0.0
    unreliable: list[str] = field(default_factory=list)  # tests that also fail without the fault


class Tree:
    """The planted tree and its work folder."""

    def __init__(self, work: Path):
        self.work, self.root = work, work / "tree"
        self.map, self.tiers = work / "map", work / "tiers.json"
        self.python = self.root / ".venv/bin/python"

    def start(self, words: list, limit: float | None = None, show: bool = False, **env: str) -> tuple[int, str]:
        """Run a command in the tree; return its status and output.

        At the time limit, the command ends together with all processes that it started.
        """
        surroundings = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST_", "FAULTS_", "BRUSHSVG_"))}
        path = f"{self.root}/.venv/bin:{os.environ['PATH']}"
        process = subprocess.Popen(
            [*map(str, words)],
            cwd=self.root,
            env={**surroundings, "PATH": path, **env},
            stdout=None if show else subprocess.PIPE,
            stderr=None if show else subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY)),
            encoding="utf-8",
            errors="replace",
        )
        try:
            out = process.communicate(timeout=limit)[0]
        except subprocess.TimeoutExpired:
            out = "time limit"
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # also processes that a test left behind
            process.wait()
        return process.returncode, out or ""

    def pytest(self, *words, **settings) -> tuple[int, str]:
        return self.start([self.python, "-m", "pytest", "-p", "brushsvg_faults_pytest", *words], **settings)

    # the map

    def map_tests(self, paths: list[str], processes: int, tier: str) -> None:
        """Run tests without a fault, and save which tests reach which faults.

        Tests that ran before are left out. paths holds files and folders; "cpp" stands for the C++ tests.
        Without paths, all suites run.
        """
        self.map.mkdir(exist_ok=True)
        settings = {
            "FAULTS_RESULTS": str(self.map),
            "FAULTS_RESUME": "1",
            "BRUSHSVG_FAULT_HITS": str(self.map),
        }
        if not paths or "cpp" in paths:
            self._map_cpp(settings["BRUSHSVG_FAULT_HITS"])
        left_out = "thorough" if tier == "ci" else "nothing"
        runs = (
            [("-m", f"not {left_out}", *group) for group in apart([path for path in paths if path != "cpp"])]
            if paths
            else [("-m", f"{markers} and not {left_out}", *at) for markers, *at in SUITES]
        )
        for words in runs:
            self.pytest("-n", processes, "--dist", "loadfile", *words, show=True, **settings)

    def _map_cpp(self, hits: str) -> None:
        with (self.map / "tests-cpp.jsonl").open("w", encoding="utf-8") as out:
            for name, words in self.cpp_tests().items():
                begin = time.perf_counter()
                status, _ = self.start(words, BRUSHSVG_FAULT_HITS=hits, PYTEST_CURRENT_TEST=f"{name} (call)")
                outcome = "failed" if status else "passed"
                record = {"test": name, "outcome": outcome, "seconds": round(time.perf_counter() - begin, 3)}
                out.write(json.dumps({**record, "shared": []}) + "\n")

    def cpp_tests(self) -> dict[str, list]:
        binary = self.root / BUILD / "tests/cpp/brushsvg_tests"
        _, listed = self.start([binary, "--list-test-cases", "--no-version"])
        names = [line for line in listed.splitlines() if line and not line.startswith(("[doctest]", "==="))]
        tests = {f"{CPP}{name}": [binary, f"-tc={name.replace(',', chr(92) + ',')}"] for name in names}
        examples = self.root / BUILD / "examples"
        brush = self.root / "python/brushsvg/data/brushes/round-6.json"
        out = Path(tempfile.gettempdir()) / "faults_example.ngc"
        return tests | {f"{CPP}{name}": [examples / f"example_{name}", brush, out] for name in EXAMPLES}

    def collect_tiers(self) -> None:
        """Save the tier of each test, by the markers of the tree."""
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "names"

            def names(*words: str) -> list[str]:
                status, output = self.pytest("--collect-only", "-q", *words, FAULTS_COLLECT=str(out))
                if status:
                    raise SystemExit(output[-3000:])
                return json.loads(out.read_text(encoding="utf-8"))

            tiers = {}
            for tier, left_out in (("thorough", ""), ("ci", " and not thorough")):
                for markers, *paths in SUITES:
                    tiers.update(dict.fromkeys(names("-m", markers + left_out, *paths), tier))
        self.tiers.write_text(json.dumps(tiers, indent=0), encoding="utf-8")

    def tests(self) -> dict[str, Test]:
        """Return all tests that ran without a fault."""
        tiers = json.loads(self.tiers.read_text(encoding="utf-8"))
        found = {}
        for path in sorted(self.map.glob("tests-*.jsonl")):
            for line in path.read_text(encoding="utf-8").splitlines():
                record = json.loads(line)
                name = record["test"]
                tier = "ci" if name.startswith(CPP) else tiers.get(name)
                if "outcome" in record and tier:
                    found[name] = Test(name, record["outcome"], record["seconds"], record.get("shared", []), tier)
        return found

    def hits(self) -> dict[int, set[str]]:
        """Return {number of a fault: the tests and files that reach it}.

        A file is listed if importing it reaches the fault.
        """
        found = defaultdict(set)
        for path in self.map.glob("hits-*.txt"):
            for line in path.read_text(encoding="utf-8").splitlines():
                number, _, test = line.partition("\t")
                found[int(number)].add(re.sub(r" \(\w+\)$", "", test))
        return found

    # one fault

    def run_tests(self, number: int, tests: list[Test]) -> tuple[Test | None, str, int]:
        """Run tests with a fault (0: none) until one fails.

        Return the failed test, the reason, and how many tests ran.
        """
        ran = 0
        names = self.cpp_tests() if any(test.name.startswith(CPP) for test in tests) else {}
        for test in [test for test in tests if test.name in names]:
            ran += 1
            limit = SLOWER * test.seconds + LATE_S
            status, out = self.start(names[test.name], limit, BRUSHSVG_FAULT=str(number))
            if status:
                return test, out.strip()[-300:], ran
        for files in apart(list(dict.fromkeys(test.file for test in tests if not test.name.startswith(CPP)))):
            folder = Path(tempfile.mkdtemp(prefix="faults-"))
            try:
                test, why, more = self._run_pytest(number, [test for test in tests if test.file in files], folder)
            finally:
                shutil.rmtree(folder, ignore_errors=True)
            ran += more
            if test:
                return test, why, ran
        return None, "", ran

    def _run_pytest(self, number: int, tests: list[Test], folder: Path) -> tuple[Test | None, str, int]:
        limits = {test.name: SLOWER * test.seconds + LATE_S for test in tests}
        select = folder / "select.json"
        select.write_text(json.dumps(limits), encoding="utf-8")
        files = list(dict.fromkeys(test.file for test in tests))
        status, out = self.pytest(
            "-x",
            f"--basetemp={folder}/pytest",
            *files,
            limit=sum(limits.values()) + 60,
            BRUSHSVG_FAULT=str(number),
            FAULTS_SELECT=str(select),
            FAULTS_RESULTS=str(folder),
        )
        lines = [json.loads(line) for path in folder.glob("tests-*.jsonl") for line in path.read_text().splitlines()]
        by_name = {test.name: test for test in tests}
        ended = {line["test"] for line in lines if "outcome" in line}
        for line in lines:
            if line.get("outcome") == "failed":
                # a file that cannot be imported fails as a whole
                test = by_name.get(line["test"]) or next((t for t in tests if t.file == line["test"]), tests[0])
                return test, line["why"], len(ended)
        for line in lines:
            if "begun" in line and line["test"] not in ended:
                return by_name[line["test"]], f"the process ended ({status}) or took too long", len(ended) + 1
        if status not in (0, 5):
            return tests[0], f"pytest: {status}: {out.strip()[-300:]}", len(ended)
        return None, "", len(ended)

    def try_fault(self, fault: Fault, tests: dict[str, Test], hits: set[str], budget: float) -> Outcome:
        outcome, begin = Outcome(fault.number), time.perf_counter()
        direct, near = reaching(tests, hits)
        for tier in ("ci", "thorough"):
            waiting = [[test for test in group if test.tier == tier] for group in (direct, near)]
            spent, size, seconds = 0.0, FIRST_TESTS, FIRST_S
            for group in waiting:
                while group and spent < budget:
                    chunk = first(group, size, min(seconds, budget - spent))
                    caught, why, ran = self.run_tests(fault.number, chunk)
                    outcome.tried += ran
                    if caught and self.run_tests(0, [caught])[0]:
                        outcome.unreliable.append(caught.name)
                        group.remove(caught)
                        continue
                    if caught:
                        outcome.tier, outcome.test, outcome.why = tier, caught.name, why
                        outcome.seconds = time.perf_counter() - begin
                        return outcome
                    del group[: len(chunk)]
                    spent += sum(test.seconds for test in chunk)
                    size, seconds = MORE * size, MORE * seconds
                outcome.left += len(group)
        outcome.seconds = time.perf_counter() - begin
        return outcome

    def try_all(self, faults: list[Fault], jobs: int, budget: float, again: bool) -> None:
        """Try each fault that is untried, and with again each fault that no test caught."""
        folder = self.work / "tried"
        folder.mkdir(exist_ok=True)
        tests, hits = self.tests(), self.hits()
        lock, begin = threading.Lock(), time.perf_counter()

        def one(fault: Fault) -> None:
            path = folder / f"{fault.number}.json"
            if path.exists() and not (again and not json.loads(path.read_text())["tier"]):
                return
            outcome = self.try_fault(fault, tests, hits.get(fault.number, set()), budget)
            path.write_text(json.dumps(asdict(outcome), indent=1), encoding="utf-8")
            with lock:
                outcome_text = f"caught by {outcome.test} ({outcome.tier})" if outcome.tier else "SURVIVED"
                clock = time.perf_counter() - begin
                print(
                    f"{clock:6.0f} s  {fault.number:3} {fault.file}:{fault.line} {fault.kind}: {outcome_text}",
                    flush=True,
                )

        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(one, faults))

    def outcomes(self) -> dict[int, Outcome]:
        found = [Outcome(**json.loads(path.read_text())) for path in (self.work / "tried").glob("*.json")]
        return {outcome.number: outcome for outcome in found}


def reaching(tests: dict[str, Test], hits: set[str]) -> tuple[list[Test], list[Test]]:
    """Return the tests that reach a fault, and tests that share results with these.

    Both lists begin with the quickest test. Tests share fixtures and cached results of a file or of a whole
    run. Only the first test that needs a shared result reaches the fault in it.
    """
    passing = sorted((test for test in tests.values() if test.outcome == "passed"), key=lambda test: test.seconds)
    files = {name for name in hits if "::" not in name}
    direct = [test for test in passing if test.name in hits or test.file in files]
    near_files = {test.file for test in direct if not test.name.startswith(CPP)}
    fixtures = {name for test in direct for name in test.shared}
    # A test that fails without faults still shows by its hit which file reaches the fault.
    near_files |= {name.split("::")[0] for name in hits if not name.startswith(CPP)}
    known = {test.name for test in direct}
    if any("::" not in name for name in hits):  # all other tests may use what an import computes
        return direct, [test for test in passing if test.name not in known]
    near = [test for test in passing if test.file in near_files or fixtures & set(test.shared)]
    return direct, [test for test in near if test.name not in known]


def apart(paths: list[str]) -> list[list[str]]:
    """Split paths into groups that one process of pytest can run."""
    integration = [path for path in paths if path.startswith("tests/integration")]
    groups = ([path for path in paths if path not in integration], integration)
    return [group for group in groups if group]


def first(tests: list[Test], most: int, seconds: float) -> list[Test]:
    """Return the first tests, within a count and a total time, at least one."""
    total = 0.0
    for count, test in enumerate(tests[:most]):
        total += test.seconds
        if count and total > seconds:
            return tests[:count]
    return tests[:most]
