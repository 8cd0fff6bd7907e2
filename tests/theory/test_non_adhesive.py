"""Persson's theory without adhesion and its corrections: quadrature, their own equations, each other."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import erf

from theory.non_adhesive import closed_forms
from theory.non_adhesive.corrections import CORRECTIONS, NonAdhesiveTheory

SHARES = {
    "persson": np.ones_like,
    "yang_persson": lambda area: 0.42 + 0.58 * area**2,
    "wang_mueser": lambda area: 5 / 9 - 2 / 9 * area**2 + 2 / 3 * area**4,
}


def theory_of(paper, correction, **choices):
    return NonAdhesiveTheory(paper.spectrum, paper.contact_modulus, correction, **choices)


def variance_of(paper):
    return float(paper.spectrum.full_contact_stress_variance(lambda q: 0.5 * paper.contact_modulus * q))


@pytest.mark.parametrize("pressure", [1e7, 5e9])
def test_without_correction_it_is_the_closed_form_and_xu_solves_its_implicit_equation(paper, pressure):
    contact, variance = theory_of(paper, "persson").at_pressure(pressure), variance_of(paper)
    assert contact.relative_contact_area == pytest.approx(erf(pressure / np.sqrt(2 * variance)), rel=1e-9)
    expected = closed_forms.mean_gap(pressure, paper.spectrum, paper.contact_modulus, beta=1.0)
    # Both sums over the same bands; interpolation on 3000 nodes.
    assert contact.mean_gap == pytest.approx(float(expected), rel=1e-6)
    contact = theory_of(paper, "xu").at_pressure(pressure)
    area = brentq(lambda a: a - erf(pressure / np.sqrt(2 * (0.42 + 0.58 * a) * variance)), 0, 1, xtol=1e-14)
    assert contact.relative_contact_area == pytest.approx(area, rel=1e-7)


@pytest.mark.parametrize("correction", CORRECTIONS)
def test_the_pressure_does_the_work(paper, correction):
    theory = theory_of(paper, correction)
    for pressure in (1e8, 1e9, 1e10):
        below, here, above = (theory.at_pressure(pressure * (1 + shift)) for shift in (-1e-3, 0, 1e-3))
        gained = above.elastic_energy - below.elastic_energy
        closed = below.mean_gap - above.mean_gap
        # Central differences over 0.2 %.
        assert gained == pytest.approx(pressure * closed, rel=1e-4)
        assert here.stiffness == pytest.approx(2e-3 * pressure / closed, rel=1e-4)
    gaps = [theory.at_pressure(pressure).mean_gap for pressure in (1e-2, 1.0, 1e4, 1e6)]
    # The same for every two decades, also beyond the last node, which 1e4 Pa are before.
    assert gaps[0] - gaps[1] == pytest.approx(gaps[2] - gaps[3], rel=1e-3)


@pytest.mark.parametrize("correction", CORRECTIONS)
def test_distribution_carries_area_and_pressure(paper, correction):
    contact = theory_of(paper, correction).at_pressure(2e9)
    dataset = contact.to_dataset()
    width = dataset.pressure_bin[1] - dataset.pressure_bin[0]
    assert float(dataset.pressure_pdf.sum() * width) == pytest.approx(contact.relative_contact_area, rel=1e-9)
    assert float((dataset.pressure_pdf * dataset.pressure_bin).sum() * width) == pytest.approx(2e9, rel=1e-3)
    middle = dataset.pressure_bin.values[100]
    assert float(dataset.pressure_pdf[100]) == pytest.approx(float(contact.stress_density(middle)), rel=1e-3)
    assert dataset.theory == correction


@pytest.mark.parametrize("correction", CORRECTIONS)
def test_energy_is_that_of_the_stress_in_contact(paper, correction):
    """U = ∫ A dV_p/2K over the magnification, the trapezoidal rule."""
    contact = theory_of(paper, correction).at_pressure(2e9)
    low, cutoff = paper.spectrum.limits
    q = low * (cutoff / low) ** (np.linspace(0, 1, 6001) ** 3)  # A falls from one at once
    variance, area = contact.stress_variance_at(q), contact.relative_contact_area_at(q)
    assert (area[0], area[-1]) == (1, pytest.approx(contact.relative_contact_area, rel=1e-12))
    middle = 0.5 * (area[1:] + area[:-1])
    if correction in SHARES:
        full = paper.spectrum.full_contact_stress_variance(lambda q: 0.5 * paper.contact_modulus * q, q)
        share = np.diff(variance)[100:] / np.diff(full)[100:]
        assert share == pytest.approx(SHARES[correction](middle[100:]), rel=1e-3)
    energy = np.sum(middle * np.diff(variance) / (paper.contact_modulus * 0.5 * (q[1:] + q[:-1])))
    assert contact.elastic_energy == pytest.approx(energy, rel=1e-4)


def test_what_cannot_be_is_named(paper):
    for correction, gamma, named in (("better", 0.4, "better"), ("xu", 1.5, "gamma"), ("xu", 0.0, "gamma")):
        with pytest.raises(ValueError, match=named):
            theory_of(paper, correction, gamma=gamma)
    for pressure in (0.0, -1e9, np.nan):
        with pytest.raises(ValueError, match="pressure"):
            theory_of(paper, "xu").at_pressure(pressure)


def test_light_load_asymptote(paper):
    decay, prefactor = closed_forms.low_pressure_asymptote(paper.spectrum, paper.contact_modulus)
    assert decay / paper.rms_height == pytest.approx(0.4278, abs=1e-4)
    # An error of 1e-5 in u₀ stands in the exponent 28 times: 3e-4.
    assert prefactor / paper.contact_modulus == pytest.approx(0.1652, rel=1e-3)
