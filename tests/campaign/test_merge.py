"""Datasets of one study joined: what one run of the whole study writes, and nothing else."""

import shutil

import netCDF4
import numpy as np
import pytest
import tomli_w
import xarray as xr

from contact_study.campaign import merge as merging
from contact_study.campaign.dataset.file import States, states_file
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.start import contact_merge as merge_main
from tests.campaign.toy_model import SOLVED, TOY, TOY_ATOMS
from tests.campaign.toy_study import BASE, assert_same, changed
from tests.commands import main

SWEPT = {"sweep": {"interaction.well_depth_ratio": [1, 4], "surface.seed": [1, 2, 3]}}
WHOLE = changed(**SWEPT)
UNSWEPT = {section: keys for section, keys in BASE.items() if section != "sweep"}


pytestmark = pytest.mark.usefixtures("toy_is_the_continuum")


@pytest.fixture
def run(tmp_path):
    """Write a dataset of the toy."""

    def run_study(table, output, *arguments, model=TOY):
        (tmp_path / "study.toml").write_text(tomli_w.dumps(table))
        status = main(model, [str(tmp_path / "study.toml"), "-o", str(tmp_path / output), "--workers", "1", *arguments])
        assert status in (0, 2)
        return tmp_path / output

    return run_study


@pytest.fixture
def merge(tmp_path, capsys):
    """Join datasets; returns the status and what was said."""

    def merged(*arguments, output="all.nc"):
        capsys.readouterr()
        status = merge_main([*map(str, arguments), "-o", str(tmp_path / output)])
        return status, capsys.readouterr().err

    return merged


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """One dataset for each seed, as a job array writes them, and the whole."""
    folder = tmp_path_factory.mktemp("parts")
    (folder / "study.toml").write_text(tomli_w.dumps(WHOLE))
    for name, extra in {"whole": [], **{f"seed{n}": ["--surface.seed", str(n)] for n in (1, 2, 3)}}.items():
        assert main(TOY, [str(folder / "study.toml"), "-o", str(folder / f"{name}.nc"), "--workers", "1", *extra]) == 0
    return folder


def refused(status, said, *words):
    assert status == 1
    assert said.count("\n") == 1, said
    for word in words:
        assert word in said, said
    return True


def test_seeds_join_to_what_one_run_writes(parts, merge, tmp_path):
    SOLVED.clear()
    status, said = merge(parts / "seed3.nc", parts / "seed1.nc", parts / "seed2.nc")
    assert (status, said) == (0, "")
    assert SOLVED == []
    assert_same(tmp_path / "all.nc", parts / "whole.nc")
    with xr.open_datatree(tmp_path / "all.nc") as one, xr.open_datatree(parts / "whole.nc") as two:
        joined, expected = (States(states_file(path)) for path in (tmp_path / "all.nc", parts / "whole.nc"))
        for number in range(6):
            np.testing.assert_array_equal(joined.state(number)["state"], expected.state(number)["state"])
        for name in ("study_toml", "source", "model", "title", "warnings", "git_commit", "version"):
            assert one.attrs[name] == two.attrs[name], name
        assert len(one.attrs["history"].splitlines()) == 4
        assert one.attrs["history"].splitlines()[0].partition(": ")[2].startswith("contact-merge ")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["all.nc", "all.nc.restart"]


def test_warnings_are_those_of_one_run(run, merge, tmp_path):
    table = changed(sweep={"interaction.well_depth_ratio": [1, 2]}, solver={"max_iterations": 7})
    files = [run(table, f"{ratio}.nc", "--interaction.well_depth_ratio", ratio) for ratio in ("1", "2")]
    assert merge(*files)[0] == 0
    run(table, "whole.nc")
    with xr.open_dataset(tmp_path / "all.nc") as joined, xr.open_dataset(tmp_path / "whole.nc") as expected:
        assert joined.attrs["warnings"] == expected.attrs["warnings"] != ""


def test_joined_study_is_gone_on_from(parts, merge, run, tmp_path):
    merge(parts / "seed1.nc", parts / "seed2.nc")
    SOLVED.clear()
    run(WHOLE, "all.nc", "--resume")
    assert len(SOLVED) == 6
    assert_same(tmp_path / "all.nc", parts / "whole.nc")
    # Its states, too.
    longer = changed(**SWEPT, loading={"path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]})
    merge(parts / "seed1.nc", parts / "seed2.nc", parts / "seed3.nc", output="other.nc")
    SOLVED.clear()
    run(longer, "other.nc", "--resume")
    assert {number for _, number in SOLVED} == {3}


def test_values_in_other_units_are_one_point(run, merge, tmp_path):
    output = {"gap_range": ["0 nm", "4 nm"]}
    files = []
    for name, heights in (("one.nc", ["1 angstrom", "0.5 nm"]), ("two.nc", ["5 angstrom", "0.3 nm"])):
        files.append(
            run(changed(sweep={"surface.rms_height": heights}, surface={"rms_height": None}, output=output), name)
        )
    assert merge(*files)[0] == 0
    with xr.open_dataset(tmp_path / "all.nc") as joined:
        np.testing.assert_allclose(joined.rms_height, [1e-10, 3e-10, 5e-10], rtol=1e-15)
        for file in files:
            with xr.open_dataset(file) as part:
                at = {"rms_height": part.rms_height.values, "method": "nearest"}
                np.testing.assert_array_equal(joined.relative_contact_area.sel(**at), part.relative_contact_area)


def test_other_bins_are_brought_together(run, merge, tmp_path):
    table = changed(**SWEPT, output={"pressure_range": None})
    one = run(table, "one.nc", "--interaction.well_depth_ratio", "1")
    strong = run(table, "strong.nc", "--interaction.well_depth_ratio", "40")
    whole = run(table, "whole.nc", "--interaction.well_depth_ratio", "1, 40")
    status, said = merge(strong, one)
    assert status == 0
    assert "on other bins" in said
    with xr.open_dataset(tmp_path / "all.nc") as joined, xr.open_dataset(whole) as expected:
        np.testing.assert_array_equal(joined.pressure_bin, expected.pressure_bin)
        np.testing.assert_array_equal(joined.relative_contact_area, expected.relative_contact_area)
        np.testing.assert_array_equal(joined.well_depth_ratio, [1, 40])
        assert "on other bins" in joined.attrs["warnings"]


def test_samples_that_nobody_sweeps_become_seeds(run, merge, parts, tmp_path):
    files = [run(UNSWEPT, f"{seed}.nc", "--surface.seed", str(seed)) for seed in (10, 2)]
    assert merge(*files)[0] == 0
    whole = run({**UNSWEPT, "sweep": {"surface.seed": [2, 10]}}, "whole.nc")
    assert_same(tmp_path / "all.nc", whole)
    with xr.open_dataset(tmp_path / "all.nc") as joined, xr.open_dataset(whole) as expected:
        assert joined.seed.values.tolist() == [2, 10]
        assert joined.attrs["study_toml"] == expected.attrs["study_toml"]


def test_one_with_and_one_without_the_sweep(run, merge, tmp_path):
    swept = {**UNSWEPT, "sweep": {"surface.seed": [1, 2]}}
    files = [run(UNSWEPT, "alone.nc", "--surface.seed", "7"), run(swept, "swept.nc")]
    assert merge(*files)[0] == 0
    assert_same(tmp_path / "all.nc", run({**UNSWEPT, "sweep": {"surface.seed": [1, 2, 7]}}, "whole.nc"))


def test_a_key_that_nobody_sweeps_is_named_or_joined_along(run, merge, tmp_path):
    files = [run(UNSWEPT, f"{h}.nc", "--surface.hurst_exponent", h) for h in ("0.8", "0.7")]
    assert refused(
        *merge(*files),
        "are of different studies: surface.hurst_exponent is 0.8 in the one and 0.7 in the other",
        "--along surface.hurst_exponent",
    )
    assert not (tmp_path / "all.nc").exists()
    assert merge(*files, "--along", "surface.hurst_exponent") == (0, "")
    whole = run({**UNSWEPT, "sweep": {"surface.hurst_exponent": [0.7, 0.8]}}, "whole.nc")
    assert_same(tmp_path / "all.nc", whole)
    status, said = merge(*files, "--along", "surface.hurst", output="none.nc")
    assert refused(status, said, "--along surface.hurst: is no key", "surface.hurst_exponent?")


DIFFERENT = {
    "loading.path": {"loading": {"path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]}},
    "loading.unload": {"loading": {"unload": True}},
    "output.pressure_bins": {"output": {"pressure_bins": 100}},
}


@pytest.mark.parametrize("key", DIFFERENT)
def test_different_studies_are_refused_by_key(parts, run, merge, tmp_path, key):
    other = run(changed(**SWEPT, **DIFFERENT[key]), "other.nc", "--surface.seed", "2")
    for files in ((parts / "seed1.nc", other), (other, parts / "seed1.nc")):
        assert refused(*merge(*files), f"{files[0]} and {files[1]} are of different studies: {key} is ")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other.nc", "other.nc.restart", "study.toml"]


def test_exception_for_points_of_one_part_is_a_difference(parts, run, merge):
    exception = {"when": {"surface.seed": 2}, "loading.path": ["0.1 GPa", "3 GPa"]}
    own = run({**WHOLE, "override": [exception]}, "own.nc", "--surface.seed", "2")
    assert refused(
        *merge(parts / "seed1.nc", own), "loading.path is [1e+08, 1e+09, 2e+09] in the one and [1e+08, 3e+09]"
    )


def test_what_decides_nothing_may_differ(parts, run, merge, tmp_path):
    extra = {"study": {"title": "renamed"}, "theory": {"alpha": 2.0}, "solver": {"threads": 1}}
    other = run(
        changed(**SWEPT, surface={"size": "10 nm", "rms_height": 1e-10}, **extra), "o.nc", "--surface.seed", "2"
    )
    assert merge(parts / "seed1.nc", other, parts / "seed3.nc") == (0, "")
    assert_same(tmp_path / "all.nc", parts / "whole.nc")


def test_overlap_is_taken_once_where_it_agrees(parts, run, merge, tmp_path):
    pair = run(WHOLE, "pair.nc", "--surface.seed", "1, 2")
    status, said = merge(parts / "seed1.nc", pair, parts / "seed3.nc", parts / "seed2.nc")
    assert status == 0
    assert said == f"contact-merge: warning: {parts / 'seed2.nc'}: holds nothing that the datasets before it do not\n"
    assert_same(tmp_path / "all.nc", parts / "whole.nc")


@pytest.mark.parametrize("name", ["relative_contact_area", "gap", "contact_modulus"])
def test_overlap_that_disagrees_is_refused(parts, merge, tmp_path, name):
    shutil.copy(parts / "seed2.nc", tmp_path / "tampered.nc")
    with netCDF4.Dataset(tmp_path / "tampered.nc", "r+") as dataset:
        last = (-1,) * dataset[name].ndim
        dataset[name][last] = dataset[name][last] * (1 + 1e-12)
    status, said = merge(parts / "seed1.nc", parts / "seed2.nc", tmp_path / "tampered.nc")
    where = "" if name == "contact_modulus" else ", point 3"
    ratio = "1.0" if name == "contact_modulus" else "4.0"
    assert refused(
        status, said, f"disagree at well_depth_ratio = {ratio}, seed = 2{where}: {name} is ", "leave one of them"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["tampered.nc"]


def test_points_that_no_part_holds_are_named(run, merge):
    files = [
        run(WHOLE, f"{seed}{ratio}.nc", "--surface.seed", seed, "--interaction.well_depth_ratio", ratio)
        for seed, ratio in (("1", "1"), ("2", "4"))
    ]
    words = "the joined study lacks 2 of its 4 cases, first well_depth_ratio = 1.0, seed = 2"
    assert refused(*merge(*files), words)


def test_output_is_not_lost(parts, merge, tmp_path):
    files = parts / "seed1.nc", parts / "seed2.nc"
    (tmp_path / "all.nc").write_text("precious")
    assert refused(*merge(*files), "all.nc exists; use --overwrite")
    assert (tmp_path / "all.nc").read_text() == "precious"
    assert merge(*files, "--overwrite") == (0, "")
    assert refused(*merge(tmp_path / "all.nc", parts / "seed3.nc", "--overwrite"), "is one of the datasets to join")
    # Steps of a run that goes on there are not touched.
    (tmp_path / "new.nc.parts" / "case-1").mkdir(parents=True)
    assert refused(*merge(*files, output="new.nc"), "holds the steps of an unfinished run")
    assert (tmp_path / "new.nc.parts" / "case-1").is_dir()
    assert not (tmp_path / "new.nc.parts.lock").exists()


def test_interrupted_merge_leaves_nothing(parts, merge, tmp_path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(merging, "assemble_cases", interrupt)
    status, said = merge(parts / "seed1.nc", parts / "seed2.nc")
    assert (status, said) == (130, "contact-merge: interrupted; nothing was written\n")
    assert list(tmp_path.iterdir()) == []


def test_a_merge_killed_after_the_rename_is_finished_by_the_next(parts, merge, tmp_path, monkeypatch):
    files = parts / "seed1.nc", parts / "seed2.nc"
    with monkeypatch.context() as patch:
        patch.setattr(WorkDirectory, "_publish_states", lambda _: None)
        patch.setattr(WorkDirectory, "remove", lambda _: None)
        patch.setattr(WorkDirectory, "close", lambda work: work._lock.release())
        assert merge(*files)[0] == 0
    assert {"all.nc", "all.nc.parts"} <= {path.name for path in tmp_path.iterdir()}
    assert refused(*merge(*files), "all.nc exists; use --overwrite")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["all.nc", "all.nc.restart"]


def test_inputs_that_are_none(parts, run, merge, tmp_path):
    one = parts / "seed1.nc"
    assert refused(*merge(one), "give at least two datasets")
    assert refused(*merge(one, one), "is given twice")
    assert refused(*merge(one, tmp_path / "no.nc"), "does not exist")
    (tmp_path / "text.nc").write_text("text")
    assert refused(*merge(one, tmp_path / "text.nc"), "cannot be read as NetCDF")
    xr.Dataset({"a": 1}).to_netcdf(tmp_path / "foreign.nc")
    assert refused(*merge(one, tmp_path / "foreign.nc"), "is no dataset of bem-adhesion")
    atoms = run(WHOLE, "md.nc", "--surface.seed", "2", model=TOY_ATOMS)
    assert refused(*merge(one, atoms), "cannot be joined: model is continuum in the one and atomistic in the other")
    with xr.open_dataset(parts / "whole.nc") as dataset:
        dataset.isel(seed=[0, 1]).to_netcdf(tmp_path / "cut.nc")
    assert refused(*merge(one, tmp_path / "cut.nc"), "cut.nc: does not hold the points of seed that its study sweeps")


def test_predictors_of_the_parts_are_all_named(parts, run, merge, tmp_path):
    files = []
    for seed in ("1", "2"):
        start = tmp_path / f"start{seed}.nc"
        shutil.copy(parts / f"seed{seed}.nc", start)
        arguments = ("--surface.seed", seed, "--predictor", str(start))
        files.append(run(WHOLE, f"md{seed}.nc", *arguments, model=TOY_ATOMS))
    assert merge(*files)[0] == 0
    with xr.open_dataset(tmp_path / "all.nc") as dataset:
        assert [line.split()[0] for line in dataset.attrs["predictor"].splitlines()] == ["start1.nc", "start2.nc"]
    without = run(WHOLE, "without.nc", "--surface.seed", "3", model=TOY_ATOMS)
    assert refused(*merge(files[0], without, output="none.nc"), "one was run with --predictor, one without")


def test_height_maps_need_not_be_at_hand(run, merge, tmp_path):
    heights = np.random.default_rng(1).standard_normal((16, 16))
    np.save(tmp_path / "map.npy", heights)
    surface = {"kind": "file", "path": "map.npy", "height_unit": "angstrom", "rms_height": None, "cutoff_mode": None}
    table = changed(surface=surface, output={"pressure_range": ["-40 GPa", "100 GPa"], "gap_range": ["0 nm", "4 nm"]})
    files = [run(table, f"{ratio}.nc", "--interaction.well_depth_ratio", str(ratio)) for ratio in (1, 4)]
    whole = run(table, "whole.nc")
    (tmp_path / "map.npy").unlink()
    assert merge(*files) == (0, "")
    with xr.open_dataset(tmp_path / "all.nc") as joined, xr.open_dataset(whole) as expected:
        np.testing.assert_array_equal(joined.gap, expected.gap)
        np.testing.assert_allclose(joined.pressure_bin, expected.pressure_bin, rtol=1e-12)
        assert joined.attrs["height_maps"] == expected.attrs["height_maps"]
    np.save(tmp_path / "map.npy", 2 * heights)
    other = run(table, "other.nc", "--interaction.well_depth_ratio", "2")
    assert refused(*merge(files[0], other, output="none.nc"), "the height map map.npy had another content")
