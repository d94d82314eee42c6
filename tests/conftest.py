"""What all tests share."""

import gc
import os

# all processors have a test each: threads of one would only take from another, and wait in circles
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def pytest_collection_finish():
    """Tests and modules live to the end: the collector need not go through them again and again."""
    gc.collect()
    gc.freeze()
