"""Locks of objects whose work arrays serve one solve at a time."""

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

_Method = TypeVar("_Method", bound=Callable[..., Any])


def in_turn(method: _Method) -> _Method:
    """Make threads take turns in a method, by the lock ``turn`` of its object: its arrays serve one at a time."""

    @wraps(method)
    def taken(self: Any, /, *arguments: Any, **options: Any) -> Any:
        with self.turn:
            return method(self, *arguments, **options)

    return cast(_Method, taken)
