"""The periodic elastic solid on a grid, linear maps by Fourier transforms, and loads on it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Literal

import numpy as np

from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product, kernel
from contact_study.numerics.memory import Memory, Scratch
from contact_study.physics.solids import Elasticity

Phase = Literal["transform", "spectrum", "extension", "points", "iteration"]


@dataclass(frozen=True)
class Progress:
    """A phase of a solver begins: of an outer iteration, which begins with loops over the points, with its residual.

    ``pairs`` are those so far, with the one under way, in float64 on the finest grid; ``shape`` is that of the grid.
    """

    phase: Phase
    pairs: float
    shape: tuple[int, int]
    residual: float | None = None


Trace = Callable[[Progress], None]


class Work:
    """Transform pairs of all operators of a contact, as float64 pairs on a grid of so many points, and its trace."""

    def __init__(self, points: int = 1, trace: Trace | None = None):
        self.points, self.trace, self.pairs = points, trace, 0.0

    def mark(self, phase: Phase, shape: tuple[int, ...], residual: float | None = None) -> None:
        """Report a phase to the trace, if there is one."""
        if self.trace is not None:
            self.trace(Progress(phase, self.pairs, (shape[0], shape[1]), residual))


class _MarkedTransform(RealTransform):
    """A transform that marks its beginning and its end."""

    def __init__(self, work: Work, *arguments: Any):
        super().__init__(*arguments)
        self._work = work

    def forward(self) -> np.ndarray:
        return self._between_marks(super().forward, "spectrum")

    def backward(self) -> np.ndarray:
        return self._between_marks(super().backward, "points")

    def _between_marks(self, transform: Callable[[], np.ndarray], then: Phase) -> np.ndarray:
        self._work.mark("transform", self.shape)
        result = transform()
        self._work.mark(then, self.shape)
        return result


@kernel
def _multiply_spectrum(spectrum, factors):
    """Multiply a spectrum by real factors in place; NumPy would first make the factors complex."""
    rows, columns = spectrum.shape
    for i in range(rows):
        row, factor = spectrum[i], factors[min(i, rows - i)]
        for j in range(columns):
            row[j] *= factor[j]


@kernel
def _multiply_and_sum(spectrum, factors, has_nyquist_column):
    """Multiply a spectrum by real factors in place; return Σ factor·|spectrum|² over all wavevectors."""
    rows, columns = spectrum.shape
    total = 0.0
    for i in range(rows):
        factor = factors[min(i, rows - i)]
        # A row is summed in the precision of the data, which vectorises; the rows in float64.
        row = factor[0] * (spectrum[i, 0].real ** 2 + spectrum[i, 0].imag ** 2) * factors.dtype.type(-0.5)
        if has_nyquist_column:
            last = spectrum[i, columns - 1]
            row -= factor[columns - 1] * (last.real**2 + last.imag**2) * factors.dtype.type(0.5)
        for j in range(columns):
            z = spectrum[i, j]
            k = factor[j]
            row += k * (z.real * z.real + z.imag * z.imag)
            spectrum[i, j] = k * z
        total += 2.0 * row
    return total


class PeriodicOperator:
    """A periodic solid: write into :attr:`field`, apply a map, one transform pair, and read the result there.

    ``stiffness`` is K, ``largest`` its largest eigenvalue, ``mean_stiffness`` (Pa/m) K at q = 0, a spring on the mean.
    """

    def __init__(
        self,
        elasticity: Elasticity,
        mean_stiffness: float,
        threads: int,
        scratch: Scratch,
        work: Work,
        grid: Grid,
        dtype: type = np.float64,
        memory: Memory | None = None,
    ):
        self.grid = grid
        self.mean_stiffness = mean_stiffness
        self.elasticity = elasticity
        self._work = work
        transform = (grid.shape, dtype, threads, scratch, memory)
        self._transform = RealTransform(*transform) if work.trace is None else _MarkedTransform(work, *transform)
        self.field = self._transform.field
        # A pair in float32 counts half.
        self._share = self._transform.dtype.itemsize / np.dtype(np.float64).itemsize * grid.points / work.points

    def mark(self, phase: Phase, residual: float | None = None) -> None:
        """Report a phase to the trace, if there is one."""
        self._work.mark(phase, self.grid.shape, residual)

    def _stiffness_q(self, mean_stiffness: float) -> np.ndarray:
        """Return K of each wavevector (Pa/m) by ``rfft2`` without the rows of −qy, equal to those of qy."""
        stiffness_q = self.elasticity.stiffness_on(self.grid)[: self.grid.shape[0] // 2 + 1]
        stiffness_q[0, 0] = mean_stiffness
        return stiffness_q

    def _factors(self, kernel_q: np.ndarray) -> np.ndarray:
        kernel_q *= 1 / self.grid.points
        return kernel_q.astype(self._transform.dtype)

    @cached_property
    def _stiffness_and_largest(self) -> tuple[np.ndarray, float]:
        stiffness_q = self._stiffness_q(self.mean_stiffness)
        largest = float(stiffness_q.max())
        return self._factors(stiffness_q), largest

    @property
    def stiffness(self) -> np.ndarray:
        return self._stiffness_and_largest[0]

    @property
    def largest(self) -> float:
        return self._stiffness_and_largest[1]

    @cached_property
    def compliance(self) -> np.ndarray:
        """The map to a displacement of zero mean."""
        return self._factors(1 / self._stiffness_q(np.inf))

    def inverse_shifted(self, shift: float) -> np.ndarray:
        """Prepare (K + shift)⁻¹ for a uniform shift (Pa/m)."""
        return self._factors(1 / (self._stiffness_q(self.mean_stiffness) + shift))

    def apply(self, linear_map: np.ndarray) -> np.ndarray:
        """Apply a map to :attr:`field` in place; return the field."""
        self._work.pairs += self._share
        self._transform.forward()
        _multiply_spectrum(self._transform.spectrum, linear_map)
        return self._transform.backward()

    def apply_and_sum(self, linear_map: np.ndarray) -> float:
        """Apply a map as :meth:`apply`; return the inner product of input and result."""
        # The sum is formed on the spectrum, before the result exists in real space: the passes around it can be fused.
        self._work.pairs += self._share
        self._transform.forward()
        total = _multiply_and_sum(self._transform.spectrum, linear_map, self.grid.shape[1] % 2 == 0)
        self._transform.backward()
        return total

    def interpolate(self, coarser: "PeriodicOperator") -> np.ndarray:
        """Interpolate the field of the same operator on a coarser grid, destroying it, into :attr:`field`."""
        self._work.pairs += 0.5 * (self._share + coarser._share)
        return self._transform.interpolate(coarser._transform)


MakeOperator = Callable[..., PeriodicOperator]  # of a grid, numpy.float64 or numpy.float32, and memory for its field


def periodic(
    elasticity: Elasticity, mean_stiffness: float = 0.0, threads: int = 1, work: Work | None = None
) -> MakeOperator:
    """Return a maker of :class:`PeriodicOperator`; all operators that it makes share one spectrum."""
    return partial(PeriodicOperator, elasticity, mean_stiffness, threads, Scratch(), work or Work())


@dataclass(frozen=True)
class Load:
    """A uniform pressure and a field of pressures (Pa), or with a ``unit`` heights h in it (m).

    K h is not stored: pressing = K (d + h), and ½ <d, K d> + <d, K h> = ½ <pressing, d + h> − ½ <h, K h>. A prescribed
    ``mean_gap`` (m) is held by a pressure that the solve finds.
    """

    field: np.ndarray
    unit: float | None = None
    pressure: float = 0.0
    energy: float = 0.0  # the part that does not depend on the gap (J/m²)
    mean_gap: float | None = None

    def less(self, pressure: float, stiffness: float) -> "Load":
        """Return the load without a pressure (Pa), or with the mean gap that it opens against a stiffness (Pa/m)."""
        if self.mean_gap is None:
            return replace(self, pressure=self.pressure - pressure)
        return replace(self, mean_gap=self.mean_gap + pressure / stiffness)

    def missing(self, gap: np.ndarray) -> float | None:
        """Return by how much the mean of a gap is too small (m), if the load prescribes it."""
        return None if self.mean_gap is None else self.mean_gap - float(gap.mean())

    @classmethod
    def of_heights(cls, solid: PeriodicOperator, height: np.ndarray, unit: float) -> "Load":
        """Return the load of heights on a solid, without pressure; its energy is −½ <h, K h>."""
        load = cls(height, unit)
        flattening = load.press(np.zeros(height.shape), solid)
        return replace(load, energy=-0.5 * unit * inner_product(flattening, height))

    def press(self, gap: np.ndarray, solid: PeriodicOperator) -> np.ndarray:
        """Write K d + field of a gap (Pa) into the operator's field; return it."""
        if self.unit is not None:
            np.multiply(self.field, self.unit, out=solid.field)
            solid.field += gap
            return solid.apply(solid.stiffness)
        solid.field[...] = gap
        pressing = solid.apply(solid.stiffness)
        pressing += self.field
        return pressing

    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        """Return Σ ½ d·K d + field·d − ½ pressing·d in some rows, without their part of :attr:`energy` (J/m²)."""
        if self.unit is None:
            return 0.5 * inner_product(self.field[here], gap[here])
        return 0.5 * self.unit * inner_product(pressing[here], self.field[here])


Window = tuple[slice, ...]  # the rows and columns of a padded grid with a surface
