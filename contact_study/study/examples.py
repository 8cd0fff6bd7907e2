"""The example studies in the package."""

from importlib.resources import files

from contact_study.inputs.errors import InputError

_SUFFIX, _FOLDER = ".toml", files("contact_study").joinpath("example_studies")


def example_names() -> list[str]:
    """Return the names of the examples."""
    return sorted(file.name.removesuffix(_SUFFIX) for file in _FOLDER.iterdir() if file.name.endswith(_SUFFIX))


def example(name: str) -> str:
    """Return the study file of an example; raises InputError for an unknown name."""
    from contact_study.study.schema.keys import suggestion  # slow to import

    known = example_names()
    if name not in known:
        raise InputError(f"unknown example {name}{suggestion(name, known)}; known: {', '.join(known)}")
    return _FOLDER.joinpath(name + _SUFFIX).read_text(encoding="utf-8")
