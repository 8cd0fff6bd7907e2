"""What a theory says of every magnification, at the state common to the figures."""

import xarray as xr

from contact_study.report.compute.cases import SweepPoint, case_points, select, sweep_points
from contact_study.report.compute.shown_states import PanelPoints
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.load_steps import usable

_CURVES = ("relative_contact_area_at", "detachment_stress", "effective_work_of_adhesion")
STATE = "state"


def resolving(inputs: Inputs) -> str | None:
    """The model whose dataset resolves magnifications; None where there is none."""
    return next((name for name, own in inputs.models.items() if all(curve in own for curve in _CURVES)), None)


def read_magnification(inputs: Inputs, shown: PanelPoints, seed: int | None) -> tuple[xr.Dataset, xr.Dataset] | None:
    """The state at every point of the sweep, on the dimension ``state``, and the one whose P(σ, ζ) is mapped.

    None unless there is one file, with a theory that is in contact there and resolves magnifications.
    """
    name = resolving(inputs)
    if name is None or len(inputs.paths) > 1:
        return None
    own = inputs.models[name]
    found = {point.label: _state(inputs, own, point, shown, seed) for point in sweep_points(inputs.models)}
    states = {label: state for label, state in found.items() if state is not None}
    if not states:
        return None
    curves = [
        state[list(_CURVES)].reset_coords(drop=True).assign_coords(wavevector=state["wavevector"].variable)
        for state in states.values()
    ]
    joined = xr.concat(curves, xr.Variable(STATE, list(states)), join="override")
    return joined, states.get(shown.case.label, next(iter(states.values())))


def _state(
    inputs: Inputs, own: xr.Dataset, point: SweepPoint, shown: PanelPoints, seed: int | None
) -> xr.Dataset | None:
    part = select(own, point)
    if part is None or shown.common not in (path := case_points(part, inputs.control)):
        return None
    if inputs.average in part.dims:
        part = part.sel({inputs.average: seed})
    state = part.isel(step=path.index(shown.common))
    return state if bool(usable(state)) else None
