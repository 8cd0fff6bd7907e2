import sys

import pytest
import xarray as xr

from contact_study.inputs.files import content_hash
from contact_study.start import contact_compare as compare
from contact_study.start import contact_merge as merge
from tests.campaign.toy_model import TOY_ATOMS
from tests.campaign.toy_study import WHOLE, assert_same, changed, names

pytest.importorskip("zarr")
pytestmark = pytest.mark.usefixtures("toy_is_the_continuum")
SMALL = changed(sweep={"interaction.well_depth_ratio": [1, 4], "surface.seed": [1, 2]})


@pytest.mark.validation
def test_it_is_resumed_replaced_and_kept(run, built, tmp_path):
    run(SMALL, output="bem.zarr")
    assert_same(tmp_path / "bem.zarr", built(SMALL))
    status, solved, _ = run(WHOLE, "--resume", output="bem.zarr")
    assert (status, len(solved)) == (0, 6)
    assert_same(tmp_path / "bem.zarr", built(WHOLE))
    with xr.open_dataset(tmp_path / "bem.zarr") as dataset:
        assert dataset.gap.encoding["chunks"] == dataset.gap.shape, "small fields share a file"
    status, _, said = run(SMALL, output="bem.zarr")
    assert status == 1
    assert "bem.zarr exists; use --overwrite" in said
    assert run(SMALL, "--overwrite", output="bem.zarr")[0] == 0
    assert_same(tmp_path / "bem.zarr", built(SMALL))
    assert names(tmp_path) == ["bem.zarr", "bem.zarr.restart"]


def test_parts_of_both_kinds_are_joined(built, tmp_path):
    parts = [built(WHOLE, "--surface.seed", "1, 2", name="bem.zarr"), built(WHOLE, "--surface.seed", "3")]
    assert merge([*map(str, parts), "-o", str(tmp_path / "all.zarr")]) == 0
    assert_same(tmp_path / "all.zarr", built(WHOLE))


@pytest.mark.validation
def test_it_is_a_predictor(run, tmp_path):
    run(SMALL, output="bem.zarr")
    assert run(SMALL, "--predictor", str(tmp_path / "bem.zarr"), output="md-zarr.nc", model=TOY_ATOMS)[0] == 0
    before = content_hash(tmp_path / "bem.zarr")
    with xr.open_dataset(tmp_path / "md-zarr.nc") as dataset:
        assert dataset.attrs["predictor"] == f"bem.zarr sha256:{before}"
    chunk = next((tmp_path / "bem.zarr" / "gap").glob("[0-9]*"))
    chunk.rename(chunk.with_name("9.9.9.9.9"))
    assert content_hash(tmp_path / "bem.zarr") != before


@pytest.mark.validation
def test_comparison_reads_it_and_writes_none(built, tmp_path, capsys):
    both = [built(SMALL, name=f"bem.{kind}") for kind in ("zarr", "nc")]
    for path in both:
        output = tmp_path / path.suffix[1:]
        assert compare([str(path), "-o", f"{output}.nc", "--figures", str(output)]) == 0
    one, two = (xr.open_datatree(tmp_path / f"{kind}.nc")["continuum"].to_dataset() for kind in ("zarr", "nc"))
    xr.testing.assert_equal(one.drop_vars("wall_time"), two.drop_vars("wall_time"))
    capsys.readouterr()
    assert compare([str(both[1]), "-o", str(tmp_path / "no.zarr")]) == 1
    assert "a comparison is written as NetCDF" in capsys.readouterr().err


def test_what_cannot_be_is_said(run, tmp_path, capsys, monkeypatch):
    (tmp_path / "folder.zarr").mkdir()
    (tmp_path / "folder.zarr" / "precious").touch()
    status, _, said = run(WHOLE, "--overwrite", output="folder.zarr")
    assert status == 1
    assert "folder.zarr: is there and is no Zarr" in said
    assert (tmp_path / "folder.zarr" / "precious").exists()
    assert merge([str(tmp_path / "folder.zarr"), str(tmp_path / "study.toml"), "-o", str(tmp_path / "a.nc")]) == 1
    assert "folder.zarr: is a folder; expected a dataset" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "zarr", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    status, _, said = run(WHOLE, output="bem.zarr")
    assert status == 1
    assert "pip install '.[zarr]'" in said
