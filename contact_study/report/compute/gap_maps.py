"""The gap fields of the simulations at one state, read one at a time from their files."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from contact_study.plots.selection import touching
from contact_study.report.compute.cases import case_points, first_constant, select
from contact_study.report.compute.shown_states import PanelPoints
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.files import field_at


@dataclass(frozen=True)
class GapMaps:
    """Gap of each simulation that kept it, at one state.

    Attributes
    ----------
    gaps : dict
        Gap (y, x) of each model (m), masked where there is contact.
    size : tuple of float
        Lateral periods along y and x (m).
    contact_distance : float
        Where the colours of the gap begin (m): zero for a hard wall.
    """

    gaps: dict[str, np.ma.MaskedArray]
    size: tuple[float, float]
    contact_distance: float


def located(
    inputs: Inputs, model: str, shown: PanelPoints, seed: int | None
) -> tuple[xr.Dataset, dict[str, Any], int] | None:
    """Where a simulation keeps the state common to the figures; None where it has no such state in the plane.

    Returns
    -------
    part, selection, step
        Its dataset at the point of the sweep, the swept coordinates with the seed, the position on the path.
    """
    part = select(inputs.models[model], shown.case)
    if part is None or "y" not in part or shown.common not in (path := case_points(part, inputs.control)):
        return None
    selection = dict(shown.case.selection)
    if inputs.average in part.dims:
        if seed is None:
            return None
        selection[inputs.average] = seed
    return part, selection, path.index(shown.common)


def read_gap_maps(inputs: Inputs, shown: PanelPoints, seed: int | None) -> GapMaps | None:
    """The maps at the state common to the figures; None where no simulation kept its fields or is in contact."""
    distance = first_constant(inputs.models, shown.case, "contact_distance")
    gaps, size = {}, (0.0, 0.0)
    for model in inputs.simulations:
        place = located(inputs, model, shown, seed)
        if place is None:
            continue
        part, selection, step = place
        # Smaller cells of a sweep are padded to the points of the largest.
        y, x = (part[axis].values[np.isfinite(part[axis].values)] for axis in ("y", "x"))
        stored = {
            name: field_at(inputs.paths[entry_of(model).file], name, selection, step) for name in ("gap", "pressure")
        }
        fields = {name: (("y", "x"), field[: y.size, : x.size]) for name, field in stored.items() if field is not None}
        if "gap" not in fields or not np.isfinite(gap := fields["gap"][1]).all():
            continue
        own = first_constant({model: inputs.models[model]}, shown.case, "contact_distance")
        gaps[model] = np.ma.masked_array(gap, touching(xr.Dataset({**fields, "contact_distance": own})))
        size = y.size * float(y[1] - y[0]), x.size * float(x[1] - x[0])
    return GapMaps(gaps, size, distance) if gaps else None
