"""Entry points of the commands. Nothing else is imported before Ctrl-C is handled."""

import sys
from collections.abc import Sequence

_INTERRUPTED = 130


def bem_adhesion(arguments: Sequence[str] | None = None) -> int:
    """All verbs; without one the continuum model."""
    return _start("bem-adhesion", arguments)


def md_reference(arguments: Sequence[str] | None = None) -> int:
    """``bem-adhesion run --model atoms``."""
    return _start("md-reference", arguments)


def persson_theory(arguments: Sequence[str] | None = None) -> int:
    """``bem-adhesion run --model theory``."""
    return _start("persson-theory", arguments)


def contact_compare(arguments: Sequence[str] | None = None) -> int:
    """``bem-adhesion compare``."""
    return _start("contact-compare", arguments)


def contact_merge(arguments: Sequence[str] | None = None) -> int:
    """``bem-adhesion merge``."""
    return _start("contact-merge", arguments)


def _start(name: str, arguments: Sequence[str] | None) -> int:
    try:
        from contact_study.command_line.program import main

        return main(name, arguments)
    except KeyboardInterrupt:
        print(f"{name}: interrupted before it began", file=sys.stderr)
        return _INTERRUPTED
