"""Deviations and means over samples against hand-computed numbers; points of different paths find each other."""

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.report.align.deviations import compute_deviations, ensemble_statistics, pairs_of
from contact_study.report.read.datasets import read_inputs
from tests.report import synthetic
from tests.report.panels import area_curves, reported, run
from tests.report.synthetic import AREA_FACTOR, GAP_SHIFT, SEEDED, SEEDS, area, gap, read, standard_error, write

COMPARED, MISSING, NOT_CONVERGED, DETACHED = range(4)


def deviations(paths):
    return compute_deviations(read_inputs(paths).models, "pressure")


def test_every_pair_by_hand(files, tmp_path):
    found = deviations(files)
    assert found["relative_contact_area_deviation"].dims == ("pair", "well_depth_ratio", "step")
    applied = [[0.1e9, 0.7799e9, 5.8725e9, np.nan], [0.1e9, -0.4987e9, 0.7799e9, 5.8725e9]]
    np.testing.assert_array_equal(found["applied_pressure"], applied)
    for pair in found["pair"].values:
        model, _, reference = pair.partition(" - ")
        relative = found["relative_contact_area_relative_deviation"].sel(pair=pair)
        # Differences of numbers of order one, stored in double precision.
        ratio = AREA_FACTOR[model] / AREA_FACTOR[reference] - 1
        np.testing.assert_allclose(relative.values[[0, 1, 1], [0, 1, 3]], ratio, atol=1e-13)
        shift = found["mean_gap_deviation"].sel(pair=pair, well_depth_ratio=1).values
        np.testing.assert_allclose(shift, [GAP_SHIFT[model] - GAP_SHIFT[reference]] * 3 + [np.nan], atol=1e-22)
    here = found.sel(pair="continuum - atomistic", well_depth_ratio=8).isel(step=2)
    assert float(here["relative_contact_area_deviation"]) == pytest.approx(0.1 * area(8, 0.7799e9), rel=1e-12)
    expected = -GAP_SHIFT["atomistic"] / gap(8, 0.7799e9, model="atomistic")
    assert float(here["mean_gap_relative_deviation"]) == pytest.approx(expected, rel=1e-12)
    # A theory without a gap under tension keeps its area.
    pulled = found.sel(pair="persson - continuum", well_depth_ratio=8).isel(step=1)
    assert int(pulled["state"]) == COMPARED
    assert np.isnan(pulled["mean_gap_deviation"])
    assert np.isfinite(pulled["relative_contact_area_deviation"])
    assert [found[f"mean_gap_{kind}"].attrs["units"] for kind in ("deviation", "relative_deviation")] == ["m", "1"]
    alone = compute_deviations(read(tmp_path, synthetic.SINGLE).models, "pressure")["state"]
    assert alone.dims == ("pair", "step")
    assert (alone == COMPARED).all()


def test_who_is_compared_with_whom():
    names = ["atomistic", "continuum:a", "continuum:b", "persson", "gap_flow"]
    assert pairs_of(names) == [
        *((name, "atomistic") for name in names[1:]),
        *((name, "continuum:a") for name in names[2:]),
        *((name, "continuum:b") for name in names[3:]),
    ]
    assert pairs_of(["persson", "gap_flow"]) == [], "neither theory is a reference"


@pytest.mark.parametrize(
    ("old", "new", "pressures", "branches", "states"),
    [
        (
            '"0.1 GPa", "0.7799 GPa", "5.8725 GPa"]\n[output]',
            '"5.8725 GPa", "3 GPa", "0.1 GPa"]\n[output]',
            [0.1e9, 0.7799e9, 5.8725e9, 3e9],
            [0, 0, 0, 0],
            [COMPARED, MISSING, COMPARED, MISSING],
        ),
        (
            "\n[output]",
            "\nunload = true\n[output]",
            [0.1e9, 0.7799e9, 5.8725e9, 0.7799e9, 0.1e9],
            [0, 0, 0, 1, 1],
            [COMPARED] * 3 + [MISSING] * 2,
        ),
    ],
)
def test_states_of_other_paths_find_each_other(tmp_path, old, new, pressures, branches, states):
    paths = (
        write(tmp_path / "a.nc", "atomistic"),
        write(tmp_path / "c.nc", "continuum", synthetic.STUDY.replace(old, new)),
    )
    found = deviations(paths).isel(pair=0).sel(well_depth_ratio=1).isel(step=slice(len(states)))
    np.testing.assert_array_equal(found["applied_pressure"], pressures)
    np.testing.assert_array_equal(found["branch"], branches)
    np.testing.assert_array_equal(found["state"], states)
    expected = np.where(np.array(states) == COMPARED, 0.1 * area(1, np.array(pressures)), np.nan)
    np.testing.assert_allclose(found["relative_contact_area_deviation"], expected, rtol=1e-12)


def test_unconverged_and_detached_points_are_marked_not_mixed_in(tmp_path):
    continuum = write(tmp_path / "c.nc", "continuum", unconverged=[(0, 1)])
    atomistic = write(tmp_path / "a.nc", "atomistic", detached=[(1, 1)])
    found = deviations([continuum, atomistic]).isel(pair=0)
    np.testing.assert_array_equal(found["state"].sel(well_depth_ratio=1)[:3], [COMPARED, NOT_CONVERGED, COMPARED])
    np.testing.assert_array_equal(found["state"].sel(well_depth_ratio=8), [COMPARED, DETACHED, COMPARED, COMPARED])
    assert not found["relative_contact_area_deviation"].where(found["state"] != COMPARED).notnull().any()


def test_one_dataset_without_seeds_is_compared_with_each(seeds, files):
    found = deviations([seeds, files[2]]).sel(pair="persson - continuum", well_depth_ratio=8)
    by_hand = area(8, 0.1e9, model="persson") - area(8, 0.1e9, SEEDS)
    np.testing.assert_allclose(found["relative_contact_area_deviation"].isel(step=0), by_hand, rtol=1e-12)


def test_statistics_of_each_model(inputs, tmp_path):
    # Case 3 is the second seed at ratio 8; its second step did not converge.
    path = write(tmp_path / "continuum.nc", "continuum", SEEDED, unconverged={(3, 1)})
    assert run(path, "-o", tmp_path / "comparison.nc") == 2
    with xr.open_datatree(tmp_path / "comparison.nc", decode_timedelta=False) as tree:
        found = tree["ensemble/continuum"].to_dataset().load()
    assert found.attrs["averaged_over"] == "seed"
    strong, by_hand = found.sel(well_depth_ratio=8), synthetic.of_seeds(area, 8)
    kept = [by_hand[:, 0], by_hand[[0, 2], 1], *by_hand[:, 2:].T]
    errors = [standard_error(values) for values in kept]
    np.testing.assert_array_equal(strong.samples, [3, 2, 3, 3])
    np.testing.assert_allclose(strong.relative_contact_area, [values.mean() for values in kept], rtol=1e-12)
    np.testing.assert_allclose(strong.relative_contact_area_standard_error, errors, rtol=1e-9)
    assert strong.pressure_pdf_standard_error.dims == ("step", "pressure_bin")
    assert strong.mean_gap.attrs["units"] == strong.mean_gap_standard_error.attrs["units"] == "m"
    assert "mean over seed" in strong.mean_gap.attrs["long_name"]
    assert not {"wall_time", "residual", "iterations", "converged"} & {*strong.data_vars}
    assert ensemble_statistics(inputs.models) == {}


def test_differences_are_paired(tmp_path):
    """Two models on the same surfaces: the scatter of the difference is far below that of either."""
    found = compute_deviations(read(tmp_path, SEEDED).models, "pressure").sel(well_depth_ratio=8).isel(pair=0)
    by_hand = 0.1 * area(8, 0.1e9, SEEDS)
    assert found.relative_contact_area_deviation_mean[0] == pytest.approx(by_hand.mean(), rel=1e-9)
    error = found.relative_contact_area_deviation_standard_error
    assert float(error[0]) == pytest.approx(standard_error(by_hand), rel=1e-9)
    assert "paired differences over seed" in error.attrs["long_name"]


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_any_swept_key_may_be_averaged_over(tmp_path):
    paths = synthetic.write_all(tmp_path, synthetic.HEIGHTS, ("continuum", "atomistic"))
    models = read_inputs(paths, "rms_height").models
    assert {curve.label for curve in area_curves(models)} == {"ε = ε₀", "ε = 8 ε₀"}
    assert ensemble_statistics(models)["continuum"].relative_contact_area.dims == ("well_depth_ratio", "step")
    found = compute_deviations(models, "pressure")
    assert found.relative_contact_area_deviation_mean.dims == ("pair", "well_depth_ratio", "step")
    _, page = reported(tmp_path, *paths, options=("--average", "rms_height"))
    assert "standard errors over the values of rms height" in page
    assert "first rms height" in page
    # Without being asked the heights are points of the sweep.
    assert len({curve.label for curve in area_curves(read_inputs(paths).models)}) == 6
    with pytest.raises(InputError, match="--average seed: no dataset sweeps it; swept: well_depth_ratio, rms_height"):
        read_inputs(paths, "seed")


def test_seeds_are_points_of_the_sweep_where_another_key_is_averaged_over(tmp_path):
    with pytest.raises(InputError, match="points that differ in well_depth_ratio alone take different loading paths"):
        read(tmp_path, SEEDED, ("continuum",), "well_depth_ratio")
    inputs = read(tmp_path, SEEDED[: SEEDED.index("[[override]]")], ("continuum",), "well_depth_ratio")
    assert [curve.label for curve in area_curves(inputs.models)] == ["seed = 1", "seed = 2", "seed = 3"]
