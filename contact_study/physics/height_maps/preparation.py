"""Preparation of a measured map for a periodic calculation: heights (y, x) in and out, NaN where missing."""

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid


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
    count = int(missing.sum())
    if count == 0:
        return heights.copy()
    from scipy import sparse  # slow to import
    from scipy.sparse.linalg import spsolve

    number = np.full(heights.shape, -1)
    number[missing] = np.arange(count)
    diagonal, right = np.zeros(count), np.zeros(count)
    entries: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for axis, step in enumerate(spacing):
        weight = (min(spacing) / step) ** 2
        lower = tuple(slice(None, -1) if i == axis else slice(None) for i in range(2))
        upper = tuple(slice(1, None) if i == axis else slice(None) for i in range(2))
        for here, there in ((lower, upper), (upper, lower)):
            own, other, height = number[here], number[there], heights[there]
            diagonal += np.bincount(own[own >= 0], minlength=count) * weight
            edge = (own >= 0) & (other < 0)
            right += np.bincount(own[edge], weight * height[edge], minlength=count)
            inner = (own >= 0) & (other >= 0)
            entries.append((own[inner], other[inner], np.full(int(inner.sum()), -weight)))
    row, column, value = (np.concatenate(part) for part in zip(*entries, strict=True))
    laplacian = sparse.coo_matrix((value, (row, column)), (count, count)) + sparse.diags(diagonal)
    whole = heights.copy()
    whole[missing] = spsolve(laplacian.tocsc(), right)
    return whole


def mirrored(heights: np.ndarray) -> np.ndarray:
    """Join a map to its mirror images beyond the far edges, shape (2 ny, 2 nx): periodic without a jump."""
    rows = np.concatenate([heights, heights[::-1]])
    return np.concatenate([rows, rows[:, ::-1]], axis=1)


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
