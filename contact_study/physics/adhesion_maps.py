"""Maps of the work of adhesion: factors of a law from point to point, of mean one, on any grid."""

from pathlib import Path

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps.height_map import Channel, read_values
from contact_study.physics.roughness.spectrum import SelfAffineSpectrum
from contact_study.physics.surfaces.surface import gaussian_surface


def patches(grid: Grid, modes: tuple[int, int], contrast: float, share: float) -> np.ndarray:
    """Make rectangular patches 1 + c beside a background 1 − c, so many along y and x; none along an axis: stripes.

    Each covers the ``share`` of its period, over both axes the same part of either.
    """
    waves = np.count_nonzero(modes)
    strong = np.ones(grid.shape, bool)
    for axis, (mode, points) in enumerate(zip(modes, grid.shape, strict=True)):
        if mode:
            within = (np.arange(points) * mode / points) % 1.0
            inside = within < share ** (1 / waves) * (1 - 1e-12)  # a point on the edge belongs to the background
            strong &= inside[:, None] if axis == 0 else inside[None, :]
    return of_mean_one(np.where(strong, 1 + contrast, 1 - contrast))


def log_normal(grid: Grid, spectrum: SelfAffineSpectrum, rms: float, seed: int) -> np.ndarray:
    """Draw positive random factors of a relative deviation ``rms`` whose logarithm has a self-affine spectrum."""
    field = gaussian_surface(spectrum, grid.size, grid.shape, seed, exact_height=True).heights(grid.shape)
    return of_mean_one(np.exp(np.sqrt(np.log1p(rms**2)) * field))


def from_file(grid: Grid, path: Path, channel: Channel, section: str) -> np.ndarray:
    """Read the values of a file, of the grid's shape or of a coarser one whose cells hold whole points of the grid."""
    values = read_values(path, channel, section)
    rows, columns = (points // own for points, own in zip(grid.shape, values.shape, strict=True))
    if (rows * values.shape[0], columns * values.shape[1]) != grid.shape:
        raise InputError(
            f"{section}.path: {path} holds {values.shape[0]} x {values.shape[1]} values, the grid has "
            f"{grid.shape[0]} x {grid.shape[1]} points; give surface.shape = {list(values.shape)}, or a multiple"
        )
    if not np.isfinite(values).all() or values.min() < 0 or not values.any():
        raise InputError(f"{section}.path: {path} holds missing, negative or only zero values; fill or shift them")
    return of_mean_one(np.kron(values, np.ones((rows, columns))))


def of_mean_one(factors: np.ndarray) -> np.ndarray:
    """Divide by the mean."""
    return factors / factors.mean()
