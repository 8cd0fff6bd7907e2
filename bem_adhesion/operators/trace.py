"""Reports of a solver's work while it runs: a callback for progress, benchmarks and tests."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from contact_study.numerics.fourier import RealTransform

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


Trace = Callable[[Progress], None]
"""A function that a solver calls at each mark."""


class Reporter:
    """Count transform pairs over the operators of one solid and pass marks on to a trace."""

    def __init__(self, trace: Trace):
        self._trace = trace
        self._pairs = 0.0
        self.finest = 0

    def mark(self, phase: Phase, shape: tuple[int, int], residual: float | None = None) -> None:
        self._trace(Progress(phase, self._pairs, shape, residual))

    def around(self, transform: RealTransform, work: Callable[[], np.ndarray], then: Phase) -> np.ndarray:
        """Do one transform between two marks, and count it."""
        self.mark("transform", transform.field.shape)
        weight = transform.dtype.itemsize / np.dtype(np.float64).itemsize
        self._pairs += 0.5 * weight * transform.points / self.finest
        result = work()
        self.mark(then, transform.field.shape)
        return result


class TracedTransform(RealTransform):
    """A transform that marks its beginning and its end."""

    def __init__(self, reporter: Reporter, *arguments: Any):
        super().__init__(*arguments)
        self._reporter = reporter
        reporter.finest = max(reporter.finest, self.points)

    def forward(self) -> np.ndarray:
        return self._reporter.around(self, super().forward, "spectrum")

    def backward(self) -> np.ndarray:
        return self._reporter.around(self, super().backward, "points")
