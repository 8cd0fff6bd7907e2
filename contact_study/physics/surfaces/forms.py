"""Forms of bodies: shapes of known profile around an axis, highest there, which end at the edges of the cell."""

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps.preparation import mirrored
from contact_study.physics.surfaces.surface import Surface, SurfaceScales, spectrum_of_waves

# Nodes of the mean height on either side of the axis: smooth forms to rounding, cones to 1e-6 of their height.
_NODES = 64
_POINTS_OF_SCALES = 256  # along a side, on any grid


@dataclass(frozen=True)
class Placement:
    """Axis of a form from the middle of the cell (y, x; m), turn from x to y (rad), rise along y and x (rad)."""

    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    tilt: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Form(Surface):
    """A shape by its profile, exact at any number of points."""

    placement: Placement

    @abstractmethod
    def profile(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Heights at coordinates from the axis (m), NaN where the form ends."""

    @property
    @abstractmethod
    def apex_curvature(self) -> float:
        """Mean curvature at the highest point, zero where it has none (1/m)."""

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        y, x = Grid(shape, self.size).coordinates
        return self._at(y[:, None], x[None, :]) - self._mean

    @property
    def covers_cell(self) -> bool:
        """Whether the form, which is convex, has a height at every corner of the cell."""
        sides_y, sides_x = (np.array([0.0, side]) for side in self.size)
        return bool(np.all(np.isfinite(self._at(sides_y[:, None], sides_x[None, :]))))

    @property
    def edge_jump(self) -> float:
        """Largest difference of heights between opposite edges of the cell (m)."""
        ends = [np.array([0.0, side]) for side in self.size]
        sides = [np.linspace(0, side, _POINTS_OF_SCALES) for side in self.size]
        along_y = np.diff(self._at(ends[0][:, None], sides[1][None, :]), axis=0)
        along_x = np.diff(self._at(sides[0][:, None], ends[1][None, :]), axis=1)
        return float(max(np.abs(along_y).max(), np.abs(along_x).max()))

    @property
    def scales(self) -> SurfaceScales:
        """Scales of the form between the edges of the cell, without a jump there: of its mirror images, joined."""
        y, x = ((np.arange(_POINTS_OF_SCALES) + 0.5) / _POINTS_OF_SCALES * side for side in self.size)
        heights = mirrored(self._at(y[:, None], x[None, :]))
        grid = Grid((heights.shape[0], heights.shape[1]), (2 * self.size[0], 2 * self.size[1]))
        variances = grid.variances(fourier.transform(heights)).reshape(-1)[1:]
        waves = grid.wavenumber.reshape(-1)[1:]
        height, slope = float(np.sqrt(variances.sum())), float(np.sqrt(np.sum(waves**2 * variances)))
        spectrum, depth = spectrum_of_waves(waves, variances), float(np.ptp(heights))
        one = self.size, self.shape, height, slope, depth, np.inf, spectrum
        return SurfaceScales(*one, apex_curvature=self.apex_curvature)

    def _at(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        (down, across), (rise_y, rise_x) = self.placement.offset, np.tan(self.placement.tilt)
        y, x = y - (self.size[0] / 2 + down), x - (self.size[1] / 2 + across)
        cos, sin = np.cos(self.placement.rotation), np.sin(self.placement.rotation)
        with np.errstate(invalid="ignore"):  # beyond the end of a sphere
            return self.profile(cos * y - sin * x, cos * x + sin * y) + (rise_y * y + rise_x * x)

    @cached_property
    def _mean(self) -> float:
        """Mean height over the cell by Gauss-Legendre quadrature, the same on every grid (m)."""
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        places, shares = [], []
        for side, shift in zip(self.size, self.placement.offset, strict=True):
            axis = min(max(side / 2 + shift, 0.0), side)
            places.append(np.concatenate([axis * (1 + nodes) / 2, axis + (side - axis) * (1 + nodes) / 2]))
            shares.append(np.concatenate([axis * weights, (side - axis) * weights]) / (2 * side))
        return float(shares[0] @ self._at(places[0][:, None], places[1][None, :]) @ shares[1])


@dataclass(frozen=True)
class Sphere(Form):
    """h = √(R² − r²) − R."""

    radius: float  # R (m)

    def profile(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        r2 = y**2 + x**2
        return -r2 / (self.radius + np.sqrt(self.radius**2 - r2))  # the same without cancellation

    @property
    def apex_curvature(self) -> float:
        return 1 / self.radius


@dataclass(frozen=True)
class Cylinder(Form):
    """h = √(R² − x²) − R: its axis lies along y."""

    radius: float  # R (m)

    def profile(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        return -(x**2) / (self.radius + np.sqrt(self.radius**2 - x**2)) + 0 * y

    @property
    def apex_curvature(self) -> float:
        return 1 / (2 * self.radius)


@dataclass(frozen=True)
class EllipticParaboloid(Form):
    """h = −y²/2R_y − x²/2R_x, the apex of any smooth body; a plane of infinite radii."""

    radii: tuple[float, float]  # (m)

    def profile(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        return -(y**2) / (2 * self.radii[0]) - x**2 / (2 * self.radii[1])

    @property
    def apex_curvature(self) -> float:
        return (1 / self.radii[0] + 1 / self.radii[1]) / 2


@dataclass(frozen=True)
class Cone(Form):
    """h = −s r, or a hyperboloid with a rounded tip: h = s b − s √(r² + b²), b = s R."""

    slope: float  # s, tangent of the angle between face and plane
    tip_radius: float  # R (m)

    def profile(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        blunt = self.slope * self.tip_radius
        return -self.slope * (np.sqrt(y**2 + x**2 + blunt**2) - blunt)

    @property
    def apex_curvature(self) -> float:
        return 1 / self.tip_radius if self.tip_radius else 0.0


@dataclass(frozen=True)
class Punch(Form):
    """h = −(r − a)²/2R beyond a flat face of radius a, a rounded edge, and from a slope of one on a cone."""

    flat_radius: float  # a (m)
    edge_radius: float  # R (m)

    def profile(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        beyond = np.maximum(np.hypot(y, x) - self.flat_radius, 0.0)
        edge = np.minimum(beyond, self.edge_radius)
        return -(edge**2) / (2 * self.edge_radius) - (beyond - edge)

    @property
    def apex_curvature(self) -> float:
        return 1 / (2 * self.edge_radius)  # of its edge, from which it detaches
