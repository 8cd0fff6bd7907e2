import errno
import os
import shutil

import netCDF4
import numpy as np
import pytest
import xarray as xr

from contact_study.campaign import resume as resume_run
from contact_study.campaign.dataset.file import States
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.store import case_file
from contact_study.inputs.errors import InputError
from tests.campaign import toy_model
from tests.campaign.conftest import fail
from tests.campaign.toy_study import BASE, LONGER, MORE, assert_same, changed, names

BOTH = ["bem.nc", "bem.nc.restart"]


def into_a_group(path):
    beside = path.with_name(path.name + ".restart")
    states = [States(beside).state(number) for number in range(3)]
    assert states[2] == {}
    kept = {f"case_{at}_state": ((f"case_{at}_state_0",), states[at]["state"]) for at in range(2)}
    xr.Dataset(kept).to_netcdf(path, mode="a", group="restart")
    beside.unlink()


def of_another_dataset(path):
    with netCDF4.Dataset(path, "r+") as dataset:
        dataset.history += "\nlast week: something else"


def beside(act):
    return lambda path: act(path.with_name(path.name + ".restart"))


STATES = {
    "there": (lambda path: None, 2),
    "in the dataset": (into_a_group, 2),
    "gone": (beside(os.unlink), 8),
    "of another dataset": (of_another_dataset, 8),
    "one bit": (beside(lambda path: path.write_bytes(path.read_bytes()[:-1] + b"\xff")), 5),
    "torn": (beside(lambda path: path.write_bytes(path.read_bytes()[:-1])), 5),
}


@pytest.mark.parametrize(("act", "steps"), STATES.values(), ids=STATES)
def test_without_a_state_a_longer_path_is_computed_anew(finished, run, built, tmp_path, act, steps):
    act(tmp_path / "bem.nc")
    status, solved, said = run(LONGER, "--resume")
    assert (status, len(solved)) == (0, steps), said
    assert said.count("computed again: the state after its last point was not kept") == (steps - 2) // 3
    assert_same(tmp_path / "bem.nc", built(LONGER))


def test_states_are_not_kept_of_a_dataset_that_is_replaced(finished, run, tmp_path):
    assert run(changed(output={"restart": False}), "--overwrite")[0] == 0
    assert names(tmp_path) == ["bem.nc"]


def test_what_is_precious_is_refused_and_stays(finished, run, tmp_path):
    (tmp_path / "bem.nc.restart").write_text("precious")
    status, solved, said = run(LONGER, "--resume")
    assert (status, solved, said.count("\n"), names(tmp_path)) == (1, [], 1, BOTH)
    assert "bem.nc.restart: exists and holds no restart states" in said
    assert (tmp_path / "bem.nc.restart").read_text() == "precious"


@pytest.mark.parametrize(
    ("case", "manifest", "words"),
    [
        (
            "case-0123456789abcdef/x",
            '{"model": "continuum"}',
            "holds steps in the format of an earlier version; finish",
        ),
        ("0123456789abcdef.case", None, "has lost the record of its run (manifest.json)"),
        ("0123456789abcdef.case", "[1]", "has lost the record of its run (manifest.json)"),
    ],
)
def test_steps_that_are_not_understood_are_refused_and_stay(run, tmp_path, case, manifest, words):
    parts = tmp_path / "bem.nc.parts"
    (parts / case).parent.mkdir(parents=True)
    (parts / case).touch()
    if manifest is not None:
        (parts / "manifest.json").write_text(manifest)
    before = sorted(parts.rglob("*"))
    assert run(BASE)[0] == 1
    status, _, said = run(BASE, "--resume")
    assert (status, said.count("\n")) == (1, 1)
    assert f"bem.nc.parts: {words}" in said
    assert sorted(parts.rglob("*")) == before
    assert run(BASE, "--overwrite")[0] == 0
    assert names(tmp_path) == BOTH


def garbled(folder):
    (path,) = (folder / "bem.nc.parts").glob("*.case")
    path.write_bytes(path.read_bytes()[:-1] + b"\xff")


def folder_appears(folder):
    (folder / "bem.nc").unlink(missing_ok=True)
    (folder / "bem.nc").mkdir()
    (folder / "bem.nc" / "precious").touch()


def file_appears(folder):
    (folder / "bem.nc").write_text("precious")


LOST = ".case: was deleted, or taken over by another run, while its case ran; "
APPEARED = "bem.nc has appeared or changed while this ran; move it away and run this again (a model with --resume)"
IS_FOLDER = "bem.nc: is a folder, and no dataset that may be replaced"
AGAIN = "1 damaged files of the earlier run: this run computes their lost steps again"

# What happens after the first step, how the run was started, what is said then, and of the next run; its steps.
MEANWHILE = {
    "folder dropped": (lambda folder: shutil.rmtree(folder / "bem.nc.parts"), [], LOST, "", 9),
    "step garbled": (garbled, [], ".case: is corrupt", AGAIN, 3),
    "file appears": (file_appears, [], APPEARED, "", 0),
    "folder appears": (folder_appears, [], APPEARED, "", 0),
    "folder in place of what is gone on from": (folder_appears, ["--resume"], APPEARED, "", 6),
    "folder in place of what is replaced": (folder_appears, ["--overwrite"], IS_FOLDER, "", 0),
}


@pytest.mark.parametrize(("act", "how", "first", "then", "steps"), MEANWHILE.values(), ids=MEANWHILE)
def test_what_happens_while_a_study_runs(run, built, tmp_path, after_step, act, how, first, then, steps):
    if how:
        shutil.copy(built(BASE), tmp_path / "bem.nc")
    with after_step(lambda: act(tmp_path)):
        status, _, said = run(MORE, *how)
    assert status == 1
    assert first in said.splitlines()[-1]
    assert names(tmp_path) == [name for name in names(tmp_path) if "tmp" not in name]
    if (tmp_path / "bem.nc").exists():
        (tmp_path / "bem.nc").rename(tmp_path / "moved")
        assert (tmp_path / "moved" / "precious").exists() or (tmp_path / "moved").read_text() == "precious"
    status, solved, said = run(MORE, "--resume")
    assert (status, len(solved)) == (0, steps), said
    assert then in said
    assert_same(tmp_path / "bem.nc", built(MORE))


def test_an_output_that_appears_before_the_lock_is_seen_under_it(run, built, tmp_path, monkeypatch):
    opened, there = WorkDirectory.open, built(BASE)

    def late(parts, **how):
        found = opened(parts, **how)
        shutil.copy(there, tmp_path / "bem.nc")
        return found

    monkeypatch.setattr(WorkDirectory, "open", late)
    status, solved, said = run(BASE)
    assert (status, solved) == (1, [])
    assert "bem.nc exists; use --overwrite" in said
    assert names(tmp_path) == ["bem.nc"]


NO_LOCKS, FULL = (OSError(number, os.strerror(number)) for number in (errno.ENOLCK, errno.ENOSPC))
NOT_WRITTEN = {
    "a study refused late": (toy_model, "constants", InputError("surface.seed = 1: unlucky"), "error: surface.seed ="),
    "no locks": ("fcntl", "flock", NO_LOCKS, "bem.nc: the file system of its folder has no locks (flock)"),
    "a full disk, of steps": (case_file, "append", FULL, ".case: cannot be written (No space left on device)"),
    "a full disk": (xr.Dataset, "dump_to_store", RuntimeError("NetCDF: HDF error"), "is the disk full?"),
}


@pytest.mark.parametrize(("owner", "name", "error", "words"), NOT_WRITTEN.values(), ids=NOT_WRITTEN)
def test_what_cannot_be_written_leaves_nothing_but_steps(run, tmp_path, monkeypatch, owner, name, error, words):
    owner = pytest.importorskip(owner) if isinstance(owner, str) else owner
    monkeypatch.setattr(owner, name, fail(error))
    status, _, said = run(BASE)
    assert status == 1
    assert words in said.splitlines()[-1]
    assert "Traceback" not in said
    assert names(tmp_path) == (["bem.nc.parts"] if name == "dump_to_store" else [])
    assert not list(tmp_path.rglob("*.tmp"))


def test_names_of_no_output(run, tmp_path):
    ending, folder = "expected a name that ends in .nc, for NetCDF, or .zarr", "is the name of a folder; name a file"
    np.save(tmp_path / "map.npy", np.eye(8))
    keys = ("--overwrite", "--surface.kind", "file", "--surface.path", "map.npy", "--surface.height_unit", "pm")
    for name, words in (
        ("/dev/null/bem.nc", "/dev/null/bem.nc: cannot be written ("),
        (tmp_path / "bem", f"toy: error: {tmp_path / 'bem'}: {ending}\n"),
        (tmp_path / "bem.zarr.gz", f"toy: error: {tmp_path / 'bem.zarr.gz'}: {ending}\n"),
        (tmp_path / "sub/../study.toml", "is read by this run"),
        (tmp_path / "map.npy", "is read by this run"),
        (tmp_path, f"{tmp_path}"),
        (f"{tmp_path}/bem.nc/", f"toy: error: {tmp_path}/bem.nc/: {folder}\n"),
    ):
        status, solved, said = run(BASE, *keys, "-o", str(name))
        assert (status, solved, said.count("\n")) == (1, [], 1)
        assert words in said
    assert names(tmp_path) == ["map.npy"]
    assert np.load(tmp_path / "map.npy").shape == (8, 8)


def test_whole_cases_of_a_dataset_are_read_where_they_stand(finished, run, monkeypatch):
    written, append = [], case_file.append
    monkeypatch.setattr(resume_run, "write_case", fail(AssertionError))
    monkeypatch.setattr(case_file, "append", lambda stream, *one: written.append(one[0]) or append(stream, *one))
    assert run(MORE, "--resume")[0] == 0
    # The new case's constants, warning, and steps with their states; at last all states for the file beside.
    assert [kind for kind in written if kind in (b"cons", b"step")] == [b"cons", b"step", b"step", b"step"]
