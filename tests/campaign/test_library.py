"""Studies from Python: the command's dataset, nothing left behind, and errors that name the argument or key."""

import copy
import importlib.metadata
import tomllib

import numpy as np
import pytest
import tomli_w
import xarray as xr

import bem_adhesion.run
import contact_study
from contact_study import run

STUDY = tomllib.loads("""
[surface]
kind = "self_affine"
size = "41.6 angstrom"
shape = [16, 16]
rms_height = "1 angstrom"
cutoff_mode = 4
[material]
youngs_modulus = "77.2 GPa"
poissons_ratio = 0.42
lattice_constant = "2.6 angstrom"
[interaction]
work_of_adhesion = 0.1
length = "3.28 angstrom"
[loading]
path = ["0.5 GPa", "2 GPa"]
[sweep]
"surface.seed" = [1, 2]
""")


def changed(**sections):
    table = copy.deepcopy(STUDY)
    for section, keys in sections.items():
        table.setdefault(section, {}).update(keys)
    return table


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def assert_same(one, other):
    xr.testing.assert_identical(one.drop_vars("wall_time").drop_attrs(), other.drop_vars("wall_time").drop_attrs())


def test_a_table_gives_the_dataset_of_the_command_and_leaves_nothing(tmp_path):
    table = copy.deepcopy(STUDY)
    dataset = run(table)
    assert table == STUDY
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "study.toml").write_text(tomli_w.dumps(STUDY))
    assert bem_adhesion.run.main(["study.toml", "-o", "bem.nc", "--workers", "1"]) == 0
    with xr.open_dataset("bem.nc") as written:
        assert_same(dataset, written)
        assert dataset.attrs["study_toml"] == written.attrs["study_toml"]
    assert dataset.relative_contact_area.dims == ("seed", "step")
    assert "contact_study.run(..., 'continuum')" in dataset.attrs["history"]
    assert_same(run("study.toml"), dataset)


def test_arrays_and_tuples_are_values():
    given = changed(loading={"path": np.array([0.5e9, 2e9])}, surface={"shape": (np.int64(16), 16)})
    assert_same(run(given), run(STUDY))


@pytest.mark.parametrize("model", ["atomistic", "theory"])
def test_models_by_name(model):
    dataset = run(changed(sweep={"surface.seed": [1]}), model)
    assert dataset.attrs["model"] == model
    assert (dataset.converged == 1).all()


def test_an_output_is_written_kept_and_gone_on_from(tmp_path):
    dataset = run(STUDY, output="out.nc")
    with xr.open_dataset(tmp_path / "out.nc") as written:
        assert_same(dataset, written)
    with pytest.raises(ValueError, match=r"out\.nc exists"):
        run(STUDY, output="out.nc")
    wider = changed(sweep={"surface.seed": [1, 2, 3]})
    assert run(wider, output="out.nc", resume=True).sizes["seed"] == 3
    assert run(STUDY, output="out.nc", overwrite=True).sizes["seed"] == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.nc"]


@pytest.mark.parametrize(
    ("table", "arguments", "culprit"),
    [
        (changed(interaction={"work_of_adhesion": -1.0}), {}, "interaction.work_of_adhesion"),
        (changed(interaction={"length": "long"}), {}, "interaction.length"),
        (changed(surface={"shape": [16]}), {}, "surface.shape"),
        (changed(surface={"rms_height": float("nan")}), {}, "surface.rms_height"),
        (changed(material={"young": 1e9}), {}, "young"),
        (changed(solid={}), {}, "solid"),
        ([1, 2], {}, r"study = \[1, 2\]"),
        ("missing.toml", {}, "missing.toml"),
        (STUDY, {"model": "bem"}, "model = 'bem': expected one of continuum, atomistic, theory"),
        (STUDY, {"workers": 0}, "workers = 0"),
        (STUDY, {"engine": "cloud"}, "engine 'cloud'"),
        (STUDY, {"predictor": "bem.nc"}, "predictor: the model 'continuum' takes none"),
        (STUDY, {"model": "atomistic", "predictor": "none.nc"}, "none.nc does not exist"),
        (STUDY, {"resume": True}, "resume: needs an output"),
        (STUDY, {"output": "a.nc", "resume": True, "overwrite": True}, "resume and overwrite"),
    ],
)
def test_mistakes_are_value_errors_that_name_the_culprit(tmp_path, table, arguments, culprit):
    with pytest.raises(ValueError, match=culprit):
        run(table, **arguments)
    assert list(tmp_path.iterdir()) == []


def test_inputs_are_not_overwritten(tmp_path):
    (tmp_path / "study.toml").write_text(tomli_w.dumps(STUDY))
    with pytest.raises(ValueError, match="is read by this run"):
        run("study.toml", output="study.toml", overwrite=True)


def test_what_the_command_warns_of_is_a_warning_here():
    coarse = changed(solver={"max_iterations": 1}, surface={"size": "4000 angstrom", "rms_height": "40 angstrom"})
    with (
        pytest.warns(UserWarning, match="quarter of the process zone") as review,
        pytest.warns(UserWarning, match="4 of 4 steps did not converge") as end,
    ):
        dataset = run(coarse)
    assert {warning.filename for warning in [*review, *end]} == {__file__}
    assert (dataset.converged == 0).all()


def test_the_face_of_the_package():
    assert set(contact_study.__all__) <= set(dir(contact_study))
    for name in contact_study.__all__:
        assert getattr(contact_study, name).__doc__
    with pytest.raises(AttributeError, match="no attribute 'walk'"):
        _ = contact_study.walk
    assert importlib.metadata.version("bem-adhesion") == contact_study.__version__


def test_a_height_array_is_a_surface(tmp_path):
    height = 2e-11 * np.random.default_rng(0).standard_normal((16, 24))
    study = {name: keys for name, keys in STUDY.items() if name not in ("surface", "sweep")}
    own = study | {"surface": {"heights": height, "size": (4e-9, 6e-9)}}
    dataset = run(own)
    np.save("map.npy", height)
    of_a_map = run(study | {"surface": {"kind": "file", "path": "map.npy", "size": [4e-9, 6e-9]}})
    xr.testing.assert_equal(dataset.drop_vars("wall_time"), of_a_map.drop_vars("wall_time"))
    assert dataset.rms_height == pytest.approx(height.std(), rel=1e-12)
    # The same array goes on where the file ends; another one is another study.
    run(own, output="own.nc")
    longer = own | {"loading": {"path": ["0.5 GPa", "2 GPa", "1 GPa"]}}
    assert run(longer, output="own.nc", resume=True).sizes["step"] == 3
    with pytest.raises(ValueError, match=r"heights\.npy has changed"):
        run(own | {"surface": {"heights": 2 * height, "size": (4e-9, 6e-9)}}, output="own.nc", resume=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.npy", "own.nc"]


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        ({"heights": "map.npy", "size": 1e-8}, "surface.heights must be an array"),
        ({"heights": np.full((8, 8), np.nan), "size": 1e-8}, "surface.heights is not finite"),
        ({"heights": np.eye(8)}, "size"),
        ({"heights": np.eye(8), "size": 1e-8, "kind": "sphere"}, "surface.kind"),
        ({"heights": np.eye(8), "size": 1e-8, "height_unit": "nm"}, "surface.height_unit"),
        ({"heights": np.eye(8), "size": 1e-8, "radius": 1e-8}, "surface.radius"),
    ],
)
def test_bad_height_arrays_are_named(surface, message):
    study = {name: keys for name, keys in STUDY.items() if name not in ("surface", "sweep")}
    with pytest.raises(ValueError, match=message):
        run(study | {"surface": surface})
