"""The interface of an engine."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

Report = Callable[..., Any]
Task = Callable[[Report], None]


class CampaignError(RuntimeError):
    """A campaign that cannot continue; finished steps are kept."""


class Engine(Protocol):
    """Runner of tasks.

    A task writes its own results to disk. The engine passes every report to ``report`` in this process and raises the
    first error of a task here, at the next report of a task that runs here. It ends the tasks on an interrupt. No task
    outlives this process, or on another machine its next step, so it cannot write beside a resumed run. A worker that
    dies is replaced, or raises a :class:`CampaignError`.
    """

    def __call__(self, tasks: Sequence[Task], workers: int, report: Report) -> None:
        """Run every task on at most so many workers; tasks can be pickled."""
