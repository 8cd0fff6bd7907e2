"""The states that a path passes in steps of its own, and what its jumps cost."""

from contact_study.fields.distributions import Bins
from contact_study.observables.base import InterfaceState, Observable, Value, Variable
from contact_study.observables.path_results import PASSED


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.own_steps is None:
        return {}
    columns = zip(PASSED, state.own_steps.passed.T, strict=True)
    return {
        "dissipated_energy": state.own_steps.dissipated,
        "dissipated_energy_resolution_error": state.own_steps.uncertain,
        **{f"passed_{name}": column for name, column in columns},
    }


JUMPS = Observable(
    {
        "dissipated_energy": Variable(
            "J m-2", "energy dissipated in jumps of the path up to this point per nominal area, detachments apart"
        ),
        "dissipated_energy_resolution_error": Variable(
            "J m-2", "by how much dissipated_energy may be off: where within its step a jump lies is not known"
        ),
        "passed_pressure": Variable(
            "Pa",
            "mean pressure of each state passed on the way to this point; of surfaces coming apart the load",
            ("step", "passed"),
        ),
        "passed_separation": Variable(
            "m", "mean separation of each state passed; infinite where the surfaces came apart", ("step", "passed")
        ),
        "passed_energy": Variable(
            "J m-2", "elastic and interaction energy per nominal area of each state passed", ("step", "passed")
        ),
    },
    _read,
)
