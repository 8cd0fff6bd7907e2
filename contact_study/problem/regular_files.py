"""What stands at the path of an input: a pipe would be waited for, a device read for ever."""

from pathlib import Path

from contact_study.problem.errors import InputError


def what_is_at(path: Path) -> str:
    """What stands at a path, in words; empty for a regular file."""
    if path.is_file():
        return ""
    if path.is_dir():
        return "is a folder"
    if path.exists():
        return "is a pipe or a device, not a file"
    return "is a link that leads nowhere" if path.is_symlink() else "does not exist"


def require_file(path: Path, name: str = "") -> None:
    """Raise InputError, in the name of a key or option if there is one, unless a regular file stands at a path."""
    if fault := what_is_at(path):
        raise InputError(f"{name}{': ' if name else ''}{path} {fault}")
