"""Formats of a dataset, told by the end of its name: ``.nc`` is a file of NetCDF, ``.zarr`` a folder of Zarr."""

import importlib.util
from pathlib import Path

from contact_study.problem.errors import InputError

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
        raise InputError(f"{path}: needs the package zarr; pip install 'bem-adhesion[zarr]'")
    if path.exists() and not is_store(path):
        raise InputError(f"{path}: is there and is no Zarr; choose another output")


def put(dataset: Path, path: Path) -> None:
    """Rename a dataset to its place, over an earlier one; of Zarr that goes beside where the dataset was."""
    if not path.is_dir():
        dataset.replace(path)
        return
    # No rename replaces a folder. A kill in between leaves all parts of the run, from which --resume goes on.
    earlier = dataset.with_name(f"earlier-{path.name}")
    path.rename(earlier)
    dataset.rename(path)
