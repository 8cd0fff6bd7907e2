"""What every engine owes: each task once, its reports here, the first error raised."""

import os
from functools import partial

import pytest

from contact_study.campaign import engines
from contact_study.campaign.engines import ENGINES, REMOTE, CampaignError
from contact_study.problem.errors import InputError
from tests.campaign.tasks import die, fail, square

LOCAL = [name for name in ENGINES if name not in REMOTE]  # tests/campaign/test_dask.py has the others


@pytest.mark.parametrize("name", LOCAL)
def test_every_task_is_run_once_and_reports_here(name):
    reports = []
    engines.run([partial(square, number) for number in range(5)], 2, lambda *event: reports.append(event), name)
    values = sorted(value for number, value in reports if value == number**2)
    assert values == [0, 1, 4, 9, 16]
    assert len(reports) == 10
    elsewhere = {pid for number, pid in reports if pid != number**2} - {os.getpid()}
    assert bool(elsewhere) == (name == "processes")


@pytest.mark.parametrize("name", LOCAL)
def test_error_of_a_task_is_raised_here(name):
    with pytest.raises(ValueError, match="broken"):
        engines.run([partial(square, 1), fail], 2, lambda *_: None, name)


def test_worker_that_dies_is_said():
    with pytest.raises(CampaignError, match="a worker process was killed"):
        engines.run([die], 1, lambda *_: None, "processes")


@pytest.mark.parametrize(("workers", "here"), [(0, True), (1, True), (2, False)])
def test_engine_follows_from_the_workers(workers, here):
    pids = []
    engines.run([partial(square, 7)], workers, lambda _, value: pids.append(value))
    assert (pids[1] == os.getpid()) == here


def test_nothing_to_do_starts_nothing(monkeypatch):
    monkeypatch.setitem(ENGINES, "processes", None)
    engines.run([], 4, print)


def test_unknown_engine_is_refused():
    with pytest.raises(InputError, match="engine 'cloud': expected one of serial, processes, dask"):
        engines.run([partial(square, 1)], 1, print, "cloud")
