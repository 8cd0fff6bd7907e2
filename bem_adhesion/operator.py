"""The periodically loaded elastic half-space: Green's function in Fourier space and the operator applying it.

A frictionless pressure of wavenumber q on a half-space of contact modulus E* displaces its surface by
2p/(E* q) (K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 13; A. Stanley & T. Kato, J. Tribol. 119, 481
(1997)).
Kernels are small pure functions of a grid; :class:`HalfSpace` is the one place that meets the transform.
"""

from functools import cached_property

import numpy as np
from numba import njit

from contact_study.fields.fourier import RealTransform
from contact_study.fields.grid import Grid


def stiffness(grid: Grid, contact_modulus: float, mean_stiffness: float = 0.0) -> np.ndarray:
    """Pressure per displacement of each wavevector, K_q = E* q / 2, in the layout of ``rfft2`` (Pa/m).

    Parameters
    ----------
    grid : Grid
        The periodic grid.
    contact_modulus : float
        E* = E / (1 − ν²) (Pa).
    mean_stiffness : float, optional
        Value at q = 0 (Pa/m). A periodic half-space has none: zero leaves the mean displacement to the load,
        a positive value ties it to a spring.

    Returns
    -------
    numpy.ndarray, shape grid.spectrum_shape
    """
    stiffness_q = 0.5 * contact_modulus * grid.wavenumber
    stiffness_q[0, 0] = mean_stiffness
    return stiffness_q


def compliance(grid: Grid, contact_modulus: float) -> np.ndarray:
    """Displacement per pressure of each wavevector, 2 / (E* q), in the layout of ``rfft2`` (m/Pa).

    A half-space has no mean displacement under a mean pressure; that entry is zero, so that the result of
    applying the compliance has zero mean. Parameters as in :func:`stiffness`.
    """
    compliance_q = np.zeros(grid.spectrum_shape)
    stiffness_q = stiffness(grid, contact_modulus)
    np.divide(1.0, stiffness_q, out=compliance_q, where=stiffness_q > 0)
    return compliance_q


def shifted_compliance(grid: Grid, contact_modulus: float, shift: float) -> np.ndarray:
    """1 / (E* q / 2 + shift): the half-space on a uniform bed of springs, the core of preconditioners (m/Pa).

    Parameters
    ----------
    grid, contact_modulus
        As in :func:`stiffness`.
    shift : float
        Stiffness of the bed of springs (Pa/m), positive.
    """
    return 1.0 / (stiffness(grid, contact_modulus) + shift)


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _multiply_spectrum(spectrum, kernel):
    """Spectrum times real kernel, in place, both flat; NumPy would first make the kernel complex."""
    for i in range(kernel.size):
        spectrum[i] *= kernel[i]


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _multiply_and_sum(spectrum, kernel, has_nyquist_column):
    """Spectrum times real kernel, in place; returns Σ kernel·|spectrum|² over all wavevectors."""
    rows, columns = kernel.shape
    total = 0.0
    for i in range(rows):
        # A row is summed in the precision of the data, which vectorises; the rows in float64.
        row = kernel[i, 0] * (spectrum[i, 0].real ** 2 + spectrum[i, 0].imag ** 2) * kernel.dtype.type(-0.5)
        if has_nyquist_column:
            last = spectrum[i, columns - 1]
            row -= kernel[i, columns - 1] * (last.real**2 + last.imag**2) * kernel.dtype.type(0.5)
        for j in range(columns):
            z = spectrum[i, j]
            k = kernel[i, j]
            row += k * (z.real * z.real + z.imag * z.imag)
            spectrum[i, j] = k * z
        total += 2.0 * row
    return total


class HalfSpace:
    """An elastic half-space on a periodic grid, in one floating-point precision, with its buffer.

    Write into :attr:`field`, call :meth:`stiffness`, :meth:`compliance` or :meth:`apply`, read the result
    there: no copies, one pair of transforms.

    Parameters
    ----------
    grid : Grid
        The periodic grid.
    contact_modulus : float
        E* (Pa).
    dtype : type, optional
        ``numpy.float64`` or ``numpy.float32``.
    mean_stiffness : float, optional
        Stiffness of the mean displacement, see :func:`stiffness` (Pa/m).
    threads : int, optional
        Threads of the transforms.

    Attributes
    ----------
    field : numpy.ndarray, shape grid.shape
        Input and output of every operation.
    """

    def __init__(
        self,
        grid: Grid,
        contact_modulus: float,
        dtype: type = np.float64,
        mean_stiffness: float = 0.0,
        threads: int = 1,
    ):
        self.grid = grid
        self.contact_modulus = contact_modulus
        self.mean_stiffness = mean_stiffness
        self._transform = RealTransform(grid.shape, dtype, threads)
        self.field = self._transform.field

    def kernel(self, kernel_q: np.ndarray) -> np.ndarray:
        """Prepare a real kernel of shape ``grid.spectrum_shape`` for :meth:`apply`."""
        return (kernel_q / self.grid.points).astype(self._transform.dtype)

    def apply(self, kernel: np.ndarray) -> np.ndarray:
        """Multiply the spectrum of :attr:`field`, in place, by a kernel from :meth:`kernel`; returns it."""
        self._transform.forward()
        _multiply_spectrum(self._transform.spectrum.reshape(-1), kernel.reshape(-1))
        return self._transform.backward()

    def apply_and_sum(self, kernel: np.ndarray) -> float:
        """As :meth:`apply`; returns the sum over all points of the field times the result.

        The sum is formed on the spectrum while that passes by, before the result exists in real space: an
        iterative solver can then fuse the passes before and after a scalar product.
        """
        self._transform.forward()
        total = _multiply_and_sum(self._transform.spectrum, kernel, self.grid.shape[1] % 2 == 0)
        self._transform.backward()
        return total

    def stiffness(self) -> np.ndarray:
        """Turn the displacement in :attr:`field` (m) into the pressure that holds it (Pa); returns it."""
        return self.apply(self._stiffness_kernel)

    def compliance(self) -> np.ndarray:
        """Turn the pressure in :attr:`field` (Pa) into a displacement of zero mean (m); returns it."""
        return self.apply(self._compliance_kernel)

    @cached_property
    def _stiffness_kernel(self) -> np.ndarray:
        return self.kernel(stiffness(self.grid, self.contact_modulus, self.mean_stiffness))

    @cached_property
    def _compliance_kernel(self) -> np.ndarray:
        return self.kernel(compliance(self.grid, self.contact_modulus))

    @property
    def pairs(self) -> float:
        """Pairs of transforms done so far."""
        return self._transform.pairs

    def equivalent_pairs(self, grid: Grid) -> float:
        """The work done so far, as pairs in float64 on ``grid``.

        A pair in float32 counts one half, a coarser grid in proportion to its points: a count of the work
        that does not depend on the machine.
        """
        weight = self._transform.dtype.itemsize / np.dtype(np.float64).itemsize
        return self.pairs * weight * self.grid.points / grid.points
