"""The gap fields of the simulations at one state, read one at a time from their files."""

from dataclasses import dataclass

import numpy as np

from contact_study.comparison.compute.cases import case_points, first_constant, select
from contact_study.comparison.compute.shown_states import PanelPoints
from contact_study.comparison.models import entry_of
from contact_study.comparison.read.datasets import Inputs
from contact_study.comparison.read.files import field_at
from contact_study.comparison.read.path_points import AVERAGED


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


def read_gap_maps(inputs: Inputs, shown: PanelPoints, seed: int | None) -> GapMaps | None:
    """The maps at the state common to the figures; None where no simulation kept its fields or is in contact."""
    hard_wall = not any(case.law.attracts for case in inputs.cases_at(shown.case.selection))
    distance = 0.0 if hard_wall else first_constant(inputs.models, shown.case, "contact_distance")
    gaps, size = {}, (0.0, 0.0)
    for model in inputs.simulations:
        part = select(inputs.models[model], shown.case)
        if part is None or "y" not in part or shown.common not in (path := case_points(part, inputs.control)):
            continue
        step = path.index(shown.common)
        selection = dict(shown.case.selection)
        if AVERAGED in part.dims:
            if seed is None:
                continue
            selection[AVERAGED] = seed
        # Smaller cells of a sweep are padded to the points of the largest.
        y, x = (part[axis].values[np.isfinite(part[axis].values)] for axis in ("y", "x"))
        stored = field_at(inputs.paths[entry_of(model).file], "gap", selection, step)
        if stored is None or not np.isfinite(gap := stored[: y.size, : x.size]).all():
            continue
        pressure = field_at(inputs.paths[entry_of(model).file], "pressure", selection, step) if hard_wall else None
        touching = gap <= distance if pressure is None else pressure[: y.size, : x.size] > 0
        gaps[model] = np.ma.masked_array(gap, touching)
        size = y.size * float(y[1] - y[0]), x.size * float(x[1] - x[0])
    return GapMaps(gaps, size, distance) if gaps else None
