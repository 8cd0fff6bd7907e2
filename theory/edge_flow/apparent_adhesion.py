"""Apparent work of adhesion on unloading: what many small jumps add to the edge flow.

At a prescribed separation an asperity jumps into and out of contact once Maugis' λ exceeds λ₁ of its law. A rough
contact then separates as if the work of adhesion were Γ times as large. With x = λ/λ₁ of the mean asperity

    Γ = 1 + k (x² − 1)₊.

x² is JKR's contact radius over the length of the process zone, over its value where jumps begin. The form and the
number k are chosen on one half of the contact atlas' jumping conditions; the other half judges them.
"""

import warnings
from dataclasses import replace

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.process_zone import jump_number
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of

GROWTH = 0.08  # k, from ``python -m scripts.validate_hysteresis fit``
# Mean size of the relative error of the area on each branch, on the half that judges: ``... branches``.
AREA_ERRORS = {"loading": 0.05, "unloading": 0.05}
# Simulated loops have judged Γ up to this x: 2.12 in the atlas, 2.22 on the paper's surface at six times its adhesion.
LARGEST_SIMULATED = 2.25


class Extrapolated(UserWarning):
    """An apparent work of adhesion at an x beyond all simulated loops."""


def adhesion_ratio(number: np.ndarray | float, growth: float = GROWTH) -> np.ndarray | float:
    """Return Γ of x, Maugis' λ of the mean asperity over that from which one jumps; ``growth`` is k."""
    return 1.0 + growth * np.maximum(np.square(number) - 1.0, 0.0)


def apparent_adhesion(spectrum: RoughnessSpectrum, elasticity: Elasticity | float, law: TractionLaw) -> float:
    """Return Γ, the apparent work of adhesion on unloading over that on loading; this project's own, unpublished.

    Warns (:class:`Extrapolated`) where x is beyond all simulated loops, as for rubber with an atomic range.

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
    radius, modulus = 2 / spectrum.rms_laplacian, elasticity_of(elasticity).contact_modulus
    number = jump_number(radius, modulus, law)
    ratio = float(adhesion_ratio(number))
    if number > LARGEST_SIMULATED:
        where = f"x = {number:.3g} for the mean asperity, simulated loops end at {LARGEST_SIMULATED:g}"
        advice = f"check Γ = {ratio:.3g} and the unloading branch by a simulation"
        warnings.warn(f"apparent adhesion: {where}; {advice}", Extrapolated, stacklevel=2)
    return ratio


def stronger(law: TractionLaw, ratio: float) -> TractionLaw:
    """Return the law of the same range with ``ratio`` times the work of adhesion."""
    return replace(law, work_of_adhesion=ratio * law.work_of_adhesion)
