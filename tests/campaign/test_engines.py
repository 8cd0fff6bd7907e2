import os
import pickle
import signal
import socket
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import pytest

from contact_study.campaign import engines
from contact_study.campaign.engines import ENGINES, CampaignError
from contact_study.inputs.errors import InputError
from tests.campaign.tasks import die, fail, finish, leave, meet, report_on, square, states, wait_for
from tests.campaign.toy_study import TABLE, assert_same, names

pytestmark = pytest.mark.filterwarnings("ignore")  # Dask's own, on its way down


def started(workers, **options):
    distributed = pytest.importorskip("distributed")
    return distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, dashboard_address=":0", silence_logs=50, **options
    )


@pytest.fixture(scope="module")
def cluster():
    with started(2) as local:
        yield local


def on(cluster, tasks, report=lambda *_: None, workers=4):
    engines.run(tasks, workers, report, "dask", cluster.scheduler_address)


@pytest.mark.validation
@pytest.mark.parametrize("name", ENGINES)
def test_every_task_is_run_once_and_reports_here(name, request):
    scheduler = request.getfixturevalue("cluster").scheduler_address if name == "dask" else None
    reports = []
    tasks = [partial(square, number) for number in range(5)]
    engines.run(tasks, 2, lambda *event: reports.append(event), name, scheduler)
    assert sorted(value for number, value in reports if value == number**2) == [0, 1, 4, 9, 16]
    assert len(reports) == 10
    assert name != "dask" or os.getpid() not in {value for _, value in reports}
    with pytest.raises(ValueError, match="broken"):
        engines.run([partial(square, 1), fail], 2, lambda *_: None, name, scheduler)


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


def test_engine_follows_from_the_workers(monkeypatch):
    chosen = []
    for name in ("serial", "processes"):
        monkeypatch.setitem(ENGINES, name, lambda *given, name=name: chosen.append((name, given[1])))
    for workers in (0, 1, 2):
        engines.run([partial(square, 7)], workers, print)
    engines.run([], 4, print)  # nothing to do starts nothing
    assert chosen == [("serial", 1), ("serial", 1), ("processes", 2)]


def test_no_more_tasks_at_once_than_asked_for(cluster, tmp_path):
    begun = []

    def report(word):
        begun.append(word)
        if word == "begun" and begun.count("begun") == 1:
            threading.Timer(0.5, (tmp_path / "first").touch).start()

    on(cluster, [partial(wait_for, tmp_path / "first"), partial(wait_for, tmp_path / "first")], report, 1)
    assert begun == ["begun", "seen", "ended"] * 2


def test_tasks_nobody_waits_for_end_themselves(cluster, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        on(cluster, [partial(wait_for, tmp_path / "go")], lambda _: signal.raise_signal(signal.SIGINT))
    with pytest.importorskip("distributed").Client(cluster) as client:
        deadline = time.monotonic() + 30
        while "executing" in str(client.run(states)) and time.monotonic() < deadline:
            time.sleep(0.02)  # for the news to reach the worker
        (tmp_path / "go").touch()
        client.run(finish)
    assert not (tmp_path / "ended").exists()


@pytest.fixture
def dask(run):
    def on_cluster(address, *arguments, output="dask.nc"):
        where = ("--engine", "dask", "--scheduler", str(getattr(address, "scheduler_address", address)))
        return run(TABLE, *where, *arguments, "--workers", "4", output=output)

    return on_cluster


@pytest.mark.validation
def test_numbers_are_those_of_one_machine(cluster, dask, built, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # a relative path is the client's, not the workers'
    status, _, said = dask(cluster, "-o", "dask.nc")
    assert status == 0
    lines = [line for line in said.splitlines() if "contact area" in line]
    assert len(lines) == 14
    assert lines[-1].startswith("toy: [14/14] ")
    assert_same(built(TABLE), tmp_path / "dask.nc")


@pytest.mark.validation
def test_a_case_that_kills_its_workers_is_given_up():
    with started(1) as local:
        with pytest.raises(CampaignError, match="has lost its worker several times"):
            on(local, [die])
        # A cluster that is closed while it replaces a worker fails by itself.
        with pytest.importorskip("distributed").Client(local) as client:
            client.wait_for_workers(1, timeout=60)


def test_events_are_read_and_not_executed(cluster, tmp_path):
    sprung = tmp_path / "sprung"
    seen = []

    class Trap:
        def __reduce__(self):
            return Path.touch, (sprung,)

    def report(*event):
        seen.append(event)
        if event == ("begun",):
            topic = next(topic for topic in cluster.scheduler.get_events() if topic.startswith("contact-study-"))
            for word in (pickle.dumps(Trap()), "no JSON"):
                cluster.scheduler.log_event(topic, word)
            (tmp_path / "go").touch()

    on(cluster, [partial(wait_for, tmp_path / "go")], report)
    assert ("ended",) in seen
    assert not sprung.exists()


@pytest.mark.validation
def test_a_case_beyond_the_memory_of_a_worker_is_told_by_it(dask, tmp_path):
    with started(1, memory_limit="1 GB") as local:
        status, _, said = dask(local, "--surface.shape", "[4000, 4000]", "--output.fields", "false")
    assert status == 1
    words = f"needs at least 1.6 GB of memory, a Dask worker on {socket.gethostname()} has 1 GB"
    assert f"surface.shape = [4000, 4000]: {words}" in said.splitlines()[-1]
    assert names(tmp_path) == []


@pytest.mark.validation
def test_a_scheduler_that_is_lost_is_one_line(study, tmp_path):
    file = tmp_path / "scheduler.json"
    here = {**os.environ, "PYTHONPATH": os.getcwd(), "TOY_SECONDS": "1"}
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--scheduler-file", file, "--port", "0"]
    scheduler = subprocess.Popen([*dask, "--no-dashboard"], stderr=subprocess.DEVNULL)
    dask = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", file, "--no-nanny"]
    worker = subprocess.Popen([*dask, "--no-dashboard"], stderr=subprocess.DEVNULL, env=here)
    try:
        program = "from contact_study.campaign.engines import dask; dask._TIMEOUT = '5s'\n"
        program += "from tests.campaign.toy_model import main; main()"
        toy = [sys.executable, "-c", program, study, "-o", tmp_path / "bem.nc", "--engine", "dask", "--scheduler", file]
        lines = []
        with subprocess.Popen([*map(str, toy)], stderr=subprocess.PIPE, text=True, env=here) as asked:
            for line in asked.stderr:
                lines.append(line)
                if "[2/14]" in line:
                    scheduler.kill()
        assert f"error: the Dask scheduler at {file} no longer answers; " in lines[-1]
        assert "of 14 steps are finished and kept, --resume continues" in lines[-1]
        assert all("contact area" in line for line in lines[:-1])
    finally:
        for process in (scheduler, worker):
            process.kill()
            process.wait()


def test_schedulers_that_are_none_and_workers_of_another_version(cluster, run, study, tmp_path, monkeypatch):
    monkeypatch.setattr("contact_study.campaign.engines.dask._TIMEOUT", "0.5s")
    monkeypatch.setattr("contact_study.campaign.engines.dask.__version__", "9.9")
    dask = ("--engine", "dask")
    for arguments, words in (
        ((*dask, "--scheduler", "tcp://127.0.0.1:9"), "--scheduler tcp://127.0.0.1:9: does not answer"),
        ((*dask, "--scheduler", "none.json"), "--scheduler none.json: does not answer (no such file"),
        ((*dask, "--scheduler", str(study)), "study.toml: is no file of a scheduler"),
        ((*dask, "--scheduler", cluster.scheduler_address), "this is 9.9"),
        (dask, "--engine dask: needs --scheduler ADDRESS"),
        (("--scheduler", "x"), "--scheduler x: goes with --engine dask"),
    ):
        status, _, said = run(TABLE, *arguments)
        assert (status, said.count("\n"), names(tmp_path)) == (1, 1, [])
        assert words in said


def test_folder_that_is_not_shared_is_said(run, monkeypatch):
    with monkeypatch.context() as patch:
        there = Path.is_dir
        patch.setattr(Path, "is_dir", lambda path: there(path) and not path.name.endswith(".parts"))
        status, _, said = run(TABLE)
        assert status == 1
        assert "bem.nc.parts does not exist on " in said
    monkeypatch.setitem(ENGINES, "serial", lambda *_: None)
    status, _, said = run(TABLE, "--engine", "serial", "--resume")
    assert status == 1
    assert "a worker has finished steps that are not here" in said


@pytest.mark.validation
@pytest.mark.parametrize(("arguments", "imported"), [((), "False\n"), (("--engine", "dask"), "True\n")])
def test_a_command_imports_dask_only_where_it_is_asked_for(arguments, imported):
    program = "import sys; from tests.campaign.toy_model import main; main(); "
    program += "print(sys.modules.get('dask', 'may be imported') is not None)"
    command = [sys.executable, "-c", program, "none.toml", "-o", "none.nc", *arguments]
    assert subprocess.run(command, capture_output=True, text=True).stdout == imported


def test_without_dask_it_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install '\.\[dask\]'"):
        engines.check("dask", "tcp://127.0.0.1:8786")
