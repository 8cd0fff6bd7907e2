"""Distributions over bins, the same for every model."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

# Relative rounding of widths and edges.
_SAME = 1e-9


def probability_density(values: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Count values into a density over bins, whose integral is the fraction of values inside the edges."""
    counts, _ = np.histogram(values, bins=edges)
    return counts / (values.size * np.diff(edges))


def moments(values: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Standard deviation and skewness of values, shape (n,), by weights, shape (..., n); NaN without weight."""
    with np.errstate(invalid="ignore"):
        share = weights / weights.sum(axis=-1, keepdims=True)
        off = values - (share @ values)[..., None]
        deviation = np.sqrt((share * off**2).sum(axis=-1))
        return deviation, (share * off**3).sum(axis=-1) / deviation**3


def redistributed(density: np.ndarray, edges: np.ndarray, new_edges: np.ndarray) -> np.ndarray:
    """Transfer a density, shape (..., n), constant within each bin, to other bins; exact between edges of both sets."""
    return np.diff(cumulative(density, edges, new_edges)) / np.diff(new_edges)


def cumulative(density: np.ndarray, edges: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Integrate a density, shape (..., n), constant within each bin, up to each of some values, shape (..., m)."""
    on_edges = np.cumsum(density * np.diff(edges), axis=-1)
    on_edges = np.concatenate([np.zeros((*on_edges.shape[:-1], 1)), on_edges], axis=-1)
    return np.apply_along_axis(lambda row: np.interp(at, edges, row), -1, on_edges)


@dataclass(frozen=True)
class Bins:
    """Evenly spaced edges of the distributions (Pa, m), one set for a study so that its cases and models compare."""

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

    @property
    def edges_of(self) -> dict[str, np.ndarray]:
        """Edges by the name of their distribution."""
        pressure, gap = self.pressure_edges, self.gap_edges
        return {"pressure_pdf": pressure, "pressure_pdf_at": pressure, "gap_pdf": gap}

    @property
    def spans(self) -> tuple[list[float], ...]:
        """Lowest edge, highest edge and number of the bins of pressure (Pa) and gap (m); see :meth:`evenly`."""
        both = self.pressure_edges, self.gap_edges
        return tuple([float(edges[0]), float(edges[-1]), float(edges.size - 1)] for edges in both)

    @classmethod
    def evenly(cls, pressure: Sequence[float], gap: Sequence[float]) -> "Bins":
        """Make evenly spaced bins from spans, see :attr:`spans`."""
        return cls(*(np.linspace(low, high, int(count) + 1) for low, high, count in (pressure, gap)))

    def equal(self, other: "Bins") -> bool:
        """Compare edges up to rounding."""
        mine, others = (bins.edges_of.values() for bins in (self, other))
        return all(
            one.size == two.size and np.allclose(one, two, rtol=0, atol=_SAME * (one[1] - one[0]))
            for one, two in zip(mine, others, strict=True)
        )

    def hold(self, other: "Bins") -> bool:
        """Tell whether the other bins are no finer, so that their distributions follow from these."""
        mine, others = (np.array([edges[1] - edges[0] for edges in bins.edges_of.values()]) for bins in (self, other))
        return bool(np.all(others >= (1 - _SAME) * mine))
