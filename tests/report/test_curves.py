"""The plotted numbers are those of the datasets, with their errors, scatter and bands, in the units of the axes."""

import dataclasses

import numpy as np
import pytest

from contact_study.plots.paths import Curve, error_band
from contact_study.report.align import curves
from contact_study.report.align.cases import sweep_points
from contact_study.report.facts.shown_states import common_label, panel_points
from contact_study.report.read.datasets import read_scatter
from tests.report import synthetic
from tests.report.panels import area_curves, bands, density_curves, gap_curves, one
from tests.report.synthetic import H_RMS, MODULUS, PRESSURES, SEEDED, area, gap, of_seeds, read, standard_error

STRONG = np.array(PRESSURES[8])


@pytest.fixture(scope="module")
def seeded(tmp_path_factory):
    """One of three seeds did not converge: case 1 is the first seed at the second ratio."""
    return read(tmp_path_factory.mktemp("seeds"), SEEDED, unconverged=[(1, 0)]).models


@pytest.mark.parametrize("model", synthetic.AREA_FACTOR)
def test_areas_and_gaps_against_pressure(inputs, model):
    physical, reduced = (one(area_curves(inputs.models, reduced=which), model, 1) for which in (False, True))
    np.testing.assert_allclose(physical.x, STRONG / 1e9, rtol=1e-12)
    np.testing.assert_allclose(physical.y, area(8, STRONG, model=model), rtol=1e-12)
    np.testing.assert_allclose(reduced.x, STRONG / MODULUS, rtol=1e-12)
    assert physical.label == "ε = 8 ε₀"
    assert physical.simulated == (model in ("continuum", "atomistic"))
    expected = np.where((STRONG < 0) & (model == "persson"), np.nan, gap(8, STRONG, model=model))
    for reduced, length, pressure in ((True, H_RMS, MODULUS), (False, 1e-10, 1e9)):  # Å and GPa
        curve = one(gap_curves(inputs.models, reduced), model, 1)
        np.testing.assert_allclose(curve.x, expected / length, rtol=1e-12)
        np.testing.assert_allclose(curve.y, STRONG / pressure, rtol=1e-12)


def test_bands_between_the_branches(inputs, tmp_path):
    pressure, (low, high) = np.sort(STRONG), synthetic.BRANCH_FACTOR.values()
    areas, gaps = (made(8, pressure, model="gap_flow") for made in (area, gap))
    for band, unit, ends in (
        (bands(inputs)[1], 1e9, (low * areas, high * areas)),
        (bands(inputs, "gap")[1], MODULUS, (gaps / high / H_RMS, gaps / low / H_RMS)),
    ):
        np.testing.assert_allclose(band.along, pressure / unit, rtol=1e-12)
        np.testing.assert_allclose([band.low, band.high], ends, rtol=1e-12)
    one_branch = {"gap_flow": dict.fromkeys(("loading", "unloading"), inputs.models["gap_flow"])}
    assert bands(dataclasses.replace(inputs, branches=one_branch)) == []
    # Under a prescribed gap each branch has its own pressures.
    band = bands(read(tmp_path, synthetic.GAP_STUDY, ("continuum", "theory")))[0]
    pressure = synthetic.pressure_at(np.array([1e-9, 0.7e-9, 0.3e-9, 0.2e-9]))
    areas = area(1, pressure, model="gap_flow")
    sides = [np.interp(band.along, factor * pressure / 1e6, factor * areas) for factor in (low, high)]
    np.testing.assert_allclose([band.low, band.high], np.sort(sides, axis=0), rtol=1e-12)


def test_distributions_are_those_of_the_paper_states(inputs):
    models = inputs.models
    shown = panel_points(models)
    assert shown.case.selection == {"well_depth_ratio": 8.0}
    assert float(shown.common[0]) == 0.7799e9
    assert [float(named[0]) for named in shown.several] == [-0.4987e9, 0.7799e9, 5.8725e9]
    (stresses, panel_b), (gaps, _) = (density_curves(name, models, shown) for name in ("pressure", "gap"))
    assert {curve.label for curve in panel_b} == {"p/E* = −0.00532", "p/E* = 0.00832", "p/E* = 0.06265"}
    assert {curve.model for curve in gaps} == {"atomistic", "continuum", "gap_flow"}, "Persson's theory has none"
    bins = synthetic.study().bins
    for found, edges, unit, name in (
        (stresses, bins.pressure_edges, MODULUS, "pressure"),
        (gaps, bins.gap_edges, H_RMS, "gap"),
    ):
        density = models["continuum"][f"{name}_pdf"].sel(well_depth_ratio=1).isel(step=1).values
        curve = one(found, "continuum", 0)
        np.testing.assert_allclose(curve.x * unit, models["continuum"][f"{name}_bin"], rtol=1e-12)
        np.testing.assert_allclose(curve.y / unit, np.where(density > 0, density, np.nan), rtol=1e-12)
        for curve in found:
            contact = area((1, 8)[curve.colour], 0.7799e9, model=curve.model) if name == "pressure" else 1.0
            assert np.nansum(curve.y * np.diff(edges) / unit) == pytest.approx(contact, rel=1e-12)


def test_detached_and_unconverged_states(tmp_path):
    models = read(tmp_path, kinds=("continuum",), unconverged=[(0, 1)], detached=[(1, 1)]).models
    unconverged, detached = (one(area_curves(models), "continuum", colour) for colour in (0, 1))
    np.testing.assert_array_equal(unconverged.fit[:3], [True, False, True])
    assert np.isfinite(unconverged.y[1]), "shown, with a cross"
    assert np.isnan(detached.y[1]), "not shown"
    panels = density_curves("pressure", models, panel_points(models))
    assert ("continuum", 0) not in {(curve.model, curve.colour) for panel in panels for curve in panel}


def test_states_of_another_study(tmp_path):
    text = synthetic.SINGLE.replace('"0.7799 GPa", "5.8725 GPa"', '"1 GPa", "2 GPa", "3 GPa"')
    models = read(tmp_path, text, ("continuum", "theory")).models
    assert [float(named[0]) for named in panel_points(models).several] == [0.1e9, 2e9, 3e9]
    named = panel_points(models, 0.9e9).common
    assert common_label(models, named, "pressure") == "p = 1 GPa"
    assert common_label(models, named, "pressure", reduced=True) == f"p/E* = {1e9 / MODULUS:.4g}"
    assert {curve.label for curve in area_curves(models)} == {""}
    swept = read(tmp_path, synthetic.SINGLE + '[sweep]\n"material.youngs_modulus" = ["50 GPa", "77.2 GPa"]\n').models
    assert [point.label for point in sweep_points(swept)] == ["E = 50 GPa", "E = 77.2 GPa"]
    named = panel_points(swept, 1e9).common
    assert common_label(swept, named, "pressure", reduced=True) == "p = 779.9 MPa", "p/E* is not the same for both"


@pytest.mark.parametrize(
    ("text", "noise"), [(synthetic.SINGLE.replace('"0.1 GPa", ', '"0 GPa", '), 1e-12), (synthetic.GAP_STUDY, 90.0)]
)
def test_rounding_has_no_sign(tmp_path, text, noise):
    """A pressure of nothing but rounding, or below the residual stress (1e-9 E*), is zero."""
    inputs = read(tmp_path, text)
    for pressure, zero in ((noise, True), (1e7, inputs.control == "pressure")):
        for dataset in inputs.models.values():
            dataset["mean_pressure"][..., 0] = pressure
        assert all((curve.x[0] == 0) == zero for curve in area_curves(inputs.models))


def test_seeds_are_averaged_with_their_standard_error(seeded):
    assert [point.label for point in sweep_points(seeded)] == ["ε = ε₀", "ε = 8 ε₀"]
    curve, areas = one(area_curves(seeded), "continuum", 1), of_seeds(area, 8)
    kept = [areas[1:, 0], *areas[:, 1:].T]
    np.testing.assert_allclose(curve.y, [values.mean() for values in kept], rtol=1e-12)
    np.testing.assert_allclose(curve.y_error, [standard_error(values) for values in kept], rtol=1e-12)
    scatter = standard_error(of_seeds(gap, 8))[2]
    assert one(gap_curves(seeded), "continuum", 1).x_error[2] == pytest.approx(scatter / H_RMS, rel=1e-12)
    shown = panel_points(seeded)
    curve = one(density_curves("pressure", seeded, shown)[0], "continuum", 1)
    values = seeded["continuum"]["pressure_pdf"].sel(well_depth_ratio=8).isel(step=2).values
    there = values.mean(axis=0) > 0
    np.testing.assert_allclose(curve.y[there] / MODULUS, values.mean(axis=0)[there], rtol=1e-12)
    np.testing.assert_allclose(curve.y_error[there] / MODULUS, standard_error(values)[there], rtol=1e-12)


@pytest.mark.parametrize(
    ("errors", "corners"),
    [
        ({"y_error": [0.01, 0.02, np.nan]}, [[[1, 0.09], [2, 0.28], [2, 0.32], [1, 0.11]]]),
        ({"x_error": [0.01, 0.02, np.nan]}, [[[0.99, 0.1], [1.98, 0.3], [2.02, 0.3], [1.01, 0.1]]]),
        ({"x_error": [0.01, 0.02, np.nan], "y_error": [0.01, 0.02, np.nan]}, np.empty((0, 4, 2))),
        # The pressure that was prescribed scatters by the solver's tolerance.
        ({"x_error": [1e-9] * 3, "y_error": [0.01, 0.02, np.nan]}, [[[1, 0.09], [2, 0.28], [2, 0.32], [1, 0.11]]]),
    ],
)
def test_band_is_one_standard_error_to_either_side(errors, corners):
    made = {name: np.array(values) for name, values in errors.items()}
    found = error_band(Curve("continuum", "", 0, np.arange(1.0, 4.0), np.array([0.1, 0.3, 0.4]), **made))
    np.testing.assert_allclose(found.reshape(-1, 4, 2), corners, rtol=1e-12)


def test_strips_are_a_standard_deviation_about_the_mean(inputs, seeds, tmp_path):
    scatter = read_scatter(seeds, inputs)

    def strips(models):
        return curves.scatter_strips(models, scatter, curves.pressure_axis(models, False), curves.AREA)

    for colour, ratio in enumerate(PRESSURES):
        along, areas = one(strips(inputs.models), "continuum", colour), of_seeds(area, ratio)
        np.testing.assert_allclose(along.y[: areas.shape[1]], areas.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(along.y_error[: areas.shape[1]], areas.std(axis=0, ddof=1), rtol=1e-12)
    # Points that are not compared have none; the others have the colours of the figure.
    (only,) = strips(read(tmp_path, synthetic.STUDY.replace("= [1, 8]", "= [8]")).models)
    assert only.colour == 0
    np.testing.assert_allclose(only.y[0], of_seeds(area, 8)[:, 0].mean(), rtol=1e-12)
