import shutil

import netCDF4
import numpy as np
import pytest
import xarray as xr

from contact_study.campaign import merge as merging
from contact_study.campaign.dataset.file import States, states_file
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.start import contact_merge as merge_main
from tests.campaign.conftest import interrupt
from tests.campaign.toy_model import SOLVED, TOY_ATOMS
from tests.campaign.toy_study import BASE, LONGER_PATH, WHOLE, assert_same, changed, names

SWEPT = {"sweep": WHOLE["sweep"]}
UNSWEPT = {section: keys for section, keys in BASE.items() if section != "sweep"}
SEED, RATIO, HURST = "--surface.seed", "--interaction.well_depth_ratio", "--surface.hurst_exponent"

pytestmark = pytest.mark.usefixtures("toy_is_the_continuum")


def with_sweep(table=UNSWEPT, **keys):
    return {**table, "sweep": {name.replace("_", ".", 1): values for name, values in keys.items()}}


@pytest.fixture
def merge(tmp_path, capsys):
    def merged(*arguments, output="all.nc"):
        capsys.readouterr()
        status = merge_main([*map(str, arguments), "-o", str(tmp_path / output)])
        return status, capsys.readouterr().err

    return merged


@pytest.fixture(scope="module")
def seeds(built):
    return [built(WHOLE, SEED, str(number)) for number in (1, 2, 3)]


@pytest.fixture
def refused(merge, tmp_path):
    def refuse(arguments, *words, output="none.nc"):
        before = names(tmp_path)
        status, said = merge(*arguments, output=output)
        assert (status, said.count("\n")) == (1, 1), said
        for word in words:
            assert word in said, said
        assert names(tmp_path) == before

    return refuse


def test_seeds_join_to_what_one_run_writes(seeds, built, merge, tmp_path):
    whole = built(WHOLE)
    SOLVED.clear()
    assert merge(seeds[2], seeds[0], seeds[1]) == (0, "")
    assert SOLVED == []
    assert_same(tmp_path / "all.nc", whole)
    joined, expected = (States(states_file(path)) for path in (tmp_path / "all.nc", whole))
    for number in range(6):
        np.testing.assert_array_equal(joined.state(number)["state"], expected.state(number)["state"])
    with xr.open_dataset(tmp_path / "all.nc") as one, xr.open_dataset(whole) as two:
        own = ("history",)
        assert {**one.attrs, **dict.fromkeys(own)} == {**two.attrs, **dict.fromkeys(own)}
        history = one.attrs["history"].splitlines()
    assert len(history) == 4
    assert history[0].partition(": ")[2].startswith("contact-merge ")
    assert names(tmp_path) == ["all.nc", "all.nc.restart"]


WARNING = changed(sweep={"interaction.well_depth_ratio": [1, 2]}, solver={"max_iterations": 7})
BINS = changed(**SWEPT, output={"pressure_range": None})
FREE = {"study": {"title": "renamed"}, "theory": {"alpha": 2.0}, "solver": {"threads": 1}}
RENAMED = changed(**SWEPT, surface={"size": "10 nm"}, **FREE)

# The parts, each with its arguments; the study of the whole.
JOINED = {
    "warnings": ([(WARNING, RATIO, "1"), (WARNING, RATIO, "2")], WARNING),
    "seeds that nobody sweeps": ([(UNSWEPT, SEED, "10"), (UNSWEPT, SEED, "2")], with_sweep(surface_seed=[2, 10])),
    "a sweep": ([(UNSWEPT, SEED, "7"), (with_sweep(surface_seed=[1, 2]),)], with_sweep(surface_seed=[1, 2, 7])),
    "what decides nothing": ([(WHOLE, SEED, "1"), (RENAMED, SEED, "2"), (WHOLE, SEED, "3")], WHOLE),
    "an overlap": ([(WHOLE, SEED, "1"), (WHOLE, SEED, "1, 2"), (WHOLE, SEED, "3")], WHOLE),
}


@pytest.mark.parametrize(("parts", "whole"), JOINED.values(), ids=JOINED)
def test_joined_is_what_one_run_writes(built, merge, tmp_path, parts, whole):
    assert merge(*(built(*part) for part in parts))[0] == 0
    assert_same(tmp_path / "all.nc", built(whole))
    with xr.open_dataset(tmp_path / "all.nc") as joined, xr.open_dataset(built(whole)) as dataset:
        assert joined.attrs["warnings"] == dataset.attrs["warnings"]


def test_other_bins_are_said(built, merge, tmp_path):
    status, said = merge(*(built(BINS, RATIO, ratio) for ratio in ("40", "1")))
    assert status == 0
    assert "on other bins" in said
    whole = with_sweep(BINS, interaction_well_depth_ratio=[1, 40], surface_seed=[1, 2, 3])
    with xr.open_dataset(tmp_path / "all.nc") as joined, xr.open_dataset(built(whole)) as dataset:
        assert "on other bins" in joined.attrs["warnings"]
        for name in ("pressure_bin", "relative_contact_area", "well_depth_ratio"):
            np.testing.assert_array_equal(joined[name], dataset[name])


def test_values_in_other_units_are_one_point(built, merge, tmp_path):
    others = {"surface": {"rms_height": None}, "output": {"gap_range": ["0 nm", "4 nm"]}}
    heights = ["1 angstrom", "0.5 nm"], ["5 angstrom", "0.3 nm"]
    assert merge(*(built(changed(sweep={"surface.rms_height": two}, **others)) for two in heights))[0] == 0
    with xr.open_dataset(tmp_path / "all.nc") as joined:
        np.testing.assert_allclose(joined.rms_height, [1e-10, 3e-10, 5e-10], rtol=1e-15)


@pytest.mark.validation
def test_joined_study_is_gone_on_from(seeds, built, merge, run, tmp_path):
    merge(*seeds[:2])
    longer = changed(**SWEPT, loading=LONGER_PATH)
    for table, steps in ((WHOLE, 6), (longer, 6)):
        assert len(run(table, "--resume", output="all.nc")[1]) == steps
        assert_same(tmp_path / "all.nc", built(table))
    merge(*seeds, output="other.nc")
    assert {number for _, number in run(longer, "--resume", output="other.nc")[1]} == {3}  # its states, too


def test_a_key_that_nobody_sweeps_is_named_or_joined_along(built, merge, refused, tmp_path):
    files = [built(UNSWEPT, HURST, h) for h in ("0.8", "0.7")]
    words = "are of different studies: surface.hurst_exponent is 0.8 in the one and 0.7 in the other"
    refused(files, words, "--along surface.hurst_exponent")
    refused([*files, "--along", "surface.hurst"], "--along surface.hurst: is no key", "surface.hurst_exponent?")
    assert merge(*files, "--along", "surface.hurst_exponent") == (0, "")
    assert_same(tmp_path / "all.nc", built(with_sweep(surface_hurst_exponent=[0.7, 0.8])))


@pytest.mark.validation
def test_different_studies_are_refused_by_key(seeds, built, refused):
    for section, keys in (("loading", LONGER_PATH), ("loading", {"unload": True}), ("output", {"pressure_bins": 100})):
        other = built(changed(**SWEPT, **{section: keys}), SEED, "2")
        for files in ((seeds[0], other), (other, seeds[0])):
            refused(files, f"{files[0]} and {files[1]} are of different studies: {section}.{next(iter(keys))} is ")
    exception = {"when": {"surface.seed": 2}, "loading.path": ["0.1 GPa", "3 GPa"]}
    own = built({**WHOLE, "override": [exception]}, SEED, "2")
    refused((seeds[0], own), "loading.path is [1e+08, 1e+09, 2e+09] in the one and [1e+08, 3e+09]")


def test_what_an_overlap_does_not_need_is_said(seeds, built, merge):
    status, said = merge(seeds[0], built(WHOLE, SEED, "1, 2"), seeds[2], seeds[1])
    assert status == 0
    assert said == f"contact-merge: warning: {seeds[1]}: holds nothing that the datasets before it do not\n"


def test_overlap_that_disagrees_is_refused(seeds, refused, tmp_path):
    for name in ("relative_contact_area", "gap", "contact_modulus"):
        shutil.copy(seeds[1], tmp_path / "tampered.nc")
        with netCDF4.Dataset(tmp_path / "tampered.nc", "r+") as dataset:
            last = (-1,) * dataset[name].ndim
            dataset[name][last] = dataset[name][last] * (1 + 1e-12)
        where = "1.0, seed = 2" if name == "contact_modulus" else "4.0, seed = 2, point 3"
        words = f"disagree at well_depth_ratio = {where}: {name} is "
        refused((*seeds[:2], tmp_path / "tampered.nc"), words, "leave one of them")


def test_output_is_not_lost(seeds, merge, refused, tmp_path):
    (tmp_path / "all.nc").write_text("precious")
    refused(seeds[:2], "all.nc exists; use --overwrite", output="all.nc")
    assert (tmp_path / "all.nc").read_text() == "precious"
    assert merge(*seeds[:2], "--overwrite") == (0, "")
    refused((tmp_path / "all.nc", seeds[2], "--overwrite"), "is one of the datasets to join", output="all.nc")
    # Steps of a run that goes on there are not touched.
    (tmp_path / "new.nc.parts" / "case-1").mkdir(parents=True)
    refused(seeds[:2], "holds the steps of an unfinished run", output="new.nc")


def test_a_merge_interrupted_leaves_nothing_and_one_killed_is_finished_by_the_next(seeds, merge, tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(merging, "assemble_cases", interrupt)
        assert merge(*seeds[:2]) == (130, "contact-merge: interrupted; nothing was written\n")
    assert names(tmp_path) == []
    with monkeypatch.context() as patch:
        patch.setattr(WorkDirectory, "_publish_states", lambda _: None)
        patch.setattr(WorkDirectory, "remove", lambda _: None)
        patch.setattr(WorkDirectory, "close", lambda work: work._lock.release())
        assert merge(*seeds[:2])[0] == 0
    assert {"all.nc", "all.nc.parts"} <= set(names(tmp_path))
    status, said = merge(*seeds[:2])
    assert status == 1
    assert "all.nc exists; use --overwrite" in said
    assert names(tmp_path) == ["all.nc", "all.nc.restart"]


def test_inputs_that_are_none(seeds, built, refused, tmp_path):
    one = seeds[0]
    (tmp_path / "text.nc").write_text("text")
    xr.Dataset({"a": 1}).to_netcdf(tmp_path / "foreign.nc")
    with xr.open_dataset(built(WHOLE)) as dataset:
        dataset.isel(seed=[0, 1]).to_netcdf(tmp_path / "cut.nc")
    atoms = built(WHOLE, SEED, "2", model=TOY_ATOMS)
    corner = [built(WHOLE, SEED, at, RATIO, ratio) for at, ratio in (("1", "1"), ("2", "4"))]
    for arguments, words in (
        ([one], "give at least two datasets"),
        ([one, one], "is given twice"),
        ([one, tmp_path / "no.nc"], "does not exist"),
        ([one, tmp_path / "text.nc"], "cannot be read as NetCDF"),
        ([one, tmp_path / "foreign.nc"], "is no dataset of bem-adhesion"),
        ([one, atoms], "cannot be joined: model is continuum in the one and atomistic in the other"),
        ([one, tmp_path / "cut.nc"], "cut.nc: does not hold the points of seed that its study sweeps"),
        (corner, "the joined study lacks 2 of its 4 cases, first well_depth_ratio = 1.0, seed = 2"),
    ):
        refused(arguments, words)


@pytest.mark.validation
def test_predictors_of_the_parts_are_all_named(seeds, run, merge, refused, tmp_path):
    for at, seed in enumerate(seeds[:2]):
        shutil.copy(seed, tmp_path / f"start{at}.nc")
        start = ("--predictor", str(tmp_path / f"start{at}.nc"))
        run(WHOLE, SEED, f"{at + 1}", *start, output=f"md{at}.nc", model=TOY_ATOMS)
    assert merge(tmp_path / "md0.nc", tmp_path / "md1.nc")[0] == 0
    with xr.open_dataset(tmp_path / "all.nc") as dataset:
        assert [line.split()[0] for line in dataset.attrs["predictor"].splitlines()] == ["start0.nc", "start1.nc"]
    run(WHOLE, SEED, "3", output="without.nc", model=TOY_ATOMS)
    refused((tmp_path / "md0.nc", tmp_path / "without.nc"), "one was run with --predictor, one without")


def test_height_maps_need_not_be_at_hand(run, merge, refused, tmp_path):
    heights = np.random.default_rng(1).standard_normal((16, 16))
    np.save(tmp_path / "map.npy", heights)
    surface = {"kind": "file", "path": "map.npy", "height_unit": "angstrom", "rms_height": None, "cutoff_mode": None}
    table = changed(surface=surface, output={"gap_range": ["0 nm", "4 nm"]})
    files = [tmp_path / name for name in ("1.nc", "4.nc", "2.nc")]
    run(table, output="whole.nc")
    for file in files[:2]:
        run(table, RATIO, file.stem, output=file.name)
    (tmp_path / "map.npy").unlink()
    assert merge(*files[:2]) == (0, "")
    joined, expected = (xr.load_dataset(tmp_path / name) for name in ("all.nc", "whole.nc"))
    np.testing.assert_array_equal(joined.gap, expected.gap)
    np.testing.assert_allclose(joined.pressure_bin, expected.pressure_bin, rtol=1e-12)
    assert joined.attrs["height_maps"] == expected.attrs["height_maps"]
    np.save(tmp_path / "map.npy", 2 * heights)
    run(table, RATIO, "2", output="2.nc")
    refused((files[0], files[2]), "the map map.npy had another content")
