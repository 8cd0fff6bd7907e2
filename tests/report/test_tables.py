"""The numbers of the report's tables, cell by cell, and what is concluded from them."""

import numpy as np
import pytest

from contact_study.report.align.cases import Series, series
from contact_study.report.align.deviations import compute_deviations
from contact_study.report.align.regime import compute_regime
from contact_study.report.read.datasets import read_inputs
from contact_study.report.tables.results import deviation_tables, results_tables, summary_table
from contact_study.report.tables.settings import constants_table, effort_table, regime_table, unconverged_steps
from tests.report import synthetic
from tests.report.synthetic import AREA_FACTOR, GAP_SHIFT, area, gap, write, write_all

SHOWN = {"atomistic": "atoms", "continuum": "continuum", "persson": "Persson", "gap_flow": "gap\u00a0flow"}
MODELS = list(SHOWN)
# A roughness that is no power of ten: a gap in nanometres, or in metres, is told from one in units of h_rms.
STUDY, GAP_STUDY = (
    text.replace('rms_height = "10 angstrom"', 'rms_height = "7 angstrom"')
    for text in (synthetic.STUDY, synthetic.GAP_STUDY)
)
SEEDED = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2, 3]\n')
H_RMS, MODULUS = 7e-10, 77.2e9 / (1 - 0.42**2)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    return read_inputs(write_all(tmp_path_factory.mktemp("tables"), STUDY))


def text(value, decimals, plus=False):
    return f"{value:{'+' if plus else ''}z.{decimals}f}".replace("-", "−")


def test_results_by_hand(inputs):
    table = results_tables(inputs.models, "pressure")[1]
    assert table.title == "ε = 8 ε₀"
    assert table.header == ["p (GPa)", "p/E*", *SHOWN.values(), *SHOWN.values()]
    assert table.groups == [("", 2), ("contact area A/A₀", 4), ("mean gap ū (h_rms)", 4)]
    for row, pressure in zip(table.rows, (0.1e9, -0.4987e9, 0.7799e9, 5.8725e9), strict=True):
        assert row[:2] == [f"{pressure / 1e9:.5g}".replace("-", "−"), f"{pressure / MODULUS:.4g}".replace("-", "−")]
        for column, model in enumerate(MODELS):
            assert row[2 + column] == text(AREA_FACTOR[model] * area(8, pressure), 4)
            found = text((gap(8, pressure) + GAP_SHIFT[model]) / H_RMS, 3)
            assert row[6 + column] == ("–" if model == "persson" and pressure < 0 else found)


def test_deviations_by_hand(inputs):
    deviations = compute_deviations(inputs.models, "pressure")
    table = deviation_tables(inputs.models, deviations, "pressure")[0]
    pairs = [pair.partition(" - ")[::2] for pair in deviations["pair"].values]
    assert table.header == [
        "p (GPa)",
        *(f"{SHOWN[a]} − {SHOWN[b]}" for a, b in pairs),
        *(f"{SHOWN[a]} − {SHOWN[b]}" for a, b in pairs),
    ]
    assert len(table.rows) == 3
    for row in table.rows:
        for column, (model, reference) in enumerate(pairs):
            relative = 100 * (AREA_FACTOR[model] / AREA_FACTOR[reference] - 1)
            assert row[1 + column] == f"{text(relative, 0 if abs(relative) >= 10 else 1, plus=True)} %"
            shift = (GAP_SHIFT[model] - GAP_SHIFT[reference]) / H_RMS
            assert row[1 + len(pairs) + column] == text(shift, 3, plus=True)


def test_prescribed_gaps_in_their_units(tmp_path):
    models = read_inputs(
        [write(tmp_path / f"{kind}.nc", kind, GAP_STUDY) for kind in ("continuum", "atomistic")]
    ).models
    table = results_tables(models, "gap")[0]
    assert table.header[:2] == ["ū (Å)", "ū (h_rms)"]
    assert [row[:2] for row in table.rows] == [["10", "1.429"], ["7", "1"], ["3", "0.4286"], ["2", "0.2857"]]


def test_summary_is_over_shared_states(tmp_path):
    """One pair lacks the state where another is far off: neither counts it."""
    paths = [
        write(tmp_path / "c.nc", "continuum", STUDY, unconverged=[(0, 0)]),
        write(tmp_path / "a.nc", "atomistic", STUDY),
        write(tmp_path / "t.nc", "theory", STUDY),
    ]
    inputs = read_inputs(paths)
    deviations = compute_deviations(inputs.models, "pressure")
    here = {"pair": "persson - atomistic", "well_depth_ratio": 1, "step": 0}
    for name in ("relative_contact_area_relative_deviation", "mean_gap_deviation"):
        deviations[name].loc[here] = -0.87 if "area" in name else 5e-9
    table = summary_table(inputs.models, deviations)
    assert table.header == [
        "",
        *["ε = ε₀, 2 states", "ε = 8 ε₀, 4 states"],
        *["ε = ε₀, 2 states", "ε = 8 ε₀, 3 states"],
    ]
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["continuum − atoms"][:2] == ["11 % (11 %)", "11 % (11 %)"]
    assert rows["Persson − atoms"] == ["44 % (44 %)", "44 % (44 %)", "0.214 (0.214)", "0.214 (0.214)"]


def test_errors_over_seeds_have_digits(tmp_path):
    models = read_inputs([write(tmp_path / f"{kind}.nc", kind, SEEDED) for kind in ("continuum", "atomistic")]).models
    table = results_tables(models, "pressure")[0]
    values = np.array([gap(1, 0.1e9, seed) for seed in (1, 2, 3)]) / H_RMS
    error = values.std(ddof=1) / np.sqrt(3)
    assert 0.001 < error < 0.01
    assert table.rows[0][5] == f"{values.mean():.3f} ± {error:.3f}"
    assert not any(cell.endswith("± 0.000") or cell.endswith("± 0.0000") for row in table.rows for cell in row)


def test_scatter_of_rounding_is_no_error(tmp_path):
    models = read_inputs([write(tmp_path / f"{kind}.nc", kind, SEEDED) for kind in ("continuum", "atomistic")]).models
    part = models["continuum"].isel(well_depth_ratio=0)
    one = part["mean_gap"].isel(seed=0, drop=True)
    spread = part.assign(mean_gap=one * (1 + 1e-15 * part["seed"]))
    assert np.isnan(series(spread, "mean_gap").standard_error).all()
    found: Series = series(part.assign(mean_gap=one * (1 + 1e-6 * part["seed"])), "mean_gap")
    np.testing.assert_allclose(found.standard_error[:3], one[:3] * 1e-6 / np.sqrt(3), rtol=1e-6)


def test_constants_by_hand(inputs):
    table = constants_table(inputs.models)
    assert table.header == ["", "model", "E* (GPa)", "Δγ (J/m²)", "d_eq (Å)", "σ_max (GPa)", "h_rms (Å)", "rms slope"]
    case = inputs.cases[1]
    (row,) = [row for row in table.rows if row[:2] == ["ε = 8 ε₀", "continuum"]]
    slope = inputs.models["continuum"]["rms_slope"].values.max()
    expected = (MODULUS / 1e9, case.work_of_adhesion, 3.28, case.law.peak_tensile_stress / 1e9, 7.0, slope)
    assert row[2:] == [f"{value:.5g}" for value in expected]
    # The gap-flow theory stands in the file of Persson's, whose constants are its own.
    assert [row[1] for row in table.rows] == 2 * ["atoms", "continuum", "Persson's theory"]


def test_regime_by_hand(inputs):
    simulated = {"pull_off_pressure": -0.3e9, "pull_off_pressure_resolution_error": 0.05e9}
    models = {
        **inputs.models,
        "continuum": inputs.models["continuum"].assign(simulated),
        "persson": inputs.models["persson"].assign(pull_off_pressure=-0.3125e9),
    }
    regime = compute_regime(inputs)
    table = regime_table(models, regime)
    assert table.header[2] == "process zone (Å)"
    assert table.header[-2:] == ["pull-off, continuum (GPa)", "pull-off, Persson (GPa)"]
    for row, ratio in zip(table.rows, (1, 8), strict=True):
        at = regime.sel(well_depth_ratio=ratio)
        zone = MODULUS * float(models["continuum"]["work_of_adhesion"].sel(well_depth_ratio=ratio))
        zone /= float(models["continuum"]["peak_tensile_stress"].sel(well_depth_ratio=ratio)) ** 2
        assert row[2] == f"{zone / 1e-10:.1f}"
        assert row[3] == f"{416e-10 / 24 / zone:.2f}"
        assert row[1] == f"{float(at['tabor_parameter']):.2f}"
        assert row[-2:] == ["−0.350 to −0.300", "−0.312"]


def test_effort_by_hand(tmp_path):
    paths = [
        write(tmp_path / "c.nc", "continuum", STUDY, unconverged=[(0, 1), (1, 2)], detached=[(1, 2)]),
        write(tmp_path / "a.nc", "atomistic", STUDY),
    ]
    models = read_inputs(paths).models
    rows = {row[0]: row[1:] for row in effort_table(models).rows}
    assert effort_table(models).header[:5] == ["model", "steps", "not converged", "detached", "largest residual"]
    # Seven steps of seven iterations and half a second each; one did not converge, one has let go.
    assert rows["continuum"] == ["7", "1", "1", "1.0e−09", "49", "4"]
    assert rows["atoms"] == ["7", "0", "0", "1.0e−09", "49", "4"]
    assert unconverged_steps(models) == 1
