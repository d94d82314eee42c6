"""Run a sample of a test's parameters on each landing.

`make thorough` runs all of them.
"""

from zlib import crc32

import pytest


def sample(names, values, keep: int, ids=None):
    """Parametrize a test: each landing runs `keep` of the values.

    The other values carry the marker `thorough`. The kept values are spread evenly over the list and start at
    a different place for each test function. Over many tests, each value (a machine, for example) is
    therefore covered by some test.
    """
    values = list(values)
    single = len(names.split(",") if isinstance(names, str) else names) == 1
    step = max(1.0, len(values) / keep)

    def mark(function):
        first = crc32(function.__qualname__.encode()) % len(values)
        kept = {(first + int(k * step)) % len(values) for k in range(keep)}
        return pytest.mark.parametrize(
            names,
            [value if k in kept else _thorough(value, single) for k, value in enumerate(values)],
            ids=ids,
        )(function)

    return mark


def _thorough(value, single: bool):
    if isinstance(value, type(pytest.param())):
        return pytest.param(*value.values, marks=[*value.marks, pytest.mark.thorough], id=value.id)
    return pytest.param(*((value,) if single else value), marks=pytest.mark.thorough)
