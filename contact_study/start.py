"""Entry points of the commands: Ctrl-C while their libraries load ends them as quietly as later."""

import importlib
import sys

from contact_study import plugins
from contact_study.errors import InputError

INTERRUPTED, WRONG_INPUT = 130, 1  # exit statuses


def bem_adhesion() -> int:
    """The continuum."""
    return _command("bem-adhesion", "bem_adhesion.study.model")


def md_reference() -> int:
    """The atoms."""
    return _command("md-reference", "md_reference.study.model")


def persson_theory() -> int:
    """The theories."""
    return _command("persson-theory", "theory.study.model")


def contact_compare() -> int:
    """The comparison."""
    return _command("contact-compare", "contact_study.report.command")


def contact_merge() -> int:
    """The parts of a campaign in one."""
    return _command("contact-merge", "contact_study.campaign.merge.command")


def _command(name: str, module: str) -> int:
    try:
        plugins.load()
        main = importlib.import_module(module).main
    except KeyboardInterrupt:
        print(f"{name}: interrupted before it began", file=sys.stderr)
        return INTERRUPTED
    except InputError as error:  # of a plug-in
        print(f"{name}: error: {error}", file=sys.stderr)
        return WRONG_INPUT
    return int(main())
