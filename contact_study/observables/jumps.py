"""What the jumps of a path cost and where it lets go, of paths with steps of their own."""

from contact_study.fields.distributions import Bins
from contact_study.observables.base import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    found = {"dissipated_energy": state.dissipated_energy, "detachment_pressure": state.detachment_pressure}
    return {name: value for name, value in found.items() if value is not None}


JUMPS = Observable(
    {
        "dissipated_energy": Variable(
            "J m-2", "energy dissipated in jumps of the path up to this point per nominal area, detachments apart"
        ),
        "detachment_pressure": Variable(
            "Pa", "lowest mean pressure held before the surfaces came apart on the way to this point"
        ),
    },
    _read,
)
