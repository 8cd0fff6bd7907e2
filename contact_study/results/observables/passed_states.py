"""The states that a path passes between its points, in steps of its own or of time."""

from contact_study.numerics.distributions import Bins
from contact_study.results.path_results import PASSED
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.passed is None:
        return {}
    return {f"passed_{name}": column for name, column in zip(PASSED, state.passed.T, strict=True)}


PASSED_STATES = Observable(
    {
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
