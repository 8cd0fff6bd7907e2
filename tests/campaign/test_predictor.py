import re
from functools import partial

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.dataset.predictor import GapFields, check_predictor
from contact_study.inputs.errors import InputError
from contact_study.study.study import make_study
from tests.study.test_study import changed, of_another_kind

PATH = [1e8, 1e9, 1e8, 2e9]


def study(ratio=(1, 4), seed=1, **sections):
    if isinstance(ratio, tuple):
        table = changed("sweep", **{"interaction.well_depth_ratio": [*ratio]})
    else:
        table = changed("interaction", well_depth_ratio=ratio)
        table["surface"]["seed"] = seed
        if "kind" in sections.get("surface", {}):
            of_another_kind(table)
    table["loading"]["path"] = PATH
    for name, keys in sections.items():
        table.setdefault(name, {}).update(keys)
    return make_study(table)


def content_of(study, path, **attrs):
    shape = (*(len(key.values) for key in study.sweep.values()), len(PATH))
    dims = (*study.sweep, "step")
    gap = np.arange(float(np.prod(shape))).reshape(shape)[..., None, None] + np.zeros((3, 5))
    data = {"gap": ((*dims, "y", "x"), gap)}
    data |= {name: (dims, np.full(shape, value, np.int8)) for name, value in (("converged", 1), ("detached", 0))}
    coordinates = {name: list(key.values) for name, key in study.sweep.items()}
    coordinates |= {"applied_pressure": ("step", PATH), "branch": ("step", np.zeros(4, np.int8))}
    xr.Dataset(data, coordinates, {"study_toml": study.toml, **attrs}).to_netcdf(path)
    return path


single = partial(study, 4.0)


@pytest.fixture
def dataset(tmp_path):
    content = xr.load_dataset(content_of(study(), tmp_path / "all.nc"))
    content["converged"][1, 1] = 0
    content.to_netcdf(tmp_path / "bem.nc")
    return tmp_path / "bem.nc"


@pytest.mark.parametrize(
    ("ratio", "loading", "found"),
    [
        (4, {}, [4.0, None, 6.0, 7.0, None]),  # of the same visit; the second is not converged; no such pressure
        (4, {"path": [1e8, 1e9, 1e8, 1e8]}, [4.0, None, 6.0, None]),  # a further visit is another point
        (2, {}, [None]),  # no such case
        (1, {"unload": True}, [0.0, 1.0, 2.0, 3.0, None, None]),  # on the other branch
    ],
)
def test_field_of_the_same_visit(dataset, ratio, loading, found):
    fields = GapFields(dataset, study((ratio,), loading={"path": [*PATH, 3e9], **loading}).cases[0])
    at = [fields(number) for number in range(len(found))]
    assert [field if field is None else field[0, 0] for field in at] == found
    assert all(field is None or field.shape == (3, 5) for field in at)


def test_unusable_predictor(tmp_path):
    path = tmp_path / "bem.nc"
    for make, words in (
        (lambda: path.write_bytes(b"garbage"), "cannot be read as NetCDF"),
        (lambda: xr.Dataset({"mean_gap": ("step", [1.0])}).to_netcdf(path), "holds no gap fields"),
        (lambda: content_of(single(), path, study_toml="[surface]\nkind = 3"), "its study is not one this version"),
    ):
        make()
        with pytest.raises(InputError, match=rf"--predictor.*bem\.nc.* {words}"):
            check_predictor(path, study(), {})


def test_dataset_that_sweeps_more_than_the_run(tmp_path):
    swept = study(sweep={"interaction.well_depth_ratio": [1, 4], "surface.seed": [1, 2, 3]})
    path = content_of(swept, tmp_path / "bem.nc")
    (case,) = single(seed=2).cases
    assert check_predictor(path, single(seed=2), {}) == []
    # Position [1, 1] of 2 x 3 cases of four states each.
    assert [GapFields(path, case)(number)[0, 0] for number in range(4)] == [16.0, 17.0, 16.0 + 2, 19.0]
    assert GapFields(path, single(seed=9).cases[0])(0) is None


def test_run_that_sweeps_more_than_the_dataset(tmp_path):
    path = content_of(single(), tmp_path / "bem.nc")
    one, four = study().cases
    assert GapFields(path, one)(0) is None
    assert GapFields(path, four)(0)[0, 0] == 0.0
    # What the continuum does not know is no reason to have no start.
    for key in ("atomistic.cutoff", "solver.tolerance", "theory.alpha"):
        swept = make_study({**single().table, "sweep": {key: [3.0, 5.0] if "tol" not in key else [1e-9, 1e-8]}})
        assert all(GapFields(path, case)(1)[0, 0] == 1.0 for case in swept.cases)


def test_states_of_other_accuracy_yield_to_those_of_the_same(tmp_path):
    swept = study(sweep={"interaction.well_depth_ratio": [4], "solver.tolerance": [1e-6, 1e-8]})
    path = content_of(swept, tmp_path / "bem.nc")
    for tolerance, found in ((1e-8, 4.0), (1e-6, 0.0), (1e-7, 0.0)):
        assert GapFields(path, single(solver={"tolerance": tolerance}).cases[0])(0)[0, 0] == found


OTHERS = {
    "surface.seed is 1 there and 2 here": {"surface": {"seed": 2}},
    "surface.rms_height is 1e-09 there and 9e-10 here": {"surface": {"rms_height": "9 angstrom"}},
    "loading.control is pressure there and gap here": {"loading": {"control": "gap", "path": ["1 nm"]}},
    'atomistic.method = "overdamped" start from separation': {"atomistic": {"method": "overdamped"}},
    'atomistic.method = "dynamics" start from separation': {"atomistic": {"method": "dynamics"}},
}
SAID = {
    "material.youngs_modulus is 7.72e+10 there and 7.6e+10 here": {"material": {"youngs_modulus": "76 GPa"}},
    "the work of adhesion is 2.76": {"interaction": {"well_depth_ratio": 8}},
    "interaction.length is 3.28e-10 there and 3.3e-10 here": {"interaction": {"length": "3.3 angstrom"}},
}
NOT_SAID = [
    {"surface": {"shape": [128, 128]}},  # another grid of the same surface
    {"interaction": {"contact_distance": "3.8 angstrom"}},
    {"material": {"atom_mass": "197 u"}},
    {"solver": {"tolerance": 1e-10}},
    {"surface": {"size": "104 nm"}},  # as written elsewhere: 1040 angstrom
]


def test_what_may_differ_from_the_predictor(tmp_path):
    path = content_of(single(), tmp_path / "bem.nc")
    for words, sections in OTHERS.items():
        with pytest.raises(InputError, match=f"--predictor.*{re.escape(words)}"):
            check_predictor(path, single(**sections), {})
    for words, sections in SAID.items():
        notes = check_predictor(path, single(**sections), {})
        assert any(words in note for note in notes)
        assert all("may select other states" in note for note in notes)
    for sections in NOT_SAID:
        assert check_predictor(path, single(**sections), {}) == []


def test_predictor_of_another_height_map(tmp_path):
    def mapped(name):
        np.save(tmp_path / name, np.eye(8))
        surface = {"kind": "file", "path": name, "height_unit": "angstrom", "shape": [8, 8]}
        return make_study(single(surface=surface).table, tmp_path)

    path = content_of(mapped("one.npy"), tmp_path / "bem.nc", height_maps="sha256:abc one.npy")
    assert check_predictor(path, mapped("two.npy"), {"two.npy": "abc"}) == []
    with pytest.raises(InputError, match=r"another height map than two\.npy"):
        check_predictor(path, mapped("two.npy"), {"two.npy": "def"})


def test_padded_fields_come_without_their_padding(tmp_path):
    path = content_of(single(), tmp_path / "bem.nc")
    with xr.open_dataset(path) as dataset:
        padded = dataset.load().pad(y=(0, 4), x=(0, 1))
    padded["gap"][0, 1, 1] = np.inf  # no padding
    padded.attrs = {"study_toml": single().toml}
    padded.to_netcdf(tmp_path / "padded.nc")
    field = GapFields(tmp_path / "padded.nc", single().cases[0])(0)
    assert field.shape == (3, 5)
    assert np.isinf(field[1, 1])
    padded["gap"][0] = np.nan  # not among output.field_steps
    padded.to_netcdf(tmp_path / "chosen.nc")
    fields = GapFields(tmp_path / "chosen.nc", single().cases[0])
    assert (fields(0), fields.fingerprint(0), fields(1).shape) == (None, "", (3, 5))
