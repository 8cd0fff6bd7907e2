"""The plotted numbers are those of the datasets, with their errors, scatter and bands, in the units of the axes."""

import numpy as np
import pytest

from contact_study.plots.paths import Curve, error_band
from contact_study.report.align.cases import sweep_points
from contact_study.report.facts.shown_states import common_label, panel_points
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.scatter import read_scatter
from contact_study.study.bins import bins_of
from tests.report.panels import area_bands, area_curves, area_strips, density_curves, gap_bands, gap_curves
from tests.report.synthetic import (
    AREA_FACTOR,
    BRANCH_FACTOR,
    GAP_SHIFT,
    GAP_STUDY,
    MODULUS,
    PRESSURES,
    SEEDED,
    SINGLE,
    STUDY,
    area,
    gap,
    pressure_at,
    read,
    study,
    write,
    write_all,
)

EIGHT = STUDY.replace('rms_height = "10 angstrom"', 'rms_height = "8 angstrom"')  # no power of ten
SEEDS = np.array([1, 2, 3])


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    return read_inputs(write_all(tmp_path_factory.mktemp("curves")))


@pytest.fixture(scope="module")
def models(inputs):
    return inputs.models


@pytest.fixture(scope="module")
def shown(models):
    return panel_points(models, "pressure")


def one(curves, model, colour):
    (found,) = [curve for curve in curves if (curve.model, curve.colour) == (model, colour)]
    return found


def standard_error(values):
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


def of_seeds(made, ratio):
    """Made-up values, a seed a row."""
    return made(ratio, np.array([PRESSURES[ratio]]), SEEDS[:, None])


def test_contact_area_against_pressure(models):
    curves = area_curves(models)
    assert {curve.label for curve in curves} == {"ε = ε₀", "ε = 8 ε₀"}
    for model in AREA_FACTOR:
        curve = one(curves, model, 1)
        np.testing.assert_allclose(curve.x, np.array(PRESSURES[8]) / 1e9, rtol=1e-12)
        np.testing.assert_allclose(curve.y, AREA_FACTOR[model] * area(8, np.array(PRESSURES[8])), rtol=1e-12)
        np.testing.assert_allclose(one(area_curves(models, reduced=True), model, 1).x * MODULUS / 1e9, curve.x)
    assert one(curves, "continuum", 0).simulated
    assert not one(curves, "persson", 0).simulated


def test_gaps_are_in_units_of_the_roughness_and_of_e_star(tmp_path):
    inputs = read_inputs(write_all(tmp_path, EIGHT))
    models, pressure = inputs.models, np.array(PRESSURES[8])
    for model in ("continuum", "atomistic"):
        expected = gap(8, pressure) + GAP_SHIFT[model]
        reduced, physical = (one(gap_curves(models, reduced=which), model, 1) for which in (True, False))
        np.testing.assert_allclose(reduced.x, expected / 8e-10, rtol=1e-9)
        np.testing.assert_allclose(reduced.y, pressure / MODULUS, rtol=1e-12)
        np.testing.assert_allclose(physical.x, expected / 1e-10, rtol=1e-9)  # Å
        np.testing.assert_allclose(physical.y, pressure / 1e9, rtol=1e-12)
    band, at = gap_bands(inputs)[1], np.sort(pressure)
    np.testing.assert_allclose(band.along, at / MODULUS, rtol=1e-12)
    flow = (gap(8, at) + GAP_SHIFT["gap_flow"]) / 8e-10
    np.testing.assert_allclose(band.low, flow / BRANCH_FACTOR["unloading"], rtol=1e-9)
    np.testing.assert_allclose(band.high, flow / BRANCH_FACTOR["loading"], rtol=1e-9)
    curve = one(density_curves("gap", models, "pressure", panel_points(models, "pressure"))[0], "continuum", 0)
    np.testing.assert_allclose(curve.x * 8e-10, models["continuum"]["gap_bin"], rtol=1e-9)
    density = models["continuum"]["gap_pdf"].sel(well_depth_ratio=1).isel(step=1).values
    np.testing.assert_allclose(curve.y / 8e-10, np.where(density > 0, density, np.nan), rtol=1e-6)


def test_bands_between_the_branches(inputs, tmp_path):
    pressure = np.sort(PRESSURES[8])
    flow = AREA_FACTOR["gap_flow"] * area(8, pressure)
    band = area_bands(inputs)[1]
    np.testing.assert_allclose(band.along, pressure / 1e9, rtol=1e-12)
    np.testing.assert_allclose(band.low, BRANCH_FACTOR["loading"] * flow, rtol=1e-12)
    np.testing.assert_allclose(band.high, BRANCH_FACTOR["unloading"] * flow, rtol=1e-12)
    one_branch = {"gap_flow": dict.fromkeys(("loading", "unloading"), inputs.models["gap_flow"])}
    assert area_bands(type(inputs)(inputs.paths, inputs.models, one_branch, inputs.studies)) == []
    # Under a prescribed gap each branch has its own pressures.
    held = read(tmp_path, GAP_STUDY, ("continuum", "theory"))
    applied = np.array([1e-9, 0.7e-9, 0.3e-9, 0.2e-9])
    band, curves = area_bands(held)[0], []
    for factor in BRANCH_FACTOR.values():
        areas = factor * AREA_FACTOR["gap_flow"] * area(1, pressure_at(applied))
        curves.append(np.interp(band.along, factor * pressure_at(applied) / 1e6, areas))
    np.testing.assert_allclose(band.low, np.minimum(*curves), rtol=1e-12)
    np.testing.assert_allclose(band.high, np.maximum(*curves), rtol=1e-12)


def test_distributions_are_those_of_the_paper_states(models, shown):
    assert shown.paper
    assert shown.case.selection == {"well_depth_ratio": 8.0}
    assert float(shown.common[0]) == 0.7799e9
    assert [float(named[0]) for named in shown.several] == [-0.4987e9, 0.7799e9, 5.8725e9]
    panel_a, panel_b = density_curves("pressure", models, "pressure", shown)
    curve, density = one(panel_a, "continuum", 0), models["continuum"]["pressure_pdf"]
    np.testing.assert_allclose(curve.x * MODULUS, models["continuum"]["pressure_bin"], rtol=1e-12)
    expected = density.sel(well_depth_ratio=1).isel(step=1).values
    np.testing.assert_allclose(curve.y / MODULUS, np.where(expected > 0, expected, np.nan), rtol=1e-9)
    assert {curve.label for curve in panel_b} == {"p/E* = −0.00532", "p/E* = 0.00832", "p/E* = 0.06265"}
    gaps, _ = density_curves("gap", models, "pressure", shown)
    assert {curve.model for curve in gaps} == {"atomistic", "continuum", "gap_flow"}, "Persson's theory has none"
    bins = bins_of(study())
    for curves, edges, unit in ((panel_a, bins.pressure_edges, MODULUS), (gaps, bins.gap_edges, 1e-9)):
        for curve in curves:
            whole = np.nansum(curve.y * np.diff(edges) / unit)
            contact = AREA_FACTOR[curve.model] * area((1, 8)[curve.colour], 0.7799e9)
            assert whole == pytest.approx(contact if curves is panel_a else 1.0, rel=1e-9)


def test_detached_and_unconverged_states(tmp_path):
    paths = [write(tmp_path / "c.nc", "continuum", unconverged=[(0, 1)], detached=[(1, 1)])]
    models = read_inputs([*paths, write(tmp_path / "a.nc", "atomistic")]).models
    unconverged, detached = (one(area_curves(models), "continuum", colour) for colour in (0, 1))
    np.testing.assert_array_equal(unconverged.fit[:3], [True, False, True])
    assert np.isfinite(unconverged.y[1]), "shown, with a cross"
    assert np.isnan(detached.y[1]), "not shown"
    panels = density_curves("pressure", models, "pressure", panel_points(models, "pressure"))
    assert ("continuum", 0) not in {(curve.model, curve.colour) for panel in panels for curve in panel}


def test_states_of_another_study(tmp_path):
    text = SINGLE.replace('"0.7799 GPa", "5.8725 GPa"', '"1 GPa", "2 GPa", "3 GPa"')
    models = read(tmp_path, text, ("continuum", "theory")).models
    shown = panel_points(models, "pressure")
    assert not shown.paper
    assert [float(named[0]) for named in shown.several] == [0.1e9, 2e9, 3e9]
    named = panel_points(models, "pressure", 0.9e9).common
    assert float(named[0]) == 1e9
    assert common_label(models, named, "pressure") == "p = 1 GPa"
    assert common_label(models, named, "pressure", reduced=True) == f"p/E* = {1e9 / MODULUS:.4g}"
    assert {curve.label for curve in area_curves(models)} == {""}
    swept = read(tmp_path, SINGLE + '[sweep]\n"material.youngs_modulus" = ["50 GPa", "77.2 GPa"]\n').models
    assert [point.label for point in sweep_points(swept)] == ["E = 50 GPa", "E = 77.2 GPa"]
    named = panel_points(swept, "pressure", 1e9).common
    assert common_label(swept, named, "pressure", reduced=True) == "p = 779.9 MPa", "p/E* is not the same for both"


@pytest.mark.parametrize(("text", "noise"), [(SINGLE.replace('"0.1 GPa", ', '"0 GPa", '), 1e-12), (GAP_STUDY, 90.0)])
def test_rounding_has_no_sign(tmp_path, text, noise):
    """A pressure of nothing but rounding, or below the residual stress (1e-9 E*), is zero."""
    inputs = read(tmp_path, text)
    for dataset in inputs.models.values():
        dataset["mean_pressure"][..., 0] = noise
    assert all(curve.x[0] == 0 for curve in area_curves(inputs.models, inputs.control))
    if inputs.control == "gap":
        for dataset in inputs.models.values():
            dataset["mean_pressure"][..., 0] = 1e7
        assert area_curves(inputs.models, inputs.control)[0].x[0] > 0, "ten times the residual counts"


def test_seeds_are_averaged_with_their_standard_error(tmp_path):
    models = read(tmp_path, SEEDED, unconverged=[(1, 0)]).models
    assert [point.label for point in sweep_points(models)] == ["ε = ε₀", "ε = 8 ε₀"]
    curve = one(area_curves(models), "continuum", 1)
    # Case 1 is the first seed at the second ratio: its first step is left out.
    first, second = area(8, 0.1e9, SEEDS[1:]), area(8, -0.4987e9, SEEDS)
    np.testing.assert_allclose(curve.y[:2], [first.mean(), second.mean()], rtol=1e-12)
    np.testing.assert_allclose(curve.y_error[:2], [standard_error(first), standard_error(second)], rtol=1e-9)
    # A roughness of 1 nm: in its units and in nanometres the scatter of gaps is the same.
    scatter = standard_error(gap(8, PRESSURES[8][2], SEEDS))
    assert one(gap_curves(models), "continuum", 1).x_error[2] == pytest.approx(scatter / 1e-9, rel=1e-6)


def test_densities_carry_their_error(tmp_path):
    models = read(tmp_path, SEEDED).models
    shown = panel_points(models, "pressure")
    curve = one(density_curves("pressure", models, "pressure", shown)[0], "continuum", 1)
    step = PRESSURES[8].index(float(shown.common[0]))
    values = models["continuum"]["pressure_pdf"].sel(well_depth_ratio=8).isel(step=step).values
    there = values.mean(axis=0) > 0
    np.testing.assert_allclose(curve.y[there] / MODULUS, values.mean(axis=0)[there], rtol=1e-9)
    np.testing.assert_allclose(curve.y_error[there] / MODULUS, standard_error(values)[there], rtol=1e-9)


def test_band_is_one_standard_error_to_either_side():
    x, y, error = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.3, 0.4]), np.array([0.01, 0.02, np.nan])
    along = Curve("continuum", "", 0, x, y, y_error=error, fit=np.ones(3, bool))
    np.testing.assert_allclose(error_band(along), [[[1, 0.09], [2, 0.28], [2, 0.32], [1, 0.11]]], rtol=1e-12)
    across = Curve("continuum", "", 0, x, y, x_error=error, fit=np.array([True, True, False]))
    np.testing.assert_allclose(error_band(across), [[[0.99, 0.1], [1.98, 0.3], [2.02, 0.3], [1.01, 0.1]]], rtol=1e-12)
    assert error_band(Curve("continuum", "", 0, x, y, x_error=error, y_error=error)).size == 0
    # The pressure that was prescribed scatters by the solver's tolerance.
    prescribed = Curve("continuum", "", 0, x, y, x_error=np.full(3, 1e-9), y_error=error)
    np.testing.assert_array_equal(error_band(prescribed), error_band(along))


def test_strips_are_a_standard_deviation_about_the_mean(inputs, tmp_path):
    scatter = read_scatter(write(tmp_path / "seeds.nc", "continuum", SEEDED), inputs)
    for colour, ratio in enumerate(PRESSURES):
        along, steps = one(area_strips(inputs.models, scatter), "continuum", colour), slice(len(PRESSURES[ratio]))
        areas = of_seeds(area, ratio)
        np.testing.assert_allclose(along.y[steps], areas.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(along.y_error[steps], areas.std(axis=0, ddof=1), rtol=1e-9)
    # Points that are not compared have none; the others have the colours of the figure.
    (only,) = area_strips(read(tmp_path, STUDY.replace("= [1, 8]", "= [8]")).models, scatter)
    assert only.colour == 0
    np.testing.assert_allclose(only.y[0], of_seeds(area, 8)[:, 0].mean(), rtol=1e-12)
