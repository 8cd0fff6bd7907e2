"""What the theories of the local gap, gap flow and edge flow, say of each point of a loading path."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from theory.case_theories import CaseTheories
from theory.edge_flow import EdgeFlow
from theory.gap_flow import GapFlow
from theory.separation import NotConverged

# What a block that has come off is, in every model; its mean gap is infinite where the model defines one.
DETACHED: dict[str, Any] = {
    "mean_pressure": 0.0,
    "relative_contact_area": 0.0,
    "elastic_energy": 0.0,
    "interaction_energy": 0.0,
    "converged": True,
    "detached": True,
    "residual": 0.0,
}


def gap_flow_paths(theories: CaseTheories) -> list[list[dict[str, Any]]]:
    """Values of each path point in each branch; none outside a wall, which no flow goes through.

    Raises
    ------
    InputError
        If a point of the path is beyond any contact.
    """
    try:
        with theories.naming_the_spectrum():
            flows = theories.gap_flows
        return [_gap_flow_values(theories.case, flow) for flow in flows]
    except ValueError as error:
        raise InputError(f"loading.path: {error}") from None


def edge_flow_paths(theories: CaseTheories) -> list[list[dict[str, Any]]]:
    """Values of each path point, in a list of one; none outside a wall.

    Raises
    ------
    InputError
        If a point of the path is beyond any contact.
    """
    flow = theories.edge_flow
    with theories.naming_the_spectrum():
        return [] if flow is None else [_edge_flow_values(theories.case, flow)]


def flow_name(branch: str, quantity: str) -> str:
    """The name of a quantity of the gap flow."""
    return f"gap_flow/{quantity}" if branch == "equilibrium" else f"gap_flow/{branch}/{quantity}"


def nowhere(edges: np.ndarray) -> np.ndarray:
    """Distribution of what is nowhere within any bins."""
    return np.zeros(edges.size - 1)


def _gap_flow_values(case: Case, flow: GapFlow) -> list[dict[str, Any]]:
    if case.loading.control == "pressure":
        gaps = np.array([flow.gap_at(pressure) for pressure, _ in case.path])
    else:
        gaps = np.array([value + case.law.equilibrium_distance for value, _ in case.path])
    held = np.isfinite(gaps)
    states = iter(flow.states(gaps[held]))
    found = []
    for there in held:
        if there:
            state = next(states)
            values = state.quantities(case.contact_distance)
        else:
            values = _come_off(flow.converged)
        found.append({flow_name(flow.branch, key): value for key, value in values.items()})
    return found


def _edge_flow_values(case: Case, flow: EdgeFlow) -> list[dict[str, Any]]:
    if not flow.converged:
        warnings.warn(
            f"edge flow: {flow.unconverged_states} of {len(flow.equilibria) + flow.lost} mean gaps did not converge"
            + (", between separation and contact; states of either that it gives are sound" if flow.outward else ""),
            NotConverged,
            stacklevel=2,
        )
    zero = case.law.equilibrium_distance
    found = []
    for asked, _ in case.path:
        if case.loading.control == "pressure":
            # A curve that ended early does not say what is beyond it.
            gap = flow.gap_at(asked) if asked <= flow.pressure.max() else None
        else:
            gap = asked + zero if flow.mean_gap[0] <= asked + zero <= flow.mean_gap[-1] else None
        if gap is None:
            values = _not_found(asked if case.loading.control == "gap" else np.nan)
        elif np.isnan(gap):
            values = _come_off(flow.converged)
        else:
            (state,) = flow.states(np.array([gap]))
            values = state.quantities(case.contact_distance)
        found.append({f"edge_flow/{key}": value for key, value in values.items()})
    return found


def _come_off(converged: bool) -> dict[str, Any]:
    """Quantities where a curve has no state; one that is not solved does not tell where it ends either."""
    return DETACHED | {
        "mean_gap": float("inf"),
        "converged": converged,
        "relative_repulsive_area": 0.0,
        "local_mean_pressure": 0.0,
        "pressure_pdf": nowhere,
        "gap_pdf": nowhere,
    }


def _not_found(gap: float) -> dict[str, Any]:
    """Quantities of a state that the iteration did not find: NaN, and flagged."""
    unknown: Callable[[np.ndarray], np.ndarray] = lambda edges: np.full(edges.size - 1, np.nan)  # noqa: E731
    names = ("mean_pressure", "relative_contact_area", "relative_repulsive_area", "elastic_energy")
    return {
        **dict.fromkeys((*names, "interaction_energy", "local_mean_pressure", "residual"), float("nan")),
        "mean_gap": gap,
        "pressure_pdf": unknown,
        "gap_pdf": unknown,
        "converged": False,
        "detached": False,
        "message": "the edge flow found no state here: its curve of mean gaps ends before",
    }
