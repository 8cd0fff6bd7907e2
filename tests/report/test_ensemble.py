"""Means and errors over seeds, or over any other swept key: in the comparison's dataset, figures and tables."""

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.report.align.deviations import compute_deviations
from contact_study.report.align.ensemble import ensemble_statistics
from contact_study.report.read.datasets import read_inputs
from contact_study.start import contact_compare as main
from tests.report.panels import area_curves
from tests.report.synthetic import STUDY, area, write

SEEDED = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2, 3]\n')
SEEDS = np.array([1, 2, 3])
# Two swept keys besides the seed, one of which changes no made-up number.
HEIGHTS = STUDY.replace("[sweep]\n", '[sweep]\n"surface.rms_height" = ["9 angstrom", "10 angstrom", "12 angstrom"]\n')


def standard_error(values):
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


@pytest.fixture
def seeded(tmp_path):
    return [write(tmp_path / f"{kind}.nc", kind, SEEDED) for kind in ("continuum", "atomistic")]


def test_statistics_of_each_model(seeded, tmp_path):
    # Case 3 is the second seed at ratio 8; its second step did not converge.
    paths = [write(tmp_path / "continuum.nc", "continuum", SEEDED, unconverged={(3, 1)}), seeded[1]]
    found = ensemble_statistics(read_inputs(paths).models)
    assert list(found) == ["atomistic", "continuum"]
    strong = found["continuum"].sel(well_depth_ratio=8)
    np.testing.assert_array_equal(strong.samples, [3, 2, 3, 3])
    by_hand = area(8, np.array([[0.1e9, -0.4987e9, 0.7799e9, 5.8725e9]]), SEEDS[:, None])
    np.testing.assert_allclose(strong.relative_contact_area[0], by_hand[:, 0].mean(), rtol=1e-12)
    np.testing.assert_allclose(strong.relative_contact_area[1], by_hand[[0, 2], 1].mean(), rtol=1e-12)
    np.testing.assert_allclose(
        strong.relative_contact_area_standard_error[[0, 2, 3]], standard_error(by_hand)[[0, 2, 3]], rtol=1e-9
    )
    np.testing.assert_allclose(
        strong.relative_contact_area_standard_error[1], standard_error(by_hand[[0, 2], 1]), rtol=1e-9
    )
    assert strong.pressure_pdf_standard_error.dims == ("step", "pressure_bin")
    assert strong.mean_gap.attrs["units"] == strong.mean_gap_standard_error.attrs["units"] == "m"
    assert "mean over seed" in strong.mean_gap.attrs["long_name"]
    assert not {"wall_time", "residual", "iterations", "converged"} & {*strong.data_vars}


def test_comparison_holds_them(seeded, tmp_path):
    assert main([*map(str, seeded), "-o", str(tmp_path / "comparison.nc")]) == 0
    with xr.open_datatree(tmp_path / "comparison.nc") as tree:
        found = tree["ensemble/continuum"].to_dataset()
        assert found.attrs["averaged_over"] == "seed"
        np.testing.assert_allclose(
            found.relative_contact_area.sel(well_depth_ratio=1)[0], area(1, 0.1e9, SEEDS).mean(), rtol=1e-12
        )
        # The figures' curves are these numbers.
        (curve,) = (
            curve
            for curve in area_curves(read_inputs(seeded).models)
            if (curve.model, curve.colour) == ("continuum", 1)
        )
        np.testing.assert_allclose(curve.y, found.relative_contact_area.sel(well_depth_ratio=8), rtol=1e-12)
        np.testing.assert_allclose(
            curve.y_error, found.relative_contact_area_standard_error.sel(well_depth_ratio=8), rtol=1e-9
        )


def test_without_samples_there_are_none(tmp_path):
    paths = [write(tmp_path / f"{kind}.nc", kind) for kind in ("continuum", "atomistic")]
    assert main([*map(str, paths), "-o", str(tmp_path / "comparison.nc")]) == 0
    with xr.open_datatree(tmp_path / "comparison.nc") as tree:
        assert "ensemble" not in tree.children


def test_differences_are_paired(seeded):
    """Two models on the same surfaces: the scatter of the difference is far below that of either."""
    models = read_inputs(seeded).models
    found = compute_deviations(models, "pressure").sel(well_depth_ratio=8).isel(pair=0)
    by_hand = -0.1 * area(8, 0.1e9, SEEDS)
    assert found.relative_contact_area_deviation_mean[0] == pytest.approx(-by_hand.mean(), rel=1e-9)
    error = float(found.relative_contact_area_deviation_standard_error[0])
    assert error == pytest.approx(standard_error(by_hand), rel=1e-9)
    single = ensemble_statistics(models)["continuum"].relative_contact_area_standard_error.sel(well_depth_ratio=8)[0]
    assert error == pytest.approx(0.1 * float(single), rel=1e-9)
    assert "paired differences over seed" in found.relative_contact_area_deviation_standard_error.attrs["long_name"]


@pytest.mark.usefixtures("unrendered")
def test_any_swept_key_may_be_averaged_over(tmp_path):
    paths = [write(tmp_path / f"{kind}.nc", kind, HEIGHTS) for kind in ("continuum", "atomistic")]
    models = read_inputs(paths, "rms_height").models
    labels = {curve.label for curve in area_curves(models)}
    assert len(labels) == 2, "one colour for each ratio"
    assert all("h_rms" not in label for label in labels)
    assert ensemble_statistics(models)["continuum"].relative_contact_area.dims == ("well_depth_ratio", "step")
    found = compute_deviations(models, "pressure")
    assert found.relative_contact_area_deviation_mean.dims == ("pair", "well_depth_ratio", "step")
    report = tmp_path / "report.html"
    arguments = ["-o", tmp_path / "c.nc", "--report", report, "--average", "rms_height"]
    assert main([str(argument) for argument in (*paths, *arguments)]) == 0
    page = report.read_text()
    assert "standard errors over the values of rms height" in page
    assert "first rms height" in page
    # Without being asked the heights are points of the sweep.
    assert len({curve.label for curve in area_curves(read_inputs(paths).models)}) == 6


def test_seeds_are_points_of_the_sweep_where_another_key_is_averaged_over(tmp_path):
    path = write(tmp_path / "continuum.nc", "continuum", SEEDED)
    with pytest.raises(InputError, match="points that differ in well_depth_ratio alone take different loading paths"):
        read_inputs([path], "well_depth_ratio")
    even = SEEDED[: SEEDED.index("[[override]]")]
    inputs = read_inputs([write(tmp_path / "even.nc", "continuum", even)], "well_depth_ratio")
    labels = [curve.label for curve in area_curves(inputs.models)]
    assert labels == ["seed = 1", "seed = 2", "seed = 3"]


def test_unknown_key_is_refused(seeded):
    with pytest.raises(
        InputError, match="--average hurst_exponent: no dataset sweeps it; swept: well_depth_ratio, seed"
    ):
        read_inputs(seeded, "hurst_exponent")
