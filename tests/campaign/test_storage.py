"""What lies beside an output, before, while and after a study runs, and who may take its place."""

import errno
import json
import os
import shutil
import time

import netCDF4
import pytest
import xarray as xr

from contact_study.campaign import progress
from contact_study.campaign import resume as resume_run
from contact_study.campaign.dataset import assembly
from contact_study.campaign.dataset.file import States
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.progress import Progress
from contact_study.campaign.store import case_file, records
from contact_study.campaign.store.case_file import CaseWriter
from contact_study.inputs.errors import InputError
from tests.campaign import toy_model
from tests.campaign.toy_study import BASE, assert_same, changed

LONGER = changed(loading={"path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]})


def names(folder):
    return sorted(path.name for path in folder.iterdir() if path.name != "study.toml")


def test_states_stand_beside_the_dataset_and_not_in_it(finished, tmp_path):
    with xr.open_datatree(tmp_path / "bem.nc") as tree:
        assert set(tree.children) == {"metastable"}
        assert States(tmp_path / "bem.nc.restart").history == tree.attrs["history"]
    assert States(tmp_path / "bem.nc.restart").state(1)["state"].shape == (3,)
    assert States(tmp_path / "bem.nc.restart").state(2) == {}


def as_written_before(path):
    """Put the states into a group of the dataset, as earlier versions did."""
    states = States(path.with_name(path.name + ".restart"))
    kept = {
        f"case_{number}_{name}": ((f"case_{number}_{name}_0",), values)
        for number in range(2)
        for name, values in states.state(number).items()
    }
    xr.Dataset(kept).to_netcdf(path, mode="a", group="restart")
    path.with_name(path.name + ".restart").unlink()


def test_states_in_a_dataset_of_an_earlier_version_are_gone_on_from(finished, run, tmp_path):
    as_written_before(tmp_path / "bem.nc")
    status, solved, said = run(LONGER, "--resume")
    assert (status, len(solved)) == (0, 2), said
    run(LONGER, output="fresh.nc")
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")
    with xr.open_datatree(tmp_path / "bem.nc") as tree:
        assert "restart" not in tree.children


@pytest.mark.parametrize("fault", ["gone", "of another dataset", "one bit", "torn"])
def test_without_a_state_a_longer_path_is_computed_anew(finished, run, tmp_path, fault):
    path = tmp_path / "bem.nc.restart"
    content = bytearray(path.read_bytes())
    if fault == "gone":
        path.unlink()
    elif fault == "of another dataset":
        with netCDF4.Dataset(tmp_path / "bem.nc", "r+") as dataset:
            dataset.history += "\nlast week: something else"
    elif fault == "one bit":
        content[-1] ^= 1  # of the last state
        path.write_bytes(content)
    else:
        path.write_bytes(content[:-1])
    status, solved, said = run(LONGER, "--resume")
    one = fault in ("one bit", "torn")
    assert (status, len(solved)) == (0, 5 if one else 8), said
    assert said.count("computed again: the state after its last point was not kept") == (1 if one else 2)
    run(LONGER, output="fresh.nc")
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")


def test_states_are_not_kept_of_a_dataset_that_is_replaced(finished, run, tmp_path):
    assert run(changed(output={"restart": False}), "--overwrite")[0] == 0
    assert names(tmp_path) == ["bem.nc"]


def test_a_file_that_holds_no_states_is_not_lost(finished, run, tmp_path):
    (tmp_path / "bem.nc.restart").write_text("precious")
    before = (tmp_path / "bem.nc").read_bytes()
    status, _, said = run(LONGER, "--resume")
    assert (status, said.count("\n")) == (1, 1)
    assert "bem.nc.restart: exists and holds no restart states" in said
    assert (tmp_path / "bem.nc.restart").read_text() == "precious"
    assert (tmp_path / "bem.nc").read_bytes() == before
    assert names(tmp_path) == ["bem.nc", "bem.nc.restart"]


def interrupt(*_, **__):
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("at", "then"), [("_publish_states", BASE), ("_publish_states", LONGER), ("remove", LONGER), ("close", BASE)]
)
def test_a_kill_after_the_rename_leaves_nothing_for_good(run, tmp_path, monkeypatch, at, then):
    publish = WorkDirectory.publish

    def killed(parts):
        monkeypatch.setattr(WorkDirectory, at, interrupt)
        publish(parts)
        interrupt()

    monkeypatch.setattr(WorkDirectory, "publish", killed)
    assert run(BASE)[0] == 130
    monkeypatch.undo()
    if at != "close":  # a kill closes nothing
        (tmp_path / "bem.nc.parts.lock").touch()
    assert (tmp_path / "bem.nc").exists()
    status, solved, said = run(then, "--resume")
    assert (status, len(solved)) == (0, 0 if then is BASE else 2)
    assert "another run" not in said
    assert names(tmp_path) == ["bem.nc", "bem.nc.restart"]


def test_a_kill_while_the_folder_is_dropped(run, tmp_path, monkeypatch):
    unlink, gone = type(tmp_path).unlink, []

    def killed(path, missing_ok=False):
        gone.append(path.suffix == ".case")
        if sum(gone) == 2:
            interrupt()
        unlink(path, missing_ok)

    monkeypatch.setattr(type(tmp_path), "unlink", killed)
    assert run(BASE)[0] == 130
    monkeypatch.undo()
    assert any((tmp_path / "bem.nc.parts").iterdir())
    _, solved, said = run(BASE, "--resume")
    assert solved == []
    assert "are left alone" not in said
    assert names(tmp_path) == ["bem.nc", "bem.nc.restart"]


def test_a_kill_between_the_renames_of_a_folder_of_zarr(run, tmp_path, monkeypatch):
    pytest.importorskip("zarr")
    run(BASE, output="bem.zarr")
    rename = type(tmp_path).rename

    def killed(path, target):
        if path.name == "dataset.zarr":
            interrupt()
        return rename(path, target)

    monkeypatch.setattr(type(tmp_path), "rename", killed)
    wider = changed(sweep={"interaction.well_depth_ratio": [1, 4, 2]})
    assert run(wider, "--resume", output="bem.zarr")[0] == 130
    monkeypatch.undo()
    assert not (tmp_path / "bem.zarr").exists()
    status, solved, said = run(wider, "--resume", output="bem.zarr")
    assert (status, solved) == (0, []), said
    run(wider, output="fresh.nc")
    assert_same(tmp_path / "bem.zarr", tmp_path / "fresh.nc")


@pytest.fixture
def meanwhile(monkeypatch):
    """Do something after the first step of a run."""

    def after_the_first_step(act):
        save = CaseWriter.save_step

        def acted(file, number, step):
            save(file, number, step)
            if not done:
                done.append(act())

        done = []
        monkeypatch.setattr(CaseWriter, "save_step", acted)

    yield after_the_first_step
    monkeypatch.undo()


@pytest.mark.parametrize("kind", ["file", "folder"])
@pytest.mark.parametrize("resume", [False, True])
def test_an_output_that_appears_is_not_replaced(run, tmp_path, meanwhile, monkeypatch, base_dataset, kind, resume):
    def appear():
        if resume:  # in the place of the one that is gone on from
            (tmp_path / "bem.nc").unlink()
        if kind == "file":
            (tmp_path / "bem.nc").write_text("precious")
        else:
            (tmp_path / "bem.nc").mkdir()
            (tmp_path / "bem.nc" / "precious").touch()

    if resume:
        shutil.copy(base_dataset, tmp_path / "bem.nc")
    wider = changed(sweep={"interaction.well_depth_ratio": [1, 4, 2]})
    meanwhile(appear)
    status, _, said = run(wider, *(["--resume"] if resume else []))
    assert status == 1
    assert said.splitlines()[-1].endswith(
        "bem.nc has appeared or changed while this ran; move it away and run this again (a model with --resume)"
    )
    monkeypatch.undo()
    (tmp_path / "bem.nc").rename(tmp_path / "moved")
    precious = tmp_path / "moved" / "precious"
    assert precious.exists() if kind == "folder" else (tmp_path / "moved").read_text() == "precious"
    status, solved, said = run(wider, "--resume")
    assert (status, len(solved)) == (0, 6 if resume else 0), said


def test_what_is_to_be_overwritten_may_change_but_for_folders(finished, run, tmp_path, meanwhile, monkeypatch):
    meanwhile(lambda: (tmp_path / "bem.nc").write_text("new"))
    assert run(BASE, "--overwrite")[0] == 0
    monkeypatch.undo()

    def appear():
        (tmp_path / "bem.nc").unlink()
        (tmp_path / "bem.nc").mkdir()

    meanwhile(appear)
    status, _, said = run(BASE, "--overwrite")
    assert status == 1
    assert "bem.nc: is a folder, and no dataset that may be replaced" in said
    assert (tmp_path / "bem.nc").is_dir()


def test_an_output_that_appears_before_the_lock_is_seen_under_it(run, tmp_path, monkeypatch, base_dataset):
    opened = WorkDirectory.open

    def late(parts, **how):
        found = opened(parts, **how)
        shutil.copy(base_dataset, tmp_path / "bem.nc")
        return found

    monkeypatch.setattr(WorkDirectory, "open", late)
    status, solved, said = run(BASE)
    assert (status, solved) == (1, [])
    assert "bem.nc exists; use --overwrite" in said
    assert names(tmp_path) == ["bem.nc"]


def test_a_folder_deleted_while_a_study_runs_is_told_at_once(run, tmp_path, meanwhile, monkeypatch):
    meanwhile(lambda: shutil.rmtree(tmp_path / "bem.nc.parts"))
    status, solved, said = run(BASE)
    assert (status, len(solved)) == (1, 2)
    assert ".case: was deleted, or taken over by another run, while its case ran; " in said
    assert names(tmp_path) == []
    monkeypatch.undo()
    assert run(BASE, "--resume")[0] == 0


def test_steps_of_an_earlier_version_are_refused_and_stay(run, tmp_path):
    old = tmp_path / "bem.nc.parts" / "case-0123456789abcdef"
    old.mkdir(parents=True)
    (old / "step-0000.npz").write_bytes(b"steps")
    (tmp_path / "bem.nc.parts" / "manifest.json").write_text(json.dumps({"model": "continuum"}))
    for how in ([], ["--resume"]):
        status, _, said = run(BASE, *how)
        assert (status, said.count("\n")) == (1, 1)
    assert (
        "bem.nc.parts: holds steps in the format of an earlier version; finish them with that version, or drop" in said
    )
    assert (old / "step-0000.npz").exists()
    assert run(BASE, "--overwrite")[0] == 0
    assert names(tmp_path) == ["bem.nc", "bem.nc.restart"]


def test_a_study_refused_late_leaves_nothing(run, tmp_path, monkeypatch):
    def refuse(case, surface):
        raise InputError("surface.seed = 1: unlucky")

    monkeypatch.setattr(toy_model, "constants", refuse)
    status, _, said = run(BASE)
    assert status == 1
    assert said.splitlines()[-1] == "toy: error: surface.seed = 1: unlucky"
    assert names(tmp_path) == []


@pytest.mark.parametrize("number", [errno.ENOLCK])
def test_without_locks_the_file_and_the_remedy_are_named(run, tmp_path, monkeypatch, number):
    def refused(*_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("fcntl.flock", refused)
    status, solved, said = run(BASE)
    assert (status, solved) == (1, [])
    assert said.count("\n") == 1
    assert "bem.nc: the file system of its folder has no locks (flock)" in said
    assert "choose an output elsewhere" in said
    assert names(tmp_path) == []


def test_a_step_garbled_while_a_study_runs_is_told_and_computed_again(run, tmp_path, meanwhile, monkeypatch):
    def garble():
        (path,) = (tmp_path / "bem.nc.parts").glob("*.case")
        with path.open("r+b") as stream:
            stream.seek(-1, 2)
            stream.write(b"\xff")

    meanwhile(garble)
    status, _, said = run(BASE)
    assert status == 1
    assert ".case: is corrupt" in said.splitlines()[-1]
    monkeypatch.undo()
    status, _, said = run(BASE, "--resume")
    assert status == 0
    assert "1 damaged files of the earlier run: this run computes their lost steps again" in said
    run(BASE, output="fresh.nc")
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")


def test_whole_cases_of_a_dataset_are_read_where_they_stand(finished, run, monkeypatch):
    written = []
    append = records.append
    monkeypatch.setattr(resume_run, "write_case", lambda *_: written.append("case"))
    monkeypatch.setattr(
        case_file.records, "append", lambda stream, kind, *rest: written.append(kind) or append(stream, kind, *rest)
    )
    assert run(changed(sweep={"interaction.well_depth_ratio": [1, 4, 2]}), "--resume")[0] == 0
    # The new case's constants, warning, and steps with their states; at last all states for the file beside.
    assert [kind for kind in written if kind in ("case", b"cons", b"step")] == [b"cons", b"step", b"step", b"step"]


@pytest.mark.validation
def test_assembling_and_widening_are_linear_in_cases(run, tmp_path, monkeypatch):
    seconds = {}

    def timed(module, name):
        call = getattr(module, name)

        def timing(*arguments, **options):
            began = time.process_time()
            try:
                return call(*arguments, **options)
            finally:
                seconds[name] = seconds.get(name, 0.0) + time.process_time() - began

        monkeypatch.setattr(module, name, timing)

    timed(assembly, "assemble")
    timed(WorkDirectory, "write")
    taken = []
    for cases in (200, 1600):
        table = changed(output={"fields": False}, sweep={"surface.seed": list(range(cases))})
        del table["sweep"]["interaction.well_depth_ratio"]
        seconds.clear()
        assert run(table, output=f"{cases}.nc")[0] == 0
        wider = {**table, "sweep": {"surface.seed": list(range(cases + 10))}}
        began = time.process_time()
        assert run(wider, "--resume", output=f"{cases}.nc")[0] == 0
        taken.append((sum(seconds.values()), time.process_time() - began))
    # Eight times the cases; what grew with their square took thirty times as long and more.
    assert taken[1][0] < 14 * taken[0][0]
    assert taken[1][1] < 14 * taken[0][1]


def test_what_takes_its_time_shows_how_far_it_is(monkeypatch, capsys):
    monkeypatch.setattr(progress, "_SILENCE", 0.0)
    assert list(Progress("toy").through(range(3), "cases taken")) == [0, 1, 2]
    assert capsys.readouterr().err.splitlines() == [f"toy: cases taken: {number} of 3" for number in range(3)]
    monkeypatch.setattr(progress, "_SILENCE", 60.0)
    assert list(Progress("toy").through(range(3), "cases taken")) == [0, 1, 2]
    assert capsys.readouterr().err == ""
