"""Kernels that apply the condensed block's stiffness S(q), or its inverse, wave by wave.

S is in the real form of :mod:`md_reference.block.condensed`. Single- and double-precision spectra of three components
hold real and imaginary parts in turn, shape (3, ny, 2 (nx // 2 + 1)), except where they are complex.
"""

import numpy as np

from contact_study.numerics.kernel import kernel


@kernel
def act_on_wave(s_x, s_y, s_z, i, norm, xx, yy, zz, xy, xz, yz):
    """Replace the i-th wave of a row by ``norm`` times a matrix times it; return the product of both."""
    re = np.uint64(2) * np.uint64(i)
    im = re + np.uint64(1)
    x_re, x_im = s_x[re], s_x[im]
    y_re, y_im = s_y[re], s_y[im]
    z_re, z_im = -s_z[im], s_z[re]
    o_re = norm * (xx * x_re + xy * y_re + xz * z_re)
    o_im = norm * (xx * x_im + xy * y_im + xz * z_im)
    p_re = norm * (xy * x_re + yy * y_re + yz * z_re)
    p_im = norm * (xy * x_im + yy * y_im + yz * z_im)
    q_re = norm * (xz * x_re + yz * y_re + zz * z_re)
    q_im = norm * (xz * x_im + yz * y_im + zz * z_im)
    s_x[re], s_x[im] = o_re, o_im
    s_y[re], s_y[im] = p_re, p_im
    s_z[re], s_z[im] = q_im, -q_re
    return x_re * o_re + x_im * o_im + y_re * p_re + y_im * p_im + z_re * q_re + z_im * q_im


@kernel
def multiply(spectrum, stiffness, multiplicity, normalisation):
    """Replace the spectrum of s by ``normalisation`` times that of S s; return s·S s.

    ``multiplicity`` counts the waves that each column of the half spectrum represents.
    """
    rows, columns = stiffness.shape[1:]
    norm = np.float32(normalisation)
    total = 0.0
    for j in range(rows):
        xx, yy, zz = stiffness[0, j], stiffness[1, j], stiffness[2, j]
        xy, xz, yz = stiffness[3, j], stiffness[4, j], stiffness[5, j]
        s_x, s_y, s_z = spectrum[0, j], spectrum[1, j], spectrum[2, j]
        row = np.float32(0.0)
        for i in range(np.uint64(columns)):
            product = act_on_wave(s_x, s_y, s_z, i, norm, xx[i], yy[i], zz[i], xy[i], xz[i], yz[i])
            row += multiplicity[i] * product
        total += float(row)
    return total


@kernel
def invert(spectrum, stiffness, multiplicity, shift, normalisation):
    """Replace the spectrum of r by ``normalisation`` times that of z = (S + shift)⁻¹ r; return r·z."""
    rows, columns = stiffness.shape[1:]
    c_0 = np.float32(shift)
    norm = np.float32(normalisation)
    total = 0.0
    for j in range(rows):
        xx, yy, zz = stiffness[0, j], stiffness[1, j], stiffness[2, j]
        xy, xz, yz = stiffness[3, j], stiffness[4, j], stiffness[5, j]
        r_x, r_y, r_z = spectrum[0, j], spectrum[1, j], spectrum[2, j]
        row = np.float32(0.0)
        for i in range(np.uint64(columns)):
            a, b, c = xx[i] + c_0, yy[i] + c_0, zz[i] + c_0
            c_xx = b * c - yz[i] * yz[i]
            c_xy = xz[i] * yz[i] - xy[i] * c
            c_xz = xy[i] * yz[i] - b * xz[i]
            c_yy = a * c - xz[i] * xz[i]
            c_zz = a * b - xy[i] * xy[i]
            c_yz = xy[i] * xz[i] - a * yz[i]
            scale = norm / (a * c_xx + xy[i] * c_xy + xz[i] * c_xz)
            product = act_on_wave(r_x, r_y, r_z, i, scale, c_xx, c_yy, c_zz, c_xy, c_xz, c_yz)
            row += multiplicity[i] * product
        total += float(row)
    return total


@kernel
def accelerate(velocity, displacement, force, coefficients, over_mass, dt):
    """Add dt (force − S displacement)/mass to the velocity; complex spectra."""
    for j in range(force.shape[1]):
        for i in range(force.shape[2]):
            s_x, s_y, s_z, _, _, _ = _product(coefficients[:, j, i], displacement[:, j, i])
            velocity[0, j, i] += dt * over_mass[0, j, i] * (force[0, j, i] - s_x)
            velocity[1, j, i] += dt * over_mass[1, j, i] * (force[1, j, i] - s_y)
            velocity[2, j, i] += dt * over_mass[2, j, i] * (force[2, j, i] + 1j * s_z)


@kernel
def quadratic(displacement, coefficients, multiplicity):
    """Return the sum of u†Su over all waves of a complex spectrum."""
    total = 0.0
    for j in range(displacement.shape[1]):
        row = 0.0
        for i in range(displacement.shape[2]):
            s_x, s_y, s_z, x, y, z = _product(coefficients[:, j, i], displacement[:, j, i])
            row += multiplicity[0, i] * (
                (x.real * s_x.real + x.imag * s_x.imag)
                + (y.real * s_y.real + y.imag * s_y.imag)
                + (z.real * s_z.real + z.imag * s_z.imag)
            )
        total += row
    return total


@kernel
def _product(stiffness, u):
    """Return the real symmetric form of S times (u_x, u_y, i u_z), and these three."""
    x, y, z = u[0], u[1], 1j * u[2]
    return (
        stiffness[0] * x + stiffness[3] * y + stiffness[4] * z,
        stiffness[3] * x + stiffness[1] * y + stiffness[5] * z,
        stiffness[4] * x + stiffness[5] * y + stiffness[2] * z,
        x,
        y,
        z,
    )
