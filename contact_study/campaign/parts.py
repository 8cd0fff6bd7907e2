"""Finished steps on disk while a campaign runs, safe against a kill at any moment.

``bem.nc.parts`` holds one folder per case, named after what decides its numbers, with one small NetCDF file per
finished step and the state that the next step starts from. Every file is written aside and renamed, the state before
its step, so what can be read is complete. The dataset appears, by rename too, when all is done; then the folder goes.
"""

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from filelock import FileLock, Timeout

from contact_study.campaign.record import Step, Value
from contact_study.campaign.schema import variable_of
from contact_study.campaign.storage import write_aside, write_dataset
from contact_study.fields.observables import Bins
from contact_study.problem.errors import InputError

_NOTES = "warnings.json"
_SPANS = ("pressure_bins", "gap_bins")  # attributes of a step's file


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

    def open(self, *, resume: bool, overwrite: bool) -> dict[str, Any] | None:
        """Take the folder for this campaign, clearing what is there (overwrite) or leaving it (resume).

        Returns
        -------
        dict or None
            What the steps that are there belong to, as :meth:`claim` wrote it; empty if nothing readable says so, None
            if there are no steps.

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
        if self.folder.exists() and overwrite:
            shutil.rmtree(self.folder)
        if not self._manifest.exists() and not any(self.folder.glob("case-*")):
            return None
        if not resume:
            raise InputError(
                f"{self.folder} holds the steps of an unfinished run; continue it with --resume "
                "or drop it with --overwrite"
            )
        try:
            return dict(_load_json(self._manifest))
        except (OSError, ValueError, TypeError):
            return {}

    @property
    def _manifest(self) -> Path:
        return self.folder / "manifest.json"

    def belong_to(self, attributes: Mapping[str, Any]) -> bool:
        """Whether the folder, if there is one, holds steps of the run with these attributes."""
        try:
            there = dict(_load_json(self._manifest))
        except (OSError, ValueError, TypeError):
            return False
        return all(there.get(name) == value for name, value in attributes.items())

    def claim(self, attributes: Mapping[str, Any]) -> None:
        """Write what the steps belong to."""
        self.folder.mkdir(parents=True, exist_ok=True)
        _save_json(self._manifest, dict(attributes))

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

    def case_folder(self, name: str) -> Path:
        """Folder of one case."""
        return self.folder / f"case-{name}"

    def drop_damaged(self) -> int:
        """Delete what cannot be read, such as the empty files that some file systems leave after a power cut."""
        dropped = 0
        for path in [path for pattern in ("*.nc", "*.npz", _NOTES) for path in self.folder.glob(f"case-*/{pattern}")]:
            try:
                _READERS[path.suffix](path)
            except Exception:  # each format raises its own types
                path.unlink()
                dropped += 1
        return dropped


def save_step(folder: Path, number: int, step: Step) -> None:
    """Put one finished step on disk; its restart state first, the previous state last away."""
    save_state(folder, number, step.restart)
    save_values(folder, number, step)
    _state_file(folder, number - 1).unlink(missing_ok=True)


def save_values(folder: Path, number: int, step: Step) -> None:
    """Put the values and fields of one finished step on disk, not its state."""
    folder.mkdir(parents=True, exist_ok=True)
    bins = {} if step.bins is None else dict(zip(_SPANS, step.bins.spans, strict=True))
    write_aside(_step_file(folder, number), lambda path: _save_values(path, {**step.values, **step.fields}, bins))


def finished_steps(folder: Path, steps: int) -> int:
    """How many of a case's ``steps`` are on disk, counted from the first without a gap, and can be gone on from."""
    number = 0
    while number < steps and _step_file(folder, number).exists():
        number += 1
    while 0 < number < steps and not _state_file(folder, number - 1).exists():
        number -= 1
    return number


def drop_steps(folder: Path, first: int) -> None:
    """Delete the steps from number ``first`` on, with their states; with none left the case's constants, too."""
    kept = {_step_file(folder, number) for number in range(first)}
    for path in [*folder.glob("step-*.nc"), *folder.glob("state-*.npz")]:
        if path not in kept and path != _state_file(folder, first - 1):
            path.unlink()
    if first == 0:
        (folder / "constants.nc").unlink(missing_ok=True)


def save_state(folder: Path, number: int, arrays: Mapping[str, np.ndarray]) -> None:
    """Put the state that the step after ``number`` starts from on disk."""
    folder.mkdir(parents=True, exist_ok=True)
    write_aside(_state_file(folder, number), lambda path: _save_arrays(path, arrays))


def load_state(folder: Path, number: int) -> dict[str, np.ndarray]:
    """The state that the step after ``number`` starts from; empty if it was not kept."""
    path = _state_file(folder, number)
    return _load_arrays(path) if path.exists() else {}


def has_constants(folder: Path) -> bool:
    """Whether a case's constants are on disk."""
    return (folder / "constants.nc").exists()


def save_constants(folder: Path, constants: Mapping[str, Value]) -> None:
    """Put what does not change along the path on disk."""
    folder.mkdir(parents=True, exist_ok=True)
    write_aside(folder / "constants.nc", lambda path: _save_values(path, constants))


def load_constants(folder: Path) -> dict[str, Any]:
    """What does not change along the path of a case."""
    return _load_values(folder / "constants.nc")


def save_notes(folder: Path, notes: Sequence[str]) -> None:
    """Put a case's warnings on disk."""
    folder.mkdir(parents=True, exist_ok=True)
    _save_json(folder / _NOTES, list(notes))


def load_notes(folder: Path) -> list[str]:
    """A case's warnings so far."""
    path = folder / _NOTES
    return _load_json(path) if path.exists() else []


def load_step(folder: Path, number: int) -> tuple[dict[str, Any], Bins]:
    """Quantities and fields of one finished step, and the bins of its distributions."""
    with xr.open_dataset(_step_file(folder, number), engine="netcdf4", mask_and_scale=False) as dataset:
        return _values(dataset), _bins(dataset)


def step_text(folder: Path, number: int, name: str) -> str:
    """A text among the quantities of one finished step."""
    with xr.open_dataset(_step_file(folder, number), engine="netcdf4") as dataset:
        return str(dataset[name].values)


def step_bins(folder: Path, number: int) -> Bins:
    """Bins of the distributions of one finished step."""
    with xr.open_dataset(_step_file(folder, number), engine="netcdf4") as dataset:
        return _bins(dataset)


def _bins(dataset: xr.Dataset) -> Bins:
    return Bins.evenly(*(dataset.attrs[name] for name in _SPANS))


def step_numbers(folder: Path) -> list[int]:
    """Numbers of the steps whose files are there, damaged ones too."""
    return sorted(int(path.stem.rpartition("-")[2]) for path in folder.glob("step-*.nc"))


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


def _save_values(path: Path, values: Mapping[str, Value], attrs: Mapping[str, Any] | None = None) -> None:
    content = {}
    for name, value in values.items():
        value = np.asarray(value)
        dims = [f"{name.replace('/', '.')}_{axis}" for axis in range(value.ndim)]
        short = variable_of(name.rpartition("/")[2])
        content[name.replace("/", ".")] = xr.Variable(dims, value, {"units": short.units, "long_name": short.long_name})
    xr.Dataset(content, attrs=dict(attrs or {})).to_netcdf(path, engine="netcdf4")


def _load_values(path: Path) -> dict[str, Any]:
    with xr.open_dataset(path, engine="netcdf4", mask_and_scale=False) as dataset:
        return _values(dataset)


def _values(dataset: xr.Dataset) -> dict[str, Any]:
    return {str(name).replace(".", "/"): variable.values for name, variable in dataset.variables.items()}


_READERS: dict[str, Callable[[Path], Any]] = {".nc": _load_values, ".npz": _load_arrays, ".json": _load_json}
