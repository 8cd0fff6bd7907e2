"""Files of records, numbers and arrays with a checksum; a kill leaves at most the last one incomplete."""

import json
import math
import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, BinaryIO

import numpy as np

_MARK = b"rec1"
_HEAD = struct.Struct("<4s4sIIQ")  # mark, kind, number, checksum, bytes that follow
_LENGTH = struct.Struct("<Q")  # of the text before the arrays


@dataclass(frozen=True)
class Record:
    """Kind (four letters), number within it, place in the file, and CRC-32 of all but the checksum itself."""

    kind: bytes
    number: int
    start: int
    end: int
    checksum: int

    @property
    def size(self) -> int:
        """Bytes, including the head."""
        return self.end - self.start


def records_in(stream: BinaryIO) -> Iterator[Record]:
    """Yield the complete records of a file, unverified; raises ValueError if it holds anything else."""
    start, size = 0, stream.seek(0, 2)
    while start + _HEAD.size <= size:
        stream.seek(start)
        mark, kind, number, checksum, length = _HEAD.unpack(stream.read(_HEAD.size))
        if mark != _MARK:
            raise ValueError(f"no record at byte {start}")
        end = start + _HEAD.size + length
        if end > size:  # incomplete
            return
        yield Record(kind, number, start, end, checksum)
        start = end


def append(stream: BinaryIO, kind: bytes, number: int, values: Mapping[str, Any], extra: Any = None) -> Record:
    """Write numbers, texts and arrays by name, and ``extra`` JSON content, at the end of a file."""
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
    checksum = _checksum_of_head(kind, number, length)
    for piece in pieces:
        checksum = zlib.crc32(piece, checksum)
    start = stream.tell()
    stream.write(_HEAD.pack(_MARK, kind, number, checksum, length))
    stream.writelines(pieces)
    return Record(kind, number, start, start + _HEAD.size + length, checksum)


def content_of(stream: BinaryIO, record: Record) -> bytes:
    """Read the bytes after the head of a record; raises ValueError if it is corrupt."""
    stream.seek(record.start + _HEAD.size)
    content = stream.read(record.size - _HEAD.size)
    if zlib.crc32(content, _checksum_of_head(record.kind, record.number, record.size - _HEAD.size)) != record.checksum:
        raise ValueError("is corrupt")
    return content


def read(stream: BinaryIO, record: Record) -> tuple[dict[str, Any], Any]:
    """Read values and extra of a record; raises ValueError if it is corrupt."""
    content = content_of(stream, record)
    values, extra, shapes = _text(stream, record)
    start = stream.tell() - record.start - _HEAD.size
    for name, kind, shape in shapes:
        values[name] = np.frombuffer(content, kind, math.prod(shape), start).reshape(shape).copy()
        start += values[name].nbytes
    return values, extra


def read_text(stream: BinaryIO, record: Record) -> tuple[dict[str, Any], Any]:
    """Read the values that are no arrays, and extra, of a verified record."""
    scalars, extra, _ = _text(stream, record)
    return scalars, extra


def is_whole(stream: BinaryIO, record: Record) -> bool:
    """Whether the checksum of a record is right."""
    try:
        return bool(content_of(stream, record))
    except ValueError:
        return False


def copy(stream: BinaryIO, record: Record, target: BinaryIO) -> Record:
    """Append a record of one file to another; raises ValueError if it is corrupt."""
    start, content = target.tell(), content_of(stream, record)
    target.write(_HEAD.pack(_MARK, record.kind, record.number, record.checksum, len(content)) + content)
    return replace(record, start=start, end=target.tell())


def _text(stream: BinaryIO, record: Record) -> Any:
    """Read the text before a record's arrays; the stream is then at the arrays."""
    stream.seek(record.start + _HEAD.size)
    return json.loads(stream.read(*_LENGTH.unpack(stream.read(_LENGTH.size))))


def _checksum_of_head(kind: bytes, number: int, length: int) -> int:
    return zlib.crc32(_HEAD.pack(_MARK, kind, number, 0, length))
