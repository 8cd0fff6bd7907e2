"""Tasks over processes of this machine."""

import multiprocessing as mp
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any

from contact_study.campaign.engines.base import CampaignError, Report, Task


def run(tasks: Sequence[Task], workers: int, report: Report) -> None:
    """Run every task, the last ones first."""
    # Fresh interpreters: forking a process that holds FFTW plans and compiled kernels is not safe everywhere.
    context = mp.get_context("spawn")
    queue = context.Queue()
    listener = threading.Thread(target=_listen, args=(queue, report), daemon=True)
    listener.start()
    executor = ProcessPoolExecutor(workers, context, _start_worker, (queue,))
    try:
        with _interrupts_held():  # Ctrl-C reaches the workers too, but is the parent's to handle: they inherit this
            # The last case of a sweep is usually the hardest (strongest adhesion): started first, it is not waited for.
            running = [executor.submit(_run_queued, task) for task in reversed(tasks)]
        for finished in as_completed(running):
            finished.result()
        executor.shutdown()  # a worker sends its last reports before it ends
    except BrokenProcessPool:
        raise CampaignError("a worker process was killed (out of memory?); finished steps are kept") from None
    except BaseException:
        for child in mp.active_children():
            child.terminate()
        raise
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        queue.put(None)
        listener.join(timeout=5)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _listen(queue: Any, report: Report) -> None:
    while (event := queue.get()) is not None:
        report(*event)


_queue: Any = None


def _start_worker(queue: Any) -> None:
    global _queue
    _queue = queue
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where interrupts cannot be held
    threading.Thread(target=_die_with_parent, daemon=True).start()


def _die_with_parent() -> None:
    # A worker that outlived a killed campaign would write beside the one that resumes it.
    parent = mp.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def _run_queued(task: Task) -> None:
    task(lambda *event: _queue.put(event))
