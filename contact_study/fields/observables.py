"""What is read off fields of gap and pressure, the same way for every simulation."""

import numpy as np


def probability_density(values: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Histogram of all values as a density: its integral is the fraction of values inside the edges.

    Parameters
    ----------
    values : numpy.ndarray
        Any shape.
    edges : numpy.ndarray, shape (n + 1,)
        Increasing bin edges, in the unit of ``values``.

    Returns
    -------
    numpy.ndarray, shape (n,)
        Per unit of ``values``.
    """
    counts, _ = np.histogram(values, bins=edges)
    return counts / (values.size * np.diff(edges))
