"""Outputs whose name ends in .zarr: the numbers of the NetCDF file, resumed, joined, compared, started from."""

import sys
import tomllib

import pytest
import tomli_w
import xarray as xr

from bem_adhesion.study.model import MODEL
from contact_study.campaign import library
from contact_study.campaign.model import MODELS
from contact_study.campaign.record import content_hash
from contact_study.start import contact_compare as compare
from contact_study.start import contact_merge as merge
from tests.campaign.test_merge import WHOLE
from tests.campaign.toy_model import SOLVED, TOY, TOY_ATOMS
from tests.campaign.toy_study import changed
from tests.commands import main
from tests.report.synthetic import STUDY

pytest.importorskip("zarr")


pytestmark = pytest.mark.usefixtures("toy_is_the_continuum")


@pytest.fixture
def run(tmp_path):
    def run_study(table, output, *arguments, model=TOY):
        (tmp_path / "study.toml").write_text(tomli_w.dumps(table))
        return main(model, [str(tmp_path / "study.toml"), "-o", str(tmp_path / output), "--workers", "1", *arguments])

    return run_study


def assert_same(one, two):
    with xr.open_datatree(one) as left, xr.open_datatree(two) as right:
        assert {node.path for node in left.subtree} == {node.path for node in right.subtree}
        for node in left.subtree:
            here, there = (
                tree.drop_vars("wall_time", errors="ignore")
                for tree in (node.to_dataset(), right[node.path].to_dataset())
            )
            xr.testing.assert_equal(here, there)
            for name in here.variables:
                assert here[name].attrs.get("units") == there[name].attrs.get("units")
        assert left.attrs["study_toml"] == right.attrs["study_toml"]


def test_numbers_are_those_of_the_file(run, tmp_path):
    run(WHOLE, "bem.nc")
    assert run(WHOLE, "bem.zarr") == 0
    assert_same(tmp_path / "bem.zarr", tmp_path / "bem.nc")
    with xr.open_dataset(tmp_path / "bem.zarr") as dataset:
        assert dataset.gap.encoding["chunks"] == dataset.gap.shape, "small fields share a file"
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "bem.nc",
        "bem.nc.restart",
        "bem.zarr",
        "bem.zarr.restart",
        "study.toml",
    ]


def test_it_is_resumed_replaced_and_kept(run, tmp_path, capsys):
    small = changed(sweep={"interaction.well_depth_ratio": [1, 4], "surface.seed": [1, 2]})
    run(small, "bem.zarr")
    SOLVED.clear()
    assert run(WHOLE, "bem.zarr", "--resume") == 0
    assert len(SOLVED) == 6
    run(WHOLE, "whole.nc")
    assert_same(tmp_path / "bem.zarr", tmp_path / "whole.nc")
    assert run(small, "bem.zarr") == 1
    assert "bem.zarr exists; use --overwrite" in capsys.readouterr().err
    assert run(small, "bem.zarr", "--overwrite") == 0
    with xr.open_dataset(tmp_path / "bem.zarr") as dataset:
        assert dataset.sizes["seed"] == 2
    names = ["bem.zarr", "bem.zarr.restart", "study.toml", "whole.nc", "whole.nc.restart"]
    assert sorted(path.name for path in tmp_path.iterdir()) == names


@pytest.mark.validation
def test_it_is_a_predictor(run, tmp_path, capsys):
    run(WHOLE, "bem.nc")
    run(WHOLE, "bem.zarr")
    for kind in ("nc", "zarr"):
        start = ("--predictor", str(tmp_path / f"bem.{kind}"))
        assert run(WHOLE, f"md-{kind}.nc", *start, model=TOY_ATOMS) == 0
    with xr.open_dataset(tmp_path / "md-nc.nc") as one, xr.open_dataset(tmp_path / "md-zarr.nc") as two:
        xr.testing.assert_equal(one.drop_vars("wall_time"), two.drop_vars("wall_time"))
        assert two.attrs["predictor"] == f"bem.zarr sha256:{content_hash(tmp_path / 'bem.zarr')}"
    before = content_hash(tmp_path / "bem.zarr")
    chunk = next((tmp_path / "bem.zarr" / "gap").glob("[0-9]*"))
    chunk.write_bytes(chunk.read_bytes()[:-1] + b"x")
    changed_content = content_hash(tmp_path / "bem.zarr")
    chunk.rename(chunk.with_name("9.9.9.9.9"))
    assert len({before, changed_content, content_hash(tmp_path / "bem.zarr")}) == 3


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_comparison_reads_it_and_writes_none(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(MODELS, "continuum", MODEL)
    files = [tmp_path / "bem.zarr", tmp_path / "bem.nc"]
    for path in files:
        library.run(tomllib.loads(STUDY), output=path)
    both = []
    for path in files:
        output = tmp_path / f"{path.suffix[1:]}.nc"
        assert compare([str(path), "-o", str(output), "--figures", str(tmp_path / path.suffix[1:])]) == 0
        with xr.open_datatree(output) as tree:
            both.append(tree["continuum"].to_dataset().drop_vars("wall_time").load())
    xr.testing.assert_equal(*both)
    assert (tmp_path / "zarr" / "figure_5_gap_map.png").is_file(), "fields are read, too"
    capsys.readouterr()
    assert compare([str(files[0]), "-o", str(tmp_path / "no.zarr")]) == 1
    assert "a comparison is written as NetCDF" in capsys.readouterr().err


def test_what_cannot_be_is_said(run, tmp_path, capsys, monkeypatch):
    (tmp_path / "folder.zarr").mkdir()
    (tmp_path / "folder.zarr" / "precious").touch()
    assert run(WHOLE, "folder.zarr", "--overwrite") == 1
    assert "folder.zarr: is there and is no Zarr" in capsys.readouterr().err
    assert (tmp_path / "folder.zarr" / "precious").exists()
    assert merge([str(tmp_path / "folder.zarr"), str(tmp_path / "study.toml"), "-o", str(tmp_path / "a.nc")]) == 1
    assert "folder.zarr: is a folder; expected a dataset" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "zarr", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert run(WHOLE, "bem.zarr") == 1
    assert "pip install '.[zarr]'" in capsys.readouterr().err
