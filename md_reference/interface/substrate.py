"""The rigid substrate: one layer of sites on the rough surface, and the surface's height anywhere between them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import ndimage

from contact_study.numerics.kernel import kernel


@dataclass(frozen=True)
class Substrate:
    """A periodic rectangle of substrate sites, with heights (m) on ``refinement`` ``samples`` per site and axis."""

    samples: np.ndarray
    spacing: tuple[float, float]
    refinement: int = 1

    @cached_property
    def heights(self) -> np.ndarray:
        """Height of each site, shape (my, mx) (m)."""
        return np.ascontiguousarray(self.samples[:: self.refinement, :: self.refinement])

    @property
    def shape(self) -> tuple[int, int]:
        return self.heights.shape[0], self.heights.shape[1]

    @cached_property
    def _spline(self) -> np.ndarray:
        """Coefficients of the periodic cubic B-spline through the samples, with three more rows and columns."""
        coefficients = ndimage.spline_filter(self.samples, order=3, mode="grid-wrap", output=np.float64)
        return np.pad(coefficients, [(1, 2), (1, 2)], mode="wrap")

    def height_and_cosine(self, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return height (m) and cosine of the tilt, 1/√(1 + |∇h|²), of the surface at positions of any shape (m)."""
        height, cosine = np.empty(y.shape), np.empty(y.shape)
        per_y, per_x = (self.refinement / distance for distance in self.spacing)
        _evaluate_spline(self._spline, y.ravel(), x.ravel(), per_y, per_x, height.ravel(), cosine.ravel())
        return height, cosine


@kernel
def _basis(t):
    """Return the four cubic B-splines that cover a point at fraction t of its interval."""
    s = 1.0 - t
    return (
        s * s * s / 6.0,
        (4.0 - 3.0 * t * t * (1.0 + s)) / 6.0,
        (4.0 - 3.0 * s * s * (1.0 + t)) / 6.0,
        t * t * t / 6.0,
    )


@kernel
def _basis_slope(t):
    """Return the derivatives of :func:`_basis`."""
    s = 1.0 - t
    return (-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), 0.5 * s * (4.0 - 3.0 * s), 0.5 * t * t)


@kernel
def _evaluate_spline(coefficients, y, x, samples_per_y, samples_per_x, height, cosine):
    rows, columns = coefficients.shape[0] - 3, coefficients.shape[1] - 3
    for n in range(y.size):
        v, u = y[n] * samples_per_y, x[n] * samples_per_x
        # Wrapping the fraction of a period first keeps the index in range for any finite position.
        v -= np.floor(v / rows) * rows
        u -= np.floor(u / columns) * columns
        i, j = min(int(v), rows - 1), min(int(u), columns - 1)
        w_y, w_x = _basis(v - i), _basis(u - j)
        d_y, d_x = _basis_slope(v - i), _basis_slope(u - j)
        total = slope_y = slope_x = 0.0
        for k in range(4):
            row = coefficients[i + k]
            along = w_x[0] * row[j] + w_x[1] * row[j + 1] + w_x[2] * row[j + 2] + w_x[3] * row[j + 3]
            total += w_y[k] * along
            slope_y += d_y[k] * along
            slope_x += w_y[k] * (d_x[0] * row[j] + d_x[1] * row[j + 1] + d_x[2] * row[j + 2] + d_x[3] * row[j + 3])
        height[n] = total
        cosine[n] = 1.0 / np.sqrt(1.0 + (slope_y * samples_per_y) ** 2 + (slope_x * samples_per_x) ** 2)


def sample_substrate(
    sample: Callable[[tuple[int, int]], np.ndarray], size: tuple[float, float], sites: tuple[int, int], tolerance: float
) -> Substrate:
    """Put sites on a surface of periods ``size`` (m), whose heights on a grid of any shape ``sample`` gives (m).

    The interpolated height errs by ``tolerance`` (m) midway between samples, of which there are at most four per site.
    """
    spacing = (size[0] / sites[0], size[1] / sites[1])
    samples = sample(sites)
    for refinement in (1, 2):
        substrate = Substrate(samples, spacing, refinement)
        samples = sample((2 * refinement * sites[0], 2 * refinement * sites[1]))
        y, x = ((np.arange(n * refinement) + 0.5) * d / refinement for n, d in zip(sites, spacing, strict=True))
        error = substrate.height_and_cosine(*np.meshgrid(y, x, indexing="ij"))[0] - samples[1::2, 1::2]
        if np.max(np.abs(error)) <= tolerance:
            return substrate
    return Substrate(samples, spacing, 4)
