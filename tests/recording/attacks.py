"""MCAP files that say what is not so: records written byte by byte, as no program does."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from mcap.writer import MCAP0_MAGIC

LEFT, RIGHT = "/camera/left/image_raw", "/camera/right/image_raw"
IMAGE = RawImage(width=2, height=1, encoding="uyvy", step=4, data=bytes(4)).SerializeToString()
FIRST_CHUNK_AT = 31
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, CHUNK_INDEX, ATTACHMENT, ATTACHMENT_INDEX, STATISTICS = (
    1, 2, 3, 4, 5, 6, 8, 9, 10, 11,
)  # fmt: skip


def text(words: str | bytes) -> bytes:
    """Return a string as MCAP has it."""
    encoded = words.encode() if isinstance(words, str) else words
    return struct.pack("<I", len(encoded)) + encoded


def record(opcode: int, body: bytes) -> bytes:
    """Return one record."""
    return struct.pack("<BQ", opcode, len(body)) + body


def message(channel: int, time_ns: int, data: bytes = IMAGE) -> bytes:
    """Return a message record."""
    return record(MESSAGE, struct.pack("<HIQQ", channel, 0, time_ns, time_ns) + data)


def chunk(stored: bytes, *, nbytes: int, compression: str = "", crc: int = 0) -> bytes:
    """Return a chunk record that says it holds `nbytes`."""
    head = struct.pack("<QQQI", 0, 10, nbytes, crc)
    return record(CHUNK, head + text(compression) + struct.pack("<Q", len(stored)) + stored)


def chunk_index(offset: int, length: int, *, start_ns: int = 0) -> bytes:
    """Return the index of a chunk at `offset`, without a list of its channels."""
    body = struct.pack("<QQQQIQ", start_ns, 10, offset, length, 0, 0)
    return record(CHUNK_INDEX, body + text("") + struct.pack("<QQ", length, length))


def attachment_index(name: str, offset: int) -> bytes:
    """Return the index of an attachment at `offset`."""
    return record(ATTACHMENT_INDEX, struct.pack("<QQQQQ", offset, 0, 0, 0, 0) + text(name) + text(""))


def write(
    path: Path,
    chunks: Sequence[bytes],
    *,
    counts: tuple[int, int] = (1, 1),
    index: bytes = b"",
    attachments: Sequence[bytes] = (),
) -> Path:
    """Write a recording whose chunks are these records, and whose index also has `index`. `counts`: pictures it promises."""
    body = MCAP0_MAGIC + record(HEADER, text("") + text("attack"))
    schema = record(SCHEMA, struct.pack("<H", 1) + text("foxglove.RawImage") + text("protobuf") + text(b""))
    summary = schema
    for number, topic in enumerate((LEFT, RIGHT), start=1):
        summary += record(CHANNEL, struct.pack("<HH", number, 1) + text(topic) + text("protobuf") + text(b""))
    for each in chunks:
        summary += chunk_index(len(body), len(each))
        body += each
    for each in attachments:
        body += each
    pairs = b"".join(struct.pack("<HQ", number, count) for number, count in enumerate(counts, start=1))
    statistics = struct.pack("<QHIIIIQQ", sum(counts), 1, 2, len(attachments), 0, len(chunks), 0, 10)
    summary += record(STATISTICS, statistics + struct.pack("<I", len(pairs)) + pairs) + index
    footer = struct.pack("<BQQQ", FOOTER, 20, len(body), 0)
    crc = struct.pack("<I", zlib.crc32(footer, zlib.crc32(summary)))
    path.write_bytes(body + summary + footer + crc + MCAP0_MAGIC)
    return path


def pair(time_ns: int = 0) -> bytes:
    """Return the messages of one stereo frame."""
    return message(1, time_ns) + message(2, time_ns)
