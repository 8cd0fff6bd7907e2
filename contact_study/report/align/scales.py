"""Units of the figures' and tables' axes at each point of the sweep."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.plots.style import Unit, length_unit, pressure_unit
from contact_study.report.align.cases import SweepPoint, first_constant, sweep_points


@dataclass(frozen=True)
class Scales:
    """Units of the axes at one point of the sweep, the same for every model."""

    contact_modulus: float  # E* (Pa)
    rms_height: float  # h_rms (m), or one nanometre for a surface without roughness
    rough: bool = True

    @property
    def height_symbol(self) -> str:
        """Unit of gaps in words."""
        return "h_rms" if self.rough else "nm"


def scales(models: Mapping[str, xr.Dataset], point: SweepPoint) -> Scales:
    """E* and h_rms of a point of the sweep, as the continuum was given them."""
    rms_height = first_constant(models, point, "rms_height")
    rough = bool(np.isfinite(rms_height) and rms_height > 0)
    return Scales(first_constant(models, point, "contact_modulus"), rms_height if rough else 1e-9, rough)


def common_scales(models: Mapping[str, xr.Dataset]) -> tuple[bool, bool]:
    """Whether E*, and whether h_rms, is the same at every point of the sweep."""
    every = [scales(models, point) for point in sweep_points(models)]
    return (
        all(math.isclose(one.contact_modulus, every[0].contact_modulus) for one in every),
        all(math.isclose(one.rms_height, every[0].rms_height) for one in every),
    )


def mean_pressure_unit(models: Mapping[str, xr.Dataset]) -> Unit:
    """The unit of mean pressures."""
    return pressure_unit(_largest(models, "mean_pressure"))


def mean_gap_unit(models: Mapping[str, xr.Dataset]) -> Unit:
    """The unit of mean gaps."""
    return length_unit(_largest(models, "mean_gap"))


def _largest(models: Mapping[str, xr.Dataset], name: str) -> float:
    values = np.concatenate([np.empty(0), *(d[name].values.ravel() for d in models.values() if name in d)])
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
