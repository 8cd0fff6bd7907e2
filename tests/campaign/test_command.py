import importlib.metadata
import os
import subprocess
import sys
import types

import numpy as np
import pytest
import xarray as xr

from contact_study import start
from contact_study.campaign import record
from contact_study.campaign.dataset.file import chunks_of
from contact_study.inputs.errors import INTERRUPTED
from tests.campaign.conftest import interrupt
from tests.campaign.toy_study import BASE, TABLE, assert_same, names

RATIO = "--interaction.well_depth_ratio"


def swept(**sweep):
    keys = {name.replace("_", ".", 1): values for name, values in sweep.items()}
    return {**TABLE, "sweep": {"interaction.well_depth_ratio": [1, 4], **keys}}


def test_chunks_are_of_a_size_to_be_read_by():
    assert chunks_of((3, 2048, 2048)) == (1, 128, 2048)  # a part of a state
    assert chunks_of((1000, 60, 400)) == (10, 60, 400)  # a distribution of a thousand cases: a hundred chunks


def test_writes_the_dataset(built):
    output = built(TABLE, name="sub/bem.nc")
    assert names(output.parent) == ["bem.nc", "bem.nc.restart"]
    with xr.open_dataset(output) as dataset:
        assert dict(dataset.sizes) | {"y": 16, "x": 16} == dict(dataset.sizes)
        assert dataset.relative_contact_area.dims == ("well_depth_ratio", "seed", "step")
        # A path of three points beside one of four: padded, not shifted.
        assert np.isnan(dataset.relative_contact_area.sel(well_depth_ratio=1).isel(step=3)).all()
        assert dataset.applied_pressure.dims == ("well_depth_ratio", "step")
        pressure = dataset.applied_pressure.sel(well_depth_ratio=4)
        np.testing.assert_allclose(pressure, [0.1e9, -0.5e9, 1e9, 2e9], rtol=1e-15)
        dims = {"height": ("seed", "y", "x"), "work_of_adhesion": ("well_depth_ratio",), "contact_modulus": ()}
        assert {name: dataset[name].dims for name in dims} == dims
        for name in ("gap", "pressure_pdf"):  # small fields share a chunk
            assert dataset[name].encoding["chunksizes"] == dataset[name].shape
    with xr.open_dataset(output, group="metastable") as dataset:
        assert dataset.relative_contact_area.dims == ("well_depth_ratio", "seed", "theory", "metastable_branch", "step")
        assert "applied_pressure" in dataset.coords, "a group stands by itself"


def test_constants_of_swept_keys_stand_beside_them(run, tmp_path):
    run(swept(interaction_work_of_adhesion=[0.5, 0.7]))
    wider = ["--interaction.work_of_adhesion", "[0.5, 0.7, 0.9]"]
    assert run(swept(interaction_work_of_adhesion=[0.5, 0.7]), "--resume", *wider)[0] == 0
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        np.testing.assert_array_equal(dataset.work_of_adhesion, [0.5, 0.7, 0.9])
        own = dataset.realised_work_of_adhesion
        assert own.attrs["units"] == "J m-2"
        expected = dataset.work_of_adhesion * dataset.well_depth_ratio
        np.testing.assert_allclose(*xr.broadcast(own, expected), rtol=1e-12)


def test_processes_give_the_same_numbers_as_one(run, built, tmp_path):
    run(TABLE, "--workers", "2")
    assert_same(tmp_path / "bem.nc", built(TABLE))


def test_existing_output_is_refused(run, tmp_path):
    output = tmp_path / "bem.nc"
    output.write_text("precious")
    for how in ((), ("--resume",)):
        status, _, said = run(TABLE, *how)
        assert (status, said.count("\n")) == (1, 1)
        assert "--overwrite" in said
        assert output.read_text() == "precious"
    assert run(TABLE, "--overwrite")[0] == 0


def test_points_of_a_sweep_with_other_cells_and_grids(built):
    with xr.open_dataset(built(swept(surface_size=["100 angstrom", "200 angstrom"]))) as dataset:
        assert dataset.y.dims == ("size", "y_index")
        np.testing.assert_allclose(dataset.y.values[1], 2 * dataset.y.values[0])
        assert dataset.gap.dims == ("well_depth_ratio", "size", "step", "y_index", "x_index")
    with xr.open_dataset(built(swept(surface_shape=["16, 16", "24, 24"]))) as dataset:
        np.testing.assert_array_equal(dataset["shape"], [16, 24])
        there = np.isfinite(dataset.gap.isel(well_depth_ratio=0, step=0))
        assert there.sel(shape=24).all()
        np.testing.assert_array_equal(there.sel(shape=16), np.outer(np.arange(24) < 16, np.arange(24) < 16))
        np.testing.assert_allclose(dataset.y.sel(shape=16)[:16], np.arange(16) * 1e-8 / 16, rtol=1e-12)
    typed = ("--surface.size", "100 angstrom, 0.02 um", "--surface.shape", "16,32")
    with xr.open_dataset(built(TABLE, *typed)) as dataset:
        assert dataset.gap.shape[-2:] == (16, 32)
        assert float(dataset.x[1]) == pytest.approx(2e-8 / 32, rel=1e-12, abs=0)


@pytest.mark.parametrize(("ratio", "where"), [(5, ""), (6, ' at theory="gap_flow", metastable_branch="loading" in')])
def test_non_convergence_is_said_and_written(run, tmp_path, ratio, where):
    for how in ((), ("--resume",)):
        status, _, said = run(TABLE, *how, RATIO, f"[1, {ratio}]")
        assert status == 2
        assert f"2 of 12 steps did not converge{where}" in said
        assert said.count("did not converge") == 1
    with xr.open_dataset(tmp_path / "bem.nc", group="metastable" if where else None) as dataset:
        flags = dataset.converged.squeeze().sel(well_depth_ratio=ratio, seed=1)
        np.testing.assert_array_equal(flags, [1, 0, 1])


def test_progress_is_in_the_unit_of_the_study(run):
    for path, words in (
        (["-1e3, 2e3"], "] well_depth_ratio = 1.0, seed = 1: -1000 Pa,"),
        (["-.5 MPa,3 kPa"], "0.003 MPa,"),
        (["5 angstrom, 1 nm", "--loading.control", "gap"], "gap 10 angstrom,"),
    ):
        status, _, shown = run(TABLE, "--overwrite", "--loading.path", *path)
        assert status == 0
        assert words in shown


def test_warnings_and_reviews_are_shown_and_kept_once(run, tmp_path):
    keys = ("--solver.max_iterations", "7", "--surface.rms_height", "30 angstrom", RATIO, "2")
    status, _, said = run(BASE, *keys)
    assert status == 0
    kept = ["rms slope", "a toy is no model", "well_depth_ratio = 2.0: a grid too coarse"]
    assert [said.count(words) for words in kept] == [1, 1, 1]
    assert said.index("rms slope") < said.index("[1/")  # before any work
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        lines = dataset.attrs["warnings"].splitlines()
    for words, line in zip(kept, lines, strict=True):
        assert words in line


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["--surface.hurst", "0.8"], "--surface.hurst"),
        (["--dynamics.seed", "3"], "unknown key --dynamics.seed (use --atomistic.random_seed); see bem-adhesion keys"),
        (["--surface.rms_heigth", "1 nm"], "did you mean --surface.rms_height?"),
        (["--surface.shape", "[200000, 200000]"], "GB of memory"),
        (["-o", ""], "name a file"),
        ([RATIO, "13"], "unlucky"),
        ([RATIO, "1e-12"], ""),
        (["--surface.rms_height", "200 m"], ""),
        (["--resume", "--overwrite"], "--resume"),
        (["--workers", "0"], "--workers"),
        (["--engine", "cloud"], "--engine"),
        (["--material.poissons_ratio", "0.6"], "material.poissons_ratio"),
    ],
)
def test_wrong_arguments(run, tmp_path, arguments, culprit):
    status, _, said = run(TABLE, *arguments)
    assert status == 1
    assert culprit in said
    assert said.startswith("toy: error: ")
    assert said.count("\n") == 1
    assert names(tmp_path) == []


@pytest.mark.validation
def test_closed_log_does_not_stop_the_run(study, tmp_path):
    command = f"{sys.executable} -m tests.campaign.toy_model {study} -o {tmp_path}/bem.nc --workers 1 2>&1 >/dev/null"
    subprocess.run(["bash", "-c", f"{command} | true"], check=True)
    assert (tmp_path / "bem.nc").exists()


def test_help_on_a_terminal_without_greek():
    command = [sys.executable, "-m", "tests.campaign.toy_model", "--help"]
    done = subprocess.run(command, capture_output=True, env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0, done.stderr
    assert b"exit status: 0 done" in done.stdout


COMMANDS = ["bem-adhesion", "md-reference", "persson-theory", "contact-compare", "contact-merge"]


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_start_and_are_interrupted_while_their_libraries_are_read(command, monkeypatch, capsys):
    (entry,) = importlib.metadata.entry_points(group="console_scripts", name=command)
    assert entry.module == "contact_study.start"
    main = getattr(start, command.replace("-", "_"))
    monkeypatch.setattr(sys, "argv", [command, "--version"])
    assert main() == 0
    assert capsys.readouterr().out.startswith(f"{command} ")
    interrupting = types.ModuleType("program")  # whose import takes so long that one presses Ctrl-C
    interrupting.__getattr__ = interrupt
    monkeypatch.setitem(sys.modules, "contact_study.command_line.program", interrupting)
    assert main() == INTERRUPTED == 130
    assert capsys.readouterr().err == f"{command}: interrupted before it began\n"


@pytest.mark.parametrize("place", [".", ".venv/site-packages", None])
def test_only_a_checkout_names_its_commit(tmp_path, monkeypatch, place):
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b.c"]
    if place is not None:
        subprocess.run([*git, "init", "-q"], check=True)
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "theirs"], check=True)
    folder = tmp_path / (place or ".") / "contact_study/campaign"
    folder.mkdir(parents=True)
    monkeypatch.setattr(record, "__file__", str(folder / "record.py"))
    head = subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, text=True).stdout.strip()
    assert record.git_commit.__wrapped__() == (head if place == "." else "unknown")
