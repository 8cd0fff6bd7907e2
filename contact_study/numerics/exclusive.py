"""Locks of objects whose work arrays serve one solve at a time."""

from collections.abc import Callable
from functools import wraps
from threading import RLock
from typing import Concatenate, ParamSpec, Protocol, TypeVar


class Shared(Protocol):
    """An object with a lock, held by the thread that works with it."""

    turn: RLock


_Owner = TypeVar("_Owner", bound=Shared)
_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


def in_turn(
    method: Callable[Concatenate[_Owner, _Arguments], _Result],
) -> Callable[Concatenate[_Owner, _Arguments], _Result]:
    """Make threads take turns in a method: two at a time would write into the same arrays."""

    @wraps(method)
    def taken(self: _Owner, /, *arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        with self.turn:
            return method(self, *arguments, **options)

    return taken
