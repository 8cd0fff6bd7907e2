"""The block on a uniform bed of springs, inverted: what preconditions the linear problem where atoms attract.

Only waves longer than a few atoms need S there. :class:`HalvedBed` takes those to every second atom along each axis and
answers the rest by one stiffness for each component,

    P (S + c)⁻¹ Pᵀ / 4 + ω / S_max,

P bilinear interpolation, the first term by the same on the coarser grid: symmetric and positive, as the additive
multilevel preconditioner of J. H. Bramble, J. E. Pasciak and J. Xu, Math. Comp. 55, 1 (1990; the abstract was read).
"""

from typing import Protocol

import numpy as np
from numba import njit

from contact_study.fields.fourier import RealTransform
from contact_study.fields.grid import Grid
from contact_study.fields.halving import prolong, restrict

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}

# ω. Pairs of 200² atoms of the paper's surface at 8 ε0 under 0.1, 1 and 10 GPa: 306, 84, 74 with 1; 303, 66, 71 with
# 1.5; 319, 70, 91 with 2.5; 467, 138, 125 with the transforms of all atoms.
SHORT_WAVES = 1.5
# Layers are halved so often, and down to so many points along an axis.
HALVINGS, FEWEST_POINTS = 2, 32


class Bed(Protocol):
    """Where on a layer the inverse acts: on the buffer ``field``, shape (3, ny, nx), in place."""

    field: np.ndarray

    def apply_and_sum(self) -> float:
        """Apply the inverse to :attr:`field`; returns the inner product of field and result."""

    @property
    def pairs(self) -> float:
        """Transform pairs beyond those of the owner of :attr:`field`, in proportion to their points."""


class FullBed:
    """The inverse by transforms.

    Parameters
    ----------
    transform : RealTransform
        Of three components, in float32.
    coefficients : numpy.ndarray of float32, shape (6, ny, nx // 2 + 1)
        S, see :mod:`md_reference.block` (N/m).
    shift : float
        Stiffness of the springs (N/m).
    """

    def __init__(self, transform: RealTransform, coefficients: np.ndarray, shift: float):
        self.field = transform.field
        self._transform = transform
        self._coefficients = coefficients
        self._shift = shift
        grid = Grid((transform.shape[1], transform.shape[2]), (1.0, 1.0))
        self._multiplicity = grid.multiplicity[0].astype(np.float32)

    def apply_and_sum(self) -> float:
        transform = self._transform
        spectrum = transform.forward().view(np.float32)
        product = _invert(spectrum, self._coefficients, self._multiplicity, self._shift, 1 / transform.points)
        transform.backward()
        return product

    @property
    def pairs(self) -> float:
        return 0.0


class HalvedBed:
    """The inverse with long waves on half the resolution.

    Parameters
    ----------
    field : numpy.ndarray of float32, shape (3, 2·rows, 2·columns)
        Buffer of the finer grid.
    coarser : Bed
        The inverse on half the resolution.
    transform : RealTransform
        That owns the buffer of ``coarser``.
    largest : numpy.ndarray, shape (3,)
        Largest stiffness of each component on the finer grid (N/m).
    """

    def __init__(self, field: np.ndarray, coarser: Bed, transform: RealTransform, largest: np.ndarray):
        self.field = field
        self._coarser = coarser
        self._transform = transform
        self._short = np.float32(SHORT_WAVES) / largest

    def apply_and_sum(self) -> float:
        for fine, coarse in zip(self.field, self._coarser.field, strict=True):
            restrict(fine, coarse)
        product = 4 * self._coarser.apply_and_sum()
        for fine, coarse, short in zip(self.field, self._coarser.field, self._short, strict=True):
            product += prolong(coarse, short, fine)
        return product

    @property
    def pairs(self) -> float:
        return (self._transform.pairs + self._coarser.pairs) / 4


def bed_under(
    transform: RealTransform, coefficients: np.ndarray, shift: float, halvings: int = HALVINGS, threads: int = 1
) -> Bed:
    """The bed for a layer, with its long waves on a coarser one where that saves work."""
    rows, columns = transform.shape[1:]
    if not halvings or rows % 2 or columns % 2 or min(rows, columns) < 2 * FEWEST_POINTS:
        return FullBed(transform, coefficients, shift)
    coarse = RealTransform((3, rows // 2, columns // 2), np.float32, threads)
    coarser = bed_under(coarse, _of_every_second_atom(coefficients, columns), shift, halvings - 1, threads)
    return HalvedBed(transform.field, coarser, coarse, coefficients[:3].max(axis=(1, 2)))


def _of_every_second_atom(coefficients: np.ndarray, columns: int) -> np.ndarray:
    """S of the waves that every second atom of a layer with so many columns can carry."""
    rows = coefficients.shape[1]
    kept = np.r_[: rows // 4 + 1, rows - (rows // 2 - rows // 4 - 1) : rows]
    return np.ascontiguousarray(coefficients[:, kept, : columns // 4 + 1])


@njit(**_OPTIONS)
def _invert(spectrum, stiffness, multiplicity, shift, normalisation):
    """Replace the spectrum of r by that of z = (S + shift)⁻¹ r, normalised for the way back; returns r·z."""
    rows, columns = stiffness.shape[1:]
    c_0 = np.float32(shift)
    norm = np.float32(normalisation)
    total = 0.0
    for j in range(rows):
        xx = stiffness[0, j]
        yy = stiffness[1, j]
        zz = stiffness[2, j]
        xy = stiffness[3, j]
        xz = stiffness[4, j]
        yz = stiffness[5, j]
        r_x = spectrum[0, j]
        r_y = spectrum[1, j]
        r_z = spectrum[2, j]
        row = np.float32(0.0)
        for i in range(np.uint64(columns)):
            a = xx[i] + c_0
            b = yy[i] + c_0
            c = zz[i] + c_0
            c_xx = b * c - yz[i] * yz[i]
            c_xy = xz[i] * yz[i] - xy[i] * c
            c_xz = xy[i] * yz[i] - b * xz[i]
            c_yy = a * c - xz[i] * xz[i]
            c_zz = a * b - xy[i] * xy[i]
            c_yz = xy[i] * xz[i] - a * yz[i]
            scale = norm / (a * c_xx + xy[i] * c_xy + xz[i] * c_xz)
            re = np.uint64(2) * np.uint64(i)
            im = re + np.uint64(1)
            # The normal component times i makes the matrix real; see the module ``block``.
            x_re = r_x[re]
            x_im = r_x[im]
            y_re = r_y[re]
            y_im = r_y[im]
            z_re = -r_z[im]
            z_im = r_z[re]
            o_re = scale * (c_xx * x_re + c_xy * y_re + c_xz * z_re)
            o_im = scale * (c_xx * x_im + c_xy * y_im + c_xz * z_im)
            p_re = scale * (c_xy * x_re + c_yy * y_re + c_yz * z_re)
            p_im = scale * (c_xy * x_im + c_yy * y_im + c_yz * z_im)
            q_re = scale * (c_xz * x_re + c_yz * y_re + c_zz * z_re)
            q_im = scale * (c_xz * x_im + c_yz * y_im + c_zz * z_im)
            r_x[re] = o_re
            r_x[im] = o_im
            r_y[re] = p_re
            r_y[im] = p_im
            r_z[re] = q_im
            r_z[im] = -q_re
            row += multiplicity[i] * (x_re * o_re + x_im * o_im + y_re * p_re + y_im * p_im + z_re * q_re + z_im * q_im)
        total += float(row)
    return total
