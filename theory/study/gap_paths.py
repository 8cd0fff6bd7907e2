"""Gap flow and edge flow at each point of a loading path."""

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from contact_study.study.case import Case
from theory.edge_flow.flow import EdgeFlow
from theory.gap_flow.flow import GapFlow
from theory.gap_flow.pressure_curve import REMEDY
from theory.gap_flow.state import GapState
from theory.numerics.background import BackgroundExecutor, BackgroundTask
from theory.persson.separation import NotConverged
from theory.study.case_theories import CaseTheories

# Values at the path point of a number; a mistake of input is raised at the first.
PathValues = Callable[[int], dict[str, Any]]

# A detached block, in every model; its mean gap is infinite where the model defines one.
DETACHED: dict[str, Any] = {
    "mean_pressure": 0.0,
    "relative_contact_area": 0.0,
    "elastic_energy": 0.0,
    "interaction_energy": 0.0,
    "converged": True,
    "detached": True,
    "residual": 0.0,
}


def gap_flow_paths(theories: CaseTheories) -> list[PathValues]:
    """Values in each branch; none outside a wall, which no flow goes through."""
    with theories.naming_the_spectrum():
        flows = theories.gap_flows

    def in_branch(flow: GapFlow, begun: BackgroundTask[list[GapState | None]]) -> PathValues:
        return lambda number: _gap_flow_values(theories.case, flow, begun.result()[number])

    return [in_branch(*both) for both in zip(flows, theories.gap_flow_states, strict=True)]


def edge_flow_paths(theories: CaseTheories, start: int = 0) -> list[PathValues]:
    """Values at the points from number ``start`` on, in a list of one; none outside a wall."""
    flow = theories.edge_flow
    with theories.naming_the_spectrum():
        return [] if flow is None else [_edge_flow_values(theories.case, flow, theories.ahead, start)]


def flow_name(branch: str, quantity: str) -> str:
    """The name of a quantity of the gap flow."""
    return f"gap_flow/{quantity}" if branch == "equilibrium" else f"gap_flow/{branch}/{quantity}"


def nowhere(edges: np.ndarray) -> np.ndarray:
    """Distribution of what is nowhere within any bins."""
    return np.zeros(edges.size - 1)


def undefined(edges: np.ndarray) -> np.ndarray:
    """Distribution that is not known in any bin."""
    return np.full(edges.size - 1, np.nan)


def _gap_flow_values(case: Case, flow: GapFlow, state: GapState | None) -> dict[str, Any]:
    values = _come_off(flow.converged) if state is None else state.quantities(case.contact_distance)
    return {flow_name(flow.branch, key): value for key, value in values.items()}


def _edge_flow_values(case: Case, flow: EdgeFlow, ahead: BackgroundExecutor, start: int) -> PathValues:
    if not flow.converged:
        warnings.warn(
            f"edge flow: {flow.unconverged_states} of {len(flow.equilibria) + flow.lost} mean gaps did not converge"
            + (", between pieces of the curve; states of these are sound" if len(flow.pieces) > 1 else ""),
            NotConverged,
            stacklevel=2,
        )
    gaps = [_edge_flow_gap(case, flow, asked) for asked, _ in case.path]
    begun = {
        number: ahead.begin(partial(flow.states, np.array([gap])))
        for number, gap in enumerate(gaps)
        if number >= start and gap is not None and not np.isnan(gap)
    }

    def values(number: int) -> dict[str, Any]:
        asked, gap = case.path[number][0], gaps[number]
        if gap is None:
            found = _not_found(asked if case.loading.control == "gap" else np.nan, flow.limit)
        elif np.isnan(gap):
            found = _come_off(flow.converged)
        else:
            (state,) = begun[number].result()
            found = state.quantities(case.contact_distance)
        return {f"edge_flow/{key}": value for key, value in found.items()}

    return values


def _edge_flow_gap(case: Case, flow: EdgeFlow, asked: float) -> float | None:
    """Mean gap of a path point (m), NaN where no state carries its pressure; None where the curve does not say."""
    if case.loading.control == "pressure":
        # A curve that ended early does not say what is beyond it.
        return flow.gap_at(asked) if asked <= flow.pressure.max() else None
    gap = asked + case.law.equilibrium_distance
    return gap if flow.mean_gap[0] <= gap <= flow.mean_gap[-1] else None


def _come_off(converged: bool) -> dict[str, Any]:
    """Quantities where a curve has no state; one that is not solved does not tell where it ends either."""
    return DETACHED | {
        "mean_gap": float("inf"),
        "converged": converged,
        "relative_repulsive_area": 0.0,
        "local_mean_pressure": 0.0,
        "stress_balance": float("nan"),
        **dict.fromkeys(("pressure_pdf", "gap_pdf"), nowhere),
    }


def _not_found(gap: float, limit: str) -> dict[str, Any]:
    """Quantities of a state that the iteration did not find: NaN, and flagged."""
    names = ("mean_pressure", "relative_contact_area", "relative_repulsive_area", "elastic_energy")
    further = ("interaction_energy", "local_mean_pressure", "stress_balance", "residual")
    return {
        **dict.fromkeys((*names, *further), float("nan")),
        **dict.fromkeys(("pressure_pdf", "gap_pdf"), undefined),
        "mean_gap": gap,
        "converged": False,
        "detached": False,
        "message": f"adhesion is too strong for the edge flow ({limit}); {REMEDY}",
    }
