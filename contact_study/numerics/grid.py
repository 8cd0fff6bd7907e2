"""A doubly periodic grid of points and its wavevectors."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Grid:
    """Points of a periodic rectangle: their numbers and the periods (m) along y and x, in that order."""

    shape: tuple[int, int]
    size: tuple[float, float]

    @property
    def spacing(self) -> tuple[float, float]:
        """Distance between neighbouring points along y and x (m)."""
        return self.size[0] / self.shape[0], self.size[1] / self.shape[1]

    @property
    def points(self) -> int:
        return self.shape[0] * self.shape[1]

    @property
    def spectrum_shape(self) -> tuple[int, int]:
        return self.shape[0], self.shape[1] // 2 + 1

    @property
    def coordinates(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates y and x of the points along each axis (m)."""
        dy, dx = self.spacing
        return np.arange(self.shape[0]) * dy, np.arange(self.shape[1]) * dx

    @cached_property
    def wavevectors(self) -> tuple[np.ndarray, np.ndarray]:
        """Components q_y, shape (ny, 1), and q_x, shape (1, nx // 2 + 1), in the layout of ``rfft2`` (1/m)."""
        dy, dx = self.spacing
        q_y = 2 * np.pi * np.fft.fftfreq(self.shape[0], dy)
        q_x = 2 * np.pi * np.fft.rfftfreq(self.shape[1], dx)
        return q_y[:, None], q_x[None, :]

    @property
    def wavenumber(self) -> np.ndarray:
        """|q| in the layout of ``rfft2``, shape ``spectrum_shape`` (1/m); a grid stores no field."""
        q_y, q_x = self.wavevectors
        return np.hypot(q_y, q_x)

    @cached_property
    def multiplicity(self) -> np.ndarray:
        """Number of entries of the full spectrum for each of a half spectrum, shape (1, nx // 2 + 1)."""
        weight = np.full(self.spectrum_shape[1], 2.0)
        weight[0] = 1.0
        if self.shape[1] % 2 == 0:
            weight[-1] = 1.0
        return weight[None, :]

    @property
    def halved(self) -> "Grid":
        """Every second point of the same rectangle."""
        return Grid((self.shape[0] // 2, self.shape[1] // 2), self.size)

    def variances(self, coefficients: np.ndarray) -> np.ndarray:
        """Mean square of each wave of a field, from its normalised half spectrum; their sum is the variance."""
        variances = self.multiplicity * np.abs(coefficients) ** 2
        variances[0, 0] = 0.0
        return variances
