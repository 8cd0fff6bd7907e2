"""State of a trajectory or of a Monte Carlo chain between two states of a run, as arrays that a file can hold."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from contact_study.inputs.errors import InputError
from md_reference.thermal.hmc import SamplerState
from md_reference.thermal.langevin import Motion


def _record(generator: np.random.Generator, **numbers: Any) -> np.ndarray:
    """Return numbers and the state of a PCG64 generator as JSON text, which keeps all digits."""
    text = json.dumps({"generator": generator.bit_generator.state, **numbers})
    return np.frombuffer(text.encode(), np.uint8)


def _read(arrays: Mapping[str, np.ndarray]) -> tuple[np.random.Generator, dict[str, Any]]:
    """Return the generator and the numbers of a :func:`_record`; InputError for arrays of a version without one."""
    if "record" not in arrays:
        raise InputError(
            "what the interrupted run has kept is of another version of this program; drop it with --overwrite"
        )
    numbers = json.loads(arrays["record"].tobytes())
    generator = np.random.Generator(np.random.PCG64())
    generator.bit_generator.state = numbers.pop("generator")
    return generator, numbers


@dataclass
class ChainState:
    """Monte Carlo sampling of one point of the loading path."""

    sampler: SamplerState
    generator: np.random.Generator
    equilibrium: np.ndarray  # state at zero temperature, from which the next point starts, shape (3, ny, nx) (m)
    converged: bool  # whether its solve has
    pressures: list[float] = field(default_factory=list)  # mean ones of the interface so far (Pa)

    def pack(self) -> dict[str, np.ndarray]:
        """Return the chain as arrays."""
        state = self.sampler
        progress = [state.time_step, state.trajectories, state.accepted, state.evaluations]
        return {
            "state": self.equilibrium,
            "spectrum": state.displacement.view(np.float64),
            "mass": state.mass,
            "record": _record(self.generator, progress=progress, converged=self.converged, pressures=self.pressures),
        }

    @classmethod
    def unpack(cls, arrays: Mapping[str, np.ndarray]) -> "ChainState":
        """Return the chain that :meth:`pack` stored."""
        generator, numbers = _read(arrays)
        spectrum = np.ascontiguousarray(arrays["spectrum"]).view(np.complex128)
        time_step, *counts = numbers.pop("progress")
        return cls(SamplerState(spectrum, time_step, arrays["mass"], *counts), generator, arrays["state"], **numbers)


class Frame(NamedTuple):
    """Scalars of one recorded state of a trajectory, for the checks at the end of its point."""

    time: float  # (s)
    top: float  # height of the rigid plane (m)
    carried: float  # mean pressure of the interface (Pa)
    temperature: float  # of the nodes (K)
    whole: float  # temperature of the block as one body (K)


@dataclass
class TrajectoryState:
    """Molecular dynamics at one point of the loading path."""

    motion: Motion
    generator: np.random.Generator  # of the thermostat's noise
    point: int
    touched: bool = False  # whether an atom has been within reach since the block last began its approach
    frame: int = 0  # recorded states of the point so far
    frames: int = 0  # and in all
    steps: int = 0  # time steps of all frames of the point
    series: list[Frame] = field(default_factory=list)

    @property
    def taken(self) -> int:
        """Time steps of the point so far, shared evenly among its frames."""
        return self.steps * self.frame // self.frames

    def pack(self) -> dict[str, np.ndarray]:
        """Return the trajectory as arrays."""
        numbers, motion = vars(self).copy(), self.motion
        del numbers["motion"]
        rigid = [motion.top, motion.top_velocity, motion.time]
        return {
            "displacement": motion.displacement.copy(),
            "velocity": motion.velocity.copy(),
            "record": _record(rigid=rigid, **numbers),
        }

    @classmethod
    def unpack(cls, arrays: Mapping[str, np.ndarray]) -> "TrajectoryState":
        """Return the trajectory that :meth:`pack` stored."""
        generator, numbers = _read(arrays)
        motion = Motion(arrays["displacement"].copy(), arrays["velocity"].copy(), *numbers.pop("rigid"))
        numbers["series"] = [Frame(*frame) for frame in numbers["series"]]
        return cls(motion, generator, **numbers)
