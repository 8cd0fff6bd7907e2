"""Errors that a user can mend, shown as one line without a traceback, and the exit statuses of commands."""

from collections.abc import Mapping

DONE, WRONG_INPUT, NOT_CONVERGED, INTERRUPTED = 0, 1, 2, 130


class InputError(ValueError):
    """Input that cannot be used; the message is one line that names the culprit and says what to do."""


def refuse(reasons: Mapping[str, bool]) -> None:
    """Raise InputError with the first message that holds."""
    for message, holds in reasons.items():
        if holds:
            raise InputError(message)
