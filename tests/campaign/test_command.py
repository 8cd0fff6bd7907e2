"""The commands' face: exit status, one clear line for bad input, resume after a kill, the dataset's form."""

import os
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.dataset.file import chunks_of
from contact_study.results.schema import COORDINATES, VARIABLES
from tests.campaign.toy_study import assert_same, run


@pytest.mark.parametrize(
    ("shape", "chunks"),
    [
        ((1000, 60, 400, 400), (1, 1, 400, 400)),  # a state
        ((3, 2048, 2048), (1, 128, 2048)),  # a part of one
        ((1000, 60, 400), (10, 60, 400)),  # a distribution of a thousand cases: a hundred chunks
        ((7,), (7,)),
    ],
)
def test_chunks_are_of_a_size_to_be_read_by(shape, chunks):
    assert chunks_of(shape) == chunks


def test_writes_the_dataset_and_names_it(study, tmp_path, capsys):
    output = tmp_path / "sub" / "bem.nc"
    assert run(study, "-o", output, "--workers", 1) == 0
    assert capsys.readouterr().out == f"{output}\n"
    assert sorted(path.name for path in output.parent.iterdir()) == ["bem.nc", "bem.nc.restart"]
    with xr.open_dataset(output) as dataset:
        assert dict(dataset.sizes) | {"y": 16, "x": 16} == dict(dataset.sizes)
        assert dataset.relative_contact_area.dims == ("well_depth_ratio", "seed", "step")
        # A path of three points beside one of four: padded, not shifted.
        assert np.isnan(dataset.relative_contact_area.sel(well_depth_ratio=1).isel(step=3)).all()
        assert dataset.applied_pressure.dims == ("well_depth_ratio", "step")
        np.testing.assert_allclose(
            dataset.applied_pressure.sel(well_depth_ratio=4), [0.1e9, -0.5e9, 1e9, 2e9], rtol=1e-15
        )
        assert dataset.height.dims == ("seed", "y", "x")
        assert dataset.work_of_adhesion.dims == ("well_depth_ratio",)
        assert dataset.contact_modulus.dims == ()
        assert dataset.gap.encoding["chunksizes"] == dataset.gap.shape  # small fields share a chunk
        assert dataset.pressure_pdf.encoding["chunksizes"] == dataset.pressure_pdf.shape
        for name, variable in dataset.variables.items():
            assert variable.attrs["long_name"], name
            assert "units" in variable.attrs, name
        for name in ("Conventions", "title", "source", "history", "references", "study_toml", "git_commit"):
            assert dataset.attrs[name], name
        assert dataset.attrs["schema_version"]
    with xr.open_dataset(output, group="metastable") as dataset:
        assert dataset.relative_contact_area.dims == ("well_depth_ratio", "seed", "theory", "metastable_branch", "step")
        assert "applied_pressure" in dataset.coords, "a group stands by itself"


def test_constants_of_swept_keys_stand_beside_them(study, tmp_path):
    """A constant that has the name of a swept key, whose dimension has the values asked for."""
    output = tmp_path / "bem.nc"
    swept = '"interaction.well_depth_ratio" = [1, 4]\n'
    study.write_text(study.read_text().replace(swept, swept + '"interaction.work_of_adhesion" = [0.5, 0.7]\n'))
    assert run(study, "-o", output, "--workers", 1) == 0
    with xr.open_dataset(output) as dataset:
        np.testing.assert_array_equal(dataset.work_of_adhesion, [0.5, 0.7])
        own = dataset.realised_work_of_adhesion
        assert "work_of_adhesion" in own.dims
        assert own.attrs["units"] == "J m-2"
        expected = dataset.work_of_adhesion * dataset.get("well_depth_ratio", 1)
        np.testing.assert_allclose(*xr.broadcast(own, expected), rtol=1e-12)
    wider = ["--interaction.work_of_adhesion", "[0.5, 0.7, 0.9]"]
    assert run(study, "-o", output, "--workers", 1, "--resume", *wider) == 0
    with xr.open_dataset(output) as dataset:
        assert dataset.realised_work_of_adhesion.sizes["work_of_adhesion"] == 3
        assert "work_of_adhesion" in dataset.coords


def test_processes_give_the_same_numbers_as_one(study, tmp_path):
    assert run(study, "-o", tmp_path / "one.nc", "--workers", 1) == 0
    assert run(study, "-o", tmp_path / "two.nc", "--workers", 2) == 0
    assert_same(tmp_path / "one.nc", tmp_path / "two.nc")


def test_existing_output_is_refused(study, tmp_path, capsys):
    output = tmp_path / "bem.nc"
    output.write_text("precious")
    assert run(study, "-o", output) == 1
    error = capsys.readouterr().err
    assert "--overwrite" in error
    assert error.count("\n") == 1
    assert output.read_text() == "precious"
    assert run(study, "-o", output, "--resume") == 1
    assert output.read_text() == "precious"
    assert run(study, "-o", output, "--overwrite", "--workers", 1) == 0


def test_resume_of_a_finished_run_does_nothing(study, tmp_path, capsys):
    output = tmp_path / "bem.nc"
    run(study, "-o", output, "--workers", 1)
    before = output.stat().st_mtime_ns
    assert run(study, "-o", output, "--resume") == 0
    assert output.stat().st_mtime_ns == before
    assert run(study, "-o", output, "--resume", "--surface.hurst_exponent", "0.7") == 1
    assert "another study" in capsys.readouterr().err


def test_coordinate_that_the_sweep_changes(study, tmp_path):
    """Two sizes of the cell: y and x are positions, no longer indices."""
    output = tmp_path / "bem.nc"
    text = study.read_text().replace('"surface.seed" = [1, 2]', '"surface.size" = ["100 angstrom", "200 angstrom"]')
    study.write_text(text)
    assert run(study, "-o", output, "--workers", 1) == 0
    with xr.open_dataset(output) as dataset:
        assert dataset.y.dims == ("size", "y_index")
        np.testing.assert_allclose(dataset.y.values[1], 2 * dataset.y.values[0])
        assert dataset.gap.dims == ("well_depth_ratio", "size", "step", "y_index", "x_index")


def test_points_of_a_sweep_with_other_numbers_of_points(study, tmp_path):
    """Grids of 16 and 24 points: the smaller is padded at its ends."""
    output = tmp_path / "bem.nc"
    text = study.read_text().replace('"surface.seed" = [1, 2]', '"surface.shape" = ["16, 16", "24, 24"]')
    study.write_text(text)
    assert run(study, "-o", output, "--workers", 1) == 0
    with xr.open_dataset(output) as dataset:
        assert dataset.gap.dims == ("well_depth_ratio", "shape", "step", "y_index", "x_index")
        np.testing.assert_array_equal(dataset["shape"], [16, 24])
        gap = dataset.gap.isel(well_depth_ratio=0, step=0)
        assert np.isfinite(gap.sel(shape=24)).all()
        assert np.isfinite(gap.sel(shape=16)[:16, :16]).all()
        assert np.isnan(gap.sel(shape=16)[16:]).all()
        assert np.isnan(gap.sel(shape=16)[:, 16:]).all()
        np.testing.assert_allclose(dataset.y.sel(shape=16)[:16], np.arange(16) * 1e-8 / 16, rtol=1e-12)


def test_non_convergence_is_said_and_written(study, tmp_path, capsys):
    output = tmp_path / "bem.nc"
    assert run(study, "-o", output, "--workers", 1, "--interaction.well_depth_ratio", "[1, 5]") == 2
    assert "2 of 12 steps did not converge" in capsys.readouterr().err
    with xr.open_dataset(output) as dataset:
        np.testing.assert_array_equal(dataset.converged.sel(well_depth_ratio=5, seed=1), [1, 0, 1])


def test_groups_count_for_the_status(study, tmp_path, capsys):
    output = tmp_path / "bem.nc"
    assert run(study, "-o", output, "--workers", 1, "--interaction.well_depth_ratio", "[1, 6]") == 2
    said = capsys.readouterr().err
    assert (
        '2 of 12 steps did not converge at theory="gap_flow", metastable_branch="loading" in the group metastable;'
        in said
    )
    assert said.count("did not converge") == 1
    assert run(study, "-o", output, "--resume", "--interaction.well_depth_ratio", "[1, 6]") == 2
    assert "in the group metastable;" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("-1e3, 2e3", ["] well_depth_ratio = 1.0, seed = 1: -1000 Pa,", "2000 Pa,"]),
        ("-0.5 MPa", ["-0.5 MPa,"]),
        (["-.5 MPa,3 kPa"], ["-0.5 MPa,", "0.003 MPa,"]),
    ],
)
def test_progress_is_in_the_unit_of_the_study(study, tmp_path, capsys, path, said):
    path = path if isinstance(path, list) else [path]
    assert run(study, "-o", tmp_path / "bem.nc", "--workers", 1, "--loading.path", *path) == 0
    shown = capsys.readouterr().err
    for words in said:
        assert words in shown


def test_prescribed_gaps_are_in_the_unit_of_the_study(study, tmp_path, capsys):
    keys = ("--loading.control", "gap", "--loading.path", "5 angstrom, 1 nm")
    assert run(study, "-o", tmp_path / "bem.nc", "--workers", 1, *keys) == 0
    assert "gap 10 angstrom," in capsys.readouterr().err


def test_pairs_as_people_type_them(study, tmp_path):
    keys = ("--surface.size", "100 angstrom, 0.02 um", "--surface.shape", "16,32")
    assert run(study, "-o", tmp_path / "bem.nc", "--workers", 1, *keys) == 0
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        assert dataset.gap.shape[-2:] == (16, 32)
        assert float(dataset.x[1]) == pytest.approx(2e-8 / 32, rel=1e-12, abs=0)


@pytest.mark.parametrize("keys", [("--surface.rms_height", "200 m"), ("--interaction.well_depth_ratio", "1e-12")])
def test_absurd_studies_are_refused_before_anything(study, tmp_path, capsys, keys):
    assert run(study, "-o", tmp_path / "bem.nc", *keys) == 1
    assert capsys.readouterr().err.count("\n") == 1
    assert not list(tmp_path.glob("bem.nc*"))


def test_reviews_of_study_and_model_are_shown_and_kept_once(study, tmp_path, capsys):
    keys = ("--solver.max_iterations", "7", "--surface.rms_height", "30 angstrom")
    assert run(study, "-o", tmp_path / "bem.nc", "--workers", 1, *keys) == 0
    said = capsys.readouterr().err
    assert said.count("a toy is no model") == 1
    assert said.count("rms slope") == 1
    assert said.index("rms slope") < said.index("[1/")  # before any work
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        first, second = dataset.attrs["warnings"].splitlines()
    assert "rms slope" in first
    assert second == "a toy is no model"


def test_warnings_are_shown_and_kept(study, tmp_path, capsys):
    output = tmp_path / "bem.nc"
    assert run(study, "-o", output, "--workers", 1, "--interaction.well_depth_ratio", "2") == 0
    assert "warning: well_depth_ratio = 2.0, seed = 1: a grid too coarse" in capsys.readouterr().err
    with xr.open_dataset(output) as dataset:
        assert "a grid too coarse" in dataset.attrs["warnings"]


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["--surface.hurst", "0.8"], "--surface.hurst"),
        (["--dynamics.seed", "3"], "unknown key --dynamics.seed (use --atomistic.random_seed); see bem-adhesion keys"),
        (["--sampling.random_seed=3"], "(use --atomistic.random_seed); see bem-adhesion keys sampling"),
        (["--surface.rms_heigth", "1 nm"], "did you mean --surface.rms_height?"),
        (["--surface.shape", "[200000, 200000]"], "GB of memory"),
        (["-o", ""], "name a file"),
        (["--interaction.well_depth_ratio", "13"], "unlucky"),
        (["--resume", "--overwrite"], "--resume"),
        (["--workers", "0"], "--workers"),
        (["--workers", "many"], "--workers"),
        (["--engine", "cloud"], "--engine"),
        (["--material.poissons_ratio", "0.6"], "material.poissons_ratio"),
    ],
)
def test_wrong_arguments(study, tmp_path, capsys, arguments, culprit):
    assert run(study, "-o", tmp_path / "bem.nc", *arguments) == 1
    error = capsys.readouterr().err
    assert culprit in error
    assert error.startswith("toy: error: ")
    assert error.count("\n") == 1
    assert not list(tmp_path.glob("bem.nc*"))


def test_closed_log_does_not_stop_the_run(study, tmp_path):
    command = f"{sys.executable} -m tests.campaign.toy_model {study} -o {tmp_path}/bem.nc --workers 1 2>&1 >/dev/null"
    subprocess.run(["bash", "-c", f"{command} | true"], check=True)
    assert (tmp_path / "bem.nc").exists()


def test_help_on_a_terminal_without_greek():
    command = [sys.executable, "-m", "tests.campaign.toy_model", "--help"]
    done = subprocess.run(command, capture_output=True, env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0, done.stderr
    assert b"exit status: 0 done" in done.stdout


def test_schema_is_whole():
    for name, variable in {**VARIABLES, **COORDINATES}.items():
        assert variable.long_name, name
        assert variable.units, name
