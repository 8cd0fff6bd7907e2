"""Formats of a dataset, told by the end of its name: ``.nc`` is a file of NetCDF, ``.zarr`` a folder of Zarr."""

import gc
import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from contact_study.errors import InputError
from contact_study.files import what_is_at

_STORE = (".zgroup", "zarr.json")  # what a folder of Zarr has, of format 2 and 3


def is_zarr(path: Path) -> bool:
    """Whether a dataset of this name is of Zarr."""
    return path.suffix == ".zarr"


def engine_of(path: Path) -> str:
    """What xarray calls the format."""
    return "zarr" if is_zarr(path) else "netcdf4"


def is_dataset(path: Path) -> bool:
    """Whether a file, or a folder of Zarr, stands there."""
    return is_store(path) if is_zarr(path) else path.is_file()


def is_store(path: Path) -> bool:
    """Whether a folder is one of Zarr."""
    return any((path / name).is_file() for name in _STORE)


def require_dataset(path: Path, name: str = "") -> None:
    """Raise InputError, in the name of an option if there is one, unless a file or a folder of Zarr stands there."""
    if not is_dataset(path):
        fault = what_is_at(path) or "is a file"
        raise InputError(f"{f'{name}: {path}' if name else f'{path}:'} {fault}; expected a dataset (NetCDF or Zarr)")


def check_name(path: Path) -> None:
    """Make sure that a dataset can have this name.

    Raises
    ------
    InputError
        If its end is of no format of datasets: what is read by its name, a table or a picture, would be something else.
    """
    if path.suffix not in (".nc", ".zarr"):
        raise InputError(f"{path}: expected a name that ends in .nc, for NetCDF, or .zarr")


def check_format(path: Path) -> None:
    """Make sure that a dataset of this name can be written.

    Raises
    ------
    InputError
        If the library is missing, or another folder stands there.
    """
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
    """What tells a dataset from every other one that stands at its place later; None where nothing stands."""
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
    """Make one line of whatever libraries raise over a dataset that is damaged, or none.

    Parameters
    ----------
    path : pathlib.Path
        The dataset.
    name : str, optional
        The option that named it.

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
        # A file half opened crashes netCDF's library when it is closed; what garbage collection leaves alone stays
        # open.
        gc.freeze()
        said = isinstance(error, OSError) and error.strerror
        reason = str(said or f"{type(error).__name__}: {error}").splitlines()[0]
        words = "Zarr" if is_zarr(path) else "NetCDF"
        who = f"{name}: {path}" if name else f"{path}:"
        raise InputError(f"{who} cannot be read as {words}, perhaps damaged or cut short ({reason})") from None
