"""The unloading branch of the edge flow: its law, its curve, and where a curve under tension has its pull-off."""

import numpy as np
import pytest

from contact_study.physics.laws import Dugdale, ExponentialCore, LennardJones104
from contact_study.physics.laws.lennard_jones import Repulsive
from contact_study.physics.process_zone import jump_number
from contact_study.physics.spheres.numbers import maugis_parameter, tabor_parameter
from scripts import atlas_tables, jump_onset, validate_hysteresis
from theory import JKR, SelfAffineSpectrum, apparent_adhesion, edge_flow
from theory.edge_flow.apparent_adhesion import LARGEST_SIMULATED, Extrapolated, adhesion_ratio, stronger
from theory.gap_flow.state import PressureCurve

SPECTRUM = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
PAPER = SelfAffineSpectrum(0.8, 1e-9, 2 * np.pi / 1040e-10, 6 * np.pi / 1040e-10, 24 * np.pi / 1040e-10)
MODULUS = 93.7e9
RADIUS = 2 / SPECTRUM.rms_laplacian


def law_of(ratio):
    """The law whose mean asperity has a given x."""
    law = LennardJones104(0.5, 3e-10)
    # x goes with the two thirds power of Δγ.
    return stronger(law, (ratio / jump_number(RADIUS, MODULUS, law)) ** 1.5)


def test_the_number_is_maugis_over_its_onset():
    law = LennardJones104(0.5, 3e-10)
    tabor = tabor_parameter(RADIUS, MODULUS, 0.5, law.length)
    assert jump_number(RADIUS, MODULUS, law) == pytest.approx(2.125 * tabor / 0.96, rel=1e-3)
    walls = {Dugdale(0.5, 3e-10): 0.89, ExponentialCore(0.5, 3e-10, 3e-10, 1e-11): 1.14}
    for wall, onset in walls.items():
        assert wall.jump_onset == onset
    assert jump_number(RADIUS, MODULUS, Repulsive(0.0, 3e-10, 0.05)) == 0.0


def test_its_square_is_the_radius_of_contact_over_the_process_zone():
    """λ² = (9/2)^(1/3)/π a₀/ℓ, with JKR's a₀ without load and ℓ = E*Δγ/σ²."""
    law = LennardJones104(0.5, 3e-10)
    radius = JKR(RADIUS, MODULUS, 0.5).at_force(0.0)[2]
    zone = MODULUS * 0.5 / law.peak_tensile_stress**2
    squared = (0.96 * jump_number(RADIUS, MODULUS, law)) ** 2
    assert squared == pytest.approx(4.5 ** (1 / 3) / np.pi * radius / zone)


@pytest.mark.parametrize(("ratio", "expected"), [(0.5, 1.0), (1.0, 1.0), (1.5, 1.1), (2.0, 1.24)])
def test_the_apparent_adhesion_rises_with_the_square(ratio, expected):
    assert apparent_adhesion(SPECTRUM, MODULUS, law_of(ratio)) == pytest.approx(expected, abs=1e-9)


def test_beyond_simulated_loops_it_warns():
    judged = atlas_tables.read(validate_hysteresis.JUMPING_DATA)["apparent_adhesion_ratio"].max()
    strongest = adhesion_ratio(jump_number(2 / PAPER.rms_laplacian, 93.7348e9, LennardJones104(6 * 0.6924, 3.28e-10)))
    assert adhesion_ratio(LARGEST_SIMULATED - 0.05) < max(judged, strongest) <= adhesion_ratio(LARGEST_SIMULATED)
    apparent_adhesion(SPECTRUM, MODULUS, law_of(LARGEST_SIMULATED - 1e-6))
    words = r"x = 3 for the mean asperity, simulated loops end at 2\.25; check Γ = 1\.64 and the unloading branch by"
    with pytest.warns(Extrapolated, match=words):
        assert apparent_adhesion(SPECTRUM, MODULUS, law_of(3.0)) == pytest.approx(1.64)
    with pytest.raises(Extrapolated, match=words):  # warnings are errors here
        edge_flow(SPECTRUM, MODULUS, law_of(3.0), branch="unloading")


def test_it_agrees_with_branches_of_other_spectra():
    """Simulated areas of the paper's surface on unloading ask for Γ = 1.12 at 4 and 1.43 at 6 ε₀, 1.00 to 1.02 at 2."""
    found = [apparent_adhesion(PAPER, 93.7348e9, LennardJones104(0.6924 * ratio, 3.28e-10)) for ratio in (1, 2, 4, 6)]
    assert found[0] == 1
    # The spread of Γ over pressure and surfaces is a third of its excess.
    np.testing.assert_allclose(found[1:], [1.01, 1.12, 1.43], atol=0.13)


def test_unloading_is_the_curve_of_a_stronger_law():
    law = law_of(1.5)
    keys = {"highest_pressure": 3e9, "gaps": 100, "scales": 24}
    loading, unloading = (edge_flow(SPECTRUM, MODULUS, law, branch=way, **keys) for way in ("loading", "unloading"))
    same = edge_flow(SPECTRUM, MODULUS, stronger(law, 1.1), **keys)
    np.testing.assert_allclose(unloading.pressure, same.pressure, rtol=1e-6, atol=1.0)
    assert unloading.pull_off_pressure < loading.pull_off_pressure < 0
    assert unloading.work_of_separation > loading.work_of_separation > 0
    pressure = 0.5 * loading.pull_off_pressure
    # Under tension loading is the state far from contact, unloading that in contact.
    assert unloading.at_pressure(pressure).mean_gap < loading.at_pressure(pressure).mean_gap
    states = [flow.at_pressure(1e9) for flow in (loading, unloading)]
    assert states[1].fraction_below(3.4e-10) > states[0].fraction_below(3.4e-10)
    assert [state.labels for state in states] == [("edge_flow",), ("edge_flow", "unloading")]
    with pytest.raises(ValueError, match=r"branch = 'sideways': expected one of loading, unloading"):
        edge_flow(SPECTRUM, MODULUS, law, branch="sideways")


class Curve(PressureCurve):
    """A curve with a spike near contact, as the slope of an energy has where the pressure rises steeply."""

    @property
    def mean_gap(self):
        return np.linspace(0.9, 10, 911)

    @property
    def pressure(self):
        smooth = 2.0 * (self.mean_gap - 2) * (self.mean_gap - 9) / 24.5 * (self.mean_gap < 9)
        return smooth - 9.0 * (np.abs(self.mean_gap - 1) < 0.05)

    def states(self, mean_gaps):
        raise NotImplementedError


def test_the_pull_off_is_not_an_error_of_the_slope_near_contact():
    curve = Curve()
    assert curve.pressure.min() < -5
    assert curve.pull_off_pressure == pytest.approx(-1.0)
    assert curve.work_of_separation == pytest.approx(7**3 / 6 * 2 / 24.5, rel=1e-3)


@pytest.mark.filterwarnings("ignore:grid too coarse")
@pytest.mark.parametrize(("number", "expected"), [(0.8, False), (1.2, True)])
def test_an_asperity_jumps_above_its_onset(number, expected):
    law = jump_onset.with_number(jump_onset.LAWS["10-4 law"], number)
    found = maugis_parameter(jump_onset.RADIUS, 1.0, jump_onset.WORK, law.peak_tensile_stress)
    assert found == pytest.approx(number)
    assert jump_onset.jumps(law, points=48, steps=60) is expected
