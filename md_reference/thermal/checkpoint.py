"""State of a trajectory or of a Monte Carlo chain between two states of a run, as arrays that a file can hold."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from contact_study.inputs.errors import InputError
from md_reference.thermal.hmc import SamplerState
from md_reference.thermal.langevin import Motion

_WORD = 2**64
_OTHER_VERSION = "what the interrupted run has kept is of another version of this program; drop it with --overwrite"


def pack_generator(generator: np.random.Generator) -> np.ndarray:
    """Return the state of a PCG64 generator, shape (6,)."""
    state = generator.bit_generator.state
    words = [part for number in state["state"].values() for part in divmod(number, _WORD)]
    return np.array([*words, state["has_uint32"], state["uinteger"]], dtype=np.uint64)


def unpack_generator(words: np.ndarray) -> np.random.Generator:
    """Return the generator whose :func:`pack_generator` state is given."""
    high, low, increment_high, increment_low, has_uint32, uinteger = map(int, words)
    bits = np.random.PCG64()
    bits.state = {
        "bit_generator": "PCG64",
        "state": {"state": high * _WORD + low, "inc": increment_high * _WORD + increment_low},
        "has_uint32": has_uint32,
        "uinteger": uinteger,
    }
    return np.random.Generator(bits)


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
        return {
            "state": self.equilibrium,
            "spectrum": state.displacement.view(np.float64),
            "generator": pack_generator(self.generator),
            "mass": state.mass,
            "sampler": np.array([state.time_step]),
            "pressures": np.array(self.pressures),
            "counts": np.array([state.trajectories, state.accepted, state.evaluations, int(self.converged)]),
        }

    @classmethod
    def unpack(cls, arrays: Mapping[str, np.ndarray]) -> "ChainState":
        """Return the chain that :meth:`pack` stored; InputError for arrays of a version without pressures."""
        if "pressures" not in arrays:
            raise InputError(_OTHER_VERSION)
        *counts, converged = map(int, arrays["counts"])
        spectrum = np.ascontiguousarray(arrays["spectrum"]).view(np.complex128)
        sampler = SamplerState(spectrum, float(arrays["sampler"][0]), arrays["mass"], *counts)
        pressures = arrays["pressures"].tolist()
        return cls(sampler, unpack_generator(arrays["generator"]), arrays["state"], bool(converged), pressures)


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
        motion = self.motion
        return {
            "displacement": motion.displacement.copy(),
            "velocity": motion.velocity.copy(),
            "rigid": np.array([motion.top, motion.top_velocity, motion.time]),
            "counts": np.array([self.point, self.touched, self.frame, self.frames, self.steps]),
            "generator": pack_generator(self.generator),
            "series": np.array(self.series).reshape(-1, len(Frame._fields)),
        }

    @classmethod
    def unpack(cls, arrays: Mapping[str, np.ndarray]) -> "TrajectoryState":
        """Return the trajectory that :meth:`pack` stored; InputError for frames of a version with other fields."""
        if arrays["series"].shape[1] != len(Frame._fields):
            raise InputError(_OTHER_VERSION)
        point, touched, frame, frames, steps = map(int, arrays["counts"])
        motion = Motion(arrays["displacement"].copy(), arrays["velocity"].copy(), *map(float, arrays["rigid"]))
        series = [Frame(*map(float, frame)) for frame in arrays["series"]]
        generator = unpack_generator(arrays["generator"])
        return cls(motion, generator, point, bool(touched), frame, frames, steps, series)
