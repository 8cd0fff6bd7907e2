"""The balance and the energy of a contact, formed by other means than the solvers'.

Of the periodic solids from K(q) by NumPy's transforms, with free boundaries from the displacement of a loaded rectangle
by direct convolution; no operator, kernel or pass of the solvers.
"""

from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import dctn, idctn
from scipy.signal import fftconvolve

from contact_study.numerics.grid import Grid
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import Elasticity, HalfSpace

if TYPE_CHECKING:
    from research.state_checks.state import Point


class PeriodicSurface:
    """K(q) on the waves of a grid, by NumPy."""

    def __init__(self, solid: Elasticity, grid: Grid):
        self._solid = solid
        q = np.hypot(
            *np.meshgrid(
                *(2 * np.pi * np.fft.fftfreq(n, s / n) for n, s in zip(grid.shape, grid.size, strict=True)),
                indexing="ij",
            )
        )
        self._stiffness = np.zeros(grid.shape)
        self._stiffness[q > 0] = solid.stiffness(q[q > 0])

    def elastic(self, displacement: np.ndarray) -> np.ndarray:
        """The pressure that a displacement takes, but for its mean (Pa)."""
        return np.fft.ifft2(self._stiffness * np.fft.fft2(displacement)).real

    def imbalance(self, displacement: np.ndarray, found: "Point") -> np.ndarray:
        """Pressure of the interface that nothing elastic holds (Pa)."""
        return self.elastic(displacement) + found.pressure.mean() - found.pressure

    def energy(self, law: TractionLaw, heights: np.ndarray, found: "Point", gap: np.ndarray, control: str) -> float:
        """Elastic energy, interaction and load at a gap, per area (J/m²)."""
        displacement = heights + gap
        load = 0.0
        if control == "pressure":
            load = found.pressure.mean() * gap.mean()
        elif control == "approach":
            load = 0.5 * self._uniform * (displacement.mean() - self.plane(heights, found)) ** 2
        return float(self._energy_of(displacement) + np.mean(law.potential(gap)) + load)

    def plane(self, heights: np.ndarray, found: "Point") -> float:
        """Where the surface would be undeformed (m)."""
        return float(np.mean(heights + found.gap) - found.pressure.mean() / self._uniform)

    @property
    def _uniform(self) -> float:
        """Stiffness of the mean (Pa/m): that of a wave a million times as long as the layer is thick."""
        return float(self._solid.stiffness(np.array([1e-6 / self._solid.depth]))[0])

    def stored(self, heights: np.ndarray, found: "Point") -> float:
        """Elastic energy of a state but for its uniform compression, per area (J/m²)."""
        return self._energy_of(heights + found.gap)

    def _energy_of(self, displacement: np.ndarray) -> float:
        return 0.5 * float(np.mean(displacement * self.elastic(displacement)))


class FreeSurface:
    """The displacement of a cell's pressure, convolved directly."""

    def __init__(self, solid: Elasticity, grid: Grid):
        assert isinstance(solid, HalfSpace)
        (rows, columns), (dy, dx) = grid.shape, grid.spacing
        y = np.arange(1 - rows, rows)[:, None] * dy
        x = np.arange(1 - columns, columns)[None, :] * dx
        kernel = np.zeros((2 * rows - 1, 2 * columns - 1))
        for a, sign_a in ((y + dy / 2, 1), (y - dy / 2, -1)):
            for b, sign_b in ((x + dx / 2, 1), (x - dx / 2, -1)):
                r = np.hypot(a, b)
                kernel += sign_a * sign_b * (a * np.log(b + r) + b * np.log(a + r))
        self._kernel = kernel / (np.pi * solid.contact_modulus)
        q = np.hypot(
            *np.meshgrid(
                *(np.pi * np.arange(n) / length for n, length in zip(grid.shape, grid.size, strict=True)), indexing="ij"
            )
        )
        self._stiffness = 0.5 * solid.contact_modulus * q
        self._stiffness[0, 0] = 1 / np.mean(self._displaced(np.ones(grid.shape)))

    def _displaced(self, pressure: np.ndarray) -> np.ndarray:
        return fftconvolve(pressure, self._kernel, "same")

    def imbalance(self, displacement: np.ndarray, found: "Point") -> np.ndarray:
        """How far the surface is from where its pressures put it, as the stress that would move it there (Pa).

        Of the patch's own cosine waves, each with its stiffness in the half-space: the scale of that stress, which a
        patch without waves beyond its rim only has in the mean of many points.
        """
        away = found.plane + self._displaced(found.pressure) - displacement
        return idctn(self._stiffness * dctn(away, norm="ortho"), norm="ortho")

    def energy(self, law: TractionLaw, heights: np.ndarray, found: "Point", gap: np.ndarray, control: str) -> float:
        """Energy at a gap near the one found, to second order (J/m²).

        The compliance is known, its inverse is not: the pressures of the changed surface are bounded from below by
        those of the change's own stiffest answer, so that the energy is no smaller than this.
        """
        change = gap - found.gap
        first = np.mean(found.pressure * change)
        return float(first + np.mean(law.potential(gap)) + 0.5 * self._least_stiffness(change))

    def plane(self, heights: np.ndarray, found: "Point") -> float:
        """Where the surface would be undeformed (m), as is said: the balance holds it to that."""
        assert found.plane is not None
        return found.plane

    def stored(self, heights: np.ndarray, found: "Point") -> float:
        """Elastic energy of a state, per area of the surface (J/m²)."""
        return 0.5 * float(np.mean(found.pressure * self._displaced(found.pressure)))

    def _least_stiffness(self, change: np.ndarray) -> float:
        """<c, C⁻¹ c> >= <c, p>²/<p, C p> for any pressure p; taken for the p that c's own slopes suggest."""
        pressure = self._suggested(change)
        response = self._displaced(pressure)
        work = float(np.mean(pressure * response))
        return float(np.mean(change * pressure)) ** 2 / work if work else 0.0  # no change at all

    def _suggested(self, change: np.ndarray) -> np.ndarray:
        q = np.hypot(*np.meshgrid(*(np.fft.fftfreq(n) for n in change.shape), indexing="ij"))
        q[0, 0] = 0.3 / max(change.shape)  # finite for the mean, too
        return np.fft.ifft2(q * np.fft.fft2(change)).real
