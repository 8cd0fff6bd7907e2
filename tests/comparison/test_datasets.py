"""Which datasets may be compared, and what is said of those that may not."""

import shutil

import numpy as np
import pytest
import xarray as xr

from contact_study.comparison.datasets import field_at, read_inputs
from contact_study.problem.errors import InputError
from tests.comparison.synthetic import STUDY, write, write_all


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("datasets"))


def test_models_are_recognised_in_any_order(files):
    inputs = read_inputs(files[::-1])
    assert list(inputs.models) == ["atomistic", "continuum", "theory", "gap_flow"]
    assert {kind: path.name for kind, path in inputs.paths.items()} == {
        "continuum": "continuum.nc",
        "atomistic": "atomistic.nc",
        "theory": "theory.nc",
    }
    assert inputs.notes == ()
    assert inputs.control == "pressure"


def test_fields_stay_in_their_file(files):
    inputs = read_inputs(files[:2])
    assert "gap" not in inputs.models["continuum"]
    assert inputs.models["continuum"]["height"].dims == ("y", "x")
    field = field_at(files[0], "gap", {"well_depth_ratio": 8.0}, 1)
    with xr.open_dataset(files[0]) as dataset:
        np.testing.assert_array_equal(field, dataset["gap"].sel(well_depth_ratio=8).isel(step=1))
    assert field_at(files[2], "gap", {}, 0) is None


def refused(paths):
    with pytest.raises(InputError) as caught:
        read_inputs(paths)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_one_model_is_no_comparison(files):
    assert "at least two models" in refused(files[:1])


def test_one_model_twice(files, tmp_path):
    again = tmp_path / "again.nc"
    shutil.copy(files[0], again)
    assert "continuum model" in refused([files[0], again])


def test_missing_file(files, tmp_path):
    assert "does not exist" in refused([files[0], tmp_path / "nowhere.nc"])
    assert "is a folder" in refused([files[0], tmp_path])


@pytest.mark.parametrize("share", [0.0, 0.3, 0.95])
def test_truncated_file(files, tmp_path, share):
    cut = tmp_path / "cut.nc"
    whole = files[1].read_bytes()
    cut.write_bytes(whole[: int(share * len(whole))])
    message = refused([files[0], cut])
    assert str(cut) in message
    assert "NetCDF" in message


def test_foreign_datasets(files, tmp_path):
    foreign = tmp_path / "foreign.nc"
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(foreign)
    assert "is no dataset of bem-adhesion" in refused([files[0], foreign])
    text = tmp_path / "text.nc"
    text.write_text("not NetCDF")
    assert "cannot be read as NetCDF" in refused([files[0], text])


def test_dataset_of_another_schema_or_without_study(files, tmp_path):
    later = write(tmp_path / "later.nc", "atomistic", schema_version="2.0")
    assert "schema version 2.0" in refused([files[0], later])
    broken = write(tmp_path / "broken.nc", "atomistic", study_toml="[surface]\nkind = 3")
    assert "its study is not one this version can read" in refused([files[0], broken])


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('rms_height = "10 angstrom"', 'rms_height = "9 angstrom"', "surface.rms_height"),
        ("poissons_ratio = 0.42", "poissons_ratio = 0.3", "material.poissons_ratio"),
        ('length = "3.28 angstrom"', 'length = "3.3 angstrom"', "interaction.length"),
        ("[1, 8]", "[2, 3]", "sweeps have no point in common"),
        ('normalisation = "realised"', 'normalisation = "realised"\nseed = 7', "surface.seed"),
    ],
)
def test_different_contacts_are_refused(files, tmp_path, old, new, key):
    assert old in STUDY
    other = write(tmp_path / "other.nc", "atomistic", STUDY.replace(old, new))
    message = refused([files[0], other])
    assert key in message
    assert "cannot be compared" in message


def test_same_values_in_other_units_are_the_same(files, tmp_path):
    other = write(tmp_path / "other.nc", "atomistic", STUDY.replace('"77.2 GPa"', "77.2e9"))
    assert read_inputs([files[0], other]).notes == ()


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("[24, 24]", "[32, 32]", "surface.shape"),
        ('"0.1 GPa", "0.7799 GPa", "5.8725 GPa"]\n[output]', '"0.1 GPa", "0.7799 GPa"]\n[output]', "loading.path"),
        ('contact_distance = "3.68 angstrom"', 'contact_distance = "3.741 angstrom"', "interaction.contact_distance"),
    ],
)
def test_other_differences_are_noted(files, tmp_path, old, new, key):
    assert old in STUDY
    other = write(tmp_path / "other.nc", "atomistic", STUDY.replace(old, new))
    notes = read_inputs([files[0], other]).notes
    assert any(key in note for note in notes)


def test_a_theory_of_the_ensemble_needs_no_seed(files, tmp_path):
    seeded = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2]\n')
    simulated = write(tmp_path / "seeds.nc", "continuum", seeded)
    assert read_inputs([simulated, files[2]]).notes == ()
