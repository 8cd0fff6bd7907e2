"""Engine that spreads tasks over the workers of a Dask cluster, which share a folder."""

import json
import logging
import re
import threading
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.campaign.engines import CampaignError, Report, Task
from contact_study.campaign.memory import set_share
from contact_study.inputs.errors import InputError
from contact_study.version import __version__

_TIMEOUT = "10s"  # for the answer of a scheduler


def check(scheduler: str | None) -> None:
    """Raise InputError unless Dask is installed, the scheduler answers and its workers run this version."""
    with _client(scheduler) as client:
        try:
            versions = set(client.run(_version).values())
        except Exception as error:
            raise InputError(
                f"--scheduler {scheduler}: its workers cannot import this program ({error}); start them where it is"
            ) from None
        others = versions - {__version__}
        if others:
            raise InputError(
                f"--scheduler {scheduler}: its workers have version {', '.join(sorted(others))}, this is {__version__}"
            )


def run(tasks: Sequence[Task], workers: int, report: Report, scheduler: str | None = None) -> None:
    """Run every task, the last ones first, at most so many at a time."""
    from distributed import KilledWorker, as_completed
    from distributed.client import FutureCancelledError

    topic = f"contact-study-{uuid.uuid4()}"
    with _client(scheduler) as client:
        client.subscribe_topic(topic, lambda event: report(*json.loads(event[1])))
        # The last case of a sweep usually takes longest (strongest adhesion), so it starts first.
        waiting = [(_run_reporting, task, topic) for task in tasks]
        first = [client.submit(*waiting.pop(), pure=False) for _ in range(min(workers, len(waiting)))]
        running = as_completed(first, loop=client.loop)
        try:
            for finished in running:
                finished.result()
                if waiting:
                    running.add(client.submit(*waiting.pop(), pure=False))
        except KilledWorker:
            raise CampaignError("a case has lost its worker several times (out of memory?)") from None
        except FutureCancelledError:
            raise CampaignError(f"the Dask scheduler at {scheduler} no longer answers") from None


@contextmanager
def _client(scheduler: str | None) -> Iterator[Any]:
    if not scheduler:
        raise InputError("--engine dask: needs --scheduler ADDRESS, such as tcp://node1:8786, or the scheduler's file")
    try:
        from distributed import Client
    except ImportError:
        raise InputError("--engine dask: needs Dask; pip install '.[dask]'") from None
    for name in logging.root.manager.loggerDict:  # Dask gives each its own level
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)
    where = _client_arguments(scheduler)
    try:
        client = Client(**where, timeout=_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        reason = "no answer" if isinstance(error, TimeoutError) else str(error).splitlines()[0]
        raise InputError(f"--scheduler {scheduler}: does not answer ({reason})") from None
    try:
        yield client
    finally:
        with suppress(Exception):  # the scheduler may be gone
            client.close(timeout=2)  # cancels the remaining tasks


def _client_arguments(scheduler: str) -> dict[str, str]:
    """Check the arguments of Dask's client, which waits half a minute for a wrong address."""
    path = Path(scheduler)
    if path.is_file():
        try:
            json.loads(path.read_text(encoding="utf-8"))["address"]
        except (OSError, ValueError, KeyError, TypeError):
            raise InputError(
                f"--scheduler {scheduler}: is no file of a scheduler (dask scheduler --scheduler-file)"
            ) from None
        return {"scheduler_file": scheduler}
    if not re.search(r":\d+$", scheduler):
        raise InputError(
            f"--scheduler {scheduler}: does not answer (no such file, and no address with a port, tcp://node1:8786)"
        )
    return {"address": scheduler}


def _version() -> str:
    return __version__


# Warnings are caught for a whole process, so a worker of several threads runs one case at a time.
_ONE_CASE = threading.Lock()


def _run_reporting(task: Task, topic: str) -> None:
    from distributed import get_worker

    worker = get_worker()
    set_share(worker.memory_manager.memory_limit)  # its nanny kills it beyond
    key = worker.get_current_task()

    def report(*event: Any) -> None:
        # A cancelled task, such as one of a killed run, cannot be stopped from outside and ends itself.
        known = worker.state.tasks.get(key)
        if known is None or known.state not in ("executing", "long-running"):
            raise RuntimeError("the task was cancelled")
        # As text: anyone who reaches the scheduler may write to the topic, and pickles would be executed.
        worker.log_event(topic, json.dumps(event, default=np.generic.item))

    with _ONE_CASE:
        task(report)
