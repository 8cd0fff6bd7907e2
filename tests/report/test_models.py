"""One entry is all that a model needs to be in figures, tables, findings and report."""

import dataclasses
import html

import numpy as np
import pytest
import xarray as xr

from contact_study.report import models
from contact_study.report.align.deviations import pairs_of
from contact_study.report.read.datasets import read_inputs
from contact_study.report.tables import all_numbers
from tests.report.panels import area_curves, figure_of, reported
from tests.report.synthetic import area

MADE_UP = dataclasses.replace(
    models.entry_of("gap_flow"),
    name="made_up",
    label="made-up theory",
    words="the made-up theory",
    short="made up",
    colour="#123456",
    line="-.",
    about="It is of no use.",
    start="The made-up theory starts nowhere.",
)


@pytest.fixture
def paths(files, tmp_path):
    """Datasets of all models, with a theory more: twice Persson's area."""
    with xr.open_datatree(files[2], decode_timedelta=False) as tree:
        root = tree.to_dataset().load()
    another = root.sel(theory=["persson"]).assign_coords(theory=["made_up"])
    another["relative_contact_area"] = 2 * another["relative_contact_area"]
    shared = [name for name in root.data_vars if "theory" in root[name].dims]
    both = xr.concat([root[shared], another[shared]], "theory", join="outer")
    both.assign(root.drop_vars(shared).data_vars).assign_attrs(root.attrs).to_netcdf(tmp_path / "more.nc")
    return [*files[:2], tmp_path / "more.nc"]


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_a_theory_of_another_spectrum_is_a_model_of_its_own(paths, tmp_path):
    with xr.open_dataset(paths[2], decode_timedelta=False) as root:
        names = [str(label).replace("made_up", "persson@surface") for label in root.theory.values]
        root.assign_coords(theory=names).to_netcdf(tmp_path / "two_spectra.nc")
    inputs = read_inputs([*paths[:2], tmp_path / "two_spectra.nc"])
    assert list(inputs.models) == ["atomistic", "continuum", "persson", "persson@surface", "gap_flow"]
    assert not any("not shown" in note for note in inputs.notes)
    # Beside the simulations, not against itself.
    against = [reference for model, reference in pairs_of(inputs.models) if model == "persson@surface"]
    assert against == ["atomistic", "continuum"]
    entry = models.entry_of("persson@surface:coarse")
    assert (entry.label, entry.file) == ("Persson's theory, own spectrum (coarse)", "theory:coarse")
    assert models.entry_of("edge_flow@analytic").short == "edge\u00a0flow, target"
    assert not models.known("persson@file")
    assert reported(tmp_path, *paths[:2], tmp_path / "two_spectra.nc")[0] == 0
    page = html.unescape((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "Persson's theory, own spectrum" in page, "in the tables"
    assert models.entry_of("persson@surface").words not in page, "in no finding, in no caption"
    shown = inputs.with_first_spectra
    assert set(shown.models) == set(inputs.models) - {"persson@surface"}
    assert shown.branches.keys() == inputs.branches.keys()


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_an_entry_is_all_it_takes(paths, tmp_path, monkeypatch):
    unknown = read_inputs(paths)
    assert "made_up" not in unknown.models
    assert f"{paths[2]}: holds the theory made_up, which is not shown" in unknown.notes
    monkeypatch.setattr(models, "MODELS", (*models.MODELS, MADE_UP))
    inputs = read_inputs(paths)
    assert list(inputs.models)[-1] == "made_up"
    curves = area_curves(inputs.models)
    (curve,) = [curve for curve in curves if curve.model == "made_up" and curve.colour == 0]
    expected = 2 * area(1, np.array([0.1e9, 0.7799e9, 5.8725e9]), model="persson")
    np.testing.assert_allclose(curve.y[:3], expected)
    (legend,) = figure_of(curves).legends[-1:]
    assert "made-up theory" in [text.get_text() for text in legend.get_texts()]
    assert "-." in [handle.get_linestyle() for handle in legend.legend_handles if hasattr(handle, "get_linestyle")]
    assert "made_up" in {cell.value for row in all_numbers(inputs, None).rows for cell in row}
    status, text = reported(tmp_path, *paths)
    assert status == 0
    about = "Made-up theory. It is of no use.", "The made-up theory starts nowhere.", "the made-up theory (11 % and"
    assert [words for words in about if words not in text] == []
    with xr.open_dataset(tmp_path / "out.nc", group="deviations", decode_timedelta=False) as deviations:
        assert {"made_up - atomistic", "made_up - continuum"} <= set(deviations.pair.values)
