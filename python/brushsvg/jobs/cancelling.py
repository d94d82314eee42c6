"""Run work that its caller can cancel within a second, at any step."""

from __future__ import annotations

import ctypes
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError
from typing import Protocol

from ..errors import require_type

POLL_INTERVAL_S = 0.05
# How long to wait for code that holds the interpreter, such as an encoder of pictures, in seconds.
MAX_CANCEL_WAIT_S = 0.8


class CancelFlag(Protocol):
    """An object that can be set, such as a threading.Event."""

    def is_set(self) -> bool: ...


Cancel = Callable[[], object] | CancelFlag


class _WorkCancelled(BaseException):
    """Raised in the thread of the work to stop it.

    It is no Exception, so that no `except Exception` in the work catches it.
    """


def run(work: Callable, progress: Callable[[str], object] | None = None, cancel=None):
    """Return the result of work(stage), and cancel the work if requested.

    work: called with a function that receives words on the progress.
    progress: called with these words.
    cancel: None, a callable, or an object with is_set(). Once it returns true, CancelledError is raised.

    Work that can be cancelled runs in a thread of its own. An exception can be raised in it at any line of Python,
    and loops in C++ also run lines of Python (bindings.hpp). Both callables are called in the thread of the caller.
    """
    if progress is not None and not callable(progress):
        require_type(progress, Callable, "a callable", "progress")
    if cancel is None:
        return work(progress or (lambda text: None))
    is_cancelled = getattr(cancel, "is_set", cancel)
    require_type(is_cancelled, Callable, "a callable or an event", "cancel")
    messages, outcome = deque(maxlen=1), []

    def run_work() -> None:
        try:
            outcome.append((work(messages.append), None))
        except BaseException as problem:
            outcome.append((None, problem))

    def poll() -> None:
        if is_cancelled():
            raise CancelledError("cancelled")
        if progress is not None and messages:
            progress(messages.pop())

    poll()
    thread = threading.Thread(target=run_work, name="brushsvg", daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            poll()
            thread.join(POLL_INTERVAL_S)
    except BaseException:
        _stop_thread(thread)
        raise
    result, problem = outcome[0]
    if problem is not None:
        raise problem
    return result


def _stop_thread(thread: threading.Thread) -> None:
    """Raise an exception in the thread until it ends or MAX_CANCEL_WAIT_S is over.

    A thread that does not end in that time ends on its own later. It writes nothing.
    """
    end = time.monotonic() + MAX_CANCEL_WAIT_S
    while thread.is_alive() and time.monotonic() < end:
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(_WorkCancelled))
        # The exception is lost where Python ignores exceptions, as in a destructor: raise it again.
        thread.join(MAX_CANCEL_WAIT_S / 4)
