"""Contacts with analytic solutions, to hold a calculation against: a paraboloid, and waves in one and two directions.

All in SI, compression positive; arguments are numbers or arrays, and a ValueError names one that is not possible. A
paraboloid of radius R (m) is pressed on a half-space of contact modulus E* (Pa) by a force F (N), with the work of
adhesion w (J/m²). Waves are h cos(2πx/λ), and Δ cos(2πx/λ) cos(2πy/λ), an egg box.
"""

import numpy as np

from contact_study.physics.spheres.base import Number
from contact_study.physics.spheres.dmt import dmt_contact_radius, dmt_pull_off_force
from contact_study.physics.spheres.hertz import hertz_approach, hertz_contact_radius, hertz_pressure
from contact_study.physics.spheres.jkr import jkr_approach, jkr_contact_radius, jkr_pull_off_force
from contact_study.physics.spheres.maugis import maugis_dugdale_contact, maugis_dugdale_pull_off
from contact_study.physics.spheres.numbers import maugis_parameter, tabor_parameter

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
