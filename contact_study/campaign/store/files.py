"""Outputs: formats of datasets, checks before a run, and files that appear complete or not at all."""

import gc
import importlib.util
import os
import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from contact_study.inputs.errors import InputError
from contact_study.inputs.files import what_is_at

_STORE = (".zgroup", "zarr.json")  # files of a Zarr folder, formats 2 and 3


def is_zarr(path: Path) -> bool:
    """Whether a name is that of a Zarr dataset, a folder."""
    return path.suffix == ".zarr"


def engine_of(path: Path) -> str:
    """Name of a dataset's format for xarray."""
    return "zarr" if is_zarr(path) else "netcdf4"


def is_dataset(path: Path) -> bool:
    """Whether a path leads to a file, or a folder of Zarr."""
    return any((path / name).is_file() for name in _STORE) if is_zarr(path) else path.is_file()


def require_dataset(path: Path, name: str = "") -> None:
    """Raise InputError, under the name of an option if given, unless a path leads to a file or a folder of Zarr."""
    if not is_dataset(path):
        fault = what_is_at(path) or "is a file"
        raise InputError(f"{f'{name}: {path}' if name else f'{path}:'} {fault}; expected a dataset (NetCDF or Zarr)")


def check_name(path: Path) -> None:
    """Raise InputError unless a name ends as that of a dataset."""
    if path.suffix not in (".nc", ".zarr"):
        raise InputError(f"{path}: expected a name that ends in .nc, for NetCDF, or .zarr")


def named_file(name: str | Path) -> Path:
    """Return the path of an output; raises InputError for a folder's name, unless of Zarr."""
    path = Path(name)
    if not path.name or (str(name).endswith(os.sep) and not is_zarr(path)):
        raise InputError(f"{name}: is the name of a folder; name a file")
    return path


def writable_output(path: Path) -> None:
    """Make sure that a file, or a folder of Zarr, can be written at ``path``, creating its folder."""
    if is_zarr(path):
        if importlib.util.find_spec("zarr") is None:
            raise InputError(f"{path}: needs the package zarr; pip install '.[zarr]'")
        if path.exists() and not is_dataset(path):
            raise InputError(f"{path}: is there and is no Zarr; choose another output")
    if path.is_dir() and not is_zarr(path):
        raise InputError(f"{path}: is a folder; name a file")
    loop = path.is_symlink() and Path(real(path)).is_symlink()
    if loop or (path.exists() and not path.is_file() and not is_zarr(path)):
        raise InputError(f"{path}: is a {'loop of links' if loop else 'device, not a file'}; choose another output")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        probe = path.parent / f".{path.name}.{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another output") from None


def check_inputs_kept(output: Path, inputs: Sequence[Path | None]) -> None:
    """Raise InputError if the output is a file that the run reads."""
    if real(output) in {real(path) for path in inputs if path is not None}:
        raise InputError(f"{output}: is read by this run; choose another output")


def real(path: Path) -> str:
    """Resolve the links of a path as far as they lead."""
    return os.path.realpath(path)  # pathlib's fails over a loop of links


def write_aside(path: Path, write: Callable[[Path], object]) -> None:
    """Call ``write(temporary_path)`` and rename the result to ``path``: readers see all of it or nothing."""
    # Two machines may have processes of one number.
    partial = path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}.tmp")
    try:
        with writing(path):
            write(partial)
            partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Name the file in the OSError that is raised where it cannot be written."""
    try:
        yield
    except OSError as error:
        raise OSError(f"{path}: cannot be written ({error.strerror or error})") from None
    except RuntimeError as error:  # what the NetCDF library makes of a failed write
        if type(error) is not RuntimeError:
            raise
        raise OSError(f"{path}: cannot be written; is the disk full? ({error})") from None


@contextmanager
def readable(path: Path, name: str = "") -> Iterator[None]:
    """Turn any error over a damaged dataset, in the name of an option if given, into an InputError of one line."""
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
