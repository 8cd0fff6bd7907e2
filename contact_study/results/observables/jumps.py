"""What the jumps of a path in steps of its own cost."""

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.own_steps is None:
        return {}
    return {
        "dissipated_energy": state.own_steps.dissipated,
        "dissipated_energy_resolution_error": state.own_steps.uncertain,
    }


JUMPS = Observable(
    {
        "dissipated_energy": Variable(
            "J m-2", "energy dissipated in jumps of the path up to this point per nominal area, detachments apart"
        ),
        "dissipated_energy_resolution_error": Variable(
            "J m-2", "by how much dissipated_energy may be off: where within its step a jump lies is not known"
        ),
    },
    _read,
)
