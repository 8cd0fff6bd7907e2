"""A report of one dataset, of whatever kind, and datasets of one model side by side."""

import html
import re

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.plots.paths import Curve
from contact_study.report.align.cases import sweep_points
from contact_study.report.align.deviations import pairs_of
from contact_study.report.align.scales import scales
from contact_study.report.align.states import read_magnification
from contact_study.report.facts.shown_states import panel_points
from contact_study.report.figures.panels import contact_area_figure
from contact_study.report.figures.states import magnification_figure
from contact_study.report.figures.style import look_of
from contact_study.report.read.datasets import read_inputs
from contact_study.start import contact_compare as main
from tests.report.panels import areas, at
from tests.report.synthetic import AREA_FACTOR, STUDY, area, gap, write

FINER = STUDY.replace("shape = [24, 24]", "shape = [48, 48]")
NAMES = {
    "continuum": {"continuum": "the continuum"},
    "atomistic": {"atomistic": "the atoms"},
    "theory": {"persson": "Persson's theory", "gap_flow": "the gap-flow theory"},
}


def reported(folder, *paths):
    """Exit status, text of the report and the dataset's groups."""
    arguments = [*map(str, paths), "-o", str(folder / "out.nc"), "--figures", str(folder / "figures")]
    status = main([*arguments, "--report", str(folder / "report.html")])
    page = (folder / "report.html").read_text(encoding="utf-8")
    text = html.unescape(re.sub(r"<[^>]+>", "", page[page.index("<header>") :])).replace("\u00a0", " ")
    with xr.open_datatree(folder / "out.nc", decode_timedelta=False) as tree:
        return status, text, set(tree.groups)


@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize("kind", list(NAMES))
def test_one_dataset_is_reported_on(tmp_path, kind):
    status, text, groups = reported(tmp_path, write(tmp_path / "one.nc", kind))
    assert status == 0
    assert groups - {"/theory/metastable"} == {"/", f"/{kind}", "/regime"}
    assert "Deviations" not in text
    assert "deviations" not in text
    for model, words in NAMES[kind].items():
        low, high = (f"{AREA_FACTOR[model] * area(*at):.3g}" for at in ((1, 0.1e9), (8, 5.8725e9)))
        high = min(high, "1")
        said = f"{words[0].upper()}{words[1:]}: contact area A/A₀ {low} (ε = ε₀, p = 0.1 GPa) to {high} (ε = 8 ε₀, p ="
        assert said in text
    assert ("The simulations start" in text) is False
    drawn = {path.stem.partition("_")[2].partition("_")[2] for path in (tmp_path / "figures").iterdir()}
    every = {"stress_distribution", "gap_distribution", "contact_area", "mean_gap"}
    assert drawn == (every if kind == "theory" else {*every, "gap_map", "interface"})


@pytest.mark.usefixtures("unrendered")
def test_extents_are_of_converged_states_in_contact(tmp_path):
    _, text, _ = reported(tmp_path, write(tmp_path / "one.nc", "continuum", unconverged=[(0, 0)], detached=[(1, 3)]))
    low, high = (f"{area(*at):.3g}" for at in ((1, 0.7799e9), (8, 0.7799e9)))
    assert f"contact area A/A₀ {low} (ε = ε₀, p = 0.7799 GPa) to" in text
    assert float(high) < area(8, 5.8725e9)
    assert "(ε = 8 ε₀, p = 5.8725 GPa)" not in text.partition("What was run")[0]
    largest = gap(1, 0.7799e9) / 1e-9
    assert f"to {largest:.3g} hrms (ε = ε₀, p = 0.7799 GPa)" in text


@pytest.mark.usefixtures("unrendered")
def test_the_theories_alone_are_shown_against_magnification(tmp_path):
    """Every point of the sweep at the common pressure, the map where there is one."""
    path = write(tmp_path / "plain.nc", "theory")
    with xr.open_datatree(path, decode_timedelta=False) as opened:
        tree = opened.load()
    wavevector, zeta = 3e7 * np.array([1.0, 2.0, 4.0]), np.array([2.0, 4.0])
    ratio, step = tree["well_depth_ratio"].values, np.arange(tree.sizes["step"])
    values = ratio[:, None, None] + 100 * step[:, None] + np.arange(3)
    names = ("relative_contact_area_at", "detachment_stress", "effective_work_of_adhesion")
    curves = dict.fromkeys(names, (("well_depth_ratio", "step", "wavevector"), values))
    stress = ("well_depth_ratio", "step", "magnification", "pressure_bin")
    density = np.ones((2, step.size, 2, tree.sizes["pressure_bin"]))
    kept = {"pressure_pdf_at": (stress, density)}
    for file, variables in (("curves", curves), ("map", curves | kept)):
        tree.dataset = tree.to_dataset().assign(variables).assign_coords(wavevector=wavevector, magnification=zeta)
        tree.to_netcdf(tmp_path / f"{file}.nc")
        inputs = read_inputs([tmp_path / f"{file}.nc"])
        shown = panel_points(inputs.models, inputs.control)
        joined, mapped = read_magnification(inputs, *at(shown))
        # p/E* = 0.00832 is the second point of the one path and the third of the other.
        assert list(joined["detachment_stress"].values[:, 0]) == [101, 208]
        figure = magnification_figure(joined, mapped, "at p", "one")
        assert [line.get_ydata()[0] for line in figure.axes[1].lines] == [101, 208]
        assert len(figure.axes) == (5 if file == "map" else 3), "with its bar of colours"
        assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["ε = ε₀", "ε = 8 ε₀"]
        (tmp_path / file).mkdir()
        text = reported(tmp_path / file, tmp_path / f"{file}.nc")[1]
        assert ("(d) distribution of the stress at ε = 8 ε₀" in text) == (file == "map")
    continuum = write(tmp_path / "c.nc", "continuum")
    both = read_inputs([continuum, tmp_path / "map.nc"])
    assert read_magnification(both, *at(panel_points(both.models, both.control))) is None


@pytest.mark.usefixtures("unrendered")
def test_one_theory_of_a_file(tmp_path):
    """What remains of a theory's file cut to Persson's: no gap distribution, nobody who counts gaps."""
    with xr.open_dataset(write(tmp_path / "t.nc", "theory"), decode_timedelta=False) as dataset:
        dataset.sel(theory=["persson"]).to_netcdf(tmp_path / "cut.nc")
        dataset.sel(theory="persson").to_netcdf(tmp_path / "scalar.nc")
    for name in ("cut", "scalar"):
        assert list(read_inputs([tmp_path / f"{name}.nc"]).models) == ["persson"]
    status, text, _ = reported(tmp_path, tmp_path / "cut.nc")
    assert status == 0
    assert "The area is its real contact area at the highest magnification." in text
    assert not list((tmp_path / "figures").glob("*gap_distribution*"))


@pytest.mark.usefixtures("unrendered")
def test_one_dataset_without_fields(tmp_path):
    with xr.open_dataset(write(tmp_path / "c.nc", "continuum"), decode_timedelta=False) as dataset:
        dataset.drop_vars(["gap", "pressure", "height", "y", "x"]).to_netcdf(tmp_path / "bare.nc")
    assert reported(tmp_path, tmp_path / "bare.nc")[0] == 0
    assert len(list((tmp_path / "figures").iterdir())) == 4


@pytest.mark.usefixtures("unrendered")
def test_constants_of_swept_keys_are_the_models_own(tmp_path):
    """Where h_rms is swept, gaps are in units of the roughness that the model has."""
    text = STUDY[: STUDY.index("[sweep]")] + '[sweep]\n"surface.rms_height" = ["8 angstrom", "10 angstrom"]\n'
    text = text.replace('normalisation = "realised"', 'normalisation = "spectrum"')
    models = read_inputs([write(tmp_path / "c.nc", "continuum", text)]).models
    first = sweep_points(models)[0]
    realised = float(models["continuum"]["realised_rms_height"][0])
    assert scales(models, first).rms_height == realised != pytest.approx(8e-10, rel=1e-3)
    assert reported(tmp_path, tmp_path / "c.nc")[0] == 0


@pytest.mark.usefixtures("unrendered")
def test_two_datasets_of_one_model(tmp_path):
    paths = write(tmp_path / "coarse.nc", "continuum"), write(tmp_path / "fine.nc", "continuum", FINER)
    inputs = read_inputs(paths)
    assert list(inputs.models) == ["continuum:coarse", "continuum:fine"]
    assert "surface.shape is [24, 24] in the one and [48, 48] in the other" in "".join(inputs.notes)
    status, text, groups = reported(tmp_path, *paths)
    assert status == 0
    assert {"/continuum:coarse", "/continuum:fine", "/deviations"} <= groups
    assert "The continuum (fine) against the continuum (coarse), 7 states: contact area +0.0 %" in text
    assert "coarse: Continuum: 24 × 24 points" in text
    assert "fine: Continuum: 48 × 48 points" in text


def test_files_of_one_name_are_called_after_their_folders(tmp_path):
    for name, study in (("a", STUDY), ("b", FINER)):
        (tmp_path / name).mkdir()
        write(tmp_path / name / "bem.nc", "continuum", study)
    assert list(read_inputs([tmp_path / "a/bem.nc", tmp_path / "b/bem.nc"]).models) == [
        "continuum:a_bem",
        "continuum:b_bem",
    ]


def test_datasets_of_one_run_are_refused(tmp_path):
    paths = write(tmp_path / "one.nc", "continuum"), write(tmp_path / "copy.nc", "continuum")
    with pytest.raises(InputError, match=r"both of the continuum model .* they cannot be distinguished"):
        read_inputs(paths)
    with pytest.raises(InputError, match="is given twice"):
        read_inputs([paths[0], paths[0]])
    other = write(tmp_path / "other.nc", "continuum", git_commit="1" * 40)
    assert len(read_inputs([paths[0], other]).models) == 2, "another version of the program"


def test_who_is_compared_with_whom():
    names = ["atomistic", "continuum:a", "continuum:b", "persson", "gap_flow"]
    assert pairs_of(names) == [
        *((name, "atomistic") for name in names[1:]),
        *((name, "continuum:a") for name in names[2:]),
        *((name, "continuum:b") for name in names[3:]),
    ]
    assert pairs_of(["persson", "gap_flow"]) == [], "neither theory is a reference"


def test_datasets_of_one_model_look_different():
    names = ["continuum:a", "continuum:b", "atomistic:a", "atomistic:b"]
    looks = {(str(look.line), look.marker) for look in (look_of(name, names) for name in names)}
    assert len(looks) == 4
    assert look_of("continuum:a", names) == look_of("continuum", ["continuum"])
    assert (look_of("continuum:a", names).line, look_of("continuum:a", names).marker) == ("-", "o"), (
        "its own comes first"
    )


def test_colours_tell_the_models_where_nothing_is_swept():
    def colours(label):
        curves = [Curve(name, label, 0, np.ones(2), np.arange(1.0, 3)) for name in ("continuum", "gap_flow")]
        axes = contact_area_figure(areas(curves)).axes[0]
        return {tuple(collection.get_color()[0]) for collection in axes.collections if len(collection.get_color())}

    assert len(colours("")) == 2
    assert len(colours("ε = ε₀")) == 1
