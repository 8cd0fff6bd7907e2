"""The band between the two metastable branches of the gap-flow theory, as arrays to shade."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contact_study.comparison.cases import SweepPoint, select, series
from contact_study.comparison.plotted import Scales


@dataclass(frozen=True)
class Band:
    """What the two metastable branches of the gap-flow theory enclose at one point of the sweep.

    Attributes
    ----------
    colour : int
        Number of the colour.
    along : numpy.ndarray
        Increasing pressures, in the units of the figure.
    low, high : numpy.ndarray
        The enclosed quantity.
    """

    colour: int
    along: np.ndarray
    low: np.ndarray
    high: np.ndarray


def contact_area_bands(branches: Mapping[str, xr.Dataset], points: list[SweepPoint], unit: float) -> list[Band]:
    """Contact area between the branches, over pressure in units of ``unit`` (Pa)."""
    return _bands(branches, points, "relative_contact_area", lambda pressure, area: (pressure / unit, area))


def mean_gap_bands(
    branches: Mapping[str, xr.Dataset], points: list[SweepPoint], units: Mapping[str, Scales]
) -> list[Band]:
    """Mean gap in units of h_rms between the branches, over ln(p/E*)."""
    bands = []
    for number, point in enumerate(points):
        unit = units[point.label]

        def scaled(pressure: np.ndarray, gap: np.ndarray, unit: Scales = unit) -> tuple[np.ndarray, np.ndarray]:
            positive = np.where(pressure > 0, pressure, np.nan)
            return np.log(positive / unit.contact_modulus), gap / unit.rms_height

        bands += [replace(band, colour=number) for band in _bands(branches, [point], "mean_gap", scaled)]
    return bands


def _bands(
    branches: Mapping[str, xr.Dataset],
    points: list[SweepPoint],
    name: str,
    scaled: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
) -> list[Band]:
    if len(branches) < 2:
        return []
    bands = []
    for colour, point in enumerate(points):
        parts = [select(branches[side], point) for side in ("loading", "unloading")]
        if any(part is None for part in parts):
            continue
        pressure, *_ = (series(part, "mean_pressure").values for part in parts if part is not None)
        found = [series(part, name) for part in parts if part is not None]
        good = found[0].fit & found[1].fit
        along, one = scaled(pressure[good], found[0].values[good])
        _, two = scaled(pressure[good], found[1].values[good])
        _, order = np.unique(along, return_index=True)
        order = order[np.isfinite(along[order])]
        bands.append(Band(colour, along[order], np.minimum(one, two)[order], np.maximum(one, two)[order]))
    return bands
