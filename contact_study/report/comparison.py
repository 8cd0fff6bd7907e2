"""The comparison of datasets, or the report on one: read, computed, drawn and written."""

import os
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr

import contact_study
from contact_study.campaign.record import git_commit
from contact_study.campaign.store.files import writable_output, writing
from contact_study.inputs.errors import DONE, NOT_CONVERGED, InputError
from contact_study.report.align.deviations import MISSING, compute_deviations, ensemble_statistics, pairs_of
from contact_study.report.align.regime import compute_regime
from contact_study.report.facts.overview import effort
from contact_study.report.facts.ranking import find, surface_deviations
from contact_study.report.figures import Figures, draw
from contact_study.report.page import collected_warnings, render_report
from contact_study.report.read.datasets import Inputs, read_inputs, read_scatter
from contact_study.results.schema import CONVENTIONS, SCHEMA_VERSION


@dataclass(frozen=True)
class Request:
    """Datasets to compare and files to write."""

    datasets: Sequence[Path]  # files of the models
    output: Path  # dataset to write
    report: Path | None  # report to write
    pictures: Mapping[str, Mapping[str, Path]]  # files of the figures by format and name; empty for none
    reference_pressure: float | None  # pressure (Pa) at which the whole sweep is shown
    average: str | None  # swept key over which means are shown
    scatter: Path | None  # dataset over several surfaces
    command: str  # name of the command, for messages and the history
    arguments: Sequence[str]  # its arguments, for the history


def compare(asked: Request) -> int:
    """Compare the datasets, write what is asked for and return the exit status of the command."""
    inputs = read_inputs(asked.datasets, asked.average)
    if asked.reference_pressure is not None and inputs.control != "pressure":
        raise InputError("--reference-pressure: these studies prescribe the gap; leave it out")
    scatter = read_scatter(asked.scatter, inputs) if asked.scatter else None
    for note in (*inputs.notes, *(scatter.notes if scatter else ())):
        print(f"{asked.command}: warning: {note}", file=sys.stderr)
    deviations = compute_deviations(inputs.models, inputs.control) if pairs_of(inputs.models) else None
    if deviations is not None and (deviations["state"] == MISSING).all():
        raise InputError("these datasets have no point of their loading paths in common; run the same study")
    regime = compute_regime(inputs)
    attrs = _attributes(inputs, asked)
    statistics = ensemble_statistics({scatter.model: scatter.dataset}) if scatter else {}
    from_surfaces = surface_deviations(inputs.models, scatter.model, scatter.dataset) if scatter else None
    drawn = Figures()
    if asked.pictures or asked.report:
        pressure, formats = asked.reference_pressure, list(asked.pictures)
        drawn = draw(inputs, pressure, formats, scatter, page=asked.report is not None)
    scattered = {**statistics, **({} if from_surfaces is None else {"deviations": from_surfaces})}
    tree = comparison_tree(inputs, deviations, regime, attrs, scattered)
    outputs: dict[Path, Callable[[Path], Any]] = {
        asked.output: lambda path: tree.to_netcdf(path, engine="netcdf4", write_inherited_coords=True)
    }
    for kind, files in asked.pictures.items():
        outputs |= {files[name]: partial(Path.write_bytes, data=content) for name, content in drawn.files[kind].items()}
    if asked.report:
        shown = inputs.with_first_spectra.models
        findings = find(shown, deviations, regime, statistics, from_surfaces)
        page = render_report(inputs, deviations, regime, drawn, {**attrs, "file": asked.output.name}, findings)
        outputs[asked.report] = partial(Path.write_bytes, data=page.encode())
    _write(outputs)
    print(*outputs, sep="\n")
    if failed := effort(*inputs.models.values())[1]:
        words = "of the inputs' steps did not converge; they are marked and left out of the deviations"
        print(f"{asked.command}: {failed} {words}", file=sys.stderr)
    return NOT_CONVERGED if failed else DONE


def comparison_tree(
    inputs: Inputs,
    deviations: xr.Dataset | None,
    regime: xr.Dataset,
    attrs: Mapping[str, Any],
    scatter: Mapping[str, xr.Dataset] | None = None,
) -> xr.DataTree:
    """Put the dataset of a comparison together: the files' groups, ``regime``, ``deviations`` if there are any.

    ``ensemble`` holds means and standard errors of each model with several samples, ``scatter`` those of the
    realisations behind the models, and the deviations of the theories from each of these.
    """
    groups = {
        f"/{kind}" + (f"/{name}" if name else ""): dataset
        for kind, contents in inputs.groups.items()
        for name, dataset in contents.items()
    }
    groups["/regime"] = regime
    groups |= {f"/ensemble/{name}": dataset for name, dataset in ensemble_statistics(inputs.models).items()}
    groups |= {f"/scatter/{name}": dataset for name, dataset in (scatter or {}).items()}
    if deviations is not None:
        groups["/deviations"] = deviations
    filled = {path: _without_filled_coordinates(dataset) for path, dataset in groups.items()}
    return xr.DataTree.from_dict({"/": xr.Dataset(attrs=attrs), **filled})


def _without_filled_coordinates(dataset: xr.Dataset) -> xr.Dataset:
    """CF: a coordinate variable has no missing values, hence no fill value."""
    dataset = dataset.copy()
    for name in dataset.indexes:
        dataset[name].encoding = {"_FillValue": None} if dataset[name].dtype.kind in "fiu" else {}
    return dataset


def _attributes(inputs: Inputs, asked: Request) -> dict[str, str]:
    now = datetime.now(UTC).isoformat(timespec="seconds")
    roots = [inputs.groups[kind][""].attrs for kind in inputs.paths]
    references = (line for own in roots for line in str(own.get("references", "")).splitlines())
    run = f"{now}: {asked.command} {shlex.join(asked.arguments)}"
    return {
        "Conventions": CONVENTIONS,
        "title": inputs.study.title,
        "institution": "not given",
        "source": f"bem-adhesion {contact_study.__version__}, {asked.command}",
        "history": "\n".join([run, *(str(own.get("history", "")) for own in roots)]),
        "references": "\n".join(dict.fromkeys(references)),
        "created": now,
        "git_commit": git_commit(),
        "warnings": "\n".join(collected_warnings(inputs)),
        "model": "comparison",
        "study_toml": inputs.study.toml,
        "schema_version": SCHEMA_VERSION,
        "comment": "The fields gap and pressure stay in the models' own datasets.",
    }


def _write(outputs: Mapping[Path, Callable[[Path], Any]]) -> None:
    """Write every file aside, then rename them all: a failure leaves what was there before."""
    partials = {path: path.with_name(f".{path.name}.{os.getpid()}.tmp") for path in outputs}
    try:
        for path, write in outputs.items():
            writable_output(path)
            with writing(path):
                write(partials[path])
        for path, aside in partials.items():
            with writing(path):
                aside.replace(path)
    finally:
        for aside in partials.values():
            if aside.parent.is_dir():
                aside.unlink(missing_ok=True)
