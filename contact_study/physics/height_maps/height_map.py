"""A height map in metres, from the numbers of its file and the units and size of file and study."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.inputs.files import require_file
from contact_study.inputs.units import length
from contact_study.physics.height_maps.formats import Channel, RawMap, read_map
from contact_study.physics.height_maps.grid import line_scan

# A cell wider than this (m) was written in another unit: no instrument that resolves roughness reaches as far.
WIDEST = 0.1

# Relative difference up to which two sizes are one: headers round to four digits. The usual mistake, counting
# intervals instead of points, is 1/N, and larger on all maps of less than a thousand points a side.
_SAME_SIZE = 1e-3


@dataclass(frozen=True)
class HeightMap:
    """Heights (y, x) and the periods of the cell in m, both axes increasing, NaN where missing.

    ``unit`` is the unit that the heights were read in, and its source.
    """

    heights: np.ndarray
    size: tuple[float, float]
    unit: str

    @property
    def shape(self) -> tuple[int, int]:
        """Points along y and x."""
        return self.heights.shape[0], self.heights.shape[1]

    @property
    def spacing(self) -> tuple[float, float]:
        """Distance of neighbouring points along y and x (m)."""
        return self.size[0] / self.shape[0], self.size[1] / self.shape[1]


def read_height_map(
    path: Path,
    height_unit: str | None = None,
    size: tuple[float, float] | None = None,
    channel: Channel = None,
    lateral_unit: str | None = None,
) -> HeightMap:
    """Read a height map of one of the formats of :mod:`contact_study.physics.height_maps.formats`.

    Units, size (y, x; m) and channel are those of a study; units default to metres.

    Raises InputError if the file is missing or damaged, is no table of at least 4 × 4 numbers, its coordinates are not
    evenly spaced, its size is unknown, or the study contradicts it.
    """
    require_file(path, "surface.path")
    try:
        raw = read_map(path, channel)
        if np.iscomplexobj(raw.heights):
            raise InputError(f"surface.path: {path} holds complex numbers; expected heights")
        heights = np.asarray(raw.heights, dtype=float)
    except InputError:
        raise
    except Exception as error:  # each format raises its own types on a damaged file
        reason = str(error).strip().partition("\n")[0]
        raise InputError(f"surface.path: {path} cannot be read ({reason})") from None
    if heights.ndim == 1 or (heights.ndim == 2 and min(heights.shape) <= 2 and max(heights.shape) >= 4):
        raise line_scan(path, max(heights.shape))
    if heights.ndim != 2 or min(heights.shape) < 4:
        raise InputError(
            f"surface.path: {path} holds an array of shape {heights.shape}; expected at least 4 x 4 heights"
        )
    if not np.any(np.isfinite(heights)):
        raise InputError(f"surface.path: {path} holds no finite numbers: all of its heights are missing")
    heights = np.where(np.isfinite(heights), heights, np.nan)
    factor = _factor(path, "height_unit", height_unit, raw.height_unit)
    said = "its file" if raw.height_unit else "surface.height_unit" if height_unit else "default"
    unit = f"{raw.height_unit or height_unit or 'm'}, {said}"
    return HeightMap(np.ascontiguousarray(heights * factor), _size(path, raw, size, lateral_unit), unit)


def _factor(path: Path, name: str, given: str | None, own: str | None) -> float:
    """Metres in a unit: the file's, or else the study's, which must be the same if both say one."""
    factor = units.quantity(f"1 {own or given or 'm'}", "m", f"unit of {path}" if own else f"surface.{name}")
    if own and given and abs(units.quantity(f"1 {given}", "m", f"surface.{name}") / factor - 1) > 1e-9:
        raise InputError(f'surface.{name} = "{given}": {path} says {own}; leave the key out, or mend the file')
    return factor


def _size(path: Path, raw: RawMap, given: tuple[float, float] | None, lateral_unit: str | None) -> tuple[float, float]:
    if raw.size is None:
        if given is None:
            raise InputError(
                f"missing key surface.size: how wide is the map? {path} does not say; give its sides, such as "
                '"10 um, 8 um" (y, x)'
            )
        if lateral_unit is not None:
            raise InputError(f"surface.lateral_unit: {path} has no lateral coordinates; surface.size has its own unit")
        return given
    factor = _factor(path, "lateral_unit", lateral_unit, raw.lateral_unit)
    own = raw.size[0] * factor, raw.size[1] * factor
    if max(own) > WIDEST and raw.lateral_unit is None and lateral_unit is None:
        raise InputError(
            f"missing key surface.lateral_unit: {path} does not say in which unit x and y are; in metres the map would "
            f"be {length(*own)} wide"
        )
    if given is None:
        return own
    if any(abs(one / other - 1) > _SAME_SIZE for one, other in zip(given, own, strict=True)):
        raise InputError(
            f"surface.size = {given[0]:.6g} x {given[1]:.6g} m: {path} says {own[0]:.6g} x {own[1]:.6g} m (y, x; its "
            "points times their spacing); leave the key out, or mend the file"
        )
    return given
