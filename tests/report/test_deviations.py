"""Deviations against hand-computed numbers; points of different paths find each other."""

import numpy as np
import pytest
import xarray as xr

from contact_study.report.align.deviations import (
    COMPARED,
    DETACHED,
    MISSING,
    NOT_CONVERGED,
    compute_deviations,
)
from contact_study.report.read.datasets import read_inputs
from contact_study.study.load_steps import path_points
from tests.report.synthetic import AREA_FACTOR, GAP_SHIFT, STUDY, area, gap, write, write_all


def deviations(paths):
    return compute_deviations(read_inputs(paths).models, "pressure")


def test_every_pair_by_hand(tmp_path):
    found = deviations(write_all(tmp_path))
    assert list(found["pair"].values) == [
        "continuum - atomistic",
        "persson - atomistic",
        "gap_flow - atomistic",
        "persson - continuum",
        "gap_flow - continuum",
    ]
    assert found["relative_contact_area_deviation"].dims == ("pair", "well_depth_ratio", "step")
    np.testing.assert_array_equal(
        found["applied_pressure"], [[0.1e9, 0.7799e9, 5.8725e9, np.nan], [0.1e9, -0.4987e9, 0.7799e9, 5.8725e9]]
    )
    for pair in found["pair"].values:
        model, _, reference = pair.partition(" - ")
        ratio = AREA_FACTOR[model] / AREA_FACTOR[reference] - 1
        relative = found["relative_contact_area_relative_deviation"].sel(pair=pair)
        # Differences of numbers of order one, stored in double precision.
        np.testing.assert_allclose(relative.values[[0, 1, 1], [0, 1, 3]], ratio, atol=1e-13)
        shift = found["mean_gap_deviation"].sel(pair=pair, well_depth_ratio=1).values
        np.testing.assert_allclose(shift[:3], GAP_SHIFT[model] - GAP_SHIFT[reference], atol=1e-22)
        assert np.isnan(shift[3])
    here = found.sel(pair="continuum - atomistic", well_depth_ratio=8).isel(step=2)
    assert float(here["relative_contact_area_deviation"]) == pytest.approx(0.1 * area(8, 0.7799e9), rel=1e-12)
    expected = -GAP_SHIFT["atomistic"] / (gap(8, 0.7799e9) + GAP_SHIFT["atomistic"])
    assert float(here["mean_gap_relative_deviation"]) == pytest.approx(expected, rel=1e-12)


def test_theory_without_a_gap_under_tension_keeps_its_area(tmp_path):
    found = deviations(write_all(tmp_path)).sel(pair="persson - continuum", well_depth_ratio=8)
    assert int(found["state"].isel(step=1)) == COMPARED
    assert np.isnan(found["mean_gap_deviation"].isel(step=1))
    assert np.isfinite(found["relative_contact_area_deviation"].isel(step=1))


def test_other_order_and_missing_points(tmp_path):
    first = write(tmp_path / "a.nc", "atomistic")
    reordered = STUDY.replace(
        'path = ["0.1 GPa", "0.7799 GPa", "5.8725 GPa"]\n[output]',
        'path = ["5.8725 GPa", "3 GPa", "0.1 GPa"]\n[output]',
    )
    second = write(tmp_path / "c.nc", "continuum", reordered)
    found = deviations([first, second]).isel(pair=0).sel(well_depth_ratio=1)
    np.testing.assert_array_equal(found["applied_pressure"], [0.1e9, 0.7799e9, 5.8725e9, 3e9])
    np.testing.assert_array_equal(found["state"], [COMPARED, MISSING, COMPARED, MISSING])
    np.testing.assert_allclose(
        found["relative_contact_area_deviation"].values,
        [0.1 * area(1, 0.1e9), np.nan, 0.1 * area(1, 5.8725e9), np.nan],
        rtol=1e-12,
    )


def test_branches_and_repeated_visits_are_not_mixed():
    pressure = np.array([1e8, 2e8, 1e8, 2e8, 1e8, np.nan])
    branch = np.array([0, 0, 0, 0, 1, np.nan])
    points = path_points(pressure, branch)
    assert points[-1] is None
    assert len(set(points[:-1])) == 5
    assert points[0] == ("100000000", 0, 0)
    assert points[2] == ("100000000", 0, 1)
    assert points[4] == ("100000000", 1, 0)
    # The same pressure from another unit: one bit away.
    assert path_points(np.nextafter(pressure, np.inf), branch) == points


def test_unloading_is_compared_with_unloading(tmp_path):
    back = STUDY.replace('"5.8725 GPa"]\n[output]', '"5.8725 GPa"]\nunload = true\n[output]')
    found = deviations([write(tmp_path / "a.nc", "atomistic"), write(tmp_path / "c.nc", "continuum", back)])
    states = found.isel(pair=0).sel(well_depth_ratio=1)
    np.testing.assert_array_equal(states["branch"].values[:5], [0, 0, 0, 1, 1])
    np.testing.assert_array_equal(states["state"].values[:5], [COMPARED] * 3 + [MISSING] * 2)


def test_unconverged_and_detached_points_are_marked_not_mixed_in(tmp_path):
    continuum = write(tmp_path / "c.nc", "continuum", unconverged=[(0, 1)])
    atomistic = write(tmp_path / "a.nc", "atomistic", detached=[(1, 1)])
    found = deviations([continuum, atomistic]).isel(pair=0)
    np.testing.assert_array_equal(found["state"].sel(well_depth_ratio=1)[:3], [COMPARED, NOT_CONVERGED, COMPARED])
    np.testing.assert_array_equal(found["state"].sel(well_depth_ratio=8), [COMPARED, DETACHED, COMPARED, COMPARED])
    marked = found["relative_contact_area_deviation"].where(found["state"] != COMPARED)
    assert not marked.notnull().any()


def test_one_dataset_without_seeds_is_compared_with_each(tmp_path):
    seeded = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2]\n')
    paths = [write(tmp_path / "c.nc", "continuum", seeded), write(tmp_path / "t.nc", "theory")]
    found = deviations(paths).sel(pair="persson - continuum", well_depth_ratio=8)
    by_hand = [AREA_FACTOR["persson"] * area(8, 0.1e9) - area(8, 0.1e9, seed) for seed in (1, 2)]
    np.testing.assert_allclose(found["relative_contact_area_deviation"].isel(step=0), by_hand, rtol=1e-12)


def test_every_variable_is_described(tmp_path):
    found = deviations(write_all(tmp_path))
    for name, variable in found.variables.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    assert found["mean_gap_deviation"].attrs["units"] == "m"
    assert found["mean_gap_relative_deviation"].attrs["units"] == "1"


def test_a_study_without_a_sweep(tmp_path):
    single = STUDY[: STUDY.index("[sweep]")]
    found = deviations(write_all(tmp_path, single))
    assert found["state"].dims == ("pair", "step")
    xr.testing.assert_equal(found["state"], xr.zeros_like(found["state"]))
