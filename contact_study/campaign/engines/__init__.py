"""Engines, which run the cases of a study: one file each, imported by its first use.

They know tasks and reports, and nothing of studies, models or files.
"""

import importlib
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from contact_study.campaign.engines.base import CampaignError, Engine, Report, Task
from contact_study.inputs.errors import InputError

__all__ = ["ENGINES", "CampaignError", "check", "run"]


def _call(name: str, function: str, *arguments: Any, **options: Any) -> None:
    getattr(importlib.import_module(f"{__name__}.{name}"), function)(*arguments, **options)


ENGINES: dict[str, Callable[..., None]] = {
    name: partial(_call, name, "run") for name in ("serial", "processes", "dask")
}
# Check of an engine on other machines, at the address of a scheduler.
REMOTE: dict[str, Callable[..., None]] = {"dask": partial(_call, "dask", "check")}


def check(engine: str | None, scheduler: str | None) -> None:
    """Make sure, before any work, that an engine is available.

    Raises
    ------
    InputError
        If there is no such engine, or its scheduler does not answer.
    """
    if engine is not None and engine not in ENGINES:
        raise InputError(f"engine {engine!r}: expected one of {', '.join(ENGINES)}")
    if engine in REMOTE:
        REMOTE[engine](scheduler)
    elif scheduler is not None:
        raise InputError(f"--scheduler {scheduler}: goes with --engine {' or '.join(REMOTE)}")


def run(
    tasks: Sequence[Task], workers: int, report: Report, engine: str | None = None, scheduler: str | None = None
) -> None:
    """Run every task by an engine; without a name in this process, or in several for more than one worker.

    Raises
    ------
    InputError
        If there is no such engine.
    CampaignError
        If a worker died.
    """
    name = engine or ("processes" if workers > 1 else "serial")
    if name not in ENGINES:
        raise InputError(f"engine {name!r}: expected one of {', '.join(ENGINES)}")
    chosen: Engine = partial(ENGINES[name], scheduler=scheduler) if name in REMOTE else ENGINES[name]
    if tasks:
        chosen(tasks, max(1, workers), report)
