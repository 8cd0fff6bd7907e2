"""Contact problems with analytic solutions, in SI units, for the tests of every solver.

Pressures and forces are positive in compression, w is the work of adhesion, E* the contact modulus.
"""

import numpy as np
from scipy.optimize import minimize_scalar

# --- Paraboloid of radius R on a half-space -------------------------------------------------------------------


def hertz_contact_radius(force, radius, contact_modulus):
    """a = (3FR/4E*)^(1/3) (m). H. Hertz, J. reine angew. Math. 92, 156 (1882)."""
    return (3 * force * radius / (4 * contact_modulus)) ** (1 / 3)


def hertz_approach(force, radius, contact_modulus):
    """δ = a²/R (m), the same source."""
    return hertz_contact_radius(force, radius, contact_modulus) ** 2 / radius


def hertz_pressure(distance, force, radius, contact_modulus):
    """p = p0 √(1 − r²/a²), p0 = 2E*a/πR, zero outside (Pa), the same source."""
    a = hertz_contact_radius(force, radius, contact_modulus)
    peak = 2 * contact_modulus * a / (np.pi * radius)
    return peak * np.sqrt(np.clip(1 - (np.asarray(distance) / a) ** 2, 0, None))


def jkr_contact_radius(force, radius, contact_modulus, work_of_adhesion):
    """a³ = (3R/4E*)[F + 3πwR + √(6πwRF + 9π²w²R²)], the stable branch (m).

    K. L. Johnson, K. Kendall & A. D. Roberts, Proc. R. Soc. A 324, 301 (1971).
    """
    wpr = 3 * np.pi * work_of_adhesion * radius
    cube = 3 * radius / (4 * contact_modulus) * (force + wpr + np.sqrt(2 * wpr * force + wpr**2))
    return cube ** (1 / 3)


def jkr_approach(contact_radius, radius, contact_modulus, work_of_adhesion):
    """δ = a²/R − √(2πwa/E*) (m), the same source."""
    crack = np.sqrt(2 * np.pi * work_of_adhesion * contact_radius / contact_modulus)
    return contact_radius**2 / radius - crack


def jkr_pull_off_force(radius, work_of_adhesion):
    """F = −(3/2)πwR under force control (N), the same source."""
    return -1.5 * np.pi * work_of_adhesion * radius


def dmt_pull_off_force(radius, work_of_adhesion):
    """F = −2πwR (N). B. V. Derjaguin, V. M. Muller & Y. P. Toporov, J. Colloid Interface Sci. 53, 314 (1975)."""
    return -2 * np.pi * work_of_adhesion * radius


def tabor_parameter(radius, contact_modulus, work_of_adhesion, length):
    """μ = (Rw²/E*²z0³)^(1/3). D. Tabor, J. Colloid Interface Sci. 58, 2 (1977)."""
    return (radius * work_of_adhesion**2 / (contact_modulus**2 * length**3)) ** (1 / 3)


def maugis_parameter(radius, contact_modulus, work_of_adhesion, peak_tensile_stress):
    """λ = 2σ0 (9R/16πwE*²)^(1/3). D. Maugis, J. Colloid Interface Sci. 150, 243 (1992).

    With the peak of a 9-3 law for σ0 this is 1.1570 μ, with that of the 10-4 law 2.125 μ.
    """
    return 2 * peak_tensile_stress * (9 * radius / (16 * np.pi * work_of_adhesion * contact_modulus**2)) ** (1 / 3)


def maugis_dugdale_pull_off(maugis_parameter):
    """−F/πwR at pull-off under force control, a constant tension up to a finite range; the same source.

    The load and the contact radius are given in terms of m = c/a, the outer over the inner radius of the process
    zone; the pull-off force is the least load over all m > 1. Units: πwR for the load, (3πwR²/4E*)^(1/3) for a.
    """
    lam = maugis_parameter

    def load(log_excess):
        m = 1 + np.exp(log_excess)
        root, angle = np.sqrt(m**2 - 1), np.arccos(1 / m)
        quadratic = lam / 2 * (root + (m**2 - 2) * angle)
        linear = 4 * lam**2 / 3 * (root * angle - m + 1)
        a = 2 / (linear + np.sqrt(linear**2 + 4 * quadratic))
        return a**3 - lam * a**2 * (root + m**2 * angle)

    return -minimize_scalar(load, bounds=(-12, 12), method="bounded", options={"xatol": 1e-10}).fun


# --- One-dimensional wave h cos(2πx/λ), peak to valley 2h ------------------------------------------------------


def wave_full_contact_pressure(amplitude, wavelength, contact_modulus):
    """p* = πE*h/λ (Pa), which closes the wave. H. M. Westergaard, J. Appl. Mech. 6, 49 (1939)."""
    return np.pi * contact_modulus * amplitude / wavelength


def wave_relative_area(relative_pressure):
    """2a/λ = (2/π) arcsin √(p/p*), without adhesion; the same source."""
    return 2 / np.pi * np.arcsin(np.sqrt(relative_pressure))


def wave_relative_pressure(relative_area, adhesion=0.0):
    """p/p* = sin²(πa/λ) − α√tan(πa/λ) at 2a/λ in contact, short-range adhesion α.

    α² = 2wλ/π²E*h², see :func:`wave_adhesion`. K. L. Johnson, Int. J. Solids Struct. 32, 423 (1995).
    """
    angle = np.pi * np.asarray(relative_area) / 2
    return np.sin(angle) ** 2 - adhesion * np.sqrt(np.tan(angle))


def wave_adhesion(amplitude, wavelength, contact_modulus, work_of_adhesion):
    """α = √(2wλ/π²E*h²); the same source. The wave snaps into full contact without load for α > 0.57."""
    return np.sqrt(2 * work_of_adhesion * wavelength / (np.pi**2 * contact_modulus * amplitude**2))


def wave_relative_mean_gap(relative_area, relative_pressure):
    """ū/h = cos²(πa/λ) + 2(p/p*) ln sin(πa/λ), with or without adhesion; the same source."""
    angle = np.pi * np.asarray(relative_area) / 2
    return np.cos(angle) ** 2 + 2 * relative_pressure * np.log(np.sin(angle))


# --- Two-dimensional wave Δ cos(2πx/λ) cos(2πy/λ) -------------------------------------------------------------


def egg_box_full_contact_pressure(amplitude, wavelength, contact_modulus):
    """p* = √2 πE*Δ/λ (Pa). K. L. Johnson, J. A. Greenwood & J. G. Higginson, Int. J. Mech. Sci. 27, 383 (1985)."""
    return np.sqrt(2) * np.pi * contact_modulus * amplitude / wavelength


def egg_box_light_area(relative_pressure):
    """A/A0 = π(3p/8πp*)^(2/3) for p ≪ p*: Hertz on each of the two summits of a cell; the same source."""
    return np.pi * (3 * relative_pressure / (8 * np.pi)) ** (2 / 3)


def egg_box_heavy_area(relative_pressure):
    """A/A0 = 1 − (3/2π)(1 − p/p*) for p → p*: a pressurised penny-shaped crack at each hollow; the same source."""
    return 1 - 3 / (2 * np.pi) * (1 - relative_pressure)
