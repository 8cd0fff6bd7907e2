"""What an engine is: it calls every task once, somewhere, and hands on what they report."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

Report = Callable[..., Any]
Task = Callable[[Report], None]


class CampaignError(RuntimeError):
    """A campaign that could not go on; finished steps are kept."""


class Engine(Protocol):
    """Runs tasks.

    A task keeps its own results on disk as they come. What an engine owes besides: every report reaches ``report`` in
    this process; the first error of a task ends the campaign and is raised here, at the next report where this process
    runs tasks itself; an interrupt of this process ends the tasks; no task outlives this process, or on another machine
    its next step, lest it write beside the one that resumes the run; and a worker that dies is replaced or a
    :class:`CampaignError`.
    """

    def __call__(self, tasks: Sequence[Task], workers: int, report: Report) -> None:
        """Run every task on at most so many workers; tasks can be pickled."""
