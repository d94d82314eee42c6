"""The switches of planted faults in Python: __fault__(k) is true in a process whose BRUSHSVG_FAULT is k.

If BRUSHSVG_FAULT_HITS names a folder, the numbers of faults that a test reaches are written there. A .pth file of
the planted tree's .venv imports this module, so that every process of its Python has __fault__.
"""

import builtins
import os

HITS = os.environ.get("BRUSHSVG_FAULT_HITS")
ACTIVE = int(os.environ.get("BRUSHSVG_FAULT") or 0)
seen = set()


def differ(original, mutated) -> bool:
    """Return whether two expressions have different values; an exception counts as a value."""
    try:
        unequal = original() != mutated()
    except Exception:
        return True
    try:
        return bool(unequal)
    except ValueError:
        return bool(unequal.any())


def watch(number: int, original=None, mutated=None) -> bool:
    """Return False, and record the fault once for each test.

    If two forms are given, the fault is recorded only if they differ.
    """
    if number not in seen and (original is None or differ(original, mutated)):
        seen.add(number)
        test = os.environ.get("PYTEST_CURRENT_TEST", "")
        with open(f"{HITS}/hits-{os.getpid()}.txt", "a", encoding="utf-8") as file:
            file.write(f"{number}\t{test}\n")
    return False


def switch(number: int, *_) -> bool:
    return number == ACTIVE


def reset() -> None:
    """Record reached faults again, because another test begins."""
    import ctypes
    import sys

    seen.clear()
    core = sys.modules.get("brushsvg._core")
    again = core and getattr(ctypes.CDLL(core.__file__), "brushsvg_faults_reset", None)
    if again:  # the tree has faults in C++
        again()


builtins.__fault__ = watch if HITS else switch
