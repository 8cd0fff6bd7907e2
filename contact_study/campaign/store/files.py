"""Outputs: checks before a run, and files that appear complete or not at all."""

import json
import os
import socket
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from contact_study.campaign.store.formats import check_format, is_zarr
from contact_study.inputs.errors import InputError


def named_file(name: str | Path) -> Path:
    """Return the path of an output; raises InputError for a folder's name, unless of Zarr."""
    path = Path(name)
    if not path.name or (str(name).endswith(os.sep) and not is_zarr(path)):
        raise InputError(f"{name}: is the name of a folder; name a file")
    return path


def writable_output(path: Path) -> None:
    """Make sure that a file can be written at ``path``, creating its folder.

    Raises
    ------
    InputError
        If the folder cannot be made or written, or what writes the format is missing.
    """
    check_format(path)
    if path.is_dir() and not is_zarr(path):
        raise InputError(f"{path}: is a folder; name a file")
    if path.is_symlink() and Path(real(path)).is_symlink():
        raise InputError(f"{path}: is a loop of links; choose another output")
    if path.exists() and not path.is_file() and not is_zarr(path):
        raise InputError(f"{path}: is a device, not a file; choose another output")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        probe = path.parent / f".{path.name}.{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another output") from None


def check_inputs_kept(output: Path, inputs: Sequence[Path | None]) -> None:
    """Raise InputError if the output is a file that the run reads."""
    for path in inputs:
        if path is not None and real(output) == real(path):
            raise InputError(f"{output}: is read by this run; choose another output")


def real(path: Path) -> str:
    """Resolve the links of a path as far as they lead."""
    return os.path.realpath(path)  # pathlib's fails over a loop of links


def write_aside(path: Path, write: Any) -> None:
    """Call ``write(temporary_path)`` and rename the result to ``path``: readers see all of it or nothing.

    Raises
    ------
    OSError
        If it cannot be written.
    """
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
    """Name the file in what is raised where it cannot be written.

    Raises
    ------
    OSError
        If it cannot.
    """
    try:
        yield
    except OSError as error:
        raise OSError(f"{path}: cannot be written ({error.strerror or error})") from None
    except RuntimeError as error:  # what the NetCDF library makes of a failed write
        raise OSError(f"{path}: cannot be written; is the disk full? ({error})") from None


def save_json(path: Path, content: Any) -> None:
    """Write a file of JSON, by rename."""
    write_aside(path, lambda partial: partial.write_text(json.dumps(content, indent=1), encoding="utf-8"))


def load_json(path: Path) -> Any:
    """Read a file of JSON."""
    return json.loads(path.read_text(encoding="utf-8"))
