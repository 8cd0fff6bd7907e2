"""The Tabor parameter and Maugis' λ, which say whether a sphere is like DMT's or like JKR's, and their ratio.

D. Tabor, J. Colloid Interface Sci. 58, 2–13 (1977); D. Maugis, J. Colloid Interface Sci. 150, 243–269 (1992).
"""

import numpy as np

from contact_study.physics.spheres.base import Number, check

# Strength of the 9-3 law over w/z₀, z₀ its equilibrium distance.
_STRENGTH_9_3 = 16 / (9 * np.sqrt(3))
_SCALE = 2 * np.cbrt(9 / (16 * np.pi))


def tabor_parameter(radius: Number, contact_modulus: Number, work_of_adhesion: Number, length: Number) -> Number:
    """μ = (Rw²/E*²z₀³)^(1/3), z₀ the equilibrium distance (m). D. Tabor, J. Colloid Interface Sci. 58, 2–13 (1977)."""
    check(radius=radius, contact_modulus=contact_modulus, length=length)
    return np.cbrt(radius * np.asarray(work_of_adhesion) ** 2 / (np.asarray(contact_modulus) ** 2 * length**3))


def maugis_parameter(
    radius: Number, contact_modulus: Number, work_of_adhesion: Number, peak_tensile_stress: Number
) -> Number:
    """λ = 2σ₀ (9R/16πwE*²)^(1/3). D. Maugis, J. Colloid Interface Sci. 150, 243–269 (1992).

    With the peak of a 9-3 law for the constant tension σ₀ (Pa) this is 1.1570 μ, with that of the 10-4 law 2.125 μ.
    """
    check(radius=radius, contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion)
    scale = np.cbrt(9 * radius / (16 * np.pi * np.asarray(work_of_adhesion) * np.asarray(contact_modulus) ** 2))
    return 2 * peak_tensile_stress * scale


def maugis_of_tabor(tabor: Number, relative_strength: Number = _STRENGTH_9_3) -> Number:
    """Convert a Tabor parameter μ into Maugis' λ.

    λ = 2 (9/16π)^(1/3) (σ₀z₀/w) μ; source as :func:`maugis_parameter`.

    Parameters
    ----------
    tabor : float or array
        μ of :func:`tabor_parameter`.
    relative_strength : float or array, optional
        σ₀z₀/w, the strength over the work of adhesion per length z₀ of the Tabor parameter. The default, 16/(9√3), is
        that of the 9-3 law and makes λ = 1.1570 μ; 1 is that of Dugdale's law with z₀ its range, λ = 1.1272 μ.

    Returns
    -------
    float or array

    Raises
    ------
    ValueError
        If a number is not positive and finite.

    Examples
    --------
    >>> from theory import maugis_of_tabor
    >>> f"{maugis_of_tabor(1.0):.4f}"
    '1.1570'
    """
    check(tabor=tabor, relative_strength=relative_strength)
    return _SCALE * relative_strength * tabor


def tabor_of_maugis(maugis_parameter: Number, relative_strength: Number = _STRENGTH_9_3) -> Number:
    """Convert Maugis' λ into a Tabor parameter μ, the inverse of :func:`maugis_of_tabor`.

    Parameters
    ----------
    maugis_parameter : float or array
        λ of :func:`maugis_parameter`.
    relative_strength : float or array, optional
        As for :func:`maugis_of_tabor`.

    Returns
    -------
    float or array

    Raises
    ------
    ValueError
        If a number is not positive and finite.

    Examples
    --------
    >>> from theory import tabor_of_maugis
    >>> f"{tabor_of_maugis(1.1570):.3f}"
    '1.000'
    """
    check(maugis_parameter=maugis_parameter, relative_strength=relative_strength)
    return maugis_parameter / (_SCALE * relative_strength)
