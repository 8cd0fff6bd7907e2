"""The power spectrum of many measurements as a dataset, which studies and theories read."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.inputs.units import length
from contact_study.physics.roughness.combination import BOUNDS, CombinedSpectrum, combine_spectra
from contact_study.physics.roughness.measurement import REASONS, spectrum_of_measurement
from contact_study.results.schema import CONVENTIONS
from contact_study.study.schema.measurement import read_measurements
from contact_study.version import __version__

_NONE = -1  # flag of a band that a measurement does not have
_SOURCES = (
    "T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr.: Metrol. Prop. 5, 013001 (2017), "
    "doi:10.1088/2051-672X/aa51f8\n"
    "A. Sanner et al., Appl. Surf. Sci. Adv. 7, 100190 (2022), doi:10.1016/j.apsadv.2021.100190"
)


def measured_spectrum(files: Sequence[Path | str], rule: str = "abel", **keys: Any) -> xr.Dataset:
    """Combine measurements of one surface into one isotropic power spectrum with bounds.

    Parameters
    ----------
    files : sequence of path-like
        Maps, line scans, containers (``.zip``), and lists of them (TOML with tables ``[[measurement]]``).
    rule : {"abel", "approximate"}, optional
        Conversion of line scans: inverse Abel transform, or C = C_1D / 2q, which for H = 0.8 is 15 % too low.
    **keys
        Keys of all files that are no list, such as ``height_unit="nm"`` or ``tip_radius="10 nm"``.

    Returns
    -------
    xarray.Dataset
        ``power_spectrum`` with ``power_spectrum_lower`` and ``_upper`` on ``wavevector``; ``measured_spectrum`` with
        flags, on ``measurement`` and ``band``; what was left out in the attribute ``warnings``.

    Raises
    ------
    InputError
        If a file cannot be read, a unit is missing or nothing is reliable.

    Examples
    --------
    >>> import contact_study
    >>> dataset = contact_study.measured_spectrum(["afm.nc", "stylus.csv"])  # doctest: +SKIP
    >>> dataset.to_netcdf("surface_psd.nc")  # doctest: +SKIP
    """
    measurements, notes = read_measurements(files, keys)
    parts = [spectrum_of_measurement(one, rule) for one in measurements]
    notes += [
        f"{part.measurement.name} is not reliable at any wavelength above {length(part.shortest)} ({part.limit})"
        for part in parts
        if not part.reliable.wavevector.size
    ]
    found = combine_spectra(parts)
    for low, high in found.gaps:
        ends = length(2 * np.pi / high), length(2 * np.pi / low)
        notes.append(
            f"no measurement is reliable at wavelengths between {ends[0]} and {ends[1]}: there C(q) is a power law "
            "between its neighbours, and has no bounds"
        )
    return _dataset(found, notes)


def _dataset(found: CombinedSpectrum, notes: Sequence[str]) -> xr.Dataset:
    lower, upper = found.bounds
    each = [part.measurement for part in found.parts]
    bands = max(part.bands.wavevector.size for part in found.parts)

    def padded(column: int, fill: float) -> np.ndarray:
        rows = [np.asarray(part.bands[column]) for part in found.parts]
        return np.array([np.pad(row, (0, bands - row.size), constant_values=fill) for row in rows])

    by_measurement, by_band, by_wave = "measurement", ("measurement", "band"), "wavevector"
    nan = float("nan")
    spread = f"standard error of ln C with the spread between measurements, bounds are {BOUNDS:g} of it away"
    flags = {
        "long_name": "whether a band is reliable, and if not why",
        "flag_values": np.arange(_NONE, len(REASONS), dtype="i1"),
        "flag_meanings": " ".join(word.replace(" ", "_") for word in ("none", *REASONS)),
    }
    return xr.Dataset(
        {
            "power_spectrum": (by_wave, found.density, _about("m4", "isotropic power spectrum C(q) of the surface")),
            "power_spectrum_lower": (by_wave, lower, _about("m4", "lower bound of C(q)")),
            "power_spectrum_upper": (by_wave, upper, _about("m4", "upper bound of C(q)")),
            "standard_error": (by_wave, found.error, _about("1", spread)),
            "statistical_error": (
                by_wave,
                found.statistical_error,
                _about("1", "standard error of ln C by the number of independent waves"),
            ),
            "measurements": (by_wave, found.measurements, _about("1", "number of measurements reliable in the band")),
            "spread": ((), found.spread, _about("1", "standard deviation of ln C between measurements")),
            "measured_wavevector": (by_band, padded(0, nan), _about("m-1", "wavevector of a band of a measurement")),
            "measured_spectrum": (by_band, padded(1, nan), _about("m4", "C(q) of a measurement")),
            "measured_error": (by_band, np.sqrt(padded(2, nan)), _about("1", "statistical error of its ln C")),
            "measured_flag": (by_band, padded(3, _NONE).astype("i1"), flags),
            "shortest_wavelength": (
                by_measurement,
                [part.shortest for part in found.parts],
                _about("m", "shortest reliable wavelength"),
            ),
            "limited_by": (by_measurement, [part.limit for part in found.parts], {"long_name": "what limits it"}),
            "kind": (by_measurement, [one.kind for one in each], {"long_name": "map or line scan"}),
            "window": (by_measurement, [one.window for one in each], {"long_name": "window against edges"}),
            "instrument": (by_measurement, [one.instrument for one in each], {"long_name": "instrument"}),
            "source": (by_measurement, [one.source for one in each], {"long_name": "SHA-256 of the file"}),
            "doi": (by_measurement, [one.doi for one in each], {"long_name": "digital object identifier"}),
        },
        coords={
            "wavevector": (by_wave, found.wavevectors, _about("m-1", "roughness wavevector q")),
            "measurement": (by_measurement, [one.name for one in each], {"long_name": "measurement"}),
        },
        attrs={
            "Conventions": CONVENTIONS,
            "title": "power spectrum of a surface from several measurements",
            "source": f"bem-adhesion {__version__}",
            "references": _SOURCES,
            "convention": "h_rms² = 2π ∫ q C dq; 1/(4π²) of the isotropic 2-D spectrum of Jacobs et al. (2017)",
            "warnings": "\n".join(notes),
        },
    )


def _about(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}
