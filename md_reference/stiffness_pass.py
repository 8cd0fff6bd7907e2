"""The block's stiffness applied wave by wave, see the module :mod:`md_reference.block` for its real form."""

import numpy as np
from numba import njit

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}


@njit(**_OPTIONS)
def multiply(spectrum, stiffness, multiplicity, normalisation):
    """Replace the spectrum of s by that of S s; returns s·S s.

    Parameters
    ----------
    spectrum : numpy.ndarray, shape (3, ny, 2 (nx // 2 + 1))
        Of s, real and imaginary parts in turn, single or double precision as all else.
    stiffness : numpy.ndarray, shape (6, ny, nx // 2 + 1)
        S: xx, yy, zz, xy, xz, yz.
    multiplicity : numpy.ndarray, shape (nx // 2 + 1,)
        How many waves an entry of the half spectrum stands for.
    normalisation : float
        Factor of S s: the inverse number of points on the way back, or one where S holds it.
    """
    rows, columns = stiffness.shape[1:]
    norm = np.float32(normalisation)
    total = 0.0
    for j in range(rows):
        xx = stiffness[0, j]
        yy = stiffness[1, j]
        zz = stiffness[2, j]
        xy = stiffness[3, j]
        xz = stiffness[4, j]
        yz = stiffness[5, j]
        s_x = spectrum[0, j]
        s_y = spectrum[1, j]
        s_z = spectrum[2, j]
        row = np.float32(0.0)
        for i in range(np.uint64(columns)):
            re = np.uint64(2) * np.uint64(i)
            im = re + np.uint64(1)
            x_re = s_x[re]
            x_im = s_x[im]
            y_re = s_y[re]
            y_im = s_y[im]
            z_re = -s_z[im]
            z_im = s_z[re]
            o_re = norm * (xx[i] * x_re + xy[i] * y_re + xz[i] * z_re)
            o_im = norm * (xx[i] * x_im + xy[i] * y_im + xz[i] * z_im)
            p_re = norm * (xy[i] * x_re + yy[i] * y_re + yz[i] * z_re)
            p_im = norm * (xy[i] * x_im + yy[i] * y_im + yz[i] * z_im)
            q_re = norm * (xz[i] * x_re + yz[i] * y_re + zz[i] * z_re)
            q_im = norm * (xz[i] * x_im + yz[i] * y_im + zz[i] * z_im)
            s_x[re] = o_re
            s_x[im] = o_im
            s_y[re] = p_re
            s_y[im] = p_im
            s_z[re] = q_im
            s_z[im] = -q_re
            row += multiplicity[i] * (x_re * o_re + x_im * o_im + y_re * p_re + y_im * p_im + z_re * q_re + z_im * q_im)
        total += float(row)
    return total
