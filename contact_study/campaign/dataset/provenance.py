"""Attributes of a dataset: its origin, its warnings, and a count of the steps that did not converge."""

import itertools
import os
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import xarray as xr

from contact_study.campaign.model import Model, check_study
from contact_study.campaign.record import Run, RunRecord
from contact_study.campaign.store.files import engine_of, readable
from contact_study.inputs.errors import InputError
from contact_study.results.schema import CONVENTIONS, LABELS
from contact_study.version import __version__

# Of this file's folder in a checkout.
_PLACE = "contact_study/campaign/dataset/"


def carried_warnings(model: Model, attributes: Mapping[str, Any], earlier: RunRecord | None) -> list[str]:
    """Warnings of an earlier dataset about its steps, without those about its study as a whole."""
    lines = str(attributes.get("warnings", "")).splitlines()
    try:
        study_notes = check_study(model, earlier.study)[1] if earlier else []
    except InputError:  # a height map has moved since
        study_notes = []
    return [line for line in lines if line not in study_notes]


def attributes(
    run: Run, earlier: Sequence[Mapping[str, Any]], warnings: Sequence[str], command: str, git_commit: str
) -> dict[str, Any]:
    """Attributes of the root; ``command`` heads the history, that of ``earlier`` datasets follows."""
    history = [f"{datetime.now(UTC).isoformat(timespec='seconds')}: {command}"]
    for own in earlier:
        history += str(own.get("history", "")).splitlines()
    return {
        "Conventions": CONVENTIONS,
        "title": run.study.title,
        "source": f"bem-adhesion {__version__}, {run.model.command}: {run.model.description}",
        "history": "\n".join(dict.fromkeys(history)),
        "references": run.model.references,
        "git_commit": git_commit,
        "warnings": "\n".join(dict.fromkeys(warnings)),
        **run.record.attributes,
    }


def read_flags(path: Path) -> dict[str, xr.Dataset]:
    """Flags ``converged`` in each group of a dataset."""
    with readable(path), xr.open_datatree(path, engine=engine_of(path), decode_timedelta=False) as tree:
        nodes = {node.path.strip("/"): node for node in tree.subtree if "converged" in node.data_vars}
        return {group: node.to_dataset()[["converged"]].load() for group, node in nodes.items()}


def unconverged(groups: Mapping[str, xr.Dataset]) -> Iterator[str]:
    """Yield a sentence for each theory and metastable branch with steps that did not converge."""
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
    """Commit of the checkout that runs, marked if it has been changed; "unknown" outside one."""
    try:
        # In an environment inside someone else's repository this file does not belong to that repository.
        if _git("rev-parse", "--show-prefix") != _PLACE:
            return "unknown"
        return _git("describe", "--always", "--dirty", "--abbrev=40", "--exclude=*") or "unknown"
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"


def _git(*words: str) -> str:
    command = ["git", "-C", os.path.dirname(__file__), *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=10).stdout.strip()
