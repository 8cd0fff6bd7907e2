"""Engine that spreads tasks over processes of this machine, this one included."""

import multiprocessing as mp
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any

from contact_study.campaign.engines.base import CampaignError, Report, Task


def run(tasks: Sequence[Task], workers: int, report: Report) -> None:
    """Run every task, the last ones first; a single worker is a process beside this one."""
    # Forking a process with FFTW plans and compiled kernels is not safe everywhere.
    context = mp.get_context("spawn")
    queue = context.Queue()
    reporting = threading.Lock()

    def forward(*event: Any) -> None:
        with reporting:
            report(*event)

    listener = threading.Thread(target=_listen, args=(queue, forward), daemon=True)
    listener.start()
    executor = ProcessPoolExecutor(max(1, workers - 1), context, _start_worker, (queue,))
    # The last case of a sweep usually takes longest (strongest adhesion), so it starts first.
    shared = _SharedTasks(tasks, executor)

    def own_step(*event: Any) -> None:
        forward(*event)
        shared.check()

    try:
        own = shared.next_task() if workers > 1 else None
        with _blocked_interrupts():  # workers inherit this: the parent alone handles Ctrl-C
            for _ in range(workers - 1 if workers > 1 else len(tasks)):
                shared.submit()
        while own is not None:
            own(own_step)
            own = shared.next_task()
        shared.finish()
        executor.shutdown()  # a worker sends its last reports first
    except BrokenProcessPool:
        raise CampaignError("a worker process was killed (out of memory?)") from None
    except BaseException:
        shared.drop()
        for child in mp.active_children():
            child.terminate()
        raise
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        queue.put(None)
        listener.join(timeout=5)


class _SharedTasks:
    """Tasks that this process and those of an executor run one after the other, the last one first."""

    def __init__(self, tasks: Sequence[Task], executor: ProcessPoolExecutor):
        self._waiting = list(tasks)
        self._executor = executor
        self._submitted: list[Future[None]] = []
        self._lock = threading.Lock()

    def next_task(self) -> Task | None:
        """Remove and return the next task; None if none is left."""
        with self._lock:
            return self._waiting.pop() if self._waiting else None

    def submit(self, before: "Future[None] | None" = None) -> None:
        """Submit the next task to the executor, and after it another one unless it failed."""
        if before is not None and (before.cancelled() or before.exception() is not None):
            return
        with self._lock:
            if not self._waiting:
                return
            try:
                future = self._executor.submit(_run_queued, self._waiting.pop())
            except BrokenProcessPool:  # the running tasks raise it
                return
            self._submitted.append(future)
        future.add_done_callback(self.submit)

    def check(self) -> None:
        """Raise the error of a task that has failed in another process."""
        for future in self._submitted:
            if future.done():
                future.result()

    def finish(self) -> None:
        """Wait for the tasks in other processes; raises the first error."""
        for future in as_completed(self._submitted):
            future.result()

    def drop(self) -> None:
        """Start no more tasks."""
        with self._lock:
            self._waiting.clear()


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


def _listen(queue: Any, report: Report) -> None:
    while (event := queue.get()) is not None:
        report(*event)


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
