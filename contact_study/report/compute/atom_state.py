"""The atoms of one state, read from their file."""

import numpy as np
import xarray as xr

from contact_study.plots.atoms import NEEDED
from contact_study.report.compute.gap_maps import located
from contact_study.report.compute.shown_states import PanelPoints
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.files import field_at
from contact_study.results.schema import variable_of


def read_atoms(inputs: Inputs, shown: PanelPoints, seed: int | None) -> xr.Dataset | None:
    """The atoms at the state common to the figures, as :func:`contact_study.plots.atoms` shows them.

    None unless a simulation kept its atoms and is in contact there.
    """
    for model in inputs.simulations:
        place = located(inputs, model, shown, seed)
        if place is None:
            continue
        part, selection, step = place
        fields = {}
        for name in NEEDED:
            values = field_at(inputs.paths[entry_of(model).file], name, selection, step)
            if values is not None:
                fields[name] = (variable_of(name).dims[-values.ndim :], values)
        if len(fields) < len(NEEDED) or not np.any(fields["normal_stress"][1]):
            continue
        return xr.Dataset(fields, {axis: part[axis] for axis in ("y", "x")})
    return None
