"""A paraboloid of radius R on a half-space of contact modulus E*, with the work of adhesion w.

Hertz: no adhesion. JKR: adhesion of no range, for a large Tabor parameter. DMT: adhesion outside a contact of Hertz's
shape, for a small one. Maugis: a constant tension up to a finite range, from the one limit to the other.
"""

import numpy as np
from scipy.optimize import minimize_scalar

Number = float | np.ndarray


def hertz_contact_radius(force: Number, radius: Number, contact_modulus: Number) -> Number:
    """a = (3FR/4E*)^(1/3) (m). H. Hertz, J. reine angew. Math. 92, 156 (1882).

    Parameters
    ----------
    force : float or numpy.ndarray
        F >= 0 (N).
    radius, contact_modulus : float or numpy.ndarray
        R (m) and E* (Pa).

    Raises
    ------
    ValueError
        If the force pulls, or a radius or modulus is not positive.
    """
    _check("force", force, least=0.0)
    _positive(radius=radius, contact_modulus=contact_modulus)
    return np.cbrt(3 * np.asarray(force) * radius / (4 * np.asarray(contact_modulus)))


def hertz_approach(force: Number, radius: Number, contact_modulus: Number) -> Number:
    """δ = a²/R (m); arguments and source as :func:`hertz_contact_radius`."""
    return hertz_contact_radius(force, radius, contact_modulus) ** 2 / radius


def hertz_pressure(distance: Number, force: Number, radius: Number, contact_modulus: Number) -> np.ndarray:
    """p = (2E*a/πR) √(1 − r²/a²), zero outside (Pa), at the distance r from the axis (m).

    Other arguments and source as :func:`hertz_contact_radius`.
    """
    a = hertz_contact_radius(force, radius, contact_modulus)
    peak = 2 * contact_modulus * a / (np.pi * radius)
    return peak * np.sqrt(np.clip(1 - (np.asarray(distance) / a) ** 2, 0, None))


def jkr_contact_radius(force: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """a³ = (3R/4E*)[F + 3πwR + √(6πwRF + 9π²w²R²)], the stable branch (m).

    K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301–313 (1971). Tabor parameter above about 3.

    Parameters
    ----------
    force : float or numpy.ndarray
        F, no lower than the pull-off (N).
    radius, contact_modulus : float or numpy.ndarray
        R (m) and E* (Pa).
    work_of_adhesion : float or numpy.ndarray
        w >= 0 (J/m²).

    Raises
    ------
    ValueError
        If the force is below the pull-off, or another number is not possible.
    """
    _positive(radius=radius, contact_modulus=contact_modulus)
    wpr = 3 * np.pi * np.asarray(_check("work_of_adhesion", work_of_adhesion, least=0.0)) * radius
    _check("force", force, least=-0.5 * wpr)
    cube = 3 * radius / (4 * np.asarray(contact_modulus)) * (force + wpr + np.sqrt(2 * wpr * force + wpr**2))
    return np.cbrt(cube)


def jkr_approach(contact_radius: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """δ = a²/R − √(2πwa/E*) (m), at the contact radius a (m); others and source as :func:`jkr_contact_radius`."""
    _positive(radius=radius, contact_modulus=contact_modulus)
    crack = np.sqrt(2 * np.pi * np.asarray(work_of_adhesion) * contact_radius / contact_modulus)
    return np.asarray(contact_radius) ** 2 / radius - crack


def jkr_pull_off_force(radius: Number, work_of_adhesion: Number) -> Number:
    """F = −(3/2)πwR under force control (N); arguments and source as :func:`jkr_contact_radius`."""
    return -1.5 * np.pi * work_of_adhesion * radius


def dmt_contact_radius(force: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """Hertz's under F + 2πwR (m); arguments as :func:`jkr_contact_radius`. Tabor parameter below about 0.1.

    B. V. Derjaguin, V. M. Muller, Y. P. Toporov, J. Colloid Interface Sci. 53, 314 (1975).
    """
    return hertz_contact_radius(force - dmt_pull_off_force(radius, work_of_adhesion), radius, contact_modulus)


def dmt_pull_off_force(radius: Number, work_of_adhesion: Number) -> Number:
    """F = −2πwR (N); arguments and source as :func:`dmt_contact_radius`."""
    return -2 * np.pi * np.asarray(work_of_adhesion) * radius


def tabor_parameter(radius: Number, contact_modulus: Number, work_of_adhesion: Number, length: Number) -> Number:
    """μ = (Rw²/E*²z₀³)^(1/3). D. Tabor, J. Colloid Interface Sci. 58, 2–13 (1977).

    Parameters
    ----------
    radius, contact_modulus, work_of_adhesion : float or numpy.ndarray
        R (m), E* (Pa) and w (J/m²).
    length : float or numpy.ndarray
        z₀, the equilibrium distance of the law (m).
    """
    _positive(radius=radius, contact_modulus=contact_modulus, length=length)
    return np.cbrt(radius * np.asarray(work_of_adhesion) ** 2 / (np.asarray(contact_modulus) ** 2 * length**3))


def maugis_parameter(
    radius: Number, contact_modulus: Number, work_of_adhesion: Number, peak_tensile_stress: Number
) -> Number:
    """λ = 2σ₀ (9R/16πwE*²)^(1/3). D. Maugis, J. Colloid Interface Sci. 150, 243–269 (1992).

    With the peak of a 9-3 law for σ₀ this is 1.1570 μ, with that of the 10-4 law 2.125 μ.

    Parameters
    ----------
    radius, contact_modulus, work_of_adhesion : float or numpy.ndarray
        R (m), E* (Pa) and w (J/m²).
    peak_tensile_stress : float or numpy.ndarray
        σ₀, the constant tension (Pa).
    """
    _positive(radius=radius, contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion)
    scale = np.cbrt(9 * radius / (16 * np.pi * np.asarray(work_of_adhesion) * np.asarray(contact_modulus) ** 2))
    return 2 * peak_tensile_stress * scale


def maugis_dugdale_contact(maugis_parameter: float, zone: Number) -> tuple[np.ndarray, np.ndarray]:
    """Load and contact radius along the curve of equilibrium, from the width of the process zone.

    Parameters
    ----------
    maugis_parameter : float
        λ > 0, see :func:`maugis_parameter`, also for the source.
    zone : float or numpy.ndarray
        m − 1 > 0, with m = c/a the outer over the inner radius of the zone.

    Returns
    -------
    load : numpy.ndarray
        F in units of πwR.
    contact_radius : numpy.ndarray
        a in units of (3πwR²/4E*)^(1/3).
    """
    _positive(maugis_parameter=maugis_parameter, zone=zone)
    m = 1 + np.asarray(zone)
    root, angle = np.sqrt(m**2 - 1), np.arccos(1 / m)
    quadratic = maugis_parameter / 2 * (root + (m**2 - 2) * angle)
    linear = 4 * maugis_parameter**2 / 3 * (root * angle - m + 1)
    a = 2 / (linear + np.sqrt(linear**2 + 4 * quadratic))
    return a**3 - maugis_parameter * a**2 * (root + m**2 * angle), a


def maugis_dugdale_pull_off(maugis_parameter: float) -> float:
    """−F/πwR at pull-off under force control: the least load of :func:`maugis_dugdale_contact`."""
    found = minimize_scalar(
        lambda logarithm: float(maugis_dugdale_contact(maugis_parameter, np.exp(logarithm))[0]),
        bounds=(-12, 12),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return -float(found.fun)


def _positive(**numbers: Number) -> None:
    for name, value in numbers.items():
        _check(name, value)


def _check(name: str, value: Number, least: Number | None = None) -> Number:
    """The value, if it is finite, and positive or no less than something."""
    given = np.asarray(value, dtype=float)
    sound = given > 0 if least is None else given >= least
    if not np.all(np.isfinite(given) & sound):
        bound = "positive" if least is None else f"at least {float(np.min(least)):g}"
        raise ValueError(f"{name} = {value!r}: must be finite and {bound}")
    return value
