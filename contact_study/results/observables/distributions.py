"""Distributions of the local pressure and of the local gap."""

from contact_study.numerics.distributions import Bins, probability_density
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, bins: Bins) -> dict[str, Value]:
    return {
        "pressure_pdf": probability_density(state.pressure, bins.pressure_edges),
        "gap_pdf": probability_density(state.gap, bins.gap_edges),
    }


DISTRIBUTIONS = Observable(
    {
        "pressure_pdf": Variable("Pa-1", "probability density of the interfacial pressure", ("step", "pressure_bin")),
        "gap_pdf": Variable("m-1", "probability density of the local gap", ("step", "gap_bin")),
    },
    _read,
)
