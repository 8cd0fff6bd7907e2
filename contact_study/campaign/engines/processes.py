"""Tasks over processes of this machine, this one among them: its imports are done when others begin theirs."""

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
    """Run every task, the last ones first; one worker alone is a process beside this one."""
    # Fresh interpreters: forking a process that holds FFTW plans and compiled kernels is not safe everywhere.
    context = mp.get_context("spawn")
    queue = context.Queue()
    reporting = threading.Lock()

    def told(*event: Any) -> None:
        with reporting:
            report(*event)

    listener = threading.Thread(target=_listen, args=(queue, told), daemon=True)
    listener.start()
    executor = ProcessPoolExecutor(max(1, workers - 1), context, _start_worker, (queue,))
    # The last case of a sweep is usually the hardest (strongest adhesion): started first, it is not waited for.
    shared = _Shared(tasks, executor)

    def own_step(*event: Any) -> None:
        told(*event)
        shared.check()

    try:
        own = shared.take() if workers > 1 else None
        with _interrupts_held():  # Ctrl-C reaches the workers too, but is the parent's to handle: they inherit this
            for _ in range(workers - 1 if workers > 1 else len(tasks)):
                shared.submit()
        while own is not None:
            own(own_step)
            own = shared.take()
        shared.finish()
        executor.shutdown()  # a worker sends its last reports before it ends
    except BrokenProcessPool:
        raise CampaignError("a worker process was killed (out of memory?); finished steps are kept") from None
    except BaseException:
        shared.drop()
        for child in mp.active_children():
            child.terminate()
        raise
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        queue.put(None)
        listener.join(timeout=5)


class _Shared:
    """Tasks that this process and those of an executor take one after the other, the last one first."""

    def __init__(self, tasks: Sequence[Task], executor: ProcessPoolExecutor):
        self._waiting = list(tasks)
        self._executor = executor
        self._submitted: list[Future[None]] = []
        self._lock = threading.Lock()

    def take(self) -> Task | None:
        """The next task; None if there is none left."""
        with self._lock:
            return self._waiting.pop() if self._waiting else None

    def submit(self, before: "Future[None] | None" = None) -> None:
        """Give the next task, if there is one, to the executor; after it, unless it failed, another one."""
        if before is not None and (before.cancelled() or before.exception() is not None):
            return
        with self._lock:
            if not self._waiting:
                return
            try:
                future = self._executor.submit(_run_queued, self._waiting.pop())
            except BrokenProcessPool:  # which the tasks that were running tell
                return
            self._submitted.append(future)
        future.add_done_callback(self.submit)

    def check(self) -> None:
        """Raise the error of a task that has failed in another process."""
        for future in self._submitted:
            if future.done():
                future.result()

    def finish(self) -> None:
        """Wait for the tasks in other processes, none being left; raises the first error."""
        for future in as_completed(self._submitted):
            future.result()

    def drop(self) -> None:
        """Start no more tasks."""
        with self._lock:
            self._waiting.clear()


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
