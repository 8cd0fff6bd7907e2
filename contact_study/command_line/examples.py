"""Example studies in the package."""

import tomllib
from importlib.resources import files
from importlib.resources.abc import Traversable

from contact_study.inputs.errors import InputError
from contact_study.study.schema.keys import suggestion

_SUFFIX = ".toml"


def example_names() -> list[str]:
    """Return the names of the examples."""
    return sorted(file.name.removesuffix(_SUFFIX) for file in _folder().iterdir() if file.name.endswith(_SUFFIX))


def example(name: str) -> str:
    """Return the study file of an example; raises InputError for an unknown name."""
    known = example_names()
    if name not in known:
        raise InputError(f"--example {name}: unknown{suggestion(name, known)}; known: {', '.join(known)}")
    return _folder().joinpath(name + _SUFFIX).read_text(encoding="utf-8")


def listed_examples() -> list[str]:
    """Return a line for each example: name and title."""
    names = example_names()
    width = max(len(name) for name in names)
    return [f"{name:{width}}  {tomllib.loads(example(name))['study']['title']}" for name in names]


def _folder() -> Traversable:
    return files("contact_study").joinpath("example_studies")
