"""Height maps as text: tables, columns x, y and height, ESRI and WSxM ASCII, and the even grids of coordinates."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.number_tables import NUMBER, TableError, first_row, lines_of, numbers_of
from contact_study.inputs.units import quantity

# The words of Gwyddion's export in the languages of its menus.
_WIDTH = "Width|Šířka|Breite|Anchura|Largeur|Larghezza|Largura|Ширина|幅|폭"
_HEIGHT = "Height|Výška|Höhe|Altura|Hauteur|Altezza|Высота|高さ|높이"
# Largest distance of a coordinate from its place on an even grid, in steps: rounded decimals and single precision.
_UNEVEN = 0.01
_SPARSEST = 4  # grid points for each point given, beyond which points are scattered and no grid with holes


class MapError(TableError):
    """A fault of a file of heights, in words after its name, or around ``{path}``."""


@dataclass(frozen=True)
class RawMap:
    """A map as its file has it; units are None where it gives none."""

    heights: np.ndarray  # numbers, NaN where missing, y and x increasing
    size: tuple[float, float] | None = None  # periods (y, x) in the lateral unit
    height_unit: str | None = None
    lateral_unit: str | None = None


def read_text(path: Path) -> RawMap:
    """A table of heights, or what its first lines say it is; InputError if damaged, ValueError of no known kind."""
    lines = lines_of(path)
    head = "\n".join(lines[:30])
    if head.startswith("WSxM") and "ASCII XYZ" in head:
        return _points(lines)
    if head.startswith("WSxM") and "ASCII Matrix" in head:
        size = _sides(path, head, r"^{} Amplitude:\s*(.*)$", ("Y", "X"))
        unit = re.search(r"^Z Amplitude:\s*[-+\d.eE]+\s*(\S+)", head, re.MULTILINE)
        rows = lines[1 + max(number for number, line in enumerate(lines[:30]) if "Amplitude:" in line) :]
        return RawMap(numbers_of(rows)[::-1], size, unit[1] if unit else None, "m")
    if re.match(r"\s*ncols\s", head, re.IGNORECASE):
        return _esri(lines)
    return _table(path, lines)


def read_points(path: Path) -> RawMap:
    """Columns x, y and height of points in any order; errors as :func:`read_text`."""
    return _points(lines_of(path))


def _table(path: Path, lines: Sequence[str]) -> RawMap:
    """Rows of heights; three columns are points, as no map is as narrow."""
    head = "\n".join(line for line in lines[:30] if line.lstrip().startswith("#"))
    rows = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    named = bool(rows) and not NUMBER.match(rows[0])
    if named and len(rows) > 1 and NUMBER.match(rows[1]) and (columns := numbers_of(rows[1:2]).shape[1]) in (2, 3):
        return _points(lines) if columns == 3 else _profile(lines)
    if rows and rows[0].lstrip()[:1] in (",", ";"):
        raise MapError("begins with an empty cell; leave out names of rows and columns, write nan for a missing height")
    try:
        table = numbers_of(rows)
    except ValueError as error:
        if named or isinstance(error, InputError):
            raise
        # No header of an instrument either: of numbers with words between them nothing is left out.
        raise MapError(f"cannot be read ({error})") from None
    size = _sides(path, head, r"^#\s*(?:{}):\s*(.*)$", (_HEIGHT, _WIDTH))
    if table.shape[1] == 3 and table.shape[0] > 3 and size is None:
        return _points(lines)
    if table.shape[1] == 2:
        return _profile(lines)
    unit = re.search(r"^#\s*Value units:\s*(\S+)", head, re.MULTILINE)
    # The comments in which Gwyddion and others export a table, whose first row is the top.
    said = size is not None or unit is not None
    return RawMap(table[::-1] if said else table, size, unit[1] if unit else None, "m")


def _sides(path: Path, head: str, pattern: str, sides: Sequence[str]) -> tuple[float, float] | None:
    """Lengths of both sides as a header says them (m)."""
    found = [re.search(pattern.format(side), head, re.MULTILINE) for side in sides]
    if found[0] is None or found[1] is None:
        return None
    y, x = (quantity(one[1].strip().replace(",", "."), "m", f"surface.path: {path}, {one[0]}") for one in found if one)
    return y, x


def _points(lines: Sequence[str]) -> RawMap:
    """Columns x, y and height on an even grid, in any order; a header ``X[nm] Y[nm] Z[nm]`` gives the units."""
    first = first_row(lines)
    head = "\n".join(lines[:first])
    units: list[str | None] = list(re.findall(r"[XYZ]\s*[\[(](.*?)[\])]", head, re.IGNORECASE))
    if len(units) == 3 and units[0] != units[1]:
        raise MapError(f"has x in {units[0]} and y in {units[1]}; give both in one unit")
    if len(units) != 3:
        said = (re.search(rf"^#\s*{key} units:\s*(\S+)", head, re.MULTILINE) for key in ("Lateral", "Value"))
        lateral, height = (one[1] if one else None for one in said)
        units = [lateral, lateral, height]
    table = numbers_of(lines[first:])
    if table.shape[1] < 3:
        raise MapError(f"has {table.shape[1]} columns; points need three, x, y and height")
    heights, size = gridded(table[:, :3])
    return RawMap(heights, size, units[2], units[0])


def _profile(lines: Sequence[str]) -> RawMap:
    """Columns x and height of a line scan, shape (x, 2); a header ``x (um), h (nm)`` gives the units."""
    first = first_row(lines)
    bracketed = (re.findall(r"[\[(]\s*([^\[\]()]+?)\s*[\])]", line) for line in lines[:first])
    lateral, height = next((found for found in bracketed if len(found) == 2), (None, None))
    return RawMap(numbers_of(lines[first:]), None, height, lateral)


def _esri(lines: Sequence[str]) -> RawMap:
    """An ASCII grid of ESRI: columns, rows, corner, cell size and the mark of missing heights, then rows."""
    said: dict[str, float] = {}
    while re.match(r"\s*[A-Za-z_]", lines[len(said)]):
        name, number = lines[len(said)].lower().split()
        said[name] = float(number)
    heights = numbers_of(lines[len(said) :])[::-1].copy()
    rows, columns = int(said.get("nrows", -1)), int(said["ncols"])
    if heights.shape != (rows, columns):
        raise MapError(f"holds {len(heights)} x {heights[0].size} heights, its header says {rows} x {columns}")
    heights[heights == said.get("nodata_value", -9999.0)] = np.nan
    return RawMap(heights, (rows * said["cellsize"], columns * said["cellsize"]))


def line_scan(points: int) -> MapError:
    """Make the error for a file that holds a line."""
    return MapError(f"holds a line scan ({points} points); a map (rows x columns) is needed")


def step_of(name: str, values: np.ndarray) -> float:
    """Find the spacing of even coordinates in either direction; raise InputError for others."""
    step = (values[-1] - values[0]) / (values.size - 1)
    even = values[0] + step * np.arange(values.size)
    if not np.all(np.abs(values - even) <= _UNEVEN * abs(step)) or step == 0:
        lengths = np.abs(np.diff(values))
        raise MapError(
            f"the coordinate {name} of {{path}} is not evenly spaced (steps from {lengths.min():.6g} to "
            f"{lengths.max():.6g}); resample the map on an even grid"
        )
    return abs(float(step))


def gridded(points: np.ndarray) -> tuple[np.ndarray, tuple[float, float]]:
    """Arrange points (x, y, height) in any order on their grid, NaN where there is none; return it and its periods."""
    if len(points) < 4 or not np.all(np.isfinite(points[:, :2])):
        raise MapError(f"holds {len(points)} points; expected a grid with finite x and y")
    columns, dx = _places("x", points[:, 0])
    rows, dy = _places("y", points[:, 1])
    shape = (int(rows.max()) + 1, int(columns.max()) + 1)
    if shape[0] * shape[1] > _SPARSEST * len(points):
        raise MapError(f"the {len(points)} points of {{path}} are scattered, on no grid; interpolate them onto one")
    if np.unique(rows * shape[1] + columns).size < len(points):
        raise MapError("holds two heights for one place")
    heights = np.full(shape, np.nan)
    heights[rows, columns] = points[:, 2]
    return heights, (shape[0] * dy, shape[1] * dx)


def _places(name: str, values: np.ndarray) -> tuple[np.ndarray, float]:
    """Number of each coordinate along its axis, and the spacing."""
    lowest, reach = float(values.min()), float(np.ptp(values))
    gaps = np.diff(np.unique(values))
    if gaps.size == 0:
        raise MapError(f"the points of {{path}} have one {name} only; expected at least 4")
    gaps = gaps[gaps > 0.1 * np.median(gaps[gaps >= 0.5 * gaps.max()])]  # smaller ones are one place, rounded
    steps = round(reach / float(np.median(gaps)))
    if np.all(gaps < 1.5 * np.median(gaps)):  # no line is missing as a whole: their number is exact
        steps = gaps.size
    spacing = reach / steps
    places = np.rint((values - lowest) / spacing).astype(int)
    off = np.abs(values - lowest - spacing * places).max() / spacing
    if off > _UNEVEN:
        raise MapError(
            f"the coordinate {name} of {{path}} is not evenly spaced (off its place by {off:.2g} of a step); resample "
            "the map on an even grid"
        )
    return places, spacing
