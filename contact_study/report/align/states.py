"""Fields of one state, read from the files of the simulations; quantities of the theories over the magnification."""

from typing import Any

import numpy as np
import xarray as xr

from contact_study.plots.maps import ATOMS_NEED
from contact_study.report.align.cases import SweepPoint, case_points, select, state_at, sweep_points
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.files import field_at
from contact_study.results.schema import variable_of
from contact_study.results.state import usable
from contact_study.study.case import PathPoint

_CURVES = ("relative_contact_area_at", "detachment_stress", "effective_work_of_adhesion")
STATE = "state"


def read_gaps(inputs: Inputs, point: SweepPoint, named: PathPoint, sample: Any) -> dict[str, xr.Dataset]:
    """The state of each simulation that kept its gaps and is in contact there, by the name of its entry."""
    found = {name: _with_fields(inputs, name, point, named, sample, ("gap", "pressure")) for name in inputs.simulations}
    kept = {name: state for name, state in found.items() if state is not None and "gap" in state}
    return {name: state for name, state in kept.items() if np.isfinite(state["gap"].values).all()}


def read_interface(inputs: Inputs, point: SweepPoint, named: PathPoint, sample: Any) -> xr.Dataset | None:
    """Heights, gap and pressure of one state; None unless there is one dataset, of a simulation that kept them."""
    if len(inputs.models) > 1 or not inputs.simulations:
        return None
    state = _with_fields(inputs, inputs.simulations[0], point, named, sample, ("gap", "pressure"))
    if state is None or not all(need in state for need in ("gap", "pressure", "height")):
        return None
    kept = [state[name].values for name in ("gap", "pressure")]
    return state if all(not np.isinf(field).any() and np.isfinite(field).any() for field in kept) else None


def read_atoms(inputs: Inputs, point: SweepPoint, named: PathPoint, sample: Any) -> xr.Dataset | None:
    """The atoms of one state; None unless a simulation kept them and is in contact there."""
    for name in inputs.simulations:
        state = _with_fields(inputs, name, point, named, sample, ATOMS_NEED)
        if state is not None and all(need in state for need in ATOMS_NEED) and np.any(state["normal_stress"]):
            return state[list(ATOMS_NEED)]
    return None


def resolving(inputs: Inputs) -> str | None:
    """The model whose dataset resolves magnifications; None where there is none."""
    return next((name for name, own in inputs.models.items() if all(curve in own for curve in _CURVES)), None)


def read_magnification(
    inputs: Inputs, shown: SweepPoint, named: PathPoint, sample: Any
) -> tuple[xr.Dataset, xr.Dataset] | None:
    """The state at every point of the sweep, on the dimension ``state``, and the one whose P(σ, ζ) is mapped.

    None unless there is one file, with a theory that is in contact there and resolves magnifications.
    """
    name = resolving(inputs)
    if name is None or len(inputs.paths) > 1:
        return None
    found = {point.label: _state(inputs, name, point, named, sample) for point in sweep_points(inputs.models)}
    states = {label: state for label, state in found.items() if state is not None and bool(usable(state))}
    if not states:
        return None
    curves = [
        state[list(_CURVES)].reset_coords(drop=True).assign_coords(wavevector=state["wavevector"].variable)
        for state in states.values()
    ]
    joined = xr.concat(curves, xr.Variable(STATE, list(states)), join="override")
    return joined, states.get(shown.label, next(iter(states.values())))


def _state(inputs: Inputs, model: str, point: SweepPoint, named: PathPoint, sample: Any) -> xr.Dataset | None:
    """One state of a model without its fields; None where it has no such state."""
    state = state_at(inputs.models[model], point, named)
    if state is None or inputs.average not in state.dims:
        return state
    return None if sample is None else state.sel({inputs.average: sample})


def _with_fields(
    inputs: Inputs, model: str, point: SweepPoint, named: PathPoint, sample: Any, names: tuple[str, ...]
) -> xr.Dataset | None:
    """One state of a simulation with those of the named fields that its file keeps."""
    state = _state(inputs, model, point, named, sample)
    if state is None or "y" not in state:
        return None
    part = select(inputs.models[model], point)
    assert part is not None
    selection = {**point.selection, **({inputs.average: sample} if inputs.average in part.dims else {})}
    step = case_points(part).index(named)
    # Smaller cells of a sweep are padded to the points of the largest.
    y, x = (state[axis].values for axis in ("y", "x"))
    cell = {axis: np.flatnonzero(np.isfinite(values)) for axis, values in (("y", y), ("x", x))}
    numbered = {f"{axis}_index": axis for axis in ("y", "x") if f"{axis}_index" in state.dims}
    state = state.drop_vars(["y", "x"]).rename(numbered)
    for name in names:
        if (values := field_at(inputs.paths[entry_of(model).file], name, selection, step)) is not None:
            state[name] = (variable_of(name).dims[-values.ndim :], values)
    there = {axis: places for axis, places in cell.items() if axis in state.dims}
    return state.isel(there).assign_coords(y=y[cell["y"]], x=x[cell["x"]])
