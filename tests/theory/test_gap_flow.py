"""Gap-flow theory: reference table, exact limits, balances, branches, convergence."""

import numpy as np
import pytest

from contact_study.physics.laws import Exponential, LennardJones104
from contact_study.physics.laws.base import TractionLaw
from theory.edge_flow.flow import edge_flow
from theory.gap_flow.flow import GapFlow, gap_flow

PRESSURES = (0.1, 0.5, 1, 2, 5, 10)  # GPa
# A (u < 3.68 Å) and ū/h_rms of a prototype with 3200 gaps and 800 scales, and its pull-off pressure (GPa).
REFERENCE = {
    1: ((0.0407, 0.1312, 0.2153, 0.3456, 0.6026, 0.8277), (1.855, 1.234, 0.933, 0.627, 0.262, 0.068), 0.0),
    4: ((0.3026, 0.4080, 0.4965, 0.6168, 0.8093, 0.9366), (1.014, 0.769, 0.600, 0.407, 0.164, 0.040), -0.17),
    8: ((0.6709, 0.7138, 0.7560, 0.8176, 0.9169, 0.9766), (0.434, 0.364, 0.299, 0.210, 0.083, 0.017), -1.00),
}


def flow_of(paper, ratio, branch="equilibrium", work_of_adhesion=0.6924, **resolution):
    law = paper.law(ratio, work_of_adhesion)
    return gap_flow(paper.spectrum, paper.contact_modulus, law, branch, **resolution)


def states_at(flow, pressures):
    return flow.states(np.array([flow.gap_at(p * 1e9) for p in pressures]))


@pytest.mark.parametrize("ratio", REFERENCE)
def test_reference_table(paper, ratio):
    areas, gaps, pull_off = REFERENCE[ratio]
    flow = flow_of(paper, ratio)
    states = states_at(flow, PRESSURES)
    zero = flow.length
    # The reference's own first-order error in its 800 scales is up to 1.2 % of A (ε₀, 0.1 GPa), here half of that.
    assert [s.fraction_below(paper.contact_distance) for s in states] == pytest.approx(areas, rel=0.01)
    found = [(s.mean_gap - zero) / paper.rms_height for s in states]
    assert found == pytest.approx(gaps, rel=0.01, abs=1e-3)  # and a unit of the last digit
    assert flow.pull_off_pressure / 1e9 == pytest.approx(pull_off, abs=0.01)


@pytest.mark.parametrize(
    ("ratio", "branch", "areas"),
    [
        (4, "loading", (0.206, 0.420, 0.767)),
        (4, "unloading", (0.547, 0.667, 0.882)),
        (8, "loading", (0.401, 0.563, 0.837)),
        (8, "unloading", (0.975, 0.981, 0.995)),
    ],
)
def test_reference_areas_of_the_branches(paper, ratio, branch, areas):
    states = states_at(flow_of(paper, ratio, branch, 0.69), (0.1, 1, 5))
    found = [s.fraction_below(paper.contact_distance) for s in states]
    assert found == pytest.approx(areas, rel=0.02)  # 2400 gaps and 600 scales, first order


@pytest.mark.parametrize(("branch", "gap"), [("loading", 28 / 3), ("equilibrium", 28 / 3), ("unloading", 1.5)])
def test_of_several_stable_states_an_approaching_block_meets_the_farthest(branch, gap):
    # Pressures at 1, 3, 5, 7, 9, 11 m: they fall through 15 Pa at 1.5, 6.5 and 28/3 m.
    pressures = np.array([20.0, 0.0, 30.0, 10.0, 20.0, -10.0])
    energy = -np.concatenate([[0.0], np.cumsum(pressures)]) / 10
    nothing = np.empty((0, energy.size))
    law, nodes = LennardJones104(1.0, 1.0), np.arange(7.0)
    flow = GapFlow(law, 2.0, 10.0, branch, nodes, energy, 0, nodes[:0], nodes[:0], nothing, nothing)
    assert flow.pressure == pytest.approx(pressures)
    assert flow.mean_gap == pytest.approx([1, 3, 5, 7, 9, 11])
    assert flow.gap_at(15.0) == pytest.approx(gap)
    assert flow.pressure_at(6.5) == pytest.approx(15.0)
    assert flow.pull_off_pressure == pytest.approx(-10.0)


@pytest.mark.parametrize(("ratio", "branch"), [(1, "equilibrium"), (8, "loading")])
def test_distribution_keeps_area_gap_and_load(paper, ratio, branch):
    flow = flow_of(paper, ratio, branch)
    for state in states_at(flow, (0.5, 5)):
        assert state.weights.min() >= 0
        # Rounding of 1600 steps with condition numbers up to 1e4.
        assert state.weights.sum() == pytest.approx(1, abs=1e-9)
        assert state.weights @ state.gaps * flow.length == pytest.approx(state.mean_gap, rel=1e-9)
        # The traction flows as the derivative of the energy does, but for the ends of coexistence between nodes.
        assert state.mean_traction == pytest.approx(state.pressure, rel=0.02)
        masses = state.pressure_density(edges := np.linspace(-40e9, 120e9, 8001)) * 20e6
        # Measured 2 to 11 MPa, of tension up to 1.7 GPa and repulsion up to 6.6 GPa.
        assert masses @ (0.5 * (edges[1:] + edges[:-1])) == pytest.approx(state.pressure, abs=0.02e9)
        assert not masses[edges[1:] < -flow.law.peak_tensile_stress * flow.contact_modulus].any()


def test_energy_is_elastic_plus_interaction(paper):
    flow = flow_of(paper, 8)
    at = np.searchsorted(flow.gaps, [1.2, 2, 4])
    found = [state.elastic_energy + state.interaction_energy for state in flow.states(flow.gaps[at] * flow.length)]
    # An identity of the implicit scheme itself, term by term.
    assert found == pytest.approx(flow.energy[at] * flow.contact_modulus * flow.length, rel=1e-8)


def test_gaps_of_coexistence_are_left_out_and_nothing_more(paper):
    flow = flow_of(paper, 4)
    (state,) = states_at(flow, [0.78])
    gaps = state.gaps * flow.length
    above = gaps[(gaps > 4.5e-10) & (state.weights > 0)][0]
    # No gap lies between the two states that coexist: contact below 3.8 Å and the wide gap that attraction leaves.
    assert above > 6.5e-10
    assert not np.any(state.weights[(gaps > 4e-10) & (gaps < above)])
    # Above it P(u) varies as slowly as the roughness, by 17 % in 1.4 Å. A finest step as long as the others would put
    # the area of several nodes on the first and leave a third of it on those beside.
    density = state.gap_density(above + 0.1e-10 * np.arange(15))
    assert density == pytest.approx(np.full(14, density[-1]), rel=0.25)


class Coreless(TractionLaw):
    """Attraction that nothing ends: its potential has no minimum."""

    title = "attraction alone"
    words = "attraction alone"

    def potential(self, gap):
        return -self.work_of_adhesion * np.exp(-np.asarray(gap) / self.length)


@pytest.mark.parametrize("flow", [gap_flow, edge_flow])
def test_laws_without_a_core_are_refused_by_name(paper, flow):
    for law, words in ((Exponential(0.7, 3e-10), "exponential: has a wall"), (Coreless(0.7, 3e-10), "has no core")):
        with pytest.raises(ValueError, match=words):
            flow(paper.spectrum, paper.contact_modulus, law)


def test_a_state_far_beyond_the_roughness_is_a_whole_distribution(paper):
    """Its weights fall off below the smallest number."""
    flow = gap_flow(paper.spectrum, paper.contact_modulus, paper.law(1), largest_gap=1e-6, gaps=200, scales=100)
    (state,) = flow.states(np.array([9.9e-7]))
    assert state.fraction_below(paper.contact_distance) == 0
    assert state.fraction_below(0.5e-6) < 1e-12
    assert state.fraction_below(1.1e-6) == pytest.approx(1, rel=1e-9)
