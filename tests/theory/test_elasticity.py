"""The theories on solids that are no half-spaces, against cases with an exact solution."""

from dataclasses import dataclass

import numpy as np
import pytest

from contact_study.physics.solids import Layer
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
    """Mean gap and pressure of springs on Gaussian heights: each gap d minimises ½K(d − base + h)² + φ(d)."""
    heights = np.linspace(-8, 8, 10001)  # 1e-15 of the Gaussian is beyond
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
    law = paper.law(1)
    solid = Springs(paper.contact_modulus, law.strongest_softening / 3.0)
    flow = gap_flow(paper.spectrum, solid, law)
    for base in np.array([-0.5, 0.5, 1.0, 2.0]) * paper.rms_height:
        gap, pressure = exact_springs(base, solid.spring, paper.rms_height, law)
        # The flow's steps are of first order in the variance: with a quarter of them the first is off by 6e-3.
        assert flow.pressure_at(gap) == pytest.approx(pressure, abs=2e-3 * law.peak_tensile_stress)


def test_mean_gap_without_adhesion_is_the_work_of_the_pressure(paper):
    solid = Layer(paper.contact_modulus, 0.5, 0.7 / paper.spectrum.low)  # its K is no power of q
    theory = PerssonTheory(paper.spectrum, solid, 0.0)
    pressures = np.array([0.05, 0.3]) * theory.stress_scale
    curve = separation_curve(theory, pressures[0])
    expected = closed_forms.mean_gap(pressures, paper.spectrum, solid)
    # The nodes of the diffusion, as on a half-space.
    np.testing.assert_allclose(curve.mean_gap(pressures), expected, rtol=5e-3)
