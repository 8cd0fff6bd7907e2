import dataclasses
import socket

import pytest

from contact_study.campaign import engines, memory
from contact_study.campaign import run as runner
from contact_study.campaign.model import MODELS
from contact_study.campaign.record import prepare_run
from contact_study.inputs.errors import InputError
from contact_study.study.study import make_study
from tests.campaign.toy_model import TOY
from tests.campaign.toy_study import changed
from tests.commands import main

NEED = 16 * 16 * 100.0  # of a case of the toy's study


JOB, SLURM = "system.slice/slurmstepd.scope/job_7", "memory/slurm/job_7/memory.limit_in_bytes"


@pytest.mark.parametrize(
    ("own", "limits", "found"),
    [
        (f"0::/{JOB}/step_0/user/task_0\n", {f"{JOB}/memory.max": "4000\n", f"{JOB}/step_0/memory.max": "max\n"}, 4000),
        ("0::/\n", {"memory.max": "5000\n"}, 5000),  # in a container
        ("4:cpu,memory:/slurm/job_7/step_0\n1:pids:/x\n", {SLURM: "6000\n"}, 6000),
        ("4:memory:/slurm/job_7\n", {SLURM: "9223372036854771712\n"}, None),
        (f"0::/{JOB}\n", {f"{JOB}/memory.max": "max\n"}, None),
    ],
)
def test_memory_is_that_of_the_job(tmp_path, monkeypatch, own, limits, found):
    monkeypatch.setattr(memory, "_GROUPS", tmp_path / "groups")
    monkeypatch.setattr(memory, "_OWN_GROUPS", tmp_path / "own")
    machine = memory._memory()
    assert machine > 1e9
    (tmp_path / "own").write_text(own)
    for name, limit in limits.items():
        path = tmp_path / "groups" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(limit)
    assert memory._memory() == (found or machine)
    if found is not None:
        with pytest.raises(InputError, match=f"needs at least 1 GB of memory, the job on {socket.gethostname()} has"):
            memory.require(memory.Need(1e9, "surface.shape = [1, 1]", "fewer points"))


@pytest.fixture
def started(study, tmp_path, monkeypatch):
    def workers_and_threads(table, model, cores, asked):
        found, run = [], engines.run

        def kept(tasks, workers, *rest):
            found.append((workers, tasks[0].args[1]))
            run(tasks, 1, *rest)

        monkeypatch.setattr(runner, "available_cores", lambda: cores)
        study.write_text(make_study(table).toml)
        more = [] if asked is None else ["--workers", str(asked)]
        with monkeypatch.context() as patch:
            patch.setattr(engines, "run", kept)
            assert main(model, [str(study), "-o", str(tmp_path / "bem.nc"), "--overwrite", *more]) == 0
        return found[0]

    return workers_and_threads


def test_no_more_cases_at_once_than_memory_holds(started, monkeypatch):
    for held, asked, workers in ((4.5, None, 2), (1.5, None, 1), (2.5, 2, 2), (2.5, 5, 2)):  # there are two cases
        monkeypatch.setattr(memory, "_memory", lambda held=held: held * NEED)
        assert started(changed(), TOY, 8, asked)[0] == workers


def test_a_case_has_the_cores_that_it_keeps_busy(started):
    table = changed(sweep={"surface.seed": [1, 2]})
    for cores, busy, asked, chosen in (
        (8, 1, None, (4, 2)),  # there are four cases
        (8, 1, 3, (3, 2)),
        (1, 2, None, (1, 1)),
        (2, 2, None, (2, 1)),  # two cases for each process
        (3, 2, None, (1, 3)),
        (5, 2, None, (2, 2)),
        (2, 2, 2, (2, 1)),  # asked for
        (4, 2, 1, (1, 4)),
    ):
        assert started(table, dataclasses.replace(TOY, threads=busy), cores, asked) == chosen


def test_more_workers_than_memory_holds_are_refused(run, tmp_path, monkeypatch):
    monkeypatch.setattr(memory, "_memory", lambda: 1.5 * NEED)
    status, _, said = run(changed(), "--workers", "2")
    assert (status, said.count("\n")) == (1, 1)
    assert "--workers 2: surface.shape = [16, 16]: needs at least 5.12e-05 GB" in said
    assert said.endswith("use --workers 1\n")
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_on_other_machines_each_case_says_so_where_it_runs(monkeypatch):
    run = prepare_run(TOY, make_study(changed()))
    monkeypatch.setattr(memory, "_memory", lambda: 0.5 * NEED)
    assert runner._count_fitting_cases(run, runner.RunOptions(workers=100, engine="dask")) == 2
    for check in (
        lambda: runner._count_fitting_cases(run, runner.RunOptions()),
        lambda: memory.require(TOY.needs(run.study.cases[0])),
    ):
        with pytest.raises(InputError, match=r"needs at least 2\.56e-05 GB"):
            check()


def test_a_worker_has_its_share(monkeypatch):
    monkeypatch.setattr(memory, "_share", float("inf"))
    machine = memory._memory()
    memory.set_share(2e6)
    assert memory._memory() == 2e6
    with pytest.raises(InputError, match=f"a Dask worker on {socket.gethostname()} has 0.002 GB"):
        memory.require(memory.Need(1e9, "x", "y"))
    memory.set_share(None)
    assert memory._memory() == machine


def test_leakage_counts_in_memory_and_time():
    case = make_study(changed()).cases[0]
    asked = dataclasses.replace(case, output=dataclasses.replace(case.output, leakage=True))
    points = case.surface.shape[0] * case.surface.shape[1]
    # Factors of the flow's matrix take 1500 to 1850 bytes for each point of 256² to 1024².
    assert MODELS["continuum"].needs(asked).size - MODELS["continuum"].needs(case).size == 1700 * points
    (low, _), (more, _) = (memory.seconds_of("continuum", [(each, 1)]) for each in (case, asked))
    assert more - low == pytest.approx(4e-6 * points)
