"""States of the theories as datasets of the schema, beside those of a study; P(σ) at any magnification."""

from dataclasses import replace

import numpy as np
import pytest

from contact_study.results.schema import variable_of
from theory.edge_flow.flow import edge_flow
from theory.gap_flow.flow import gap_flow
from theory.non_adhesive import closed_forms
from theory.persson.separation import separation_curve

# Quantities every theory has.
SHARED = ("mean_pressure", "mean_gap", "relative_contact_area", "elastic_energy", "interaction_energy", "pressure_pdf")


@pytest.fixture(scope="module")
def states(paper):
    arguments = paper.spectrum, paper.contact_modulus, paper.law(1)
    return {
        "persson": paper.theory(0.6924).at_pressure(1e9),
        "gap_flow": gap_flow(*arguments, "loading", gaps=200, scales=200).at_pressure(1e9),
        "edge_flow": edge_flow(*arguments, highest_pressure=2e9, gaps=100, scales=30).at_pressure(1e9),
    }


@pytest.mark.parametrize("theory", ["persson", "gap_flow", "edge_flow"])
def test_every_theory_gives_the_same_quantities_with_units_and_whole_distributions(states, theory):
    dataset = states[theory].to_dataset()
    assert dataset.theory == theory
    for name in dataset.data_vars:
        assert dataset[name].attrs["units"] == variable_of(name).units
        assert "step" not in dataset[name].dims
    assert all(np.isfinite(dataset[name]).all() for name in SHARED)
    assert dataset.converged == 1
    with pytest.raises(ValueError, match="pressure_edges: must be rising"):
        states[theory].to_dataset(pressure_edges=np.array([1.0, 0.0]))
    # Persson's counts the stress in contact only.
    held = float(dataset.relative_contact_area) if theory == "persson" else 1.0
    width = dataset.pressure_bin[1] - dataset.pressure_bin[0]
    assert float(dataset.pressure_pdf.sum() * width) == pytest.approx(held, rel=1e-6)


def test_the_local_theories_say_gaps_and_both_pressures(states, paper):
    for theory in ("gap_flow", "edge_flow"):
        state = states[theory]
        dataset = state.to_dataset(paper.contact_distance)
        assert float(dataset.relative_contact_area) == state.fraction_below(paper.contact_distance)
        # From the law's zero, at which smooth surfaces rest.
        assert float(dataset.mean_gap) == pytest.approx(state.mean_gap - 3.28e-10, rel=1e-12)
        width = dataset.gap_bin[1] - dataset.gap_bin[0]
        assert float(dataset.gap_pdf.sum() * width) == pytest.approx(1, rel=1e-6)
        mean = float((dataset.gap_pdf * dataset.gap_bin).sum() * width)
        assert mean == pytest.approx(state.mean_gap, rel=1e-3)  # 400 bins
        assert float(dataset.local_mean_pressure) == state.mean_traction != float(dataset.mean_pressure)
        assert state.quantities()["converged"]
        for lost in (0.999 * state.weights, np.roll(state.weights, 1)):  # area, and mean gap
            assert not replace(state, weights=lost).quantities()["converged"]
        own = state.to_dataset()
        assert float(own.relative_repulsive_area) == state.fraction_below(3.28e-10)
        assert theory == "edge_flow" or own.metastable_branch == "loading"
        assert float(own.relative_contact_area) == state.fraction_below(paper.law(1).contact_distance)


def test_stress_at_a_magnification_is_the_diffusion_stopped_there(paper):
    contact = paper.theory(0.0).at_pressure(1e9)
    wavevectors = contact.theory.wavevectors
    edges = contact.theory.stress_scale * np.linspace(-7, 8, 1501)
    between = float(np.sqrt(wavevectors[80] * wavevectors[81]))
    whole = np.sum(contact.stress_density(edges, between)) * (edges[1] - edges[0])
    # Between two nodes the area is between theirs, not that of one of them.
    share = (whole - contact.contact[81]) / (contact.contact[80] - contact.contact[81])
    assert 0.3 < share < 0.7
    # At the last it is the distribution itself, on other cells.
    whole, last = contact.pressure_density(edges), contact.stress_density(edges, wavevectors[-1])
    assert np.abs(last - whole).max() < 5e-3 * whole.max()
    density = contact.stress_density(edges, wavevectors[100])
    expected = closed_forms.stress_density(0.5 * (edges[1:] + edges[:-1]), 1e9, contact.theory.stress_variance[100])
    assert np.abs(density - expected).max() < 0.02 * expected.max()
    with pytest.raises(ValueError, match="wavevector"):
        contact.stress_density(edges, 2 * wavevectors[-1])


def test_a_state_gives_its_mean_gap_and_its_stress_at_magnifications(states):
    edges = np.linspace(-5e9, 4e10, 91)
    expected = separation_curve(states["persson"].theory, 1e8).mean_gap(1e9)
    # Two sweeps with other pressures.
    assert float(states["persson"].to_dataset().mean_gap) == pytest.approx(float(expected), rel=1e-3)
    assert np.isnan(states["persson"].theory.at_pressure(-1e6).to_dataset().mean_gap)
    dataset = states["persson"].to_dataset(edges, magnifications=[2.0, 12.0])
    assert (dataset.pressure_pdf_at.dims, dataset.magnification.units) == (("magnification", "pressure_bin"), "1")
    first = states["persson"].theory.wavevectors[0]
    np.testing.assert_array_equal(dataset.pressure_pdf_at[0], states["persson"].stress_density(edges, 2 * first))
    with pytest.raises(ValueError, match="magnifications go from above"):
        states["persson"].to_dataset(magnifications=[1.0])
