"""Files of records, numbers and arrays with a checksum; a kill leaves at most the last one incomplete."""

import json
import math
import struct
import zlib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from contact_study.campaign.engines import CampaignError
from contact_study.campaign.store.files import write_aside

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


def write(path: Path, content: Iterable[Content]) -> None:
    """Write a file of records; it appears by rename."""

    def write_all(partial: Path) -> None:
        with partial.open("wb") as stream:
            for one in content:
                append(stream, *one)

    write_aside(path, write_all)


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
        for key in [*self._records]:
            try:
                with self.path.open("rb") as stream:
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
        """Read a whole record; raises CampaignError if it is corrupt."""
        start, end, checksum = self._records[key]
        stream.seek(start)
        content = stream.read(end - start)
        head = _HEAD.pack(_MARK, *key, 0, end - start - _HEAD.size)
        if zlib.crc32(memoryview(content)[_HEAD.size :], zlib.crc32(head)) != checksum:
            raise CampaignError(f"{self.path}: is corrupt")
        return content
