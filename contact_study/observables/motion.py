"""When a state of atoms in motion was met, and how warm they were."""

from contact_study.fields.distributions import Bins
from contact_study.observables.base import InterfaceState, Observable, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, float]:
    return {} if state.motion is None else {"temperature": state.motion.temperature}


def _read_time(state: InterfaceState, _: Bins) -> dict[str, float]:
    clock = state.motion or state.relaxation
    return {} if clock is None else {"time": clock.time}


MOTION = Observable(
    {"temperature": Variable("K", "twice the kinetic energy over Boltzmann's constant and the number of freedoms")},
    _read,
)
TIME = Observable(
    {
        "time": Variable(
            "s", "time since the motion, or a path in time, began; of a point of the path that of its last state"
        )
    },
    _read_time,
    averaged=False,
)
