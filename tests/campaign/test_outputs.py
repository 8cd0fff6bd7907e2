"""Outputs that cannot be written, and names that are none."""

import errno
import os

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.store import records
from tests.campaign.toy_study import run


@pytest.mark.parametrize("output", ["/dev/null/bem.nc"])
def test_directory_that_cannot_be_written(study, capsys, output):
    assert run(study, "-o", output) == 1
    assert output in capsys.readouterr().err


def test_inputs_are_not_overwritten(study, tmp_path, capsys):
    text = study.read_text()
    assert run(study, "-o", tmp_path / "sub" / ".." / "study.toml", "--overwrite") == 1
    np.save(tmp_path / "map.npy", np.eye(8))
    keys = ("--surface.kind", "file", "--surface.path", "map.npy")
    assert run(study, "-o", tmp_path / "map.npy", "--overwrite", *keys) == 1
    assert capsys.readouterr().err.count("is read by this run") == 2
    assert study.read_text() == text
    assert np.load(tmp_path / "map.npy").shape == (8, 8)


@pytest.mark.parametrize("name", ["bem", "bem.zarr.gz"])
def test_a_name_of_no_dataset(study, tmp_path, capsys, name):
    assert run(study, "-o", tmp_path / name) == 1
    said = capsys.readouterr().err
    assert said == f"toy: error: {tmp_path / name}: expected a name that ends in .nc, for NetCDF, or .zarr\n"
    assert not (tmp_path / name).exists()


def test_a_slash_at_the_end_is_a_folder(study, tmp_path, capsys):
    assert run(study, "-o", f"{tmp_path}/bem.nc/") == 1
    assert capsys.readouterr().err == f"toy: error: {tmp_path}/bem.nc/: is the name of a folder; name a file\n"
    assert not (tmp_path / "bem.nc").exists()


def test_full_disk_is_said_in_one_line(study, tmp_path, monkeypatch, capsys):
    def fail(*_, **__):
        raise RuntimeError("NetCDF: HDF error")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    assert run(study, "-o", tmp_path / "bem.nc", "--workers", 1) == 1
    error = capsys.readouterr().err
    assert "is the disk full?" in error
    assert "Traceback" not in error
    assert not list(tmp_path.rglob("*.tmp"))


def test_disk_that_fills_while_steps_are_written(study, tmp_path, monkeypatch, capsys):
    def fail(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(records, "append", fail)
    assert run(study, "-o", tmp_path / "bem.nc", "--workers", 1) == 1
    error = capsys.readouterr().err.splitlines()[-1]
    assert ".case: cannot be written (No space left on device)" in error
    assert not list(tmp_path.rglob("*.tmp"))


def test_output_that_is_a_directory(study, tmp_path, capsys):
    assert run(study, "-o", tmp_path) == 1
    assert run(study, "-o", tmp_path, "--overwrite") == 1
    assert capsys.readouterr().err.count("\n") == 2
    assert study.exists()
