import hashlib
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.store import case_file
from tests.campaign.toy_model import TOY, TOY_ATOMS, TOY_OF_WHOLE_PATHS
from tests.campaign.toy_study import BASE, LONGER, LONGER_PATH, MORE, assert_same, changed, names

NO_STATES = {"output": {"restart": False}}
MORE_AND_LONGER = changed(sweep=MORE["sweep"], loading=LONGER_PATH)
ORDER = {"sweep": {"surface.seed": [3, 1], "interaction.well_depth_ratio": [4, 1]}}
BACK, COARSE = {"loading": {"unload": True}}, {"output": {"pressure_bins": 600}}
FURTHER = {"loading": {"unload": True, **LONGER_PATH}}
RATIO = "interaction.well_depth_ratio"
FREE = {
    "study": {"title": "renamed"},
    "surface": {"size": "10 nm", "rms_height": 1e-10},
    "theory": {"alpha": 2.0},
    "atomistic": {"cutoff": 5.0},
    "solver": {"threads": 1},
}
TURNED, FINER = "unloading starts from another point", "coarser than those asked for now"
LOST = "output.restart = false), or its file bem.nc.restart is missing, of another dataset or damaged"

# The first study, the steps after which it was stopped (0: never), the next one, the steps then solved, why all anew.
RESUMED = {
    "a seed more": ({}, 0, {"sweep": {RATIO: [1, 4], "surface.seed": [1, 2]}}, 6, ""),
    "another order": ({}, 0, ORDER, 6, ""),
    "what decides no number": ({}, 0, FREE, 0, ""),
    "points at the end": ({}, 0, {"loading": {"path": [*LONGER_PATH["path"], "0.2 GPa"]}}, 4, ""),
    "the way back": ({}, 0, BACK, 4, ""),
    "points of the sweep need no state": (NO_STATES, 0, {**NO_STATES, "sweep": {RATIO: [1, 4, 2]}}, 3, ""),
    "fields": ({"output": {"fields": False}}, 0, {}, 6, "the earlier run did not keep its fields"),
    "no state": (NO_STATES, 0, {"loading": LONGER_PATH}, 8, LOST),
    "another turn": (BACK, 0, FURTHER, 14, TURNED),
    "finer bins": ({}, 0, COARSE, 6, FINER),
    "another order, unfinished": ({}, 4, ORDER, 8, ""),
    "the way back, unfinished": ({}, 4, BACK, 6, ""),
    "another turn, unfinished": (BACK, 4, FURTHER, 11, ""),  # the state before the turn is still there
    "finer bins, unfinished": ({}, 4, COARSE, 6, ""),
}


@pytest.mark.parametrize(("first", "after", "then", "steps", "anew"), RESUMED.values(), ids=RESUMED)
def test_what_is_gone_on_from_is_what_a_fresh_run_gives(run, built, stopped, tmp_path, first, after, then, steps, anew):
    fresh = built(changed(**then))
    if after:
        stopped(changed(**first), after)
    else:
        run(changed(**first))
    status, solved, said = run(changed(**then), "--resume")
    assert status == 0, said
    assert len(solved) == len(set(solved)) == steps
    assert after or said.count("computed again: ") == (2 if anew else 0)
    assert anew in said
    assert not anew or "warning: well_depth_ratio = 1.0: computed again: " in said
    assert_same(tmp_path / "bem.nc", fresh)
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        assert dataset.attrs["title"] == changed(**then)["study"]["title"]
        assert len(dataset.attrs["history"].splitlines()) == (1 if after else 2)
    assert names(tmp_path) == names(fresh.parent)
    before = (tmp_path / "bem.nc").stat().st_mtime_ns
    assert run(changed(**then), "--resume")[:2] == (0, [])
    assert (tmp_path / "bem.nc").stat().st_mtime_ns == before


def test_widening_goes_on_widening(run, built, tmp_path):
    exception = {**BASE, "override": [{"when": {RATIO: 4}, "loading.path": LONGER_PATH["path"]}]}
    for length in (1, 2, 3):
        run(changed(loading={"path": LONGER_PATH["path"][:length]}), "--resume")
    assert run(exception, "--resume")[1] == [("well_depth_ratio = 4.0", 3)]
    assert_same(tmp_path / "bem.nc", built(exception))


def test_steps_that_follow_from_the_whole_path(run):
    model = {"model": TOY_OF_WHOLE_PATHS}
    run(BASE, **model)
    assert len(run(MORE, "--resume", **model)[1]) == 3
    _, solved, said = run(MORE_AND_LONGER, "--resume", **model)
    assert len(solved) == 12
    assert "share quantities of the whole path" in said


def content(folder):
    return {path: path.is_file() and path.read_bytes() for path in folder.rglob("*") if path.name != "study.toml"}


@pytest.fixture
def refused(run, tmp_path):
    def refuse(table, *words, model=TOY):
        before = content(tmp_path)
        status, solved, said = run(table, "--resume", model=model)
        assert (status, solved, said.count("\n")) == (1, [], 1)
        assert all(part in said for part in words), said
        assert content(tmp_path) == before
        return said

    return refuse


@pytest.fixture(params=[0, 5], ids=["finished", "unfinished"])
def begun(request, run, stopped):
    def begin(table, *arguments, **options):
        if request.param:
            stopped(table, request.param, *arguments, **options)
        else:
            run(table, *arguments, **options)
        return bool(request.param)

    return begin


def test_another_study_is_refused(begun, refused):
    fault = "bem.nc.parts holds the steps of another study or version" if begun(BASE) else "belongs to another study"
    refused(changed(surface={"hurst_exponent": 0.7}), fault, "surface.hurst_exponent is 0.8 there and 0.7 here")
    refused(BASE, fault, "model is continuum there and atomistic here", model=TOY_ATOMS)


def killed_at(patch, owner, name, count, suffix=""):
    call, calls = getattr(owner, name), []

    def killed(*arguments, **options):
        if not suffix or str(arguments[0]).endswith(suffix):
            calls.append(name)
            if len(calls) == count:
                raise KeyboardInterrupt
        return call(*arguments, **options)

    patch.setattr(owner, name, killed)


def work(name, count=1):
    return WorkDirectory, name, count


# Where a run is killed, of which study, which one goes on, and the most steps it solves then.
KILLED = {
    "states not moved": (work("_publish_states", 2), BASE, BASE, 0),
    "states not moved, longer": (work("_publish_states", 2), BASE, LONGER, 2),
    "folder not removed": (work("remove"), BASE, LONGER, 2),
    "lock not removed": (work("close"), BASE, BASE, 0),
    "folder half removed": ((Path, "unlink", 2, ".case"), BASE, BASE, 0),
    "cases not all brought": ((case_file, "append", 6), MORE_AND_LONGER, MORE_AND_LONGER, 6),
    "widened in part": ((case_file, "append", 23), MORE_AND_LONGER, MORE_AND_LONGER, 6),
    "zarr not renamed": ((Path, "replace", 1, "dataset.zarr"), MORE, MORE, 0),
}


@pytest.mark.parametrize(("where", "table", "then", "most"), KILLED.values(), ids=KILLED)
def test_a_kill_leaves_nothing_for_good(run, built, tmp_path, monkeypatch, where, table, then, most):
    output, fresh = "bem.nc", built(then)
    if table is MORE:
        pytest.importorskip("zarr")
        output = "bem.zarr"
    before = b""
    if table is not BASE:
        run(BASE, output=output)
        before = (tmp_path / output).read_bytes() if output == "bem.nc" else b""
    with monkeypatch.context() as patch:
        killed_at(patch, *where)
        assert run(table, "--resume", output=output)[0] == 130
    assert not before or (tmp_path / output).read_bytes() == before, "it stands until its successor does"
    if where[1] != "close":  # a kill closes nothing
        (tmp_path / f"{output}.parts.lock").touch()
    status, solved, said = run(then, "--resume", output=output)
    assert status == 0, said
    assert len(solved) <= most
    assert "left alone" not in said
    assert_same(tmp_path / output, fresh)
    assert names(tmp_path) == [output, f"{output}.restart"]


def test_steps_of_a_wider_run_are_not_dropped(finished, run, stopped):
    stopped(MORE, 1, "--resume")
    status, solved, said = run(BASE, "--resume")
    assert (status, solved) == (0, [])
    assert "holds steps of another run, which are left alone" in said
    assert len(run(MORE, "--resume")[1]) == 2


def test_wider_bins_take_the_finished_distributions(run, tmp_path):
    output = {"pressure_range": None}
    run(changed(output=output))
    before = xr.load_dataset(tmp_path / "bem.nc").pressure_pdf
    _, solved, said = run(changed(sweep={RATIO: [1, 4, 40]}, output=output), "--resume")
    assert len(solved) == 3
    assert "the distributions of 6 steps finished before were on other bins" in said
    dataset = xr.load_dataset(tmp_path / "bem.nc")
    assert "on other bins" in dataset.attrs["warnings"]
    after = dataset.pressure_pdf.sel(well_depth_ratio=[1, 4])
    width_before, width = (float(pdf.pressure_bin[1] - pdf.pressure_bin[0]) for pdf in (before, after))
    assert width > 1.1 * width_before
    # The toy's density is uniform: it stays what it was inside the old range, and its integral everywhere.
    np.testing.assert_allclose(after.sum("pressure_bin") * width, before.sum("pressure_bin") * width_before, rtol=1e-9)
    inside = after.where(abs(after.pressure_bin) < 0.9 * abs(float(before.pressure_bin[0])))
    np.testing.assert_allclose(inside.mean("pressure_bin"), before.mean("pressure_bin"), rtol=1e-9)


def test_warnings_of_finished_steps_are_carried_on(run, tmp_path):
    run(changed(sweep={RATIO: [2]}, solver={"max_iterations": 7}))
    _, _, said = run(changed(sweep={RATIO: [2, 1]}, solver={"max_iterations": 7}), "--resume")
    assert said.count("a toy is no model") == 1
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        assert dataset.attrs["warnings"] == "a toy is no model\nwell_depth_ratio = 2.0: a grid too coarse"


MAP = {"kind": "file", "path": "map.npy", "height_unit": "angstrom", "rms_height": None, "cutoff_mode": None}


@pytest.fixture
def new_map(tmp_path):
    def write(seed):
        np.save(tmp_path / "map.npy", np.random.default_rng(seed).standard_normal((16, 16)))

    write(1)
    return write


def test_height_map_is_told_by_its_content(run, begun, refused, tmp_path, new_map):
    if not begun(changed(surface=MAP)):
        sha256 = hashlib.sha256((tmp_path / "map.npy").read_bytes()).hexdigest()
        shutil.copy(tmp_path / "map.npy", tmp_path / "moved.npy")
        assert run(changed(surface={**MAP, "path": "moved.npy"}), "--resume")[:2] == (0, [])
        with xr.open_dataset(tmp_path / "bem.nc") as dataset:
            assert dataset.attrs["height_maps"] == f"sha256:{sha256} moved.npy"
    new_map(2)
    assert "another study" not in refused(changed(surface=MAP), ".npy has changed since it was started (SHA-256 ")


def test_height_map_that_changes_while_the_study_runs(run, new_map, after_step):
    with after_step(lambda: new_map(2)):
        status, solved, said = run(changed(surface=MAP))
    assert status == 1
    assert "map.npy has changed while the study ran; 3 of 6 steps are finished and kept, --resume continues" in said
    assert {label for label, _ in solved} == {"well_depth_ratio = 1.0"}


@pytest.mark.validation
def test_predictor_is_widened_with_its_study(finished, run, tmp_path):
    start = ("--predictor", str(tmp_path / "bem.nc"))
    run(BASE, *start, output="md.nc", model=TOY_ATOMS)
    run(MORE, "--resume")
    assert len(run(MORE, *start, "--resume", output="md.nc", model=TOY_ATOMS)[1]) == 3
    run(MORE, *start, output="fresh.nc", model=TOY_ATOMS)
    assert_same(tmp_path / "md.nc", tmp_path / "fresh.nc")
    one, two = (xr.load_dataset(tmp_path / name) for name in ("md.nc", "fresh.nc"))
    assert one.attrs["predictor"] == two.attrs["predictor"]
    assert len(str(one.predictor_field.values.ravel()[0])) == 64


@pytest.mark.validation
def test_other_fields_of_the_predictor_are_refused(finished, run, begun, tmp_path):
    atoms = {"output": "md.nc", "model": TOY_ATOMS}
    with xr.open_datatree(tmp_path / "bem.nc") as tree:
        tree = tree.load()
    tree["gap"][1, 1] += 1e-12
    tree.to_netcdf(tmp_path / "other.nc")
    begun(BASE, "--predictor", str(tmp_path / "bem.nc"), **atoms)
    point = "than the finished step started from (well_depth_ratio = 4.0, point 2)"
    for predictor, words in (
        (["--predictor", str(tmp_path / "other.nc")], point),
        ([], "--predictor is bem.nc there and none here"),
    ):
        status, solved, said = run(BASE, *predictor, "--resume", **atoms)
        assert (status, solved) == (1, [])
        assert words in said
