"""Plug-ins: modules under a package's entry points, which call :func:`contact_study.register_law` and its like."""

from contact_study.inputs.errors import InputError

GROUP = "contact_study.plugins"
_loaded = False


def load() -> None:
    """Import the plug-ins of installed packages, once; InputError if one cannot be imported."""
    global _loaded
    if _loaded:
        return
    _loaded = True  # a plug-in may make a study itself
    from importlib.metadata import entry_points  # slow to import

    for entry in entry_points(group=GROUP):
        try:
            entry.load()
        except Exception as error:  # whatever a stranger's module raises
            raise InputError(f"plug-in {entry.name} ({entry.value}) cannot be loaded: {error}") from None
