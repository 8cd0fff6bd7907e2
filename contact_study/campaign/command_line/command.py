"""The face that the three models' commands share: arguments, messages, exit status."""

import argparse
import contextlib
import dataclasses
import io
import os
import re
import shlex
import signal
import sys
import tomllib
import traceback
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import contact_study
from contact_study.campaign.command_line.examples import example, example_names, listed_examples
from contact_study.campaign.engines import ENGINES, CampaignError
from contact_study.campaign.model import Model
from contact_study.campaign.progress import Progress
from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output
from contact_study.errors import InputError
from contact_study.files import require_file
from contact_study.start import INTERRUPTED
from contact_study.study.schema.dotted_keys import all_keys
from contact_study.study.schema.keys import as_written, replacement, suggestion
from contact_study.study.study import read_study

if TYPE_CHECKING:
    import xarray as xr

DONE, WRONG_INPUT, NOT_CONVERGED = 0, 1, 2


class Parser(argparse.ArgumentParser):
    """An argument parser that reports a mistake in one line, with exit status 1."""

    def error(self, message: str) -> NoReturn:
        raise InputError(message)


def completed(parser: argparse.ArgumentParser) -> None:
    """Where the shell asks how a line may go on, answer it and end; see docs/installation.md."""
    if "_ARGCOMPLETE" in os.environ:
        with contextlib.suppress(ImportError):  # an extra
            import argcomplete

            argcomplete.autocomplete(parser)


def main(model: Model, arguments: Sequence[str] | None = None) -> int:
    """Run one model on a study file; returns the exit status.

    0: done and converged; 1: wrong input; 2: some step did not converge (the dataset says which); 130: interrupted.
    """
    if arguments is None:  # a process of the command's own
        arguments = sys.argv[1:]
        _leave_out_dask(arguments)
    return guarded(model.command, lambda: _main(model, arguments))


def _leave_out_dask(arguments: Sequence[str]) -> None:
    """Where Dask is installed, Pint and xarray take it up, half a second, for what a command has no use for."""
    asked = "dask" in arguments or "--engine=dask" in arguments
    if not asked and "xarray" not in sys.modules:  # which knows by then whether there is one
        sys.modules.setdefault("dask", None)  # type: ignore[arg-type]


def guarded(command: str, body: Any, interrupted: str = "finished steps are kept, continue with --resume") -> int:
    """Call ``body``; mistakes of input and interruption become one line on stderr and an exit status."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # not every terminal has Greek letters
    previous = signal.signal(signal.SIGTERM, _interrupt)
    try:
        return body()
    except (InputError, CampaignError) as error:
        print(f"{command}: error: {error}", file=sys.stderr)
        return WRONG_INPUT
    except KeyboardInterrupt:
        print(f"{command}: interrupted; {interrupted}", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        return WRONG_INPUT
    except OSError as error:
        print(f"{command}: error: {error}", file=sys.stderr)
        return WRONG_INPUT
    except UnicodeEncodeError as error:
        print(
            f"{command}: error: {error.object[error.start : error.end]!a} cannot be written in this locale's encoding, "
            f"{error.encoding}; try LC_ALL=C.UTF-8",
            file=sys.stderr,
        )
        return WRONG_INPUT
    except MemoryError:
        print(
            f"{command}: error: not enough memory; use fewer points, atoms or layers, or --workers 1", file=sys.stderr
        )
        return WRONG_INPUT
    except Exception:
        traceback.print_exc()
        print(
            f"{command}: error: this is a fault of the program, not of the input; please report it",
            file=sys.stderr,
        )
        return WRONG_INPUT
    finally:
        signal.signal(signal.SIGTERM, previous)


def _interrupt(*_: Any) -> NoReturn:
    raise KeyboardInterrupt


def _main(model: Model, arguments: Sequence[str]) -> int:
    parser = _parser(model)
    completed(parser)
    given, unknown = parser.parse_known_args(_joined(arguments))
    if unknown:
        options = [f"--{section}.{name}" for section, name, *_ in all_keys()]
        name = unknown[0].removeprefix("--").partition("=")[0]
        meant = replacement(name, "--") or suggestion(unknown[0], options)
        raise InputError(f"unknown argument {unknown[0]}{meant}; see --help")
    output = None if given.output is None else named_file(given.output)
    overrides = {
        name[4:]: value for name, value in vars(given).items() if name.startswith("key:") and value is not None
    }
    if given.example is not None:
        return _example(given)
    if given.inspect is not None:
        return _inspect(given, output, overrides)
    if given.study is None or output is None:
        raise InputError("name a study and where its dataset goes, STUDY.toml -o OUT.nc; see --help")
    if given.resume and given.overwrite:
        raise InputError("--resume and --overwrite exclude each other")
    if given.workers is not None and given.workers < 1:
        raise InputError(f"--workers {given.workers}: must be at least 1")
    from contact_study.campaign.run import RunOptions, run_campaign  # and with it xarray, which is slow to import

    study = read_study(given.study, overrides)
    predictor = getattr(given, "predictor", None)
    check_inputs_kept(output, [given.study, predictor, *(case.height_map for case in study.cases)])
    words = f"{model.command} {shlex.join(arguments)}"
    how = RunOptions(given.resume, given.overwrite, given.workers, given.engine, given.scheduler)
    groups = run_campaign(model, study, output, Progress(model.command), words, predictor, how)
    print(output)
    return _status(model, groups)


def _example(given: argparse.Namespace) -> int:
    """Print an example study, or which there are."""
    if given.study is not None or given.output is not None:
        raise InputError("--example prints a study, and runs none; write it to a file: --example NAME > study.toml")
    print(example(given.example) if given.example else "\n".join(listed_examples()), end="" if given.example else "\n")
    return DONE


def _inspect(given: argparse.Namespace, output: Path | None, overrides: Mapping[str, Any]) -> int:
    """Look at a surface, and run nothing."""
    from contact_study.campaign.command_line.inspection import inspect

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
    parser.add_argument("study", type=Path, nargs="?", metavar="STUDY.toml", help="study file")
    parser.add_argument("-o", "--output", metavar="OUT.nc", help="dataset to write, OUT.zarr for one of Zarr")
    parser.add_argument(
        "--inspect",
        type=Path,
        metavar="FILE",
        help="say what a height map, or the surface of a study, was taken to be; draw it and its spectrum; run nothing",
    )
    parser.add_argument(
        "--example",
        nargs="?",
        const="",
        metavar="NAME",
        help="print an example study, to be written to a file; without a name list the examples",
    ).completer = lambda **_: example_names()  # type: ignore[attr-defined]
    parser.add_argument("--resume", action="store_true", help="continue an interrupted run of the same study")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing dataset")
    parser.add_argument(
        "--workers",
        type=int,
        metavar="N",
        help="processes, this one among them; default: one per case, at most the cores"
        + (f" ({model.threads} cores for each where these have fewer than two cases)" if model.threads > 1 else ""),
    )
    parser.add_argument("--engine", choices=ENGINES, help="where cases run; default: processes if there are several")
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="address, or file, of the scheduler of a Dask cluster (--engine dask)"
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {contact_study.__version__}")
    if model.takes_predictor:
        parser.add_argument(
            "--predictor", type=Path, metavar="BEM.nc", help="start each step from this dataset's gap fields"
        )
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
        added.completer = partial(_words_of, declaration.kind)
    return parser


def _words_of(kind: str, **_: Any) -> list[str]:
    """The words that a key takes, for the shell; none where it takes a number or free text."""
    return kind.removesuffix(", or a list").split(" | ") if " | " in kind else []


def _joined(arguments: Sequence[str]) -> list[str]:
    """Arguments with each negative value tied to its key, which argparse would take for an option."""
    keys = {f"--{section}.{name}" for section, name, *_ in all_keys()}
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in keys and re.match(r"-\.?\d", argument):
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def _toml_value(text: str) -> Any:
    """A value as TOML writes it; anything else is a string."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _status(model: Model, groups: "Mapping[str, xr.Dataset]") -> int:
    """Exit status of a dataset; names each group with steps that did not converge."""
    from contact_study.campaign.dataset.provenance import unconverged

    said = list(unconverged(groups))
    for words in said:
        print(f"{model.command}: {words}", file=sys.stderr)
    return NOT_CONVERGED if said else DONE
