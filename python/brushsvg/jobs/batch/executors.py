"""Executors for a batch: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager

from ...errors import Error, missing_packages_error

MAX_SCHEDULER_WAIT_S = 10  # how long to wait for an answer of the scheduler, in seconds


@contextmanager
def start_processes(jobs: int) -> Iterator[Executor]:
    """Yield an executor with this number of processes.

    The processes end with the context, even in the middle of their work, and also if this process is killed. For
    this, each worker holds one end of a pipe, and only this process holds the other end.
    """
    methods = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    worker_end, own_end = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(jobs, context, initializer=_end_with_parent, initargs=(worker_end,))
    try:
        yield pool
    except BaseException:
        own_end.close()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    else:
        pool.shutdown()
    finally:
        own_end.close()
        worker_end.close()


def _end_with_parent(pipe) -> None:
    """End this worker process when its parent closes the pipe or dies.

    Ctrl-C is ignored here, because the parent handles it.
    """
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)

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
        sentence = f"no scheduler answers there: {str(problem).splitlines()[0][:200]}"
        raise Error(sentence, file=address, code="cluster-unreachable") from None
    with client:
        yield client.get_executor()
