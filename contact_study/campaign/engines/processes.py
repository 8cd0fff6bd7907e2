"""Engine that spreads tasks over processes of this machine, this one included."""

import multiprocessing as mp
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing.connection import wait
from typing import Any

from contact_study.campaign.engines import CampaignError, Report, Task


def run(tasks: Sequence[Task], workers: int, report: Report) -> None:
    """Run every task, the last ones first; a single worker is a process beside this one."""
    # Forking a process with FFTW plans and compiled kernels is not safe everywhere.
    context = mp.get_context("spawn")
    queue = context.Queue()
    reporting, sharing = threading.Lock(), threading.RLock()
    waiting, submitted = list(tasks), list[Future[None]]()

    def forward(*event: Any) -> None:
        with reporting:
            report(*event)

    def listen() -> None:
        for event in iter(queue.get, None):
            forward(*event)

    def own_step(*event: Any) -> None:
        forward(*event)
        for future in submitted:
            if future.done():
                future.result()

    # The last case of a sweep usually takes longest (strongest adhesion), so it starts first.
    def next_task() -> Task | None:
        with sharing:
            return waiting.pop() if waiting else None

    def submit(before: Future[None] | None = None) -> None:
        """Submit the next task to the executor, and after it another one unless it failed."""
        if before is not None and (before.cancelled() or before.exception() is not None):
            return
        with sharing, suppress(BrokenProcessPool):  # the running tasks raise it
            if waiting:
                submitted.append(executor.submit(_run_queued, waiting.pop()))
                submitted[-1].add_done_callback(submit)

    listener = threading.Thread(target=listen, daemon=True)
    listener.start()
    executor = ProcessPoolExecutor(max(1, workers - 1), context, _start_worker, (queue,))
    try:
        own = next_task() if workers > 1 else None
        with _blocked_interrupts():  # workers inherit this: the parent alone handles Ctrl-C
            for _ in range(workers - 1 if workers > 1 else len(tasks)):
                submit()
        while own is not None:
            own(own_step)
            own = next_task()
        for future in as_completed(submitted):
            future.result()
        executor.shutdown()  # a worker sends its last reports first
    except BrokenProcessPool:
        raise CampaignError("a worker process was killed (out of memory?)") from None
    except BaseException:
        with sharing:
            waiting.clear()
        for child in mp.active_children():
            child.terminate()
        raise
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        queue.put(None)
        listener.join(timeout=5)


@contextmanager
def _blocked_interrupts() -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


_queue: Any = None


def _start_worker(queue: Any) -> None:
    global _queue
    _queue = queue
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where interrupts cannot be blocked
    threading.Thread(target=_die_with_parent, daemon=True).start()


def _die_with_parent() -> None:
    # A worker of a killed campaign would write beside the resumed one.
    parent = mp.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def _run_queued(task: Task) -> None:
    task(lambda *event: _queue.put(event))
