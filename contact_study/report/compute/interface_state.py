"""The interface of one dataset at one state, whole."""

import numpy as np
import xarray as xr

from contact_study.report.compute.gap_maps import located
from contact_study.report.compute.shown_states import PanelPoints
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.files import field_at


def read_interface_state(inputs: Inputs, shown: PanelPoints, seed: int | None) -> xr.Dataset | None:
    """Heights, gap and pressure at the state common to the figures, as :mod:`contact_study.plots` shows them.

    None unless there is one dataset, of a simulation that kept its fields and is in contact there.
    """
    if len(inputs.models) > 1 or not inputs.simulations:
        return None
    model = inputs.simulations[0]
    place = located(inputs, model, shown, seed)
    if place is None:
        return None
    part, selection, step = place
    state = part.isel(step=step)
    if inputs.average in part.dims:
        state = state.sel({inputs.average: seed})
    for name in ("gap", "pressure"):
        field = field_at(inputs.paths[entry_of(model).file], name, selection, step)
        if field is None or np.isinf(field).any() or not np.isfinite(field).any():
            return None
        state = state.assign({name: (("y", "x"), field)})
    return state if "height" in state else None
