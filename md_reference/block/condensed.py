"""The harmonic block, condensed exactly onto its bottom layer of atoms.

A simple cubic lattice of linear springs, periodic in x and y and clamped at the top, acts on its bottom layer through
one 3×3 matrix S(q) per lateral wavevector, by binary doubling of one layer of cells. With u_z replaced by i u_z every
S(q) is real and symmetric: xx, yy, zz, xy, xz, yz.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import contact_modulus_of

_kernel = njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})

# Corners of a cubic cell; degree of freedom 3 * corner + component.
_ROWS, _COLUMNS = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)  # of the six numbers of a matrix
CORNERS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)])


def lame_constants(youngs_modulus: float, poissons_ratio: float) -> tuple[float, float]:
    """Return the first Lamé constant λ and the shear modulus μ (Pa) of an isotropic solid."""
    shear_modulus = youngs_modulus / (2 * (1 + poissons_ratio))
    first = youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio))
    return first, shear_modulus


def isotropic_element(lattice_constant: float, youngs_modulus: float, poissons_ratio: float) -> np.ndarray:
    """Return the stiffness of one cubic cell of an elastically isotropic lattice, shape (24, 24) (N/m).

    Springs μa act along the edges and the face diagonals, beside a dilatation energy ½(λ−μ)a³θ² of the cell. A cell
    owns a quarter of each edge and half of each face diagonal, so that free surfaces are consistent.
    """
    first, shear_modulus = lame_constants(youngs_modulus, poissons_ratio)
    element = np.zeros((24, 24))
    for p in range(8):
        for q in range(p):
            bond = CORNERS[p] - CORNERS[q]
            squared_length = int(bond @ bond)
            if squared_length > 2:
                continue
            elongation = np.zeros((8, 3))
            elongation[p] = bond / np.sqrt(squared_length)
            elongation[q] = -elongation[p]
            stiffness = 0.25 * squared_length * shear_modulus * lattice_constant
            element += stiffness * np.outer(elongation, elongation)
    dilatation = ((2 * CORNERS - 1) / (4 * lattice_constant)).ravel()
    return element + (first - shear_modulus) * lattice_constant**3 * np.outer(dilatation, dilatation)


@_kernel
def _stack(lower, upper, out):
    """Eliminate the common plane of two slabs; slab[0, 1, 2] are A, B, D of [[A, B], [Bᵀ, D]], real."""
    i_xx, i_yy, i_zz, i_xy, i_xz, i_yz = invert_symmetric(
        lower[2, 0, 0] + upper[0, 0, 0],
        lower[2, 1, 1] + upper[0, 1, 1],
        lower[2, 2, 2] + upper[0, 2, 2],
        lower[2, 0, 1] + upper[0, 0, 1],
        lower[2, 0, 2] + upper[0, 0, 2],
        lower[2, 1, 2] + upper[0, 1, 2],
    )
    inverse = ((i_xx, i_xy, i_xz), (i_xy, i_yy, i_yz), (i_xz, i_yz, i_zz))
    for r in range(3):
        for c in range(3):
            to_a = to_b = to_d = 0.0
            for k in range(3):
                for m in range(3):
                    to_a += lower[1, r, k] * inverse[k][m] * lower[1, c, m]
                    to_b += lower[1, r, k] * inverse[k][m] * upper[1, m, c]
                    to_d += upper[1, k, r] * inverse[k][m] * upper[1, m, c]
            out[0, r, c] = lower[0, r, c] - to_a
            out[1, r, c] = -to_b
            out[2, r, c] = upper[2, r, c] - to_d


@_kernel
def invert_symmetric(xx, yy, zz, xy, xz, yz):
    """Invert a symmetric 3×3 matrix, six numbers for six."""
    c_xx = yy * zz - yz * yz
    c_xy = xz * yz - xy * zz
    c_xz = xy * yz - yy * xz
    scale = 1.0 / (xx * c_xx + xy * c_xy + xz * c_xz)
    return (
        c_xx * scale,
        (xx * zz - xz * xz) * scale,
        (xx * yy - xy * xy) * scale,
        c_xy * scale,
        c_xz * scale,
        (xy * xz - xx * yz) * scale,
    )


@_kernel
def _bloch(element, phase_y, phase_x, slab):
    """Write the real form of the matrices A, B, D between the two planes of one layer of cells."""
    slab[:] = 0.0
    for p in range(8):
        for q in range(8):
            if p >> 2 > q >> 2:
                continue  # Bᵀ
            phase = phase_x * ((q & 1) - (p & 1)) + phase_y * (((q >> 1) & 1) - ((p >> 1) & 1))
            cosine = np.cos(phase)
            sine = np.sin(phase)
            for c in range(3):
                for d in range(3):
                    factor = cosine
                    if c != 2 and d == 2:
                        factor = sine
                    elif c == 2 and d != 2:
                        factor = -sine
                    slab[(p >> 2) + (q >> 2), c, d] += factor * element[3 * p + c, 3 * q + d]


@_kernel
def _condense(element, phase_y, phase_x, layers, coefficients):
    """Fill coefficients[6, n] with S of ``layers`` cells under a clamped plane, for n pairs of Bloch phases."""
    # Slabs of 2^bit layers in ``powers``, what is stacked so far in ``stacked``, two buffers each.
    powers, stacked = np.empty((2, 3, 3, 3)), np.empty((2, 3, 3, 3))
    for n in range(phase_y.size):
        power, current = 0, -1
        _bloch(element, phase_y[n], phase_x[n], powers[0])
        remaining = layers
        while True:
            if remaining & 1:
                if current < 0:
                    current = 0
                    stacked[0] = powers[power]
                else:
                    _stack(stacked[current], powers[power], stacked[1 - current])
                    current = 1 - current
            remaining >>= 1
            if remaining == 0:
                break
            _stack(powers[power], powers[power], powers[1 - power])
            power = 1 - power
        for c in range(6):
            coefficients[c, n] = stacked[current, 0, _ROWS[c], _COLUMNS[c]]


@dataclass(frozen=True)
class SurfaceStiffness:
    """S(q) of a block on the half spectrum of its bottom layer, in the real form (N/m, shape (6, ny, nx // 2 + 1)).

    S_zz at q = 0 is the uniform compression, which calculations under prescribed pressure or mean height omit.
    """

    grid: Grid
    lattice_constant: float
    coefficients: np.ndarray

    @property
    def normal_stiffness(self) -> np.ndarray:
        """K = 1/(a² [S⁻¹]_zz), the normal pressure per displacement without shear stress (Pa/m)."""
        return 1 / (self.area_per_atom * invert_symmetric.py_func(*self.coefficients)[2])  # on whole arrays

    @property
    def contact_modulus(self) -> np.ndarray:
        """E*(q) on the half spectrum (Pa), NaN at q = 0."""
        wavenumber = np.where(self.grid.wavenumber > 0, self.grid.wavenumber, np.nan)
        return contact_modulus_of(self.normal_stiffness, wavenumber)

    @property
    def area_per_atom(self) -> float:
        """a² (m²)."""
        return self.lattice_constant**2


def surface_stiffness(
    element: np.ndarray, shape: tuple[int, int], lattice_constant: float, layers: int
) -> SurfaceStiffness:
    """Return S(q) of a block of ``shape`` (y, x) atoms per layer and ``layers`` cells under a clamped plane.

    ``element`` is the stiffness of one cell of any harmonic model of cubic symmetry, shape (24, 24) (N/m).
    """
    if layers < 1:
        raise ValueError(f"atomistic.layers: a block needs at least one layer of cells, got {layers}")
    grid = Grid(shape, (shape[0] * lattice_constant, shape[1] * lattice_constant))
    # Phases from integers: the Nyquist phase is then exactly π and the matrix there real to rounding.
    phase_y, phase_x = np.meshgrid(np.fft.fftfreq(shape[0]), np.fft.rfftfreq(shape[1]), indexing="ij")
    coefficients = np.empty((6, *phase_y.shape))
    _condense(element, 2 * np.pi * phase_y.ravel(), 2 * np.pi * phase_x.ravel(), layers, coefficients.reshape(6, -1))
    return SurfaceStiffness(grid, lattice_constant, coefficients)


def effective_contact_modulus(stiffness: SurfaceStiffness, heights: np.ndarray) -> float:
    """Return E*(q) averaged over the heights' waves by energy of full contact, q|h_q|² (Pa); flat: the longest wave."""
    grid = stiffness.grid
    weight = grid.multiplicity * grid.wavenumber * np.abs(fourier.transform(heights)) ** 2
    if not weight.any():
        weight = (grid.wavenumber == np.min(grid.wavenumber[grid.wavenumber > 0])).astype(float)
    modulus = np.nan_to_num(stiffness.contact_modulus)  # NaN at q = 0 only, where the weight is zero
    return float(np.sum(weight * modulus) / np.sum(weight))
