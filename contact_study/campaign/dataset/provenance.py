"""What a dataset says of itself: where it came from, and which of its steps did not converge."""

import itertools
import os
import subprocess
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from typing import Any

import xarray as xr

import contact_study
from contact_study.campaign.check import checked
from contact_study.campaign.dataset.formats import engine_of, readable
from contact_study.campaign.resume.identity import Cases, Run
from contact_study.campaign.resume.resume import ExistingDataset
from contact_study.errors import InputError
from contact_study.results.schema import CONVENTIONS, LABELS
from contact_study.study.study import make_study

# Of this file's folder in a checkout.
_PLACE = "contact_study/campaign/dataset/"


def carried_warnings(run: Run, finished: ExistingDataset | None, earlier: Cases | None = None) -> list[str]:
    """Warnings of an earlier dataset that hold on: those of its steps, not those that were said of its whole study.

    ``earlier`` are its cases, if they are known already.
    """
    if finished is None:
        return []
    lines = str(finished.attributes.get("warnings", "")).splitlines()
    try:
        study = (
            earlier.study
            if earlier
            else make_study(tomllib.loads(finished.attributes["study_toml"]), run.study.directory)
        )
        _, said = checked(run.model, study)
    except InputError:  # a height map has moved since
        said = []
    return [line for line in lines if line not in said]


def provenance(
    run: Run, earlier: Sequence[Mapping[str, Any]], warnings: Sequence[str], command: str, git_commit: str
) -> dict[str, Any]:
    """Attributes of the root; ``command`` heads the history, that of ``earlier`` datasets follows."""
    history = [f"{datetime.now(UTC).isoformat(timespec='seconds')}: {command}"]
    for attributes in earlier:
        history += str(attributes.get("history", "")).splitlines()
    return {
        "Conventions": CONVENTIONS,
        "title": run.study.title,
        "source": f"bem-adhesion {contact_study.__version__}, {run.model.command}: {run.model.description}",
        "history": "\n".join(dict.fromkeys(history)),
        "references": run.model.references,
        "git_commit": git_commit,
        "warnings": "\n".join(dict.fromkeys(warnings)),
        **run.attributes,
    }


def read_flags(finished: ExistingDataset) -> dict[str, xr.Dataset]:
    """Which steps converged, in each group of a finished dataset."""
    with (
        readable(finished.path),
        xr.open_datatree(finished.path, engine=engine_of(finished.path), decode_timedelta=False) as tree,
    ):
        nodes = {node.path.strip("/"): node for node in tree.subtree if "converged" in node.data_vars}
        return {group: node.to_dataset()[["converged"]].load() for group, node in nodes.items()}


def unconverged(groups: Mapping[str, xr.Dataset]) -> Iterator[str]:
    """For each theory and metastable branch with steps that did not converge, how many of how many, in words."""
    for group, dataset in groups.items():
        if "converged" not in dataset:
            continue
        flags = dataset["converged"]
        labels = [dim for dim in LABELS if dim in flags.dims]
        for place in itertools.product(*(flags[dim].values for dim in labels)):
            chosen = dict(zip(labels, place, strict=True))
            own = flags.sel(chosen)
            failed, total = int((own == 0).sum()), int((own >= 0).sum())
            if failed:
                where = ", ".join(f'{dim}="{label}"' for dim, label in chosen.items())
                where = (f" at {where}" if where else "") + (f" in the group {group}" if group else "")
                yield (
                    f"{failed} of {total} steps did not converge{where}; see the variables converged and residual there"
                )


@cache
def git_commit() -> str:
    """Commit of the checkout that this runs from, marked if it has been changed; "unknown" outside one."""
    try:
        # Installed in an environment that lies in someone's repository, this is none of its files.
        if _git("rev-parse", "--show-prefix") != _PLACE:
            return "unknown"
        return _git("describe", "--always", "--dirty", "--abbrev=40", "--exclude=*") or "unknown"
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"


def _git(*words: str) -> str:
    """What git says of the folder of this file."""
    command = ["git", "-C", os.path.dirname(__file__), *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=10).stdout.strip()
