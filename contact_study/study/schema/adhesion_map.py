"""The section ``[adhesion_map]`` of a study file: how the work of adhesion varies along the surface."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics.grid import Grid
from contact_study.physics import adhesion_maps
from contact_study.study.schema import keys
from contact_study.study.schema.keys import FACTOR, SHARE, TEXT, integer, key, pair, quantity
from contact_study.study.schema.modes import Modes, check_carried, check_modes, spectrum_of_modes


@dataclass(frozen=True, kw_only=True)
class AdhesionMapSection:
    """Work of adhesion along the surface: uniform, in patches or stripes, random, or from a file."""

    kind: str = key(TEXT, "variation of the work of adhesion about interaction.work_of_adhesion, its mean", "none")

    @property
    def map_path(self) -> str | None:
        """File of the map as the study writes it; None for one that needs none."""
        return None

    def factors(self, grid: Grid, directory: Path) -> np.ndarray | None:
        """Return the local work of adhesion over its mean; None if it is uniform, InputError if it cannot be made."""
        return None


@dataclass(frozen=True, kw_only=True)
class Patches(AdhesionMapSection):
    """Rectangular patches or stripes."""

    modes: tuple[int, int] = key(pair(integer(0, 2**31 - 1)), "patches along y and x; 0 along one axis makes stripes")
    contrast: float = key(SHARE, "(w₁ − w₂)/(w₁ + w₂) of patches and background; 1: the background does not adhere")
    share: float = key(SHARE, "fraction of the area that the patches cover", 0.5)

    def __post_init__(self):
        if self.modes == (0, 0):
            raise InputError("adhesion_map.modes = [0, 0]: make no patches; at least one must be positive")
        if self.share == 1:
            raise InputError("adhesion_map.share = 1: leaves no background; use a smaller one")

    def factors(self, grid: Grid, directory: Path) -> np.ndarray:
        for axis, mode, points in zip("yx", self.modes, grid.shape, strict=True):
            if 2 * mode > points:
                raise InputError(
                    f"adhesion_map.modes = {list(self.modes)}: {mode} patches along {axis} need at least {2 * mode} "
                    f"points, surface.shape has {points}"
                )
        return adhesion_maps.patches(grid, self.modes, self.contrast, self.share)


@dataclass(frozen=True, kw_only=True)
class RandomAdhesion(AdhesionMapSection):
    """A log-normal random map; its modes count waves on the longest side."""

    relative_rms: float = key(
        quantity("1", positive=True, maximum=3.0), "standard deviation of the work of adhesion over its mean"
    )
    hurst_exponent: float = key(quantity("1", minimum=0.0, maximum=1.0), "Hurst exponent H", 0.8)
    low_mode: float = key(FACTOR, "q_L in units of 2π over the longest side of size", 1.0)
    roll_off_mode: float = key(FACTOR, "q_0 in units of 2π over the longest side of size", 1.0)
    cutoff_mode: float = key(FACTOR, "q_1 in units of 2π over the longest side of size")
    seed: int = key(integer(0), "random realisation", 1)

    def __post_init__(self):
        check_modes("adhesion_map", self._modes)

    @property
    def _modes(self) -> Modes:
        return self.low_mode, self.roll_off_mode, self.cutoff_mode

    def factors(self, grid: Grid, directory: Path) -> np.ndarray:
        check_carried("adhesion_map", self.cutoff_mode, grid.size, grid.shape)
        spectrum = spectrum_of_modes(self.hurst_exponent, 1.0, self._modes, grid.size)
        return adhesion_maps.log_normal(grid, spectrum, self.relative_rms, self.seed)


@dataclass(frozen=True, kw_only=True)
class AdhesionFile(AdhesionMapSection):
    """A map of a file, scaled to the mean."""

    path: str = key(TEXT, "map relative to the study file (NetCDF, npy, npz, text), scaled to the mean")
    channel: str | int | None = key(
        keys.NAME_OR_NUMBER, "name or number, from 0, of the map in a file that holds several", None
    )

    @property
    def map_path(self) -> str:
        return self.path

    def factors(self, grid: Grid, directory: Path) -> np.ndarray:
        return adhesion_maps.from_file(grid, directory / self.path, self.channel, "adhesion_map")


ADHESION_MAPS = keys.TaggedUnion(
    "kind", {"none": AdhesionMapSection, "patches": Patches, "random": RandomAdhesion, "file": AdhesionFile}
)
