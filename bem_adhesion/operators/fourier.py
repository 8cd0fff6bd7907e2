"""The periodic elastic solid on a grid, linear maps applied by Fourier transforms, and loads on it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bem_adhesion.operators.trace import Phase, Reporter, Trace, TracedTransform
from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product, kernel
from contact_study.numerics.memory import Memory, Scratch
from contact_study.physics.solids import Elasticity


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

    ``stiffness`` is K, ``largest`` its largest eigenvalue; ``compliance`` leads to a displacement of zero mean;
    ``mean_stiffness`` (Pa/m) is K at q = 0, a spring on the mean displacement.
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
        reporter: Reporter | None = None,
    ):
        self.grid = grid
        self.mean_stiffness = mean_stiffness
        self._elasticity = elasticity
        self._reporter = reporter
        transform = (grid.shape, dtype, threads, scratch, memory)
        self._transform = RealTransform(*transform) if reporter is None else TracedTransform(reporter, *transform)
        self.field = self._transform.field

    def mark(self, phase: Phase, residual: float | None = None) -> None:
        """Report a phase to the trace, if there is one."""
        if self._reporter is not None:
            self._reporter.mark(phase, self.grid.shape, residual)

    def _stiffness_q(self, mean_stiffness: float) -> np.ndarray:
        """Return K of each wavevector (Pa/m) by ``rfft2`` without the rows of −qy, equal to those of qy."""
        stiffness_q = self._elasticity.stiffness_on(self.grid)[: self.grid.shape[0] // 2 + 1]
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
        return self._factors(1 / self._stiffness_q(np.inf))

    def inverse_shifted(self, shift: float) -> np.ndarray:
        """Prepare (K + shift)⁻¹ for a uniform shift (Pa/m)."""
        return self._factors(1 / (self._stiffness_q(self.mean_stiffness) + shift))

    def apply(self, linear_map: np.ndarray) -> np.ndarray:
        """Apply a map to :attr:`field` in place; return the field."""
        self._transform.forward()
        _multiply_spectrum(self._transform.spectrum, linear_map)
        return self._transform.backward()

    def apply_and_sum(self, linear_map: np.ndarray) -> float:
        """Apply a map as :meth:`apply`; return the inner product of input and result."""
        # The sum is formed on the spectrum, before the result exists in real space: the passes around it can be fused.
        self._transform.forward()
        total = _multiply_and_sum(self._transform.spectrum, linear_map, self.grid.shape[1] % 2 == 0)
        self._transform.backward()
        return total

    def interpolate(self, coarser: "PeriodicOperator") -> np.ndarray:
        """Interpolate the field of the same operator on a coarser grid, destroying it, into :attr:`field`."""
        return self._transform.interpolate(coarser._transform)

    @property
    def pairs(self) -> float:
        """Transform pairs so far."""
        return self._transform.pairs

    def equivalent_pairs(self, grid: Grid) -> float:
        """Return the pairs so far as float64 pairs on ``grid``; one in float32 counts half."""
        weight = self._transform.dtype.itemsize / np.dtype(np.float64).itemsize
        return self.pairs * weight * self.grid.points / grid.points


MakeOperator = Callable[..., PeriodicOperator]
"""Make the operator of a solid on a grid in ``numpy.float64`` or ``numpy.float32``; ``memory`` holds its field."""


def periodic(
    elasticity: Elasticity, mean_stiffness: float = 0.0, threads: int = 1, trace: Trace | None = None
) -> MakeOperator:
    """Return a maker of :class:`PeriodicOperator`; all operators that it makes share one spectrum."""
    scratch = Scratch()
    reporter = None if trace is None else Reporter(trace)

    def make(grid: Grid, dtype: type, memory: Memory | None = None) -> PeriodicOperator:
        return PeriodicOperator(grid, elasticity, dtype, mean_stiffness, threads, scratch, memory, reporter)

    return make


@dataclass(frozen=True)
class Load:
    """A uniform pressure and a field of pressures (Pa), or with a ``unit`` heights h in it (m).

    A solver needs ``pressing`` = K d + field and the field's energy. K h is not stored: pressing = K (d + h), and
    ½ <d, K d> + <d, K h> = ½ <pressing, d + h> − ½ <h, K h>.
    """

    field: np.ndarray
    unit: float | None = None
    pressure: float = 0.0
    energy: float = 0.0  # the part that does not depend on the gap (J/m²)

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
