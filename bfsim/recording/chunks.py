"""The chunks of an MCAP file, read one at a time, within limits, with their messages in order of time.

A file of some kilobytes can claim to hold gigabytes. So the decompressed size of a chunk is limited in advance, as are
the messages that wait for their turn.
"""

from __future__ import annotations

import heapq
import io
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, Message
from mcap.summary import Summary

from bfsim.errors import RecordingError, shown

LARGEST_CHUNK_BYTES = 128 << 20
"""The largest chunk before compression: two pictures of the largest size. Programs write chunks of 1 to 8 MB."""

MOST_MESSAGES = 1 << 16
"""In a chunk, on the topics that are read."""

_MOST_WAITING_BYTES = 2 * LARGEST_CHUNK_BYTES
"""Of messages that wait because chunks overlap in time."""

RECORD_HEAD = struct.Struct("<BQ")  # opcode, length [MCAP specification, "Records"]
_CHUNK_HEAD = struct.Struct("<QQQII")  # times of first and last message, size, CRC32, length of a name
_MESSAGE_HEAD = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time


def records_in(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield opcode, start and end of each record in some bytes. Raises ValueError if they end within a record."""
    position = 0
    while position < len(data):
        if position + RECORD_HEAD.size > len(data):
            raise ValueError(f"a record breaks off at its byte {position}")
        opcode, length = RECORD_HEAD.unpack_from(data, position)
        start = position + RECORD_HEAD.size
        position = start + length
        if position > len(data):
            raise ValueError(
                f"a record at its byte {start} has {length} bytes, of which {len(data) - start} are there"
            )
        yield opcode, start, position


class ChunkReader:
    """Reads the chunks that an index lists. `offset` is the begin of the latest, `end` the end of all so far.

    Raises RecordingError for a chunk that is too large; for a damaged one, the errors of mcap and the decompressors.
    """

    def __init__(self, stream: IO[bytes], path: Path, size_bytes: int, summary: Summary) -> None:
        self.offset = self.end = 0
        self._stream = stream
        self._path = path
        self._size_bytes = size_bytes
        self._summary = summary

    def messages(self, topics: list[str]) -> Iterator[tuple[Channel, Message]]:
        """Yield the messages of some topics in the order of their time stamps."""
        channels = {each.id: each for each in self._summary.channels.values() if each.topic in topics}
        waiting: list[tuple[int, int, int, Message]] = []
        waiting_bytes = 0
        for index in sorted(
            self._with(channels), key=lambda each: (each.message_start_time, each.chunk_start_offset)
        ):
            begins = index.message_start_time, index.chunk_start_offset
            while waiting and waiting[0][:2] < begins:
                message = heapq.heappop(waiting)[-1]
                waiting_bytes -= len(message.data)
                yield channels[message.channel_id], message
            for number, message in enumerate(self._messages_of(index, channels)):
                heapq.heappush(waiting, (message.log_time, index.chunk_start_offset, number, message))
                waiting_bytes += len(message.data)
            if waiting_bytes > _MOST_WAITING_BYTES:
                self._refuse(
                    f"must follow the others in time, but {_size(waiting_bytes)} of pictures overlap there"
                )
        while waiting:
            message = heapq.heappop(waiting)[-1]
            yield channels[message.channel_id], message

    def _with(self, channels: dict[int, Channel]) -> Iterator[ChunkIndex]:
        """Yield the chunks that may hold messages of some channels; a chunk without an index may hold any."""
        for index in self._summary.chunk_indexes:
            found = index.message_index_offsets
            if not found or not channels.keys().isdisjoint(found):
                yield index

    def _messages_of(self, index: ChunkIndex, channels: dict[int, Channel]) -> Iterator[Message]:
        data = self._decompressed(index)
        count = 0
        for opcode, start, end in records_in(data):
            if opcode != Opcode.MESSAGE:
                continue
            channel, sequence, log_time, publish_time = _MESSAGE_HEAD.unpack_from(data, start)
            if channel not in channels:
                continue
            count += 1
            if count > MOST_MESSAGES:
                self._refuse(f"must hold at most {MOST_MESSAGES} messages of the cameras, not more")
            body = data[start + _MESSAGE_HEAD.size : end]
            yield Message(
                channel_id=channel, log_time=log_time, data=body, publish_time=publish_time, sequence=sequence
            )

    def _decompressed(self, index: ChunkIndex) -> bytes:
        """Return the decompressed records of a chunk."""
        self.offset = index.chunk_start_offset
        heads = RECORD_HEAD.size + _CHUNK_HEAD.size
        if self.offset + heads > self._size_bytes:
            raise ValueError("it lies behind the end of the file")
        self._stream.seek(self.offset)
        head = self._stream.read(heads)
        opcode, length = RECORD_HEAD.unpack_from(head)
        _, _, nbytes, crc, _ = _CHUNK_HEAD.unpack_from(head, RECORD_HEAD.size)
        if opcode != Opcode.CHUNK or length > self._size_bytes - self.offset - RECORD_HEAD.size:
            raise ValueError("it is not where the index says")
        largest = max(nbytes, length)  # without compression, the length covers the records
        if largest > LARGEST_CHUNK_BYTES:
            self._refuse(
                f"must hold at most {_size(LARGEST_CHUNK_BYTES)}, not {_size(largest)}; write the recording with smaller chunks"
            )
        self.end = max(self.end, self.offset + RECORD_HEAD.size + length)
        self._stream.seek(self.offset + RECORD_HEAD.size)
        chunk = Chunk.read(ReadDataStream(io.BytesIO(self._stream.read(length))))
        data = _decompressed(chunk)
        if len(data) != nbytes:
            raise ValueError(f"it says {nbytes} bytes and holds {len(data)}")
        if crc not in (0, zlib.crc32(data)):
            raise ValueError("its checksum does not match")
        return data

    def _refuse(self, problem: str) -> None:
        raise RecordingError(f"{self._path}: the chunk at byte {self.offset} {problem}")


def _decompressed(chunk: Chunk) -> bytes:
    """Decompress a chunk, to at most the size that it claims."""
    nbytes = chunk.uncompressed_size
    match chunk.compression:
        case "":
            return chunk.data
        case "zstd":
            said = zstandard.get_frame_parameters(chunk.data).content_size
            if said not in (nbytes, zstandard.CONTENTSIZE_UNKNOWN):
                raise ValueError(f"it says {nbytes} bytes, and its compressed data say {said}")
            return zstandard.ZstdDecompressor().decompress(chunk.data, max_output_size=nbytes)
        case "lz4":
            data: bytes = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=nbytes + 1)
            return data
    raise ValueError(f"compression must be zstd, lz4 or none, not {shown(chunk.compression)}")


def _size(nbytes: int) -> str:
    return f"{nbytes / (1 << 20):.0f} MiB"
