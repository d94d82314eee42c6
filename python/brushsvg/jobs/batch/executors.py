"""Where drawings of a batch are converted: processes of this machine, or a cluster of Dask's."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager

from ...errors import Error, lacking

MAX_SCHEDULER_WAIT_S = 10  # for a scheduler to answer


@contextmanager
def start_processes(jobs: int) -> Iterator[Executor]:
    """As many processes. They end when the context does, in the middle of what they do, and where this process is
    killed: each holds an end of a pipe, whose other end is here alone."""
    methods = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    theirs, ours = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(jobs, context, initializer=_end_with_parent, initargs=(theirs,))
    try:
        yield pool
    except BaseException:
        ours.close()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    else:
        pool.shutdown()
    finally:
        ours.close()
        theirs.close()


def _end_with_parent(pipe) -> None:
    """In a worker: Ctrl-C is its parent's."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def wait() -> None:
        pipe.poll(None)
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


@contextmanager
def connect_cluster(address: str) -> Iterator[Executor]:
    """The workers of a scheduler of Dask's."""
    try:
        from dask.distributed import Client
    except ImportError:
        raise lacking("a cluster needs", "distributed") from None
    try:
        client = Client(address, timeout=MAX_SCHEDULER_WAIT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as problem:
        sentence = f"no scheduler answers there: {str(problem).splitlines()[0][:200]}"
        raise Error(sentence, file=address, code="cluster-unreachable") from None
    with client:
        yield client.get_executor()
