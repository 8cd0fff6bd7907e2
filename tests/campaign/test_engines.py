"""What every engine owes: each task once, its reports here, the first error raised."""

import os
from functools import partial

import pytest

from contact_study.campaign import engines
from contact_study.campaign.engines import ENGINES, REMOTE, CampaignError
from tests.campaign.tasks import die, fail, leave, meet, report_on, square, wait_for

LOCAL = [name for name in ENGINES if name not in REMOTE]  # tests/campaign/test_dask.py has the others


@pytest.mark.parametrize("name", LOCAL)
def test_every_task_is_run_once_and_reports_here(name):
    reports = []
    engines.run([partial(square, number) for number in range(5)], 2, lambda *event: reports.append(event), name)
    values = sorted(value for number, value in reports if value == number**2)
    assert values == [0, 1, 4, 9, 16]
    assert len(reports) == 10
    with pytest.raises(ValueError, match="broken"):
        engines.run([partial(square, 1), fail], 2, lambda *_: None, name)


def test_processes_run_tasks_at_the_same_time_one_of_them_here(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    pids = []
    engines.run([partial(meet, one, two), partial(meet, two, one)], 2, pids.append, "processes")
    assert len(set(pids)) == 2
    assert os.getpid() in pids


def test_tasks_that_wait_go_to_the_process_that_is_free(tmp_path):
    ended, counted = tmp_path / "ended", []
    tasks = [partial(leave, ended), *[partial(square, number) for number in range(3)], partial(wait_for, ended)]
    engines.run(tasks, 2, lambda *event: counted.append(event), "processes")
    assert {number**2 for number in range(3)} <= {event[1] for event in counted if len(event) == 2}
    assert ("ended",) in counted


@pytest.mark.parametrize("others", [[], [partial(report_on, 60)]])
def test_worker_that_dies_ends_what_this_process_is_at(others):
    with pytest.raises(CampaignError, match="a worker process was killed"):
        engines.run([die, *others], 1 + len(others), lambda *_: None, "processes")


@pytest.mark.parametrize(("workers", "name"), [(0, "serial"), (1, "serial"), (2, "processes")])
def test_engine_follows_from_the_workers(monkeypatch, workers, name):
    chosen = []
    monkeypatch.setitem(ENGINES, name, lambda *given: chosen.append(given[1]))
    engines.run([partial(square, 7)], workers, print)
    assert chosen == [max(1, workers)]
    engines.run([], 4, print)
    assert len(chosen) == 1, "nothing to do starts nothing"
