"""Entry points of the commands; Ctrl-C during imports ends them with one line, too."""

import importlib
import sys
from typing import Any

from contact_study.campaign.model import MODELS
from contact_study.inputs import plugins
from contact_study.inputs.errors import INTERRUPTED, WRONG_INPUT, InputError


def bem_adhesion() -> int:
    """Run the continuum model."""
    return _model("continuum")


def md_reference() -> int:
    """Run the atomistic model."""
    return _model("atomistic")


def persson_theory() -> int:
    """Run the theories."""
    return _model("theory")


def contact_compare() -> int:
    """Compare datasets."""
    return _command("contact-compare", "contact_study.command_line.compare")


def contact_merge() -> int:
    """Merge datasets."""
    return _command("contact-merge", "contact_study.command_line.merge")


def _model(kind: str) -> int:
    model = MODELS[kind]
    return _command(model.command, "contact_study.command_line.run", model)


def _command(name: str, module: str, *arguments: Any) -> int:
    try:
        plugins.load()
        main = importlib.import_module(module).main
    except KeyboardInterrupt:
        print(f"{name}: interrupted before it began", file=sys.stderr)
        return INTERRUPTED
    except InputError as error:  # of a plug-in
        print(f"{name}: error: {error}", file=sys.stderr)
        return WRONG_INPUT
    return int(main(*arguments))
