"""What is plotted is what the datasets hold."""

import numpy as np
import pytest

from contact_study.plots.paths import smallest_resolved
from contact_study.report.align.cases import sweep_points
from contact_study.report.align.curves import path_bands, path_curves
from contact_study.report.facts.shown_states import panel_points
from contact_study.report.figures import panels as figures
from contact_study.report.figures.style import png
from contact_study.report.read.datasets import read_inputs
from contact_study.study.bins import bins_of
from tests.report.panels import density_panels
from tests.report.synthetic import (
    AREA_FACTOR,
    BRANCH_FACTOR,
    GAP_SHIFT,
    GAP_STUDY,
    STUDY,
    area,
    gap,
    pressure_at,
    study,
    write,
    write_all,
)

MODULUS = 77.2e9 / (1 - 0.42**2)
SEEDED = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2, 3]\n')


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    return read_inputs(write_all(tmp_path_factory.mktemp("figures")))


@pytest.fixture(scope="module")
def models(inputs):
    return inputs.models


@pytest.fixture(scope="module")
def shown(models):
    return panel_points(models, "pressure")


def one(curves, model, colour):
    (found,) = [curve for curve in curves if (curve.model, curve.colour) == (model, colour)]
    return found


def test_contact_area_against_pressure(models):
    curves = path_curves(models, "pressure").areas
    assert len(curves) == 8
    for model, factor in AREA_FACTOR.items():
        curve = one(curves, model, 1)
        assert curve.label == "ε = 8 ε₀"
        np.testing.assert_allclose(curve.x, [0.1, -0.4987, 0.7799, 5.8725], rtol=1e-12)
        np.testing.assert_allclose(curve.y, factor * area(8, curve.x * 1e9), rtol=1e-12)
        assert curve.fit.all()
        assert curve.y_error is None


def test_logarithm_of_pressure_against_mean_gap(models):
    curve = one(path_curves(models, "pressure").gaps, "atomistic", 1)
    # The realised surface has exactly the rms height asked for.
    pressure = np.array([0.1e9, 0.7799e9, 5.8725e9])
    np.testing.assert_allclose(curve.x[[0, 2, 3]], (gap(8, pressure) + GAP_SHIFT["atomistic"]) / 1e-9, rtol=1e-9)
    np.testing.assert_allclose(curve.y[[0, 2, 3]], np.log(pressure / MODULUS), rtol=1e-12)
    assert np.isnan([curve.x[1], curve.y[1]]).all(), "tension has no logarithm"


def test_bands_between_the_branches(inputs):
    pressure = np.array([-0.4987e9, 0.1e9, 0.7799e9, 5.8725e9])
    flow = AREA_FACTOR["gap_flow"] * area(8, pressure)
    band = path_bands(inputs.branches, inputs.models, 1e9).areas[1]
    np.testing.assert_allclose(band.along, pressure / 1e9, rtol=1e-12)
    np.testing.assert_allclose(band.low, BRANCH_FACTOR["loading"] * flow, rtol=1e-12)
    np.testing.assert_allclose(band.high, BRANCH_FACTOR["unloading"] * flow, rtol=1e-12)
    band = path_bands(inputs.branches, inputs.models).gaps[1]
    np.testing.assert_allclose(band.along, np.log(pressure[1:] / MODULUS), rtol=1e-12)
    flow = (gap(8, pressure[1:]) + GAP_SHIFT["gap_flow"]) / 1e-9
    np.testing.assert_allclose(band.low, flow / BRANCH_FACTOR["unloading"], rtol=1e-9)
    assert path_bands({}, inputs.models, 1e9).areas == []


def test_distributions_are_those_of_the_paper_states(models, shown):
    assert shown.paper
    assert shown.case.selection == {"well_depth_ratio": 8.0}
    assert float(shown.common[0]) == 0.7799e9
    assert [float(named[0]) for named in shown.several] == [-0.4987e9, 0.7799e9, 5.8725e9]
    panel_a, panel_b = density_panels("pressure", models, "pressure", shown)
    curve, density = one(panel_a, "continuum", 0), models["continuum"]["pressure_pdf"]
    np.testing.assert_allclose(curve.x * MODULUS, models["continuum"]["pressure_bin"], rtol=1e-12)
    expected = density.sel(well_depth_ratio=1).isel(step=1)
    np.testing.assert_allclose(10**curve.y / MODULUS, expected, rtol=1e-9)
    assert {curve.label for curve in panel_b} == {"p/E* = −0.00532", "p/E* = 0.00832", "p/E* = 0.06265"}
    tension = one(panel_b, "persson", 0)
    expected = models["persson"]["pressure_pdf"].sel(well_depth_ratio=8).isel(step=1)
    np.testing.assert_allclose(10**tension.y / MODULUS, expected, rtol=1e-9)


def test_normalisation_of_the_plotted_densities(models, shown):
    stress, _ = density_panels("pressure", models, "pressure", shown)
    gaps, _ = density_panels("gap", models, "pressure", shown)
    assert {curve.model for curve in gaps} == {"atomistic", "continuum", "gap_flow"}, "Persson's theory has none"
    bins = bins_of(study())
    for curves, edges, unit in ((stress, bins.pressure_edges, MODULUS), (gaps, bins.gap_edges, 1e-9)):
        for curve in curves:
            whole = np.nansum(10**curve.y * np.diff(edges) / unit)
            contact = AREA_FACTOR[curve.model] * area((1, 8)[curve.colour], 0.7799e9)
            assert whole == pytest.approx(contact if curves is stress else 1.0, rel=1e-9)


def test_seeds_are_averaged_with_their_standard_error(tmp_path):
    paths = [write(tmp_path / f"{kind}.nc", kind, SEEDED, unconverged=[(1, 0)]) for kind in ("continuum", "atomistic")]
    models = read_inputs(paths).models
    assert [point.label for point in sweep_points(models)] == ["ε = ε₀", "ε = 8 ε₀"]
    curve = one(path_curves(models, "pressure").areas, "continuum", 1)
    # Case 1 is the first seed at the second ratio: its first step is left out.
    first = np.array([area(8, 0.1e9, seed) for seed in (2, 3)])
    second = np.array([area(8, -0.4987e9, seed) for seed in (1, 2, 3)])
    np.testing.assert_allclose(curve.y[:2], [first.mean(), second.mean()], rtol=1e-12)
    errors = [first.std(ddof=1) / np.sqrt(2), second.std(ddof=1) / np.sqrt(3)]
    np.testing.assert_allclose(curve.y_error[:2], errors, rtol=1e-9)
    panel_a, _ = density_panels("pressure", models, "pressure", panel_points(models, "pressure"))
    mean = models["continuum"]["pressure_pdf"].sel(well_depth_ratio=1).isel(step=1).mean("seed")
    np.testing.assert_allclose(10 ** one(panel_a, "continuum", 0).y / MODULUS, mean, rtol=1e-9)


def test_detached_and_unconverged_states(tmp_path):
    paths = [write(tmp_path / "c.nc", "continuum", unconverged=[(0, 1)], detached=[(1, 1)])]
    paths += [write(tmp_path / "a.nc", "atomistic")]
    models = read_inputs(paths).models
    curves = path_curves(models, "pressure").areas
    unconverged, detached = one(curves, "continuum", 0), one(curves, "continuum", 1)
    np.testing.assert_array_equal(unconverged.fit[:3], [True, False, True])
    assert np.isfinite(unconverged.y[1]), "shown, with a cross"
    assert np.isnan(detached.y[1]), "not shown"
    panel_a, panel_b = density_panels("pressure", models, "pressure", panel_points(models, "pressure"))
    assert ("continuum", 0) not in {(curve.model, curve.colour) for curve in [*panel_a, *panel_b]}


def test_states_of_another_study(tmp_path):
    text = STUDY[: STUDY.index("[sweep]")].replace('"0.7799 GPa", "5.8725 GPa"', '"1 GPa", "2 GPa", "3 GPa"')
    models = read_inputs([write(tmp_path / "c.nc", "continuum", text), write(tmp_path / "t.nc", "theory", text)]).models
    shown = panel_points(models, "pressure")
    assert not shown.paper
    assert [float(named[0]) for named in shown.several] == [0.1e9, 2e9, 3e9]
    assert float(panel_points(models, "pressure", 0.9e9).common[0]) == 1e9
    (curve,) = [c for c in path_curves(models, "pressure").areas if c.model == "continuum"]
    assert curve.label == ""
    figure = figures.contact_area_figure(path_curves(models, "pressure"))
    assert png(figure).startswith(b"\x89PNG")


def test_another_swept_key(tmp_path):
    text = STUDY[: STUDY.index("[sweep]")] + '[sweep]\n"surface.hurst_exponent" = [0.5, 0.8]\n'
    models = read_inputs([write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "atomistic")]).models
    assert [point.label for point in sweep_points(models)] == ["H = 0.5", "H = 0.8"]
    assert len(path_curves(models, "pressure").areas) == 4


def test_drawn_lines_are_the_data(models, shown):
    panels = density_panels("gap", models, "pressure", shown)
    figure = figures.gap_distribution_figure(*panels)
    for axes, curves in zip(figure.axes, panels, strict=True):
        drawn = [line.get_xydata() for line in axes.lines]
        assert len(drawn) == len(curves)
        for line, curve in zip(drawn, curves, strict=True):
            np.testing.assert_array_equal(line, np.column_stack([curve.x, curve.y]))
    assert png(figure) == png(figures.gap_distribution_figure(*panels))


def test_panels_are_ended_by_the_simulations(models, shown):
    panels = density_panels("pressure", models, "pressure", shown)
    left, right = figures.stress_distribution_figure(*panels).axes
    lowest = smallest_resolved([*panels[0], *panels[1]])
    assert left.get_ylim() == right.get_ylim()
    assert left.get_ylim()[0] == pytest.approx(lowest - 0.3)


def test_bands_of_a_prescribed_gap_are_over_each_branchs_pressure(tmp_path):
    inputs = read_inputs([write(tmp_path / f"{kind}.nc", kind, GAP_STUDY) for kind in ("continuum", "theory")])
    applied = np.array([1e-9, 0.7e-9, 0.3e-9, 0.2e-9])
    band = path_bands(inputs.branches, inputs.models, 1e9).areas[0]
    curves = []
    for factor in BRANCH_FACTOR.values():
        areas = factor * AREA_FACTOR["gap_flow"] * area(1, pressure_at(applied))
        curves.append(np.interp(band.along, factor * pressure_at(applied) / 1e9, areas))
    np.testing.assert_allclose(band.low, np.minimum(*curves), rtol=1e-12)
    np.testing.assert_allclose(band.high, np.maximum(*curves), rtol=1e-12)
    assert band.along[-1] == pytest.approx(BRANCH_FACTOR["loading"] * pressure_at(0.2e-9) / 1e9)


def test_gaps_are_in_units_of_the_roughness(tmp_path):
    """A roughness that is no power of ten."""
    text = STUDY.replace('rms_height = "10 angstrom"', 'rms_height = "8 angstrom"')
    inputs = read_inputs(write_all(tmp_path, text))
    models = inputs.models
    pressure = np.array([0.1e9, -0.4987e9, 0.7799e9, 5.8725e9])
    expected = (gap(8, pressure) + GAP_SHIFT["continuum"]) / 8e-10
    logarithmic = one(path_curves(models, "pressure").gaps, "continuum", 1)
    np.testing.assert_allclose(logarithmic.x, np.where(pressure > 0, expected, np.nan), rtol=1e-9)
    linear = one(path_curves(models, "pressure").linear_gaps, "continuum", 1)
    np.testing.assert_allclose(linear.x, expected, rtol=1e-9)
    np.testing.assert_allclose(linear.y, pressure / MODULUS, rtol=1e-12)
    for either in (False, True):
        band = getattr(path_bands(inputs.branches, models), "linear_gaps" if either else "gaps")[1]
        at = np.sort(pressure)[0 if either else 1 :]
        np.testing.assert_allclose(band.along, at / MODULUS if either else np.log(at / MODULUS), rtol=1e-12)
        flow = (gap(8, at) + GAP_SHIFT["gap_flow"]) / 8e-10
        np.testing.assert_allclose(band.low, flow / BRANCH_FACTOR["unloading"], rtol=1e-9)
        np.testing.assert_allclose(band.high, flow / BRANCH_FACTOR["loading"], rtol=1e-9)
    panel_a, _ = density_panels("gap", models, "pressure", panel_points(models, "pressure"))
    curve = one(panel_a, "continuum", 0)
    np.testing.assert_allclose(curve.x * 8e-10, models["continuum"]["gap_bin"], rtol=1e-9)
    density = models["continuum"]["gap_pdf"].sel(well_depth_ratio=1).isel(step=1)
    np.testing.assert_allclose(10**curve.y / 8e-10, density, rtol=1e-6)


def test_errors_of_gaps_and_pressures_are_in_the_units_of_the_axes(tmp_path):
    text = SEEDED.replace('rms_height = "10 angstrom"', 'rms_height = "8 angstrom"')
    models = read_inputs([write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "atomistic")]).models
    scatter = np.std([gap(8, 0.1e9, seed) for seed in (1, 2, 3)], ddof=1) / np.sqrt(3)
    curves = path_curves(models, "pressure")
    for found in (curves.gaps, curves.linear_gaps):
        assert one(found, "continuum", 1).x_error[0] == pytest.approx(scatter / 8e-10, rel=1e-6)
    # Under a prescribed gap it is the pressure that scatters.
    text = GAP_STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2, 3]\n')
    models = read_inputs([write(tmp_path / f"gap-{kind}.nc", kind, text) for kind in ("continuum", "atomistic")]).models
    for dataset in models.values():
        dataset["mean_pressure"] = dataset["mean_pressure"] * (1 + 0.1 * dataset["seed"])
    pressure = np.array([1.1, 1.2, 1.3]) * pressure_at(0.2e-9)
    error = pressure.std(ddof=1) / np.sqrt(3)
    found = one(path_curves(models, "gap").gaps, "continuum", 1)
    assert found.y[3] == pytest.approx(np.log(pressure.mean() / MODULUS), rel=1e-9)
    assert found.y_error[3] == pytest.approx(error / pressure.mean(), rel=1e-6), "of the logarithm"
    linear = one(path_curves(models, "gap").linear_gaps, "continuum", 1)
    assert linear.y_error[3] == pytest.approx(error / MODULUS, rel=1e-6)
    area_curve = one(path_curves(models, "gap").areas, "continuum", 1)
    assert area_curve.x_error[3] == pytest.approx(error / 1e6, rel=1e-6), "the axis is in MPa"
