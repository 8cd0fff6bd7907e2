"""Apparent work of adhesion on unloading: what hysteresis of many small jumps adds to the edge flow.

An asperity jumps into and out of contact at a prescribed separation once its Maugis number λ exceeds λ₁. A rough contact
then separates as if the work of adhesion were Γ times as large. Γ follows from two numbers of the mean asperity: x =
λ/λ₁, and the part c of the nominal area that asperities without load would cover.
"""

from dataclasses import replace

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from contact_study.physics.spheres.jkr import jkr_contact_radius
from contact_study.physics.spheres.numbers import maugis_parameter

# Maxima per area of a Gaussian surface over (∇²h/h')², both rms. M. S. Longuet-Higgins, Phil. Trans. R. Soc. Lond. A
# 249, 321–387 (1957), as 1/(6π√3) of the profile's moments m₄/m₂ = ¾ (∇²h/h')².
_MAXIMA = 0.75 / (6 * np.pi * np.sqrt(3))

# ln Γ = SIZE c^COVERED (x^STEEPNESS − ONSET^STEEPNESS)₊, fitted to half of the loops of the contact atlas.
SIZE, COVERED, STEEPNESS, ONSET = 0.073, 0.7, 3.0, 1.14


def jump_number(spectrum: RoughnessSpectrum, elasticity: Elasticity | float, law: TractionLaw) -> float:
    """Return Maugis' λ of the mean asperity, of radius 2/rms ∇²h, over that from which one asperity jumps.

    Parameters
    ----------
    spectrum, elasticity, law
        As for :func:`theory.edge_flow`.

    Returns
    -------
    float
    """
    radius, modulus = 2 / spectrum.rms_laplacian, elasticity_of(elasticity).contact_modulus
    number = maugis_parameter(radius, modulus, law.work_of_adhesion, law.peak_tensile_stress)
    return float(number) / law.jump_onset


def covered_area(spectrum: RoughnessSpectrum, elasticity: Elasticity | float, law: TractionLaw) -> float:
    """Return the maxima per area times the area of JKR's contact of the mean asperity without load.

    Parameters
    ----------
    spectrum, elasticity, law
        As for :func:`theory.edge_flow`.

    Returns
    -------
    float
    """
    radius, modulus = 2 / spectrum.rms_laplacian, elasticity_of(elasticity).contact_modulus
    contact = float(jkr_contact_radius(0.0, radius, modulus, law.work_of_adhesion))
    return float(_MAXIMA * (spectrum.rms_laplacian / spectrum.rms_slope) ** 2 * np.pi * contact**2)


def apparent_adhesion(spectrum: RoughnessSpectrum, elasticity: Elasticity | float, law: TractionLaw) -> float:
    """Return Γ, the work of adhesion that a contact seems to have on unloading over its own.

    Parameters
    ----------
    spectrum, elasticity, law
        As for :func:`theory.edge_flow`.

    Returns
    -------
    float
        1 without hysteresis.

    Examples
    --------
    >>> from theory import LennardJones104, SelfAffineSpectrum, apparent_adhesion
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> apparent_adhesion(spectrum, 93.7e9, LennardJones104(work_of_adhesion=0.1, length=3.28e-10))
    1.0
    """
    if not law.attracts:
        return 1.0
    excess = jump_number(spectrum, elasticity, law) ** STEEPNESS - ONSET**STEEPNESS
    if excess <= 0:
        return 1.0
    return float(np.exp(SIZE * covered_area(spectrum, elasticity, law) ** COVERED * excess))


def stronger(law: TractionLaw, ratio: float) -> TractionLaw:
    """Return the law of the same range with ``ratio`` times the work of adhesion."""
    return replace(law, work_of_adhesion=ratio * law.work_of_adhesion)
