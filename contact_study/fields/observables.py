"""What is read off fields of gap and pressure, the same way for every simulation."""

from dataclasses import dataclass

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


@dataclass(frozen=True)
class Bins:
    """Bin edges of the two distributions, one set for a whole study so that its cases and models compare.

    Parameters
    ----------
    pressure_edges : numpy.ndarray
        Edges of ``pressure_pdf`` (Pa).
    gap_edges : numpy.ndarray
        Edges of ``gap_pdf`` (m).
    """

    pressure_edges: np.ndarray
    gap_edges: np.ndarray

    @property
    def pressure(self) -> np.ndarray:
        """Centres of the pressure bins (Pa)."""
        return 0.5 * (self.pressure_edges[1:] + self.pressure_edges[:-1])

    @property
    def gap(self) -> np.ndarray:
        """Centres of the gap bins (m)."""
        return 0.5 * (self.gap_edges[1:] + self.gap_edges[:-1])
