"""What is read off the interface state of a simulation: a file for each subject, formula and dataset entry together."""

from contact_study.numerics.distributions import Bins
from contact_study.results.observables.contact_area import CONTACT_AREA
from contact_study.results.observables.contact_autocorrelation import CONTACT_AUTOCORRELATION
from contact_study.results.observables.contact_clusters import CONTACT_CLUSTERS
from contact_study.results.observables.contact_edge import CONTACT_EDGE
from contact_study.results.observables.contact_stiffness import CONTACT_STIFFNESS
from contact_study.results.observables.distributions import DISTRIBUTIONS
from contact_study.results.observables.energies import ENERGIES
from contact_study.results.observables.jumps import JUMPS
from contact_study.results.observables.means import MEANS
from contact_study.results.observables.motion import MOTION, SLOW_MOTION, TIME
from contact_study.results.observables.passed_states import PASSED_STATES
from contact_study.results.observables.percolation import PERCOLATION
from contact_study.results.observables.plasticity import PLASTICITY
from contact_study.results.observables.relaxation import RELAXATION
from contact_study.results.observables.solver_report import SOLVER_REPORT
from contact_study.results.state import InterfaceState, Observable, Value, Variable

OBSERVABLES: list[Observable] = [
    MEANS,
    CONTACT_AREA,
    ENERGIES,
    DISTRIBUTIONS,
    CONTACT_CLUSTERS,
    CONTACT_EDGE,
    CONTACT_AUTOCORRELATION,
    PERCOLATION,
    CONTACT_STIFFNESS,
    JUMPS,
    PASSED_STATES,
    PLASTICITY,
    RELAXATION,
    MOTION,
    SLOW_MOTION,
    TIME,
    SOLVER_REPORT,
]

ENTRIES: dict[str, Variable] = {
    name: variable for observable in OBSERVABLES for name, variable in observable.variables.items()
}


# What an ensemble has a mean of.
AVERAGED: set[str] = {name for observable in OBSERVABLES if observable.averaged for name in observable.variables}


def observed(state: InterfaceState, bins: Bins) -> dict[str, Value]:
    """Every observable of a state by its name in a dataset, distributions on the given bins."""
    return {name: value for observable in OBSERVABLES for name, value in observable.read(state, bins).items()}
