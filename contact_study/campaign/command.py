"""The face that the three models' commands share: arguments, messages, exit status."""

import argparse
import dataclasses
import io
import os
import re
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
from contact_study.campaign.identity import Run, run_of
from contact_study.campaign.memory import check_memory
from contact_study.campaign.model import Model
from contact_study.campaign.parts import Parts
from contact_study.campaign.predictor import check_predictor
from contact_study.campaign.progress import Progress
from contact_study.campaign.resume import Finished, finished_at, take_up
from contact_study.campaign.runner import CampaignError, collect, last_states, run_cases
from contact_study.campaign.schema import CONVENTIONS
from contact_study.problem.bins import with_bins
from contact_study.problem.errors import InputError
from contact_study.problem.keys import suggestion
from contact_study.problem.plausibility import review
from contact_study.problem.study import Study, all_keys, make_study, read_study
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
    given, unknown = parser.parse_known_args(_joined(arguments))
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
    output: Path = given.output
    study = read_study(given.study, overrides)
    predictor = getattr(given, "predictor", None)
    _check_inputs_kept(output, [given.study, predictor, *(case.height_map for case in study.cases)])
    study, said = _reviewed(model, study)
    run = run_of(model, study, predictor if predictor is not None and predictor.is_file() else None)
    if predictor is not None:
        said += check_predictor(predictor, study, run.height_maps)
    parts = Parts(output)
    finished = finished_at(output, resume=given.resume, overwrite=given.overwrite)
    if finished is not None and finished.is_of(run):
        return _already_done(run, parts, finished)
    storage.writable_output(output)
    progress = Progress(model.command)
    for note in said:
        progress.say(f"warning: {note}")
    try:
        unfinished = parts.open(resume=given.resume, overwrite=given.overwrite)
        names = run.case_names()
        for note in take_up(run, names, parts, unfinished, finished, git_commit()):
            progress.say(f"warning: {note}")
        notes = run_cases(run, names, parts, given.workers, progress)
        progress.close()
        groups, late = _assembled(run, names, parts)
        notes = [*_carried(run, finished), *notes, *late]
        command = f"{model.command} {shlex.join(arguments)}"
        groups[""].attrs.update(_provenance(run, finished, [*said, *notes], command))
        parts.finish(groups)
    finally:
        progress.close()
        parts.close()
    for note in dict.fromkeys(notes):
        progress.say(f"warning: {note}")
    print(output)
    return _status(model, groups)


def _reviewed(model: Model, study: Study) -> tuple[Study, list[str]]:
    """The study with its bins, and what there is to be said of it as a whole.

    Raises
    ------
    InputError
        If it cannot be served.
    """
    check_memory(study)
    scales = scales_of(study)
    said = [*study.notes, *review(study, scales)]
    for case in study.cases:
        model.check(case)
    return with_bins(study, scales), [*said, *model.review(study, scales)]


def _already_done(run: Run, parts: Parts, finished: Finished) -> int:
    command, path = run.model.command, finished.path
    if parts.belong_to(run.attributes):
        parts.remove()  # of a run killed between its dataset and its tidying up
    elif parts.folder.exists():
        print(f"{command}: warning: {parts.folder} holds steps of another run, which are left alone", file=sys.stderr)
    with xr.open_datatree(path, decode_timedelta=False) as tree:
        groups = {node.path.strip("/"): node.to_dataset().load() for node in _with_flags(tree)}
    status = _status(run.model, groups)
    if finished.attributes["git_commit"] != git_commit():
        print(
            f"{command}: warning: {path} is of commit {finished.attributes['git_commit']}, this is {git_commit()}; use "
            "--overwrite to compute it anew",
            file=sys.stderr,
        )
    print(path)
    return status


def _assembled(run: Run, names: Sequence[str], parts: Parts) -> tuple[dict[str, xr.Dataset], list[str]]:
    """The groups of the dataset, and what came to light on the way."""
    study = run.study
    brought: list[str] = []
    bins, longest = study.cases[0].bins, max(len(case.path) for case in study.cases)
    coordinates = {"pressure_bin": bins.pressure, "gap_bin": bins.gap}
    groups = storage.assemble(study.sweep, longest, collect(run, names, parts, brought), coordinates)
    if study.cases[0].output.restart:
        groups[storage.RESTART] = storage.restart_group(last_states(run, names, parts))
    notes = []
    if brought:
        notes.append(
            f"the distributions of {len(brought)} steps finished before were on other bins and are spread over this "
            "study's, within one bin; --overwrite computes them anew"
        )
    return groups, notes


def _parser(model: Model) -> Parser:
    parser = Parser(
        prog=model.command,
        usage="%(prog)s STUDY.toml -o OUT.nc [--section.key VALUE ...] [--resume | --overwrite] [--workers N]"
        + (" [--predictor BEM.nc]" if model.takes_predictor else ""),
        description=model.description,
        epilog="Exit status: 0 done and converged, 1 wrong input, 2 some step did not converge. "
        'Quantities are SI numbers or strings with a unit, lists have commas: --loading.path "-1 kPa, 2 MPa".',
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


def _shown(default: Any) -> str:
    return str(default).lower() if isinstance(default, bool) else str(default)


def _toml_value(text: str) -> Any:
    """A value as TOML writes it; anything else is a string."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _check_inputs_kept(output: Path, inputs: Sequence[Path | None]) -> None:
    for path in inputs:
        if path is not None and output.resolve() == path.resolve():
            raise InputError(f"{output}: is read by this run; choose another output")


def _carried(run: Run, finished: Finished | None) -> list[str]:
    """Warnings of a finished dataset that hold on: those of its steps, not those that were said of its whole study."""
    if finished is None:
        return []
    lines = str(finished.attributes.get("warnings", "")).splitlines()
    try:
        _, said = _reviewed(
            run.model, make_study(tomllib.loads(finished.attributes["study_toml"]), run.study.directory)
        )
    except InputError:  # a height map has moved since
        said = []
    return [line for line in lines if line not in said]


def _provenance(run: Run, finished: Finished | None, notes: Sequence[str], command: str) -> dict[str, Any]:
    history = f"{datetime.now(UTC).isoformat(timespec='seconds')}: {command}"
    if finished is not None:
        history += f"\n{finished.attributes.get('history', '')}"
    return {
        "Conventions": CONVENTIONS,
        "title": run.study.title,
        "source": f"bem-adhesion {contact_study.__version__}, {run.model.command}: {run.model.description}",
        "history": history,
        "references": run.model.references,
        "git_commit": git_commit(),
        "warnings": "\n".join(dict.fromkeys(notes)),
        **run.attributes,
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


def _with_flags(tree: xr.DataTree) -> list[xr.DataTree]:
    return [node for node in tree.subtree if "converged" in node.data_vars]


def _status(model: Model, groups: Mapping[str, xr.Dataset]) -> int:
    """Exit status of a dataset; names each group with steps that did not converge."""
    status = DONE
    for group, dataset in groups.items():
        if "converged" not in dataset:
            continue
        failed, total = (int(flags.sum()) for flags in (dataset["converged"] == 0, dataset["converged"] >= 0))
        if failed:
            status = NOT_CONVERGED
            where = f" in the group {group}" if group else ""
            print(
                f"{model.command}: {failed} of {total} steps did not converge{where}; see the variables converged and "
                "residual there",
                file=sys.stderr,
            )
    return status
