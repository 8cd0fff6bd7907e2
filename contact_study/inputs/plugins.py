"""Laws, solids, surfaces and observables from outside: modules that installed packages name as plug-ins.

A plug-in is a module that calls :func:`contact_study.register_law` and its like when it is imported. A package names it
under the entry points ``contact_study.plugins``; it then works in every command and on every worker. A script
that registers at its top level needs no entry point.
"""

from contact_study.inputs.errors import InputError

GROUP = "contact_study.plugins"
_loaded = False


def load() -> None:
    """Import the plug-ins of installed packages, once.

    Raises InputError if one cannot be imported.
    """
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
