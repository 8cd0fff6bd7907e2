"""Finished steps of one case on disk, safe against a kill at any moment.

A case has a folder with one file per finished step, the state that the next step starts from, its constants and its
warnings. Every file is written aside and renamed, the state before its step, so what can be read is complete. Steps
are archives of NumPy arrays, each under a CRC-32; a file that a power cut has torn cannot be read, and is dropped.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.campaign.files import load_json, save_json, write_aside
from contact_study.campaign.record import Step
from contact_study.fields.distributions import Bins
from contact_study.observables.base import Value

_NOTES = "warnings.json"
_CONSTANTS = "constants.npz"

# Members of an archive that hold all that is no array, as JSON, and one after the other the arrays of no more numbers
# than so many: a member each would cost more than the numbers.
_SCALARS, _SMALL = "scalars", "small"
_SMALL_SIZE = 4096
# Among the scalars, and no quantities: the spans of the bins; name, type and shape of each small array in their order.
_BINS, _SHAPES = "bins", "shapes"


def save_step(folder: Path, number: int, step: Step) -> None:
    """Put one finished step on disk; its restart state first, the previous state last away."""
    save_state(folder, number, step.restart)
    save_values(folder, number, step)
    _state_file(folder, number - 1).unlink(missing_ok=True)
    _partial_file(folder, number).unlink(missing_ok=True)


def save_partial(folder: Path, number: int, kept: Mapping[str, np.ndarray]) -> None:
    """Put what is known so far of an unfinished step on disk."""
    _save(_partial_file(folder, number), kept)


def load_partial(folder: Path, number: int) -> dict[str, np.ndarray]:
    """What is known of an unfinished step; empty if nothing is."""
    path = _partial_file(folder, number)
    return _load(path)[0] if path.exists() else {}


def save_values(folder: Path, number: int, step: Step) -> None:
    """Put the values and fields of one finished step on disk, not its state."""
    bins = {} if step.bins is None else {_BINS: step.bins.spans}
    _save(_step_file(folder, number), {**step.values, **step.fields}, bins)


def finished_steps(folder: Path, steps: int) -> int:
    """How many of a case's ``steps`` are on disk, counted from the first without a gap, and can be gone on from."""
    number = 0
    while number < steps and _step_file(folder, number).exists():
        number += 1
    while 0 < number < steps and not _state_file(folder, number - 1).exists():
        number -= 1
    return number


def drop_steps(folder: Path, first: int) -> None:
    """Delete the steps from number ``first`` on, with their states; with none left the case's constants, too.

    An unfinished step stays if it comes before ``first``.
    """
    kept = {file(folder, number) for number in range(first) for file in (_step_file, _state_file, _partial_file)}
    for path in [*folder.glob("step-*.npz"), *folder.glob("state-*.npz"), *folder.glob("partial-*.npz")]:
        if path not in kept:
            path.unlink()
    if first == 0:
        (folder / _CONSTANTS).unlink(missing_ok=True)


def drop_damaged(folder: Path) -> int:
    """Delete what cannot be read, such as the empty files that some file systems leave after a power cut."""
    dropped = 0
    for suffix, read in _READERS.items():
        for path in folder.glob(f"*{suffix}"):
            try:
                read(path)
            except (OSError, ValueError):
                path.unlink()
                dropped += 1
    return dropped


def save_state(folder: Path, number: int, arrays: Mapping[str, np.ndarray]) -> None:
    """Put the state that the step after ``number`` starts from on disk."""
    _save(_state_file(folder, number), arrays)


def load_state(folder: Path, number: int) -> dict[str, np.ndarray]:
    """The state that the step after ``number`` starts from; empty if it was not kept."""
    path = _state_file(folder, number)
    return _load(path)[0] if path.exists() else {}


def has_constants(folder: Path) -> bool:
    """Whether a case's constants are on disk."""
    return (folder / _CONSTANTS).exists()


def save_constants(folder: Path, constants: Mapping[str, Value]) -> None:
    """Put what does not change along the path on disk."""
    _save(folder / _CONSTANTS, constants)


def load_constants(folder: Path) -> dict[str, Any]:
    """What does not change along the path of a case."""
    return _load(folder / _CONSTANTS)[0]


def save_notes(folder: Path, notes: Sequence[str]) -> None:
    """Put a case's warnings on disk."""
    folder.mkdir(parents=True, exist_ok=True)
    save_json(folder / _NOTES, list(notes))


def load_notes(folder: Path) -> list[str]:
    """A case's warnings so far."""
    path = folder / _NOTES
    return load_json(path) if path.exists() else []


def load_step(folder: Path, number: int) -> tuple[dict[str, Any], Bins]:
    """Quantities and fields of one finished step, and the bins of its distributions."""
    values, extra = _load(_step_file(folder, number))
    return values, Bins.evenly(*extra[_BINS])


def step_text(folder: Path, number: int, name: str) -> str:
    """A text among the quantities of one finished step."""
    return str(_scalars(_step_file(folder, number))[0][name])


def step_bins(folder: Path, number: int) -> Bins:
    """Bins of the distributions of one finished step."""
    return Bins.evenly(*_scalars(_step_file(folder, number))[1][_BINS])


def step_numbers(folder: Path) -> list[int]:
    """Numbers of the steps whose files are there, damaged ones too."""
    return sorted(int(path.stem.rpartition("-")[2]) for path in folder.glob("step-*.npz"))


def _step_file(folder: Path, number: int) -> Path:
    return folder / f"step-{number:04d}.npz"


def _state_file(folder: Path, number: int) -> Path:
    return folder / f"state-{number:04d}.npz"


def _partial_file(folder: Path, number: int) -> Path:
    return folder / f"partial-{number:04d}.npz"


def _save(path: Path, values: Mapping[str, Any], extra: Mapping[str, Any] | None = None) -> None:
    scalars: dict[str, Any] = {}
    small: dict[str, np.ndarray] = {}
    packed: dict[str, np.ndarray] = {}
    for name, value in values.items():
        array = np.asarray(value)
        if not array.ndim:
            scalars[name] = array.item()
        elif array.size <= _SMALL_SIZE:
            small[name] = array
        else:
            packed[f"array/{name}"] = array
    shapes = [(name, array.dtype.str, array.shape) for name, array in small.items()]
    # Python's JSON writes the shortest digits that give the same double again, and names NaN and infinities.
    text = json.dumps([scalars, {**(extra or {}), _SHAPES: shapes}]).encode()
    packed[_SCALARS] = np.frombuffer(text, np.uint8)
    packed[_SMALL] = np.frombuffer(b"".join(array.tobytes() for array in small.values()), np.uint8)

    def write(partial: Path) -> None:
        with partial.open("wb") as stream:
            np.savez(stream, **packed)  # type: ignore[arg-type]

    path.parent.mkdir(parents=True, exist_ok=True)
    write_aside(path, write)


def _load(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    with _archive(path) as archive:
        scalars, extra = json.loads(archive[_SCALARS].tobytes())
        arrays = {name.partition("/")[2]: archive[name] for name in archive if name.startswith("array/")}
        small = archive[_SMALL] if _SMALL in archive else np.empty(0, np.uint8)  # steps of an earlier version
        first = 0
        for name, kind, shape in extra.pop(_SHAPES, ()):
            end = first + np.dtype(kind).itemsize * math.prod(shape)
            arrays[name] = small[first:end].view(kind).reshape(shape).copy()  # where its numbers are aligned
            first = end
    return {**scalars, **arrays}, extra


def _scalars(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    with _archive(path) as archive:
        scalars, extra = json.loads(archive[_SCALARS].tobytes())
    return scalars, extra


@contextmanager
def _archive(path: Path) -> Iterator[Mapping[str, np.ndarray]]:
    """The arrays of a file; ValueError where it is damaged."""
    try:
        # np.load leaves a file open that it cannot read.
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            yield archive
    except (OSError, MemoryError):
        raise
    except Exception as error:  # a torn archive raises a dozen types
        raise ValueError(f"{path}: is damaged ({error})") from error


_READERS: dict[str, Callable[[Path], Any]] = {".npz": _load, ".json": load_json}
