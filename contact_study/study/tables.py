"""Columns of numbers from a file, as they go into a study: measured laws and solids, and roughness spectra."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.inputs.files import refuse_endless
from contact_study.physics.roughness.spectrum import TabulatedSpectrum
from contact_study.study.schema.bodies import ROUGH_SECTIONS

_SHOWN = 40  # letters of a line in a message
FILE, TABLE = "file", "table"
_KEY, _UNIT_KEYS = "spectrum_path", ("wavevector_unit", "density_unit")
_SI, _NAMES = ("m^-1", "m^4"), ("wavevector", "power")

_OWN = "power_spectrum"  # the spectrum of a surface in this project's own datasets
_MOST = 20_000  # more rows than any average over directions has; a study holds them all
_ROUNDING = 1e-20  # of the largest power: what a transform leaves of waves that a surface does not have


def _numbers_of(rows: Sequence[tuple[int, str]], where: str, separator: str) -> np.ndarray:
    """Read the numbers of numbered lines, a row a line, between separators (a regular expression)."""
    table: list[list[float]] = []
    first = 0
    for number, line in rows:
        words = [word for word in re.split(separator, line) if word]
        if not words:
            continue
        first = first or number
        try:
            table.append([float(word) for word in words])
        except ValueError:
            raise InputError(
                f"{where} is no table of numbers: line {number} is {line.strip()[:_SHOWN]!r}; remove words, or put "
                "# before them, and part columns by blanks, tabs or commas"
            ) from None
        if len(words) != len(table[0]):
            counts = f"line {number} has {len(words)} of them, line {first} has {len(table[0])}"
            raise InputError(f"{where} is no table of numbers: {counts}")
    return np.array(table, ndmin=2)


def _text_of(path: Path, name: str) -> str:
    try:
        refuse_endless(path)
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise InputError(f"{name}: {path} cannot be read ({reason})") from None


def with_columns(table: Mapping[str, Any], section: str, columns: Mapping[str, str], directory: Path) -> dict[str, Any]:
    """Replace the key ``path`` of a section by the columns of its file, in SI; a study holds its numbers."""
    if not columns or not isinstance(table.get("path"), str):
        return dict(table)
    beside = [name for name in columns if name in table]
    if beside:
        raise InputError(f"{section}.path and {section}.{beside[0]}: give the file or its numbers, not both")
    path, name = directory / table["path"], f"{section}.path"
    lines = [(number, line.split("#")[0]) for number, line in enumerate(_text_of(path, name).splitlines(), 1)]
    rows = [(number, line) for number, line in lines if line.strip()]
    if not rows:
        raise InputError(f"{name}: {path} is empty; expected {len(columns)} columns of numbers")
    numbers = _numbers_of(rows, f"{name}: {path}", r"[\s,]+")
    if numbers.shape[1] != len(columns) or not np.all(np.isfinite(numbers)):
        expected = f"expected {len(columns)} columns of finite numbers"
        raise InputError(f"{name}: {path} holds a table of shape {numbers.shape}; {expected}")
    kept = {name: value for name, value in table.items() if name not in ("path", *map("{}_unit".format, columns))}
    for values, (column, si) in zip(numbers.T, columns.items(), strict=True):
        key = f"{column}_unit"
        unit = str(table.get(key, si))
        try:
            size = units.quantity(f"1 {unit}", si, key)
        except InputError:
            raise InputError(f"{section}.{key} = {unit!r}: is no unit that can be converted to {si}") from None
        kept[column] = [float(value) * size for value in values]
    return kept


def read_spectrum(
    path: Path | str, wavevector_unit: str | None = None, density_unit: str | None = None
) -> TabulatedSpectrum:
    """Read a roughness spectrum from a file.

    Parameters
    ----------
    path : path-like
        NetCDF (``.nc``), with one spectrum on its wavevectors, or ``power_spectrum`` as the datasets here have it; else
        text, q and C(q) a row a line, between blanks, tabs or commas. A header names the columns with their units,
        ``q (1/m), C (m^4)``; columns beyond these two need one, and are left out. Rows of no power at the ends, or of
        a transform's rounding, are outside of the spectrum.
    wavevector_unit, density_unit : str, optional
        Units where the file is silent.

    Returns
    -------
    TabulatedSpectrum

    Raises
    ------
    InputError
        If there is no such file, a unit is missing, unknown or not that of the quantity, or there is no spectrum in it.

    Examples
    --------
    >>> from theory import read_spectrum
    >>> spectrum = read_spectrum("psd.csv", "nm^-1", "nm^4")  # doctest: +SKIP
    """
    return TabulatedSpectrum(*_columns(Path(path), "path", (wavevector_unit, density_unit)))


def with_spectrum(table: Mapping[str, Any], directory: Path) -> dict[str, Any]:
    """A study with the numbers of the file that ``theory.spectrum_path`` names, and ``"table"`` for ``"file"``."""
    section = table.get("theory", {})
    if not isinstance(section.get(_KEY), str):
        return dict(table)
    swept = table.get("sweep", {})
    asked = [holder[name] for holder, name in ((section, "spectrum"), (swept, "theory.spectrum")) if name in holder]
    if not any(FILE in _words(one) for one in asked):
        raise InputError(f'theory.{_KEY} is given, but theory.spectrum does not name "{FILE}"')
    changed = {**table, "theory": _with_numbers(section, "theory", directory)}
    if "sweep" in table:
        changed["sweep"] = dict(swept)
    for holder, name in ((changed["theory"], "spectrum"), (changed.get("sweep", {}), "theory.spectrum")):
        if name in holder:
            words = [TABLE if word == FILE else word for word in _words(holder[name])]
            holder[name] = words if isinstance(holder[name], list) or len(words) > 1 else words[0]
    return changed


def with_drawn_spectra(table: Mapping[str, Any], directory: Path) -> dict[str, Any]:
    """A study with the numbers of the files that ``spectrum_path`` of a surface names."""
    changed = dict(table)
    for name in ROUGH_SECTIONS:
        section = table.get(name, {})
        if section.get("kind") == "spectrum" and isinstance(section.get(_KEY), str):
            changed[name] = _with_numbers(section, name, directory)
            ratio = _bound_ratio(directory / section[_KEY], changed[name]["wavevectors"])
            changed[name] |= {"bound_ratio": ratio} if ratio else {}
    return changed


def _bound_ratio(path: Path, wavevectors: Sequence[float]) -> list[float]:
    """Upper over lower bound of C at each q (1/m) in a dataset of this project; nothing of other files.

    In a gap between measurements it is a power law, as C is.
    """
    import xarray as xr  # slow to import

    if path.suffix.lower() != ".nc":
        return []
    with xr.open_dataset(path, decode_timedelta=False) as dataset:
        names = [f"{_OWN}_{end}" for end in ("upper", "lower")]
        if not all(name in dataset for name in names):
            return []
        ratio = np.log(dataset[names[0]].values / dataset[names[1]].values)
        known, q = np.isfinite(ratio), dataset["wavevector"].values
    found: list[float] = np.exp(np.interp(np.log(wavevectors), np.log(q[known]), ratio[known])).tolist()
    return found


def _with_numbers(section: Mapping[str, Any], name: str, directory: Path) -> dict[str, Any]:
    """A section with the numbers of the spectrum's file that it names."""
    beside = [key for key in ("wavevectors", "density") if key in section]
    if beside:
        raise InputError(f"{name}.{_KEY} and {name}.{beside[0]}: give the file or its numbers, not both")
    q, density = _columns(directory / section[_KEY], f"{name}.{_KEY}", [section.get(key) for key in _UNIT_KEYS])
    kept = {key: value for key, value in section.items() if key not in (_KEY, *_UNIT_KEYS)}
    return {**kept, "wavevectors": q.tolist(), "density": density.tolist()}


def _words(spectrum: Any) -> list[Any]:
    if isinstance(spectrum, str):
        return [word.strip() for word in spectrum.split(",")]
    return spectrum if isinstance(spectrum, list) else [spectrum]


def _columns(path: Path, key: str, given: Sequence[Any]) -> tuple[np.ndarray, np.ndarray]:
    """The rows that hold a spectrum; those at the ends whose power is none, or a transform's rounding, are outside."""
    where = f"{key}: {path}"
    columns, said = _netcdf(path, where) if path.suffix.lower() == ".nc" else _text(path, key, where)
    about = zip(columns, _NAMES, _UNIT_KEYS, said, given, _SI, strict=True)
    q, density = (column * _factor(where, *words) for column, *words in about)
    for name, column, si, wrong in zip(_NAMES, (q, density), _SI, (q <= 0, density < 0), strict=True):
        bad = ~np.isfinite(column) | wrong
        if bad.any():
            row = int(np.argmax(bad))
            raise InputError(f"{where}, row {row + 1}: {name} {column[row]:g} {si}; must be a positive number")
    falling = np.flatnonzero(np.diff(q) <= 0)
    if falling.size:
        row = int(falling[0]) + 1
        raise InputError(f"{where}, row {row + 1}: wavevector {q[row]:g} m^-1 after {q[row - 1]:g}; they must rise")
    held = np.flatnonzero(density > _ROUNDING * density.max(initial=0.0))
    if held.size < 2:
        raise InputError(f"{where} holds {held.size} rows with power; a spectrum needs two, a range of wavevectors")
    if held.size > _MOST:
        raise InputError(f"{where} holds {held.size} rows; average it to {_MOST} at most")
    q, density = q[held[0] : held[-1] + 1], density[held[0] : held[-1] + 1]
    if not density.all():
        row = held[0] + int(np.argmin(density))
        raise InputError(f"{where}, row {row + 1}: power 0 m^4 between others; leave such rows out")
    for name, column, si in zip(_NAMES, (q, density), _SI, strict=True):
        for value in (column.min(), column.max()):
            units.quantity(float(value), si, f"{where}, {name}")
    return q, density


def _factor(where: str, name: str, key: str, own: str | None, asked: Any, si: str) -> float:
    """Size of a column's unit in SI."""
    if own is None and asked is None:
        section = where.partition(".")[0] if where.startswith(ROUGH_SECTIONS) else "theory"
        raise InputError(
            f'{where} does not say the unit of its {name}; give a header, "q (1/m), C (m^4)", or {section}.{key}'
        )
    # As keys spell it: 1/m and m-1 are m^-1, m4 is m^4.
    words = [re.sub(r"^1\s*/\s*([^\W\d]+)$", r"\1^-1", str(unit).strip()) for unit in (own, asked) if unit]
    spelt = [re.sub(r"([^\W\d])(-?\d+)", r"\1^\2", word) for word in words]
    sizes = [units.quantity(f"1 {unit}", si, f"{where}, unit of {name}") for unit in spelt]
    if len(sizes) > 1 and not math.isclose(*sizes, rel_tol=1e-9):
        raise InputError(f"{where}: its {name} is in {own}, the study says {asked}")
    return sizes[0]


def _text(path: Path, key: str, where: str) -> tuple[np.ndarray, list[str | None]]:
    """Both columns, and the units that a header gives them."""
    header, rows = [], []
    for number, line in enumerate(map(str.strip, _text_of(path, key).splitlines()), 1):
        try:
            float(re.split(r"[\s,;]+", line)[0])
            rows.append((number, line))
        except ValueError:
            header.append(line)
    bracketed = [re.findall(r"[(\[]\s*([^()\[\]]+?)\s*[)\]]", line) for line in header]
    named = next((found for found in reversed(bracketed) if len(found) >= len(_NAMES)), None)
    table = _numbers_of(rows, where, r"[\s,;]+")
    if not table.size or table.shape[1] < len(_NAMES) or (table.shape[1] > len(_NAMES) and named is None):
        raise InputError(
            f"{where} holds {table.shape[1] if table.size else 'no'} columns of numbers; expected q and C(q), and more "
            'only under a header such as "q (1/m), C (m^4)"'
        )
    return table.T[:2], [None, None] if named is None else named[:2]


def _netcdf(path: Path, where: str) -> tuple[np.ndarray, list[str | None]]:
    """The spectrum of a dataset and its wavevectors, with their units."""
    import xarray as xr  # slow to import

    try:
        refuse_endless(path)
    except OSError as error:
        raise InputError(f"{where} cannot be read ({error.strerror})") from None
    try:
        with xr.open_dataset(path, decode_timedelta=False) as opened:
            dataset = opened.load()
    except MemoryError:
        raise
    except Exception as error:  # of a dozen types, of a file that is damaged
        raise InputError(f"{where} is no NetCDF file ({str(error).partition(chr(10))[0]})") from None
    names = [_OWN] if _OWN in dataset else [str(name) for name, values in dataset.items() if values.squeeze().ndim == 1]
    if len(names) != 1:
        raise InputError(f"{where} holds {len(names)} variables on one dimension ({', '.join(names)}); expected one")
    density = dataset[names[0]].squeeze(drop=True)
    if density.ndim != 1 or density.dims[0] not in dataset.coords:
        on = ", ".join(map(str, density.dims))
        raise InputError(f"{where}: {names[0]} stands on {on}; expected one spectrum on its wavevectors")
    axis = dataset[density.dims[0]]
    there = np.isfinite(axis.values)  # surfaces of fewer wavevectors are padded
    said = [variable.attrs.get("units") for variable in (axis, density)]
    return np.stack([axis.values, density.values])[:, there], said
