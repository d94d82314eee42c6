"""Give up work within a second when its caller cancels it, at any step."""

from __future__ import annotations

import ctypes
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError
from typing import Protocol

from ..errors import need

POLL_INTERVAL_S = 0.05
MAX_CANCEL_WAIT_S = 0.8  # for what holds the interpreter, such as the encoder of a picture


class CancelFlag(Protocol):
    """What a threading.Event has."""

    def is_set(self) -> bool: ...


Cancel = Callable[[], object] | CancelFlag


class _WorkCancelled(BaseException):
    """Raised in the work's thread: no `except Exception` on its way takes it for an error."""


def run(work: Callable, progress: Callable[[str], object] | None = None, cancel=None):
    """Return what work(stage) returns; stage receives words about progress. progress: the same; cancel: None, a
    callable or something with is_set(): once it says yes, CancelledError is raised.

    Work that may be given up runs in a thread of its own, so that an exception can be put into it at any line of
    Python, which loops of C++ run, too (bindings.hpp). Both callables are called in the thread of the caller.
    """
    if progress is not None and not callable(progress):
        need(progress, Callable, "a callable, which progress is")
    if cancel is None:
        return work(progress or (lambda text: None))
    is_over = getattr(cancel, "is_set", cancel)
    need(is_over, Callable, "a callable or an event, which cancel is")
    said, outcome = deque(maxlen=1), []

    def worked() -> None:
        try:
            outcome.append((work(said.append), None))
        except BaseException as problem:
            outcome.append((None, problem))

    def look() -> None:
        if is_over():
            raise CancelledError("cancelled")
        if progress is not None and said:
            progress(said.pop())

    look()
    thread = threading.Thread(target=worked, name="brushsvg", daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            look()
            thread.join(POLL_INTERVAL_S)
    except BaseException:
        _stop_thread(thread)
        raise
    result, problem = outcome[0]
    if problem is not None:
        raise problem
    return result


def _stop_thread(thread: threading.Thread) -> None:
    """What does not hear it within PATIENCE_S ends on its own: it writes nothing."""
    end = time.monotonic() + MAX_CANCEL_WAIT_S
    while thread.is_alive() and time.monotonic() < end:
        ctypes.pythonapi.PyThreadState_SetAsyncExc(
            ctypes.c_ulong(thread.ident), ctypes.py_object(_WorkCancelled)
        )
        thread.join(
            MAX_CANCEL_WAIT_S / 4
        )  # raised where Python ignores exceptions, as in a destructor, it is lost
