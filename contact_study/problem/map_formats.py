"""Files of height maps, one reader a format: each gives what the file holds and says, and nothing more."""

import logging
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.problem.errors import InputError
from contact_study.problem.map_grid import gridded, step_of
from contact_study.problem.units import quantity

Channel = str | int | None


@dataclass(frozen=True)
class RawMap:
    """A map as its file has it.

    Attributes
    ----------
    heights : numpy.ndarray, shape (ny, nx)
        Numbers of the file, y and x increasing along the axes; NaN where there is none.
    size : tuple of float or None
        Periods along y and x, points times spacing, in the lateral unit.
    height_unit, lateral_unit : str or None
        Units; None where the file is silent.
    """

    heights: np.ndarray
    size: tuple[float, float] | None = None
    height_unit: str | None = None
    lateral_unit: str | None = None


def read_map(path: Path, channel: Channel) -> RawMap:
    """Read a file by its suffix, or else by its content.

    Parameters
    ----------
    path : pathlib.Path
        A file that exists.
    channel : str, int or None
        Name or number, from 0, of the map in a file that holds several.

    Raises
    ------
    InputError
        If several maps leave a choice, there is no such channel, or no reader knows the format.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is not None:
        return reader(path, channel)
    if _is_text(path):
        try:
            return _text(path, channel)
        except InputError:
            raise
        except ValueError as error:
            reason = str(error)
    else:
        reason = "it is no text"
    return _instrument(path, channel, reason)


def chosen(path: Path, names: Sequence[str], channel: Channel, usual: str = "") -> str:
    """The channel that is meant, of those that a file holds.

    Raises
    ------
    InputError
        If there is none, or it is not clear which.
    """
    listed = ", ".join(f"{number}: {name}" for number, name in enumerate(names))
    if not names:
        raise InputError(f"surface.path: {path} holds no map of heights")
    if channel is None:
        if usual in names or len(names) == 1:
            return usual if usual in names else names[0]
        raise InputError(f"missing key surface.channel: {path} holds {len(names)} maps of heights ({listed})")
    if isinstance(channel, int) and channel < len(names):
        return names[channel]
    if channel in names:
        return str(channel)
    raise InputError(f"surface.channel = {channel!r}: {path} has {listed}")


def _npy(path: Path, channel: Channel) -> RawMap:
    _only(path, channel)
    return RawMap(np.load(path, allow_pickle=False))


def _npz(path: Path, channel: Channel) -> RawMap:
    with np.load(path, allow_pickle=False) as archive:
        names = [name for name in archive.files if archive[name].ndim == 2]
        return RawMap(archive[chosen(path, names, channel)])


def _netcdf(path: Path, channel: Channel) -> RawMap:
    import xarray as xr

    with xr.open_dataset(path) as dataset:
        names = [str(name) for name, variable in dataset.items() if variable.ndim == 2]
        heights = dataset[chosen(path, names, channel, "height")].load()
        axes = {_axis(dataset, str(dimension)): str(dimension) for dimension in heights.dims}
        if set(axes) == {"y", "x"}:
            heights = heights.transpose(axes["y"], axes["x"])
        size, units = [], []
        for dimension in map(str, heights.dims):
            if dimension not in dataset.coords or dataset[dimension].size < 2:
                continue
            step = step_of(path, dimension, dataset[dimension].values.astype(float))
            if step < 0:
                heights = heights.isel({dimension: slice(None, None, -1)})
            units.append(dataset[dimension].attrs.get("units"))
            factor = quantity(f"1 {units[-1] or 'm'}", "m", f"units of {dimension}")
            size.append(abs(step) * factor * dataset[dimension].size)
        own = (size[0], size[1]) if len(size) == 2 else None
        return RawMap(heights.values, own, heights.attrs.get("units"), "m" if any(units) else None)


def _axis(dataset: Any, dimension: str) -> str:
    """``y`` or ``x`` as the coordinate's attribute or else the dimension's name says; another name as it is."""
    attribute = dataset[dimension].attrs.get("axis") if dimension in dataset.coords else None
    return str(attribute or dimension).lower()


def _text(path: Path, channel: Channel) -> RawMap:
    """A table of heights, or what its first lines say it is."""
    _only(path, channel)
    lines = _lines(path)
    head = "\n".join(lines[:30])
    if head.startswith("WSxM") and "ASCII XYZ" in head:
        return _points(path, lines)
    if head.startswith("WSxM") and "ASCII Matrix" in head:
        said = _header(head, r"^(?P<key>[XY]) Amplitude:\s*(?P<value>.*)$")
        unit = re.search(r"^Z Amplitude:\s*[-+\d.eE]+\s*(\S+)", head, re.MULTILINE)
        raw = _table(path, lines[1 + _last(lines, "Amplitude:") :], ("Y", "X"), said, downwards=True)
        return replace(raw, height_unit=unit[1] if unit else None)
    if re.match(r"\s*ncols\s", head, re.IGNORECASE):
        return _esri(path, lines)
    # The comments in which Gwyddion and others export a table.
    said = _header(head, r"^#\s*(?P<key>Width|Height|Value units):\s*(?P<value>.*)$")
    return _table(path, lines, ("Height", "Width"), said, downwards=bool(said))


def _table(
    path: Path, lines: Sequence[str], sides: tuple[str, str], said: Mapping[str, str], downwards: bool
) -> RawMap:
    """Rows of heights below a header with the lengths of both sides; ``downwards`` if they begin with the largest y."""
    table = _numbers(path, lines)
    size = None
    if all(side in said for side in sides):
        size = tuple(quantity(said[side], "m", f"surface.path: {path}, {side}") for side in sides)
    return RawMap(table[::-1] if downwards else table, size, said.get("Value units"), "m")  # type: ignore[arg-type]


def _points(path: Path, lines: Sequence[str]) -> RawMap:
    """Columns x, y and height on an even grid, in any order; a header ``X[nm] Y[nm] Z[nm]`` gives the units."""
    first = next((i for i, line in enumerate(lines) if re.match(r"\s*[-+.\d]", line)), len(lines))
    units = re.findall(r"[XYZ]\s*\[(.*?)\]", "\n".join(lines[:first]))
    if len(units) == 3 and units[0] != units[1]:
        raise InputError(f"surface.path: {path} has x in {units[0]} and y in {units[1]}; give both in one unit")
    table = _numbers(path, lines[first:], "," if first < len(lines) and "," in lines[first] else None)
    if table.shape[1] < 3:
        raise InputError(f"surface.path: {path} has {table.shape[1]} columns; points need three, x, y and height")
    heights, size = gridded(path, table[:, :3])
    return RawMap(heights, size, *((units[2], units[0]) if len(units) == 3 else (None, None)))


def _xyz(path: Path, channel: Channel) -> RawMap:
    _only(path, channel)
    return _points(path, _lines(path))


def _lines(path: Path) -> list[str]:
    """The lines of a text; instruments still write the micro sign in Latin-1."""
    content = path.read_bytes()
    try:
        return content.decode("utf-8").splitlines()
    except UnicodeDecodeError:
        return content.decode("latin-1").splitlines()


def _numbers(path: Path, lines: Sequence[str], delimiter: str | None = None) -> np.ndarray:
    """Rows of numbers; ValueError, with the row, where there are other things or rows of other lengths."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of no rows
        try:
            table = np.loadtxt(lines, ndmin=2, delimiter=delimiter)
        except ValueError as error:
            raise ValueError(str(error).partition(";")[0]) from None  # then come arguments of loadtxt
    if not table.size:
        raise InputError(f"surface.path: {path} holds no numbers")
    return table


def _esri(path: Path, lines: Sequence[str]) -> RawMap:
    """An ASCII grid of ESRI: columns, rows, corner, cell size and the mark of missing heights, then rows."""
    said: dict[str, float] = {}
    while re.match(r"\s*[A-Za-z_]", lines[len(said)]):
        name, number = lines[len(said)].split()
        said[name.lower()] = float(number)
    heights = _numbers(path, lines[len(said) :])[::-1].copy()
    rows, columns = int(said.get("nrows", -1)), int(said["ncols"])
    if heights.shape != (rows, columns):
        raise InputError(
            f"surface.path: {path} holds {heights.shape[0]} x {heights.shape[1]} heights, its header says "
            f"{rows} x {columns}"
        )
    heights[heights == said.get("nodata_value", -9999.0)] = np.nan
    return RawMap(heights, (rows * said["cellsize"], columns * said["cellsize"]))


def _instrument(path: Path, channel: Channel, reason: str) -> RawMap:
    """Any of the formats of SurfaceTopography, whose arrays are (x, y)."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns of an MPI that is not there
            from SurfaceTopography.IO import CannotDetectFileFormat, open_topography
    except ImportError:
        raise InputError(
            f"surface.path: {path} is in none of the formats {', '.join(READERS)} or text ({reason}); instruments' "
            "files need pip install 'bem-adhesion[instruments]'"
        ) from None
    try:
        with _silent(), open_topography(str(path)) as reader:
            # A format without any mark: every file of the right length passes for it.
            if reader.format() == "hgt" and path.suffix.lower() != ".hgt":
                raise CannotDetectFileFormat
            maps = [one for one in reader.channels if one.dim == 2 and one.is_height_channel]
            name = chosen(path, [one.channel_id for one in maps], channel)
            found = next(one for one in maps if one.channel_id == name)
            sides = found.physical_sizes
            # It asks for a size where the file has none.
            topography = found.topography(physical_sizes=found.nb_grid_pts if sides is None else None)
            heights: np.ndarray = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan).T
            unit = topography.unit
    except CannotDetectFileFormat:
        raise InputError(
            f"surface.path: {path} is in no format that is known ({reason}); known are text, {', '.join(READERS)} "
            "and those of SurfaceTopography"
        ) from None
    return RawMap(heights, None if sides is None else (float(sides[1]), float(sides[0])), unit, unit)


@contextmanager
def _silent() -> Iterator[None]:
    """What a library logs of the formats that a file is not of is of no use to a reader."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        yield
    finally:
        logging.disable(before)


def _only(path: Path, channel: Channel) -> None:
    if channel not in (None, 0):
        raise InputError(f"surface.channel = {channel!r}: {path} holds one map")


def _is_text(path: Path) -> bool:
    with path.open("rb") as stream:
        start = stream.read(4096)
    return b"\0" not in start and not re.search(rb"[\x01-\x08\x0e-\x1f\x80-\x9f]{2}", start)


def _header(head: str, pattern: str) -> dict[str, str]:
    return {match["key"]: match["value"].strip() for match in re.finditer(pattern, head, re.MULTILINE)}


def _last(lines: Sequence[str], word: str) -> int:
    return max((i for i, line in enumerate(lines[:30]) if word in line), default=-1)


READERS: Mapping[str, Callable[[Path, Channel], RawMap]] = {
    ".npy": _npy,
    ".npz": _npz,
    ".nc": _netcdf,
    ".nc4": _netcdf,
    ".netcdf": _netcdf,
    ".xyz": _xyz,
}
