"""Waves pressed on a half-space of contact modulus E*: h cos(2πx/λ), and Δ cos(2πx/λ) cos(2πy/λ), an egg box.

The one-dimensional wave is solved at every pressure, with and without adhesion of no range; of the egg box both limits
are known. Peak to valley they measure 2h and 2Δ.
"""

import numpy as np

Number = float | np.ndarray


def wave_full_contact_pressure(amplitude: Number, wavelength: Number, contact_modulus: Number) -> Number:
    """p* = πE*h/λ (Pa), which closes the wave. H. M. Westergaard, J. Appl. Mech. 6, A49–A53 (1939).

    Parameters
    ----------
    amplitude, wavelength : float or numpy.ndarray
        h and λ (m).
    contact_modulus : float or numpy.ndarray
        E* (Pa).
    """
    return np.pi * contact_modulus * amplitude / wavelength


def wave_relative_area(relative_pressure: Number) -> np.ndarray:
    """2a/λ = (2/π) arcsin √(p/p*) without adhesion; the same source.

    Parameters
    ----------
    relative_pressure : float or numpy.ndarray
        p/p* from 0 to 1.

    Raises
    ------
    ValueError
        If it is not.
    """
    given = _share("relative_pressure", relative_pressure)
    return 2 / np.pi * np.arcsin(np.sqrt(given))


def wave_relative_pressure(relative_area: Number, adhesion: Number = 0.0) -> np.ndarray:
    """p/p* = sin²(πa/λ) − α √tan(πa/λ), short-range adhesion α.

    K. L. Johnson, Int. J. Solids Struct. 32, 423–430 (1995), doi:10.1016/0020-7683(94)00111-9.

    Parameters
    ----------
    relative_area : float or numpy.ndarray
        2a/λ from 0 to 1.
    adhesion : float or numpy.ndarray, optional
        α, see :func:`wave_adhesion`.
    """
    angle = np.pi * _share("relative_area", relative_area) / 2
    return np.sin(angle) ** 2 - adhesion * np.sqrt(np.tan(angle))


def wave_adhesion(amplitude: Number, wavelength: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """α = √(2wλ/π²E*h²); source as :func:`wave_relative_pressure`.

    The wave snaps into full contact without load for α > 0.57.

    Parameters
    ----------
    amplitude, wavelength : float or numpy.ndarray
        h and λ (m).
    contact_modulus, work_of_adhesion : float or numpy.ndarray
        E* (Pa) and w (J/m²).
    """
    return np.sqrt(2 * work_of_adhesion * wavelength / (np.pi**2 * contact_modulus * amplitude**2))


def wave_relative_mean_gap(relative_area: Number, relative_pressure: Number) -> np.ndarray:
    """ū/h = cos²(πa/λ) + 2(p/p*) ln sin(πa/λ) with or without adhesion; source as :func:`wave_relative_pressure`.

    Parameters
    ----------
    relative_area, relative_pressure : float or numpy.ndarray
        2a/λ and p/p*.
    """
    angle = np.pi * _share("relative_area", relative_area) / 2
    return np.cos(angle) ** 2 + 2 * relative_pressure * np.log(np.sin(angle))


def egg_box_full_contact_pressure(amplitude: Number, wavelength: Number, contact_modulus: Number) -> Number:
    """p* = √2 πE*Δ/λ (Pa).

    K. L. Johnson, J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27, 383–396 (1985).

    Parameters
    ----------
    amplitude, wavelength : float or numpy.ndarray
        Δ and λ (m).
    contact_modulus : float or numpy.ndarray
        E* (Pa).
    """
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
