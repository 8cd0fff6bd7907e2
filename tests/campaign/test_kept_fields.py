import copy

import numpy as np
import pytest
import xarray as xr

import contact_study
from contact_study import plots
from contact_study.inputs.errors import InputError
from contact_study.study.study import make_study

STUDY = {
    "surface": {"kind": "wavy", "size": "10 nm", "shape": [16, 24], "amplitude": "0.2 nm", "modes": [1, 1]},
    "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.5, "lattice_constant": "0.625 nm"},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": ["1 MPa", "5 MPa", "20 MPa"], "unload": True},
    "output": {"fields": True},
}
SHORT = ["1 MPa", "5 MPa"]


def study(path=None, **output):
    table = copy.deepcopy(STUDY)
    table["output"] |= output
    if path:
        table["loading"] = {"path": path}
    return table


@pytest.fixture(scope="module")
def whole():
    return contact_study.run(study())


@pytest.mark.parametrize("name", ["bem.nc", "bem.zarr"])
def test_chosen_points_in_single_precision(whole, tmp_path, name):
    pytest.importorskip("zarr") if name.endswith("zarr") else None
    options = {"field_steps": [1, -1, -1], "field_precision": "single"}
    contact_study.run(study(**options), output=tmp_path / name)
    found = xr.load_dataset(tmp_path / name, **({"engine": "zarr"} if name.endswith("zarr") else {}))
    for field in ("gap", "pressure"):
        assert found[field].dtype == np.float32
        kept = found[field].notnull()
        assert kept.all(("y", "x")).values.tolist() == kept.any(("y", "x")).values.tolist() == [0, 1, 0, 0, 1]
        np.testing.assert_array_equal(found[field][[1, 4]], whole[field][[1, 4]].astype(np.float32))
    for number in ("relative_contact_area", "elastic_energy", "pressure_pdf", "height"):
        np.testing.assert_array_equal(found[number], whole[number])
        assert found[number].dtype == np.float64
    plots.gap_map(found.isel(step=1))
    with pytest.raises(ValueError, match=r"keeps no gap of this point .* output\.field_steps chose others"):
        plots.gap_map(found.isel(step=2))


def test_what_cannot_be_kept_is_named():
    for output, words in (
        ({"field_steps": [0, 5]}, r"output\.field_steps: 5 is no point of the path, which has 5: 0 to 4"),
        ({"field_steps": [-6]}, r"output\.field_steps: -6 is no point"),
        ({"field_steps": [0.5]}, r"output\.field_steps\[0\] = 0\.5: expected a whole number"),
        ({"field_steps": []}, r"output\.field_steps = \[\]: is empty"),
        ({"field_precision": "half"}, r"output\.field_precision = 'half': expected one of double, single"),
        ({"fields": False, "field_steps": [0]}, r"output\.field_steps: no fields are kept; set output\.fields = true"),
        ({"fields": False, "field_precision": "single"}, r"output\.field_precision: no fields are kept"),
    ):
        with pytest.raises(InputError, match=words):
            make_study(study(**output))


def test_a_point_of_some_path_is_enough():
    table = study(field_steps=[4], path=["1 MPa"])
    table["sweep"] = {"material.poissons_ratio": [0.3, 0.4]}
    longer = {"when": {"material.poissons_ratio": 0.4}, "loading.path": [f"{p} MPa" for p in (1, 2, 3, 4, 5)]}
    table["override"] = [longer]
    assert [case.kept_fields for case in make_study(table).cases] == [frozenset(), {4}]


@pytest.mark.filterwarnings("ignore:computed again")
@pytest.mark.parametrize(
    ("before", "after"),
    [
        ({"field_steps": [1]}, {"field_steps": [1, 3]}),
        ({"field_steps": [1]}, {}),
        ({"field_precision": "single"}, {"field_precision": "double"}),
        ({"field_steps": [0, 1], "path": SHORT}, {"field_steps": [0, 1], "path": [*SHORT, "9 MPa"]}),
    ],
)
def test_a_run_that_keeps_more_is_what_a_fresh_one_is(before, after, tmp_path):
    contact_study.run(study(**before), output=tmp_path / "bem.nc")
    found = contact_study.run(study(**after), output=tmp_path / "bem.nc", resume=True)
    fresh = contact_study.run(study(**after))
    for name in ("gap", "pressure"):
        xr.testing.assert_identical(found[name], fresh[name])


def test_a_run_gives_nothing_up(tmp_path):
    contact_study.run(study(), output=tmp_path / "bem.nc")
    for after, words in (
        ({"field_steps": [1]}, r"it keeps fields of points that output\.field_steps leaves out: name"),
        ({"fields": False}, r"it keeps fields by output\.fields = true, this study has false: set it so"),
        ({"field_precision": "single"}, r"output\.field_precision = double, this study has single: set it so"),
    ):
        with pytest.raises(InputError, match=words):
            contact_study.run(study(**after), output=tmp_path / "bem.nc", resume=True)
