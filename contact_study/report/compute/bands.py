"""The band between the two metastable branches of a theory, as arrays to shade."""

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contact_study.report.compute.cases import SweepPoint, select, series
from contact_study.report.compute.scales import Scales

_VISIBLE = 2e-3  # of the quantity: a dot of the figures


@dataclass(frozen=True)
class Band:
    """What the two metastable branches of a theory enclose at one point of the sweep.

    Attributes
    ----------
    model : str
        Name of the theory's entry.
    colour : int
        Number of the colour.
    along : numpy.ndarray
        Increasing pressures, in the units of the figure.
    low, high : numpy.ndarray
        The enclosed quantity.
    """

    model: str
    colour: int
    along: np.ndarray
    low: np.ndarray
    high: np.ndarray


def contact_area_bands(
    branches: Mapping[str, Mapping[str, xr.Dataset]], points: list[SweepPoint], unit: float
) -> list[Band]:
    """Contact area between the branches, over pressure in units of ``unit`` (Pa)."""
    return _bands(branches, points, "relative_contact_area", lambda pressure, area: (pressure / unit, area))


def mean_gap_bands(
    branches: Mapping[str, Mapping[str, xr.Dataset]],
    points: list[SweepPoint],
    units: Mapping[str, Scales],
    linear: bool = False,
) -> list[Band]:
    """Mean gap in units of h_rms between the branches, over ln(p/E*), or over p/E* if ``linear``."""
    bands = []
    for number, point in enumerate(points):
        unit = units[point.label]

        def scaled(pressure: np.ndarray, gap: np.ndarray, unit: Scales = unit) -> tuple[np.ndarray, np.ndarray]:
            if linear:
                return pressure / unit.contact_modulus, gap / unit.rms_height
            positive = np.where(pressure > 0, pressure, np.nan)
            return np.log(positive / unit.contact_modulus), gap / unit.rms_height

        bands += [replace(band, colour=number) for band in _bands(branches, [point], "mean_gap", scaled)]
    return bands


def _bands(
    branches: Mapping[str, Mapping[str, xr.Dataset]],
    points: list[SweepPoint],
    name: str,
    scaled: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
) -> list[Band]:
    bands = []
    for model, (colour, point) in itertools.product(branches, enumerate(points)):
        parts = [select(dataset, point) for dataset in branches[model].values()]
        if len(parts) < 2 or any(part is None for part in parts):
            continue
        sides = [_side(part, name, scaled) for part in parts if part is not None]
        # Under a prescribed gap each branch has its own pressures; the band is where both have some.
        every = np.unique(np.concatenate([along for along, _ in sides]))
        if not all(along.size for along, _ in sides):
            continue
        shared = every[(every >= max(along[0] for along, _ in sides)) & (every <= min(along[-1] for along, _ in sides))]
        one, two = (np.interp(shared, along, values) for along, values in sides)
        # Without hysteresis the branches differ by the error of their grids, which is no band.
        if np.abs(one - two).max(initial=0.0) > _VISIBLE * max(np.abs(one).max(initial=0.0), 1e-300):
            bands.append(Band(model, colour, shared, np.minimum(one, two), np.maximum(one, two)))
    return bands


def _side(
    part: xr.Dataset, name: str, scaled: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
) -> tuple[np.ndarray, np.ndarray]:
    """Increasing pressures of one branch, and the quantity there, in the units of the figure."""
    pressure, found = series(part, "mean_pressure"), series(part, name)
    along, values = scaled(pressure.values[found.fit], found.values[found.fit])
    finite = np.isfinite(along) & np.isfinite(values)
    along, order = np.unique(along[finite], return_index=True)
    return along, values[finite][order]
