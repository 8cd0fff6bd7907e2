"""Restart states beside a dataset, ``bem.nc.restart``: the state after each last point, to lengthen paths from.

Only ``--resume`` and ``contact-merge`` read the file, so it may be deleted. It names its dataset by the history.
"""

import itertools
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.campaign.store import records
from contact_study.campaign.store.files import write_aside
from contact_study.campaign.store.records import Record

_OWNER, _STATE = b"ownr", b"stat"


def states_file(dataset: Path) -> Path:
    """Path of the restart states of a dataset."""
    return dataset.with_name(dataset.name + ".restart")


def write_states(path: Path, history: str, states: Iterable[Mapping[str, Any]]) -> None:
    """Write the states of the cases of a dataset, in their order; no file if all are empty."""
    kept = ((number, state) for number, state in enumerate(states) if state)
    first = next(kept, None)
    if first is None:
        return

    def write(partial: Path) -> None:
        with partial.open("wb") as stream:
            records.append(stream, _OWNER, 0, {}, history)
            for number, state in itertools.chain([first], kept):
                records.append(stream, _STATE, number, state)

    write_aside(path, write)


class States:
    """Reader of the restart states of a dataset.

    Parameters
    ----------
    path : pathlib.Path
        The file; it may be missing.

    Attributes
    ----------
    history : str or None
        History of their dataset; None without a readable file.
    """

    def __init__(self, path: Path):
        self._path = path
        self._records: dict[int, Record] = {}
        self.history: str | None = None
        with suppress(OSError, ValueError), path.open("rb") as stream:
            for record in records.records_in(stream):
                if record.kind == _OWNER:
                    self.history = records.read(stream, record)[1]
                else:
                    self._records[record.number] = record

    def state(self, number: int) -> dict[str, np.ndarray]:
        """State after the last step of a case; empty if it was not kept, or is damaged."""
        with suppress(KeyError, OSError, ValueError), self._path.open("rb") as stream:
            return records.read(stream, self._records[number])[0]
        return {}
