"""Where what takes long to find out is kept between runs."""

import os
import tempfile
from pathlib import Path

import platformdirs

try:
    import fcntl
except ImportError:  # Windows, whose locks every file system has
    fcntl = None  # type: ignore[assignment]


def cache_folder() -> Path:
    """Folder of the user's own; ``BEM_ADHESION_CACHE`` names another. It need not exist, or be writable.

    Others may write into one that is named: nothing in it is executed.
    """
    return Path(os.environ.get("BEM_ADHESION_CACHE") or own_cache_folder())


def own_cache_folder() -> Path:
    """Folder below the user's home, for what a library reads as code, too. It need not exist, or be writable."""
    return platformdirs.user_cache_path("bem-adhesion")


def has_locks(folder: Path) -> bool:
    """Whether files in a folder can be locked: some file systems of clusters refuse, or wait for ever.

    Raises
    ------
    OSError
        If no file can be made there.
    """
    if fcntl is None:
        return True
    with tempfile.TemporaryFile(dir=folder) as probe:
        try:
            fcntl.flock(probe, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
    return True
