"""The theories on solids that are no half-spaces, against cases with an exact solution."""

from dataclasses import dataclass

import numpy as np
import pytest

from contact_study.physics.solids import HalfSpace, Layer
from contact_study.physics.solids.base import Elasticity
from theory.gap_flow.flow import gap_flow
from theory.non_adhesive import closed_forms
from theory.persson.separation import separation_curve
from theory.persson.theory import PerssonTheory


@dataclass(frozen=True)
class Springs(Elasticity):
    """A bed of independent springs: K for every wave (Pa/m)."""

    spring: float

    def stiffness(self, wavenumber):
        return np.full(np.shape(wavenumber), self.spring)


def exact_springs(base, spring, rms_height, law):
    """Mean gap and pressure of springs on Gaussian heights, each in its lowest state, at a position of their base.

    The gap d above a height h minimises ½K(d − base + h)² + φ(d), whatever its neighbours do.
    """
    # Of the Gaussian 1e-15 is beyond, and the trapezoidal rule knows no other error.
    heights = np.linspace(-8, 8, 10001)
    weights = np.exp(-0.5 * heights**2)
    weights /= weights.sum()
    reach = base - rms_height * heights
    trial = law.length * np.geomspace(0.5, 3 + reach.max() / law.length, 800)
    energy = 0.5 * spring * (trial - reach[:, None]) ** 2 + law.potential(trial)
    gap = trial[np.argmin(energy, axis=1)]
    for _ in range(4):
        gap -= (spring * (gap - reach) + law.traction(gap)) / (spring + law.stiffness(gap))
    return weights @ gap, spring * (weights @ gap - base)


def test_gap_flow_is_exact_on_springs(paper):
    """Springs of one stiffness, below the law's softening: waves of any length, added in any order, do not
    know of each other, and the flow of the energy is that of heat in the position of the base."""
    law = paper.law(1)
    solid = Springs(paper.contact_modulus, law.strongest_softening / 3.0)
    flow = gap_flow(paper.spectrum, solid, law)
    for base in np.array([-0.5, 0.5, 1.0, 2.0]) * paper.rms_height:
        gap, pressure = exact_springs(base, solid.spring, paper.rms_height, law)
        # The flow's steps are of first order in the variance: with a quarter of them the first is off by 6e-3.
        assert flow.pressure_at(gap) == pytest.approx(pressure, abs=2e-3 * law.peak_tensile_stress)


def test_thick_layers_and_thin_ones(paper):
    """A layer much thicker than the longest wave is a half-space, a thinner one stiffer: less contact, more gap."""
    spectrum, law = paper.spectrum, paper.law(1)
    solids = [Layer(paper.contact_modulus, 0.42, d / spectrum.low) for d in (40.0, 0.1)]
    half_space = HalfSpace(paper.contact_modulus)
    theories = [PerssonTheory(spectrum, solid, 0.69) for solid in (half_space, *solids)]
    areas = [theory.at_pressure(1e9).relative_contact_area for theory in theories]
    assert areas[1] == pytest.approx(areas[0], rel=1e-9)
    assert areas[0] > areas[2]
    gaps = [gap_flow(spectrum, solid, law).gap_at(1e9) for solid in (half_space, *solids)]
    assert gaps[1] == pytest.approx(gaps[0], rel=1e-9)
    assert gaps[0] < gaps[2]


def test_mean_gap_without_adhesion_is_the_work_of_the_pressure(paper):
    """Closed form against the sweep of the energy, on a solid whose K is no power of q."""
    solid = Layer(paper.contact_modulus, 0.5, 0.7 / paper.spectrum.low)
    theory = PerssonTheory(paper.spectrum, solid, 0.0)
    pressures = np.array([0.05, 0.3]) * theory.stress_scale
    curve = separation_curve(theory, pressures[0])
    expected = closed_forms.mean_gap(pressures, paper.spectrum, solid)
    # The nodes of the diffusion, as on a half-space.
    np.testing.assert_allclose(curve.mean_gap(pressures), expected, rtol=5e-3)
