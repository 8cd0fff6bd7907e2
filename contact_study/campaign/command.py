"""The face that the three models' commands share: arguments, messages, exit status."""

import argparse
import dataclasses
import hashlib
import io
import os
import shlex
import signal
import subprocess
import sys
import tomllib
import traceback
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

import xarray as xr

import contact_study
from contact_study.campaign import storage
from contact_study.campaign.memory import check_memory
from contact_study.campaign.model import Model
from contact_study.campaign.predictor import check_predictor
from contact_study.campaign.progress import Progress
from contact_study.campaign.runner import CampaignError, collect, run_cases
from contact_study.campaign.schema import CONVENTIONS, SCHEMA_VERSION
from contact_study.problem.bins import with_bins
from contact_study.problem.errors import InputError
from contact_study.problem.keys import suggestion
from contact_study.problem.plausibility import review
from contact_study.problem.study import Study, all_keys, read_study
from contact_study.problem.surface_scales import scales_of

DONE, WRONG_INPUT, NOT_CONVERGED, INTERRUPTED = 0, 1, 2, 130


class Parser(argparse.ArgumentParser):
    """An argument parser that reports a mistake in one line, with exit status 1."""

    def error(self, message: str) -> NoReturn:
        raise InputError(message)


def main(model: Model, arguments: Sequence[str] | None = None) -> int:
    """Run one model on a study file; returns the exit status.

    0: done and converged; 1: wrong input; 2: some step did not converge (the dataset says which); 130: interrupted.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    return guarded(model.command, lambda: _main(model, arguments))


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
    given, unknown = parser.parse_known_args(arguments)
    if unknown:
        options = [f"--{section}.{name}" for section, name, *_ in all_keys()]
        raise InputError(f"unknown argument {unknown[0]}{suggestion(unknown[0], options)}; see --help")
    if not given.output.name:
        raise InputError(f"-o {given.output}: name a file")
    overrides = {
        name[4:]: value for name, value in vars(given).items() if name.startswith("key:") and value is not None
    }
    if given.resume and given.overwrite:
        raise InputError("--resume and --overwrite exclude each other")
    if given.workers is not None and given.workers < 1:
        raise InputError(f"--workers {given.workers}: must be at least 1")
    study = read_study(given.study, overrides)
    check_memory(study)
    scales = scales_of(study)
    said = [*study.notes, *review(study, scales)]
    for case in study.cases:
        model.check(case)
    said += model.review(study, scales)
    study = with_bins(study, scales)
    predictor = getattr(given, "predictor", None)
    if predictor is not None:
        check_predictor(predictor)
    output: Path = given.output
    _check_inputs_kept(output, [given.study, predictor, *(case.height_map for case in study.cases)])
    identity = _identity(model, study, predictor)
    parts = storage.Parts(output)
    if _is_complete(output, identity, resume=given.resume, overwrite=given.overwrite):
        parts.remove()  # of a run killed between its dataset and its tidying up
        with xr.open_dataset(output) as dataset:
            status = _status(model, dataset)
            if dataset.attrs["git_commit"] != git_commit():
                print(
                    f"{model.command}: warning: {output} is of commit {dataset.attrs['git_commit']}, this is "
                    f"{git_commit()}; use --overwrite to compute it anew",
                    file=sys.stderr,
                )
        print(output)
        return status
    storage.writable_output(output)
    progress = Progress(model.command)
    for note in said:
        progress.say(f"warning: {note}")
    try:
        for note in parts.open(identity, git_commit(), resume=given.resume, overwrite=given.overwrite):
            progress.say(f"warning: {note}")
        notes = run_cases(model, study, parts, predictor, given.workers, progress)
        progress.close()
        bins, longest = study.cases[0].bins, max(len(case.path) for case in study.cases)
        coordinates = {"pressure_bin": bins.pressure, "gap_bin": bins.gap}
        groups = storage.assemble(study.sweep, longest, collect(study, parts), coordinates)
        command = f"{model.command} {shlex.join(arguments)}"
        groups[""].attrs.update(_provenance(model, study, identity, [*said, *notes], command))
        parts.finish(groups)
    finally:
        progress.close()
        parts.close()
    for note in notes:
        progress.say(f"warning: {note}")
    print(output)
    return _status(model, groups[""])


def _parser(model: Model) -> Parser:
    parser = Parser(
        prog=model.command,
        usage="%(prog)s STUDY.toml -o OUT.nc [--section.key VALUE ...] [--resume | --overwrite] [--workers N]"
        + (" [--predictor BEM.nc]" if model.takes_predictor else ""),
        description=model.description,
        epilog="Exit status: 0 done and converged, 1 wrong input, 2 some step did not converge. "
        "Quantities are SI numbers or strings with a unit; a negative number needs an equals sign, "
        "--loading.path=-1e8.",
        allow_abbrev=False,
    )
    parser.add_argument("study", type=Path, metavar="STUDY.toml", help="study file")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.nc", help="dataset to write")
    parser.add_argument("--resume", action="store_true", help="continue an interrupted run of the same study")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing dataset")
    parser.add_argument("--workers", type=int, metavar="N", help="processes; default: one per case, at most the cores")
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
            text += f" (default {_shown(default)})"
        groups[section].add_argument(
            f"--{section}.{name}",
            dest=f"key:{section}.{name}",
            type=_toml_value,
            metavar=f"<{declaration.kind}>",
            help=text,
        )
    return parser


def _shown(default: Any) -> str:
    return str(default).lower() if isinstance(default, bool) else str(default)


def _toml_value(text: str) -> Any:
    """A value as TOML writes it; anything else is a string."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _identity(model: Model, study: Study, predictor: Path | None) -> dict[str, Any]:
    """What must agree for finished steps to be continued."""
    return {
        "model": model.kind,
        "study_toml": study.toml,
        "version": contact_study.__version__,
        "schema_version": SCHEMA_VERSION,
        "predictor": "" if predictor is None else _fingerprint(predictor),
    }


def _fingerprint(path: Path) -> str:
    """Name and content of a file, wherever it lies."""
    with path.open("rb") as stream:
        return f"{path.name} sha256:{hashlib.file_digest(stream, 'sha256').hexdigest()}"


def _check_inputs_kept(output: Path, inputs: Sequence[Path | None]) -> None:
    for path in inputs:
        if path is not None and output.resolve() == path.resolve():
            raise InputError(f"{output}: is read by this run; choose another output")


def _is_complete(output: Path, identity: Mapping[str, Any], *, resume: bool, overwrite: bool) -> bool:
    """Whether the output stands already; refuses to touch what is not to be touched."""
    if not output.exists() or overwrite:
        return False
    if not resume:
        raise InputError(f"{output} exists; use --overwrite to replace it or --resume to continue its run")
    try:
        with xr.open_dataset(output) as dataset:
            same = all(dataset.attrs.get(name) == value for name, value in identity.items())
    except (OSError, ValueError):
        raise InputError(f"{output} exists and is no readable dataset; use --overwrite or another output") from None
    if not same:
        raise InputError(f"{output} exists and belongs to another study or model; use --overwrite or another output")
    return True


def _provenance(
    model: Model, study: Study, identity: Mapping[str, Any], notes: Sequence[str], command: str
) -> dict[str, Any]:
    return {
        "Conventions": CONVENTIONS,
        "title": study.title,
        "source": f"bem-adhesion {contact_study.__version__}, {model.command}: {model.description}",
        "history": f"{datetime.now(UTC).isoformat(timespec='seconds')}: {command}",
        "references": model.references,
        "git_commit": git_commit(),
        "warnings": "\n".join(notes),
        **identity,
    }


@cache
def git_commit() -> str:
    """Commit of the checkout that this runs from, marked if it has been changed; "unknown" outside one."""
    try:
        found = subprocess.run(
            [
                "git",
                "-C",
                os.path.dirname(__file__),
                "describe",
                "--always",
                "--dirty",
                "--abbrev=40",
                "--exclude=*",
            ],
            capture_output=True,
            text=True,
            timeout=10,
        )
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    return found.stdout.strip() or "unknown"


def _status(model: Model, dataset: xr.Dataset) -> int:
    """Exit status of a dataset; names the steps that did not converge."""
    converged = dataset["converged"]
    failed = int((converged == 0).sum())
    if not failed:
        return DONE
    total = int((converged >= 0).sum())
    print(
        f"{model.command}: {failed} of {total} steps did not converge; see the variables converged and residual",
        file=sys.stderr,
    )
    return NOT_CONVERGED
