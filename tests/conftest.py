"""What all tests share."""

import atexit
import gc
import os
import shutil
import tempfile

import pytest

# all processors have a test each: threads of one would only take from another, and wait in circles
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# which files the commands wrote is remembered here, not in the home of who runs the tests
os.environ["XDG_STATE_HOME"] = tempfile.mkdtemp(prefix="brushsvg-state-")
atexit.register(shutil.rmtree, os.environ["XDG_STATE_HOME"], ignore_errors=True)


def pytest_collection_finish():
    """Tests and modules live to the end: the collector need not go through them again and again."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True)
def arms_reach_all(request, monkeypatch):
    """Place the paper of shipped cells where their arms do not reach in tests: only those marked arm check arms."""
    if request.node.get_closest_marker("arm") is None:
        monkeypatch.setattr("brushsvg.machine.job_program.find_unreachable", lambda *_: [])
