"""The MCAP file of a recording: every checksum is verified on opening, and errors name the byte.

This module handles records, channels and chunks, but knows nothing of pictures.
"""

from __future__ import annotations

import hashlib
import io
import os
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    Header,
    Message,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.summary import Summary
from zstandard import ZstdError

from bfsim.errors import RecordingError, shown
from bfsim.recording.chunks import RECORD_HEAD, ChunkReader, records_in

# All errors of mcap 1.x and the decompressors that wrong bytes can cause.
_DAMAGE = (
    McapError,
    ZstdError,
    struct.error,
    ValueError,
    LookupError,
    MemoryError,
    OverflowError,
    RuntimeError,
    OSError,
)

MAGIC = b"\x89MCAP0\r\n"
"""The beginning and end of a file [MCAP specification, "Magic"]. mcap defines it in its writer, which few runs need."""

# Footer record [MCAP specification, "Footer (op=0x02)"]: opcode, length, summary start, summary offset start,
# CRC32 of the summary and of the footer up to here. The closing magic follows.
_FOOTER = struct.Struct("<BQQQI")
_TAIL_BYTES = _FOOTER.size + len(MAGIC)
_CRC_BYTES = 4

_PART_BYTES = 1 << 20
"""Bytes that are read at a time for the digest of the stored file."""

_MADE_BY = "`bfsim record import` makes a recording from images, raw frames, a video or a bag"
_OTHER_FILES = {
    ".py": "firmware goes behind `--firmware`, and a board behind `--board`",
    ".ldf": "an LDF goes behind `--ldf`",
    ".json": "a script goes behind `--script`",
    ".toml": "a script goes behind `--script`, a baseline behind `bfsim check --baseline`, and `bfsim sweep` takes a sweep",
}
"""What to say when other files of a user are given in place of a recording."""


class McapContainer:
    """An open MCAP file. Raises RecordingError, on opening and reading, for anything wrong with it."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self.read_end = 0
        """The end of the chunks that were read so far, in bytes."""
        if self.path.is_dir():
            raise RecordingError(
                f"{self.path}: recording must be a readable file, not a folder; `bfsim record import` makes one of a folder of pictures"
            )
        if self.path.is_fifo():  # reading a pipe without a writer would block
            raise RecordingError(
                f"{self.path}: recording must be a file that can be read from any place, not a pipe; save it under a name first"
            )
        try:
            self._stream: IO[bytes] = self.path.open("rb")
        except OSError as error:
            raise RecordingError(
                f"{self.path}: recording must be a readable file: {error.strerror}"
            ) from None
        try:
            self.size_bytes = os.fstat(self._stream.fileno()).st_size
            self._index_bytes = self._index()
            self.summary = self._summary_of(self._index_bytes)
            header, _ = self._record(Opcode.HEADER, len(MAGIC), "header")
            self.library: str = Header.read(ReadDataStream(io.BytesIO(header))).library
        except _DAMAGE as error:
            self.close()
            if isinstance(error, RecordingError):
                raise
            raise self._damaged("its header or index", error) from None

    def close(self) -> None:
        """Close the file."""
        self._stream.close()

    def messages(self, topics: list[str]) -> Iterator[tuple[Channel, Message]]:
        """Yield the messages of `topics` in the order of their time stamps, with a few chunks in memory at a time."""
        chunks = ChunkReader(self._stream, self.path, self.size_bytes, self.summary)
        messages = chunks.messages(topics)
        while True:
            try:
                channel, message = next(messages)
            except StopIteration:
                return
            except RecordingError:
                raise
            except _DAMAGE as error:
                raise self._damaged(f"the chunk at byte {chunks.offset}", error) from None
            self.read_end = max(self.read_end, chunks.end)
            yield channel, message

    def stored_digest(self, end: int) -> str:
        """Return a digest of the index, and of the file as stored up to byte `end`.

        If it is the same, so is everything that was read up to there.
        """
        digest = hashlib.sha256(self._index_bytes)
        self._stream.seek(0)
        while part := self._stream.read(min(_PART_BYTES, max(0, end - self._stream.tell()))):
            digest.update(part)
        return digest.hexdigest()

    def channel(self, topic: str) -> tuple[Channel, Schema | None] | None:
        """Return the channel with this topic and its schema, or None."""
        for channel in self.summary.channels.values():
            if channel.topic == topic:
                return channel, self.summary.schemas.get(channel.schema_id)
        return None

    def message_count(self, topic: str) -> int:
        """Return the number of messages of `topic` according to the file's statistics."""
        found = self.channel(topic)
        counts = self.summary.statistics.channel_message_counts if self.summary.statistics else {}
        return counts.get(found[0].id, 0) if found else 0

    def metadata(self, name: str) -> dict[str, str] | None:
        """Return the entries of the metadata record `name`, or None."""
        for index in self.summary.metadata_indexes:
            if index.name == name:
                body, _ = self._record(Opcode.METADATA, index.offset, name)
                where, stream = (
                    f"metadata {shown(name)} at byte {index.offset}",
                    ReadDataStream(io.BytesIO(body)),
                )
                try:
                    metadata: Metadata = Metadata.read(stream)
                except _DAMAGE as error:
                    raise self._damaged(where, error) from None
                if stream.count != len(body):
                    raise self._damaged(where, "it has fewer entries than its length says")
                return metadata.metadata
        return None

    def attachment(self, name: str) -> bytes | None:
        """Return the bytes of the attachment `name`, or None."""
        for index in self.summary.attachment_indexes:
            if index.name == name:
                where = f"attachment {shown(name)} at byte {index.offset}"
                body, crc = self._record(Opcode.ATTACHMENT, index.offset, name)
                if crc not in (0, zlib.crc32(body[:-_CRC_BYTES])):
                    raise self._damaged(where, "its checksum does not match")
                try:
                    attachment: Attachment = Attachment.read(ReadDataStream(io.BytesIO(body)))
                except _DAMAGE as error:
                    raise self._damaged(where, error) from None
                return attachment.data
        return None

    def _record(self, opcode: Opcode, offset: int, name: str) -> tuple[bytes, int]:
        """Return the body of the record at `offset` and its last four bytes as a number."""
        room = self.size_bytes - offset - RECORD_HEAD.size
        where = f"record {shown(name)} at byte {offset}"
        if room < 0:
            raise self._damaged(where, "it lies behind the end of the file")
        self._stream.seek(offset)
        found, length = RECORD_HEAD.unpack(self._stream.read(RECORD_HEAD.size))
        if found != opcode or not _CRC_BYTES <= length <= room:
            raise self._damaged(where, "it is not where the index says")
        body = self._stream.read(length)
        return body, int.from_bytes(body[-_CRC_BYTES:], "little")

    def _index(self) -> bytes:
        """Return the bytes of the index, after checking both ends of the file."""
        head = self._stream.read(len(MAGIC))
        if head != MAGIC:
            start = f"one that starts with {shown(head.decode('latin-1'))}" if head else "an empty one"
            advice = _OTHER_FILES.get(self.path.suffix.lower(), _MADE_BY)
            raise RecordingError(f"{self.path}: recording must be an MCAP file, not {start}; {advice}")
        self._stream.seek(max(0, self.size_bytes - _TAIL_BYTES))
        tail = self._stream.read()
        if len(tail) < _TAIL_BYTES or not tail.endswith(MAGIC):
            raise RecordingError(
                f"{self.path}: recording must end with an MCAP footer, "
                f"but breaks off at byte {self.size_bytes}; "
                "it was truncated while it was written or copied; copy or import it again"
            )
        _, _, summary_start, _, crc = _FOOTER.unpack(tail[: _FOOTER.size])
        summary_end = self.size_bytes - _TAIL_BYTES
        if not len(MAGIC) <= summary_start <= summary_end:
            raise RecordingError(
                f"{self.path}: recording must have an MCAP index, but its footer (byte {summary_end}) "
                "points to none; `mcap recover` writes one"
            )
        self._stream.seek(summary_start)
        summary = self._stream.read(summary_end - summary_start)
        if crc not in (0, zlib.crc32(tail[: _FOOTER.size - _CRC_BYTES], zlib.crc32(summary))):
            raise self._damaged(f"the index at byte {summary_start}", "its checksum does not match")
        return summary

    def _summary_of(self, index: bytes) -> Summary:
        """Return what the index lists. Other records in it are not read: nothing would limit a chunk there."""
        summary = Summary()
        for opcode, start, end in records_in(index):
            stream = ReadDataStream(io.BytesIO(index[start:end]))
            match opcode:
                case Opcode.STATISTICS:
                    summary.statistics = Statistics.read(stream)
                case Opcode.SCHEMA:
                    schema: Schema = Schema.read(stream)
                    summary.schemas[schema.id] = schema
                case Opcode.CHANNEL:
                    channel: Channel = Channel.read(stream)
                    summary.channels[channel.id] = channel
                case Opcode.CHUNK_INDEX:
                    summary.chunk_indexes.append(ChunkIndex.read(stream))
                case Opcode.METADATA_INDEX:
                    summary.metadata_indexes.append(MetadataIndex.read(stream))
                case Opcode.ATTACHMENT_INDEX:
                    summary.attachment_indexes.append(AttachmentIndex.read(stream))
        if summary.statistics is None or not summary.chunk_indexes:
            raise RecordingError(
                f"{self.path}: recording must be a chunked MCAP file with statistics and a chunk index, "
                "not one without; `mcap recover` writes them"
            )
        return summary

    def _damaged(self, what: str, why: BaseException | str) -> RecordingError:
        reason = str(why) or type(why).__name__
        return RecordingError(
            f"{self.path}: {what} must be readable, but is damaged ({reason}); copy or import it again"
        )
