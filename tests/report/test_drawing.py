"""What stands on the page: nothing printed over anything else, nothing cut, every state named."""

import itertools

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from contact_study.plots.paths import (
    Curve,
    logarithmic,
    of_compression,
    path_segments,
    window,
)
from contact_study.plots.selection import extent
from contact_study.report.align.cases import sweep_points
from contact_study.report.align.curves import path_bands, path_curves
from contact_study.report.align.scales import scales
from contact_study.report.align.states import read_gaps
from contact_study.report.facts.shown_states import common_label, panel_points
from contact_study.report.figures import illustrations
from contact_study.report.figures import panels as figures
from contact_study.report.figures.legends import band_label
from contact_study.report.figures.states import gap_map_figure
from contact_study.report.figures.style import SWEEP_COLOURS, palette
from contact_study.report.read.datasets import read_inputs
from tests.report.panels import areas, at
from tests.report.synthetic import GAP_STUDY, STUDY, write, write_all

SINGLE = STUDY[: STUDY.index("[sweep]")]
SIX = SINGLE + '[sweep]\n"interaction.well_depth_ratio" = [1, 1.5, 2, 4, 6, 8]\n'
TWO_KEYS = SINGLE + '[sweep]\n"surface.hurst_exponent" = [0.5, 0.8]\n"interaction.well_depth_ratio" = [1, 4]\n'


def drawn(monkeypatch, inputs, wanted=None):
    """The figures of a comparison before they are files, with their captions."""
    kept = []
    monkeypatch.setattr(illustrations, "png", lambda figure: kept.append(figure) or b"")
    found = illustrations.draw(inputs, wanted)
    return dict(zip(found.images, kept, strict=True)), found.captions


def words_of(figure):
    return [text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_text")) if text.get_text()]


def boxes(figure: Figure):
    """Extents in pixels of what must not meet: legends, headings, labels of the axes, titles."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    artists = list(figure.findobj(Legend))
    for axes in figure.axes:
        artists += [*axes.texts, axes.title, axes.xaxis.label, axes.yaxis.label]
    artists += list(figure.texts)
    named = [artist for artist in artists if isinstance(artist, Legend) or artist.get_text()]
    return [(artist, artist.get_window_extent(renderer)) for artist in named], figure.bbox


def check_page(name, figure):
    placed, page = boxes(figure)
    for (one, first), (other, second) in itertools.combinations(placed, 2):
        # A pixel of an anti-aliased edge is no overlap.
        assert not first.padded(-1).overlaps(second.padded(-1)), (name, one, other)
    for artist, box in placed:
        inside = page.padded(1)
        assert inside.containsx(box.x0) and inside.containsx(box.x1), (name, artist)  # noqa: PT018
        assert inside.containsy(box.y0) and inside.containsy(box.y1), (name, artist)  # noqa: PT018


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        (SIX, ("continuum", "atomistic", "theory")),
        (TWO_KEYS, ("continuum", "theory")),
        (GAP_STUDY, ("continuum", "atomistic")),
    ],
    ids=["six", "two keys", "gap"],
)
def test_nothing_is_printed_over_anything_or_cut(monkeypatch, tmp_path, text, kinds):
    shown, _ = drawn(monkeypatch, read_inputs([write(tmp_path / f"{kind}.nc", kind, text) for kind in kinds]))
    for name, figure in shown.items():
        check_page(name, figure)


def cell(gap, size=(1e-8, 1e-8)):
    """A state on a cell, in contact below 3.68 Å."""
    y, x = (np.arange(count) * period / count for count, period in zip(gap.shape, size, strict=True))
    return xr.Dataset({"gap": (("y", "x"), gap), "contact_distance": 3.68e-10}, {"y": y, "x": x})


@pytest.mark.parametrize("size", [(1e-8, 4e-8), (4e-8, 1e-8), (1e-8, 1e-7), (1e-8, 1e-8)])
@pytest.mark.parametrize("models", [("atomistic", "continuum"), ("continuum",)])
def test_maps_of_any_cell_fit_their_page(size, models):
    gap = np.linspace(3e-10, 1e-9, 64).reshape(8, 8)
    figure = gap_map_figure(dict.fromkeys(models, cell(gap, size)), "ε = 8 ε₀, p/E* = 0.00832")
    check_page(size, figure)
    figure.canvas.draw()
    for axes in figure.axes[: len(models)]:
        box = axes.get_window_extent()
        # The cell's own proportions, to a pixel of a map at least a quarter of an inch wide.
        assert box.height / box.width == pytest.approx(size[0] / size[1], rel=0.04)
        assert box.width > 0.25 * figure.dpi


def test_every_panel_names_its_state(monkeypatch, tmp_path):
    shown, captions = drawn(monkeypatch, read_inputs(write_all(tmp_path)))
    for name in ("stress_distribution", "gap_distribution"):
        left, right = ([text.get_text() for text in axes.texts] for axes in shown[name].axes)
        assert left == ["(a)", "p/E* = 0.00832"]
        assert right == ["(b)", "ε = 8 ε₀"]
    assert "ε = 8 ε₀, p/E* = 0.00832" in words_of(shown["gap_map"])
    assert "(b) at ε = 8 ε₀, p/E* = −0.00532, 0.00832, 0.06265." in captions["stress_distribution"]
    assert "at ε = 8 ε₀, p/E* = 0.00832;" in captions["gap_map"]


def test_missing_distributions_are_named_with_their_reason(monkeypatch, tmp_path):
    paths = [
        write(tmp_path / "c.nc", "continuum", unconverged=[(0, 1)]),
        write(
            tmp_path / "t.nc",
            "theory",
            STUDY.replace('"0.1 GPa", "0.7799 GPa", "5.8725 GPa"]', '"0.1 GPa", "5.8725 GPa"]'),
        ),
    ]
    inputs = read_inputs(paths)
    for name in ("relative_contact_area", "pressure_pdf", "gap_pdf"):
        inputs.models["gap_flow"][name] = inputs.models["gap_flow"][name].where(inputs.models["gap_flow"].step > 2)
    words = drawn(monkeypatch, inputs)[1]["stress_distribution"]
    at = "p/E* = 0.00832"
    assert f"Not shown, being detached or not converged: the continuum at ε = ε₀, {at}." in words
    assert f"Not on the loading path: Persson's theory at ε = ε₀, {at}; the gap-flow theory at ε = ε₀, {at}." in words
    assert f"Without a result: the gap-flow theory at ε = 8 ε₀, {at}; the gap-flow theory at ε = 8 ε₀, p/E*" in words
    assert "Persson" not in drawn(monkeypatch, inputs)[1]["gap_distribution"], "which has no distribution of gaps"


def test_a_state_for_the_whole_sweep_is_in_units_of_all_of_it(tmp_path):
    text = SINGLE + '[sweep]\n"material.youngs_modulus" = ["50 GPa", "77.2 GPa"]\n'
    models = read_inputs([write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "theory")]).models
    named = panel_points(models, "pressure", 1e9).common
    assert common_label(models, named, "pressure") == "p = 779.9 MPa", "p/E* is not the same for both"
    single = read_inputs([write(tmp_path / f"s-{kind}.nc", kind, SINGLE) for kind in ("continuum", "theory")]).models
    assert common_label(single, named, "pressure") == "p/E* = 0.00832"


def test_the_band_is_the_gap_flow_theorys(monkeypatch, tmp_path):
    inputs = read_inputs(write_all(tmp_path))
    shown, captions = drawn(monkeypatch, inputs)
    for name in ("contact_area", "mean_gap"):
        assert band_label("gap_flow") in words_of(shown[name])
        assert "branches of the gap-flow theory" in captions[name]
    assert "gap-flow" in band_label("gap_flow")
    without = type(inputs)(
        inputs.paths,
        inputs.models,
        {"gap_flow": dict.fromkeys(("loading", "unloading"), inputs.models["gap_flow"])},
        inputs.studies,
    )
    assert path_bands(without.branches, inputs.models, 1e9).areas == [], "branches that are one"
    shown, captions = drawn(monkeypatch, without)
    for name in ("contact_area", "mean_gap"):
        assert band_label("gap_flow") not in words_of(shown[name])
        assert "band" not in captions[name]


def test_a_legend_is_read_along_its_rows():
    points = [Curve("continuum", f"H = 0.{number:02d}", number, np.ones(1), np.ones(1)) for number in range(31)]
    figure = figures.contact_area_figure(areas(points))
    figure.canvas.draw()
    legend = figure.legends[0]
    places = [text.get_window_extent() for text in legend.get_texts()]
    order = sorted(range(len(places)), key=lambda index: (-round(places[index].y0), places[index].x0))
    words = [legend.get_texts()[index].get_text() for index in order]
    assert words == ["H = 0.00", *(f"0.{number:02d}" for number in range(1, 31))], "what all begin with stands once"
    assert len({round(place.y0) for place in places}) > 1, "in several rows"


def test_more_colours_than_a_palette_are_all_different():
    twelve, six = ([Curve("continuum", "", number, *np.ones((2, 1))) for number in range(n)] for n in (12, 6))
    assert len({tuple(np.atleast_1d(colour)) for colour in palette(SWEEP_COLOURS, twelve)}) == 12
    assert palette(SWEEP_COLOURS, six) == list(SWEEP_COLOURS)


def marks_zero(axes):
    """Whether a line stands at a mean gap of zero."""
    return any(list(line.get_xdata()) == [0, 0] for line in axes.lines)


def test_tension_and_gaps_below_zero_are_shown(monkeypatch, tmp_path):
    inputs = read_inputs(write_all(tmp_path))
    for model, dataset in inputs.models.items():
        if model != "gap_flow":
            dataset["mean_gap"] = dataset["mean_gap"] - 0.3e-9
    shown, captions = drawn(monkeypatch, inputs)
    logarithmic, linear = shown["mean_gap"].axes
    assert logarithmic.get_ylabel() == r"$\ln\,(p/E^*)$"
    modulus = 77.2e9 / (1 - 0.42**2)
    low, high = linear.get_ylim()
    assert low < -0.4987e9 / modulus < 5.8725e9 / modulus < high
    drawn_here = np.concatenate([line.get_xydata() for line in linear.lines])
    state = inputs.models["continuum"].sel(well_depth_ratio=8).isel(step=1)
    expected = [float(state["mean_gap"]) / 1e-9, -0.4987e9 / modulus]
    assert np.isclose(drawn_here, expected, rtol=1e-9).all(axis=1).any()
    assert linear.get_xlim()[0] < expected[0]
    for axes in (logarithmic, linear):
        assert marks_zero(axes)
    words = captions["mean_gap"]
    assert words.startswith("(a) Natural logarithm")
    assert "(b) mean pressure in units of E*, tension negative" in words
    assert "Where ū < 0 (the atoms and the continuum; ε = ε₀ and ε = 8 ε₀), the surfaces are pressed closer" in words
    assert "Where ū < 0 (Persson's theory; ε = ε₀ and ε = 8 ε₀), its energy U(p) somewhere falls" in words


def test_without_tension_the_mean_gap_is_one_panel(monkeypatch, tmp_path):
    inputs = read_inputs([write(tmp_path / f"{kind}.nc", kind, SINGLE) for kind in ("continuum", "atomistic")])
    for dataset in inputs.models.values():
        dataset["mean_gap"][-1] = -1e-20
    shown, captions = drawn(monkeypatch, inputs)
    (axes,) = shown["mean_gap"].axes
    assert axes.get_ylabel() == r"$\ln\,(p/E^*)$"
    assert marks_zero(axes) == (axes.get_xlim()[0] < 0)
    assert captions["mean_gap"].startswith("Natural logarithm")
    assert "Where ū" not in captions["mean_gap"], "a gap of zero to rounding is not below it"


@pytest.mark.parametrize(
    ("text", "name", "noise"),
    [(SINGLE.replace('"0.1 GPa", ', '"0 GPa", '), "applied_pressure", 1e-12), (GAP_STUDY, "applied_gap", 90.0)],
)
def test_rounding_has_no_sign(tmp_path, text, name, noise):
    """A pressure of nothing but rounding, or below the residual stress (1e-9 E*), is on no logarithmic axis."""
    paths = [write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "atomistic")]
    inputs = read_inputs(paths)
    control = inputs.control
    for dataset in inputs.models.values():
        dataset["mean_pressure"][..., 0] = noise
    curves = path_curves(inputs.models, control)
    assert all(curve.x[0] == 0 for curve in curves.areas)
    assert all(np.isnan(curve.y[0]) for curve in curves.gaps)
    axes = figures.contact_area_figure(curves).axes[1]
    assert axes.get_xlim()[0] > 1e-3
    for dataset in inputs.models.values():
        dataset["mean_pressure"][..., 0] = 1e7
    if control == "gap":
        assert path_curves(inputs.models, control).areas[0].x[0] > 0, "ten times the residual counts"


def curve(x, y, model="persson", **options):
    return Curve(model, "", 0, np.array(x, float), np.array(y, float), simulated=model != "persson", **options)


def test_logarithmic_axes_end_where_the_simulations_do():
    curves = [curve([-2, 0, 1], [0, 1, 2], "continuum"), curve([-9, -1, 3], [-9, 0.5, 4])]
    limits = window(curves, ended=0)
    # The theory's state at −9 is out of sight; four per cent are left on either side.
    np.testing.assert_allclose(limits, [[-2.2, 3.2], [-0.16, 4.16]], rtol=1e-12)
    np.testing.assert_allclose(window(curves, ended=1)[1], [-0.16, 4.16], rtol=1e-12)
    assert window(curves, ended=None)[0][0] < -9
    assert window(curves[1:], ended=0)[0][0] < -9, "without simulations all is shown"
    both = [*curves, curve([-5, 0], [0, 1], "atomistic")]
    assert window(both, ended=0)[0][0] < -5, "the one that reaches farther"


def test_no_contact_is_on_no_logarithmic_axis():
    found = of_compression(curve([1, 2, -1, 3], [0, 0.5, 0.5, 0.6]))
    np.testing.assert_array_equal(found.x, [np.nan, 2, np.nan, 3])
    exponents = logarithmic(found)
    np.testing.assert_allclose([exponents.x[1], exponents.y[1]], np.log10([2, 0.5]), rtol=1e-12)
    assert np.isnan(exponents.y[[0, 2]]).all()
    assert not areas([curve([1, -1], [0, 0.5])]).in_compression


def test_bars_are_the_errors_along_their_axes():
    shown = curve([1, 2], [0.1, 0.2], "continuum", x_error=np.array([0.5, np.nan]), y_error=np.array([0.01, 0.02]))
    axes = figures.contact_area_figure(areas([shown])).axes[0]
    bars = [lines.get_segments() for lines in axes.collections if isinstance(lines, LineCollection)][1:]
    across, along = (np.array(segments) for segments in bars)
    np.testing.assert_allclose(np.ptp(across[:, :, 0], axis=1), [1.0, 0.0], rtol=1e-12)
    np.testing.assert_allclose(np.ptp(along[:, :, 1], axis=1), [0.02, 0.04], rtol=1e-12)


def test_lines_follow_the_path_once():
    fit = np.array([True, True, True, True, False, True, True])
    back = np.array([False, False, True, True, False, False, False])
    found = curve([0, 1, 0, np.nan, 5, 2, 3], [0, 1, 0.001, 9, 9, 2, 3], fit=fit, unloading=back)
    segments, unloading, joined = path_segments(found)
    # 1 → 0 retraces 0 → 1 only where its ends are the same: zero and a thousandth are not.
    np.testing.assert_array_equal(segments[:, :, 0], [[0, 1], [1, 0], [2, 3]])
    np.testing.assert_array_equal(unloading, [False, True, False])
    np.testing.assert_array_equal(joined, [True, True, True, False, False, True, True])
    again = curve([1, 2, 1, 2], [1, 2, 1.001, 2.0], unloading=np.array([False, False, True, True]))
    segments, unloading, joined = path_segments(again)
    assert len(segments) == 1
    assert not unloading.any()
    assert joined.all()


def test_a_lone_state_of_a_theory_is_a_dot():
    fit = np.array([True, False, True, True])
    figure = figures.contact_area_figure(areas([curve([1, 2, 3, 4], [0.1, 0.2, 0.3, 0.4], fit=fit)]))
    dots = [line.get_xydata() for line in figure.axes[0].lines if line.get_marker() == "."]
    np.testing.assert_array_equal(np.concatenate(dots), [[1, 0.1]])
    (line,) = [found for found in figure.axes[0].collections if isinstance(found, LineCollection)]
    np.testing.assert_array_equal(line.get_segments(), [[[3, 0.3], [4, 0.4]]])


def test_markers_are_the_states(tmp_path):
    """x is the pressure and y the area; hollow markers on the way back."""
    text = SINGLE.replace("[output]", "unload = true\n[output]")
    models = read_inputs([write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "atomistic")]).models
    axes = figures.contact_area_figure(path_curves(models, "pressure")).axes[0]
    found = {}
    for line in axes.lines:
        if line.get_marker() == "o":
            found[line.get_markerfacecolor()] = line.get_xydata()
    area = models["continuum"]["relative_contact_area"].values
    np.testing.assert_allclose(found.pop("white"), np.stack([[0.7799, 0.1], area[3:]], axis=1), rtol=1e-12)
    (filled,) = found.values()
    np.testing.assert_allclose(filled, np.stack([[0.1, 0.7799, 5.8725], area[:3]], axis=1), rtol=1e-12)


@pytest.fixture
def wide(tmp_path):
    """Inputs of a cell that is four times as wide as high, on points that are farther apart along x."""
    text = SINGLE.replace('"416 angstrom"', '["208 angstrom", "832 angstrom"]').replace("[24, 24]", "[16, 40]")
    return read_inputs([write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "atomistic")])


def test_gap_maps_lie_as_the_surface_does(wide):
    maps = read_gaps(wide, *at(panel_points(wide.models, "pressure")))
    assert extent(maps["continuum"]) == pytest.approx((208e-10, 832e-10), rel=1e-12)
    with xr.open_dataset(wide.paths["continuum"]) as dataset:
        stored = dataset["gap"].isel(step=1).values
    np.testing.assert_array_equal(maps["continuum"]["gap"], stored)
    figure = gap_map_figure(maps)
    panels = [axes for axes in figure.axes if axes.images]
    assert [axes.get_title() for axes in panels] == ["atoms", "continuum"]
    for axes in panels:
        (image,) = axes.images
        assert image.get_extent() == pytest.approx([0, 832, 0, 208])
        assert image.origin == "lower"
        np.testing.assert_allclose(image.get_array().filled(0.0), np.where(stored < 3.68e-10, 0.0, stored / 1e-10))
        assert (axes.get_xlim(), axes.get_ylim()) == (pytest.approx((0, 832)), pytest.approx((0, 208)))
    assert panels[-1].get_xlabel().startswith("$x$")
    assert panels[0].get_ylabel().startswith("$y$")


def test_a_smaller_cell_of_a_sweep_is_shown_without_its_padding(tmp_path):
    text = SINGLE.replace("lattice_constant", "# ").replace(
        'well_depth = "18.6 meV"', 'work_of_adhesion = "0.69 J/m^2"'
    )
    text += '[sweep]\n"surface.size" = ["520 angstrom", "416 angstrom"]\n'
    paths = [write(tmp_path / f"{kind}.nc", kind, text) for kind in ("continuum", "theory")]
    padded = xr.load_dataset(paths[0], decode_timedelta=False).pad(y_index=(0, 4), x_index=(0, 4))
    for name in padded:
        padded[name].encoding = {}
    padded.to_netcdf(paths[0])
    inputs = read_inputs(paths)
    shown = panel_points(inputs.models, "pressure")
    assert shown.case.label == "size = 416 Å"
    state = read_gaps(inputs, *at(shown))["continuum"]
    assert extent(state) == pytest.approx((416e-10, 416e-10), rel=1e-12)
    assert state["gap"].shape == (24, 24)
    assert np.isfinite(state["gap"]).all()


def test_gap_maps_are_not_clipped(wide):
    maps = read_gaps(wide, *at(panel_points(wide.models, "pressure")))
    maps["atomistic"]["gap"] *= 1.5
    figure = gap_map_figure(maps)
    images = [axes.images[0] for axes in figure.axes if axes.images]
    image = images[-1]
    largest = max(float(state["gap"].max()) for state in maps.values())
    assert image.norm.vmax == pytest.approx(largest / 1e-10, rel=1e-12)
    assert image.norm.vmin == pytest.approx(3.68, rel=1e-12)
    assert images[0].get_clim() == image.get_clim(), "one bar for both"
    assert image.colorbar.extend == "min", "contact"
    assert "contact black" in " ".join(words_of(figure))
    figure = gap_map_figure({"continuum": cell(np.full((4, 4), 9e-10))})
    image = next(axes for axes in figure.axes if axes.images).images[0]
    assert image.colorbar.extend == "neither"
    assert "contact black" not in " ".join(words_of(figure))


def test_full_contact_is_a_black_map():
    figure = gap_map_figure({"continuum": cell(np.full((4, 4), 3e-10))})
    image = next(axes for axes in figure.axes if axes.images).images[0]
    assert image.norm.vmin < image.norm.vmax


def test_units_of_the_axes(wide):
    point = sweep_points(wide.models)[0]
    unit = scales(wide.models, point)
    assert unit.rms_height == pytest.approx(1e-9, rel=1e-9)
    # A figure without a single curve is drawn, too: nothing may have converged.
    figure = figures.gap_distribution_figure([], [], unit.height_symbol)
    assert figure.axes[0].get_xlabel() == r"gap $u/h_\mathrm{rms}$"
    assert figures.gap_distribution_figure([], [], "nm").axes[0].get_xlabel() == r"gap $u/\mathrm{nm}$"
