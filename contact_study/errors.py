"""What a user can mend: said in one line, without a traceback."""


class InputError(ValueError):
    """Input that cannot be used; the message is one line that names the culprit and says what to do."""
