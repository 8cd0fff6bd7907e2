"""Run a study by one of the models.

Only the arguments are imported at first; a run, an example or an inspection imports what it needs.
"""

import argparse
import dataclasses
import re
import shlex
import sys
import tomllib
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from contact_study.campaign.engines import ENGINES
from contact_study.campaign.model import Model
from contact_study.command_line.frame import Parser, complete, guarded, report_convergence
from contact_study.inputs.errors import DONE, InputError
from contact_study.study.schema.dotted_keys import all_keys
from contact_study.study.schema.keys import as_written, replacement, suggestion
from contact_study.version import __version__


def main(model: Model, arguments: Sequence[str] | None = None) -> int:
    """Run one model on a study file.

    Returns
    -------
    int
        Exit status. 0: done and converged; 1: wrong input; 2: some step did not converge; 130: interrupted.
    """
    if arguments is None:  # a process of the command's own
        arguments = sys.argv[1:]
        _hide_dask(arguments)
    return guarded(model.command, lambda: _main(model, arguments))


def _hide_dask(arguments: Sequence[str]) -> None:
    """Keep pint and xarray from importing Dask, half a second, unless the command uses it."""
    asked = "dask" in arguments or "--engine=dask" in arguments
    if not asked and "xarray" not in sys.modules:  # which has looked for it by then
        sys.modules.setdefault("dask", None)  # type: ignore[arg-type]


def _main(model: Model, arguments: Sequence[str]) -> int:
    parser = _parser(model)
    complete(parser)
    given, unknown = parser.parse_known_args(_joined(arguments))
    if unknown:
        known = [f"--{section}.{name}" for section, name, *_ in all_keys()]
        name = unknown[0].removeprefix("--").partition("=")[0]
        meant = replacement(name, "--") or suggestion(unknown[0], known)
        raise InputError(f"unknown argument {unknown[0]}{meant}; see --help")
    from contact_study.campaign.store.files import check_inputs_kept, named_file

    output = None if given.output is None else named_file(given.output)
    overrides = {
        name[4:]: value for name, value in vars(given).items() if name.startswith("key:") and value is not None
    }
    if given.example is not None:
        return _print_example(given)
    if given.inspect is not None:
        return _inspect(given, output, overrides)
    if given.study is None or output is None:
        raise InputError("name a study and where its dataset goes, STUDY.toml -o OUT.nc; see --help")
    if given.resume and given.overwrite:
        raise InputError("--resume and --overwrite exclude each other")
    if given.workers is not None and given.workers < 1:
        raise InputError(f"--workers {given.workers}: must be at least 1")
    from contact_study.campaign.progress import Progress
    from contact_study.campaign.run import RunOptions, run_campaign
    from contact_study.study.study import read_study

    study = read_study(given.study, overrides)
    predictor = getattr(given, "predictor", None)
    check_inputs_kept(output, [given.study, predictor, *(case.height_map for case in study.cases)])
    words = f"{model.command} {shlex.join(arguments)}"
    options = RunOptions(given.resume, given.overwrite, given.workers, given.engine, given.scheduler)
    groups = run_campaign(model, study, output, Progress(model.command), words, predictor, options)
    print(output)
    return report_convergence(model.command, groups)


def _print_example(given: argparse.Namespace) -> int:
    """Print an example study, or the list of examples."""
    from contact_study.command_line.examples import example, listed_examples

    if given.study is not None or given.output is not None:
        raise InputError("--example prints a study, and runs none; write it to a file: --example NAME > study.toml")
    print(example(given.example) if given.example else "\n".join(listed_examples()), end="" if given.example else "\n")
    return DONE


def _inspect(given: argparse.Namespace, output: Path | None, overrides: Mapping[str, Any]) -> int:
    """Describe a surface."""
    from contact_study.campaign.store.files import check_inputs_kept, writable_output
    from contact_study.command_line.inspect import inspect
    from contact_study.inputs.files import require_file

    if given.study is not None:
        raise InputError(f"{given.study}: --inspect takes the map or the study, and runs none")
    require_file(given.inspect, "--inspect")
    if output is not None:
        check_inputs_kept(output, [given.inspect])
        writable_output(output)
    for line in inspect(given.inspect, overrides, output):
        print(line)
    return DONE


def _parser(model: Model) -> Parser:
    parser = Parser(
        prog=model.command,
        usage="%(prog)s STUDY.toml -o OUT.nc [--section.key VALUE ...] [--resume | --overwrite] [--workers N] "
        "[--engine NAME]"
        + (" [--predictor BEM.nc]" if model.takes_predictor else "")
        + "\n       %(prog)s --inspect FILE [--section.key VALUE ...] [-o PICTURE.png]"
        + "\n       %(prog)s --example [NAME]",
        description=model.description,
        epilog="Exit status: 0 done and converged, 1 wrong input, 2 some step did not converge, 130 interrupted. "
        'Quantities are SI numbers or strings with a unit, lists have commas: --loading.path "-1 kPa, 2 MPa".',
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("study", type=Path, nargs="?", metavar="STUDY.toml", help="study file")
    add("-o", "--output", metavar="OUT.nc", help="dataset to write, OUT.zarr for one of Zarr")
    add("--inspect", type=Path, metavar="FILE", help="height map or study: describe and draw its surface, run nothing")
    add(
        "--example", nargs="?", const="", metavar="NAME", help="print an example study; without a name list them"
    ).completer = lambda **_: _example_names()  # type: ignore[attr-defined]
    add("--resume", action="store_true", help="continue an interrupted run of the same study")
    add("--overwrite", action="store_true", help="replace an existing dataset")
    cores = f"; {model.threads} cores each for few cases" if model.threads > 1 else ""
    add(
        "--workers",
        type=int,
        metavar="N",
        help=f"number of processes (default: one per case, at most the cores{cores})",
    )
    add("--engine", choices=ENGINES, help="engine that runs the cases (default: processes if there are several)")
    add("--scheduler", metavar="ADDRESS", help="address, or file, of the scheduler of a Dask cluster (--engine dask)")
    add("--version", action="version", version=f"%(prog)s {__version__}")
    if model.takes_predictor:
        add("--predictor", type=Path, metavar="BEM.nc", help="dataset whose gap fields the steps start from")
    groups: dict[str, Any] = {}
    for section, name, declaration, default in all_keys():
        if section not in groups:
            groups[section] = parser.add_argument_group(f"[{section}]")
        text = declaration.description.replace("%", "%%")
        if default is not None and default is not dataclasses.MISSING:
            text += f" (default {as_written(default)})"
        added = groups[section].add_argument(
            f"--{section}.{name}",
            dest=f"key:{section}.{name}",
            type=_toml_value,
            metavar=f"<{declaration.kind}>",
            help=text,
        )
        added.completer = partial(_choices, declaration.kind)
    return parser


def _example_names() -> list[str]:
    from contact_study.command_line.examples import example_names

    return example_names()


def _choices(kind: str, **_: Any) -> list[str]:
    """Words that a key takes, for the shell; none for a number or free text."""
    return kind.removesuffix(", or a list").split(" | ") if " | " in kind else []


def _joined(arguments: Sequence[str]) -> list[str]:
    """Join each negative value to its key; argparse would take it for an option."""
    keys = {f"--{section}.{name}" for section, name, *_ in all_keys()}
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in keys and re.match(r"-\.?\d", argument):
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def _toml_value(text: str) -> Any:
    """Read a value as TOML writes it; anything else is a string."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except ValueError:
        return text
