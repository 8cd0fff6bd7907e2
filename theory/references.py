"""Contacts with analytic solutions, to hold a calculation against: a paraboloid, and waves in one and two directions.

All in SI, compression positive; arguments are numbers or arrays, and a ValueError names one that is not possible. A
paraboloid of radius R (m) is pressed on a half-space of contact modulus E* (Pa) by a force F (N), with the work of
adhesion w (J/m²). Waves are h cos(2πx/λ), and Δ cos(2πx/λ) cos(2πy/λ), an egg box.
"""

import numpy as np
from scipy.optimize import minimize_scalar

Number = float | np.ndarray

__all__ = [
    "dmt_contact_radius",
    "dmt_pull_off_force",
    "egg_box_full_contact_pressure",
    "egg_box_heavy_area",
    "egg_box_light_area",
    "hertz_approach",
    "hertz_contact_radius",
    "hertz_pressure",
    "jkr_approach",
    "jkr_contact_radius",
    "jkr_pull_off_force",
    "maugis_dugdale_contact",
    "maugis_dugdale_pull_off",
    "maugis_parameter",
    "tabor_parameter",
    "wave_adhesion",
    "wave_full_contact_pressure",
    "wave_relative_area",
    "wave_relative_mean_gap",
    "wave_relative_pressure",
]


def hertz_contact_radius(force: Number, radius: Number, contact_modulus: Number) -> Number:
    """a = (3FR/4E*)^(1/3) (m), F >= 0. H. Hertz, J. reine angew. Math. 92, 156 (1882)."""
    _check(0.0, force=force)
    _check(radius=radius, contact_modulus=contact_modulus)
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

    K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301–313 (1971). Tabor parameter above about 3; the
    force F is no lower than the pull-off.
    """
    _check(radius=radius, contact_modulus=contact_modulus)
    _check(0.0, work_of_adhesion=work_of_adhesion)
    wpr = 3 * np.pi * np.asarray(work_of_adhesion) * radius
    _check(-0.5 * wpr, force=force)
    cube = 3 * radius / (4 * np.asarray(contact_modulus)) * (force + wpr + np.sqrt(2 * wpr * force + wpr**2))
    return np.cbrt(cube)


def jkr_approach(contact_radius: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """δ = a²/R − √(2πwa/E*) (m), at the contact radius a (m); others and source as :func:`jkr_contact_radius`."""
    _check(radius=radius, contact_modulus=contact_modulus)
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
    """μ = (Rw²/E*²z₀³)^(1/3), z₀ the equilibrium distance (m). D. Tabor, J. Colloid Interface Sci. 58, 2–13 (1977)."""
    _check(radius=radius, contact_modulus=contact_modulus, length=length)
    return np.cbrt(radius * np.asarray(work_of_adhesion) ** 2 / (np.asarray(contact_modulus) ** 2 * length**3))


def maugis_parameter(
    radius: Number, contact_modulus: Number, work_of_adhesion: Number, peak_tensile_stress: Number
) -> Number:
    """λ = 2σ₀ (9R/16πwE*²)^(1/3). D. Maugis, J. Colloid Interface Sci. 150, 243–269 (1992).

    With the peak of a 9-3 law for the constant tension σ₀ (Pa) this is 1.1570 μ, with that of the 10-4 law 2.125 μ.
    """
    _check(radius=radius, contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion)
    scale = np.cbrt(9 * radius / (16 * np.pi * np.asarray(work_of_adhesion) * np.asarray(contact_modulus) ** 2))
    return 2 * peak_tensile_stress * scale


def maugis_dugdale_contact(maugis_parameter: float, zone: Number) -> tuple[np.ndarray, np.ndarray]:
    """F/πwR and a/(3πwR²/4E*)^(1/3) along the curve of equilibrium, from the width of the process zone.

    λ > 0 is that of :func:`maugis_parameter`, also for the source; the zone is m − 1 > 0 with m = c/a, its outer over
    its inner radius.
    """
    _check(maugis_parameter=maugis_parameter, zone=zone)
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


def _check(least: Number | None = None, **numbers: Number) -> None:
    """Refuse numbers that are not finite, or not positive, or less than something if that is given."""
    for name, value in numbers.items():
        given = np.asarray(value, dtype=float)
        if not np.all(np.isfinite(given) & (given > 0 if least is None else given >= least)):
            bound = "positive" if least is None else f"at least {float(np.min(least)):g}"
            raise ValueError(f"{name} = {value!r}: must be finite and {bound}")


def wave_full_contact_pressure(amplitude: Number, wavelength: Number, contact_modulus: Number) -> Number:
    """p* = πE*h/λ (Pa), which closes the wave. H. M. Westergaard, J. Appl. Mech. 6, A49–A53 (1939)."""
    return np.pi * contact_modulus * amplitude / wavelength


def wave_relative_area(relative_pressure: Number) -> np.ndarray:
    """2a/λ = (2/π) arcsin √(p/p*) without adhesion, from p/p*; the same source."""
    return 2 / np.pi * np.arcsin(np.sqrt(_share("relative_pressure", relative_pressure)))


def wave_relative_pressure(relative_area: Number, adhesion: Number = 0.0) -> np.ndarray:
    """p/p* = sin²(πa/λ) − α √tan(πa/λ), short-range adhesion α.

    From 2a/λ and α, see :func:`wave_adhesion`. K. L. Johnson, Int. J. Solids Struct. 32, 423–430 (1995),
    doi:10.1016/0020-7683(94)00111-9.
    """
    angle = np.pi * _share("relative_area", relative_area) / 2
    return np.sin(angle) ** 2 - adhesion * np.sqrt(np.tan(angle))


def wave_adhesion(amplitude: Number, wavelength: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """α = √(2wλ/π²E*h²); source as :func:`wave_relative_pressure`.

    The wave snaps into full contact without load for α > 0.57.
    """
    return np.sqrt(2 * work_of_adhesion * wavelength / (np.pi**2 * contact_modulus * amplitude**2))


def wave_relative_mean_gap(relative_area: Number, relative_pressure: Number) -> np.ndarray:
    """ū/h = cos²(πa/λ) + 2(p/p*) ln sin(πa/λ) with or without adhesion; source as :func:`wave_relative_pressure`."""
    angle = np.pi * _share("relative_area", relative_area) / 2
    return np.cos(angle) ** 2 + 2 * relative_pressure * np.log(np.sin(angle))


def egg_box_full_contact_pressure(amplitude: Number, wavelength: Number, contact_modulus: Number) -> Number:
    """p* = √2 πE*Δ/λ (Pa). K. L. Johnson, J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27, 383–396 (1985)."""
    return np.sqrt(2) * np.pi * contact_modulus * amplitude / wavelength


def egg_box_light_area(relative_pressure: Number) -> np.ndarray:
    """A/A₀ = π(3p/8πp*)^(2/3) for p ≪ p*: Hertz on each of the two summits of a cell; the same source."""
    return np.pi * np.cbrt(3 * _share("relative_pressure", relative_pressure) / (8 * np.pi)) ** 2


def egg_box_heavy_area(relative_pressure: Number) -> np.ndarray:
    """A/A₀ = 1 − (3/2π)(1 − p/p*) for p → p*: a pressurised penny-shaped crack at each hollow; the same source."""
    return 1 - 3 / (2 * np.pi) * (1 - _share("relative_pressure", relative_pressure))


def _share(name: str, value: Number) -> np.ndarray:
    given = np.asarray(value, dtype=float)
    if not np.all((given >= 0) & (given <= 1)):
        raise ValueError(f"{name} = {value!r}: must lie between 0 and 1")
    return given
