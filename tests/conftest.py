"""What all tests share."""

import gc
import os

import pytest

# all processors have a test each: threads of one would only take from another, and wait in circles
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def pytest_collection_finish():
    """Tests and modules live to the end: the collector need not go through them again and again."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True)
def arms_reach_all(request, monkeypatch):
    """Tests lay the paper of cells that come along where their arms do not reach: only those marked arm ask these."""
    if request.node.get_closest_marker("arm") is None:
        monkeypatch.setattr("brushsvg.machine.program.unreachable", lambda *_: [])
