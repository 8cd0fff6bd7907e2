"""Pictures are checked by the data that they show."""

import matplotlib
import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from contact_study import plots
from contact_study.plots.curves import dissipated_energy
from contact_study.plots.style import COLOURS

SIDE, SPACING = 16, 1e-9


def state(**changes):
    """One state as simulations write it, with gaps, pressures and heights that a test can foretell."""
    position = SPACING * np.arange(SIDE)
    y, x = np.mgrid[:SIDE, :SIDE]
    gap = np.where((abs(x - 4) < 2) & (abs(y - 4) < 3), 0.1e-9, 1e-9 * (1 + x + 0.1 * y))
    gap[:, 15], gap[8:10, 12:14] = 2e-9, 0.1e-9
    fields = {"gap": gap, "pressure": 1e8 * (x - 3.0), "height": 1e-9 * np.cos(2 * np.pi * (x - 2 * y) / SIDE)}
    return xr.Dataset(
        {name: (("y", "x"), values) for name, values in fields.items()} | {"contact_distance": 0.2e-9},
        {"y": position, "x": position},
    ).assign(**changes)


def path(pressures, areas, gaps, branch, **further):
    values = {
        "mean_pressure": pressures,
        "relative_contact_area": areas,
        "mean_gap": gaps,
        "mean_separation": gaps,
        "converged": np.ones(len(branch)),
        "detached": np.zeros(len(branch)),
    }
    return xr.Dataset(
        {name: ("step", np.asarray(value, float)) for name, value in {**values, **further}.items()},
        {"step": np.arange(len(branch)), "branch": ("step", np.array(branch))},
    )


def test_maps_show_their_field_upwards_in_its_unit():
    (image,) = plots.height_map(state()).images
    assert image.get_array()[2, 1] == pytest.approx(np.cos(2 * np.pi * (1 - 2 * 2) / SIDE))  # nm
    assert image.colorbar.ax.get_ylabel() == "height (nm)"
    axes = plots.gap_map(state())
    (image,) = axes.images
    shown = image.get_array()
    assert shown.mask.sum() == 3 * 5 + 4
    np.testing.assert_allclose(shown[0, 6], 7.0, rtol=1e-6)  # nm, at x = 6, y = 0
    assert shown[6, 0] > shown[0, 0]  # y upwards
    assert image.origin == "lower"
    np.testing.assert_allclose(image.get_extent(), (0, 16, 0, 16))
    assert axes.get_xlabel() == "$x$ (nm)"
    assert image.colorbar.ax.get_ylabel() == "gap (nm), contact black"
    image = plots.pressure_map(state()).images[0]
    np.testing.assert_allclose(image.get_array()[5], 1e-1 * (np.arange(SIDE) - 3), atol=1e-9)  # GPa
    assert image.norm.vmin == -image.norm.vmax
    red, blue = image.cmap(image.norm(1.0)), image.cmap(image.norm(-0.3))
    assert red[0] > red[2]
    assert blue[2] > blue[0]


def test_contact_map_colours_the_largest_clusters_first():
    axes = plots.contact_map(state(), largest=1)
    (image,) = axes.images
    colour = [
        to_rgb(image.cmap(image.norm(image.get_array()[row, column]))[:3]) for row, column in ((4, 4), (8, 12), (0, 9))
    ]
    assert colour[0] == to_rgb(COLOURS[0])
    assert colour[1] == to_rgb("#9a9a9a")
    assert colour[2] == (1, 1, 1)
    assert axes.get_title() == f"contact area {19 / 256:.3g}, 2 clusters"
    thermal = state(relative_contact_area=0.123, cluster_count=7, relative_contact_area_standard_error=0.01)
    assert plots.contact_map(thermal).get_title() == "mean contact area 0.123, mean 7 clusters"


def test_contact_map_of_a_free_surface_ends_at_its_rim():
    rims = np.isin(np.arange(SIDE), [0, SIDE - 1])
    both_rims = state(gap=(("y", "x"), np.where(rims, 0.1e-9, np.full((SIDE, SIDE), 1e-9))))
    free = both_rims.assign_attrs(study_toml='[elasticity]\nboundary = "free"\n')
    assert "one cluster" in plots.contact_map(both_rims).get_title()
    for known in (free, both_rims.assign_coords(boundary="free")):
        assert "2 clusters" in plots.contact_map(known).get_title()


def test_a_wall_is_in_contact_where_it_presses_or_holds():
    """With attraction points touch under tension, too; surfaces that are just apart do not touch at their highest."""
    wall = state(contact_distance=0.0)
    wall["gap"] = wall["gap"] * 0
    assert plots.contact_map(wall).images[0].get_array().astype(bool).sum() == 15 * SIDE


def test_section_has_both_surfaces_and_the_contact():
    axes = plots.section(state(), y=4.2e-9)
    surface, block, contact = (line.get_ydata() for line in axes.lines)
    assert axes.get_ylabel() == "height (nm)"
    np.testing.assert_allclose(surface, np.cos(2 * np.pi * (np.arange(SIDE) - 8) / SIDE), atol=1e-9)
    np.testing.assert_allclose(block - surface, 1e9 * state()["gap"].values[4], rtol=1e-9)
    assert list(np.flatnonzero(np.isfinite(contact))) == [3, 4, 5]
    with pytest.raises(ValueError, match="outside the cell"):
        plots.section(state(), y=17e-9)
    high = state()
    high["height"][11, 3] = 5e-9
    assert max(plots.section(high).lines[0].get_ydata()) == pytest.approx(5.0)


def test_curves_part_loading_from_unloading_and_leave_out_what_did_not_converge():
    dataset = path(
        [1e6, 2e6, 4e6, 2e6, -1e6],
        [0.1, 0.2, 0.4, 0.3, 0.15],
        [5e-9, 4e-9, 2e-9, 3e-9, 4.5e-9],
        [0, 0, 0, 1, 1],
        converged=[1, 0, 1, 1, 1],
    )
    before, axes = dict(matplotlib.rcParams), Figure().subplots()
    assert plots.contact_area(dataset, axes) is axes
    assert dict(matplotlib.rcParams) == before
    forth, back, _ = axes.lines
    chains = [line.get_segments()[0][:, 0] for line in axes.collections if isinstance(line, LineCollection)]
    assert [list(chain) for chain in chains] == [[1, 4], [4, 2, -1]]
    np.testing.assert_allclose(forth.get_ydata(), [0.1, 0.4])
    np.testing.assert_allclose(back.get_xdata(), [2, -1])
    assert back.get_markerfacecolor() == "white"
    assert axes.get_xlabel() == "pressure $p$ (MPa)"
    forth, back = plots.mean_gap(dataset).lines[:2]
    np.testing.assert_allclose([*forth.get_ydata(), *back.get_ydata()], [5, 2, 3, 4.5])  # nm


def test_tension_is_shown_on_logarithms_of_both_signs():
    known = path([1e6, 1e8, 1e9, -1e7], [0.1, 0.2, 0.4, 0.15], [4e-9] * 4, [0, 0, 0, 1])
    axes = plots.contact_area(known, scale="symlog")
    np.testing.assert_allclose(axes.get_xticks(), [-0.01, -0.001, 0, 0.001, 0.01, 0.1, 1])
    assert axes.get_xlim()[0] > -1
    with pytest.raises(ValueError, match="scale = 'cubic'"):
        plots.contact_area(known, scale="cubic")


def test_a_line_for_each_point_of_the_sweep_and_each_theory():
    one = path([1e9, 2e9], [0.1, 0.2], [5e-9, 4e-9], [0, 0])
    swept = xr.concat([one, one * 2], xr.DataArray(["persson", "edge_flow"], dims="theory", name="theory"))
    for converged, shown in ((swept["converged"], ["persson"]), (1.0, ["persson", "edge flow"])):  # 1 and 2, or 1
        axes = plots.contact_area(swept.assign(converged=converged).assign_coords(branch=one["branch"]))
        assert axes.get_legend_handles_labels()[1] == shown


def test_dissipated_energy_of_a_parallelogram():
    """Separation 10 − p while loading, 8 − p back, between −1 and 4 MPa: ∫ = 2 nm × 5 MPa, less a triangle.

    At the turning point both branches meet, so that the loop closes over the last step of 1 MPa: a triangle of ½.
    """
    forth, back = np.array([-1, 0, 1, 2, 3, 4.0]), np.array([3, 2, 1, 0, -1.0])
    dataset = path(
        1e6 * np.concatenate([forth, back]),
        np.full(11, 0.1),
        1e-9 * np.concatenate([10 - forth, 8 - back]),
        [0] * 6 + [1] * 5,
    )
    assert dissipated_energy(dataset) == pytest.approx(2e-9 * 1e6 * 4.5, rel=1e-9)
    each = {
        f"passed_{name}": dataset[f"mean_{name}"].expand_dims(passed=1, axis=-1) for name in ("pressure", "separation")
    }
    assert dissipated_energy(dataset.assign(each)) == dissipated_energy(dataset)  # of one state a step
    axes = plots.hysteresis_loop(dataset)
    assert "0.009 J/m² dissipated" in axes.get_legend_handles_labels()[1]
    np.testing.assert_allclose(axes.lines[0].get_xdata(), 11 - np.arange(6))  # nm, pressures from below
    np.testing.assert_allclose(axes.collections[0].get_paths()[0].get_extents().extents, [5, -1, 11, 4])  # shaded
    there = 1e-9 * (10 - forth)
    back_again = np.append(there, there[-2::-1] + 1e-15)
    equal = path(1e6 * np.append(forth, forth[-2::-1]), np.full(11, 0.1), back_again, [0] * 6 + [1] * 5)
    assert dissipated_energy(equal) < 0
    words = plots.hysteresis_loop(equal).get_legend_handles_labels()[1]
    assert "0 J/m² dissipated: reversible within rounding" in words
    gap = dataset.rename(mean_pressure="mean_separation", mean_separation="mean_pressure")
    held = gap.assign(mean_separation=gap.mean_separation * 1e-15, mean_pressure=gap.mean_pressure * 1e15)
    held = held.assign_coords(applied_gap=held.mean_separation)
    assert dissipated_energy(held) == pytest.approx(2e-9 * 1e6 * 4.5, rel=1e-9)
    x, y = plots.hysteresis_loop(held).lines[0].get_xydata()[[0, -1]].T
    assert x[0] < x[1]
    assert y[0] > y[1]
    with pytest.raises(ValueError, match="no cycle"):
        plots.hysteresis_loop(dataset.isel(step=slice(6)))
    with pytest.raises(ValueError, match="select one along 'seed'"):
        plots.hysteresis_loop(xr.concat([dataset, dataset], "seed"))


def test_the_loop_shows_what_its_own_steps_passed_and_marks_jump_in_and_pull_off():
    """A path down to 1 nm and out again, whose points alone make no cycle: its states do."""
    dataset = path([-1e6, 4e6, 0.0], np.full(3, 0.1), [5e-9, 1e-9, 6e-9], [0, 0, 0])
    pressures, separations = [[-1, -2, np.nan], [2, 4, np.nan], [1, -3, 0]], [[5, 4, np.nan], [2, 1, np.nan], [2, 3, 6]]
    passed = {"passed_pressure": 1e6 * np.array(pressures), "passed_separation": 1e-9 * np.array(separations)}
    results = {"jump_in_pressure": -2e6, "jump_in_separation": 4e-9}
    results |= {"pull_off_pressure": -3e6, "work_of_separation": 0.0055}
    dataset = dataset.assign({name: (("step", "passed"), values) for name, values in passed.items()}).assign(results)
    dataset = dataset.assign_coords(applied_gap=dataset.mean_separation)
    # At 1, 2, 3, 4, 5 nm loading carries 4, 2, 0, −2, −1 MPa, unloading 4, 1, −3, −2, −1.
    for branch in ([0, 0, 0], [0, 0, 1]):  # the way back begins at the least separation, or with unloading
        known = dataset.assign_coords(branch=("step", branch))
        assert dissipated_energy(known) == pytest.approx((0.5 + 2.0 + 1.5) * 1e-3, rel=1e-9)
    axes = plots.hysteresis_loop(dataset)
    marked = {line.get_label(): (float(line.get_xdata()[0]), float(line.get_ydata()[0])) for line in axes.lines[2:4]}
    assert marked == {
        "jump-in": (pytest.approx(4), pytest.approx(-2)),
        "pull-off, 0.0055 J/m² of work to separate": (pytest.approx(3), pytest.approx(-3)),
    }
    assert len(plots.hysteresis_loop(dataset.drop_vars(list(results))).lines) == 3


def test_spectrum_is_that_of_the_waves_and_keeps_the_variance():
    heights = np.random.default_rng(3).standard_normal((SIDE, SIDE)) * 1e-10
    surface = state(height=(("y", "x"), heights))
    line = plots.surface_spectrum(surface).lines[0]
    # White noise has one C(q): its variance over the area of wavevectors (2π/Δ)², here within the scatter of a band.
    white = heights.var() * SPACING**2 / (2 * np.pi) ** 2
    # The bands hold unequal numbers of waves: those of the upper octave are the many.
    assert np.mean(line.get_ydata()[-8:]) == pytest.approx(white, rel=0.2)
    with pytest.raises(ValueError, match="flat"):
        plots.surface_spectrum(state(height=(("y", "x"), np.zeros((SIDE, SIDE)))))


def test_distributions_have_the_units_of_their_axis():
    bins = np.linspace(-2e9, 2e9, 9)
    density = np.exp(-((bins / 1e9) ** 2)) * 1e-9 * (bins > -2e9)
    dataset = xr.Dataset({"pressure_pdf": ("pressure_bin", density)}, {"pressure_bin": bins})
    line = plots.stress_distribution(dataset).lines[0]
    np.testing.assert_allclose(line.get_xdata()[5], 0.5)
    np.testing.assert_allclose(line.get_ydata()[5], np.exp(-0.25))
    assert np.isnan(line.get_ydata()[0])


def test_deviations_stand_under_their_own_pressures():
    values = [[[0.1, -0.2, np.nan], [0.3, 0.02, 0.05]]]
    pressures = [[1e9, 2e9, np.nan], [-5e8, 1e9, 2e9]]
    dataset = xr.Dataset(
        {"relative_contact_area_relative_deviation": (("pair", "well_depth_ratio", "step"), values)},
        {
            "pair": ["continuum - atomistic"],
            "well_depth_ratio": [1.0, 8.0],
            "applied_pressure": (("well_depth_ratio", "step"), pressures),
            "branch": (("well_depth_ratio", "step"), [[0, 0, -1], [0, 0, 0]]),
        },
    )
    axes = plots.deviations(dataset, "continuum - atomistic")
    shown = axes.images[0].get_array().filled(np.nan)
    np.testing.assert_allclose(shown, [[np.nan, 10, -20], [30, 2, 5]])
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["-0.5", "1", "2"]
    assert [tick.get_text() for tick in axes.get_yticklabels()] == ["well depth ratio = 1", "well depth ratio = 8"]
    with pytest.raises(ValueError, match="the dataset has continuum - atomistic"):
        plots.deviations(dataset, "moon - sun")


def test_what_is_missing_or_too_much_is_refused_with_the_way_out():
    for draw, missing in ((plots.gap_map, "gap"), (plots.section, "height"), (plots.contact_area, "pressure")):
        with pytest.raises(ValueError, match=f"no variable '(mean_)?{missing}'"):
            draw(state().drop_vars(missing))
    two = xr.concat([state(), state()], xr.DataArray([3, 4], dims="step", name="step"), data_vars="all")
    with pytest.raises(ValueError, match=r"select one first, for example dataset.sel\(step=4\)"):
        plots.gap_map(two)
    plots.gap_map(two.sel(step=3))


RATIOS = {
    "persson_tosatti_ratio": [0.1, 0.5],
    "pastewka_robbins_ratio": [0.2, 0.7],
    "dmt_tension_ratio": [0.9, 4.0],
    "bearing_area_ratio": [0.4, 3.0],
}


def criteria():
    columns = {"finest_tabor_number": [0.3, 2.0], **RATIOS}
    return xr.Dataset(
        {name: ("well_depth_ratio", values) for name, values in columns.items()}, {"well_depth_ratio": [1.0, 8.0]}
    )


def test_every_point_of_the_sweep_is_a_column_of_all_criteria():
    axes = plots.criteria_map(criteria(), name="study")
    markers = [line for line in axes.lines if line.get_marker() in "s^Do" and len(line.get_xdata()) == 1]
    shown = np.array([line.get_xydata()[0] for line in markers])
    expected = [[tabor, RATIOS[name][column]] for column, tabor in enumerate((0.3, 2.0)) for name in RATIOS]
    np.testing.assert_allclose(shown, expected)
    # Persson and Tosatti's is made for large Tabor parameters, the others for small ones.
    hollow = [line.get_markerfacecolor() == "white" for line in markers]
    assert hollow == [True, False, False, False, False, True, True, True]
    assert [text.get_text() for text in axes.texts][-2:] == [f"study\nwell depth ratio = {k}" for k in (1, 8)]
    low, high = axes.get_ylim()
    assert low < 0.1 < 4 < high
    assert 1 in axes.lines[0].get_ydata()
    assert axes.get_xscale() == axes.get_yscale() == "log"
    plots.criteria_map(criteria().isel(well_depth_ratio=1), axes, "one")  # on the same map
    assert len(axes.get_legend_handles_labels()[1]) == 4
    assert axes.texts[-1].get_text() == "one"
    with pytest.raises(ValueError, match="persson_tosatti_ratio"):
        plots.criteria_map(criteria().drop_vars("persson_tosatti_ratio"))


WAVEVECTOR = 3e7 * np.array([1.0, 2.0, 4.0, 8.0])
ZETA = np.array([2.0, 4.0, 8.0])
STRESS = np.linspace(-2e9, 6e9, 17)


def magnified():
    """Two states whose numbers a test can foretell."""
    density = np.exp(-0.5 * ((STRESS[None, :] - 1e9) / (4e8 * ZETA[:, None])) ** 2) / ZETA[:, None] * 1e-9
    states = np.stack([density, 2 * density])
    curves = {
        "relative_contact_area_at": [[1.0, 0.8, 0.5, 0.2], [1.0, 0.9, 0.7, 0.4]],
        "detachment_stress": [[0.0, 0.0, 1e9, 3e9], [0.0, 1e9, 2e9, 4e9]],
        "effective_work_of_adhesion": [[-0.1, 0.1, 0.3, 0.7], [0.1, 0.2, 0.5, 1.4]],
    }
    return xr.Dataset(
        {name: (("step", "wavevector"), values) for name, values in curves.items()}
        | {"pressure_pdf_at": (("step", "magnification", "pressure_bin"), states)},
        {"wavevector": WAVEVECTOR, "magnification": ZETA, "pressure_bin": STRESS, "step": [0, 1]},
    )


@pytest.mark.parametrize(
    ("draw", "name", "unit", "words"),
    [
        (plots.area_by_magnification, "relative_contact_area_at", 1, "$A(\\zeta)/A_0$"),
        (plots.detachment_stress, "detachment_stress", 1e9, "(GPa)"),
        (plots.effective_work_of_adhesion, "effective_work_of_adhesion", 1, "(J/m²)"),
    ],
)
def test_curves_are_over_the_magnification_in_their_units(draw, name, unit, words):
    axes = draw(magnified())
    lines = [line for line in axes.lines if len(line.get_xdata()) == 4]
    assert [line.get_label() for line in lines] == ["step = 0", "step = 1"]
    for number, line in enumerate(lines):
        np.testing.assert_allclose(line.get_xdata(), [1, 2, 4, 8])
        np.testing.assert_allclose(line.get_ydata(), magnified()[name][number] / unit)
    assert axes.get_ylabel().endswith(words)
    assert axes.get_xscale() == "log"


def test_small_works_of_adhesion_are_in_millijoules():
    axes = plots.effective_work_of_adhesion(magnified().isel(step=0) * 1e-3)
    assert axes.get_ylabel().endswith("(mJ/m²)")
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(0.7)
    assert list(axes.lines[1].get_ydata()) == [0, 0], "zero is marked where the energy changes its sign"


def test_map_shows_the_density_at_its_stress_and_magnification():
    known = magnified().isel(step=1)
    axes = plots.stress_by_magnification(known)
    mesh, shown = axes.collections[0], axes.collections[0].get_array()
    across, along = mesh.get_coordinates()[0, :, 0], mesh.get_coordinates()[:, 0, 1]
    assert across[-1] == ZETA[-1]
    assert np.all((across[:-1] < ZETA) & (across[1:] >= ZETA))
    density = known["pressure_pdf_at"].values.T * 1e9  # stress upwards, in 1/GPa
    rows = np.searchsorted(STRESS / 1e9, 0.5 * (along[1:] + along[:-1]) - 1e-9)
    np.testing.assert_allclose(shown.filled(0), np.where(density > 1e-4 * density.max(), density, 0)[rows])
    assert shown.mask.any()
    assert axes.get_ylabel() == r"stress $\sigma$ (GPa)"
    assert "1/GPa" in mesh.colorbar.ax.get_ylabel()


def test_states_without_a_map_are_refused():
    with pytest.raises(ValueError, match=r"theory\.magnifications = 48"):
        plots.stress_by_magnification(magnified().drop_vars("pressure_pdf_at"))
    with pytest.raises(ValueError, match="more than one state: select one along 'step'"):
        plots.stress_by_magnification(magnified())
    with pytest.raises(ValueError, match="nothing is in contact"):
        plots.stress_by_magnification(magnified().isel(step=0) * 0)


def probe(**further):
    """A sphere on 2 nm² that turns at 3 nm, prescribed through a spring of 1 N/m."""
    approach, force = np.array([-1.0, 1.0, 3.0, 1.0, -2.0]) * 1e-9, np.array([0.0, 0.5, 2.0, 0.0, -0.5]) * 1e-9
    displacement = approach - force
    found = path(force / 2e-18, [0, 1, 1, 1, 1], 5e-9 - displacement, np.zeros(5, int), total_force=force)
    named = {"displacement": displacement, "approach": approach}
    found = found.assign({name: ("step", values) for name, values in named.items()}).assign(further)
    return found.assign_coords(applied_approach=("step", approach))


def test_force_curves_show_the_way_in_dashed_and_the_way_out_solid():
    axes = plots.force_curve(probe(pull_off_force=-0.5e-9))
    inwards, outwards, mark, *_ = axes.lines
    assert (inwards.get_linestyle(), outwards.get_linestyle()) == ("--", "-")
    np.testing.assert_allclose(inwards.get_xdata(), [-1, 0.5, 1, 1, -1.5])  # nm
    np.testing.assert_allclose(inwards.get_ydata(), [0, 0.5, 2, np.nan, np.nan])  # nN
    np.testing.assert_allclose(outwards.get_ydata(), [np.nan, np.nan, 2, 0, -0.5])
    assert [*mark.get_xdata(), *mark.get_ydata()] == pytest.approx([-1.5, -0.5])
    assert mark.get_label() == "pull-off 0.5 nN"
    assert axes.get_xlabel() == r"displacement $\delta$ (nm)"
    np.testing.assert_allclose(plots.force_curve(probe(), against="approach").lines[0].get_xdata(), [-1, 1, 3, 1, -2])
    with pytest.raises(ValueError, match=r"must be 'displacement' or .* or 'approach'"):
        plots.force_curve(probe(), against="gap")


def test_force_curves_show_a_later_approach_apart_from_the_first():
    approach = [-1.0, 1.0, 3.0, 1.0, 1.0, 2.0, -2.0, np.nan]  # a dwell on the way out; a shorter path is padded
    force = np.array([0.0, 0.5, 2.0, 0.0, 0.1, 1.0, -0.5, np.nan]) * 1e-9
    again = path(force / 2e-18, [1] * 8, [5e-9] * 8, np.zeros(8, int), total_force=force, displacement=force)
    again = again.assign_coords(applied_approach=("step", 1e-9 * np.array(approach)))
    axes = plots.force_curve(again)
    drawn = [(line.get_linestyle(), list(np.flatnonzero(np.isfinite(line.get_ydata())))) for line in axes.lines[:4]]
    assert drawn == [("--", [0, 1, 2]), ("-", [2, 3, 4]), ("-.", [4, 5]), ("-", [5, 6])]
    looks = [(line.get_linestyle(), line.get_label()) for line in axes.get_legend().get_lines()]
    assert looks == [("--", "first approach"), ("-", "retraction"), ("-.", "later approach")]
    once = plots.force_curve(again.isel(step=[0, 1, 2, 3, 7])).get_legend().get_lines()
    assert [line.get_label() for line in once] == ["approach", "retraction"]


def test_values_of_a_sweep_are_in_a_unit_that_suits_them():
    triggers = xr.DataArray([5e-7, 1.5e-6], dims="trigger_force", name="trigger_force", attrs={"units": "N"})
    axes = plots.force_curve(xr.concat([probe(), probe()], triggers))
    assert axes.get_legend_handles_labels()[1][:2] == ["trigger force = 500 nN", "trigger force = 1500 nN"]


def test_force_curves_show_all_states_that_adaptive_steps_passed():
    passed = np.full((5, 2), np.nan)
    passed[:, -1] = probe()["mean_pressure"]
    separation = passed.copy()
    separation[:, -1] = probe()["mean_separation"]
    passed[2, 0], separation[2, 0] = 0.5e9, 4e-9  # 1 nN at a displacement of 1 nm, machine at 2 nm
    names = {"passed_pressure": passed, "passed_separation": separation}
    found = probe(**{name: (("step", "passed"), values) for name, values in names.items()})
    for against, x in (("displacement", 1.0), ("approach", 2.0)):
        line = plots.force_curve(found, against=against).lines[0]
        np.testing.assert_allclose([line.get_xdata()[2], line.get_ydata()[2]], [x, 1.0])
        assert len(line.get_xdata()) == 6


def test_patch_sizes_and_leakage():
    density = np.array([[0.0, 4e3, 20.0], [1e4, 0.0, 5.0]])
    sizes = xr.Dataset(
        {"patch_size_density": (("step", "relative_patch_area"), density)},
        {"step": [0, 1], "relative_patch_area": [1e-4, 1e-3, 1e-2]},
    )
    for line, values in zip(plots.patch_sizes(sizes).lines, density, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), [1e-4, 1e-3, 1e-2])
        np.testing.assert_array_equal(line.get_ydata(), np.where(values > 0, values, np.nan))
    wide, narrow = [3e-9, 2e-9, 0.0, 0.0], [2e-9, 1e-9, 1e-10, 0.0]
    leaks = path([1e6, 2e6, 3e6, 4e6], [0.1, 0.2, 0.4, 0.5], [5e-9] * 4, [0] * 4)
    leaks = leaks.assign(hydraulic_gap_x=("step", wide), hydraulic_gap_y=("step", narrow), percolation_area=0.45)
    along_x, along_y, end = plots.leakage(leaks).lines
    np.testing.assert_allclose(along_x.get_xydata(), [[0.1, 3.0], [0.2, 2.0]])  # nm, and no zero
    np.testing.assert_allclose(along_y.get_xydata(), [[0.1, 2.0], [0.2, 1.0], [0.4, 0.1]])
    assert (along_y.get_linestyle(), along_y.get_label()) == ("--", "along y")
    assert (end.get_label(), end.get_xdata()[0]) == ("closed", 0.45)
    with pytest.raises(ValueError, match=r"output\.leakage = true"):
        plots.leakage(leaks.drop_vars("hydraulic_gap_y"))
