"""Executors for a batch: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager

from ...errors import Error, missing_packages_error

MAX_SCHEDULER_WAIT_S = 10  # how long to wait for an answer of the scheduler, in seconds


NO_WORKER = (
    "no worker process can start, because each one first runs your script again: save it as a file with its calls "
    'below `if __name__ == "__main__":`, or give batch executor=ThreadPoolExecutor()'
)


@contextmanager
def start_processes(jobs: int) -> Iterator[Executor]:
    """Yield an executor with this number of processes.

    The processes end with the context, even in the middle of their work, and also if this process is killed. For
    this, each worker holds one end of a pipe, and only this process holds the other end. A worker that is ready
    writes into its end.

    Raises Error if this process cannot start workers. Replaces the Error worker-lost if no worker was ever ready.
    """
    if getattr(sys.modules["__main__"], "__file__", "") == "<stdin>":
        raise Error(NO_WORKER, code="worker-lost")
    if multiprocessing.current_process().daemon:
        sentence = (
            "a daemonic process, such as one of multiprocessing.Pool, cannot start worker processes: give batch "
            "executor=ThreadPoolExecutor()"
        )
        raise Error(sentence, code="worker-lost")
    methods = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    worker_end, own_end = context.Pipe()
    pool = ProcessPoolExecutor(jobs, context, initializer=_end_with_parent, initargs=(worker_end,))
    try:
        yield pool
    except BaseException as problem:
        was_ready = own_end.poll()
        own_end.close()
        pool.shutdown(wait=False, cancel_futures=True)
        if isinstance(problem, Error) and problem.code == "worker-lost" and not was_ready:
            raise Error(NO_WORKER, code="worker-lost") from None
        raise
    else:
        pool.shutdown()
    finally:
        own_end.close()
        worker_end.close()


def end_repeated_script() -> None:
    """End this process without a word if it is a worker that runs the user's script before its work.

    The script has no `if __name__ == "__main__":`, so each worker would run the whole batch again. multiprocessing
    itself recognizes such a process in this way.
    """
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(1)


def _end_with_parent(pipe) -> None:
    """Report that this worker is ready, ignore Ctrl-C, and end when the parent closes the pipe or dies."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    pipe.send_bytes(b"ready")

    def wait() -> None:
        pipe.poll(None)
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


@contextmanager
def connect_cluster(address: str) -> Iterator[Executor]:
    """Yield an executor that runs on the workers of a Dask scheduler."""
    try:
        from dask.distributed import Client
    except ImportError:
        raise missing_packages_error("a cluster needs", "distributed") from None
    try:
        client = Client(address, timeout=MAX_SCHEDULER_WAIT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as problem:
        sentence = f"no scheduler answers at this address: {str(problem).splitlines()[0][:200]}"
        raise Error(sentence, file=address, code="cluster-unreachable") from None
    with client:
        yield client.get_executor()
