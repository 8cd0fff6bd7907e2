"""When a state of a motion was met, under what load, how warm and with what energy."""

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, float]:
    motion = state.motion
    return {} if motion is None else {name: getattr(motion, name) for name in MOTION.variables}


def _read_slow(state: InterfaceState, _: Bins) -> dict[str, float]:
    slow = state.slow_motion
    return {} if slow is None else {"overdamped_time": slow.time, "overdamped_load": slow.load}


def _read_time(state: InterfaceState, _: Bins) -> dict[str, float]:
    clock = state.motion or state.relaxation
    return {} if clock is None else {"time": clock.time}


MOTION = Observable(
    {
        "temperature": Variable(
            "K",
            "kinetic temperature of the nodes, against a driven plane, by velocities in the middle of time steps",
        ),
        "kinetic_energy": Variable(
            "J m-2",
            "kinetic energy of nodes and rigid plane per nominal area, by velocities at the end of time steps",
        ),
        "mechanical_energy": Variable(
            "J m-2",
            "kinetic, whole elastic and interaction energy of atoms in motion and the potential of the load, applied "
            "pressure times height of the rigid plane, per nominal area",
        ),
    },
    _read,
)
SLOW_MOTION = Observable(
    {
        "overdamped_time": Variable(
            "m Pa-1",
            "time of overdamped motion since the path began, over the friction of a unit of area, which sets no scale",
        ),
        "overdamped_load": Variable("Pa", "mean pressure that acts on a state in overdamped motion"),
    },
    _read_slow,
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
