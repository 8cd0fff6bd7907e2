"""Files of height maps: a reader for each format, and the map in metres by the units and size of file and study."""

import gzip
import logging
import re
import shutil
import tempfile
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.files import require_file
from contact_study.inputs.number_tables import TableError
from contact_study.inputs.units import length, quantity
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps.text import MapError, RawMap, line_scan, read_points, read_text, step_of

Channel = str | int | None

# A cell wider than this (m) was written in another unit: no instrument that resolves roughness reaches as far.
WIDEST = 0.1
_SAME_SIZE = 1e-3  # relative difference up to which two sizes are one: headers round to four digits
# A map's variable of a NetCDF file, of this project and of SurfaceTopography, and what marks missing heights there.
_USUAL, _MASK = ("height", "heights"), "mask"
# Channels of a microscope that are no heights, whatever unit its software gives them.
_NO_HEIGHTS = re.compile("phase|error|amplitude|deflection|friction|lateral|current|potential", re.IGNORECASE)


@dataclass(frozen=True)
class HeightMap:
    """Heights (y, x) and the periods of the cell in m, both axes increasing, NaN where missing."""

    heights: np.ndarray
    size: tuple[float, float]
    unit: str  # that the heights were read in, and its source

    @property
    def grid(self) -> Grid:
        return Grid((self.heights.shape[0], self.heights.shape[1]), self.size)


def read_height_map(
    path: Path,
    height_unit: str | None = None,
    size: tuple[float, float] | None = None,
    channel: Channel = None,
    lateral_unit: str | None = None,
) -> HeightMap:
    """Read a map by the keys of a study, size (y, x) in m and units m by default; InputError if it is none."""
    raw = read_raw(path, channel, _check_map)
    heights = np.where(np.isfinite(raw.heights), raw.heights, np.nan)
    factor = unit_size(path, "height_unit", height_unit, raw.height_unit)
    said = "its file" if raw.height_unit else "surface.height_unit" if height_unit else "default"
    unit = f"{raw.height_unit or height_unit or 'm'}, {said}"
    return HeightMap(np.ascontiguousarray(heights * factor), _size(path, raw, size, lateral_unit), unit)


def read_values(path: Path, channel: Channel, section: str) -> np.ndarray:
    """Read a map (y, x) of another quantity from the same formats, in the unit of its file, for keys of a section."""
    try:
        return read_raw(path, channel, _check_map).heights
    except InputError as error:
        words = str(error).replace("surface.", f"{section}.").replace("maps of heights", "maps")
        raise type(error)(words.replace("map of heights", "map").replace("heights", "values")) from None


def read_raw(path: Path, channel: Channel, check: Callable[[np.ndarray], None] = lambda heights: None) -> RawMap:
    """Read a map or line scan of real numbers, of which some are finite; ``check`` raises MapError."""
    require_file(path, "surface.path")
    try:
        raw = _read(path, channel)
        if np.iscomplexobj(raw.heights):
            raise MapError("holds complex numbers; expected heights")
        heights = np.asarray(raw.heights, dtype=float)
        check(heights)
        if not np.any(np.isfinite(heights)):
            raise MapError("holds no finite numbers: all of its heights are missing")
    except TableError as error:
        raise InputError(f"surface.path: {error.of_file(path)}") from None
    except InputError:
        raise
    except Exception as error:  # each format raises its own types on a damaged file
        reason = str(error).strip().partition("\n")[0]
        raise InputError(f"surface.path: {path} cannot be read ({reason})") from None
    return replace(raw, heights=heights)


def is_line(heights: np.ndarray) -> bool:
    """Test whether an array is that of a line scan: one row or column, or columns x and height."""
    return heights.ndim == 1 or (heights.ndim == 2 and min(heights.shape) <= 2 and max(heights.shape) >= 4)


def _check_map(heights: np.ndarray) -> None:
    if is_line(heights):
        raise line_scan(max(heights.shape))
    if heights.ndim != 2 or min(heights.shape) < 4:
        raise MapError(f"holds an array of shape {heights.shape}; expected at least 4 x 4 heights")


def unit_size(path: Path, name: str, given: str | None, own: str | None) -> float:
    """Metres in a unit: the file's, or else the study's, which must be the same if both say one."""
    factor = quantity(f"1 {own or given or 'm'}", "m", f"unit of {path}" if own else f"surface.{name}")
    if own and given and abs(quantity(f"1 {given}", "m", f"surface.{name}") / factor - 1) > 1e-9:
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
    factor = unit_size(path, "lateral_unit", lateral_unit, raw.lateral_unit)
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


def _read(path: Path, channel: Channel) -> RawMap:
    """Read an existing file by its suffix, or else by its content; ``channel`` is the name or number of a map in it."""
    if (suffix := path.suffix.lower()) in READERS:
        return READERS[suffix](path, channel)
    with path.open("rb") as stream:
        start = stream.read(4096)
    reason = "it is no text"
    if b"\0" not in start and not re.search(rb"[\x01-\x08\x0e-\x1f\x80-\x9f]{2}", start):
        try:
            return _only(path, channel, read_text(path))
        except InputError:
            raise
        except ValueError as error:
            reason = str(error)
    return _instrument(path, channel, reason)


def _chosen(
    path: Path, names: Sequence[str], channel: Channel, usual: str = "", others: Collection[str] = frozenset()
) -> str:
    """Choose one of the channels of a file, of which ``others`` are no heights."""
    heights = [name for name in names if name not in others]
    kinds = {name: " (not a height)" if name in others else " (height)" if others else "" for name in names}
    listed = ", ".join(f"{number}: {name}{kinds[name]}" for number, name in enumerate(names))
    if not heights:
        raise MapError(f"holds no map of heights{listed and f'; it has {listed}'}")
    if channel is None:
        if usual in heights or len(heights) == 1:
            return usual if usual in heights else heights[0]
        raise InputError(f"missing key surface.channel: {path} holds {len(heights)} maps of heights ({listed})")
    found = names[channel] if isinstance(channel, int) and channel < len(names) else channel
    if found not in heights:
        what = "is no map of heights" if found in names else "there is no such channel"
        raise InputError(f"surface.channel = {channel!r}: {what}; {path} has {listed}")
    return str(found)


def _netcdf(path: Path, channel: Channel) -> RawMap:
    import xarray as xr

    with xr.open_dataset(path) as dataset:
        names = [str(name) for name, variable in dataset.items() if variable.ndim == 2 and name != _MASK]
        usual = next((name for name in names if name in _USUAL), "")
        heights = dataset[_chosen(path, names, channel, usual)].load()
        if _MASK in dataset and dataset[_MASK].dims == heights.dims:
            heights = heights.where(dataset[_MASK] == 0)
        axes = {str(dataset[dim].attrs.get("axis") or dim).lower(): dim for dim in heights.dims}
        if set(axes) == {"y", "x"}:
            heights = heights.transpose(axes["y"], axes["x"])
        steps, units = [], []
        for dimension in map(str, heights.dims):
            if dimension not in dataset.coords or dataset[dimension].size < 2:
                continue
            steps.append(step_of(dimension, dataset[dimension].values.astype(float)))
            if heights[dimension][0] > heights[dimension][-1]:
                heights = heights.isel({dimension: slice(None, None, -1)})
            units.append(_unit(dataset[dimension]))
        if len(steps) < 2:
            return RawMap(heights.values, None, _unit(heights))
        said = next((unit for unit in units if unit), None)  # of two coordinates one may speak for both
        sizes = [quantity(f"1 {unit or said or 'm'}", "m", f"surface.path: {path}, unit of x or y") for unit in units]
        y, x = (step * n * one for step, n, one in zip(steps, heights.shape, sizes, strict=True))
        return RawMap(heights.values, (y, x), _unit(heights), said and "m")


def _npz(path: Path, channel: Channel) -> RawMap:
    with np.load(path, allow_pickle=False) as archive:
        return RawMap(archive[_chosen(path, [name for name in archive.files if archive[name].ndim == 2], channel)])


def _unit(variable: Any) -> str | None:
    """Unit of a NetCDF variable; SurfaceTopography calls the attribute ``unit``, and writes ``A`` for Å."""
    unit = variable.attrs.get("units") or variable.attrs.get("unit")
    return "angstrom" if unit == "A" else unit


def _gzip(path: Path, channel: Channel) -> RawMap:
    """Read the content of a compressed file."""
    with tempfile.TemporaryDirectory(prefix="height_map") as folder:
        content = Path(folder) / path.stem
        with gzip.open(path) as packed, content.open("wb") as out:
            shutil.copyfileobj(packed, out)
        try:
            return _read(content, channel)
        except InputError as error:
            raise type(error)(str(error).replace(str(content), str(path))) from None


def _instrument(path: Path, channel: Channel, reason: str) -> RawMap:
    """Any of the formats of SurfaceTopography, whose arrays are (x, y)."""
    try:
        with silent():  # it warns of an MPI that is not there
            from SurfaceTopography.IO import CannotDetectFileFormat, open_topography
    except ImportError:
        raise MapError(
            f"is in none of the formats {', '.join(READERS)} or text ({reason}); instruments' files need pip install "
            "'.[instruments]'"
        ) from None
    try:
        with silent(), open_topography(str(path)) as reader:
            # A format without any mark: every file of the right length passes for it.
            if reader.format() == "hgt" and path.suffix.lower() != ".hgt":
                raise CannotDetectFileFormat
            maps = [one for one in reader.channels if one.dim == 2]
            if not maps and reader.channels:
                return _instrument_line(reader.channels[0])
            # The unit of what is no length is no text with some readers.
            lengths = {one.channel_id for one in maps if one.is_height_channel and isinstance(one.unit, str | None)}
            by_name = {one.channel_id: one for one in reversed(maps)}
            others = {name for name in by_name if name not in lengths or _NO_HEIGHTS.search(name)}
            found = by_name[_chosen(path, [one.channel_id for one in maps], channel, others=others)]
            sides = found.physical_sizes
            # It asks for a size where the file has none.
            topography = found.topography(physical_sizes=found.nb_grid_pts if sides is None else None)
            heights: np.ndarray = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan).T
            unit = topography.unit
    except CannotDetectFileFormat:
        raise MapError(
            f"is in no format that is known ({reason}); known are text, {', '.join(READERS)} and those of "
            "SurfaceTopography"
        ) from None
    return RawMap(heights, None if sides is None else (float(sides[1]), float(sides[0])), unit, unit)


def _instrument_line(channel: Any) -> RawMap:
    """The line scan of a file that has no map, as columns x and height."""
    scan = channel.topography(physical_sizes=channel.nb_grid_pts if channel.physical_sizes is None else None)
    columns = np.stack([np.asarray(values, dtype=float) for values in scan.positions_and_heights()], axis=1)
    return RawMap(columns, None, scan.unit, scan.unit)


@contextmanager
def silent() -> Iterator[None]:
    """Silence remarks of libraries on formats that a file does not have."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings(action="ignore"):
            yield
    finally:
        logging.disable(before)


def _only(path: Path, channel: Channel, found: RawMap) -> RawMap:
    """The one map of a file."""
    if channel not in (None, 0):
        raise InputError(f"surface.channel = {channel!r}: {path} holds one map; leave the key out")
    return found


READERS: Mapping[str, Callable[[Path, Channel], RawMap]] = {
    ".npy": lambda path, channel: _only(path, channel, RawMap(np.load(path, allow_pickle=False))),
    ".npz": _npz,
    ".nc": _netcdf,
    ".nc4": _netcdf,
    ".netcdf": _netcdf,
    ".xyz": lambda path, channel: _only(path, channel, read_points(path)),
    ".gz": _gzip,
}
