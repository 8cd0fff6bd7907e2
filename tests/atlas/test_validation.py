"""The validator accepts a sound dataset and names each thing that is wrong with a broken one."""

import numpy as np
import pytest
import xarray as xr

from contact_study.atlas.joining import sealed
from contact_study.atlas.validation import problems
from contact_study.results.schema import variable_of


def sound():
    steps = {
        "mean_pressure": [-1e5, 1e6, np.nan],
        "mean_gap": [2e-9, 1e-9, np.nan],
        "relative_contact_area": [0.0, 0.2, np.nan],
        "relative_repulsive_area": [0.0, 0.1, np.nan],
        "elastic_energy": [0.0, 1e-3, np.nan],
        "dissipated_energy": [0.0, 1e-4, np.nan],
        "converged": [1.0, 1.0, -1.0],
    }
    scalars = {
        "contact_modulus": 1e9,
        "work_of_adhesion": 0.05,
        "peak_tensile_stress": 1e7,
        "process_zone": 4e-9,
        "pixel": 1e-9,
        "pull_off_pressure": -2e5,
    }
    found = {name: ("step", values) for name, values in steps.items()} | scalars
    dataset = xr.Dataset(found)
    for name in dataset.data_vars:
        known = variable_of(name)
        dataset[name].attrs = {"units": known.units, "long_name": known.long_name}
    return sealed(dataset)


def test_a_sound_dataset_has_no_problem():
    assert problems(sound()) == []


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("relative_contact_area", [0.0, 1.2, np.nan], "outside 0 to 1"),
        ("relative_repulsive_area", [0.0, 0.3, np.nan], "exceeds relative_contact_area"),
        ("elastic_energy", [-1.0, 1e-3, np.nan], "outside 0 to inf"),
        ("mean_gap", [np.inf, 1e-9, np.nan], "infinite"),
        ("dissipated_energy", [1e-3, 1e-4, np.nan], "falls along the path"),
        ("converged", [1.0, 0.0, -1.0], "1 of 2 states did not converge"),
        ("pull_off_pressure", -2e7, "exceeds peak_tensile_stress"),
        ("process_zone", 3.9e-9, "exceeds a quarter of process_zone"),
    ],
)
def test_broken_numbers_are_named(name, values, words):
    broken = sound()
    broken[name] = broken[name].copy(data=np.asarray(values, np.float32))
    found = problems(sealed(broken))
    assert len(found) == 1
    assert found[0].startswith((name, "pixel"))
    assert words in found[0]


def test_missing_variables_units_and_words_are_named():
    broken = sound().drop_vars("mean_gap")
    broken["mean_pressure"].attrs = {"units": "MPa"}
    assert problems(sealed(broken)) == [
        "mean_gap: is missing",
        "mean_pressure: has no long_name",
        "mean_pressure: is in 'MPa'; expected 'Pa'",
    ]


def test_a_changed_number_breaks_the_checksum():
    broken = sound()
    broken["mean_gap"][1] *= 1.001
    assert [line.partition(":")[0] for line in problems(broken)] == ["content_sha256"]


def test_files_of_others_need_no_checksum_and_may_have_their_own_variables(tmp_path):
    dataset = sound()
    del dataset.attrs["content_sha256"]
    dataset["colour"] = 1.0
    dataset["colour"].attrs = {"units": "1", "long_name": "colour"}
    dataset.to_netcdf(tmp_path / "other.nc")
    assert problems(xr.load_dataset(tmp_path / "other.nc")) == []
