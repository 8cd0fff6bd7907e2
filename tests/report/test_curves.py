"""The plotted numbers are those of the datasets, with their errors, scatter and bands, in the units of the axes."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection

from contact_study.plots.paths import ERROR, Curve, error_band, smallest_resolved
from contact_study.report.align.cases import sweep_points
from contact_study.report.align.curves import path_bands, path_curves, scatter_strips
from contact_study.report.facts.shown_states import panel_points
from contact_study.report.figures import panels as figures
from contact_study.report.figures.style import SWEEP_COLOURS, png
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.scatter import read_scatter
from contact_study.study.bins import bins_of
from tests.report import panels
from tests.report.panels import density_panels
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


@pytest.fixture
def seeded(tmp_path):
    return read(tmp_path, SEEDED).models


def one(curves, model, colour):
    (found,) = [curve for curve in curves if (curve.model, curve.colour) == (model, colour)]
    return found


def standard_error(values):
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


def of_seeds(made, ratio, seeds=SEEDS):
    """Made-up values, a seed a row."""
    return made(ratio, np.array([PRESSURES[ratio]]), seeds[:, None])


def test_contact_area_against_pressure(models):
    curves = path_curves(models, "pressure").areas
    assert len(curves) == 8
    for model, factor in AREA_FACTOR.items():
        curve = one(curves, model, 1)
        assert curve.label == "ε = 8 ε₀"
        np.testing.assert_allclose(curve.x, np.array(PRESSURES[8]) / 1e9, rtol=1e-12)
        np.testing.assert_allclose(curve.y, factor * area(8, curve.x * 1e9), rtol=1e-12)
        assert curve.fit.all()
        assert curve.y_error is None
        assert curve.simulated == (model in ("continuum", "atomistic"))


def test_gaps_are_in_units_of_the_roughness_and_of_e_star(tmp_path):
    inputs = read_inputs(write_all(tmp_path, EIGHT))
    models, pressure = inputs.models, np.array(PRESSURES[8])
    curves, bands = path_curves(models, "pressure"), path_bands(inputs.branches, models)
    for model in ("continuum", "atomistic"):
        expected = (gap(8, pressure) + GAP_SHIFT[model]) / 8e-10
        logarithmic, linear = one(curves.gaps, model, 1), one(curves.linear_gaps, model, 1)
        # Tension has no logarithm.
        np.testing.assert_allclose(logarithmic.x, np.where(pressure > 0, expected, np.nan), rtol=1e-9)
        expected_y = np.log(np.where(pressure > 0, pressure, np.nan) / MODULUS)
        np.testing.assert_allclose(logarithmic.y, expected_y, rtol=1e-12)
        np.testing.assert_allclose(linear.x, expected, rtol=1e-9)
        np.testing.assert_allclose(linear.y, pressure / MODULUS, rtol=1e-12)
    for band, at in ((bands.gaps[1], np.sort(pressure)[1:]), (bands.linear_gaps[1], np.sort(pressure))):
        along = at / MODULUS if band is bands.linear_gaps[1] else np.log(at / MODULUS)
        np.testing.assert_allclose(band.along, along, rtol=1e-12)
        flow = (gap(8, at) + GAP_SHIFT["gap_flow"]) / 8e-10
        np.testing.assert_allclose(band.low, flow / BRANCH_FACTOR["unloading"], rtol=1e-9)
        np.testing.assert_allclose(band.high, flow / BRANCH_FACTOR["loading"], rtol=1e-9)
    panel_a, _ = density_panels("gap", models, "pressure", panel_points(models, "pressure"))
    curve = one(panel_a, "continuum", 0)
    np.testing.assert_allclose(curve.x * 8e-10, models["continuum"]["gap_bin"], rtol=1e-9)
    density = models["continuum"]["gap_pdf"].sel(well_depth_ratio=1).isel(step=1)
    np.testing.assert_allclose(10**curve.y / 8e-10, density, rtol=1e-6)


def test_bands_between_the_branches(inputs):
    pressure = np.sort(PRESSURES[8])
    flow = AREA_FACTOR["gap_flow"] * area(8, pressure)
    band = path_bands(inputs.branches, inputs.models, 1e9).areas[1]
    np.testing.assert_allclose(band.along, pressure / 1e9, rtol=1e-12)
    np.testing.assert_allclose(band.low, BRANCH_FACTOR["loading"] * flow, rtol=1e-12)
    np.testing.assert_allclose(band.high, BRANCH_FACTOR["unloading"] * flow, rtol=1e-12)
    assert path_bands({}, inputs.models, 1e9).areas == []


def test_bands_of_a_prescribed_gap_are_over_each_branchs_pressure(tmp_path):
    inputs = read(tmp_path, GAP_STUDY, ("continuum", "theory"))
    applied = np.array([1e-9, 0.7e-9, 0.3e-9, 0.2e-9])
    band = path_bands(inputs.branches, inputs.models, 1e9).areas[0]
    curves = []
    for factor in BRANCH_FACTOR.values():
        areas = factor * AREA_FACTOR["gap_flow"] * area(1, pressure_at(applied))
        curves.append(np.interp(band.along, factor * pressure_at(applied) / 1e9, areas))
    np.testing.assert_allclose(band.low, np.minimum(*curves), rtol=1e-12)
    np.testing.assert_allclose(band.high, np.maximum(*curves), rtol=1e-12)
    assert band.along[-1] == pytest.approx(BRANCH_FACTOR["loading"] * pressure_at(0.2e-9) / 1e9)


def test_distributions_are_those_of_the_paper_states(models, shown):
    assert shown.paper
    assert shown.case.selection == {"well_depth_ratio": 8.0}
    assert float(shown.common[0]) == 0.7799e9
    assert [float(named[0]) for named in shown.several] == [-0.4987e9, 0.7799e9, 5.8725e9]
    panel_a, panel_b = density_panels("pressure", models, "pressure", shown)
    curve, density = one(panel_a, "continuum", 0), models["continuum"]["pressure_pdf"]
    np.testing.assert_allclose(curve.x * MODULUS, models["continuum"]["pressure_bin"], rtol=1e-12)
    np.testing.assert_allclose(10**curve.y / MODULUS, density.sel(well_depth_ratio=1).isel(step=1), rtol=1e-9)
    assert {curve.label for curve in panel_b} == {"p/E* = −0.00532", "p/E* = 0.00832", "p/E* = 0.06265"}
    expected = models["persson"]["pressure_pdf"].sel(well_depth_ratio=8).isel(step=1)
    np.testing.assert_allclose(10 ** one(panel_b, "persson", 0).y / MODULUS, expected, rtol=1e-9)


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


def test_drawn_densities_are_the_data_and_end_with_the_simulations(models, shown):
    found = density_panels("gap", models, "pressure", shown)
    figure = figures.gap_distribution_figure(*found)
    for axes, curves in zip(figure.axes, found, strict=True):
        drawn = [line.get_xydata() for line in axes.lines]
        assert len(drawn) == len(curves)
        for line, curve in zip(drawn, curves, strict=True):
            np.testing.assert_array_equal(line, np.column_stack([curve.x, curve.y]))
    assert png(figure) == png(figures.gap_distribution_figure(*found))
    found = density_panels("pressure", models, "pressure", shown)
    left, right = figures.stress_distribution_figure(*found).axes
    assert left.get_ylim() == right.get_ylim()
    assert left.get_ylim()[0] == pytest.approx(smallest_resolved([*found[0], *found[1]]) - 0.3)


def test_detached_and_unconverged_states(tmp_path):
    paths = [write(tmp_path / "c.nc", "continuum", unconverged=[(0, 1)], detached=[(1, 1)])]
    models = read_inputs([*paths, write(tmp_path / "a.nc", "atomistic")]).models
    curves = path_curves(models, "pressure").areas
    unconverged, detached = one(curves, "continuum", 0), one(curves, "continuum", 1)
    np.testing.assert_array_equal(unconverged.fit[:3], [True, False, True])
    assert np.isfinite(unconverged.y[1]), "shown, with a cross"
    assert np.isnan(detached.y[1]), "not shown"
    panel_a, panel_b = density_panels("pressure", models, "pressure", panel_points(models, "pressure"))
    assert ("continuum", 0) not in {(curve.model, curve.colour) for curve in [*panel_a, *panel_b]}


def test_states_of_another_study(tmp_path):
    text = SINGLE.replace('"0.7799 GPa", "5.8725 GPa"', '"1 GPa", "2 GPa", "3 GPa"')
    models = read(tmp_path, text, ("continuum", "theory")).models
    shown = panel_points(models, "pressure")
    assert not shown.paper
    assert [float(named[0]) for named in shown.several] == [0.1e9, 2e9, 3e9]
    assert float(panel_points(models, "pressure", 0.9e9).common[0]) == 1e9
    curves = path_curves(models, "pressure")
    assert {curve.label for curve in curves.areas} == {""}
    assert png(figures.contact_area_figure(curves)).startswith(b"\x89PNG")
    swept = read(tmp_path, SINGLE + '[sweep]\n"surface.hurst_exponent" = [0.5, 0.8]\n').models
    assert [point.label for point in sweep_points(swept)] == ["H = 0.5", "H = 0.8"]
    assert len(path_curves(swept, "pressure").areas) == 4


# --- Means over seeds ------------------------------------------------------------------------------------------------


def test_seeds_are_averaged_with_their_standard_error(tmp_path):
    models = read(tmp_path, SEEDED, unconverged=[(1, 0)]).models
    assert [point.label for point in sweep_points(models)] == ["ε = ε₀", "ε = 8 ε₀"]
    curve = one(path_curves(models, "pressure").areas, "continuum", 1)
    # Case 1 is the first seed at the second ratio: its first step is left out.
    first, second = area(8, 0.1e9, SEEDS[1:]), area(8, -0.4987e9, SEEDS)
    np.testing.assert_allclose(curve.y[:2], [first.mean(), second.mean()], rtol=1e-12)
    np.testing.assert_allclose(curve.y_error[:2], [standard_error(first), standard_error(second)], rtol=1e-9)


def test_densities_carry_the_error_of_their_logarithm(seeded):
    shown = panel_points(seeded, "pressure")
    panel, _ = density_panels("pressure", seeded, "pressure", shown)
    curve = one(panel, "continuum", 1)
    step = PRESSURES[8].index(float(shown.common[0]))
    values = seeded["continuum"]["pressure_pdf"].sel(well_depth_ratio=8).isel(step=step).values
    mean, error = values.mean(axis=0), standard_error(values)
    there = mean > error
    np.testing.assert_allclose(10 ** curve.y[there] / MODULUS, mean[there], rtol=1e-9)
    np.testing.assert_allclose(curve.y_error[there], (error / mean)[there] / np.log(10), rtol=1e-9)
    figure = figures.stress_distribution_figure(panel, [])
    assert len([found for found in figure.axes[0].collections if found.get_alpha() == ERROR]) == len(panel)


def test_errors_of_gaps_and_pressures_are_in_the_units_of_the_axes(tmp_path):
    text = SEEDED.replace('rms_height = "10 angstrom"', 'rms_height = "8 angstrom"')
    curves = path_curves(read(tmp_path, text).models, "pressure")
    scatter = standard_error(gap(8, 0.1e9, SEEDS))
    for found in (curves.gaps, curves.linear_gaps):
        assert one(found, "continuum", 1).x_error[0] == pytest.approx(scatter / 8e-10, rel=1e-6)
    # Under a prescribed gap it is the pressure that scatters.
    models = read(tmp_path, GAP_STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2, 3]\n')).models
    for dataset in models.values():
        dataset["mean_pressure"] = dataset["mean_pressure"] * (1 + 0.1 * dataset["seed"])
    pressure = np.array([1.1, 1.2, 1.3]) * pressure_at(0.2e-9)
    error, curves = standard_error(pressure), path_curves(models, "gap")
    found = one(curves.gaps, "continuum", 1)
    assert found.y[3] == pytest.approx(np.log(pressure.mean() / MODULUS), rel=1e-9)
    assert found.y_error[3] == pytest.approx(error / pressure.mean(), rel=1e-6), "of the logarithm"
    assert one(curves.linear_gaps, "continuum", 1).y_error[3] == pytest.approx(error / MODULUS, rel=1e-6)
    assert one(curves.areas, "continuum", 1).x_error[3] == pytest.approx(error / 1e6, rel=1e-6), "the axis is in MPa"


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


def test_lines_have_bands_and_markers_have_bars(seeded):
    axes = figures.contact_area_figure(path_curves(seeded, "pressure")).axes[0]
    bands = [found for found in axes.collections if isinstance(found, PolyCollection)]
    assert len(bands) == 2, "the continuum's, at each ratio; the atoms have no line"
    corners = np.concatenate([path.vertices for band in bands for path in band.get_paths()])
    low = area(1, 0.1e9, SEEDS).mean() - standard_error(area(1, 0.1e9, SEEDS))
    assert np.isclose(corners[:, 1], low, rtol=1e-9).any()
    assert len([container for container in axes.containers if container.has_yerr]) == 2, "the atoms'"


# --- The scatter between surfaces behind the models of one ------------------------------------------------------------


@pytest.fixture
def scatter(inputs, tmp_path):
    return read_scatter(write(tmp_path / "seeds.nc", "continuum", SEEDED), inputs)


def test_strips_are_a_standard_deviation_about_the_mean(inputs, scatter):
    strips = scatter_strips(inputs.models, scatter, "pressure")
    assert strips.label == "continuum, 3 surfaces"
    for colour, ratio in enumerate(PRESSURES):
        along, across = (
            one(strips.curves.areas, "continuum", colour),
            one(strips.curves.linear_gaps, "continuum", colour),
        )
        steps, areas, gaps = slice(len(PRESSURES[ratio])), of_seeds(area, ratio), of_seeds(gap, ratio)
        np.testing.assert_allclose(along.y[steps], areas.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(along.y_error[steps], areas.std(axis=0, ddof=1), rtol=1e-9)
        np.testing.assert_allclose(across.x_error[steps] / across.x[steps], gaps.std(0, ddof=1) / gaps.mean(0), 1e-9)


def test_points_that_are_not_compared_have_no_strip(scatter, tmp_path):
    inputs = read(tmp_path, STUDY.replace("= [1, 8]", "= [8]"))
    (only,) = scatter_strips(inputs.models, scatter, "pressure").curves.areas
    # The first colour of the figure, though the second of the realisations.
    assert only.colour == 0
    np.testing.assert_allclose(only.y[0], of_seeds(area, 8)[:, 0].mean(), rtol=1e-12)


def test_strips_are_drawn_behind_in_their_colours(inputs, scatter):
    strips = scatter_strips(inputs.models, scatter, "pressure")
    curves = path_curves(inputs.models, "pressure")
    drawn = figures.contact_area_figure(curves, "GPa", strips=strips)
    beside = figures.mean_gap_figure(curves, strips=strips)
    expected = [tuple(np.round([int(code[i : i + 2], 16) / 255 for i in (1, 3, 5)], 3)) for code in SWEEP_COLOURS[:2]]
    for axes in (*drawn.axes, *beside.axes):
        found = [each for each in axes.collections if isinstance(each, PolyCollection)]
        assert all(each.get_zorder() < 1 for each in found)
        assert [tuple(np.round(each.get_facecolor()[0][:3], 3)) for each in found] == expected
    corners = np.concatenate([path.vertices for path in drawn.axes[0].collections[0].get_paths()])
    mean, deviation = of_seeds(area, 1).mean(0), of_seeds(area, 1).std(0, ddof=1)
    assert corners[:, 1].min() == pytest.approx((mean - deviation).min(), rel=1e-9)
    assert corners[:, 1].max() == pytest.approx((mean + deviation).max(), rel=1e-9)
    for figure in (drawn, beside):
        assert "continuum, 3 surfaces" in [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.parametrize(("pressures", "plain"), [([0.2, 0.5, 1.0, 2.0], True), ([0.01, 0.1, 1.0, 10.0], False)])
def test_pressures_of_a_decade_are_plain_numbers(pressures, plain):
    x = np.array(pressures)
    axes = figures.contact_area_figure(panels.areas([Curve("continuum", "", 0, x, x / 20)])).axes[1]
    axes.figure.draw_without_rendering()
    low, high = axes.get_xlim()
    ticks = zip(axes.get_xticks(), axes.xaxis.get_majorticklabels(), strict=True)
    labels = [text.get_text() for at, text in ticks if low <= at <= high]
    assert (labels == ["0.2", "0.5", "1", "2"]) == plain
    assert not any(text.get_text() for text in axes.xaxis.get_minorticklabels())
