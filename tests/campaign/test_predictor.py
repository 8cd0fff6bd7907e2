"""Gap fields of another dataset are found by case, pressure and visit."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.predictor import GapFields, check_predictor
from contact_study.problem.errors import InputError
from contact_study.problem.study import make_study
from tests.problem.test_study import changed

PATH = [1e8, 1e9, 1e8, 2e9]


@pytest.fixture
def dataset(tmp_path):
    gap = np.arange(2.0 * 4)[:, None] + np.zeros(2 * 4 * 3 * 5).reshape(8, 15)
    content = xr.Dataset(
        {
            "gap": (("well_depth_ratio", "step", "y", "x"), gap.reshape(2, 4, 3, 5)),
            "converged": (("well_depth_ratio", "step"), np.array([[1, 1, 1, 1], [1, 0, 1, 1]], np.int8)),
            "detached": (("well_depth_ratio", "step"), np.zeros((2, 4), np.int8)),
        },
        {
            "well_depth_ratio": [1.0, 4.0],
            "applied_pressure": ("step", PATH),
            "branch": ("step", np.zeros(4, np.int8)),
        },
    )
    content.attrs["study_toml"] = study().toml
    path = tmp_path / "bem.nc"
    content.to_netcdf(path)
    return path


def study(ratios=(1, 4), **sections):
    """The study of the dataset, or another with further sections and keys."""
    table = changed("sweep", **{"interaction.well_depth_ratio": list(ratios)})
    table["loading"]["path"] = PATH
    for name, keys in sections.items():
        table.setdefault(name, {}).update(keys)
    return make_study(table)


def case(ratio):
    table = changed("sweep", **{"interaction.well_depth_ratio": [ratio]})
    table["loading"]["path"] = [*PATH, 3e9]
    return make_study(table).cases[0]


def test_field_of_the_same_visit(dataset):
    fields = GapFields(dataset, case(4.0))
    assert [fields(number)[0, 0] for number in (0, 2, 3)] == [4.0, 6.0, 7.0]
    assert fields(0).shape == (3, 5)


def test_nothing_where_there_is_no_usable_state(dataset):
    fields = GapFields(dataset, case(4.0))
    assert fields(1) is None  # not converged
    assert fields(4) is None  # no such pressure
    assert GapFields(dataset, case(2.0))(0) is None  # no such case


def test_branch_counts(dataset):
    unloading = case(1.0)
    unloading = dataclasses.replace(unloading, loading=dataclasses.replace(unloading.loading, unload=True))
    assert GapFields(dataset, unloading)(5) is None


@pytest.mark.parametrize("content", [None, b"garbage", "no gap"])
def test_unusable_predictor(tmp_path, content):
    path = tmp_path / "bem.nc"
    if content == "no gap":
        xr.Dataset({"mean_gap": ("step", [1.0])}).to_netcdf(path)
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match="--predictor"):
        check_predictor(path, study(), {})
