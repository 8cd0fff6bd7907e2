"""Time, load and temperature of a state of atoms in motion, of overdamped motion or of a path in time."""

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    values: dict[str, Value] = {}
    if state.motion is not None:
        values = {
            "temperature": state.motion.temperature,
            "kinetic_energy": state.motion.kinetic_energy,
            "mechanical_energy": state.motion.mechanical_energy,
        }
    if state.slow_motion is not None:
        values |= {"overdamped_time": state.slow_motion.time, "overdamped_load": state.slow_motion.load}
    return values


def _read_time(state: InterfaceState, _: Bins) -> dict[str, Value]:
    clock = state.motion or state.relaxation
    return {} if clock is None else {"time": clock.time}


MOTION = Observable(
    {
        "temperature": Variable(
            "K",
            "kinetic temperature of the nodes, driven plane: in its frame",
            attrs={"comment": "by velocities in the middle of time steps"},
        ),
        "kinetic_energy": Variable(
            "J m-2",
            "kinetic energy of nodes and rigid plane per nominal area",
            attrs={"comment": "by velocities at the end of time steps"},
        ),
        "mechanical_energy": Variable(
            "J m-2",
            "mechanical energy of atoms in motion and load per nominal area",
            attrs={
                "comment": "kinetic, whole elastic and interaction energy, and the potential of the load: applied "
                "pressure times height of the rigid plane"
            },
        ),
        "overdamped_time": Variable("m Pa-1", "time of overdamped motion over the friction of a unit of area"),
        "overdamped_load": Variable("Pa", "mean pressure on a state in overdamped motion"),
    },
    _read,
)
TIME = Observable(
    {"time": Variable("s", "time since the motion, or a path in time, began; of a point that of its last state")},
    _read_time,
    averaged=False,
)
