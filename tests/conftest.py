"""What all tests share."""

import gc


def pytest_collection_finish():
    """Tests and modules live to the end: the collector need not go through them again and again."""
    gc.collect()
    gc.freeze()
