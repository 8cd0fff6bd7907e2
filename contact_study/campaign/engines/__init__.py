"""Engines, which run the cases of a study: they have tasks and reports, and nothing of studies, models or files."""

import importlib
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from contact_study.inputs.errors import InputError

__all__ = ["ENGINES", "CampaignError", "check", "run"]

# A task writes its own results to disk and can be pickled. An engine ``run(tasks, workers, report)`` passes every
# report to ``report`` in this process and raises the first error of a task here, at the next report of a task that runs
# here. It ends the tasks on an interrupt. No task outlives this process, or on another machine its next step, so it
# cannot write beside a resumed run. A worker that dies is replaced, or raises a CampaignError.
Report = Callable[..., Any]
Task = Callable[[Report], None]


class CampaignError(RuntimeError):
    """A campaign that cannot continue; finished steps are kept."""


def _imported(name: str, *arguments: Any, **options: Any) -> None:
    importlib.import_module(f"{__name__}.{name}").run(*arguments, **options)


def _serial(tasks: Sequence[Task], workers: int, report: Report) -> None:
    for task in tasks:
        task(report)


ENGINES: dict[str, Callable[..., None]] = {
    "serial": _serial,
    "processes": partial(_imported, "processes"),
    "dask": partial(_imported, "dask"),
}
REMOTE = "dask"  # on other machines, at the address of a scheduler


def check(engine: str | None, scheduler: str | None) -> None:
    """Raise InputError, before any work, unless an engine is available and its scheduler answers."""
    if engine is not None and engine not in ENGINES:
        raise InputError(f"engine {engine!r}: expected one of {', '.join(ENGINES)}")
    if engine == REMOTE:
        from contact_study.campaign.engines import dask

        dask.check(scheduler)
    elif scheduler is not None:
        raise InputError(f"--scheduler {scheduler}: goes with --engine {REMOTE}")


def run(
    tasks: Sequence[Task], workers: int, report: Report, engine: str | None = None, scheduler: str | None = None
) -> None:
    """Run every task by an engine; without a name in this process, or in several for more than one worker."""
    name = engine or ("processes" if workers > 1 else "serial")
    options = {"scheduler": scheduler} if name == REMOTE else {}
    if tasks:
        ENGINES[name](tasks, max(1, workers), report, **options)
