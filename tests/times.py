"""Record what each test and fixture costs: `pytest -p times`, with BRUSHSVG_TEST_TIMES naming a folder.

Each worker appends lines of JSON to a file of its own: `id` (test or fixture), `when` (setup, call, teardown or
fixture), `cpu_s` (processor time, subprocesses included) and `wall_s`. `tools/test_times.py` adds them up.
"""

import json
import os
import time
from pathlib import Path

import pytest


def _cpu_s() -> float:
    return sum(os.times()[:4])


def _record(id: str, when: str, cpu_s: float, wall_s: float) -> None:
    folder = os.environ.get("BRUSHSVG_TEST_TIMES")
    if folder:
        worker = os.environ.get("PYTEST_XDIST_WORKER", "main")
        line = {"id": id, "when": when, "cpu_s": round(cpu_s, 3), "wall_s": round(wall_s, 3)}
        with open(Path(folder) / f"{worker}.jsonl", "a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")


def _timed(id: str, when: str):
    cpu_s, wall_s = _cpu_s(), time.perf_counter()
    outcome = yield
    _record(id, when, _cpu_s() - cpu_s, time.perf_counter() - wall_s)
    return outcome


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item):
    return (yield from _timed(item.nodeid, "setup"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    return (yield from _timed(item.nodeid, "call"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item):
    return (yield from _timed(item.nodeid, "teardown"))


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef, request):
    return (yield from _timed(f"{fixturedef.baseid}::{fixturedef.argname}", "fixture"))
