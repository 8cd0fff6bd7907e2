"""Which datasets may be compared, and what is said of those that may not."""

import dataclasses
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.record import key_values
from contact_study.inputs.errors import InputError
from contact_study.report.align.cases import sweep_points
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.files import field_at
from contact_study.report.read.studies import ONE_CONTACT, _only_key, check_studies
from tests.report.synthetic import SINGLE, STUDY, read, study, write, write_all

BOTH = ("continuum", "atomistic")
RANGED = STUDY.replace("[output]", "[output]\ngap_range = [0, 8e-9]")


def test_models_are_recognised_in_any_order_and_fields_stay_in_their_file(files):
    inputs = read_inputs(files[::-1])
    assert list(inputs.models) == ["atomistic", "continuum", "persson", "gap_flow"]
    named = {kind: path.name for kind, path in inputs.paths.items()}
    assert named == {kind: f"{kind}.nc" for kind in ("continuum", "atomistic", "theory")}
    assert (inputs.notes, inputs.control) == ((), "pressure")
    assert "gap" not in inputs.models["continuum"]
    assert inputs.models["continuum"]["height"].dims == ("y", "x")
    with xr.open_dataset(files[0]) as dataset:
        field = dataset["gap"].sel(well_depth_ratio=8).isel(step=1)
    np.testing.assert_array_equal(field_at(files[0], "gap", {"well_depth_ratio": 8.0}, 1), field)
    assert field_at(files[2], "gap", {}, 0) is None


def refused(paths):
    with pytest.raises(InputError) as caught:
        read_inputs(paths)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def cut(path, whole, share):
    path.write_bytes(whole[: int(share * len(whole))])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path, files: None, "does not exist"),
        (lambda path, files: path.mkdir(), "is a folder"),
        (lambda path, files: cut(path, files[1].read_bytes(), 0.0), "NetCDF"),
        (lambda path, files: cut(path, files[1].read_bytes(), 0.3), "NetCDF"),
        (lambda path, files: cut(path, files[1].read_bytes(), 0.95), "NetCDF"),
        (lambda path, files: path.write_text("not NetCDF"), "cannot be read as NetCDF"),
        (lambda path, files: xr.Dataset({"a": ("x", [1.0])}).to_netcdf(path), "is no dataset of bem-adhesion"),
        (lambda path, files: write(path, "atomistic", schema_version="3.0"), "schema version 3.0"),
        (lambda path, files: write(path, "atomistic", study_toml="[surface]\nkind = 3"), "one this version can read"),
        (lambda path, files: shutil.copy(files[0], path), "are both of the continuum model"),
    ],
)
def test_a_file_that_is_none_of_a_comparison(files, tmp_path, make, words):
    other = tmp_path / "other.nc"
    make(other, files)
    message = refused([files[0], other])
    assert str(other) in message
    assert words in message


@pytest.mark.parametrize(
    ("old", "new", "said", "refusal"),
    [
        ('rms_height = "7 angstrom"', 'rms_height = "9 angstrom"', "surface.rms_height", True),
        ("poissons_ratio = 0.42", "poissons_ratio = 0.3", "material.poissons_ratio", True),
        ('length = "3.28 angstrom"', 'length = "3.3 angstrom"', "interaction.length", True),
        ("[1, 8]", "[2, 3]", "sweeps have no point in common", True),
        ('"realised"', '"realised"\nseed = 7', "surface.seed", True),
        ("[24, 24]", "[32, 32]", "surface.shape", False),
        ('9 GPa", "5.8725 GPa"]\n[output]', '9 GPa"]\n[output]', "loading.path", False),
        ('"3.68 angstrom"', '"3.741 angstrom"', "interaction.contact_distance", False),
        ("[output]", "[output]\ngap_range = [0, 8e-9]", "output.gap_range", False),
        ('"77.2 GPa"', "77.2e9", "", False),
    ],
)
def test_different_contacts_are_refused_and_other_differences_noted(files, tmp_path, old, new, said, refusal):
    assert old in STUDY
    paths = [files[0], write(tmp_path / "other.nc", "atomistic", STUDY.replace(old, new))]
    words = refused(paths) if refusal else "".join(read_inputs(paths).notes)
    assert said in words
    assert ("cannot be compared" in words) == refusal
    assert bool(said) == bool(words), "the same value in another unit is no difference"


def with_another(asked, section, name):
    """The study with another value of one key in every case, unchecked."""
    cases = [dataclasses.replace(case) for case in asked.cases]
    for case in cases:
        object.__setattr__(case, section, changed := dataclasses.replace(getattr(case, section)))
        object.__setattr__(changed, name, "another")
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


def test_joined_seeds_of_one_binning_are_one_study(files, tmp_path):
    ranges = {"pressure_range": [-4e10, 8e10], "gap_range": [0, 8e-9]}
    inputs = read_inputs([joined(tmp_path, kind, (1, 2, 3), **ranges) for kind in BOTH])
    assert inputs.study.sweep["seed"].values == (1, 2, 3)
    assert [case.surface.seed for case in inputs.cases] == [1, 2, 3]
    assert "[sweep]" in inputs.study.toml
    assert ["holds seed = 1, 2, 3" in note for note in inputs.notes] == [True, True]
    # A detail draws from the surface's seed unless it has its own.
    rough = '\n[detail]\nkind = "self_affine"\nrms_height = "1 angstrom"\n'
    for given, words in (("", "surface.seed"), ("seed = 2\n", "may be any of surface.seed, detail.seed")):
        table = tomllib.loads(SINGLE + rough + given)
        if given:
            with pytest.raises(InputError, match=words):
                _only_key(tmp_path, "seed", table)
        else:
            assert _only_key(tmp_path, "seed", table) == words
    message = refused(
        [joined(tmp_path, "continuum", (1, 2), gap_range=lambda seed: [0, 8e-9 + seed * 1e-10]), files[2]]
    )
    assert "_bin are not the" in message
    assert "output.gap_range" in message


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.isel(gap_bin=slice(1, None)), "gap_bin are not the 30 even bins"),
        (lambda d: d.assign_coords(pressure_bin=d["pressure_bin"] ** 3), "pressure_bin are not the 40 even bins"),
        (lambda d: d.assign_attrs(study_toml=RANGED), "gap_bin are"),
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


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            SINGLE + '[sweep]\n"surface.seed" = [1, 2]\n[[override]]\nwhen = { "surface.seed" = 2 }\n'
            '"loading.path" = ["0.2 GPa", "1 GPa", "3 GPa"]\n',
            "different loading paths (seed = 2)",
        ),
        (
            SINGLE.replace('"0.1 GPa", "0.7799 GPa", "5.8725 GPa"', "1e-9, 5e-10")
            + '[sweep]\n"loading.control" = ["pressure", "gap"]\n',
            "pressures at some points of its sweep, gaps at others",
        ),
    ],
)
def test_paths_that_cannot_be_averaged_are_refused(tmp_path, text, words):
    assert words in refused(write_all(tmp_path, text, BOTH))


def test_swept_values_that_differ_by_rounding_are_one_point(files, tmp_path):
    text = SINGLE + '[sweep]\n"surface.cutoff_mode" = [6.0, 7.0]\n'
    other = write(tmp_path / "a.nc", "atomistic", text.replace("7.0]", "7.000000000000001]"))
    rounded = tmp_path / "rounded.nc"
    dataset = xr.load_dataset(files[1], decode_timedelta=False)
    dataset.assign_coords(well_depth_ratio=[1.0, np.nextafter(8.0, 9.0)]).to_netcdf(rounded)
    for paths in ([write(tmp_path / "c.nc", "continuum", text), other], [files[0], rounded]):
        inputs = read_inputs(paths)
        assert len(sweep_points(inputs.models)) == len(inputs.cases) == 2
        assert inputs.notes == ()
        for path in paths:
            assert field_at(path, "gap", sweep_points(inputs.models)[1].selection, 1).shape == (24, 24)
    with pytest.raises(KeyError, match="well_depth_ratio = 3"):
        field_at(rounded, "gap", {"well_depth_ratio": 3.0}, 1)


def test_positions_that_change_over_a_sweep_are_no_swept_keys(tmp_path):
    text = SINGLE.replace("lattice_constant", "# ").replace(
        'well_depth = "18.6 meV"', 'work_of_adhesion = "0.69 J/m^2"'
    )
    text += '[sweep]\n"surface.size" = ["416 angstrom", "520 angstrom"]\n"interaction.well_depth_ratio" = [1, 8]\n'
    inputs = read(tmp_path, text, ("continuum", "theory"))
    assert "y_index" in inputs.models["continuum"].dims
    points = [point.selection for point in sweep_points(inputs.models)]
    assert points == [{"well_depth_ratio": ratio, "size": size} for ratio in (1, 8) for size in (416e-10, 520e-10)]


def test_what_is_no_difference(files, seeds, tmp_path):
    """Other groups of a file, height maps of equal content, a seed that a theory of the ensemble does not need."""
    paths = write_all(tmp_path, kinds=("continuum", "theory"))
    xr.Dataset({"state": ("where", np.ones(5))}).to_netcdf(paths[0], mode="a", group="restart")
    inputs = read_inputs(paths)
    assert sorted(inputs.models) == ["continuum", "gap_flow", "persson"]
    assert sorted(inputs.branches["gap_flow"]) == ["loading", "unloading"]
    assert "restart" not in inputs.groups["continuum"]
    first = write(tmp_path / "c.nc", "continuum", height_maps="sha256:ab map.npy\nsha256:cd other.npy")
    same, changed = (
        write(tmp_path / f"{at}.nc", "atomistic", height_maps=f"sha256:{at} map.npy") for at in ("ab", "ef")
    )
    assert read_inputs([first, same]).notes == ()
    assert "the map map.npy had another content" in refused([first, changed])
    assert read_inputs([seeds, files[2]]).notes == ()
