"""A measured force curve as a dataset: force, displacement and contact radius with the signs of the simulations."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.files import content_hash, require_file
from contact_study.inputs.number_tables import TableError
from contact_study.inputs.units import quantity
from contact_study.physics.force_curves.columns import RawCurve
from contact_study.physics.force_curves.instruments import SUFFIXES, read_instrument
from contact_study.physics.force_curves.text import read_text

if TYPE_CHECKING:
    import xarray as xr

# Options of a curve: of those in words the possible values, of others the SI unit or the type.
OPTIONS: dict[str, tuple[str, ...] | str] = {
    "columns": "text",
    "curve": "number",
    "spring_constant": "N/m",
    "sensitivity": "m/V",
    "positive_force": ("compression", "tension"),
    "positive_displacement": ("approach", "retraction"),
    "zero_force": ("given", "baseline"),
    "zero_displacement": ("given", "contact"),
}
_BASELINE = 0.2  # of the displacements of the approach, from its start: without contact
_FEWEST = 10  # points of a baseline
_NOISE, _IN_A_ROW = 5.0, 3  # deviations of the baseline, and points beyond them, that make a contact
_DRIFT = 0.02  # of the largest force: a baseline drifts as far
_LOADING, _UNLOADING = 0, 1
_LONG_NAMES = {
    "total_force": ("N", "measured force, compression positive"),
    "displacement": ("m", "measured displacement of the probe towards the surface"),
    "contact_radius": ("m", "measured radius of the contact"),
    "time": ("s", "time of the measurement"),
}


def read_force_curve(path: Path | str, **options: Any) -> "xr.Dataset":
    """Read a measured force curve.

    Parameters
    ----------
    path : path-like
        Text with a line of names and units above columns of numbers, ``displacement (nm), force (nN)``; or a file of a
        microscope that afmformats reads (extra ``afm``: ibw, jpk-force, h5, …). A comment ``# option = value`` in a
        text gives an option below.
    **options
        ``columns``: a line of names and units in place of the file's, ``-`` for a column to leave out;
        ``curve``: number of the curve, of a file with several;
        ``spring_constant`` (N/m), ``sensitivity`` (m/V): the cantilever's, numbers or text with a unit;
        ``positive_force``: ``"compression"`` or ``"tension"``;
        ``positive_displacement``: of columns displacement and z, ``"approach"`` or ``"retraction"``;
        ``zero_force``: ``"given"``, or ``"baseline"``, the mean before contact (files of microscopes: the default);
        ``zero_displacement``: ``"given"``, or ``"contact"``, where the approach leaves the baseline by
        five of its deviations and 2 % of its largest force.

    Returns
    -------
    xarray.Dataset
        On ``point``: ``total_force`` (N, compression positive), ``displacement`` (m, positive towards the surface) and
        ``contact_radius`` (m) as far as the file has them, ``branch`` (0 loading, 1 unloading), ``time`` (s), and
        ``..._uncertainty`` of each; the file's name and SHA-256 as attributes.

    Raises
    ------
    InputError
        If a file or option cannot be used: a missing unit, an unknown column, falling times, no contact.

    Examples
    --------
    >>> from contact_study import read_force_curve
    >>> curve = read_force_curve("probe.csv", positive_force="tension")  # doctest: +SKIP
    """
    path = Path(path)
    require_file(path, "force curve")
    _check(options, "")
    try:
        raw = _read(path, options)
        said = {name: value for name, value in raw.options.items() if name in OPTIONS}
        _check(said, f"{path}: ")
        used = {name: value for name, value in {**said, **options}.items() if value is not None}
        found, branch = _quantities(raw, used)
    except TableError as error:
        raise InputError(error.of_file(path)) from None
    return _dataset(path, used, found, branch)


def _read(path: Path, options: Mapping[str, Any]) -> RawCurve:
    if path.suffix.lower() in SUFFIXES:
        if options.get("columns") is not None:
            raise InputError(f"columns: {path.suffix} files have names of their own; leave the option out")
        given = {name.replace("_", " "): _number(options, name) for name in ("spring_constant", "sensitivity")}
        return read_instrument(path, options.get("curve"), given)
    if options.get("curve") is not None:
        raise InputError(f"curve: {path} is text, which holds one curve; leave the option out")
    return read_text(path, options.get("columns"), OPTIONS)


def _check(options: Mapping[str, Any], where: str) -> None:
    """Refuse options that are unknown or have no possible value."""
    for name, value in options.items():
        if name not in OPTIONS:
            raise InputError(f"{where}{name}: is no option of a force curve; there is {', '.join(OPTIONS)}")
        known = OPTIONS[name]
        if isinstance(known, tuple) and value is not None and value not in known:
            raise InputError(f"{where}{name} = {value!r}: must be {' or '.join(map(repr, known))}")
        if known in ("N/m", "m/V") and value is not None and _number(options, name, where) <= 0:  # type: ignore[operator]
            raise InputError(f"{where}{name} = {value!r}: must be positive")


def _number(options: Mapping[str, Any], name: str, where: str = "") -> float | None:
    value = options.get(name)
    return None if value is None else quantity(value, str(OPTIONS[name]), f"{where}{name}")


def _quantities(raw: RawCurve, used: Mapping[str, Any]) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Variables of the dataset by name, and the branch of each point."""
    columns = dict(raw.columns)
    if "contact_area" in columns:
        if "contact_radius" in columns:
            raise TableError("{path} has contact area and contact radius; name one of them -")
        columns["contact_radius"] = np.sqrt(columns.pop("contact_area") / np.pi)
    force = _force(raw, columns, used)
    displacement = _displacement(raw, columns, force, used)
    radius = columns.get("contact_radius")
    if displacement is None and radius is None:
        raise TableError(f"{{path}} has {', '.join(raw.columns)}; a curve needs displacement or contact radius, too")
    for name, values in (("force", force), ("displacement", displacement)):
        if values is not None and not np.isfinite(values).all():
            raise TableError(f"{{path}}, row {int(np.argmin(np.isfinite(values))) + 1}: the {name} is missing")
    if "time" in columns and (late := np.flatnonzero(np.diff(columns["time"]) <= 0)).size:
        before, after = columns["time"][late[0] : late[0] + 2]
        raise TableError(f"{{path}}, row {late[0] + 2}: time {after:g} s after {before:g} s; times must rise")
    branch = _branch(columns.get("branch"), force if displacement is None else displacement)
    zero_force = used.get("zero_force", "baseline" if raw.baseline else "given")
    zero_displacement = used.get("zero_displacement", "given")
    if (zero_force, zero_displacement) != ("given", "given"):
        if displacement is None:
            raise TableError("{path} has no displacement; zero_force and zero_displacement must be given")
        rest, at = _baseline(force, displacement, branch)
        force = force - rest if zero_force == "baseline" else force
        displacement = displacement - at if zero_displacement == "contact" else displacement
    found = {"total_force": force, "displacement": displacement, "contact_radius": radius, "time": columns.get("time")}
    for name, values in raw.uncertainties.items():
        found[f"{'total_force' if name == 'force' else name}_uncertainty"] = np.abs(values)
    return {name: values for name, values in found.items() if values is not None}, branch


def _force(raw: RawCurve, columns: dict[str, np.ndarray], used: Mapping[str, Any]) -> np.ndarray:
    sign = -1.0 if used.get("positive_force") == "tension" else 1.0
    if "deflection" in columns:
        if raw.options.get("deflection_in") == "V":
            sensitivity = _number(used, "sensitivity")
            if sensitivity is None:
                raise TableError('{path} has a deflection in V; give sensitivity, as in "50 nm/V"')
            columns["deflection"] = columns["deflection"] * sensitivity
        columns["deflection"] = sign * columns["deflection"]
    if "force" in columns:
        return sign * columns["force"]
    if "deflection" not in columns:
        raise TableError(f"{{path}} has {', '.join(columns)}, no force and no deflection")
    stiffness = _number(used, "spring_constant")
    if stiffness is None:
        raise TableError('{path} has a deflection and no force; give spring_constant, as in "0.1 N/m"')
    return stiffness * columns["deflection"]


def _displacement(
    raw: RawCurve, columns: Mapping[str, np.ndarray], force: np.ndarray, used: Mapping[str, Any]
) -> np.ndarray | None:
    sign = -1.0 if used.get("positive_displacement") == "retraction" else 1.0
    ways = {"displacement": sign, "separation": -1.0, "z": sign, "height": -1.0}
    names = [name for name in ways if name in columns]
    if len(names) > 1:
        raise TableError(f"{{path}} has {' and '.join(names)}; leave one out with columns and the name -")
    if not names:
        return None
    moved = ways[names[0]] * columns[names[0]]
    if names[0] in ("displacement", "separation"):
        return moved
    # Of a piezo the bending of the cantilever is subtracted.
    if "deflection" in columns:
        return moved - columns["deflection"]
    stiffness = _number(used, "spring_constant") or raw.spring_constant
    if stiffness is None:
        raise TableError(
            f"{{path}} has {names[0]}, where the cantilever is held; give spring_constant, or call the column "
            "displacement where it is that of the probe"
        )
    return moved - force / stiffness


def _branch(said: np.ndarray | None, along: np.ndarray) -> np.ndarray:
    """Branch of each point: the file's, or unloading after the largest displacement (without one: force)."""
    if said is None:
        return (np.arange(along.size) > np.argmax(along)).astype(np.int8)
    if not np.isin(said, (_LOADING, _UNLOADING)).all():
        raise TableError("{path} has a branch other than 0, loading, and 1, unloading")
    return said.astype(np.int8)


def _baseline(force: np.ndarray, displacement: np.ndarray, branch: np.ndarray) -> tuple[float, float]:
    """Mean force before contact, and the displacement at which the approach leaves it."""
    way_in = np.flatnonzero(branch == _LOADING)
    if way_in.size:
        way_in = way_in[np.argsort(displacement[way_in], kind="stable")]
        start = displacement[way_in[0]] + _BASELINE * np.ptp(displacement[way_in])
        free = force[way_in[displacement[way_in] <= start]]
    if not way_in.size or free.size < _FEWEST:
        raise TableError(f"{{path}} has fewer than {_FEWEST} points of an approach before contact for a baseline")
    rest, noise = float(free.mean()), float(free.std())
    height = np.abs(force[way_in] - rest)
    away = height > max(_NOISE * noise, _DRIFT * float(height.max()))
    together = np.flatnonzero(np.convolve(away, np.ones(_IN_A_ROW), mode="valid") == _IN_A_ROW)
    if not together.size:
        raise TableError(
            f"{{path}} shows no contact: the approach stays within {_NOISE:g} deviations, {_NOISE * noise:.3g} N, of "
            "its baseline"
        )
    return rest, float(displacement[way_in[together[0]]])


def _dataset(path: Path, used: Mapping[str, Any], found: Mapping[str, np.ndarray], branch: np.ndarray) -> "xr.Dataset":
    import xarray as xr  # slow to import

    def variable(name: str, values: np.ndarray) -> "xr.Variable":
        units, words = _LONG_NAMES[name.removesuffix("_uncertainty")]
        long_name = f"uncertainty of the {words}" if name.endswith("_uncertainty") else words
        return xr.Variable("point", values, {"units": units, "long_name": long_name})

    flags = {"flag_values": np.array([_LOADING, _UNLOADING], np.int8), "flag_meanings": "loading unloading"}
    about = {"title": path.name, "source": f"{path.name} sha256:{content_hash(path)}"}
    return xr.Dataset(
        {name: variable(name, values) for name, values in found.items()},
        {"branch": xr.Variable("point", branch, {"long_name": "branch of the measurement", **flags})},
        {**about, "reading": ", ".join(f"{name} = {value}" for name, value in used.items())},
    )
