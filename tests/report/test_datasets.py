"""Which datasets may be compared, and what is said of those that may not."""

import dataclasses
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.record import key_values
from contact_study.inputs.errors import InputError
from contact_study.report.align.cases import sweep_points
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.files import field_at
from contact_study.report.read.studies import ONE_CONTACT, check_studies
from contact_study.study.schema.dotted_keys import all_keys
from tests.report.synthetic import STUDY, study, write, write_all

SINGLE = STUDY[: STUDY.index("[sweep]")]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("datasets"))


def test_models_are_recognised_in_any_order(files):
    inputs = read_inputs(files[::-1])
    assert list(inputs.models) == ["atomistic", "continuum", "persson", "gap_flow"]
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
    later = write(tmp_path / "later.nc", "atomistic", schema_version="3.0")
    assert "schema version 3.0" in refused([files[0], later])
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


def with_another(asked, section, name):
    """The study with another value of one key in every case, unchecked."""
    cases = []
    for case in asked.cases:
        changed = dataclasses.replace(getattr(case, section))
        object.__setattr__(changed, name, "another")
        cases.append(dataclasses.replace(case))
        object.__setattr__(cases[-1], section, changed)
    return dataclasses.replace(asked, cases=tuple(cases))


@pytest.mark.parametrize("key", [key for key, _ in key_values(study().cases[0])])
def test_a_difference_in_any_key_is_refused_or_said(key):
    paths = {"continuum": Path("c.nc"), "atomistic": Path("a.nc")}
    studies = {"continuum": study(), "atomistic": with_another(study(), *key.split("."))}
    if key in ONE_CONTACT:
        with pytest.raises(InputError, match=key):
            list(check_studies(list(paths), paths, studies))
    else:
        (note,) = check_studies(list(paths), paths, studies)
        assert key in note
        assert "another in the other" in note


def test_keys_of_one_contact_are_keys():
    assert {f"{section}.{name}" for section, name, *_ in all_keys()} >= ONE_CONTACT


def joined(folder, kind, seeds, **ranges):
    """One dataset of runs that each knew one seed."""
    parts = []
    for seed in seeds:
        text = SINGLE.replace('normalisation = "realised"', f'normalisation = "realised"\nseed = {seed}')
        for name, limits in ranges.items():
            text = text.replace("[output]", f"[output]\n{name} = {limits(seed) if callable(limits) else limits}")
        path = write(folder / f"{kind}-{seed}.nc", kind, text)
        parts.append(xr.load_dataset(path, decode_timedelta=False).expand_dims(seed=[seed]))
    path = folder / f"{kind}.nc"
    xr.concat(parts, dim="seed", data_vars="all", join="outer").to_netcdf(path)
    return path


def test_joined_seeds_of_one_binning_are_one_study(tmp_path):
    ranges = {"pressure_range": [-4e10, 8e10], "gap_range": [0, 8e-9]}
    inputs = read_inputs([joined(tmp_path, kind, (1, 2, 3), **ranges) for kind in ("continuum", "atomistic")])
    assert inputs.study.sweep["seed"].values == (1, 2, 3)
    assert [case.surface.seed for case in inputs.cases] == [1, 2, 3]
    assert "[sweep]" in inputs.study.toml
    assert all("holds seed = 1, 2, 3" in note for note in inputs.notes)
    assert len(inputs.notes) == 2


def test_joined_datasets_of_other_bins_are_refused(files, tmp_path):
    path = joined(tmp_path, "continuum", (1, 2), gap_range=lambda seed: [0, 8e-9 + seed * 1e-10])
    with xr.open_dataset(path) as dataset:
        assert dataset.sizes["gap_bin"] > 30
    message = refused([path, files[2]])
    assert "_bin are not the" in message
    assert "output.gap_range" in message


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.isel(gap_bin=slice(1, None)), "gap_bin are not the 30 even bins"),
        (lambda d: d.assign_coords(pressure_bin=d["pressure_bin"] ** 3), "pressure_bin are not the 40 even bins"),
        (lambda d: d.isel(step=slice(2)), "loading path at well_depth_ratio = 1.0 is not that of the study"),
        (lambda d: d.assign_coords(branch=1 - d["branch"]), "loading path"),
        (lambda d: d.sel(well_depth_ratio=8), "lacks the dimension well_depth_ratio"),
        (lambda d: d.expand_dims(humidity=[0.5]), "its dimension humidity is no key"),
        (lambda d: d.assign_coords(well_depth_ratio=[1.0, -8.0]), "its study is not one this version can read"),
    ],
)
def test_a_dataset_that_is_not_its_studys_is_refused(files, tmp_path, change, words):
    path = tmp_path / "changed.nc"
    change(xr.load_dataset(files[1], decode_timedelta=False)).to_netcdf(path)
    message = refused([files[0], path])
    assert str(path) in message
    assert words in message


def test_bins_that_the_study_names_are_those_of_the_dataset(files, tmp_path):
    named = STUDY.replace("[output]", "[output]\ngap_range = [0, 8e-9]")
    right = write(tmp_path / "right.nc", "atomistic", named)
    assert "output.gap_range" in read_inputs([files[0], right]).notes[0]
    wrong = write(tmp_path / "wrong.nc", "atomistic", study_toml=named)
    assert "gap_bin are not the 30 even bins" in refused([files[0], wrong])


def test_a_part_of_a_sweep_is_compared_as_what_it_is(files, tmp_path):
    path = tmp_path / "part.nc"
    xr.load_dataset(files[1], decode_timedelta=False).sel(well_depth_ratio=[8]).to_netcdf(path)
    inputs = read_inputs([files[0], path])
    assert inputs.studies["atomistic"].sweep["well_depth_ratio"].values == (8.0,)
    assert any("share 1 points" in note for note in inputs.notes)


def test_seeds_on_different_paths_are_refused(tmp_path):
    text = SINGLE + '[sweep]\n"surface.seed" = [1, 2]\n[[override]]\nwhen = { "surface.seed" = 2 }\n'
    text += '"loading.path" = ["0.2 GPa", "1 GPa", "3 GPa"]\n'
    paths = [write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "atomistic")]
    assert "different loading paths (seed = 2)" in refused(paths)


def test_a_sweep_over_the_control_is_refused(tmp_path):
    text = SINGLE.replace('"0.1 GPa", "0.7799 GPa", "5.8725 GPa"', "1e-9, 5e-10")
    text += '[sweep]\n"loading.control" = ["pressure", "gap"]\n'
    paths = [write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "atomistic")]
    assert "pressures at some points of its sweep, gaps at others" in refused(paths)


def test_swept_values_that_differ_by_rounding_are_one_point(tmp_path):
    sweeps = [
        '[sweep]\n"surface.cutoff_mode" = [6.0, 7.0]\n',
        '[sweep]\n"surface.cutoff_mode" = [6.0, 7.000000000000001]\n',
    ]
    paths = [
        write(tmp_path / f"{kind}.nc", kind, SINGLE + sweep)
        for kind, sweep in zip(("continuum", "atomistic"), sweeps, strict=True)
    ]
    inputs = read_inputs(paths)
    assert len(sweep_points(inputs.models)) == 2
    assert len(inputs.cases) == 2
    assert inputs.notes == ()
    for path in paths:
        point = sweep_points(inputs.models)[1]
        assert field_at(path, "gap", point.selection, 1).shape == (24, 24)


def test_coordinates_that_were_rounded_are_those_of_the_study(files, tmp_path):
    path = tmp_path / "rounded.nc"
    dataset = xr.load_dataset(files[1], decode_timedelta=False)
    dataset.assign_coords(well_depth_ratio=[1.0, np.nextafter(8.0, 9.0)]).to_netcdf(path)
    inputs = read_inputs([files[0], path])
    assert inputs.notes == ()
    assert len(sweep_points(inputs.models)) == 2
    assert field_at(path, "gap", {"well_depth_ratio": 8.0}, 1).shape == (24, 24)
    with pytest.raises(KeyError, match="well_depth_ratio = 3"):
        field_at(path, "gap", {"well_depth_ratio": 3.0}, 1)


def test_positions_that_change_over_a_sweep_are_no_swept_keys(tmp_path):
    text = SINGLE.replace("lattice_constant", "# ").replace(
        'well_depth = "18.6 meV"', 'work_of_adhesion = "0.69 J/m^2"'
    )
    text += '[sweep]\n"surface.size" = ["416 angstrom", "520 angstrom"]\n"interaction.well_depth_ratio" = [1, 8]\n'
    inputs = read_inputs([write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "theory")])
    assert "y_index" in inputs.models["continuum"].dims
    points = [(point.selection["size"], point.selection["well_depth_ratio"]) for point in sweep_points(inputs.models)]
    assert sorted(points) == [(416e-10, 1), (416e-10, 8), (520e-10, 1), (520e-10, 8)]
    assert all(len(point.selection) == 2 for point in sweep_points(inputs.models))


def test_other_groups_of_a_file_are_left_alone(tmp_path):
    paths = [write(tmp_path / f"{kind}.nc", kind) for kind in ("continuum", "theory")]
    xr.Dataset({"state": ("where", np.ones(5))}).to_netcdf(paths[0], mode="a", group="restart")
    inputs = read_inputs(paths)
    assert sorted(inputs.models) == ["continuum", "gap_flow", "persson"]
    assert sorted(inputs.branches["gap_flow"]) == ["loading", "unloading"]


def test_height_maps_of_another_content_are_refused(tmp_path):
    first = write(tmp_path / "c.nc", "continuum", height_maps="sha256:ab map.npy\nsha256:cd other.npy")
    same = write(tmp_path / "a.nc", "atomistic", height_maps="sha256:ab map.npy")
    assert read_inputs([first, same]).notes == ()
    changed = write(tmp_path / "b.nc", "atomistic", height_maps="sha256:ef map.npy")
    assert "the height map map.npy had another content" in refused([first, changed])


def test_a_theory_of_the_ensemble_needs_no_seed(files, tmp_path):
    seeded = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2]\n')
    simulated = write(tmp_path / "seeds.nc", "continuum", seeded)
    assert read_inputs([simulated, files[2]]).notes == ()
