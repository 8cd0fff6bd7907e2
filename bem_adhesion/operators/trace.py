"""Reports of a solver's work while it runs: a callback for progress, benchmarks and tests.

A solver marks each change of phase. A trace that reads the clock at each mark has the time of every phase; solves
without a trace run the same code as before.
"""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.memory import Memory, Scratch

Phase = Literal["transform", "spectrum", "extension", "points", "iteration"]


@dataclass(frozen=True)
class Progress:
    """One mark of a solver.

    A phase begins: a Fourier transform, a product in Fourier space, the extension from a contact set, loops over the
    points, or an outer iteration, which begins with loops over the points. ``pairs`` are the transform pairs so far,
    as float64 pairs on the finest grid, ``shape`` the points of the grid in use, ``residual`` that at the start of an
    iteration in the units of the solver's tolerance.
    """

    phase: Phase
    pairs: float
    shape: tuple[int, int]
    residual: float | None = None


class Trace(Protocol):
    """A function that a solver calls at each mark."""

    def __call__(self, progress: Progress) -> None: ...


class Reporter:
    """Count transform pairs over the operators of one solid and pass marks on to a trace."""

    def __init__(self, trace: Trace):
        self._trace = trace
        self._pairs = 0.0
        self.finest = 0

    def mark(self, phase: Phase, shape: tuple[int, int], residual: float | None = None) -> None:
        """Call the trace."""
        self._trace(Progress(phase, self._pairs, shape, residual))

    def count(self, pairs: float, transform: RealTransform) -> None:
        """Add pairs of a transform."""
        weight = transform.dtype.itemsize / np.dtype(np.float64).itemsize
        self._pairs += pairs * weight * transform.points / self.finest


class TracedTransform(RealTransform):
    """A transform that marks its beginning and its end."""

    def __init__(
        self,
        reporter: Reporter,
        shape: tuple[int, int],
        dtype: type,
        threads: int,
        scratch: Scratch | None,
        memory: Memory | None,
    ):
        super().__init__(shape, dtype, threads, scratch, memory)
        self._reporter = reporter
        reporter.finest = max(reporter.finest, self.points)

    def forward(self) -> np.ndarray:
        self._begin()
        result = super().forward()
        self._reporter.mark("spectrum", self.field.shape)
        return result

    def backward(self) -> np.ndarray:
        self._begin()
        result = super().backward()
        self._reporter.mark("points", self.field.shape)
        return result

    def _begin(self) -> None:
        self._reporter.mark("transform", self.field.shape)
        self._reporter.count(0.5, self)
