"""The linear problem of one Newton step: conjugate gradients with one Fourier transform pair an iteration.

Solve (S + D) x = −g, S the block's surface stiffness and D one 3×3 matrix an atom. The preconditioner is (S + c)⁻¹,
applied in Fourier space. For z = (S + c)⁻¹ r the product S z = r − c z is at hand, so that (S + D) z = r + (D − c) z
costs no transform of its own. The arithmetic is single precision on a right-hand side scaled to one: the step only has
to be good to the forcing term of the truncated Newton method, whose residual is evaluated in double precision.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from contact_study.fields.fourier import RealTransform
from md_reference.block import SurfaceStiffness

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}


@dataclass(frozen=True)
class NewtonStep:
    """Outcome of a linear solve.

    Attributes
    ----------
    step : numpy.ndarray, shape (3, ny, nx)
        Approximate solution x (m).
    iterations : int
        Conjugate-gradient iterations, each of one transform pair.
    indefinite : bool
        True if a direction of negative curvature ended the iteration; ``step`` is what was reached before.
    """

    step: np.ndarray
    iterations: int
    indefinite: bool


class NewtonSolver:
    """Owner of the single-precision arrays and transforms.

    Parameters
    ----------
    stiffness : SurfaceStiffness
        S of the block; S_zz at q = 0 is left out.
    fixed_mean : bool
        Keep the mean of the normal component (gap control) instead of leaving it free (pressure control).
    threads : int, optional
        Threads of FFTW.

    Attributes
    ----------
    diagonal : numpy.ndarray of float32, shape (6, ny, nx)
        D (N/m), to be written by the caller: xx, yy, zz, xy, xz, yz.
    direction : numpy.ndarray of float32, shape (3, ny, nx)
        The last search direction: one of negative curvature if the solver stopped on it.
    """

    def __init__(self, stiffness: SurfaceStiffness, fixed_mean: bool, threads: int = 1):
        shape = (3, *stiffness.grid.shape)
        self.transform = RealTransform(shape, np.float32, threads)
        self.fixed_mean = fixed_mean
        self.diagonal = np.zeros((6, *shape[1:]), np.float32)
        self._coefficients = stiffness.coefficients.astype(np.float32)
        self._coefficients[2, 0, 0] = 0.0
        self._multiplicity = stiffness.grid.multiplicity[0].astype(np.float32)
        self._residual = np.empty(shape, np.float32)
        self._solution = np.empty(shape, np.float32)
        self.direction = np.empty(shape, np.float32)
        self._image = np.empty(shape, np.float32)

    def solve(self, gradient: np.ndarray, shift: float, reduction: float, max_iterations: int) -> NewtonStep:
        """Solve (S + D) x = −gradient with the D that the caller has put into :attr:`diagonal`.

        Parameters
        ----------
        gradient : numpy.ndarray, shape (3, ny, nx)
            Right-hand side, negated (N); its normal mean is zero if that mean is fixed.
        shift : float
            c of the preconditioner (N/m), positive.
        reduction : float
            Stop when the residual's norm has fallen by this factor.
        max_iterations : int
            Largest number of iterations.
        """
        scale = float(np.max(np.abs(gradient)))
        spectrum = self.transform.spectrum.view(np.float32)
        field = self.transform.field
        np.multiply(gradient, -1 / scale, out=self._residual, casting="same_kind")
        field[...] = self._residual
        self._solution[...] = 0.0
        self.direction[...] = 0.0
        self._image[...] = 0.0
        target = reduction**2 * float(np.sum(self._residual * self._residual, dtype=np.float64))
        previous = 1.0
        indefinite = False
        iterations = 0
        while iterations < max_iterations:
            self.transform.forward()
            product = _precondition(
                spectrum, self._coefficients, self._multiplicity, shift, 1 / self.transform.points, self.fixed_mean
            )
            if not product > 0.0:
                break  # rounding is all that is left
            self.transform.backward()
            iterations += 1
            ratio = product / previous if iterations > 1 else 0.0
            previous = product
            curvature = _advance_direction(
                field, self._residual, self.diagonal, shift, ratio, self.direction, self._image
            )
            if not curvature > 1e-12 * product:
                indefinite = True
                break
            squares, normal_sum = _advance_solution(
                product / curvature, self.direction, self._image, self._solution, self._residual, field
            )
            if self.fixed_mean:
                # A uniform normal residual is the constraint's own force, which the preconditioner drops.
                squares -= normal_sum**2 / self.transform.points
            if squares <= target:
                break
        step = self._solution * scale
        return NewtonStep(step, iterations, indefinite)

    def unstable_direction(self, shift: float, max_iterations: int) -> np.ndarray | None:
        """A direction of negative curvature of S + D, shape (3, ny, nx); None if conjugate gradients meet none.

        Their right side is random (the same each time) and lies where D is negative, as every unstable mode does.

        Parameters
        ----------
        shift, max_iterations
            As in :meth:`solve`.
        """
        start = np.maximum(-self.diagonal[:3], 0)
        start *= 1 + np.random.default_rng(0).standard_normal(start.shape, dtype=np.float32)
        if self.fixed_mean:
            start[2] -= np.mean(start[2])
        if not start.any():
            return None
        found = self.solve(start, shift, 0.0, max_iterations)
        return self.direction / np.abs(self.direction).max() if found.indefinite else None


@njit(**_OPTIONS)
def _precondition(spectrum, stiffness, multiplicity, shift, normalisation, fixed_mean):
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
    if fixed_mean:
        # At q = 0 the normal component is decoupled: r_z z_z = normalisation r_z² / shift.
        mean = spectrum[2, 0, 0]
        total -= mean * mean * shift / normalisation
        spectrum[2, 0, 0] = np.float32(0.0)
        spectrum[2, 0, 1] = np.float32(0.0)
    return total


@njit(**_OPTIONS)
def _advance_direction(z, r, diagonal, shift, ratio, direction, image):
    """direction = z + ratio·direction and image = (S + D) direction by the same recurrence; returns their product."""
    rows, columns = z.shape[1:]
    c_0 = np.float32(shift)
    beta = np.float32(ratio)
    total = 0.0
    for j in range(rows):
        row = np.float32(0.0)
        for i in range(columns):
            x = z[0, j, i]
            y = z[1, j, i]
            w = z[2, j, i]
            xy = diagonal[3, j, i]
            xz = diagonal[4, j, i]
            yz = diagonal[5, j, i]
            h_x = r[0, j, i] + (diagonal[0, j, i] - c_0) * x + xy * y + xz * w + beta * image[0, j, i]
            h_y = r[1, j, i] + xy * x + (diagonal[1, j, i] - c_0) * y + yz * w + beta * image[1, j, i]
            h_z = r[2, j, i] + xz * x + yz * y + (diagonal[2, j, i] - c_0) * w + beta * image[2, j, i]
            x += beta * direction[0, j, i]
            y += beta * direction[1, j, i]
            w += beta * direction[2, j, i]
            direction[0, j, i] = x
            direction[1, j, i] = y
            direction[2, j, i] = w
            image[0, j, i] = h_x
            image[1, j, i] = h_y
            image[2, j, i] = h_z
            row += x * h_x + y * h_y + w * h_z
        total += float(row)
    return total


@njit(**_OPTIONS)
def _advance_solution(length, direction, image, solution, r, field):
    """Step along the direction, the new residual also into ``field``; returns r·r and Σr_z."""
    alpha = np.float32(length)
    squares = 0.0
    normal_sum = 0.0
    for c in range(3):
        for j in range(r.shape[1]):
            row = np.float32(0.0)
            row_sum = np.float32(0.0)
            for i in range(r.shape[2]):
                solution[c, j, i] += alpha * direction[c, j, i]
                value = r[c, j, i] - alpha * image[c, j, i]
                r[c, j, i] = value
                field[c, j, i] = value
                row += value * value
                row_sum += value
            squares += float(row)
            if c == 2:
                normal_sum += float(row_sum)
    return squares, normal_sum
