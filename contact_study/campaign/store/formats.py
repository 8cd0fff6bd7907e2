"""Formats of a dataset by the end of its name: ``.nc`` for a file of NetCDF, ``.zarr`` for a folder of Zarr."""

import gc
import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from contact_study.inputs.errors import InputError
from contact_study.inputs.files import what_is_at

_STORE = (".zgroup", "zarr.json")  # files of a Zarr folder, formats 2 and 3


def is_zarr(path: Path) -> bool:
    """Whether a name is that of a Zarr dataset."""
    return path.suffix == ".zarr"


def engine_of(path: Path) -> str:
    """Name of the format for xarray."""
    return "zarr" if is_zarr(path) else "netcdf4"


def is_dataset(path: Path) -> bool:
    """Whether a path leads to a file, or a folder of Zarr."""
    return is_store(path) if is_zarr(path) else path.is_file()


def is_store(path: Path) -> bool:
    """Whether a folder is a Zarr dataset."""
    return any((path / name).is_file() for name in _STORE)


def require_dataset(path: Path, name: str = "") -> None:
    """Raise InputError, under the name of an option if given, unless a path leads to a file or a folder of Zarr."""
    if not is_dataset(path):
        fault = what_is_at(path) or "is a file"
        raise InputError(f"{f'{name}: {path}' if name else f'{path}:'} {fault}; expected a dataset (NetCDF or Zarr)")


def check_name(path: Path) -> None:
    """Raise InputError unless a name ends as that of a dataset."""
    if path.suffix not in (".nc", ".zarr"):
        raise InputError(f"{path}: expected a name that ends in .nc, for NetCDF, or .zarr")


def check_format(path: Path) -> None:
    """Raise InputError if the library of a dataset's format is missing, or another folder has its name."""
    if not is_zarr(path):
        return
    if importlib.util.find_spec("zarr") is None:
        raise InputError(f"{path}: needs the package zarr; pip install '.[zarr]'")
    if path.exists() and not is_store(path):
        raise InputError(f"{path}: is there and is no Zarr; choose another output")


def move_dataset(dataset: Path, path: Path) -> None:
    """Rename a dataset to its place, over an earlier one; an earlier folder of Zarr moves beside the new one first.

    Raises
    ------
    OSError
        If the place is a folder that is no dataset.
    """
    if not path.is_dir():
        dataset.replace(path)
        return
    if not is_zarr(path) or not is_store(path):
        raise IsADirectoryError(f"{path}: is a folder, and no dataset that may be replaced")
    # No rename replaces a folder: after a kill in between, restore_dataset puts the earlier one back.
    path.rename(_earlier(dataset, path))
    dataset.rename(path)


def restore_dataset(dataset: Path, path: Path) -> None:
    """Put an earlier dataset back whose :func:`move_dataset` was killed."""
    if not path.exists() and is_store(_earlier(dataset, path)):
        _earlier(dataset, path).rename(path)


def _earlier(dataset: Path, path: Path) -> Path:
    return dataset.with_name(f"earlier-{path.name}")


def mark_of(path: Path) -> tuple[int, ...] | None:
    """Identify the file at a path: a later file there has another mark; None without a file."""
    files = [path / name for name in (".zmetadata", *_STORE)] if is_zarr(path) else []
    for file in (*files, path):
        try:
            found = file.stat()
        except OSError:
            continue
        return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns
    return None


@contextmanager
def readable(path: Path, name: str = "") -> Iterator[None]:
    """Turn any error of a library over a damaged dataset into one line.

    Parameters
    ----------
    path : pathlib.Path
        The dataset.
    name : str, optional
        Option that named it.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    try:
        yield
    except (InputError, MemoryError):
        raise
    except Exception as error:  # of a dozen types: a flipped bit may be anywhere
        # Closing a half-opened file crashes the netCDF library; a frozen object is never collected, hence never closed.
        gc.freeze()
        said = isinstance(error, OSError) and error.strerror
        reason = str(said or f"{type(error).__name__}: {error}").splitlines()[0]
        words = "Zarr" if is_zarr(path) else "NetCDF"
        who = f"{name}: {path}" if name else f"{path}:"
        raise InputError(f"{who} cannot be read as {words}, perhaps damaged or cut short ({reason})") from None
