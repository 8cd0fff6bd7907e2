"""How stiff the contact is against its mean gap."""

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    return {} if state.contact_stiffness is None else {"contact_stiffness": state.contact_stiffness}


CONTACT_STIFFNESS = Observable(
    {
        "contact_stiffness": Variable(
            "Pa m-1",
            "mean pressure over mean gap, -dp/du, by the linearised problem; with free boundaries over the position of "
            "the undeformed surface",
        ),
    },
    _read,
)
