"""Files of records; and that of a case while its study runs: constants, warnings, finished steps, the restart state.

A record has numbers and arrays with a checksum; a kill leaves at most the last one incomplete. A state comes before its
step; a file half full of older states is rewritten without them. A worker that opens a case renames a copy to its
place: an abandoned one that still runs then writes into a file without a name.
"""

import json
import math
import os
import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from contact_study.campaign.engines import CampaignError
from contact_study.campaign.store.files import write_aside, writing
from contact_study.numerics.distributions import Bins
from contact_study.results.state import Step, Value

_MARK = b"rec1"
_HEAD = struct.Struct("<4s4sIIQ")  # mark, kind, number, checksum, bytes that follow
_LENGTH = struct.Struct("<Q")  # of the text before the arrays

Key = tuple[bytes, int]  # kind (four letters) and number within it
# Kind, number, numbers, texts and arrays by name, and further JSON content.
Content = tuple[bytes, int, Mapping[str, Any], Any]


class Record(NamedTuple):
    """Place of a record in its file, and CRC-32 of all but the checksum itself."""

    start: int
    end: int
    checksum: int


def append(stream: BinaryIO, kind: bytes, number: int, values: Mapping[str, Any], extra: Any) -> Record:
    """Write a record at the end of a file."""
    scalars: dict[str, Any] = {}
    arrays: dict[str, np.ndarray] = {}
    for name, value in values.items():
        array = np.asarray(value)
        if array.ndim:
            arrays[name] = np.ascontiguousarray(array)
        else:
            scalars[name] = array.item()
    shapes = [(name, array.dtype.str, array.shape) for name, array in arrays.items()]
    # Python's JSON writes the shortest digits that give the same double, and NaN and infinities by name.
    text = json.dumps([scalars, extra, shapes]).encode()
    bodies = (array.reshape(-1).view(np.uint8).data for array in arrays.values())
    pieces: list[bytes | memoryview] = [_LENGTH.pack(len(text)), text, *bodies]
    length = sum(len(piece) for piece in pieces)
    checksum = zlib.crc32(_HEAD.pack(_MARK, kind, number, 0, length))
    for piece in pieces:
        checksum = zlib.crc32(piece, checksum)
    start = stream.tell()
    stream.write(_HEAD.pack(_MARK, kind, number, checksum, length))
    stream.writelines(pieces)
    return Record(start, start + _HEAD.size + length, checksum)


def write_records(path: Path, content: Iterable[Content]) -> None:
    """Write a file of records; it appears by rename."""

    def write(partial: Path) -> None:
        with partial.open("wb") as stream:
            for one in content:
                append(stream, *one)

    write_aside(path, write)


class RecordFile:
    """Reader of a file of records, empty if there is none; ``damaged`` if it holds anything else."""

    def __init__(self, path: Path):
        self.path = path
        self.damaged = False
        self._records: dict[Key, Record] = {}
        start = 0
        with suppress(FileNotFoundError), path.open("rb") as stream:
            size = stream.seek(0, 2)
            while start + _HEAD.size <= size:
                stream.seek(start)
                mark, kind, number, checksum, length = _HEAD.unpack(stream.read(_HEAD.size))
                end = start + _HEAD.size + length
                self.damaged = mark != _MARK
                if self.damaged or end > size:  # incomplete
                    break
                self._records[kind, number] = Record(start, end, checksum)
                start = end

    def check(self) -> None:
        """Verify every record; drop corrupt ones."""
        if not self._records:
            return
        with self.path.open("rb") as stream:
            for key in [*self._records]:
                try:
                    self._bytes(stream, key)
                except CampaignError:
                    self.damaged = True
                    del self._records[key]

    def _read(self, key: Key, arrays: bool = True) -> tuple[dict[str, Any], Any]:
        """Read values and further content of a record; without ``arrays`` unverified."""
        with self.path.open("rb") as stream:
            content = self._bytes(stream, key) if arrays else b""
            stream.seek(self._records[key].start + _HEAD.size)
            values, extra, shapes = json.loads(stream.read(*_LENGTH.unpack(stream.read(_LENGTH.size))))
            start = stream.tell() - self._records[key].start
        for name, kind, shape in shapes if arrays else ():
            values[name] = np.frombuffer(content, kind, math.prod(shape), start).reshape(shape).copy()
            start += values[name].nbytes
        return values, extra

    def _bytes(self, stream: BinaryIO, key: Key) -> bytes:
        """Read a whole record from the open file; raises CampaignError if it is corrupt."""
        start, end, checksum = self._records[key]
        stream.seek(start)
        content = stream.read(end - start)
        head = _HEAD.pack(_MARK, *key, 0, end - start - _HEAD.size)
        if zlib.crc32(memoryview(content)[_HEAD.size :], zlib.crc32(head)) != checksum:
            raise CampaignError(f"{self.path}: is corrupt")
        return content


_CONSTANTS, _NOTES, _STEP, _STATE, _PARTIAL = b"cons", b"note", b"step", b"stat", b"part"

# Least bytes of obsolete states for which a file is rewritten.
_LEAST_GAIN = 2**20


class CaseFile(RecordFile):
    """Reader of the file of a case; empty if there is none."""

    @property
    def has_steps(self) -> bool:
        """Whether the file has a step, or a part of one."""
        return any(kind in (_STEP, _PARTIAL) for kind, _ in self._records)

    def finished(self, steps: int, last_state: bool) -> int:
        """Count ``steps`` without a gap up to one with a state, which the last needs for ``last_state``."""
        number = next(n for n in range(steps + 1) if n == steps or not self.has_step(n))
        if number == steps and not last_state:
            return number
        return next((n for n in range(number, 0, -1) if (_STATE, n - 1) in self._records), 0)

    @property
    def has_constants(self) -> bool:
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
        if self._records:
            with self.path.open("rb") as source:
                for key in keys:
                    start = target.tell()
                    target.write(self._bytes(source, key))
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
        self._append((_CONSTANTS, 0, constants, None))

    def save_notes(self, notes: Sequence[str]) -> None:
        self._append((_NOTES, sum(kind == _NOTES for kind, _ in self._records), {}, list(notes)))

    def save_partial(self, number: int, kept: Mapping[str, np.ndarray]) -> None:
        """Write the averages of an unfinished step."""
        self._append((_PARTIAL, number, kept, None))

    def save_step(self, number: int, step: Step) -> None:
        spans = None if step.bins is None else step.bins.spans
        self._append((_STATE, number, step.restart, None), (_STEP, number, {**step.values, **step.fields}, spans))

    def _append(self, *content: Content) -> None:
        stream = self._stream
        assert stream is not None
        with writing(self.path):
            found = {one[:2]: append(stream, *one) for one in content}
            stream.flush()
        try:
            is_named = os.path.samestat(self.path.stat(), os.fstat(stream.fileno()))
        except OSError:
            is_named = False
        if not is_named:
            raise CampaignError(f"{self.path}: was deleted, or taken over by another run, while its case ran")
        self._records |= found
        kept = [self._records[key] for key in self._kept(self.start, True, self.start - 1)]
        live = sum(record.end - record.start for record in kept)
        if stream.tell() - live > max(live, _LEAST_GAIN):
            self._rewrite()

    def _rewrite(self) -> None:
        """Replace the file by a copy of its live records, and append to that."""
        before = self._stream

        def write(partial: Path) -> None:
            self._stream = stream = partial.open("w+b")
            self._copy(stream, self._kept(self.start, True, self.start - 1))
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
    write_records(path, [(_CONSTANTS, 0, constants, None), *content, (_STATE, len(content) - 1, state, None)])
