"""What a viscoelastic solid has dissipated on its path in time."""

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    return {} if state.relaxation is None else {"viscous_dissipation": state.relaxation.dissipated}


RELAXATION = Observable(
    {
        "viscous_dissipation": Variable(
            "J m-2", "energy dissipated by the viscoelastic solid up to this point per nominal area"
        ),
    },
    _read,
)
