"""Where the cases of a study are run: one file for each way, chosen by its name from one table."""

from collections.abc import Callable, Sequence
from functools import partial

from contact_study.campaign.engines import dask, processes, serial
from contact_study.campaign.engines.base import CampaignError, Engine, Report, Task
from contact_study.errors import InputError

__all__ = ["ENGINES", "CampaignError", "check", "run"]

ENGINES: dict[str, Callable[..., None]] = {
    "serial": serial.run,
    "processes": processes.run,
    "dask": dask.run,
}
# Those that run on machines of their own, at the address of a scheduler; what makes sure that one answers.
REMOTE = {"dask": dask.check}


def check(engine: str | None, scheduler: str | None) -> None:
    """Make sure, before any work, that an engine can be had.

    Raises
    ------
    InputError
        If there is no such engine, or it has no scheduler that answers.
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
    """Run every task by an engine; without a name in this process, or where there are more workers in processes.

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
