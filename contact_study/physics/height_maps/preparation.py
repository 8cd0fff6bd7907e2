"""Preparation of a measured map for a periodic calculation: heights (y, x) in and out, NaN where missing."""

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid

# In place of the number of a missing height.
_KNOWN, _OUTSIDE = -1, -2


def detrended(heights: np.ndarray, degree: int) -> np.ndarray:
    """Subtract the least-squares polynomial of a total degree (0: the mean) from heights, NaN where missing."""
    present = np.isfinite(heights)
    known = np.where(present, heights, 0.0)
    rows, columns = (np.polynomial.legendre.legvander(np.linspace(-1, 1, n), degree).T for n in heights.shape)
    terms = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    gram = np.array(
        [[(rows[i] * rows[k]) @ present @ (columns[j] * columns[m]) for k, m in terms] for i, j in terms], dtype=float
    )
    right = np.array([rows[i] @ known @ columns[j] for i, j in terms])
    fitted = np.linalg.lstsq(gram, right, rcond=None)[0]
    coefficients = np.zeros((degree + 1, degree + 1))
    for (i, j), value in zip(terms, fitted, strict=True):
        coefficients[i, j] = value
    return heights - rows.T @ coefficients @ columns


def filled(heights: np.ndarray, spacing: tuple[float, float]) -> np.ndarray:
    """Fill missing heights (NaN) by the harmonic function that continues those around, of no slope at the edges."""
    missing = ~np.isfinite(heights)
    count = np.count_nonzero(missing)
    if count == 0:
        return heights.copy()
    from scipy import sparse  # slow to import
    from scipy.sparse.linalg import spsolve

    own = np.arange(count)
    number, known = np.full(heights.shape, _KNOWN), np.where(missing, 0.0, heights)
    number[missing] = own
    number, known = np.pad(number, 1, constant_values=_OUTSIDE), np.pad(known, 1)
    laplacian, right = sparse.csr_matrix((count, count)), np.zeros(count)
    for axis, step in enumerate(spacing):
        weight = (min(spacing) / step) ** 2
        for shift in (-1, 1):
            other, height = (np.roll(part, shift, axis)[1:-1, 1:-1][missing] for part in (number, known))
            inner = other >= 0
            beside = np.full(np.count_nonzero(inner), -weight), (own[inner], other[inner])
            laplacian += sparse.coo_matrix(beside, (count, count)) + sparse.diags(weight * (other > _OUTSIDE))
            right += weight * height
    whole = heights.copy()
    whole[missing] = spsolve(laplacian.tocsc(), right)
    return whole


def mirrored(heights: np.ndarray) -> np.ndarray:
    """Join a map to its mirror images beyond the far edges, shape (2 ny, 2 nx): periodic without a jump."""
    return np.pad(heights, [(0, count) for count in heights.shape], mode="symmetric")


def windowed(heights: np.ndarray, share: float) -> np.ndarray:
    """Fade heights to their mean over a share of sides by Tukey windows (F. J. Harris, Proc. IEEE 66, 51 (1978))."""
    from scipy.signal.windows import tukey  # slow to import

    rows, columns = (tukey(n, share, sym=False) for n in heights.shape)
    mean = heights.mean()
    return mean + (heights - mean) * rows[:, None] * columns[None, :]


def lowpassed(heights: np.ndarray, grid: Grid, shortest: float) -> np.ndarray:
    """Remove the waves that are shorter than a wavelength (m)."""
    # A wave on the limit stays, whatever the rounding of 2π.
    keep = grid.wavenumber <= 2 * np.pi / shortest * (1 + 1e-9)
    return fourier.synthesise(fourier.transform(heights) * keep, heights.shape)
