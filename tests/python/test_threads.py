"""Several jobs in threads of one process each end as they do alone."""

import subprocess
import sys
import threading
from concurrent.futures import CancelledError, ThreadPoolExecutor

import pytest

import brushsvg
from brushsvg import Error

PAGE = '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">{}</svg>'
LINE = '<path d="M{} 40 C40 10 60 10 90 30" fill="none" stroke="#203060" stroke-width="{}"/>'
DRAWINGS = {
    "line.svg": LINE.format(20, 3),
    "shape.svg": '<path d="M20 15H60V22H44V50H36V22H20Z"/>',
    "wide.svg": '<path d="M15 10H55V40H15Z M70 20a9 9 0 1 0 18 0a9 9 0 1 0 -18 0Z"/>',
}
JOBS = [
    (name, brush, cell)
    for name, brush in (
        ("line.svg", "round-6"),
        ("shape.svg", "liner-1"),
        ("wide.svg", "round-6-angles"),
        ("line.svg", "no such brush"),
    )
    for cell in ("grbl-3axis", "ur5e")
]
AT_ONCE = 4


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, body in DRAWINGS.items():
        (tmp_path / name).write_text(PAGE.format(body))
    return tmp_path


def made(job) -> tuple:
    name, brush, cell = job
    try:
        found = brushsvg.convert(name, brush=brush, cell=cell, figures=True)
    except Error as refusal:
        return refusal.code, str(refusal)
    return dict(found.texts), str(found.figures), found.time_s, found.notices


def test_jobs_in_threads_give_the_same_results_as_alone(desk):
    alone = [made(job) for job in JOBS]
    with ThreadPoolExecutor(AT_ONCE) as pool:
        together = list(pool.map(made, JOBS * 2))
    assert together == alone * 2


def test_cancelling_one_job_does_not_cancel_the_others(desk):
    alone, gone = made(JOBS[2]), threading.Event()
    gone.set()

    def given_up(_) -> bool:
        try:
            brushsvg.convert("wide.svg", brush="round-6-angles", cell="grbl-3axis", figures=True, cancel=gone)
        except CancelledError:
            return True
        return False

    with ThreadPoolExecutor(AT_ONCE) as pool:
        others = [pool.submit(made, JOBS[2]) for _ in range(3)]
        cancelled = list(pool.map(given_up, range(3)))
        assert all(cancelled)
        assert [each.result() for each in others] == [alone] * 3


ARM_JOBS = """
import sys, threading
from concurrent.futures import ThreadPoolExecutor
import brushsvg
start = threading.Barrier(4)

def text(cell):
    start.wait()
    return brushsvg.convert("line.svg", cell=cell).texts

with ThreadPoolExecutor(4) as pool:
    a, b, *others = pool.map(text, ["ur5e", "ur5e", "kr6-r900", "kr6-r900"])
assert a == b and others[0] == others[1]
"""


def test_the_first_jobs_of_a_process_may_be_for_arms_in_threads(desk):
    """Only a new process shows this: the library that solves the joints fills its tables at the first use."""
    done = subprocess.run([sys.executable, "-c", ARM_JOBS], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
