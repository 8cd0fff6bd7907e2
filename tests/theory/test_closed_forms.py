"""Closed forms of Persson's theory without adhesion against quadrature and reference numbers."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

from theory.non_adhesive import closed_forms


def test_stress_density_holds_the_contact_area_and_the_load():
    stress, pressure, variance = np.linspace(-1, 60, 60001), 2.0, 30.0
    density = closed_forms.stress_density(stress, pressure, variance)
    assert np.all(density[stress < 0] == 0)
    # Trapezoidal rule on a smooth function: 1e-6 at this spacing, cut off at eleven deviations.
    area = closed_forms.relative_contact_area(pressure, variance)
    assert np.trapezoid(density, stress) == pytest.approx(area, rel=1e-6)
    assert np.trapezoid(density * stress, stress) == pytest.approx(pressure, rel=1e-6)


def test_mean_gap_agrees_with_quadrature(paper):
    spectrum, modulus, beta = paper.spectrum, paper.contact_modulus, 0.45
    pressure = 0.01 * modulus

    def inner(w):
        def integrand(y):
            return (beta + 3 * (1 - beta) * erf(y) ** 2) * np.exp(-(y**2)) / y

        return quad(integrand, w * pressure / modulus, 10, epsrel=1e-10)[0]

    def outer(t):
        # q = q_L + t² takes away the singularity of w at q_L.
        q = spectrum.low + t**2
        w = (np.pi * float(spectrum.moment(3, upper=q))) ** -0.5
        return 2 * t * q**2 * float(spectrum.density(q)) * w * inner(w)

    corner, end = np.sqrt(spectrum.roll_off - spectrum.low), np.sqrt(spectrum.cutoff - spectrum.low)
    expected = np.sqrt(np.pi) * (quad(outer, 1e-3, corner, epsrel=1e-7)[0] + quad(outer, corner, end, epsrel=1e-7)[0])
    # Bands of 0.25 % in q: their rule is of second order, with a constant below one.
    assert closed_forms.mean_gap(pressure, spectrum, modulus, beta) == pytest.approx(expected, rel=2e-5)


def test_light_load_asymptote(paper):
    decay, prefactor = closed_forms.low_pressure_asymptote(paper.spectrum, paper.contact_modulus)
    assert decay / paper.rms_height == pytest.approx(0.4278, abs=1e-4)
    # An error of 1e-5 in u₀ stands in the exponent 28 times: 3e-4.
    assert prefactor / paper.contact_modulus == pytest.approx(0.1652, rel=1e-3)
    pressure = np.exp(-9) * paper.contact_modulus
    gap = closed_forms.mean_gap(pressure, paper.spectrum, paper.contact_modulus)
    assert prefactor * np.exp(-gap / decay) == pytest.approx(pressure, rel=0.01)
