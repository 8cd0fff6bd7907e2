"""Going on from earlier runs: what stands is kept, what is missing is computed, what differs is named."""

import hashlib

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.store import records
from contact_study.campaign.store.case_file import CaseWriter
from tests.campaign.toy_model import TOY_ATOMS, TOY_OF_WHOLE_PATHS
from tests.campaign.toy_study import BASE, assert_same, changed

WIDER = {
    "a seed more": {"sweep": {"interaction.well_depth_ratio": [1, 4], "surface.seed": [1, 2]}},
    "another order": {"sweep": {"surface.seed": [3, 1], "interaction.well_depth_ratio": [4, 1]}},
    "what decides no number": {
        "study": {"title": "renamed"},
        "surface": {"size": "10 nm", "rms_height": 1e-10},
        "theory": {"alpha": 2.0},
        "atomistic": {"cutoff": 5.0},
        "solver": {"threads": 1},
    },
    "points at the end": {"loading": {"path": ["0.1 GPa", "1 GPa", "2 GPa", "1.5 GPa", "0.2 GPa"]}},
    "the way back": {"loading": {"unload": True}},
}
FILES = ["bem.nc", "bem.nc.restart", "fresh.nc", "fresh.nc.restart", "study.toml"]
SOLVED_OF = {"a seed more": 6, "another order": 6, "points at the end": 4, "the way back": 4}


@pytest.mark.parametrize("words", WIDER)
def test_finished_study_is_widened_to_what_a_fresh_run_gives(finished, run, tmp_path, words):
    wider = changed(**WIDER[words])
    status, solved, said = run(wider, "--resume")
    assert status == 0, said
    assert len(solved) == len(set(solved)) == SOLVED_OF.get(words, 0)
    assert "again" not in said
    assert run(wider, output="fresh.nc")[0] == 0
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")
    with xr.open_dataset(tmp_path / "bem.nc") as one, xr.open_dataset(tmp_path / "fresh.nc") as two:
        assert one.attrs["study_toml"] == two.attrs["study_toml"]
        assert one.attrs["title"] == wider["study"]["title"]
        assert one.attrs["history"].count("toy") > two.attrs["history"].count("toy") / 2
        assert len(one.attrs["history"].splitlines()) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == FILES
    before = (tmp_path / "bem.nc").stat().st_mtime_ns
    assert run(wider, "--resume")[:2] == (0, [])
    assert (tmp_path / "bem.nc").stat().st_mtime_ns == before


def test_widening_goes_on_widening(run, tmp_path):
    run(changed(loading={"path": ["0.1 GPa"]}))
    run(changed(loading={"path": ["0.1 GPa"]}, study={"title": "t"}), "--resume")
    run(changed(loading={"path": ["0.1 GPa", "1 GPa"]}), "--resume")
    _, solved, _ = run(BASE, "--resume")
    assert solved == [("well_depth_ratio = 1.0", 2), ("well_depth_ratio = 4.0", 2)]
    run(BASE, output="fresh.nc")
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")


def test_exceptions_of_some_points_are_lengthened(finished, run, tmp_path):
    exception = {"when": {"interaction.well_depth_ratio": 4}, "loading.path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]}
    _, solved, _ = run({**BASE, "override": [exception]}, "--resume")
    assert solved == [("well_depth_ratio = 4.0", 3)]
    run({**BASE, "override": [exception]}, output="fresh.nc")
    with xr.open_dataset(tmp_path / "bem.nc") as one, xr.open_dataset(tmp_path / "fresh.nc") as two:
        np.testing.assert_array_equal(one.relative_contact_area, two.relative_contact_area)


ANEW = {
    "fields": ({"output": {"fields": False}}, {}, 6, "the earlier run did not keep its fields"),
    "no state": (
        {"output": {"restart": False}},
        {"loading": {"path": ["0.1 GPa", "1 GPa", "2 GPa", "1.5 GPa"]}},
        8,
        "output.restart = false), or its file bem.nc.restart is missing, of another dataset or damaged",
    ),
    "another turn": (
        {"loading": {"unload": True}},
        {"loading": {"unload": True, "path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]}},
        14,
        "unloading starts from another point",
    ),
    "finer bins": ({}, {"output": {"pressure_bins": 600}}, 6, "coarser than those asked for now"),
}


@pytest.mark.parametrize("why", ANEW)
def test_what_must_be_computed_anew_is(run, tmp_path, why):
    first, then, steps, words = ANEW[why]
    run(changed(**first))
    status, solved, said = run(changed(**then), "--resume")
    assert status == 0, said
    assert len(solved) == steps
    assert said.count("computed again: ") == 2
    assert "warning: well_depth_ratio = 1.0: computed again: " in said
    assert words in said
    run(changed(**then), output="fresh.nc")
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")


def test_states_that_are_not_asked_for_are_not_kept(run, tmp_path):
    run(changed(output={"restart": False}))
    run(BASE, output="kept.nc")
    assert not (tmp_path / "bem.nc.restart").exists()
    assert (tmp_path / "kept.nc.restart").exists()
    # Points of the sweep need no state.
    wider = changed(output={"restart": False}, sweep={"interaction.well_depth_ratio": [1, 4, 2]})
    assert len(run(wider, "--resume")[1]) == 3


def test_steps_that_follow_from_the_whole_path(run):
    model = {"model": TOY_OF_WHOLE_PATHS}
    run(BASE, **model)
    wider = changed(sweep={"interaction.well_depth_ratio": [1, 4, 2]})
    assert len(run(wider, "--resume", **model)[1]) == 3
    longer = changed(loading={"path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]}, **{"sweep": wider["sweep"]})
    _, solved, said = run(longer, "--resume", **model)
    assert len(solved) == 12
    assert "share quantities of the whole path" in said


def test_another_study_is_refused(finished, run, tmp_path):
    before = (tmp_path / "bem.nc").read_bytes()
    status, solved, said = run(changed(surface={"hurst_exponent": 0.7}), "--resume")
    assert (status, solved) == (1, [])
    assert "belongs to another study" in said
    assert "surface.hurst_exponent is 0.8 there and 0.7 here" in said
    assert said.count("\n") == 1
    assert (tmp_path / "bem.nc").read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bem.nc", "bem.nc.restart", "study.toml"]
    status, _, said = run(BASE, "--resume", model=TOY_ATOMS)
    assert status == 1
    assert "model is continuum there and atomistic here" in said


@pytest.mark.parametrize("words", ["another order", "the way back"])
def test_unfinished_study_is_widened(run, stopped, tmp_path, words):
    wider = changed(**WIDER[words])
    stopped(BASE, 4)
    status, solved, said = run(wider, "--resume")
    assert status == 0, said
    run(wider, output="fresh.nc")
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")
    assert len(solved) == SOLVED_OF.get(words, 0) + 2


@pytest.mark.parametrize("why", ["another turn", "finer bins"])
def test_what_must_be_computed_anew_of_an_unfinished_study(run, stopped, tmp_path, why):
    first, then, steps, _ = ANEW[why]
    stopped(changed(**first), 4)
    status, solved, said = run(changed(**then), "--resume")
    assert status == 0, said
    # The state before an unloading that began elsewhere may still be there.
    assert len(solved) == (steps - 3 if why == "another turn" else steps)
    run(changed(**then), output="fresh.nc")
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")


def test_unfinished_study_says_what_differs(run, stopped, tmp_path):
    stopped(BASE, 4)
    before = sorted(tmp_path.rglob("*"))
    status, _, said = run(changed(surface={"hurst_exponent": 0.7}), "--resume")
    assert status == 1
    assert "bem.nc.parts holds the steps of another study or version" in said
    assert "surface.hurst_exponent is 0.8 there and 0.7 here" in said
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("writes", [6, 23])
def test_widening_that_is_killed_is_taken_up_again(finished, run, tmp_path, monkeypatch, writes):
    wider = changed(
        sweep={"interaction.well_depth_ratio": [1, 4, 2]}, loading={"path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]}
    )
    run(wider, output="fresh.nc")
    count = []
    append = records.append

    def counted(*arguments):
        count.append(1)
        if len(count) == writes:
            raise KeyboardInterrupt
        return append(*arguments)

    monkeypatch.setattr(records, "append", counted)
    assert run(wider, "--resume")[0] == 130
    monkeypatch.undo()
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        assert dataset.sizes["well_depth_ratio"] == 2  # the finished dataset stands until its successor does
    status, solved, _ = run(wider, "--resume")
    assert status == 0
    assert len(solved) <= 6
    assert_same(tmp_path / "bem.nc", tmp_path / "fresh.nc")
    assert sorted(path.name for path in tmp_path.iterdir()) == FILES


def test_steps_of_a_wider_run_are_not_dropped(finished, run):
    with pytest.MonkeyPatch.context() as patch:
        save = CaseWriter.save_step

        def stop(*arguments):
            save(*arguments)
            raise KeyboardInterrupt

        patch.setattr(CaseWriter, "save_step", stop)
        wider = changed(sweep={"interaction.well_depth_ratio": [1, 4, 2]})
        assert run(wider, "--resume")[0] == 130
    status, solved, said = run(BASE, "--resume")
    assert (status, solved) == (0, [])
    assert "holds steps of another run, which are left alone" in said
    assert len(run(wider, "--resume")[1]) == 2


def test_wider_bins_take_the_finished_distributions(run, tmp_path):
    output = {"pressure_range": None}
    run(changed(output=output))
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        before = dataset.pressure_pdf.load()
    wider = changed(sweep={"interaction.well_depth_ratio": [1, 4, 40]}, output=output)
    _, solved, said = run(wider, "--resume")
    assert len(solved) == 3
    assert "the distributions of 6 steps finished before were on other bins" in said
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        assert "on other bins" in dataset.attrs["warnings"]
        after = dataset.pressure_pdf.sel(well_depth_ratio=[1, 4]).load()
    width_before, width = (float(pdf.pressure_bin[1] - pdf.pressure_bin[0]) for pdf in (before, after))
    assert width > 1.1 * width_before
    # The toy's density is uniform: it stays what it was inside the old range, and its integral everywhere.
    np.testing.assert_allclose(after.sum("pressure_bin") * width, before.sum("pressure_bin") * width_before, rtol=1e-9)
    inside = np.abs(after.pressure_bin) < 0.9 * abs(float(before.pressure_bin[0]))
    np.testing.assert_allclose(
        after.isel(pressure_bin=np.flatnonzero(inside)).mean("pressure_bin"), before.mean("pressure_bin"), rtol=1e-9
    )


def test_warnings_of_finished_steps_are_carried_on(run, tmp_path):
    table = changed(sweep={"interaction.well_depth_ratio": [2]}, solver={"max_iterations": 7})
    run(table)
    _, _, said = run(changed(sweep={"interaction.well_depth_ratio": [2, 1]}, solver={"max_iterations": 7}), "--resume")
    assert said.count("a toy is no model") == 1
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        lines = dataset.attrs["warnings"].splitlines()
    assert lines == ["a toy is no model", "well_depth_ratio = 2.0: a grid too coarse"]


@pytest.fixture
def map_study(tmp_path):
    np.save(tmp_path / "map.npy", np.random.default_rng(1).standard_normal((16, 16)))
    return changed(
        surface={"kind": "file", "path": "map.npy", "height_unit": "angstrom", "rms_height": None, "cutoff_mode": None}
    )


def test_height_map_is_told_by_its_content(run, tmp_path, map_study):
    run(map_study)
    content = hashlib.sha256((tmp_path / "map.npy").read_bytes()).hexdigest()
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        assert dataset.attrs["height_maps"] == f"sha256:{content} map.npy"
    (tmp_path / "map.npy").rename(tmp_path / "moved.npy")
    map_study["surface"]["path"] = "moved.npy"  # the same content at another place
    assert run(map_study, "--resume")[:2] == (0, [])
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        assert dataset.attrs["height_maps"] == f"sha256:{content} moved.npy"


@pytest.mark.parametrize("whole", [True, False])
def test_changed_height_map_is_refused(run, stopped, tmp_path, map_study, whole):
    if whole:
        run(map_study)
    else:
        stopped(map_study, 4)
    np.save(tmp_path / "map.npy", np.random.default_rng(2).standard_normal((16, 16)))
    before = sorted(tmp_path.rglob("*"))
    status, solved, said = run(map_study, "--resume")
    assert (status, solved) == (1, [])
    assert ": the height map map.npy has changed since it was started (SHA-256 " in said
    assert "another study" not in said
    assert said.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_height_map_that_changes_while_the_study_runs(run, tmp_path, map_study, monkeypatch):
    save = CaseWriter.save_step

    def change(*arguments):
        save(*arguments)
        np.save(tmp_path / "map.npy", np.random.default_rng(2).standard_normal((16, 16)))

    monkeypatch.setattr(CaseWriter, "save_step", change)
    status, solved, said = run(map_study)
    assert status == 1
    assert "map.npy has changed while the study ran; 3 of 6 steps are finished and kept, --resume continues" in said
    assert {label for label, _ in solved} == {"well_depth_ratio = 1.0"}


def test_predictor_is_widened_with_its_study(finished, run, tmp_path):
    start = ("--predictor", str(tmp_path / "bem.nc"))
    assert run(BASE, *start, output="md.nc", model=TOY_ATOMS)[0] == 0
    wider = changed(sweep={"interaction.well_depth_ratio": [1, 4, 2]})
    run(wider, "--resume")
    status, solved, said = run(wider, *start, "--resume", output="md.nc", model=TOY_ATOMS)
    assert status == 0, said
    assert len(solved) == 3
    run(wider, *start, output="fresh.nc", model=TOY_ATOMS)
    assert_same(tmp_path / "md.nc", tmp_path / "fresh.nc")
    with xr.open_dataset(tmp_path / "md.nc") as one, xr.open_dataset(tmp_path / "fresh.nc") as two:
        assert one.attrs["predictor"] == two.attrs["predictor"]
        assert len(str(one.predictor_field.values.ravel()[0])) == 64


@pytest.mark.parametrize("whole", [True, False])
def test_other_fields_of_the_predictor_are_refused(finished, run, stopped, tmp_path, whole):
    with xr.open_datatree(tmp_path / "bem.nc") as tree:
        tree = tree.load()
    tree["gap"][1, 1] += 1e-12
    tree.to_netcdf(tmp_path / "other.nc")
    start = ("--predictor", str(tmp_path / "bem.nc"))
    if whole:
        run(BASE, *start, output="md.nc", model=TOY_ATOMS)
    else:
        stopped(BASE, 5, *start, output="md.nc", model=TOY_ATOMS)
    other = ("--predictor", str(tmp_path / "other.nc"))
    status, solved, said = run(BASE, *other, "--resume", output="md.nc", model=TOY_ATOMS)
    assert (status, solved) == (1, [])
    assert "holds another gap field than the finished step started from (well_depth_ratio = 4.0, point 2)" in said
    status, _, said = run(BASE, "--resume", output="md.nc", model=TOY_ATOMS)
    assert status == 1
    assert "--predictor is bem.nc there and none here" in said
