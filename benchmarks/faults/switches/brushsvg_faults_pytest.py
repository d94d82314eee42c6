"""Select, order and limit the tests of a planted tree, and record their outcomes (pytest plugin).

FAULTS_RESULTS   a folder: a line of JSON for the beginning of each test, one for its end
FAULTS_SELECT    a file of JSON, {test: seconds it may take}: these tests alone
FAULTS_RESUME    if set, tests that have an end in FAULTS_RESULTS are left out
FAULTS_COLLECT   a file: the names of the tests that were collected
"""

import faulthandler
import functools
import gc
import json
import os
import signal
import time
from pathlib import Path

import brushsvg_faults
import pytest

CURRENT = "PYTEST_CURRENT_TEST"
GRACE_S = 20  # the process ends if code does not return to Python


class TimeLimitError(BaseException):
    """Only pytest may catch this exception."""


def late(*_):
    raise TimeLimitError("this test takes much longer than without the fault")


def read(folder):
    for path in Path(folder).glob("tests-*.jsonl"):
        for line in path.read_text(encoding="utf-8").splitlines():
            yield json.loads(line)


class Planted:
    def __init__(self, results, select):
        self.results, self.limits = results, select
        self.failed, self.skipped, self.file = False, False, None
        self.caches = []

    def write(self, **fields):
        if self.results:
            with open(f"{self.results}/tests-{os.getpid()}.jsonl", "a", encoding="utf-8") as file:
                file.write(json.dumps(fields) + "\n")

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config, items):
        kept = items[:]
        if self.limits is not None:
            kept = [item for item in kept if item.nodeid in self.limits]
        if os.environ.get("FAULTS_RESUME"):
            known = {each["test"] for each in read(self.results) if "outcome" in each}
            kept = [item for item in kept if item.nodeid not in known]
        if out := os.environ.get("FAULTS_COLLECT"):
            Path(out).write_text(json.dumps([item.nodeid for item in kept]), encoding="utf-8")
        self.caches = caches()  # before tests/conftest.py hides existing objects from gc
        config.hook.pytest_deselected(items=[item for item in items if item not in set(kept)])
        items[:] = kept

    @pytest.hookimpl(hookwrapper=True)
    def pytest_make_collect_report(self, collector):
        """Count faults reached by the import of a file for its tests."""
        if isinstance(collector, pytest.Module):
            os.environ[CURRENT] = f"{collector.nodeid} (collect)"
            brushsvg_faults.reset()
        yield
        if isinstance(collector, pytest.Module):
            os.environ.pop(CURRENT, None)

    def pytest_collectreport(self, report):
        if report.failed:
            self.write(test=report.nodeid, outcome="failed", seconds=0.0, why=tail(report))

    def pytest_runtest_makereport(self, item, call):
        if call.excinfo is None:
            return
        if call.excinfo.errisinstance(pytest.skip.Exception):
            self.skipped = True
        else:
            self.failed = True
            self.why = f"{call.excinfo.typename}: {call.excinfo.value}"[:300]

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item):
        if item.path != self.file:
            self.file = item.path
            for each in (
                self.caches + caches()
            ):  # a file must not find results of another file, so that its tests reach all faults
                each.cache_clear()
        brushsvg_faults.reset()
        self.failed, self.skipped, self.why = False, False, ""
        self.write(test=item.nodeid, begun=time.time())
        limit = (self.limits or {}).get(item.nodeid)
        if limit:
            signal.signal(signal.SIGALRM, late)
            signal.setitimer(signal.ITIMER_REAL, limit)
            faulthandler.dump_traceback_later(limit + GRACE_S, exit=True)
        begin = time.perf_counter()
        yield
        if limit:
            signal.setitimer(signal.ITIMER_REAL, 0)
            faulthandler.cancel_dump_traceback_later()
        self.write(
            test=item.nodeid,
            outcome="failed" if self.failed else "skipped" if self.skipped else "passed",
            seconds=round(time.perf_counter() - begin, 3),
            shared=shared(item),
            why=self.why,
        )


def tail(report) -> str:
    return str(report.longrepr).strip().splitlines()[-1][:300]


def caches() -> list:
    """Return all functools.cache and lru_cache of the package and its tests."""
    found = [each for each in gc.get_objects() if isinstance(each, functools._lru_cache_wrapper)]
    homes = [getattr(each.__wrapped__, "__code__", None) for each in found]
    ours = [home and any(part in home.co_filename for part in ("/brushsvg/", "/tests/")) for home in homes]
    return [each for each, known in zip(found, ours, strict=True) if known]


def shared(item) -> list[str]:
    """Return fixtures of this project that live longer than the file of the item."""
    root = str(item.config.rootpath)
    return [
        name
        for name, fixtures in item._fixtureinfo.name2fixturedefs.items()
        for fixture in fixtures[-1:]
        if fixture.scope in ("session", "package") and not name.startswith("_")
        if getattr(fixture.func, "__code__", None) and fixture.func.__code__.co_filename.startswith(root + "/tests/")
    ]


def pytest_configure(config):
    if hasattr(config, "workerinput") or not config.getoption("numprocesses", None):
        select = os.environ.get("FAULTS_SELECT")
        limits = json.loads(Path(select).read_text(encoding="utf-8")) if select else None
        config.pluginmanager.register(Planted(os.environ.get("FAULTS_RESULTS"), limits))
