"""Errors that a user can mend, shown as one line without a traceback."""


class InputError(ValueError):
    """Input that cannot be used; the message is one line that names the culprit and says what to do."""
