"""Paths of inputs, and the folders where results of slow searches are kept between runs."""

import errno
import hashlib
import json
import os
import stat
import tempfile
from pathlib import Path

import platformdirs

from contact_study.inputs.errors import InputError

try:
    import fcntl
except ImportError:  # Windows, whose file systems all have locks
    fcntl = None  # type: ignore[assignment]


def what_is_at(path: Path) -> str:
    """Describe a path that is no regular file; empty for one that is."""
    if path.is_file():
        return ""
    if path.is_dir():
        return "is a folder"
    if path.exists():
        return "is a pipe or a device, not a file"
    return "is a link that leads nowhere" if path.is_symlink() else "does not exist"


def refuse_endless(path: Path) -> None:
    """Raise OSError for a missing path, and for a pipe or device, which would be read for ever."""
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise OSError(errno.EINVAL, what_is_at(path))


def require_file(path: Path, name: str) -> None:
    """Raise InputError, in the name of a key or option, unless a path is a regular file."""
    if fault := what_is_at(path):
        raise InputError(f"{name}: {path} {fault}")


def cache_folder() -> Path:
    """Folder of the user, or the one that ``BEM_ADHESION_CACHE`` names, where others may write: nothing is executed."""
    return Path(os.environ.get("BEM_ADHESION_CACHE") or own_cache_folder())


def own_cache_folder() -> Path:
    """Folder below the user's home, also for files that a library executes; it need not exist or be writable."""
    return platformdirs.user_cache_path("bem-adhesion")


def has_locks(folder: Path) -> bool:
    """Test whether files in a folder can be locked, which some clusters refuse; OSError if no file can be made."""
    if fcntl is None:
        return True
    with tempfile.TemporaryFile(dir=folder) as probe:
        try:
            fcntl.flock(probe, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
    return True


def content_hash(path: Path) -> str:
    """SHA-256 of a file's content, or of the names and contents of all files of a folder."""
    if path.is_dir():
        files = sorted(one.relative_to(path).as_posix() for one in path.rglob("*") if one.is_file())
        return hashlib.sha256(json.dumps([(name, content_hash(path / name)) for name in files]).encode()).hexdigest()
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
