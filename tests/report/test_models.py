"""One entry is all that a model needs to be in figures, tables, findings and report."""

import dataclasses
import html
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import contact_study.report
from contact_study.report import models
from contact_study.report.align.deviations import pairs_of
from contact_study.report.read.datasets import read_inputs
from contact_study.report.tables import all_numbers
from contact_study.start import contact_compare as main
from tests.report.panels import area_curves, figure_of, text_of
from tests.report.synthetic import AREA_FACTOR, area, write_all

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
def paths(tmp_path):
    """Datasets of all models, with a theory more: twice Persson's area."""
    written = write_all(tmp_path)
    with xr.open_datatree(written[2], decode_timedelta=False) as tree:
        root = tree.to_dataset().load()
    another = root.sel(theory=["persson"]).assign_coords(theory=["made_up"])
    another["relative_contact_area"] = 2 * another["relative_contact_area"]
    shared = [name for name in root.data_vars if "theory" in root[name].dims]
    both = xr.concat([root[shared], another[shared]], "theory", join="outer").assign(
        root.drop_vars([*shared]).data_vars
    )
    both.attrs = root.attrs
    both.to_netcdf(tmp_path / "more.nc")
    return [*written[:2], tmp_path / "more.nc"]


def test_a_theory_without_an_entry_is_said_and_left_out(paths):
    inputs = read_inputs(paths)
    assert "made_up" not in inputs.models
    assert f"{paths[2]}: holds the theory made_up, which is not shown" in inputs.notes


@pytest.mark.usefixtures("unrendered")
def test_a_theory_of_another_spectrum_is_a_model_of_its_own(paths, tmp_path):
    with xr.open_datatree(paths[2], decode_timedelta=False) as tree:
        root = tree.to_dataset().load()
    names = {"made_up": "persson@surface"}
    root = root.assign_coords(theory=[names.get(str(label), str(label)) for label in root.theory.values])
    root.to_netcdf(tmp_path / "two_spectra.nc")
    inputs = read_inputs([*paths[:2], tmp_path / "two_spectra.nc"])
    order = list(inputs.models)
    assert order.index("persson@surface") == order.index("persson") + 1
    assert not any("not shown" in note for note in inputs.notes)
    # Beside the simulations, not against itself.
    pairs = pairs_of(inputs.models)
    assert ("persson@surface", "continuum") in pairs
    assert ("persson@surface", "persson") not in pairs
    entry = models.entry_of("persson@surface:coarse")
    assert (entry.label, entry.file) == ("Persson's theory, own spectrum (coarse)", "theory:coarse")
    assert models.entry_of("edge_flow@analytic").short == "edge\u00a0flow, target"
    assert not models.known("persson@file")
    arguments = [*map(str, (*paths[:2], tmp_path / "two_spectra.nc")), "-o", str(tmp_path / "both.nc")]
    assert main([*arguments, "--report", str(tmp_path / "report.html")]) == 0
    page = html.unescape((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "Persson's theory, own spectrum" in page, "in the tables"
    assert models.entry_of("persson@surface").words not in page, "in no finding, in no caption"
    shown = inputs.with_first_spectra
    assert "persson@surface" not in shown.models
    assert set(shown.models) == set(inputs.models) - {"persson@surface"}
    assert shown.branches.keys() == inputs.branches.keys()


@pytest.mark.usefixtures("unrendered")
def test_an_entry_is_all_it_takes(paths, tmp_path, monkeypatch):
    monkeypatch.setattr(models, "MODELS", (*models.MODELS, MADE_UP))
    inputs = read_inputs(paths)
    assert list(inputs.models)[-1] == "made_up"
    curves = area_curves(inputs.models)
    (curve,) = [curve for curve in curves if curve.model == "made_up" and curve.colour == 0]
    np.testing.assert_allclose(curve.y[:3], 2 * AREA_FACTOR["persson"] * area(1, np.array([0.1e9, 0.7799e9, 5.8725e9])))
    (legend,) = figure_of(curves).legends[-1:]
    assert "made-up theory" in [text.get_text() for text in legend.get_texts()]
    assert "-." in [handle.get_linestyle() for handle in legend.legend_handles if hasattr(handle, "get_linestyle")]
    assert "made_up" in {cell.value for row in all_numbers(inputs, None).rows for cell in row}
    report = tmp_path / "report.html"
    assert main([*map(str, paths), "-o", str(tmp_path / "out.nc"), "--report", str(report)]) == 0
    text = text_of(report.read_text(encoding="utf-8"))
    for words in (
        "Made-up theory. It is of no use.",
        "The made-up theory starts nowhere.",
        "the made-up theory (11 % and",
    ):
        assert words in text, words
    with xr.open_dataset(tmp_path / "out.nc", group="deviations", decode_timedelta=False) as deviations:
        assert {"made_up - atomistic", "made_up - continuum"} <= set(deviations.pair.values)


def test_no_other_file_spells_a_model():
    folder = Path(contact_study.report.__file__).parent
    names = [text for entry in models.MODELS for text in (f'"{entry.name}"', entry.label, entry.colour)]
    # Two labels are words of the language.
    spelt = re.compile("|".join(re.escape(name) for name in dict.fromkeys(names) if name not in ("atoms", "continuum")))
    apart = {
        "models.py",
        "report.css.j2",
    }  # settings of each model; colours of the sweep
    for path in [*folder.rglob("*.py"), *folder.rglob("*.j2")]:
        if path.name not in apart:
            assert not spelt.search(path.read_text(encoding="utf-8")), path
