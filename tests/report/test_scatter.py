"""The scatter between surfaces behind the models of one: --scatter."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import PolyCollection

from contact_study.errors import InputError
from contact_study.plots.paths import Curve
from contact_study.report.align.curves import path_curves, scatter_strips
from contact_study.report.command import main
from contact_study.report.figures import panels as figures
from contact_study.report.figures.style import SWEEP_COLOURS
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.scatter import read_scatter
from tests.report.panels import areas as areas_alone
from tests.report.synthetic import STUDY, area, gap, write, write_all

SEEDS = np.array([1, 2, 4])
SEEDED = STUDY.replace("[sweep]\n", f'[sweep]\n"surface.seed" = {SEEDS.tolist()}\n')
PRESSURES = {1: [0.1e9, 0.7799e9, 5.8725e9], 8: [0.1e9, -0.4987e9, 0.7799e9, 5.8725e9]}


@pytest.fixture
def files(tmp_path):
    return write_all(tmp_path), write(tmp_path / "seeds.nc", "continuum", SEEDED)


def areas(ratio):
    """Made-up contact areas, a seed a row."""
    return area(ratio, np.array([PRESSURES[ratio]]), SEEDS[:, None])


def test_strips_are_a_standard_deviation_about_the_mean(files):
    inputs = read_inputs(files[0])
    strips = scatter_strips(inputs.models, read_scatter(files[1], inputs), "pressure")
    assert strips.label == "continuum, 3 surfaces"
    for colour, ratio in enumerate(PRESSURES):
        (along,) = (curve for curve in strips.curves.areas if curve.colour == colour)
        steps = slice(len(PRESSURES[ratio]))
        np.testing.assert_allclose(along.y[steps], areas(ratio).mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(along.y_error[steps], areas(ratio).std(axis=0, ddof=1), rtol=1e-9)
        (across,) = (curve for curve in strips.curves.linear_gaps if curve.colour == colour)
        gaps = gap(ratio, np.array([PRESSURES[ratio]]), SEEDS[:, None])
        np.testing.assert_allclose(across.x_error[steps] / across.x[steps], gaps.std(0, ddof=1) / gaps.mean(0), 1e-9)


def test_points_that_are_not_compared_have_no_strip(files, tmp_path):
    one = STUDY.replace("= [1, 8]", "= [8]")
    inputs = read_inputs([write(tmp_path / f"one_{kind}.nc", kind, one) for kind in ("continuum", "atomistic")])
    strips = scatter_strips(inputs.models, read_scatter(files[1], inputs), "pressure")
    (only,) = strips.curves.areas
    # The first colour of the figure, though the second of the realisations.
    assert only.colour == 0
    np.testing.assert_allclose(only.y[0], areas(8)[:, 0].mean(), rtol=1e-12)


def test_they_are_drawn_behind_in_their_colours(files):
    inputs = read_inputs(files[0])
    strips = scatter_strips(inputs.models, read_scatter(files[1], inputs), "pressure")
    curves = path_curves(inputs.models, "pressure")
    drawn = figures.contact_area_figure(curves, "GPa", strips=strips)
    beside = figures.mean_gap_figure(curves, strips=strips)
    for axes in (*drawn.axes, *beside.axes):
        found = [each for each in axes.collections if isinstance(each, PolyCollection)]
        assert len(found) == 2
        assert all(each.get_zorder() < 1 for each in found)
        colours = [tuple(np.round(each.get_facecolor()[0][:3], 3)) for each in found]
        expected = [tuple(np.round([int(code[i : i + 2], 16) / 255 for i in (1, 3, 5)], 3)) for code in SWEEP_COLOURS]
        assert colours == expected[:2]
    corners = np.concatenate([path.vertices for path in drawn.axes[0].collections[0].get_paths()])
    low, high = areas(1).mean(0) - areas(1).std(0, ddof=1), areas(1).mean(0) + areas(1).std(0, ddof=1)
    assert corners[:, 1].min() == pytest.approx(low.min(), rel=1e-9)
    assert corners[:, 1].max() == pytest.approx(high.max(), rel=1e-9)
    for figure in (drawn, beside):
        assert "continuum, 3 surfaces" in [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.parametrize(("pressures", "plain"), [([0.2, 0.5, 1.0, 2.0], True), ([0.01, 0.1, 1.0, 10.0], False)])
def test_pressures_of_a_decade_are_plain_numbers(pressures, plain):
    x = np.array(pressures)
    curve = Curve("continuum", "", 0, x, x / 20)
    axes = figures.contact_area_figure(areas_alone([curve])).axes[1]
    axes.figure.draw_without_rendering()
    low, high = axes.get_xlim()
    ticks = zip(axes.get_xticks(), axes.xaxis.get_majorticklabels(), strict=True)
    labels = [text.get_text() for at, text in ticks if low <= at <= high]
    assert (labels == ["0.2", "0.5", "1", "2"]) == plain
    assert not any(text.get_text() for text in axes.xaxis.get_minorticklabels())


@pytest.mark.usefixtures("unrendered")
def test_command(files, tmp_path, capsys):
    outputs = ["-o", tmp_path / "comparison.nc", "--figures", tmp_path / "figures", "--report", tmp_path / "r.html"]
    assert main([str(word) for word in [*files[0], "--scatter", files[1], *outputs]]) == 0
    with xr.open_datatree(tmp_path / "comparison.nc") as tree:
        found = tree["scatter/continuum"].to_dataset()
        np.testing.assert_allclose(
            found.relative_contact_area.sel(well_depth_ratio=8), areas(8).mean(axis=0), rtol=1e-12
        )
        assert (found.samples.sel(well_depth_ratio=8) == 3).all()
        # The compared surface's own numbers stay what they are.
        np.testing.assert_allclose(
            tree["continuum"].relative_contact_area.sel(well_depth_ratio=8), area(8, np.array(PRESSURES[8])), 1e-12
        )
        assert "ensemble" not in tree.children
    page = (tmp_path / "r.html").read_text()
    assert page.count("mean ± one standard deviation of the continuum over 3 surfaces") == 2
    assert "over 3 surfaces of one spectrum" in page


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        (SEEDED, "theory", "a theory has no single surface"),
        (STUDY, "continuum", "holds one surface"),
        (SEEDED.replace("77.2", "70"), "continuum", "material.youngs_modulus is 7.72e\\+10 in the one and 7e\\+10"),
        (SEEDED.replace("[1, 8]", "[2]"), "continuum", "no point in common"),
    ],
)
def test_what_is_no_scatter_of_these_is_refused(files, tmp_path, text, kind, words):
    with pytest.raises(InputError, match=words):
        read_scatter(write(tmp_path / "other.nc", kind, text), read_inputs(files[0]))


def test_refused_beside_another_average(tmp_path, files):
    heights = STUDY.replace("[sweep]\n", '[sweep]\n"surface.rms_height" = ["9 angstrom", "10 angstrom"]\n')
    inputs = read_inputs([write(tmp_path / "c.nc", "continuum", heights)], "rms_height")
    with pytest.raises(InputError, match="does not go with --average rms_height"):
        read_scatter(files[1], inputs)


def test_differences_are_said_but_not_that_of_the_seeds(files, tmp_path):
    coarser = write(tmp_path / "coarse.nc", "continuum", SEEDED.replace("[24, 24]", "[16, 16]"))
    (note,) = read_scatter(coarser, read_inputs(files[0])).notes
    assert "surface.shape is [24, 24] in the one and [16, 16] in the other" in note
    bare = write(tmp_path / "bare.nc", "continuum", SEEDED.replace("fields = true", "fields = false"))
    for path in (files[1], bare):
        assert read_scatter(path, read_inputs(files[0])).notes == ()


def test_a_file_that_is_not_there(files, tmp_path, capsys):
    arguments = [*map(str, files[0]), "-o", str(tmp_path / "out.nc"), "--scatter", str(tmp_path / "none.nc")]
    assert main(arguments) == 1
    assert "none.nc: does not exist" in capsys.readouterr().err
    assert not (tmp_path / "out.nc").exists()
    seeds = str(files[1])
    assert main([*map(str, files[0]), "-o", seeds, "--scatter", seeds, "--overwrite"]) == 1
    assert "choose another output" in capsys.readouterr().err
