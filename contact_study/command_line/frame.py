"""The frame of every command: parser and help, keys as options, tables, one line for a mistake, exit status."""

import argparse
import io
import re
import shutil
import signal
import sys
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from contact_study.campaign.engines import CampaignError
from contact_study.inputs.errors import DONE, INTERRUPTED, NOT_CONVERGED, WRONG_INPUT, InputError

_KEY = re.compile(r"--(?P<key>[a-z_]+\.\w+)(?:=(?P<value>.*))?", re.DOTALL)
_WIDTH = 100  # columns of a help, and of tables where there is no terminal


class Parser(argparse.ArgumentParser):
    """An argument parser that reports a mistake in one line, with exit status 1."""

    def error(self, message: str) -> NoReturn:
        raise InputError(message)


class Help(argparse.RawDescriptionHelpFormatter):
    """Help of at most 100 columns, examples as they are written."""

    def __init__(self, prog: str):
        super().__init__(prog, max_help_position=30, width=min(_WIDTH, shutil.get_terminal_size((_WIDTH, 24)).columns))

    def _format_action_invocation(self, action: argparse.Action) -> str:
        if not action.option_strings or action.nargs == 0:
            return super()._format_action_invocation(action)
        return f"{', '.join(action.option_strings)} {action.metavar}"


def epilog(*examples: str, solves: bool = False) -> str:
    """Return the end of a help: examples and exit status; ``solves``: of steps that may not converge."""
    converged = "   2 some steps not converged" * solves
    statuses = f"exit status: 0 done   1 invalid input{converged}   130 interrupted"
    return "\n".join(["examples:", *(f"  {line}" for line in examples), "", statuses])


def take_keys(arguments: Sequence[str]) -> tuple[list[str], dict[str, Any]]:
    """Part options ``--section.key VALUE``, as TOML or text, from the others; InputError for a key no study has."""
    others, keys, left = list[str](), dict[str, Any](), iter(arguments)
    for argument in left:
        found = _KEY.fullmatch(argument)
        if found is None:
            others.append(argument)
            continue
        value = found["value"] if found["value"] is not None else next(left, "--")
        if value.startswith("--"):
            raise InputError(f"--{found['key']}: expected a value")
        keys[found["key"]] = value
    if not keys:
        return others, keys
    from contact_study.inputs import plugins
    from contact_study.study.schema.dotted_keys import all_keys, typed
    from contact_study.study.schema.keys import replacement, suggestion

    plugins.load()
    known = [f"{section}.{name}" for section, name, *_ in all_keys()]
    for key in keys:
        if key not in known:
            section = key.partition(".")[0]
            where = f" {section}" if any(one.startswith(f"{section}.") for one in known) else ""
            meant = replacement(key, "--") or suggestion(f"--{key}", [f"--{one}" for one in known])
            raise InputError(f"unknown key --{key}{meant}; see bem-adhesion keys{where}")
    return others, {key: typed(value) for key, value in keys.items()}


def guarded(command: str, body: Any, interrupted: str = "finished steps are kept, continue with --resume") -> int:
    """Call ``body``; turn mistakes of input and interruption into one line on stderr and an exit status."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # not every terminal has Greek letters
    previous = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        return body()
    except KeyboardInterrupt:
        print(f"{command}: interrupted; {interrupted}", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        return WRONG_INPUT
    except (InputError, CampaignError, OSError) as error:
        message = str(error)
    except UnicodeEncodeError as error:
        message = (
            f"{error.object[error.start : error.end]!a} cannot be written in this locale's encoding, "
            f"{error.encoding}; try LC_ALL=C.UTF-8"
        )
    except MemoryError:
        message = "not enough memory; use fewer points, atoms or layers, or --workers 1"
    except Exception:
        import traceback

        traceback.print_exc()
        message = "this is a fault of the program, not of the input; please report it"
    finally:
        signal.signal(signal.SIGTERM, previous)
    print(f"{command}: error: {message}", file=sys.stderr)
    return WRONG_INPUT


def report_convergence(command: str, groups: Mapping[str, Any]) -> int:
    """Print a line for each group of a dataset with steps that did not converge; returns the exit status."""
    from contact_study.campaign.dataset.file import unconverged

    lines = list(unconverged(groups))
    for line in lines:
        print(f"{command}: {line}", file=sys.stderr)
    return NOT_CONVERGED if lines else DONE


def print_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table; the last column is folded where lines are too long."""
    console = _console()
    if console is not None:
        from rich.table import Table
        from rich.text import Text

        table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 3, 0, 0))
        for number, name in enumerate(head):
            last = number == len(head) - 1
            table.add_column(name, style="cyan" if number == 0 else "", no_wrap=not last, overflow="fold")
        for row in rows:
            table.add_row(*map(Text, row))
        console.print(table)
        return
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head) - 1)]
    before = sum(width + 3 for width in widths)
    for row in (head, *rows):
        start = "".join(f"{cell:{width + 3}}" for cell, width in zip(row, widths, strict=False))
        folded = textwrap.wrap(row[-1], max(30, _columns() - before)) or [""]
        print("\n".join((start + folded[0], *(" " * before + line for line in folded[1:]))).rstrip())


def say(text: str, style: str = "") -> None:
    """Print a line, in a style of rich on a terminal."""
    console = _console() if style else None
    if console is None:
        print(text)
    else:
        console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)


def _console() -> Any:
    """Console of rich; None without it, or if nobody sees colours."""
    if not sys.stdout.isatty():
        return None
    try:
        from rich.console import Console
    except ImportError:  # an extra
        return None
    return Console(width=min(_columns(), 140), highlight=False)


def _columns() -> int:
    return shutil.get_terminal_size((_WIDTH, 24)).columns if sys.stdout.isatty() else _WIDTH
