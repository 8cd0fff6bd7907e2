"""Measurements of one surface as a user names them: files, or a list of them with the keys of each."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.files import content_hash, refuse_endless
from contact_study.physics.height_maps import preparation
from contact_study.physics.height_maps.container import read_container
from contact_study.physics.height_maps.height_map import is_line, read_height_map, read_raw, unit_size
from contact_study.physics.height_maps.text import MapError, RawMap, step_of
from contact_study.physics.roughness.measurement import Measurement
from contact_study.study.schema import keys
from contact_study.study.schema.keys import FLAG, METRES, TEXT, choice, key, pair

_LIST = "measurement"  # the tables of a list, [[measurement]]
# As readers of maps name keys, which are those of a surface.
_OWN = re.compile(r"\bsurface\.(?=(?:path|channel|height_unit|lateral_unit|size|fill)\b)")
_FEWEST = 16  # points of a line scan: three waves of four points each, and some


@dataclass(frozen=True, kw_only=True)
class MeasurementSection:
    """One file, and what it does not say."""

    path: str = key(TEXT, "map, line scan or container (.zip), relative to the list")
    channel: str | int | None = key(keys.NAME_OR_NUMBER, "map of a file, or surface of a container, of several", None)
    height_unit: str | None = key(TEXT, "unit of the heights where the file does not say", None)
    lateral_unit: str | None = key(TEXT, "unit of x and y where the file does not say", None)
    size: tuple[float, float] | None = key(pair(METRES, broadcast=True), "length of a line, or sides of a map", None)
    instrument: str | None = key(TEXT, "instrument, for the record", None)
    tip_radius: float | None = key(METRES, "radius of the probe's tip, which hides sharper peaks", None)
    resolution: float | None = key(METRES, "shortest wavelength that the instrument resolves", None)
    periodic: bool = key(FLAG, "heights continue over the edges, as made ones do: no window", False)
    detrend: str = key(
        choice("tilt", "curvature"), "polynomial subtracted by least squares: plane or second order", "tilt"
    )
    fill: str = key(choice("none", "harmonic"), "missing heights: refused, or continued from around them", "none")
    doi: str | None = key(TEXT, "digital object identifier of the data", None)

    def read(self, directory: Path, name: str) -> tuple[list[Measurement], list[str]]:
        """Read the measurements of the file, levelled, and what there is to say; InputErrors begin with ``name``."""
        path = directory / self.path
        try:
            if path.suffix.lower() == ".zip":
                found, notes = read_container(path, self.channel)
            else:
                found, notes = [self._single(path)], []
            source = f"sha256:{content_hash(path)}"
            given = {word: getattr(self, word) for word in ("instrument", "tip_radius", "resolution", "doi")}
            given = {word: value for word, value in given.items() if value is not None}
            return [self._level(replace(one, source=source, **given)) for one in found], notes
        except InputError as error:
            raise InputError(_OWN.sub(f"{name}.", str(error))) from None

    def _single(self, path: Path) -> Measurement:
        raw = read_raw(path, self.channel)
        values = np.where(np.isfinite(raw.heights), raw.heights, np.nan)
        if raw.height_unit is None and self.height_unit is None:
            raise InputError(f"missing key surface.height_unit: {path} does not say in which unit its heights are")
        if is_line(values):
            heights, spacing = self._line(path, raw, values)
            return Measurement(path.name, heights, (spacing,), periodic=self.periodic)
        whole = read_height_map(path, self.height_unit, self.size, self.channel, self.lateral_unit)
        return Measurement(path.name, whole.heights, whole.grid.spacing, periodic=self.periodic)

    def _line(self, path: Path, raw: RawMap, values: np.ndarray) -> tuple[np.ndarray, float]:
        """Heights of a line scan in order of x, and their spacing (m)."""
        metres = unit_size(path, "height_unit", self.height_unit, raw.height_unit)
        if values.ndim == 2 and values.shape[1] == 2:
            if raw.lateral_unit is None and self.lateral_unit is None:
                raise InputError(f"missing key surface.lateral_unit: {path} does not say in which unit its x is")
            x, heights = values[np.argsort(values[:, 0])].T
            try:
                spacing = step_of("x", x) * unit_size(path, "lateral_unit", self.lateral_unit, raw.lateral_unit)
            except MapError as error:
                raise InputError(f"surface.path: {str(error).replace('{path}', str(path))}") from None
        else:
            heights = values.ravel()
            if self.size is None:
                raise InputError(f"missing key surface.size: how long is the line scan of {path}? It has heights only")
            spacing = self.size[1] / heights.size
        if heights.size < _FEWEST:
            raise InputError(
                f"surface.path: {path} holds {heights.size} points of a line scan; expected {_FEWEST} or more"
            )
        return metres * heights, spacing

    def _level(self, found: Measurement) -> Measurement:
        missing = ~np.isfinite(found.heights)
        if missing.any() and self.fill == "none":
            raise InputError(
                f"surface.path: {100 * missing.mean():.2g} % of the heights of {found.name} are missing; "
                'surface.fill = "harmonic" fills them'
            )
        heights, line = np.atleast_2d(found.heights), found.heights.ndim == 1
        if not found.periodic:
            heights = preparation.detrended(heights, 1 if self.detrend == "tilt" else 2)
        heights = preparation.filled(heights, (1.0, 1.0) if line else found.spacing)  # type: ignore[arg-type]
        return replace(found, heights=heights[0] if line else heights)


def read_measurements(
    files: Sequence[Path | str], shared: Mapping[str, Any] | None = None
) -> tuple[list[Measurement], list[str]]:
    """Read measurements of one surface.

    Parameters
    ----------
    files : sequence of path-like
        Maps, line scans, containers (``.zip``) and lists: TOML with a table ``[[measurement]]`` for each file.
    shared : mapping, optional
        Keys of all files that are no list, such as ``height_unit``.

    Returns
    -------
    measurements : list of Measurement
        Levelled, in m.
    notes : list of str
        What was left out, and containers without a digital object identifier.

    Raises
    ------
    InputError
        If a file cannot be read or a unit is missing.

    Examples
    --------
    >>> from contact_study.study.schema.measurement import read_measurements
    >>> measurements, notes = read_measurements(["afm.nc", "stylus.csv"])  # doctest: +SKIP
    """
    measurements, notes = list[Measurement](), list[str]()
    for path in map(Path, files):
        tables = [(_LIST, {**(shared or {}), "path": path.name})]
        if path.suffix.lower() == ".toml":
            tables = [(f"{_LIST}[{number}]", table) for number, table in enumerate(_listed(path))]
        for name, table in tables:
            found, said = keys.bind(MeasurementSection, table, name).read(path.parent, name)
            measurements += found
            notes += said
    return measurements, notes


def _listed(path: Path) -> list[dict[str, Any]]:
    try:
        refuse_endless(path)
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read ({error}); expected a list of measurements (TOML)") from None
    tables = content.get(_LIST)
    if list(content) != [_LIST] or not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables):
        raise InputError(f"{path}: expected tables [[{_LIST}]] with a key path each, and no other")
    return tables
