"""Work that other threads begin before it is asked for: compiled steps run without the interpreter's lock."""

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

Result = TypeVar("Result")


class BackgroundTask(Generic[Result]):
    """Work that is done once, by the thread that comes first."""

    def __init__(self, ahead: "BackgroundExecutor", work: Callable[[], Result]):
        self._ahead, self._work = ahead, work
        self._claim = threading.Lock()
        self._future: Future[Result] = Future()

    def result(self) -> Result:
        """Return the result of the work or raise its error; meanwhile this thread does other waiting work."""
        self.do()
        while not self._future.done() and (other := self._ahead.take()) is not None:
            other.do()
        return self._future.result()

    def do(self) -> None:
        """Do the work, unless that is done or being done."""
        if not self._claim.acquire(blocking=False):
            return
        try:
            self._future.set_result(self._work())
        except BaseException as error:
            self._future.set_exception(error)
            if not isinstance(error, Exception):  # an interrupt is nobody's result
                raise


class BackgroundExecutor:
    """Threads beside the one that asks, which counts as one; work may not catch warnings, which a process shares."""

    def __init__(self, threads: int):
        self._others = threads - 1
        self._waiting: deque[BackgroundTask] = deque()
        self._lock = threading.Lock()

    def begin(self, work: Callable[[], Result]) -> BackgroundTask[Result]:
        """Work to be done as soon as a thread is free, first come, first served."""
        piece = BackgroundTask(self, work)
        with self._lock:
            if self._others > 0:
                self._others -= 1
                # Nobody waits for it at the end of an interrupted process.
                threading.Thread(target=self._serve, args=(piece,), daemon=True).start()
            else:
                self._waiting.append(piece)
        return piece

    def take(self) -> BackgroundTask | None:
        """The next piece that waits, which whoever takes it is to do."""
        with self._lock:
            return self._waiting.popleft() if self._waiting else None

    def _serve(self, piece: BackgroundTask | None) -> None:
        while piece is not None:
            piece.do()
            with self._lock:
                piece = self._waiting.popleft() if self._waiting else None
                self._others += piece is None
