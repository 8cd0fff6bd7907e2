"""The file of one case while its study runs: constants, warnings, finished steps, and a state to go on from.

Each is a record under a checksum, appended when it is known, the state before its step: what can be read is complete,
and a kill at any moment costs what was being written. States before the last serve nobody; once they fill half of the
file it is written anew without them, and renamed.

Whoever takes up a case first copies its file, and renames the copy to its place. A worker that was given up but still
runs, on another machine perhaps, then writes into a file without a name.
"""

import os
import socket
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from contact_study.campaign.engines.base import CampaignError
from contact_study.campaign.store import records
from contact_study.campaign.store.files import write_aside
from contact_study.campaign.store.records import Record
from contact_study.numerics.distributions import Bins
from contact_study.results.state import Value
from contact_study.results.step import Step

_CONSTANTS, _NOTES, _STEP, _STATE, _PARTIAL = b"cons", b"note", b"step", b"stat", b"part"

# Bytes of states that serve nobody, below which a file is not written anew for them.
_WORTH_WHILE = 2**20

_Key = tuple[bytes, int]


class CaseFile:
    """What the file of a case holds; nothing if there is none.

    Parameters
    ----------
    path : pathlib.Path
        The file.

    Attributes
    ----------
    path : pathlib.Path
        The file.
    damaged : bool
        Whether something in it is not what was written; a record that a kill has torn is none of this.
    """

    def __init__(self, path: Path):
        self.path = path
        self.damaged = False
        self._records: dict[_Key, Record] = {}
        with suppress(FileNotFoundError), path.open("rb") as stream:
            try:
                for record in records.records_in(stream):
                    self._records[record.kind, record.number] = record
            except ValueError:
                self.damaged = True

    def check(self) -> None:
        """Look at every record, and forget those that are not what was written."""
        if not self._records:
            return
        with self.path.open("rb") as stream:
            whole = {key: record for key, record in self._records.items() if records.is_whole(stream, record)}
        self.damaged |= len(whole) < len(self._records)
        self._records = whole

    @property
    def has_steps(self) -> bool:
        """Whether a step, or a part of one, is there."""
        return any(kind in (_STEP, _PARTIAL) for kind, _ in self._records)

    def finished(self, steps: int, last_state: bool) -> int:
        """How many of a case's ``steps`` are there, counted from the first without a gap, and can be gone on from.

        The last one of all counts without a state, unless its state is wanted.
        """
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
        """Whether the case's constants are there."""
        return (_CONSTANTS, 0) in self._records

    @property
    def constants(self) -> dict[str, Any]:
        """What does not change along the path."""
        return self._read((_CONSTANTS, 0))[0]

    @property
    def notes(self) -> list[str]:
        """The case's warnings so far."""
        return [note for key in self._records if key[0] == _NOTES for note in self._read(key)[1]]

    def step(self, number: int) -> tuple[dict[str, Any], Bins]:
        """Quantities and fields of one finished step, and the bins of its distributions."""
        values, spans = self._read((_STEP, number))
        return values, Bins.evenly(*spans)

    def step_text(self, number: int, name: str) -> str | None:
        """A text among the quantities of a step; None if it is not there."""
        return str(self._read((_STEP, number), records.read_text)[0][name]) if self.has_step(number) else None

    def has_step(self, number: int) -> bool:
        """Whether a step is there."""
        return (_STEP, number) in self._records

    def usable_steps(self, bins: Bins) -> int:
        """How many steps from the first one on have distributions that can be brought onto the bins."""
        number = 0
        while self.has_step(number) and self._bins(number).hold(bins):
            number += 1
        return number

    def _bins(self, number: int) -> Bins:
        return Bins.evenly(*self._read((_STEP, number), records.read_text)[1])

    def state(self, number: int) -> dict[str, np.ndarray]:
        """The state that the step after ``number`` starts from; empty if it is not there."""
        key = _STATE, number
        return self._read(key)[0] if key in self._records else {}

    def partial(self, number: int) -> dict[str, np.ndarray]:
        """What is known of an unfinished step; empty if nothing is."""
        key = _PARTIAL, number
        return self._read(key)[0] if key in self._records else {}

    def keep(self, first: int, partial: bool) -> None:
        """Leave the steps before number ``first`` alone in the file, and what is known of that one if ``partial``.

        With none left the constants go, too; so does what :meth:`check` has found damaged.
        """
        kept = [key for key in self._records if _is_before(key, first, partial)]

        def write(path: Path) -> None:
            with path.open("wb") as target:
                self._copy(target, kept)

        if self.damaged or len(kept) < len(self._records):
            write_aside(self.path, write)

    def _copy(self, target: BinaryIO, keys: Iterable[_Key]) -> None:
        """Copy records into a file, which are what is there from now on."""
        copied: dict[_Key, Record] = {}
        if self._records:
            with self.path.open("rb") as stream:
                for key in keys:
                    if not records.is_whole(stream, self._records[key]):
                        raise self._damage("is not what was written")
                    copied[key] = records.copy(stream, self._records[key], target)
        self._records = copied

    def _read(
        self, key: _Key, how: Callable[[BinaryIO, Record], tuple[dict[str, Any], Any]] = records.read
    ) -> tuple[dict[str, Any], Any]:
        try:
            with self.path.open("rb") as stream:
                return how(stream, self._records[key])
        except ValueError as error:
            raise self._damage(str(error)) from None

    def _damage(self, fault: str) -> CampaignError:
        return CampaignError(f"{self.path}: {fault}; --resume computes it again")


def _is_before(key: _Key, first: int, partial: bool) -> bool:
    kind, number = key
    if kind == _NOTES:
        return True
    if kind == _CONSTANTS:
        return first > 0
    return number < first + (kind == _PARTIAL and partial)


class CaseWriter(CaseFile):
    """The file of a case in the hands of who runs it; a context.

    Parameters
    ----------
    path : pathlib.Path
        The file; its folder is there.
    steps : int
        Points of the case's path.
    last_state : bool
        Whether the state after the last one is wanted.

    Raises
    ------
    OSError
        If it cannot be written.
    CampaignError
        If it was deleted, or somebody else has taken up the case.
    """

    def __init__(self, path: Path, steps: int, last_state: bool):
        super().__init__(path)
        self._steps = steps, last_state
        self._stream: BinaryIO | None = None

    def __enter__(self) -> "CaseWriter":
        self.check()
        self._take_up()
        return self

    def __exit__(self, *_: Any) -> None:
        if self._stream is not None:
            with suppress(OSError):  # said when it was written
                self._stream.close()

    @property
    def start(self) -> int:
        """Number of the first step that is missing."""
        return self.finished(*self._steps)

    def save_constants(self, constants: Mapping[str, Value]) -> None:
        """Put what does not change along the path on disk."""
        self._append((_CONSTANTS, 0, constants, None))

    def save_notes(self, notes: Sequence[str]) -> None:
        """Put warnings on disk, after those that are there."""
        self._append((_NOTES, sum(kind == _NOTES for kind, _ in self._records), {}, list(notes)))

    def save_partial(self, number: int, kept: Mapping[str, np.ndarray]) -> None:
        """Put what is known so far of an unfinished step on disk."""
        self._append((_PARTIAL, number, kept, None))

    def save_step(self, number: int, step: Step) -> None:
        """Put one finished step on disk."""
        spans = None if step.bins is None else step.bins.spans
        self._append((_STATE, number, step.restart, None), (_STEP, number, {**step.values, **step.fields}, spans))

    def _append(self, *content: tuple[bytes, int, Mapping[str, Any], Any]) -> None:
        stream = self._stream
        assert stream is not None
        try:
            found = [records.append(stream, *one) for one in content]
            stream.flush()
        except OSError as error:
            raise OSError(f"{self.path}: cannot be written ({error.strerror or error})") from None
        if not self._stands():
            raise CampaignError(
                f"{self.path}: was deleted, or taken up by another run, while its case ran; run the study again"
            )
        self._records |= {(record.kind, record.number): record for record in found}
        live = sum(self._records[key].size for key in self._live)
        if stream.tell() - live > max(live, _WORTH_WHILE):
            self._take_up()

    @property
    def _live(self) -> list[_Key]:
        """What serves somebody: all but states and parts of steps before the one that is missing."""
        first = self.start
        return [
            key
            for key in self._records
            if key[0] == _CONSTANTS
            or (
                _is_before(key, first, True)
                and (key[0] not in (_STATE, _PARTIAL) or key[1] >= first - (key[0] == _STATE))
            )
        ]

    def _take_up(self) -> None:
        """Write the file anew with what serves somebody, and go on with it in the place of the old one."""
        partial = self.path.with_name(f".{self.path.name}.{socket.gethostname()}.{os.getpid()}.tmp")
        try:
            stream = partial.open("w+b")
            try:
                self._copy(stream, self._live)
                stream.flush()
                if self._records:
                    os.fsync(stream.fileno())
                partial.replace(self.path)
            except BaseException:
                stream.close()
                partial.unlink(missing_ok=True)
                raise
        except OSError as error:
            raise OSError(f"{self.path}: cannot be written ({error.strerror or error})") from None
        if self._stream is not None:
            self._stream.close()
        self._stream = stream

    def _stands(self) -> bool:
        """Whether the file still has its name."""
        assert self._stream is not None
        try:
            return os.path.samestat(self.path.stat(), os.fstat(self._stream.fileno()))
        except OSError:
            return False


def write_case(
    path: Path, constants: Mapping[str, Any], steps: Sequence[Mapping[str, Any]], bins: Bins, state: Mapping[str, Any]
) -> None:
    """Put what is known of a case on disk, as if a run had stopped after these steps; all of it appears at once."""

    def write(partial: Path) -> None:
        with partial.open("wb") as stream:
            records.append(stream, _CONSTANTS, 0, constants)
            for number, values in enumerate(steps):
                records.append(stream, _STEP, number, values, bins.spans)
            if steps:
                records.append(stream, _STATE, len(steps) - 1, state)

    write_aside(path, write)
