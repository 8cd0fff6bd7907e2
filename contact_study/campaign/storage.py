"""Finished steps on disk, safe against a kill at any moment, and their assembly into one dataset.

While a campaign runs, ``bem.nc.parts`` holds one folder per case with one small NetCDF file per finished step and the
state that the next step starts from. Every file is written aside and renamed, the state before its step, so what can
be read is complete. The dataset appears, by rename too, when all is done; then the folder goes.
"""

import json
import os
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from filelock import FileLock, Timeout

from contact_study.campaign.record import Step, Value
from contact_study.campaign.schema import COORDINATES, VARIABLES
from contact_study.problem.errors import InputError
from contact_study.problem.study import SweptKey

_NOTES = "warnings.json"
_CHUNK_POINTS = 2**19


def writable_output(path: Path) -> None:
    """Make sure that a file can be written at ``path``, creating its folder.

    Raises
    ------
    InputError
        If the folder cannot be made or written.
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: is a device, not a file; choose another output")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        probe = path.parent / f".{path.name}.{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another output") from None


def write_aside(path: Path, write: Any) -> None:
    """Call ``write(temporary_path)`` and rename the result to ``path``: readers see all of it or nothing.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(partial)
        partial.replace(path)
    except RuntimeError as error:  # what the NetCDF library makes of a failed write
        raise OSError(f"{path}: cannot be written; is the disk full? ({error})") from None
    finally:
        partial.unlink(missing_ok=True)


class Parts:
    """The folder of a running campaign.

    Parameters
    ----------
    output : pathlib.Path
        The dataset it will become.
    """

    def __init__(self, output: Path):
        self.output = output
        self.folder = output.with_name(output.name + ".parts")
        self._lock = FileLock(str(self.folder) + ".lock")

    def open(self, identity: Mapping[str, Any], git_commit: str, *, resume: bool, overwrite: bool) -> list[str]:
        """Take the folder for this campaign, keeping what is there (resume) or clearing it (overwrite).

        Returns
        -------
        list of str
            What is to be known of the steps that are there: some damaged, or of another commit of this software.

        Raises
        ------
        InputError
            If another run is writing, or steps are there that may be neither used nor cleared.
        """
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise InputError(
                f"{self.output}: another run is writing it; wait for its end or choose another output"
            ) from None
        manifest = self.folder / "manifest.json"
        notes = []
        if self.folder.exists() and overwrite:
            shutil.rmtree(self.folder)
        if manifest.exists() or any(self.folder.glob("case-*")):
            if not resume:
                raise InputError(
                    f"{self.folder} holds the steps of an unfinished run; continue it with --resume "
                    "or drop it with --overwrite"
                )
            earlier = _manifest(manifest)
            if any(earlier.get(name) != value for name, value in identity.items()):
                raise InputError(
                    f"{self.folder} holds the steps of another study or version; use --overwrite or another output"
                )
            commit = earlier.get("git_commit")
            if commit != git_commit:
                notes.append(f"the earlier steps are of commit {commit}, the next of {git_commit}")
        self.folder.mkdir(parents=True, exist_ok=True)
        _save_json(manifest, {**identity, "git_commit": git_commit})
        damaged = _drop_damaged(self.folder)
        if damaged:
            notes.append(f"{damaged} damaged files of the earlier run are dropped and computed again")
        return notes

    def close(self) -> None:
        """Let other runs write."""
        if self._lock.is_locked:
            Path(self._lock.lock_file).unlink(missing_ok=True)
            self._lock.release()

    def finish(self, groups: Mapping[str, xr.Dataset]) -> None:
        """Write the dataset, inside the folder first, then rename it to the output and drop the folder."""
        dataset = self.folder / "dataset.nc"
        write_dataset(dataset, groups)
        dataset.replace(self.output)
        self.remove()

    def remove(self) -> None:
        """Drop the folder, whose dataset is written."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def case_folder(self, number: int) -> Path:
        """Folder of one case."""
        return self.folder / f"case-{number:04d}"


def _manifest(path: Path) -> dict[str, Any]:
    """What a folder's steps belong to; empty if nothing readable says so."""
    try:
        return dict(_load_json(path))
    except (OSError, ValueError, TypeError):
        return {}


def _drop_damaged(folder: Path) -> int:
    """Delete what cannot be read, such as the empty files that some file systems leave after a power cut."""
    dropped = 0
    for path in [*folder.glob("case-*/*.nc"), *folder.glob("case-*/*.npz"), *folder.glob(f"case-*/{_NOTES}")]:
        try:
            _READERS[path.suffix](path)
        except Exception:  # each format raises its own types
            path.unlink()
            dropped += 1
    return dropped


def save_step(folder: Path, number: int, step: Step) -> None:
    """Put one finished step on disk; its restart state first, the previous state last away."""
    folder.mkdir(parents=True, exist_ok=True)
    write_aside(_state_file(folder, number), lambda path: _save_arrays(path, step.restart))
    write_aside(_step_file(folder, number), lambda path: _save_values(path, {**step.values, **step.fields}))
    _state_file(folder, number - 1).unlink(missing_ok=True)


def finished_steps(folder: Path) -> int:
    """How many steps of a case are on disk, counted from the first without a gap."""
    number = 0
    while _step_file(folder, number).exists():
        number += 1
    while number and not _state_file(folder, number - 1).exists():
        number -= 1
    return number


def load_state(folder: Path, number: int) -> dict[str, np.ndarray]:
    """The state that the step after ``number`` starts from."""
    return _load_arrays(_state_file(folder, number))


def save_constants(folder: Path, constants: Mapping[str, Value]) -> None:
    """Put what does not change along the path on disk."""
    folder.mkdir(parents=True, exist_ok=True)
    write_aside(folder / "constants.nc", lambda path: _save_values(path, constants))


def save_notes(folder: Path, notes: Sequence[str]) -> None:
    """Put a case's warnings on disk."""
    folder.mkdir(parents=True, exist_ok=True)
    _save_json(folder / _NOTES, list(notes))


def load_notes(folder: Path) -> list[str]:
    """A case's warnings so far."""
    path = folder / _NOTES
    return _load_json(path) if path.exists() else []


def load_case(folder: Path, steps: int) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Constants and the values of every step of a finished case."""
    return _load_values(folder / "constants.nc"), [_load_values(_step_file(folder, i)) for i in range(steps)]


def assemble(
    sweep: Mapping[str, SweptKey],
    steps: int,
    cases: Iterable[tuple[tuple[int, ...], dict[str, Any], list[dict[str, Any]]]],
    coordinates: Mapping[str, np.ndarray],
) -> dict[str, xr.Dataset]:
    """Datasets by group ("" for the root) from the values of every case.

    Parameters
    ----------
    sweep : mapping
        Swept keys: the leading dimensions.
    steps : int
        Points of the longest loading path.
    cases : iterable
        Position in the sweep, constants, and values of each step.
    coordinates : mapping
        One-dimensional coordinates of the whole study.
    """
    lengths = tuple(len(swept.values) for swept in sweep.values())
    arrays: dict[str, np.ndarray] = {}
    for index, constants, path in cases:
        for name, value in constants.items():
            _place(arrays, name, value, lengths, index)
        for number, values in enumerate(path):
            for name, value in values.items():
                _place(arrays, name, value, (*lengths, steps), (*index, number))
    groups: dict[str, dict[str, np.ndarray]] = {"": {}}
    for name, array in arrays.items():
        group, _, short = name.rpartition("/")
        groups.setdefault(group, {})[short] = array
    on_step = {
        name: groups[""][name] for name in groups[""] if name in COORDINATES and _variable(name).dims == ("step",)
    }
    return {group: _dataset({**on_step, **content}, sweep, coordinates, steps) for group, content in groups.items()}


def write_dataset(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    """Write the groups of one dataset, by rename."""

    def write(partial: Path) -> None:
        for group, dataset in groups.items():
            encoding = {str(name): _encoding(str(name), variable) for name, variable in dataset.variables.items()}
            dataset.to_netcdf(
                partial, mode="a" if group else "w", group=group or None, encoding=encoding, engine="netcdf4"
            )

    write_aside(path, write)


def _encoding(name: str, variable: xr.Variable) -> dict[str, Any]:
    if variable.dtype.kind not in "fiu":
        return {}
    if variable.dims == (name,):  # CF: a coordinate has no missing values
        return {"_FillValue": None}
    encoding = _variable(name).encoding
    if encoding.get("zlib"):  # one state a chunk, and no more than a few MB: a reader of one field reads no other
        rows, columns = variable.shape[-2:]
        whole_rows = max(1, min(rows, _CHUNK_POINTS // columns)) if variable.dims[-2] != "step" else 1
        encoding |= {"chunksizes": (*(1,) * (variable.ndim - 2), whole_rows, columns)}
    return encoding


def _all_variables() -> dict[str, Any]:
    return {**COORDINATES, **VARIABLES}


def _variable(name: str) -> Any:
    return _all_variables()[name]


def _place(
    arrays: dict[str, np.ndarray], name: str, value: Any, lengths: tuple[int, ...], index: tuple[int, ...]
) -> None:
    variable = _variable(name.rpartition("/")[2])
    value = np.asarray(value)
    if name not in arrays:
        arrays[name] = np.full((*lengths, *value.shape), variable.empty, dtype=variable.dtype)
    if np.shape(arrays[name][index]) != value.shape:
        raise InputError(f"the sweep changes the number of points of {name}; run its points as studies of their own")
    arrays[name][index] = value if value.shape else value.item()


def _dataset(
    content: Mapping[str, np.ndarray],
    sweep: Mapping[str, SweptKey],
    coordinates: Mapping[str, np.ndarray],
    steps: int,
) -> xr.Dataset:
    data: dict[str, xr.Variable] = {}
    coords: dict[str, xr.Variable] = {}
    for name, array in content.items():
        dims = (*sweep, *_variable(name).dims)
        target = coords if name in COORDINATES else data
        if name in COORDINATES or not _variable(name).dims or _variable(name).dims[0] != "step":
            array, dims = _drop_constant_sweep(array, dims, len(sweep))
        target[name] = xr.Variable(dims, array, _attributes(name))
    # A coordinate that changes over the sweep cannot index its own dimension, which then counts points only.
    indices = {
        name: f"{name}_index" for name, variable in coords.items() if name in variable.dims and variable.ndim > 1
    }
    for variable in [*data.values(), *coords.values()]:
        variable.dims = tuple(indices.get(str(dim), dim) for dim in variable.dims)
    used = {dim for variable in [*data.values(), *coords.values()] for dim in variable.dims}
    for name, values in {**coordinates, "step": np.arange(steps, dtype=np.int32)}.items():
        if name in used and name not in coords:
            coords[name] = xr.Variable((name,), values, _attributes(name))
    for name, swept in sweep.items():
        coords[name] = xr.Variable(
            (name,), np.asarray(swept.values), {"units": swept.units, "long_name": swept.description}
        )
    return xr.Dataset(data, coords)


def _drop_constant_sweep(array: np.ndarray, dims: tuple[str, ...], swept: int) -> tuple[np.ndarray, tuple[str, ...]]:
    """Leave out a swept dimension along which a coordinate or constant does not change."""
    for axis in reversed(range(swept)):
        first = np.take(array, [0], axis=axis)
        same = array == first
        if array.dtype.kind == "f":
            same |= np.isnan(array) & np.isnan(first)
        if np.all(same):
            array, dims = np.take(array, 0, axis=axis), (*dims[:axis], *dims[axis + 1 :])
    return array, dims


def _attributes(name: str) -> dict[str, Any]:
    variable = _variable(name)
    return {"units": variable.units, "long_name": variable.long_name, **variable.attrs}


def _step_file(folder: Path, number: int) -> Path:
    return folder / f"step-{number:04d}.nc"


def _state_file(folder: Path, number: int) -> Path:
    return folder / f"state-{number:04d}.npz"


def _save_arrays(path: Path, arrays: Mapping[str, np.ndarray]) -> None:
    with path.open("wb") as stream:
        np.savez(stream, **dict(arrays))  # type: ignore[arg-type]


def _load_arrays(path: Path) -> dict[str, np.ndarray]:
    # np.load leaves a file open that it cannot read.
    with path.open("rb") as stream, np.load(stream, allow_pickle=False) as arrays:
        return dict(arrays)


def _save_json(path: Path, content: Any) -> None:
    write_aside(path, lambda partial: partial.write_text(json.dumps(content, indent=1), encoding="utf-8"))


def _load_json(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


def _save_values(path: Path, values: Mapping[str, Value]) -> None:
    content = {}
    for name, value in values.items():
        value = np.asarray(value)
        dims = [f"{name.replace('/', '.')}_{axis}" for axis in range(value.ndim)]
        short = _variable(name.rpartition("/")[2])
        content[name.replace("/", ".")] = xr.Variable(dims, value, {"units": short.units, "long_name": short.long_name})
    xr.Dataset(content).to_netcdf(path, engine="netcdf4")


def _load_values(path: Path) -> dict[str, Any]:
    with xr.open_dataset(path, engine="netcdf4", mask_and_scale=False) as dataset:
        return {str(name).replace(".", "/"): variable.values for name, variable in dataset.variables.items()}


_READERS: dict[str, Callable[[Path], Any]] = {".nc": _load_values, ".npz": _load_arrays, ".json": _load_json}
