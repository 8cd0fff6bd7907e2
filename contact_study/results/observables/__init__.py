"""Quantities that are read off the state of a simulation, a file for each subject with formula and dataset entry."""

from collections.abc import Collection
from dataclasses import replace

from contact_study.numerics.distributions import Bins
from contact_study.results.observables.area import AREA, OVERCOUNT, corrected_area, edge_sides
from contact_study.results.observables.autocorrelation import (
    AUTOCORRELATION,
    RELATIVE_DISTANCE,
    RING_EDGES,
    RINGS,
    contact_autocorrelation,
)
from contact_study.results.observables.clusters import (
    CLUSTERS,
    PATCH_EDGES,
    RELATIVE_PATCH_AREA,
    cluster_map,
    percolates,
)
from contact_study.results.observables.gap_at_edge import GAP_AT_EDGE
from contact_study.results.observables.leakage import LEAKAGE
from contact_study.results.observables.mechanics import FURTHER, MECHANICS
from contact_study.results.observables.solver_report import SOLVER_REPORT
from contact_study.results.state import InterfaceState, Observable, Step, Value, Variable

__all__ = [
    "AREA",
    "AUTOCORRELATION",
    "AVERAGED",
    "CLUSTERS",
    "ENTRIES",
    "FIXED_COORDINATES",
    "FURTHER",
    "GAP_AT_EDGE",
    "LEAKAGE",
    "MECHANICS",
    "OBSERVABLES",
    "OVERCOUNT",
    "PATCH_EDGES",
    "RELATIVE_DISTANCE",
    "RELATIVE_PATCH_AREA",
    "RINGS",
    "RING_EDGES",
    "SOLVER_REPORT",
    "cluster_map",
    "contact_autocorrelation",
    "corrected_area",
    "edge_sides",
    "observed",
    "options_of",
    "percolates",
    "recorded",
]

OBSERVABLES: list[Observable] = [
    MECHANICS,
    FURTHER,
    AREA,
    CLUSTERS,
    AUTOCORRELATION,
    GAP_AT_EDGE,
    LEAKAGE,
    SOLVER_REPORT,
]

# Of distributions over lengths and areas in units of the cell's, alike for every study.
FIXED_COORDINATES = {"relative_distance": RELATIVE_DISTANCE, "relative_patch_area": RELATIVE_PATCH_AREA}

ENTRIES: dict[str, Variable] = {
    name: variable for observable in OBSERVABLES for name, variable in observable.variables.items()
}

# Those whose value for an ensemble is the mean over its states.
AVERAGED: set[str] = {name for observable in OBSERVABLES if observable.averaged for name in observable.variables}


def options_of(output: object) -> frozenset[str]:
    """Keys of observables that a section [output] asks for."""
    return frozenset(each.option for each in OBSERVABLES if each.option and getattr(output, each.option))


def observed(state: InterfaceState, bins: Bins, options: Collection[str] = ()) -> dict[str, Value]:
    """Read observables off a state, distributions on the given bins; returns values by name.

    Those that cost time are read if ``options`` has their key, see :func:`options_of`.
    """
    asked = (observable for observable in OBSERVABLES if observable.option in ("", *options))
    return {name: value for observable in asked for name, value in observable.read(state, bins).items()}


def recorded(point: InterfaceState | Step, bins: Bins, fields: bool = False, options: Collection[str] = ()) -> Step:
    """The step of a state, with its fields if asked, or of quantities of theories, every distribution on the bins."""
    if isinstance(point, InterfaceState):
        kept = {"gap": point.gap, "pressure": point.pressure} if fields else {}
        if fields and point.plastic_indentation is not None:
            kept["plastic_indentation"] = point.plastic_indentation
        return Step(observed(point, bins, options), {**kept, **point.atoms}, point.restart, bins)
    edges = bins.edges_of
    functions = {key: value for key, value in point.values.items() if callable(value)}
    densities = {key: function(edges[key.rpartition("/")[2]]) for key, function in functions.items()}
    return replace(point, values={**point.values, **densities}, bins=bins)
