"""Where atoms in motion stand between two frames of a run, to be put aside and gone on from."""

import dataclasses
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from contact_study.errors import InputError
from md_reference.study.method import OTHER_VERSION
from md_reference.thermal.langevin import Motion
from md_reference.thermal.random_state import generator_of, packed


class Frame(NamedTuple):
    """What is to be known of a state once the point ends."""

    time: float  # (s)
    top: float  # height of the rigid plane (m)
    carried: float  # mean pressure of the interface (Pa)
    temperature: float  # of the nodes (K)
    whole: float  # temperature of the block as one body (K)


@dataclasses.dataclass
class TrajectoryState:
    """Where a run stands.

    Attributes
    ----------
    motion : Motion
        Of all nodes.
    generator : numpy.random.Generator
        Of the noise.
    point : int
        Of the path.
    touched : bool
        Whether an atom was within reach since the block last began to come down.
    frame, frames : int
        States of the point so far and in all.
    steps : int
        Of all frames of the point.
    series : list of Frame
        Of the point so far.
    """

    motion: Motion
    generator: np.random.Generator
    point: int
    touched: bool = False
    frame: int = 0
    frames: int = 0
    steps: int = 0
    series: list[Frame] = dataclasses.field(default_factory=list)

    def enter(self, point: int) -> None:
        """Stand before the first frame of a point."""
        self.point, self.frame, self.series = point, 0, []

    def share(self, steps: int, most: int) -> None:
        """Have the point take so many steps, in at most so many frames."""
        self.steps, self.frames = steps, min(most, steps)

    @property
    def taken(self) -> int:
        """Steps of the point so far, shared out evenly to its frames."""
        return self.steps * self.frame // self.frames

    @property
    def packed(self) -> dict[str, np.ndarray]:
        """All of it as arrays, to be put aside."""
        motion = self.motion
        return {
            "displacement": motion.displacement.copy(),
            "velocity": motion.velocity.copy(),
            "rigid": np.array([motion.top, motion.top_velocity, motion.time]),
            "counts": np.array([self.point, self.touched, self.frame, self.frames, self.steps]),
            "generator": packed(self.generator),
            "series": np.array(self.series).reshape(-1, len(Frame._fields)),
        }

    @classmethod
    def unpacked(cls, arrays: Mapping[str, np.ndarray]) -> "TrajectoryState":
        """What :attr:`packed` was made of.

        Raises
        ------
        InputError
            If a version of this program packed it that kept other numbers.
        """
        if arrays["series"].shape[1] != len(Frame._fields):
            raise InputError(OTHER_VERSION)
        top, top_velocity, time = map(float, arrays["rigid"])
        point, touched, frame, frames, steps = map(int, arrays["counts"])
        motion = Motion(arrays["displacement"].copy(), arrays["velocity"].copy(), top, top_velocity, time)
        series = [Frame(*map(float, frame)) for frame in arrays["series"]]
        return cls(motion, generator_of(arrays["generator"]), point, bool(touched), frame, frames, steps, series)
