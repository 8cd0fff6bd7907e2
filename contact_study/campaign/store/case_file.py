"""The file of one case while its study runs: constants, warnings, finished steps, and the restart state.

Each is a record, the state before its step; a file half full of older states is rewritten without them. A worker that
opens a case renames a copy to its place: an abandoned one that still runs then writes into a file without a name.
"""

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from contact_study.campaign.engines import CampaignError
from contact_study.campaign.store import records
from contact_study.campaign.store.files import write_aside, writing
from contact_study.campaign.store.records import Content, Key, Record, RecordFile
from contact_study.numerics.distributions import Bins
from contact_study.results.state import Step, Value

_CONSTANTS, _NOTES, _STEP, _STATE, _PARTIAL = b"cons", b"note", b"step", b"stat", b"part"

# Least bytes of obsolete states for which a file is rewritten.
_LEAST_GAIN = 2**20


class CaseFile(RecordFile):
    """Reader of the file of a case; empty if there is none. An incomplete last record, after a kill, is no damage."""

    @property
    def has_steps(self) -> bool:
        """Whether the file has a step, or a part of one."""
        return any(kind in (_STEP, _PARTIAL) for kind, _ in self._records)

    def finished(self, steps: int, last_state: bool) -> int:
        """Count ``steps`` without a gap up to one with a state, which the last needs for ``last_state``."""
        number = 0
        while number < steps and self.has_step(number):
            number += 1
        if number == steps and not last_state:
            return number
        while number > 0 and (_STATE, number - 1) not in self._records:
            number -= 1
        return number

    @property
    def has_constants(self) -> bool:
        """Whether the file has the case's constants."""
        return (_CONSTANTS, 0) in self._records

    @property
    def constants(self) -> dict[str, Any]:
        """Quantities that do not change along the path."""
        return self._read((_CONSTANTS, 0))[0]

    @property
    def notes(self) -> list[str]:
        """The case's warnings so far."""
        return [note for key in self._records if key[0] == _NOTES for note in self._read(key)[1]]

    def has_step(self, number: int) -> bool:
        """Whether the file has a step."""
        return (_STEP, number) in self._records

    def step(self, number: int) -> tuple[dict[str, Any], Bins]:
        """Quantities and fields of one finished step, and the bins of its distributions."""
        values, spans = self._read((_STEP, number))
        return values, Bins.evenly(*spans)

    def step_text(self, number: int, name: str) -> str | None:
        """A text among the quantities of a step; None if the step is missing."""
        return str(self._read((_STEP, number), arrays=False)[0][name]) if self.has_step(number) else None

    def usable_steps(self, bins: Bins) -> int:
        """Count the steps from the first on whose distributions fit the bins."""
        number = 0
        while self.has_step(number) and Bins.evenly(*self._read((_STEP, number), arrays=False)[1]).hold(bins):
            number += 1
        return number

    def state(self, number: int) -> dict[str, np.ndarray]:
        """Restart state after a step; empty if it is missing."""
        return self._read((_STATE, number))[0] if (_STATE, number) in self._records else {}

    def partial(self, number: int) -> dict[str, np.ndarray]:
        """Averages of an unfinished step; empty if there are none."""
        return self._read((_PARTIAL, number))[0] if (_PARTIAL, number) in self._records else {}

    def keep(self, first: int, partial: bool) -> None:
        """Keep steps before ``first``, and the unfinished one if ``partial``; without a step no constants."""
        kept = [key for key in self._kept(first, partial) if first > 0 or key[0] != _CONSTANTS]

        def write(path: Path) -> None:
            with path.open("wb") as target:
                self._copy(target, kept)

        if self.damaged or len(kept) < len(self._records):
            write_aside(self.path, write)

    def _kept(self, first: int, partial: bool, oldest: int = -1) -> list[Key]:
        """All records but those of the steps from ``first`` on, and the states before the ``oldest`` one."""
        return [
            (kind, number)
            for kind, number in self._records
            if kind in (_CONSTANTS, _NOTES)
            or (kind == _STEP and number < first)
            or (kind == _STATE and oldest <= number < first)
            or (kind == _PARTIAL and oldest < number < first + partial)
        ]

    def _copy(self, target: BinaryIO, keys: Iterable[Key]) -> None:
        """Copy records into a new file, whose records they become."""
        copied: dict[Key, Record] = {}
        for key in keys:
            with self.path.open("rb") as stream:
                content = self._bytes(stream, key)
            start = target.tell()
            target.write(content)
            copied[key] = self._records[key]._replace(start=start, end=target.tell())
        self._records = copied


class CaseWriter(CaseFile):
    """Writer of the file of a case of so many ``steps``, with the last state or without; a context."""

    def __init__(self, path: Path, steps: int, last_state: bool):
        super().__init__(path)
        self._steps = steps, last_state
        self._stream: BinaryIO | None = None

    def __enter__(self) -> "CaseWriter":
        self.check()
        self._rewrite()
        return self

    def __exit__(self, *_: Any) -> None:
        if self._stream is not None:
            with suppress(OSError):  # raised when it was written
                self._stream.close()

    @property
    def start(self) -> int:
        """Number of the first missing step."""
        return self.finished(*self._steps)

    def save_constants(self, constants: Mapping[str, Value]) -> None:
        """Write the quantities that do not change along the path."""
        self._append((_CONSTANTS, 0, constants, None))

    def save_notes(self, notes: Sequence[str]) -> None:
        """Append warnings."""
        self._append((_NOTES, sum(kind == _NOTES for kind, _ in self._records), {}, list(notes)))

    def save_partial(self, number: int, kept: Mapping[str, np.ndarray]) -> None:
        """Write the averages of an unfinished step."""
        self._append((_PARTIAL, number, kept, None))

    def save_step(self, number: int, step: Step) -> None:
        """Write a finished step."""
        spans = None if step.bins is None else step.bins.spans
        self._append((_STATE, number, step.restart, None), (_STEP, number, {**step.values, **step.fields}, spans))

    def _append(self, *content: Content) -> None:
        stream = self._stream
        assert stream is not None
        with writing(self.path):
            found = {one[:2]: records.append(stream, *one) for one in content}
            stream.flush()
        try:
            is_named = os.path.samestat(self.path.stat(), os.fstat(stream.fileno()))
        except OSError:
            is_named = False
        if not is_named:
            raise CampaignError(f"{self.path}: was deleted, or taken over by another run, while its case ran")
        self._records |= found
        live = sum(self._records[key].end - self._records[key].start for key in self._live)
        if stream.tell() - live > max(live, _LEAST_GAIN):
            self._rewrite()

    @property
    def _live(self) -> list[Key]:
        return self._kept(self.start, partial=True, oldest=self.start - 1)

    def _rewrite(self) -> None:
        """Replace the file by a copy of its live records, and append to that."""
        before = self._stream

        def write(partial: Path) -> None:
            self._stream = stream = partial.open("w+b")
            self._copy(stream, self._live)
            stream.flush()
            if self._records:
                os.fsync(stream.fileno())

        try:
            write_aside(self.path, write)
        except BaseException:
            self.__exit__()
            raise
        finally:
            if before is not None:
                before.close()


def write_case(
    path: Path, constants: Mapping[str, Any], steps: Iterable[Mapping[str, Any]], bins: Bins, state: Mapping[str, Any]
) -> None:
    """Write a case file as of a run that stopped after these steps; it appears by rename."""
    content = [(_STEP, number, values, bins.spans) for number, values in enumerate(steps)]
    records.write(path, [(_CONSTANTS, 0, constants, None), *content, (_STATE, len(content) - 1, state, None)])
