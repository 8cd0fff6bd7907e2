"""The example studies that come with the package."""

import tomllib
from importlib.resources import files
from importlib.resources.abc import Traversable

from contact_study.errors import InputError
from contact_study.study.schema.keys import suggestion

_SUFFIX = ".toml"


def example_names() -> list[str]:
    """Names of the examples."""
    return sorted(file.name.removesuffix(_SUFFIX) for file in _folder().iterdir() if file.name.endswith(_SUFFIX))


def example(name: str) -> str:
    """The study file of an example.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    known = example_names()
    if name not in known:
        raise InputError(f"--example {name}: unknown{suggestion(name, known)}; known: {', '.join(known)}")
    return _folder().joinpath(name + _SUFFIX).read_text(encoding="utf-8")


def listed_examples() -> list[str]:
    """A line for each example: its name and its title."""
    names = example_names()
    width = max(len(name) for name in names)
    return [f"{name:{width}}  {tomllib.loads(example(name))['study']['title']}" for name in names]


def _folder() -> Traversable:
    return files("contact_study").joinpath("example_studies")
