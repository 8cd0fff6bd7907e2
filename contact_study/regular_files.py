"""What stands at the path of an input: a pipe would be waited for, a device read for ever."""

import errno
import stat
from pathlib import Path

from contact_study.errors import InputError


def what_is_at(path: Path) -> str:
    """What stands at a path, in words; empty for a regular file."""
    if path.is_file():
        return ""
    if path.is_dir():
        return "is a folder"
    if path.exists():
        return "is a pipe or a device, not a file"
    return "is a link that leads nowhere" if path.is_symlink() else "does not exist"


def refuse_endless(path: Path) -> None:
    """Raise OSError where nothing stands at a path, or what would be waited for or read for ever."""
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise OSError(errno.EINVAL, what_is_at(path))


def require_file(path: Path, name: str) -> None:
    """Raise InputError, in the name of a key or option, unless a regular file stands at a path."""
    if fault := what_is_at(path):
        raise InputError(f"{name}: {path} {fault}")
