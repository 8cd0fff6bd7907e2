"""What the solvers ask of the elastic solid under their grid, and the periodic solid that answers by Fourier transform.

:class:`Operator` is the whole of it: linear maps of a field in a buffer. A solver is given a function that makes one
for any grid and precision, so that its coarser grids have the same solid under them, and never asks what it is.
"""

from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numba import njit

from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.numerics.memory import Memory, Scratch
from contact_study.physics.solids import Elasticity

Map = Any
"""A linear map of an operator's field, prepared by the operator that applies it."""


class Operator(Protocol):
    """The elastic solid on a grid, in one floating-point precision, with its buffer.

    Write into :attr:`field`, apply a map, read the result there: no copies.

    Attributes
    ----------
    grid : Grid
        The grid.
    field : numpy.ndarray, shape grid.shape
        Input and output of every map.
    stiffness : Map
        K: displacement (m) to the pressure that holds it (Pa), symmetric and positive.
    compliance : Map
        Pressure (Pa) to a displacement of zero mean (m).
    largest : float
        Largest eigenvalue of K on this grid (Pa/m).
    mean_stiffness : float
        Stiffness of the mean displacement (Pa/m): zero where it is the load's.
    """

    grid: Grid
    field: np.ndarray
    mean_stiffness: float

    @property
    def stiffness(self) -> Map: ...
    @property
    def compliance(self) -> Map: ...
    @property
    def largest(self) -> float: ...

    def inverse_shifted(self, shift: float) -> Map:
        """(K + shift)⁻¹, the solid on a uniform bed of springs of stiffness ``shift`` (Pa/m), or what is near to it.

        It preconditions: symmetric and positive is all it must be.
        """

    def apply(self, linear_map: Map) -> np.ndarray:
        """Apply a map to :attr:`field` in place; returns it."""

    def apply_and_sum(self, linear_map: Map) -> float:
        """As :meth:`apply`; returns the inner product of field and result, the sum over all points."""

    def interpolate(self, coarser: Any) -> np.ndarray:
        """Write the field of an operator of its kind on a coarser grid, interpolated, into :attr:`field`; returns it.

        What the other's field was is lost.
        """

    def equivalent_pairs(self, grid: Grid) -> float:
        """The work done so far, as pairs of transforms in float64 on ``grid``.

        A pair in float32 counts one half, a coarser grid in proportion to its points: a count of the work
        that does not depend on the machine.
        """


class MakeOperator(Protocol):
    """The operator of a solid on a grid, in ``numpy.float64`` or ``numpy.float32``; its field lies in the memory."""

    def __call__(self, grid: Grid, dtype: type, memory: Memory | None = None) -> Operator: ...


def periodic(elasticity: Elasticity, mean_stiffness: float = 0.0, threads: int = 1) -> MakeOperator:
    """Operators of a periodically repeated solid, see :class:`PeriodicOperator`; they take turns in one spectrum."""
    scratch = Scratch()

    def make(grid: Grid, dtype: type, memory: Memory | None = None) -> Operator:
        return PeriodicOperator(grid, elasticity, dtype, mean_stiffness, threads, scratch, memory)

    return make


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _multiply_spectrum(spectrum, kernel):
    """Spectrum times real kernel, in place; NumPy would first make the kernel complex."""
    rows, columns = spectrum.shape
    for i in range(rows):
        row, factor = spectrum[i], kernel[min(i, rows - i)]
        for j in range(columns):
            row[j] *= factor[j]


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _multiply_and_sum(spectrum, kernel, has_nyquist_column):
    """Spectrum times real kernel, in place; returns Σ kernel·|spectrum|² over all wavevectors."""
    rows, columns = spectrum.shape
    total = 0.0
    for i in range(rows):
        factor = kernel[min(i, rows - i)]
        # A row is summed in the precision of the data, which vectorises; the rows in float64.
        row = factor[0] * (spectrum[i, 0].real ** 2 + spectrum[i, 0].imag ** 2) * kernel.dtype.type(-0.5)
        if has_nyquist_column:
            last = spectrum[i, columns - 1]
            row -= factor[columns - 1] * (last.real**2 + last.imag**2) * kernel.dtype.type(0.5)
        for j in range(columns):
            z = spectrum[i, j]
            k = factor[j]
            row += k * (z.real * z.real + z.imag * z.imag)
            spectrum[i, j] = k * z
        total += 2.0 * row
    return total


class PeriodicOperator:
    """A solid repeated with the period of the grid: its maps are kernels in Fourier space, one pair of transforms each.

    Parameters
    ----------
    grid : Grid
        The periodic grid.
    elasticity : Elasticity
        The solid, by its K(q).
    dtype : type, optional
        ``numpy.float64`` or ``numpy.float32``.
    mean_stiffness : float, optional
        K at q = 0 (Pa/m): zero leaves the mean displacement to the load, a positive value ties it to a spring.
    threads : int, optional
        Threads of the transforms.
    scratch : Scratch, optional
        Memory of the spectrum, which no operator needs beyond the map it applies.
    memory : Memory, optional
        Memory of the field.

    Attributes
    ----------
    field : numpy.ndarray, shape grid.shape
        Input and output of every map.
    """

    def __init__(
        self,
        grid: Grid,
        elasticity: Elasticity,
        dtype: type = np.float64,
        mean_stiffness: float = 0.0,
        threads: int = 1,
        scratch: Scratch | None = None,
        memory: Memory | None = None,
    ):
        self.grid = grid
        self.mean_stiffness = mean_stiffness
        self._elasticity = elasticity
        self._transform = RealTransform(grid.shape, dtype, threads, scratch, memory)
        self.field = self._transform.field

    def _stiffness_q(self, mean_stiffness: float) -> np.ndarray:
        """K of each wavevector in the layout of ``rfft2`` (Pa/m); made anew, the kernels are what is kept.

        K is even in both components of the wavevector: of the rows of −qy, which are those of qy, there are none.
        """
        stiffness_q = self._elasticity.stiffness_on(self.grid)[: self.grid.shape[0] // 2 + 1]
        stiffness_q[0, 0] = mean_stiffness
        return stiffness_q

    def _kernel(self, kernel_q: np.ndarray) -> np.ndarray:
        kernel_q *= 1 / self.grid.points
        return kernel_q.astype(self._transform.dtype)

    @cached_property
    def _stiffness_and_largest(self) -> tuple[np.ndarray, float]:
        stiffness_q = self._stiffness_q(self.mean_stiffness)
        largest = float(stiffness_q.max())
        return self._kernel(stiffness_q), largest

    @property
    def stiffness(self) -> np.ndarray:
        """Kernel of K."""
        return self._stiffness_and_largest[0]

    @property
    def largest(self) -> float:
        """Largest K of a wave of this grid, or the mean's (Pa/m)."""
        return self._stiffness_and_largest[1]

    @cached_property
    def compliance(self) -> np.ndarray:
        """Kernel of 1/K, zero at q = 0: a mean pressure makes no displacement."""
        return self._kernel(1 / self._stiffness_q(np.inf))

    def inverse_shifted(self, shift: float) -> np.ndarray:
        """Kernel of 1/(K + shift)."""
        return self._kernel(1 / (self._stiffness_q(self.mean_stiffness) + shift))

    def apply(self, linear_map: np.ndarray) -> np.ndarray:
        """Multiply the spectrum of :attr:`field`, in place, by a kernel; returns it."""
        self._transform.forward()
        _multiply_spectrum(self._transform.spectrum, linear_map)
        return self._transform.backward()

    def apply_and_sum(self, linear_map: np.ndarray) -> float:
        """As :meth:`apply`; returns the sum over all points of the field times the result.

        The sum is formed on the spectrum while that passes by, before the result exists in real space: an
        iterative solver can then fuse the passes before and after a scalar product.
        """
        self._transform.forward()
        total = _multiply_and_sum(self._transform.spectrum, linear_map, self.grid.shape[1] % 2 == 0)
        self._transform.backward()
        return total

    def interpolate(self, coarser: "PeriodicOperator") -> np.ndarray:
        """See :meth:`Operator.interpolate`; by its trigonometric polynomial."""
        return self._transform.interpolate(coarser._transform)

    @property
    def pairs(self) -> float:
        """Pairs of transforms done so far."""
        return self._transform.pairs

    def equivalent_pairs(self, grid: Grid) -> float:
        """See :meth:`Operator.equivalent_pairs`."""
        weight = self._transform.dtype.itemsize / np.dtype(np.float64).itemsize
        return self.pairs * weight * self.grid.points / grid.points
