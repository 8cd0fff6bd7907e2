"""The scatter between surfaces behind the models of one: --scatter."""

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.scatter import read_scatter
from contact_study.start import contact_compare as main
from tests.report.synthetic import STUDY, area, write, write_all

SEEDS = np.array([1, 2, 4])
SEEDED = STUDY.replace("[sweep]\n", f'[sweep]\n"surface.seed" = {SEEDS.tolist()}\n')
PRESSURES = {1: [0.1e9, 0.7799e9, 5.8725e9], 8: [0.1e9, -0.4987e9, 0.7799e9, 5.8725e9]}


@pytest.fixture
def files(tmp_path):
    return write_all(tmp_path), write(tmp_path / "seeds.nc", "continuum", SEEDED)


def areas(ratio):
    """Made-up contact areas, a seed a row."""
    return area(ratio, np.array([PRESSURES[ratio]]), SEEDS[:, None])


@pytest.mark.usefixtures("unrendered")
def test_command(files, tmp_path, capsys):
    outputs = ["-o", tmp_path / "comparison.nc", "--figures", tmp_path / "figures", "--report", tmp_path / "r.html"]
    assert main([str(word) for word in [*files[0], "--scatter", files[1], *outputs]]) == 0
    with xr.open_datatree(tmp_path / "comparison.nc") as tree:
        found = tree["scatter/continuum"].to_dataset()
        np.testing.assert_allclose(
            found.relative_contact_area.sel(well_depth_ratio=8), areas(8).mean(axis=0), rtol=1e-12
        )
        assert (found.samples.sel(well_depth_ratio=8) == 3).all()
        # The compared surface's own numbers stay what they are.
        np.testing.assert_allclose(
            tree["continuum"].relative_contact_area.sel(well_depth_ratio=8), area(8, np.array(PRESSURES[8])), 1e-12
        )
        assert "ensemble" not in tree.children
    page = (tmp_path / "r.html").read_text()
    assert page.count("mean ± one standard deviation of the continuum over 3 surfaces") == 2
    assert "over 3 surfaces of one spectrum" in page


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        (SEEDED, "theory", "a theory has no single surface"),
        (STUDY, "continuum", "holds one surface"),
        (SEEDED.replace("77.2", "70"), "continuum", "material.youngs_modulus is 7.72e\\+10 in the one and 7e\\+10"),
        (SEEDED.replace("[1, 8]", "[2]"), "continuum", "no point in common"),
    ],
)
def test_what_is_no_scatter_of_these_is_refused(files, tmp_path, text, kind, words):
    with pytest.raises(InputError, match=words):
        read_scatter(write(tmp_path / "other.nc", kind, text), read_inputs(files[0]))


def test_refused_beside_another_average(tmp_path, files):
    heights = STUDY.replace("[sweep]\n", '[sweep]\n"surface.rms_height" = ["9 angstrom", "10 angstrom"]\n')
    inputs = read_inputs([write(tmp_path / "c.nc", "continuum", heights)], "rms_height")
    with pytest.raises(InputError, match="does not go with --average rms_height"):
        read_scatter(files[1], inputs)


def test_differences_are_said_but_not_that_of_the_seeds(files, tmp_path):
    coarser = write(tmp_path / "coarse.nc", "continuum", SEEDED.replace("[24, 24]", "[16, 16]"))
    (note,) = read_scatter(coarser, read_inputs(files[0])).notes
    assert "surface.shape is [24, 24] in the one and [16, 16] in the other" in note
    bare = write(tmp_path / "bare.nc", "continuum", SEEDED.replace("fields = true", "fields = false"))
    for path in (files[1], bare):
        assert read_scatter(path, read_inputs(files[0])).notes == ()


def test_a_file_that_is_not_there(files, tmp_path, capsys):
    arguments = [*map(str, files[0]), "-o", str(tmp_path / "out.nc"), "--scatter", str(tmp_path / "none.nc")]
    assert main(arguments) == 1
    assert "none.nc: does not exist" in capsys.readouterr().err
    assert not (tmp_path / "out.nc").exists()
    seeds = str(files[1])
    assert main([*map(str, files[0]), "-o", seeds, "--scatter", seeds, "--overwrite"]) == 1
    assert "choose another output" in capsys.readouterr().err
