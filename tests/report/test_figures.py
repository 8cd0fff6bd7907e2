"""What stands on a figure: nothing printed over anything else, nothing cut, every state where it belongs."""

import itertools

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.legend import Legend

import contact_study
from contact_study.plots.panels import Band, gap_maps, magnification, palette, saved
from contact_study.plots.paths import ERROR, Curve, Look, path_segments
from contact_study.plots.selection import extent, touching
from contact_study.plots.style import COLOURS
from contact_study.report import figures
from contact_study.report.align.states import read_gaps, read_magnification
from contact_study.report.facts.shown_states import panel_points
from contact_study.report.models import FIGURE_TITLES, look_of
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.files import field_at
from tests.report.panels import area_curves, at, figure_of
from tests.report.synthetic import GAP_STUDY, HARD, LOOP, MODULUS, SINGLE, read, write, write_all

SIX = SINGLE + '[sweep]\n"interaction.well_depth_ratio" = [1, 1.5, 2, 4, 6, 8]\n'
TWO_KEYS = SINGLE + '[sweep]\n"surface.hurst_exponent" = [0.5, 0.8]\n"interaction.well_depth_ratio" = [1, 4]\n'


def drawn(monkeypatch, inputs):
    """The figures of a comparison before they are files, in reduced units, with their captions."""
    kept = {}
    monkeypatch.setattr(figures, "saved", lambda figure, kind, name: kept.update({name[:-1]: figure}) or b"")
    captions = figures.draw(inputs).captions
    assert kept.keys() <= FIGURE_TITLES.keys()  # their files are named by the place in it
    return kept, captions


def words_of(figure):
    return [text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_text")) if text.get_text()]


def check_page(name, figure):
    """Legends, headings, labels and titles do not meet and are inside the page."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    artists = [*figure.findobj(Legend), *figure.texts]
    for axes in figure.axes:
        artists += [*axes.texts, axes.title, axes.xaxis.label, axes.yaxis.label]
    named = [artist for artist in artists if isinstance(artist, Legend) or artist.get_text()]
    boxes = [artist.get_window_extent(canvas.get_renderer()) for artist in named]
    for first, second in itertools.combinations(boxes, 2):
        # A pixel of an anti-aliased edge is no overlap.
        assert not first.padded(-1).overlaps(second.padded(-1)), (name, first, second)
    assert all(figure.bbox.padded(1).contains(*corner) for box in boxes for corner in (box.min, box.max)), name


@pytest.mark.validation
@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        (SIX, ("continuum", "atomistic", "theory")),
        (TWO_KEYS, ("continuum", "theory")),
        (GAP_STUDY, ("continuum", "atomistic")),
    ],
)
def test_nothing_is_printed_over_anything_or_cut(monkeypatch, tmp_path, text, kinds):
    for name, figure in drawn(monkeypatch, read(tmp_path, text, kinds))[0].items():
        check_page(name, figure)


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:.*(process zone|of the surface)")
def test_probes_have_a_force_curve(monkeypatch, tmp_path):
    study = {
        "surface": {"kind": "sphere", "radius": 50e-9, "size": 20e-9, "shape": [12, 12]},
        "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.3},
        "elasticity": {"boundary": "free"},
        "interaction": {"law": "exponential", "work_of_adhesion": 0.05, "length": "0.5 nm"},
        "loading": {"control": "approach", "path": ["-2 nm", "0.5 nm", "-0.5 nm"], "machine_stiffness": "1 N/m"},
        "sweep": {"material.youngs_modulus": [1e9, 2e9]},
    }
    found = contact_study.run(study, "continuum", output=tmp_path / "probe.nc")
    shown, captions = drawn(monkeypatch, read_inputs([tmp_path / "probe.nc"]))
    check_page("force", shown["force"])
    lines = [line for line in shown["force"].axes[0].lines if len(line.get_xdata()) == 3][::2]
    for line, force in zip(lines, found.total_force.values, strict=True):
        assert np.nanmax(line.get_ydata()) == pytest.approx(force[1] / 1e-9)
    assert "Force against the displacement of the body" in captions["force"]
    assert "force" not in drawn(monkeypatch, read(tmp_path, LOOP))[0], "a periodic cell under pressure"


@pytest.mark.validation
def test_a_report_draws_the_leakage_that_a_study_asks_for(monkeypatch, tmp_path):
    study = {
        "surface": {"kind": "wavy", "size": "1 um", "shape": [24, 24], "amplitude": "10 nm"},
        "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3},
        "interaction": {"law": "hard_wall"},
        "loading": {"path": ["1 MPa", "5 MPa", "60 MPa"]},
        "output": {"leakage": True},
    }
    found = contact_study.run(study, "continuum", output=tmp_path / "leak.nc")
    shown, captions = drawn(monkeypatch, read_inputs([tmp_path / "leak.nc"]))
    check_page("leakage", shown["leakage"])
    open_ = found.hydraulic_gap_x.values > 0
    assert list(open_) == [True, True, False]
    line = shown["leakage"].axes[0].lines[0]
    np.testing.assert_allclose(line.get_ydata(), found.hydraulic_gap_x.values[open_] / 1e-9)
    assert "along x and along y" in captions["leakage"]
    assert "leakage" not in drawn(monkeypatch, read(tmp_path, LOOP))[0]


def cell(gap, size=(1e-8, 1e-8)):
    """A state on a cell, in contact below 3.68 Å."""
    y, x = (np.arange(count) * period / count for count, period in zip(gap.shape, size, strict=True))
    return xr.Dataset({"gap": (("y", "x"), gap), "contact_distance": 3.68e-10}, {"y": y, "x": x})


@pytest.mark.parametrize("size", [(1e-8, 4e-8), (4e-8, 1e-8), (1e-8, 1e-7)])
@pytest.mark.parametrize("models", [("atoms", "continuum"), ("continuum",)])
def test_maps_of_any_cell_fit_their_page(size, models):
    figure = gap_maps(dict.fromkeys(models, cell(np.linspace(3e-10, 1e-9, 64).reshape(8, 8), size)), "ε = 8 ε₀")
    check_page(size, figure)
    for axes in figure.axes[: len(models)]:
        box = axes.get_window_extent()
        # The cell's own proportions, to a pixel of a map at least a quarter of an inch wide.
        assert box.height / box.width == pytest.approx(size[0] / size[1], rel=0.04)
        assert box.width > 0.25 * figure.dpi


@pytest.mark.validation
def test_panels_name_their_state_and_captions_the_meaning(monkeypatch, tmp_path):
    inputs = read_inputs(write_all(tmp_path))
    for model, dataset in inputs.models.items():
        if model != "gap_flow":
            dataset["mean_gap"] = dataset["mean_gap"] - 0.3e-9
    shown, captions = drawn(monkeypatch, inputs)
    for name in ("stress_distribution", "gap_distribution"):
        left, right = ([text.get_text() for text in axes.texts] for axes in shown[name].axes)
        assert left == ["(a)", "p/E* = 0.00832"]
        assert right == ["(b)", "ε = 8 ε₀"]
    assert "ε = 8 ε₀, p = 779.9 MPa" in words_of(shown["gap_map"])
    assert "(b) ε = 8 ε₀, p = −498.7 MPa, p = 779.9 MPa, p = 5.8725 GPa." in captions["stress_distribution"]
    assert "Persson's theory counts the stress in contact only" in captions["stress_distribution"]
    assert "Where ū < 0 (the atoms and the continuum), the surfaces are pressed closer" in captions["mean_gap"]
    assert "Where ū < 0 (Persson's theory), its energy U(p) somewhere falls" in captions["mean_gap"]
    for name in ("contact_area", "mean_gap"):
        assert "gap-flow metastable band" in words_of(shown[name])
        assert "branches of the gap-flow theory" in captions[name]
        assert "The gap-flow theory is this project's own, unpublished" in captions[name]
        assert "unloading" not in captions[name].partition("branches")[2]
    logarithmic, linear = shown["mean_gap"].axes
    assert logarithmic.get_yscale() == "log"
    low, high = linear.get_ylim()
    assert low < -0.4987e9 / MODULUS < 5.8725e9 / MODULUS < high, "tension, too"
    assert linear.get_xlabel() == r"mean gap $\bar{u}/h_\mathrm{rms}$"
    assert [list(line.get_xdata()) for line in linear.lines].count([0, 0]) == 1, "a line at a gap of zero"


@pytest.mark.validation
def test_the_legend_says_how_laws_count_contact(monkeypatch, tmp_path):
    text = SINGLE.replace('well_depth = "18.6 meV"', 'work_of_adhesion = "0.69 J/m^2"')
    text += '[sweep]\n"interaction.law" = ["lennard_jones_10_4", "hard_wall"]\n'
    shown, _ = drawn(monkeypatch, read(tmp_path, text, ("continuum",)))
    words = " ".join(words_of(shown["contact_area"]))
    assert "contact by 10-4: a gap below the contact distance; hard wall: a positive pressure" in words


def test_a_legend_is_read_along_its_rows():
    points = [Curve("continuum", f"H = 0.{number:02d}", number, np.ones(1), np.ones(1)) for number in range(31)]
    figure = figure_of(points)
    figure.canvas.draw()
    places = [(text.get_window_extent(), text.get_text()) for text in figure.legends[0].get_texts()]
    words = [text for _, text in sorted(places, key=lambda place: (-round(place[0].y0), place[0].x0))]
    assert words == ["H = 0.00", *(f"0.{number:02d}" for number in range(1, 31))], "what all begin with stands once"
    assert len({round(place.y0) for place, _ in places}) > 1, "in several rows"
    assert len({tuple(np.atleast_1d(colour)) for colour in palette(COLOURS, points[:12])}) == 12
    assert palette(COLOURS, points[:6]) == list(COLOURS)


def curve(x, y, model="persson", label="", **options):
    return Curve(model, label, 0, np.array(x, float), np.array(y, float), simulated=model != "persson", **options)


def test_logarithmic_axes_end_where_the_simulations_do():
    curves = [curve([-1, 0.01, 1], [0.1, 0.1, 0.4], "continuum"), curve([1e-9, 0.1, 10], [1e-9, 0.2, 0.5])]
    axes = figure_of(curves, "loglog").axes[0]
    # The theory's state at 1e-9 is out of sight; four per cent are left on either side.
    assert np.log10(axes.get_xlim()) == pytest.approx([-2.12, 1.12])
    assert axes.get_ylim()[0] > 0.05
    upright = figure_of(curves, "log", upright=True).axes[0]
    assert upright.get_xscale() == "linear"
    assert upright.get_ylim()[0] > 0.05, "along the pressure"
    assert upright.get_xlim()[0] < -1
    assert figure_of(curves[1:], "loglog").axes[0].get_xlim()[0] < 1e-9, "without simulations all is shown"
    assert figure_of(curves).axes[0].get_ylim()[0] == 0
    for pressures, plain in (([0.2, 0.5, 1.0, 2.0], True), ([0.01, 0.1, 1.0, 10.0], False)):
        axes = figure_of([curve(pressures, np.array(pressures) / 20)], "loglog").axes[0]
        axes.figure.draw_without_rendering()
        low, high = axes.get_xlim()
        ticks = zip(axes.get_xticks(), axes.xaxis.get_majorticklabels(), strict=True)
        shown = [text.get_text() for place, text in ticks if low <= place <= high]
        assert (shown == ["0.2", "0.5", "1", "2"]) == plain, "pressures of a decade are plain numbers"


def test_bars_bands_and_strips():
    errors = {"x_error": np.array([0.5, np.nan]), "y_error": np.array([0.01, 0.02])}
    axes = figure_of([curve([1, 2], [0.1, 0.2], "continuum", **errors)]).axes[0]
    bars = [lines.get_segments() for lines in axes.collections if isinstance(lines, LineCollection)][1:]
    across, along = (np.array(segments) for segments in bars)
    np.testing.assert_allclose(np.ptp(across[:, :, 0], axis=1), [1.0, 0.0], rtol=1e-12)
    np.testing.assert_allclose(np.ptp(along[:, :, 1], axis=1), [0.02, 0.04], rtol=1e-12)
    own = [curve([1, 2], [0.1, 0.2], "continuum", "a", y_error=np.array([0.01, 0.02]))]
    figure = figure_of(own, strips=own, bands=[Band(Look(label="flow theory"), 0, np.ones(2), np.ones(2), np.ones(2))])
    faces = [each for each in figure.axes[0].collections if isinstance(each, PolyCollection)]
    corners = np.concatenate([path.vertices for each in faces[1:] for path in each.get_paths()])
    assert corners[:, 1].min() == pytest.approx(0.09)
    assert corners[:, 1].max() == pytest.approx(0.22)
    assert "flow metastable band" in words_of(figure)
    density = figure_of(own, "log", densities=True).axes[0]
    assert [found.get_alpha() for found in density.collections] == [ERROR]


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
    assert len(path_segments(again)[0]) == 1
    lone = figure_of([curve([1, 2, 3, 4], [0.1, 0.2, 0.3, 0.4], fit=fit[[0, 4, 2, 3]], look=Look(marker=""))])
    dots = [line.get_xydata() for line in lone.axes[0].lines if line.get_marker() == "."]
    np.testing.assert_array_equal(np.concatenate(dots), [[1, 0.1]])


def test_unloading_looks_different(tmp_path):
    """x is the pressure and y the area; hollow triangles on the way back."""
    models = read(tmp_path, LOOP).models
    axes = figure_of(area_curves(models)).axes[0]
    found = {line.get_marker(): line for line in axes.lines if line.get_color() == "#0072B2"}
    area = models["continuum"]["relative_contact_area"].values
    np.testing.assert_allclose(found["v"].get_xydata(), np.stack([[0.7799, 0.1], area[3:]], axis=1), rtol=1e-12)
    np.testing.assert_allclose(found["o"].get_xydata(), np.stack([[0.1, 0.7799, 5.8725], area[:3]], axis=1))
    assert found["v"].get_markerfacecolor() == "white"
    assert "unloading" in words_of(axes.figure)


def test_datasets_of_one_model_and_models_without_a_sweep_look_different():
    names = ["continuum:a", "continuum:b", "atomistic:a", "atomistic:b"]
    looks = [(str(look.line), look.marker) for look in (look_of(name, names) for name in names)]
    assert len({*looks}) == 4
    assert looks[0] == ("-", "o"), "its own comes first"
    for label, count in (("", 2), ("ε = ε₀", 1)):
        curves = [curve([1, 1], [1, 2], name, label, look=look_of(name, [name])) for name in ("continuum", "gap_flow")]
        collections = figure_of(curves).axes[0].collections
        assert len({tuple(own.get_color()[0]) for own in collections if len(own.get_color())}) == count


def test_gap_maps_lie_as_the_surface_does(tmp_path):
    """A cell that is four times as wide as high, on points that are farther apart along x."""
    text = SINGLE.replace('"416 angstrom"', '["208 angstrom", "832 angstrom"]').replace("[24, 24]", "[16, 40]")
    wide = read(tmp_path, text)
    maps = read_gaps(wide, *at(panel_points(wide.models)))
    assert extent(maps["continuum"]) == pytest.approx((208e-10, 832e-10), rel=1e-12)
    with xr.open_dataset(wide.paths["continuum"]) as dataset:
        stored = dataset["gap"].isel(step=1).values / 1e-9
    maps["atomistic"]["gap"] *= 1.5
    panels = [axes.images[0] for axes in gap_maps(maps).axes if axes.images]
    for image, gap in zip(panels, (1.5 * stored, stored), strict=True):
        assert image.get_extent() == pytest.approx([0, 83.2, 0, 20.8])
        assert image.origin == "lower"
        np.testing.assert_allclose(image.get_array().filled(0.0), np.where(gap < 0.368, 0.0, gap))
        assert image.get_clim() == pytest.approx((0.368, 1.5 * stored.max())), "one bar for both"
    assert panels[1].colorbar.extend == "min", "contact"
    for gap, words in ((9e-10, "neither"), (3e-10, "min")):
        image = gap_maps({"continuum": cell(np.full((4, 4), gap))}).axes[0].images[0]
        assert image.norm.vmin < image.norm.vmax
        assert image.colorbar.extend == words


def test_states_of_padded_cells_and_hard_walls(tmp_path):
    text = SINGLE.replace("lattice_constant", "# ").replace('well_depth = "18.6 meV"', "work_of_adhesion = 0.69")
    text += '[sweep]\n"surface.size" = ["520 angstrom", "416 angstrom"]\n'
    path = write(tmp_path / "continuum.nc", "continuum", text)
    padded = xr.load_dataset(path, decode_timedelta=False).pad(y_index=(0, 4), x_index=(0, 4))
    padded.drop_encoding().to_netcdf(path)
    inputs = read_inputs([path])
    shown = panel_points(inputs.models)
    assert shown.case.label == "size = 41.6 nm"
    state = read_gaps(inputs, *at(shown))["continuum"]
    assert extent(state) == pytest.approx((416e-10, 416e-10), rel=1e-12)
    assert state["gap"].shape == (24, 24)
    inputs = read(tmp_path, HARD)
    state = read_gaps(inputs, *at(panel_points(inputs.models)))["continuum"]
    pressed = field_at(inputs.paths["continuum"], "pressure", {}, 0) > 0
    assert pressed.any()
    np.testing.assert_array_equal(touching(state), pressed)


def test_the_theories_alone_are_shown_against_magnification(tmp_path):
    """Every point of the sweep at the common pressure, the map where there is one."""
    with xr.open_datatree(write(tmp_path / "plain.nc", "theory"), decode_timedelta=False) as opened:
        tree = opened.load()
    values = tree["well_depth_ratio"].values[:, None, None] + 100 * np.arange(4)[:, None] + np.arange(3)
    names = ("relative_contact_area_at", "detachment_stress", "effective_work_of_adhesion")
    added = dict.fromkeys(names, (("well_depth_ratio", "step", "wavevector"), values))
    density = np.ones((2, 4, 2, tree.sizes["pressure_bin"]))
    added["pressure_pdf_at"] = ("well_depth_ratio", "step", "magnification", "pressure_bin"), density
    along = {"wavevector": [3e7, 6e7, 1.2e8], "magnification": [2.0, 4.0]}
    tree.dataset = tree.to_dataset().assign(added).assign_coords(along)
    tree.to_netcdf(tmp_path / "map.nc")
    inputs = read_inputs([tmp_path / "map.nc"])
    joined, mapped = read_magnification(inputs, *at(panel_points(inputs.models)))
    # p/E* = 0.00832 is the second point of the one path and the third of the other.
    assert list(joined["detachment_stress"].values[:, 0]) == [101, 208]
    figure = magnification(joined, mapped, "at p", "one")
    assert [line.get_ydata()[0] for line in figure.axes[1].lines] == [101, 208]
    assert len(figure.axes) == 5, "with the map and its bar of colours"
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["ε = ε₀", "ε = 8 ε₀"]
    both = read_inputs([write(tmp_path / "c.nc", "continuum"), tmp_path / "map.nc"])
    assert read_magnification(both, *at(panel_points(both.models))) is None


def test_a_page_has_figures_in_its_own_ink():
    figure = figure_of([curve([1, 2], [0.1, 0.2])])
    svg = saved(figure, "page", "area").decode()
    assert svg.startswith("<svg")
    assert "#000000" not in svg
    assert "currentColor" in svg
    assert 'id="area-' in svg
    assert saved(figure, "page", "area").decode() == svg
