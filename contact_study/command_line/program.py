"""The program: verbs, and the names that it had before."""

import argparse
import contextlib
import importlib
import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from contact_study.command_line.frame import Help, Parser, epilog, guarded, take_keys
from contact_study.inputs.errors import DONE, WRONG_INPUT, InputError
from contact_study.version import __version__

if TYPE_CHECKING:
    from contact_study.campaign.model import Model

PROGRAM = "bem-adhesion"
# Each is a module beside this one, with ``add(parser)``, ``run(given)``, ``USAGE`` and ``END`` of its help, and perhaps
# ``KEYS``, which says that it takes keys of a study, and ``KEPT``, what an interruption leaves.
VERBS = {
    "init": "write an example study, or list the examples",
    "inspect": "describe and draw a height map, or the surface of a study",
    "spectrum": "combine maps and line scans of one surface into its power spectrum",
    "check": "check a study and estimate its memory and time; run nothing",
    "run": "run a study: boundary elements, atoms or theory",
    "compare": "compare datasets, or report on one: deviations, figures, report",
    "merge": "merge the datasets of one study, run in parts",
    "plot": "draw one picture of a dataset",
    "uncertainty": "intervals of answers and shares of variance from draws of a study",
    "infer": "infer work of adhesion, modulus and range from force curves",
    "explore": "look at datasets and set up a first study in the browser",
    "export": "write a dataset as a table, or for ParaView, OVITO and ASE",
    "keys": "list the keys of a study file: units, defaults, meanings",
}
_OLD = {
    "md-reference": ["run", "--model", "atoms"],
    "persson-theory": ["run", "--model", "theory"],
    "contact-compare": ["compare"],
    "contact-merge": ["merge"],
}
_EXAMPLES = ("init first", "check first.toml", "run first.toml -o bem.nc", "compare bem.nc -o comparison")
_NOTHING = "nothing was written"
_OVERVIEW = f"""usage: {PROGRAM} COMMAND ...

Adhesive contact of rough solids: boundary elements, atoms and theory.

commands:
{{verbs}}

`{PROGRAM} COMMAND --help` explains one. `{PROGRAM} STUDY.toml -o OUT.nc` is short for run.

{epilog(*(f"{PROGRAM} {words}" for words in _EXAMPLES), solves=True)}"""


def main(name: str, arguments: Sequence[str] | None = None, model: "Model | None" = None) -> int:
    """Run a command by its name, or a model that is none of the three; returns the exit status."""
    own_process = arguments is None
    typed = sys.argv[1:] if arguments is None else list(arguments)
    if "_ARGCOMPLETE" in os.environ:
        _complete(name)
    if name == PROGRAM and model is None and (not typed or typed[0] in ("-h", "--help", "--version")):
        verbs = "\n".join(f"  {verb:9} {words}" for verb, words in VERBS.items())
        print(f"{PROGRAM} {__version__}" if "--version" in typed[:1] else _OVERVIEW.format(verbs=verbs))
        return DONE if typed else WRONG_INPUT

    def body() -> int:
        verb, *others = _in_verbs(name, typed)
        module = importlib.import_module(f"contact_study.command_line.verbs.{verb}")
        asked = "dask" in others or "--engine=dask" in others
        if own_process and not asked and "xarray" not in sys.modules:  # which has looked for it by then
            # Keep pint and xarray from importing Dask, half a second.
            sys.modules.setdefault("dask", None)  # type: ignore[arg-type]
        prog, words = f"{PROGRAM} {verb}" if name == PROGRAM else name, f"{VERBS[verb][0].upper()}{VERBS[verb][1:]}."
        about = {"prog": prog, "usage": f"{prog} {module.USAGE}", "description": words, "epilog": module.END}
        parser = Parser(**about, formatter_class=Help, allow_abbrev=False)
        parser._positionals.title = "arguments"
        module.add(parser)
        parser.add_argument("--version", action="version", version=f"{prog} {__version__}", help=argparse.SUPPRESS)
        others, keys = take_keys(others) if hasattr(module, "KEYS") else (others, {})
        _check_options(others, parser)
        try:
            given = parser.parse_args(others)
        except SystemExit:  # after --help
            return DONE
        given.command, given.words, given.arguments = name, f"{name} {shlex.join(typed)}", typed
        given.keys, given.other_model = keys, model
        return guarded(name, lambda: module.run(given), getattr(module, "KEPT", _NOTHING))

    return guarded(name, body, _NOTHING)


def _in_verbs(name: str, typed: list[str]) -> list[str]:
    """Return the arguments of a command in today's form, verb first."""
    first = typed[0] if typed else ""
    if name == PROGRAM and first in VERBS:
        return typed
    plain = name == PROGRAM and not first.startswith("-")
    if plain and not (Path(first).suffix or os.sep in first or Path(first).exists()):
        from contact_study.study.schema.keys import suggestion

        raise InputError(f"unknown command {first}{suggestion(first, VERBS)}; see {PROGRAM} --help")
    verb = _OLD.get(name, ["run"])
    if verb[0] == "run":
        for flag, instead in (("--inspect", "inspect"), ("--example", "init")):
            if any(one.partition("=")[0] == flag for one in typed):
                found = [one.partition("=")[2] if one.startswith(f"{flag}=") else one for one in typed if one != flag]
                return [instead, *found, *(["-o", "-"] if instead == "init" else [])]
    return [*verb, *typed]


def _check_options(arguments: Sequence[str], parser: Parser) -> None:
    """Raise InputError for an option that a verb does not have, before argparse misses others."""
    options = [option for action in parser._actions for option in action.option_strings]
    for argument in arguments:
        if argument.startswith("--") and argument.partition("=")[0] not in options:
            from contact_study.study.schema.keys import suggestion

            meant = suggestion(argument.partition("=")[0], options)
            raise InputError(f"unknown option {argument}{meant}; see {parser.prog} --help")


def _complete(name: str) -> None:
    """Answer the shell's request to complete a line and exit; see docs/installation.md."""
    with contextlib.suppress(ImportError):  # an extra
        import argcomplete

        parser = argparse.ArgumentParser(prog=name)
        line = os.environ["COMP_LINE"][: int(os.environ["COMP_POINT"])]
        first, *others = [*line.split(" ")[1:], ""]
        if name == PROGRAM and first in VERBS:
            _with_keys(parser.add_subparsers().add_parser(first), first)
        elif name == PROGRAM and len(others) < 2:
            parser.add_argument("command", choices=VERBS)
        else:
            _with_keys(parser, _OLD.get(name, ["run"])[0])
        argcomplete.autocomplete(parser)


def _with_keys(parser: argparse.ArgumentParser, verb: str) -> None:
    """Add what a verb takes, and the keys of a study as options, with the words that they take."""
    module = importlib.import_module(f"contact_study.command_line.verbs.{verb}")
    module.add(parser)
    if hasattr(module, "KEYS"):
        from contact_study.study.schema.dotted_keys import all_keys

        for section, key, declared, _ in all_keys():
            added = parser.add_argument(f"--{section}.{key}", help=declared.description.replace("%", "%%"))
            words = declared.kind.removesuffix(", or a list").split(" | ") if " | " in declared.kind else []
            added.completer = lambda words=words, **_: words  # type: ignore[attr-defined]
