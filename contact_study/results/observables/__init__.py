"""Quantities that are read off the state of a simulation: one file per subject, with formula and dataset entry.

Quantities of a whole path are in :mod:`~contact_study.results.path_results`, those of a case in
:mod:`~contact_study.results.constants`, those of the theories in :mod:`~contact_study.results.schema`.
"""

from contact_study.numerics.distributions import Bins
from contact_study.results.observables.area import AREA
from contact_study.results.observables.autocorrelation import AUTOCORRELATION
from contact_study.results.observables.clusters import CLUSTERS
from contact_study.results.observables.distributions import DISTRIBUTIONS
from contact_study.results.observables.energies import ENERGIES
from contact_study.results.observables.means import MEANS
from contact_study.results.observables.motion import MOTION, TIME
from contact_study.results.observables.solver_report import SOLVER_REPORT
from contact_study.results.state import InterfaceState, Observable, Value, Variable

OBSERVABLES: list[Observable] = [
    MEANS,
    AREA,
    ENERGIES,
    DISTRIBUTIONS,
    CLUSTERS,
    AUTOCORRELATION,
    MOTION,
    TIME,
    SOLVER_REPORT,
]

ENTRIES: dict[str, Variable] = {
    name: variable for observable in OBSERVABLES for name, variable in observable.variables.items()
}

# Quantities whose value for an ensemble is the mean over its states.
AVERAGED: set[str] = {name for observable in OBSERVABLES if observable.averaged for name in observable.variables}


def observed(state: InterfaceState, bins: Bins) -> dict[str, Value]:
    """Read every observable off a state, distributions on the given bins; returns values by name."""
    return {name: value for observable in OBSERVABLES for name, value in observable.read(state, bins).items()}
