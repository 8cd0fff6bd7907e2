"""Where the cases of a study are run: one file for each way, chosen by its name from one table."""

from collections.abc import Sequence

from contact_study.campaign.engines import processes, serial
from contact_study.campaign.engines.base import CampaignError, Engine, Report, Task
from contact_study.problem.errors import InputError

__all__ = ["ENGINES", "CampaignError", "run"]

ENGINES: dict[str, Engine] = {
    "serial": serial.run,
    "processes": processes.run,
}


def run(tasks: Sequence[Task], workers: int, report: Report, engine: str | None = None) -> None:
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
    if tasks:
        ENGINES[name](tasks, max(1, workers), report)
